//! Header of a PLY file.

use crate::scene::access::fault::Fault;

/// Encoding of the numbers after the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// Type of a number in a binary file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// Type of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    /// A count and as many items.
    List {
        count: Scalar,
        item: Scalar,
    },
}

#[derive(Debug, PartialEq)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Debug, PartialEq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) n: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// The place of a number among the properties.
    pub(super) fn scalar(&self, name: &str) -> Option<usize> {
        let is_it = |p: &Property| p.name == name && matches!(p.kind, Kind::Scalar(_));
        self.properties.iter().position(is_it)
    }
}

#[derive(Debug, PartialEq)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Lines of the header.
    pub(super) n_lines: usize,
}

impl Header {
    /// The header, and the bytes after it.
    pub(super) fn read(content: &[u8]) -> Result<(Self, &[u8]), Fault> {
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut rest = content;
        let mut n_lines = 0;
        loop {
            let Some(end) = rest.iter().position(|&byte| byte == b'\n') else {
                return Err(Fault::Format(match n_lines {
                    0 => "does not begin with a line `ply`".into(),
                    _ => "ends without `end_header`; the file is cut: export it again".into(),
                }));
            };
            let line = String::from_utf8_lossy(&rest[..end]);
            rest = &rest[end + 1..];
            n_lines += 1;
            let wrong = |needed: &str| {
                let found = line.trim();
                Fault::Format(format!("line {n_lines}: found `{found}`, needed {needed}"))
            };
            let words: Vec<&str> = line.split_whitespace().collect();
            match (n_lines, &words[..]) {
                (1, ["ply"]) => {}
                (1, _) => {
                    return Err(Fault::Format("does not begin with a line `ply`".into()));
                }
                (_, ["format", name, _]) => {
                    let known = encoding_of(name).ok_or_else(|| {
                        wrong("`format` ascii, binary_little_endian or binary_big_endian, and 1.0")
                    })?;
                    encoding = Some(known);
                }
                (_, ["element", name, n]) => elements.push(Element {
                    name: (*name).to_owned(),
                    n: n.parse().map_err(|_| wrong("`element name count`"))?,
                    properties: Vec::new(),
                }),
                (_, ["property", kind @ .., name]) => {
                    let kind = kind_of(kind).ok_or_else(|| {
                        wrong("`property type name` or `property list type type name`")
                    })?;
                    let of = elements
                        .last_mut()
                        .ok_or_else(|| wrong("an `element` before it"))?;
                    let name = (*name).to_owned();
                    of.properties.push(Property { name, kind });
                }
                (_, ["end_header"]) => break,
                (_, [] | ["comment" | "obj_info", ..]) => {}
                _ => return Err(wrong("a statement of PLY")),
            }
        }
        let encoding =
            encoding.ok_or_else(|| Fault::Format("has no line `format` in its header".into()))?;
        let header = Self {
            encoding,
            elements,
            n_lines,
        };
        Ok((header, rest))
    }
}

fn encoding_of(name: &str) -> Option<Encoding> {
    Some(match name {
        "ascii" => Encoding::Text,
        "binary_little_endian" => Encoding::LittleEndian,
        "binary_big_endian" => Encoding::BigEndian,
        _ => return None,
    })
}

fn kind_of(words: &[&str]) -> Option<Kind> {
    match *words {
        [name] => scalar_of(name).map(Kind::Scalar),
        ["list", count, item] => Some(Kind::List {
            count: scalar_of(count)?,
            item: scalar_of(item)?,
        }),
        _ => None,
    }
}

fn scalar_of(name: &str) -> Option<Scalar> {
    Some(match name {
        "char" | "int8" => Scalar::I8,
        "uchar" | "uint8" => Scalar::U8,
        "short" | "int16" => Scalar::I16,
        "ushort" | "uint16" => Scalar::U16,
        "int" | "int32" => Scalar::I32,
        "uint" | "uint32" => Scalar::U32,
        "float" | "float32" => Scalar::F32,
        "double" | "float64" => Scalar::F64,
        _ => return None,
    })
}
