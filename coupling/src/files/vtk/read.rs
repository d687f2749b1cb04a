//! Reading of our own files, for rendering and tests.
//!
//! The content is verified before use, and no memory is allocated from the size in a header alone: a block is only
//! decompressed if the compressed bytes present could hold it.

use super::write::escape;
use super::{Array, Fault, Names, PolyData, Values, VtkError};
use flate2::{Decompress, FlushDecompress, Status};
use rayon::prelude::*;
use std::fs;
use std::path::Path;

/// Upper bound on the compression ratio of deflate: 258 bytes from 2 bits, 1032:1, rounded up.
const MAX_EXPANSION: u64 = 1100;

/// Reads a file written by [`write`](super::write()).
///
/// # Errors
/// [`VtkError::Io`] if the file cannot be read; [`VtkError::Data`] if it is truncated, damaged or in the layout of another
/// program.
pub fn read(path: &Path) -> Result<PolyData, VtkError> {
    let bytes = fs::read(path).map_err(VtkError::io("read", path))?;
    parse(&bytes).map_err(VtkError::data(path))
}

fn parse(bytes: &[u8]) -> Result<PolyData, Fault> {
    let (header, appended) = split(bytes)?;
    let mut file = File {
        appended,
        data: PolyData::default(),
        n_points: 0,
        n_lines: 0,
        n_polygons: 0,
    };
    let mut section = "";
    let mut has_time = false;
    for tag in tags(header) {
        match tag.name {
            "VTKFile" => require_layout(&tag)?,
            "FieldData" | "PointData" | "CellData" | "Points" | "Verts" | "Lines" | "Polys" => {
                section = tag.name
            }
            "Piece" => {
                file.n_points = tag.number("NumberOfPoints")?;
                file.n_lines = tag.number("NumberOfLines")?;
                file.n_polygons = tag.number("NumberOfPolys")?;
            }
            "DataArray" if section == "FieldData" => {
                has_time |= file.read_field(&tag)?;
            }
            "Array" if section == "FieldData" => file.read_names(&tag)?,
            "DataArray" => file.read_array(section, &tag)?,
            _ => {}
        }
    }
    if !has_time {
        return Err(Fault::Missing { part: "TimeValue" });
    }
    file.data.check()?;
    file.complete()
}

/// Splits a file into its XML text and the bytes after the underscore; a truncated file is rejected.
fn split(bytes: &[u8]) -> Result<(&str, &[u8]), Fault> {
    const MARK: &[u8] = b"<AppendedData encoding=\"raw\">";
    let missing = |part| Fault::Missing { part };
    let body = bytes
        .trim_ascii_end()
        .strip_suffix(b"</VTKFile>")
        .and_then(|rest| rest.trim_ascii_end().strip_suffix(b"</AppendedData>"))
        .ok_or(missing("the end of the file"))?;
    let start = body
        .windows(MARK.len())
        .position(|window| window == MARK)
        .ok_or(missing("the appended section"))?;
    let header = std::str::from_utf8(&body[..start]).map_err(|_| missing("the XML header"))?;
    let appended = body[start + MARK.len()..]
        .trim_ascii_start()
        .strip_prefix(b"_")
        .ok_or(missing("the underscore before the appended data"))?;
    Ok((header, appended))
}

fn require_layout(tag: &Tag<'_>) -> Result<(), Fault> {
    for (attribute, expected) in [
        ("type", "PolyData"),
        ("byte_order", "LittleEndian"),
        ("header_type", "UInt64"),
        ("compressor", "vtkZLibDataCompressor"),
    ] {
        let value = tag.text(attribute)?;
        if value != expected {
            return Err(Fault::Unsupported { attribute, value });
        }
    }
    Ok(())
}

/// Content read so far.
struct File<'a> {
    appended: &'a [u8],
    data: PolyData,
    n_points: u64,
    n_lines: u64,
    n_polygons: u64,
}

