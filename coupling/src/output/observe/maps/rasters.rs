//! Maps for geographic information systems: ESRI grids and GeoTIFF files.

use std::fmt::Write as _;
use std::path::Path;

use crate::files::vtk::replace_file;
use crate::output::observe::ObserveError;
use crate::scene::geotiff;
use crate::scene::terrain::grid::MapGrid;

/// Missing value in ASCII grids.
const NO_DATA: f64 = -9999.0;

/// Writes a map as an ASCII grid under its name, and beside it as GeoTIFF (`.tif`) and with the text of its reference system
/// (`.prj`) if that is known.
///
/// # Errors
///
/// [`ObserveError`] names the file.
pub(crate) fn write(path: &Path, map: &MapGrid) -> Result<(), ObserveError> {
    replace_file(path, &[ascii(map).as_bytes()])?;
    let image = path.with_extension("tif");
    let content = geotiff::written(map).map_err(|error| ObserveError::Write {
        path: image.display().to_string(),
        source: std::io::Error::other(error),
    })?;
    replace_file(&image, &[&content])?;
    if let Some(crs) = &map.crs {
        replace_file(&path.with_extension("prj"), &[crs.wkt.as_bytes()])?;
    }
    Ok(())
}

/// An ESRI grid, rows from the north.
fn ascii(map: &MapGrid) -> String {
    let grid = &map.grid;
    let mut text = format!(
        "ncols {}\nnrows {}\nxllcenter {:?}\nyllcenter {:?}\ncellsize {:?}\nNODATA_value {NO_DATA}\n",
        grid.n[0], grid.n[1], grid.corner[0], grid.corner[1], grid.spacing,
    );
    for row in grid.heights.chunks_exact(grid.n[0]).rev() {
        for (k, value) in row.iter().enumerate() {
            let gap = if k == 0 { "" } else { " " };
            let value = if value.is_finite() { *value } else { NO_DATA };
            // writing to a string does not fail
            let _ = write!(text, "{gap}{value:.3}");
        }
        text.push('\n');
    }
    text
}
