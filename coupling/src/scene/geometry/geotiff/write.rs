//! GeoTIFF files of maps.

use std::io::Cursor;

use tiff::encoder::compression::DeflateLevel;
use tiff::encoder::{Compression, TiffEncoder, colortype::Gray32Float};
use tiff::tags::Tag;

use super::keys::{
    LINEAR_UNITS, METER, MODEL_TYPE, PIXEL_IS_AREA, PROJECTED, PROJECTED_CITATION,
    PROJECTED_SYSTEM, RASTER_TYPE, TEXT_OF_SYSTEM, USER_DEFINED,
};
use crate::scene::geometry::crs::Crs;
use crate::scene::geometry::terrain::grid::MapGrid;

/// Value of missing numbers.
const NO_DATA: f32 = -9999.0;

/// Failure to make a GeoTIFF.
#[derive(Debug, thiserror::Error)]
#[error("cannot make a GeoTIFF: {0}")]
pub struct GeoTiffError(#[from] tiff::TiffError);

/// A grid in map coordinates as a file: 32-bit floats, deflated, NaN as −9999.
///
/// # Errors
///
/// [`GeoTiffError`] for a grid that is too large.
pub fn written(map: &MapGrid) -> Result<Vec<u8>, GeoTiffError> {
    let grid = &map.grid;
    let mut content = Cursor::new(Vec::new());
    let encoder = TiffEncoder::new(&mut content)?;
    let mut encoder = encoder.with_compression(Compression::Deflate(DeflateLevel::Balanced));
    let [columns, rows] = grid.n.map(|n| n as u32);
    let mut image = encoder.new_image::<Gray32Float>(columns, rows)?;
    let (spacing, half) = (grid.spacing, 0.5 * grid.spacing);
    let (west, north) = (grid.corner[0] - half, grid.far_corner()[1] + half);
    let tags = image.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[spacing, spacing, 0.0][..])?;
    tags.write_tag(
        Tag::ModelTiepointTag,
        &[0.0, 0.0, 0.0, west, north, 0.0][..],
    )?;
    let (keys, texts) = keys_of(map.crs.as_ref());
    tags.write_tag(Tag::GeoKeyDirectoryTag, keys.as_slice())?;
    if !texts.is_empty() {
        tags.write_tag(Tag::GeoAsciiParamsTag, texts.as_str())?;
    }
    tags.write_tag(Tag::GdalNodata, format!("{NO_DATA}").as_str())?;
    let rows = grid.heights.chunks_exact(grid.n[0]).rev().flatten();
    let values = rows.map(|z| if z.is_finite() { *z as f32 } else { NO_DATA });
    image.write_data(&values.collect::<Vec<f32>>())?;
    Ok(content.into_inner())
}

/// Directory of keys and the texts that it points into.
fn keys_of(crs: Option<&Crs>) -> (Vec<u16>, String) {
    let mut entries = Vec::new();
    let mut texts = String::new();
    if crs.is_some() {
        entries.push([MODEL_TYPE, 0, 1, PROJECTED]);
    }
    entries.push([RASTER_TYPE, 0, 1, PIXEL_IS_AREA]);
    if let Some(crs) = crs {
        let code = crs.epsg.unwrap_or(USER_DEFINED);
        entries.push([PROJECTED_SYSTEM, 0, 1, code]);
        let text = format!("{TEXT_OF_SYSTEM}{}|", crs.wkt);
        if crs.epsg.is_none() && text.is_ascii() && text.len() < usize::from(u16::MAX) {
            let place = Tag::GeoAsciiParamsTag.to_u16();
            entries.push([PROJECTED_CITATION, place, text.len() as u16, 0]);
            texts = text;
        }
        entries.push([LINEAR_UNITS, 0, 1, METER]);
    }
    // version 1.1.0 and the count
    let head = [[1, 1, 0, entries.len() as u16]];
    let keys = head.iter().chain(&entries).flatten().copied();
    (keys.collect(), texts)
}
