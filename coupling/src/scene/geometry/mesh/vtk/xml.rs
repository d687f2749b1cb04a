//! XML files with their data inline, as text or as base64 without compression.
//!
//! A reader of its own: offsets, lengths and numbers of a file are not used before they are checked.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use roxmltree::{Document, Node, ParsingOptions};

use super::{Soup, broken_lists, no_surface, push_cell, push_points, unreadable};
use crate::scene::access::fault::Fault;

/// Largest number of tags and texts of a file; each takes some hundred bytes of memory.
const MOST_NODES: u32 = 1_000_000;
/// VTK's number of a polygon.
const POLYGON: u8 = 7;
/// VTK's number of a strip of triangles.
const STRIP: u8 = 6;

/// The surface of a `.vtp` or `.vtu` file.
pub(in crate::scene::geometry::mesh) fn read(content: &[u8]) -> Result<Soup, Fault> {
    let holds = |text: &[u8]| content.windows(text.len()).any(|window| window == text);
    if holds(b"compressor=\"vtk") || holds(b"<AppendedData") {
        return Err(Fault::Format(
            "is compressed or has appended data; save it with data mode Ascii or Binary and no compressor".into(),
        ));
    }
    let text = std::str::from_utf8(content).map_err(unreadable)?;
    let options = ParsingOptions {
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options).map_err(unreadable)?;
    let root = document.root_element();
    let encoding = Encoding::of(root)?;
    let kind = root.attribute("type").unwrap_or_default();
    match kind {
        "PolyData" | "UnstructuredGrid" => {}
        "PPolyData" | "PUnstructuredGrid" => {
            return Err(Fault::Format(
                "refers to other files; save it in one file".into(),
            ));
        }
        _ => return Err(no_surface()),
    }
    let mut soup = Soup::default();
    let data = child(root, kind);
    for piece in data.into_iter().flat_map(|data| children(data, "Piece")) {
        let first = push_points(&mut soup, &points(piece, encoding)?);
        for (section, cell) in [("Polys", POLYGON), ("Strips", STRIP)] {
            for corners in child(piece, section)
                .map_or_else(|| Ok(Vec::new()), |cells| lists(cells, encoding))?
            {
                push_cell(&mut soup, first, cell, &corners)?;
            }
        }
        if let Some(cells) = child(piece, "Cells") {
            let kinds = whole(array(cells, "types")?, encoding)?;
            for (corners, kind) in lists(cells, encoding)?.iter().zip(kinds) {
                // no type of VTK has a larger number
                push_cell(
                    &mut soup,
                    first,
                    u8::try_from(kind).unwrap_or(u8::MAX),
                    corners,
                )?;
            }
        }
    }
    Ok(soup)
}

/// Layout of numbers in base64.
#[derive(Clone, Copy)]
struct Encoding {
    is_big_endian: bool,
    /// Bytes of the leading number, the length of the data.
    length_bytes: usize,
}

impl Encoding {
    fn of(root: Node<'_, '_>) -> Result<Self, Fault> {
        let unknown = |attribute: &str, value: &str| {
            Err(Fault::Format(format!(
                "has {attribute} `{value}`, which is unknown"
            )))
        };
        let is_big_endian = match root.attribute("byte_order") {
            Some("LittleEndian") | None => false,
            Some("BigEndian") => true,
            Some(other) => return unknown("byte_order", other),
        };
        // files of version 0.1 do not say it
        let length_bytes = match root.attribute("header_type") {
            Some("UInt32") | None => 4,
            Some("UInt64") => 8,
            Some(other) => return unknown("header_type", other),
        };
        Ok(Self {
            is_big_endian,
            length_bytes,
        })
    }

    /// Numbers of `N` bytes each.
    fn numbers<const N: usize, T>(self, bytes: &[u8], from_le: fn([u8; N]) -> T) -> Vec<T> {
        let ordered = |&(mut number): &[u8; N]| {
            if self.is_big_endian {
                number.reverse();
            }
            from_le(number)
        };
        bytes.as_chunks().0.iter().map(ordered).collect()
    }

    /// Bytes of an array: length and data, in one piece of base64 or in two.
    fn bytes(self, text: &str) -> Result<Vec<u8>, Fault> {
        let cut = || Fault::Format("has a binary array that is cut or damaged".into());
        let text: String = text.split_ascii_whitespace().collect();
        let mut bytes = Vec::new();
        for piece in text.split_inclusive('=').filter(|&piece| piece != "=") {
            // of two signs of padding one went into a piece of its own
            let piece = piece.trim_end_matches('=');
            let padding = ["", "", "==", "="].get(piece.len() % 4);
            let whole = format!("{piece}{}", padding.unwrap_or(&""));
            bytes.extend(STANDARD.decode(whole).map_err(|_| cut())?);
        }
        let (length, data) = bytes.split_at_checked(self.length_bytes).ok_or_else(cut)?;
        let lengths: Vec<u64> = match self.length_bytes {
            4 => self.numbers(length, |n| u64::from(u32::from_le_bytes(n))),
            _ => self.numbers(length, u64::from_le_bytes),
        };
        let n = lengths.first().and_then(|&n| usize::try_from(n).ok());
        let data = n.and_then(|n| data.get(..n)).ok_or_else(cut)?;
        Ok(data.to_vec())
    }
}

