//! Writer of NetCDF-3 files (classic format), as any reader of the field takes them.

/// Tags of the classic format.
const DIMENSION: u32 = 10;
const VARIABLE: u32 = 11;
const ATTRIBUTE: u32 = 12;
const CHAR: u32 = 2;
const FLOAT: u32 = 5;
const DOUBLE: u32 = 6;

/// Values of a variable.
#[derive(Clone, Debug, PartialEq)]
pub enum Data {
    /// 32-bit floats.
    Float(Vec<f32>),
    /// 64-bit floats.
    Double(Vec<f64>),
}

/// A variable over some of the dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name.
    pub name: &'static str,
    /// Indices of its dimensions, the last one fastest.
    pub dimensions: Vec<u32>,
    /// Attributes: name and text.
    pub attributes: Vec<(&'static str, String)>,
    /// Values.
    pub data: Data,
}

/// A file.
#[derive(Clone, Debug, PartialEq)]
pub struct File {
    /// Names and lengths.
    pub dimensions: Vec<(&'static str, usize)>,
    /// Attributes of the file.
    pub attributes: Vec<(&'static str, String)>,
    /// Variables.
    pub variables: Vec<Variable>,
}

impl Data {
    fn kind(&self) -> u32 {
        match self {
            Self::Float(_) => FLOAT,
            Self::Double(_) => DOUBLE,
        }
    }

    fn size(&self) -> usize {
        match self {
            Self::Float(values) => 4 * values.len(),
            Self::Double(values) => 8 * values.len(),
        }
    }
}

/// The bytes of a file; `None` if it is too large for the format (2 GB).
pub fn bytes(file: &File) -> Option<Vec<u8>> {
    let head = head(file, 0)?.len();
    let mut out = self::head(file, head)?;
    for variable in &file.variables {
        match &variable.data {
            Data::Float(values) => values.iter().for_each(|x| out.extend(x.to_be_bytes())),
            Data::Double(values) => values.iter().for_each(|x| out.extend(x.to_be_bytes())),
        }
    }
    Some(out)
}

/// The header, with data that begin at a byte.
fn head(file: &File, first: usize) -> Option<Vec<u8>> {
    let mut out = b"CDF\x01".to_vec();
    let number = |out: &mut Vec<u8>, x: usize| -> Option<()> {
        // offsets are signed
        out.extend(i32::try_from(x).ok()?.to_be_bytes());
        Some(())
    };
    // no records
    number(&mut out, 0)?;
    out.extend(DIMENSION.to_be_bytes());
    number(&mut out, file.dimensions.len())?;
    for (name, length) in &file.dimensions {
        text(&mut out, name);
        number(&mut out, *length)?;
    }
    attributes(&mut out, &file.attributes);
    out.extend(VARIABLE.to_be_bytes());
    number(&mut out, file.variables.len())?;
    let mut begin = first;
    for variable in &file.variables {
        text(&mut out, variable.name);
        number(&mut out, variable.dimensions.len())?;
        for dimension in &variable.dimensions {
            out.extend(dimension.to_be_bytes());
        }
        attributes(&mut out, &variable.attributes);
        out.extend(variable.data.kind().to_be_bytes());
        number(&mut out, variable.data.size())?;
        number(&mut out, begin)?;
        begin += variable.data.size();
    }
    Some(out)
}

fn attributes(out: &mut Vec<u8>, all: &[(&'static str, String)]) {
    let tag = if all.is_empty() { 0 } else { ATTRIBUTE };
    out.extend(tag.to_be_bytes());
    out.extend((all.len() as u32).to_be_bytes());
    for (name, value) in all {
        text(out, name);
        out.extend(CHAR.to_be_bytes());
        text(out, value);
    }
}

/// A text with its length, filled up to four bytes.
fn text(out: &mut Vec<u8>, text: &str) {
    out.extend((text.len() as u32).to_be_bytes());
    out.extend(text.as_bytes());
    out.resize(out.len().next_multiple_of(4), 0);
}
