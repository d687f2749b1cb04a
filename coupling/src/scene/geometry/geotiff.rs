//! Grids of elevations from and to GeoTIFF files (OGC 19-008r4), limited to square grids, north up.

mod georeference;
mod keys;
mod write;

use std::io::Cursor;

use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

use super::crs::Content;
use super::terrain::grid::{Grid, MapGrid};
use crate::scene::access::fault::Fault;
use georeference::Georeference;
pub(super) use keys::Keys;
pub use write::{GeoTiffError, written};

/// Largest number of points of a grid; each takes 8 bytes.
const MOST_POINTS: u64 = 50_000_000;

/// Most bytes that a byte of a compressed file stands for: codes of 12 bits for texts of up to 4096 bytes in LZW; 1032 in deflate.
const DENSEST: u64 = 2731;
/// Value of the tag of images without compression.
const UNCOMPRESSED: u16 = 1;

/// A file in memory.
type File<'a> = Decoder<Cursor<&'a [u8]>>;

/// True for the first bytes of a TIFF or BigTIFF, of either order of bytes.
pub fn is_tiff(content: &[u8]) -> bool {
    let starts = [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"];
    starts.iter().any(|start| content.starts_with(*start))
}

/// Grid of elevations in the content of a file, in map coordinates.
///
/// # Errors
///
/// [`Fault`], with the remedy.
pub fn grid_from(content: &[u8]) -> Result<Grid, Fault> {
    raster_from(content).map(|raster| raster.grid)
}

/// Grid of elevations in the content of a file, with its reference system.
///
/// # Errors
///
/// [`Fault`], with the remedy.
pub fn raster_from(content: &[u8]) -> Result<MapGrid, Fault> {
    let mut file = Decoder::new(Cursor::new(content)).map_err(unread)?;
    let (columns, rows) = file.dimensions().map_err(unread)?;
    if columns < 2 || rows < 2 {
        return Err(refuse(format!(
            "has {columns} x {rows} points, needs two each way"
        )));
    }
    if u64::from(columns) * u64::from(rows) > MOST_POINTS {
        return Err(refuse(format!(
            "has {columns} x {rows} points, more than {MOST_POINTS}; resample it"
        )));
    }
    let keys = Keys::read(&mut file)?;
    let crs = keys.crs();
    let place = Georeference::read(&mut file, &keys)?;
    let n = [columns as usize, rows as usize];
    if let Some(crs) = &crs {
        crs.in_meters(Content::Raster, place.middle(n))?;
    }
    keys.in_meters(Content::Raster)?;
    let (corner, spacing) = place.square_grid(n)?;
    refuse_short(&mut file, content.len() as u64)?;
    let rows = heights(&mut file, n)?;
    let heights = if place.is_north_up() {
        rows.chunks_exact(n[0]).rev().flatten().copied().collect()
    } else {
        rows
    };
    Ok(MapGrid {
        grid: Grid {
            n,
            corner,
            spacing,
            heights,
        },
        crs,
    })
}

/// Check of the size of the image against the length (bytes) of the file, before memory is reserved for it.
fn refuse_short(file: &mut File, length: u64) -> Result<(), Fault> {
    let (columns, rows) = file.dimensions().map_err(unread)?;
    let bits = u64::from(file.colortype().map_err(unread)?.bit_depth());
    let bytes = u64::from(columns) * u64::from(rows) * bits / 8;
    let compression = file.find_tag(Tag::Compression).ok().flatten();
    let compression = compression.and_then(|value| value.into_u16().ok());
    let held = match compression.unwrap_or(UNCOMPRESSED) {
        UNCOMPRESSED => length,
        _ => length.saturating_mul(DENSEST),
    };
    if bytes > held {
        return Err(refuse(format!(
            "is cut off: {columns} x {rows} points are {bytes} bytes, the file has {length}; copy it again"
        )));
    }
    Ok(())
}

fn refuse(what: impl Into<String>) -> Fault {
    Fault::Format(what.into())
}

fn unread(error: tiff::TiffError) -> Fault {
    refuse(format!(
        "is not a readable GeoTIFF: {error}; write it again: gdal_translate -co COMPRESS=DEFLATE in.tif out.tif"
    ))
}

/// Elevations in the rows of the file, NaN where missing; m.
fn heights(file: &mut File, n: [usize; 2]) -> Result<Vec<f64>, Fault> {
    let no_data = file
        .get_tag_ascii_string(Tag::GdalNodata)
        .ok()
        .and_then(|text| text.trim_matches(['\0', ' ']).parse::<f64>().ok());
    // a number for missing ones that is written in few digits, as heights are stored
    let no_data = [no_data, no_data.map(|z| f64::from(z as f32))];
    let mut heights = numbers(file.read_image().map_err(unread)?);
    if heights.len() != n[0] * n[1] {
        return Err(refuse(format!(
            "has {} numbers for {} x {} points; a raster of one band is needed: gdal_translate -b 1 in.tif out.tif",
            heights.len(),
            n[0],
            n[1]
        )));
    }
    for z in &mut heights {
        if !z.is_finite() || no_data.contains(&Some(*z)) {
            *z = f64::NAN;
        }
    }
    Ok(heights)
}

fn numbers(image: DecodingResult) -> Vec<f64> {
    fn widened<T: Into<f64>>(values: Vec<T>) -> Vec<f64> {
        values.into_iter().map(Into::into).collect()
    }
    match image {
        DecodingResult::U8(values) => widened(values),
        DecodingResult::U16(values) => widened(values),
        DecodingResult::U32(values) => widened(values),
        DecodingResult::U64(values) => values.into_iter().map(|z| z as f64).collect(),
        DecodingResult::I8(values) => widened(values),
        DecodingResult::I16(values) => widened(values),
        DecodingResult::I32(values) => widened(values),
        DecodingResult::I64(values) => values.into_iter().map(|z| z as f64).collect(),
        DecodingResult::F16(values) => values.into_iter().map(f64::from).collect(),
        DecodingResult::F32(values) => widened(values),
        DecodingResult::F64(values) => values,
    }
}

#[cfg(test)]
mod tests;
