//! Grids of elevations from GeoTIFF files (OGC 19-008r4), limited to square grids.

use std::io::Cursor;

use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

use super::terrain::grid::Grid;
use crate::scene::access::fault::Fault;

/// Numbers of keys and of their values.
const MODEL_TYPE: u16 = 1024;
const GEOGRAPHIC: u16 = 2;
const RASTER_TYPE: u16 = 1025;
const PIXEL_IS_POINT: u16 = 2;
const LINEAR_UNITS: u16 = 3076;
const METRE: u16 = 9001;
/// Tolerance of square pixels; –.
const SQUARE: f64 = 1e-6;

/// Grid of elevations in the content of a file, in map coordinates.
///
/// # Errors
///
/// [`Fault`], with the remedy.
pub fn grid_from(content: &[u8]) -> Result<Grid, Fault> {
    let refuse = |what: String| Fault::Format(what);
    let unread = |error: tiff::TiffError| refuse(format!("is not a readable GeoTIFF: {error}"));
    let mut file = Decoder::new(Cursor::new(content)).map_err(unread)?;
    let (columns, rows) = file.dimensions().map_err(unread)?;
    if columns < 2 || rows < 2 {
        return Err(refuse(format!(
            "has {columns} x {rows} points, needs two each way"
        )));
    }
    let scale = file
        .get_tag_f64_vec(Tag::ModelPixelScaleTag)
        .map_err(|_| refuse("has no pixel scale: export it north up, without a rotation".into()))?;
    let tie = file
        .get_tag_f64_vec(Tag::ModelTiepointTag)
        .map_err(|_| refuse("has no tie point: it says of no place on the map".into()))?;
    let (&[width, height, ..], &[column, row, _, x, y, ..]) = (scale.as_slice(), tie.as_slice())
    else {
        return Err(refuse(
            "has too few numbers in its pixel scale or tie point".into(),
        ));
    };
    let is_good = width > 0.0 && (width - height).abs() <= SQUARE * width;
    if !(is_good && [column, row, x, y].iter().all(|v| v.is_finite())) {
        return Err(refuse(format!(
            "has pixels of {width} x {height}; resample it to square ones"
        )));
    }
    let keys = file
        .get_tag_u16_vec(Tag::GeoKeyDirectoryTag)
        .unwrap_or_default();
    let key = |wanted: u16| {
        let mut entries = keys.chunks_exact(4).skip(1);
        entries.find_map(|entry| (entry[0] == wanted && entry[1] == 0).then_some(entry[3]))
    };
    if key(MODEL_TYPE) == Some(GEOGRAPHIC) {
        return Err(refuse(
            "is in degrees; project it to meters, to UTM say".into(),
        ));
    }
    if let Some(unit) = key(LINEAR_UNITS)
        && unit != METRE
    {
        return Err(refuse(format!(
            "has a plan in units of EPSG {unit}, needed are meters (9001); project it"
        )));
    }
    let no_data = file
        .get_tag_ascii_string(Tag::GdalNodata)
        .ok()
        .and_then(|text| text.trim_matches(['\0', ' ']).parse::<f64>().ok());
    // the place of the center of the first pixel
    let half = if key(RASTER_TYPE) == Some(PIXEL_IS_POINT) {
        0.0
    } else {
        0.5
    };
    let west = x + (half - column) * width;
    let north = y - (half - row) * width;
    let (columns, rows) = (columns as usize, rows as usize);
    let from_north = numbers(file.read_image().map_err(unread)?)?;
    if from_north.len() != columns * rows {
        return Err(refuse(format!(
            "has {} numbers for {columns} x {rows} points; a raster of one band is needed",
            from_north.len()
        )));
    }
    let is_missing = |z: &f64| !z.is_finite() || no_data == Some(*z);
    let heights = from_north.chunks_exact(columns).rev().flatten();
    let heights = heights.map(|z| if is_missing(z) { f64::NAN } else { *z });
    Ok(Grid {
        n: [columns, rows],
        corner: [west, north - (rows - 1) as f64 * width],
        spacing: width,
        heights: heights.collect(),
    })
}

fn numbers(image: DecodingResult) -> Result<Vec<f64>, Fault> {
    fn widened<T: Into<f64>>(values: Vec<T>) -> Vec<f64> {
        values.into_iter().map(Into::into).collect()
    }
    Ok(match image {
        DecodingResult::U8(values) => widened(values),
        DecodingResult::U16(values) => widened(values),
        DecodingResult::U32(values) => widened(values),
        DecodingResult::I8(values) => widened(values),
        DecodingResult::I16(values) => widened(values),
        DecodingResult::I32(values) => widened(values),
        DecodingResult::F32(values) => widened(values),
        DecodingResult::F64(values) => values,
        _ => {
            return Err(Fault::Format(
                "has heights of an uncommon type; export them as 32-bit floats".into(),
            ));
        }
    })
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use tiff::encoder::{TiffEncoder, colortype::Gray32Float};

    /// Three columns and two rows of 10 m, its first pixel at (100, 220).
    fn file(keys: &[u16]) -> Vec<u8> {
        let mut content = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut content).unwrap();
        let mut image = encoder.new_image::<Gray32Float>(3, 2).unwrap();
        let tags = image.encoder();
        tags.write_tag(Tag::ModelPixelScaleTag, &[10.0, 10.0, 0.0][..])
            .unwrap();
        tags.write_tag(
            Tag::ModelTiepointTag,
            &[0.0, 0.0, 0.0, 100.0, 220.0, 0.0][..],
        )
        .unwrap();
        tags.write_tag(Tag::GeoKeyDirectoryTag, keys).unwrap();
        tags.write_tag(Tag::GdalNodata, "-9999").unwrap();
        image
            .write_data(&[5.0, 6.0, -9999.0, 1.0, 2.0, 3.0])
            .unwrap();
        content.into_inner()
    }

    #[test]
    fn pixels_are_areas_or_points() {
        let area = grid_from(&file(&[1, 1, 0, 1, RASTER_TYPE, 0, 1, 1])).unwrap();
        assert_eq!(
            (area.n, area.corner, area.spacing),
            ([3, 2], [105.0, 205.0], 10.0)
        );
        assert_eq!(area.heights[..5], [1.0, 2.0, 3.0, 5.0, 6.0]);
        assert!(area.heights[5].is_nan());
        let point = grid_from(&file(&[1, 1, 0, 1, RASTER_TYPE, 0, 1, PIXEL_IS_POINT])).unwrap();
        assert_eq!(point.corner, [100.0, 210.0]);
    }

    #[test]
    fn degrees_and_feet_are_refused() {
        let refused = |keys: &[u16]| grid_from(&file(keys)).unwrap_err().to_string();
        assert!(refused(&[1, 1, 0, 1, MODEL_TYPE, 0, 1, GEOGRAPHIC]).contains("in degrees"));
        assert!(refused(&[1, 1, 0, 1, LINEAR_UNITS, 0, 1, 9003]).contains("EPSG 9003"));
        assert!(
            grid_from(b"II*\0")
                .unwrap_err()
                .to_string()
                .contains("no GeoTIFF")
        );
    }
}