/// Numbers of an array.
enum Numbers {
    Real(Vec<f64>),
    Whole(Vec<i64>),
}

impl Numbers {
    fn of(array: Node<'_, '_>, encoding: Encoding) -> Result<Self, Fault> {
        let kind = array.attribute("type").unwrap_or_default();
        let text = array.text().unwrap_or_default();
        match array.attribute("format") {
            Some("ascii") if kind.starts_with("Float") => words(text).map(Self::Real),
            Some("ascii") if kind.contains("Int") => words(text).map(Self::Whole),
            Some("binary") => {
                let bytes = encoding.bytes(text)?;
                Self::from_bytes(kind, &bytes, encoding).ok_or_else(|| unknown_type(kind))
            }
            Some("ascii") => Err(unknown_type(kind)),
            other => Err(Fault::Format(format!(
                "has an array of format `{}`; save it with data mode Ascii or Binary",
                other.unwrap_or_default()
            ))),
        }
    }

    /// Numbers of a type of VTK.
    fn from_bytes(kind: &str, bytes: &[u8], encoding: Encoding) -> Option<Self> {
        Some(match kind {
            "Float32" => Self::Real(encoding.numbers(bytes, |n| f64::from(f32::from_le_bytes(n)))),
            "Float64" => Self::Real(encoding.numbers(bytes, f64::from_le_bytes)),
            "Int8" => Self::Whole(encoding.numbers(bytes, |n| i8::from_le_bytes(n).into())),
            "UInt8" => Self::Whole(encoding.numbers(bytes, |n| u8::from_le_bytes(n).into())),
            "Int16" => Self::Whole(encoding.numbers(bytes, |n| i16::from_le_bytes(n).into())),
            "UInt16" => Self::Whole(encoding.numbers(bytes, |n| u16::from_le_bytes(n).into())),
            "Int32" => Self::Whole(encoding.numbers(bytes, |n| i32::from_le_bytes(n).into())),
            "UInt32" => Self::Whole(encoding.numbers(bytes, |n| u32::from_le_bytes(n).into())),
            // above 2^63 the number is negative and refused as a corner that is not there
            "Int64" | "UInt64" => Self::Whole(encoding.numbers(bytes, i64::from_le_bytes)),
            _ => return None,
        })
    }
}

fn unknown_type(kind: &str) -> Fault {
    Fault::Format(format!("has numbers of type `{kind}`, which is unknown"))
}

fn words<T: std::str::FromStr>(text: &str) -> Result<Vec<T>, Fault> {
    text.split_ascii_whitespace()
        .map(|word| {
            let refused = |_| Fault::Format(format!("has `{word}` where a number should be"));
            word.parse().map_err(refused)
        })
        .collect()
}

/// Points of a piece, three numbers each.
fn points(piece: Node<'_, '_>, encoding: Encoding) -> Result<Vec<f64>, Fault> {
    let array = child(piece, "Points")
        .and_then(|points| child(points, "DataArray"))
        .ok_or_else(|| Fault::Format("holds no points".into()))?;
    Ok(match Numbers::of(array, encoding)? {
        Numbers::Real(numbers) => numbers,
        Numbers::Whole(numbers) => numbers.into_iter().map(|n| n as f64).collect(),
    })
}

/// Corner numbers of each cell of a section.
fn lists(section: Node<'_, '_>, encoding: Encoding) -> Result<Vec<Vec<u64>>, Fault> {
    // programs leave the arrays out where a piece has no such cells
    if children(section, "DataArray").next().is_none() {
        return Ok(Vec::new());
    }
    let connectivity = whole(array(section, "connectivity")?, encoding)?;
    let mut start = 0;
    let mut cells = Vec::new();
    for end in whole(array(section, "offsets")?, encoding)? {
        let end = usize::try_from(end).map_err(|_| broken_lists())?;
        let corners = connectivity.get(start..end).ok_or_else(broken_lists)?;
        cells.push(corners.to_vec());
        start = end;
    }
    Ok(cells)
}

/// Nonnegative integers.
fn whole(array: Node<'_, '_>, encoding: Encoding) -> Result<Vec<u64>, Fault> {
    match Numbers::of(array, encoding)? {
        Numbers::Whole(numbers) => numbers
            .into_iter()
            .map(|n| u64::try_from(n).map_err(|_| broken_lists()))
            .collect(),
        Numbers::Real(_) => Err(broken_lists()),
    }
}