impl File<'_> {
    /// Reads field data; whether it was the time.
    fn read_field(&mut self, tag: &Tag<'_>) -> Result<bool, Fault> {
        if tag.text("Name")? != "TimeValue" {
            return Ok(false);
        }
        let text = tag.content.trim();
        self.data.time = text.parse().map_err(|_| Fault::Unsupported {
            attribute: "TimeValue",
            value: text.to_owned(),
        })?;
        Ok(true)
    }

    /// Reads a list of names; the note about the source, which is text in the header, is none.
    fn read_names(&mut self, tag: &Tag<'_>) -> Result<(), Fault> {
        if tag.text("format")? != "appended" {
            return Ok(());
        }
        let name = tag.text("Name")?;
        let damaged = || Fault::Compressed { name: name.clone() };
        let bytes = unpack(self.appended, tag.number("offset")?).ok_or_else(damaged)?;
        let text = String::from_utf8(bytes).map_err(|_| damaged())?;
        let list: Vec<String> = text.split_terminator('\0').map(str::to_owned).collect();
        let (found, expected) = (list.len() as u64, tag.number("NumberOfTuples")?);
        if found != expected {
            return Err(Fault::Length {
                name,
                found,
                expected,
            });
        }
        self.data.names.push(Names { name, list });
        Ok(())
    }

    fn read_array(&mut self, section: &str, tag: &Tag<'_>) -> Result<(), Fault> {
        let name = tag.text("Name")?;
        match (section, name.as_str()) {
            ("PointData", _) => {
                let array = self.array(tag, name, Some(self.n_points))?;
                self.data.point_data.push(array);
            }
            ("CellData", _) => {
                let array = self.array(
                    tag,
                    name,
                    Some(self.n_lines.saturating_add(self.n_polygons)),
                )?;
                self.data.cell_data.push(array);
            }
            ("Points", _) => {
                let Values::F32(values) = self.array(tag, name, Some(self.n_points))?.values else {
                    return Err(Fault::Missing {
                        part: "Float32 points",
                    });
                };
                self.data.points = values.as_chunks().0.to_vec();
            }
            ("Lines", "connectivity") => {
                self.data.lines.connectivity = self.integers(tag, name, None)?
            }
            ("Lines", "offsets") => {
                self.data.lines.offsets = self.integers(tag, name, Some(self.n_lines))?
            }
            ("Polys", "connectivity") => {
                self.data.polygons.connectivity = self.integers(tag, name, None)?
            }
            ("Polys", "offsets") => {
                self.data.polygons.offsets = self.integers(tag, name, Some(self.n_polygons))?
            }
            // The vertex cells of a point cloud are redundant.
            _ => {}
        }
        Ok(())
    }

    fn integers(&self, tag: &Tag<'_>, name: String, n: Option<u64>) -> Result<Vec<i32>, Fault> {
        match self.array(tag, name, n)?.values {
            Values::I32(values) => Ok(values),
            Values::F32(_) | Values::F64(_) => Err(Fault::Missing {
                part: "Int32 cells",
            }),
        }
    }

    /// An array of `n_tuples`, or of the number present.
    fn array(&self, tag: &Tag<'_>, name: String, n_tuples: Option<u64>) -> Result<Array, Fault> {
        let components = tag.number("NumberOfComponents")?;
        if ![1, 3, 6].contains(&components) {
            let components = usize::try_from(components).unwrap_or(usize::MAX);
            return Err(Fault::Components { name, components });
        }
        let offset = tag.number("offset")?;
        let unpacked = unpack(self.appended, offset)
            .ok_or_else(|| Fault::Compressed { name: name.clone() })?;
        let values = match tag.text("type")?.as_str() {
            "Float32" => Values::F32(numbers(&unpacked, f32::from_le_bytes)),
            "Float64" => Values::F64(numbers(&unpacked, f64::from_le_bytes)),
            "Int32" => Values::I32(numbers(&unpacked, i32::from_le_bytes)),
            other => {
                return Err(Fault::Unsupported {
                    attribute: "type",
                    value: other.to_owned(),
                });
            }
        };
        let found = values.len() as u64;
        let expected = n_tuples.map_or(found, |n| n.saturating_mul(components));
        if found != expected {
            return Err(Fault::Length {
                name,
                found,
                expected,
            });
        }
        Ok(Array {
            name,
            components: components as usize,
            values,
        })
    }

    /// The data, if the counts of the header agree, including omitted sections.
    fn complete(self) -> Result<PolyData, Fault> {
        if self.data.points.len() as u64 != self.n_points {
            return Err(Fault::Missing { part: "points" });
        }
        if self.data.lines.len() as u64 != self.n_lines {
            return Err(Fault::Missing { part: "lines" });
        }
        if self.data.polygons.len() as u64 != self.n_polygons {
            return Err(Fault::Missing { part: "polygons" });
        }
        Ok(self.data)
    }
}