/// The array of a name in a section.
fn array<'a, 'input>(section: Node<'a, 'input>, name: &str) -> Result<Node<'a, 'input>, Fault> {
    children(section, "DataArray")
        .find(|array| array.attribute("Name") == Some(name))
        .ok_or_else(|| Fault::Format(format!("has cells without `{name}`")))
}

fn children<'a, 'input>(
    node: Node<'a, 'input>,
    name: &str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children()
        .filter(move |child| child.has_tag_name(name))
}

fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    children(node, name).next()
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may fail")]

    use super::*;

    const POINTS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.5, -3.0];

    /// A triangle in base64, whose lengths have `length_bytes` bytes.
    fn triangle(is_big_endian: bool, length_bytes: usize, is_in_one: bool) -> String {
        let order = |mut bytes: Vec<u8>| {
            if is_big_endian {
                bytes.reverse();
            }
            bytes
        };
        let encoded = |numbers: Vec<Vec<u8>>| {
            let data = numbers.into_iter().map(order).collect::<Vec<_>>().concat();
            let mut length = (data.len() as u64).to_le_bytes().to_vec();
            length.truncate(length_bytes);
            let length = order(length);
            if is_in_one {
                STANDARD.encode([length, data].concat())
            } else {
                STANDARD.encode(length) + "\n  " + &STANDARD.encode(data)
            }
        };
        let whole =
            |numbers: &[i64]| encoded(numbers.iter().map(|n| n.to_le_bytes().into()).collect());
        format!(
            "<VTKFile type=\"PolyData\" byte_order=\"{}\" header_type=\"UInt{}\"><PolyData><Piece><Points>\
             <DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"binary\">{}</DataArray></Points><Polys>\
             <DataArray type=\"Int64\" Name=\"connectivity\" format=\"binary\">{}</DataArray>\
             <DataArray type=\"Int64\" Name=\"offsets\" format=\"binary\"> {} </DataArray></Polys>\
             <Strips/></Piece></PolyData></VTKFile>",
            if is_big_endian {
                "BigEndian"
            } else {
                "LittleEndian"
            },
            8 * length_bytes,
            encoded(POINTS.iter().map(|x| x.to_le_bytes().into()).collect()),
            whole(&[0, 1, 2]),
            whole(&[3]),
        )
    }

    #[test]
    fn base64_is_read_in_every_layout() {
        for is_big_endian in [false, true] {
            for length_bytes in [4, 8] {
                for is_in_one in [false, true] {
                    let text = triangle(is_big_endian, length_bytes, is_in_one);
                    let soup = read(text.as_bytes()).unwrap();
                    let numbers: Vec<f32> =
                        soup.points.iter().flatten().map(|&x| x as f32).collect();
                    assert_eq!(numbers, POINTS, "{text}");
                    assert_eq!(soup.triangles, [[0, 1, 2]]);
                }
            }
        }
    }

    #[test]
    fn pieces_number_their_points_from_zero() {
        let piece = |x: f64| {
            format!(
                "<Piece><Points><DataArray type=\"Float64\" format=\"ascii\">{x} 0 0 1 0 0 0 1 0</DataArray></Points>\
                 <Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 0</DataArray>\
                 <DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 4</DataArray>\
                 <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5 1</DataArray></Cells></Piece>"
            )
        };
        let text = format!(
            "<?xml version=\"1.0\"?><!-- two --><VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>{}{}\
             </UnstructuredGrid></VTKFile>",
            piece(0.0),
            piece(0.5)
        );
        let soup = read(text.as_bytes()).unwrap();
        assert_eq!(soup.triangles, [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(soup.points[3].x, 0.5);
    }

    #[test]
    fn what_is_damaged_is_refused() {
        let sound = triangle(false, 4, true);
        for (from, to, expected) in [
            ("Float32", "Float16", "numbers of type `Float16`"),
            ("LittleEndian", "Middle", "byte_order `Middle`"),
            ("UInt32", "UInt16", "header_type `UInt16`"),
            ("\"offsets\"", "\"ends\"", "cells without `offsets`"),
            (
                "format=\"binary\">",
                "format=\"binary\">A",
                "cut or damaged",
            ),
            (
                "format=\"binary\">",
                "format=\"binary\">/////",
                "cut or damaged",
            ),
            (
                "format=\"binary\"",
                "format=\"appended\"",
                "format `appended`",
            ),
            ("</Piece>", "", "is not readable as VTK"),
            (
                "type=\"PolyData\"",
                "type=\"PPolyData\"",
                "refers to other files",
            ),
            ("type=\"PolyData\"", "type=\"ImageData\"", "holds a grid"),
            ("Points>", "Pints>", "holds no points"),
        ] {
            let text = sound.replace(from, to);
            let error = read(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}: {text}");
        }
    }
}