fn numbers<T, const N: usize>(bytes: &[u8], from_bytes: impl Fn([u8; N]) -> T) -> Vec<T> {
    bytes
        .as_chunks()
        .0
        .iter()
        .map(|&number| from_bytes(number))
        .collect()
}

/// Decompresses the array at `offset`; `None` if the table or a block is damaged.
fn unpack(appended: &[u8], offset: u64) -> Option<Vec<u8>> {
    let array = appended.get(usize::try_from(offset).ok()?..)?;
    let (words, _) = array.as_chunks::<8>();
    let word = |i: usize| words.get(i).map(|&bytes| u64::from_le_bytes(bytes));
    let (n_blocks, block_bytes, shorter_last) =
        (usize::try_from(word(0)?).ok()?, word(1)?, word(2)?);
    let sizes = words.get(3..n_blocks.checked_add(3)?)?;

    let mut start = (3 + n_blocks) * 8;
    let mut blocks = Vec::with_capacity(n_blocks);
    for (i, &size) in sizes.iter().enumerate() {
        let end = start.checked_add(usize::try_from(u64::from_le_bytes(size)).ok()?)?;
        let is_last = i + 1 == n_blocks;
        let unpacked = if is_last && shorter_last != 0 {
            shorter_last
        } else {
            block_bytes
        };
        blocks.push((array.get(start..end)?, unpacked));
        start = end;
    }
    let unpacked: Option<Vec<Vec<u8>>> = blocks
        .into_par_iter()
        .map(|(block, n_bytes)| unpack_block(block, n_bytes))
        .collect();
    Some(unpacked?.concat())
}

fn unpack_block(block: &[u8], n_bytes: u64) -> Option<Vec<u8>> {
    if n_bytes > MAX_EXPANSION.checked_mul(block.len() as u64)? {
        return None;
    }
    let n_bytes = usize::try_from(n_bytes).ok()?;
    // One extra byte reveals a block with too much data.
    let mut unpacked = Vec::with_capacity(n_bytes + 1);
    let mut zlib = Decompress::new(true);
    let status = zlib
        .decompress_vec(block, &mut unpacked, FlushDecompress::Finish)
        .ok()?;
    let is_whole = status == Status::StreamEnd
        && zlib.total_in() == block.len() as u64
        && unpacked.len() == n_bytes;
    is_whole.then_some(unpacked)
}

/// An opening tag and the text up to the next tag.
struct Tag<'a> {
    name: &'a str,
    attributes: &'a str,
    content: &'a str,
}

/// The opening tags of our own XML, without `<` or `>` inside attributes.
fn tags(header: &str) -> impl Iterator<Item = Tag<'_>> {
    header.split('<').skip(1).filter_map(|piece| {
        let (inside, content) = piece.split_once('>')?;
        let inside = inside.trim_end_matches('/');
        let (name, attributes) = inside
            .split_once(char::is_whitespace)
            .unwrap_or((inside, ""));
        Some(Tag {
            name,
            attributes,
            content,
        })
    })
}

impl Tag<'_> {
    fn text(&self, attribute: &'static str) -> Result<String, Fault> {
        // Values are quoted, so that every second piece is one.
        let mut pieces = self.attributes.split('"');
        while let (Some(key), Some(value)) = (pieces.next(), pieces.next()) {
            if key.trim().strip_suffix('=') == Some(attribute) {
                return Ok(unescape(value));
            }
        }
        Err(Fault::Missing { part: attribute })
    }

    fn number(&self, attribute: &'static str) -> Result<u64, Fault> {
        let value = self.text(attribute)?;
        value
            .parse()
            .map_err(|_| Fault::Unsupported { attribute, value })
    }
}

fn unescape(text: &str) -> String {
    // The ampersand last, or `&amp;lt;` would become `<`.
    ["<", ">", "\"", "'", "&"]
        .iter()
        .fold(text.to_owned(), |text, plain| {
            text.replace(&escape(plain), plain)
        })
}
