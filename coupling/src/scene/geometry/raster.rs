//! Rasters of elevations, ESRI ASCII or GeoTIFF, and terrain directly from one.

mod ascii;

use std::sync::Arc;

use riprap_dda::{Shape, Surface, Vec3};

pub use ascii::grid_from;

use super::crs::{Content, Crs};
use super::geotiff;
use super::terrain::grid::{Grid, MapGrid};
use crate::scene::access::Access;
use crate::scene::access::fault::{Fault, MeshError};

/// Largest number of points of a grid; each takes 8 bytes.
const MOST_POINTS: usize = 50_000_000;
/// Largest number of points of a grid used directly as terrain; each makes two triangles.
const MOST_POINTS_OF_A_SHAPE: usize = 2_500_000;
/// Cells below this size make a raster within the range of longitude and latitude look like degrees.
const SMALL_CELL: f64 = 0.1;
/// Relief of terrain in meters over an extent in degrees: a kilometer of a valley is 0.01 degrees long. A bed in a
/// laboratory, the other raster of such cells, is longer than high; × extent.
const RELIEF_IN_DEGREES: f64 = 10.0;

/// Raster of a file that the scene names, in map coordinates. The reference system is that of a GeoTIFF, or of the
/// `.prj` file beside it.
///
/// # Errors
///
/// [`MeshError`], which names the file, the line and the remedy.
pub fn read(access: &Access, file: &str) -> Result<MapGrid, MeshError> {
    let of = |file: &str, fault| MeshError {
        file: file.to_owned(),
        fault,
    };
    let content = access.read(file).map_err(|fault| of(file, fault))?;
    let raster = raster_from(&content).map_err(|fault| of(file, fault))?;
    if raster.crs.is_some() {
        return Ok(raster);
    }
    let crs = Crs::beside(access, file)?;
    if let Some(crs) = &crs {
        let middle = raster.grid.middle();
        let check = crs.in_meters(Content::Raster, middle);
        check.map_err(|fault| of(file, fault))?;
    }
    Ok(MapGrid { crs, ..raster })
}

/// Raster in the content of a file, in map coordinates.
///
/// # Errors
///
/// [`Fault`].
pub fn raster_from(content: &[u8]) -> Result<MapGrid, Fault> {
    if geotiff::is_tiff(content) {
        return geotiff::raster_from(content);
    }
    Ok(MapGrid {
        grid: grid_from(content)?,
        crs: None,
    })
}

/// Check of elevations without a reference system, its heights already in meters: in degrees its relief is many times its
/// extent.
///
/// # Errors
///
/// [`Fault::Degrees`].
pub fn refuse_degrees(grid: &Grid, content: Content) -> Result<(), Fault> {
    let (low, high) = grid.range();
    let ([west, south], [east, north]) = (grid.corner, grid.far_corner());
    let is_on_earth = -360.0 <= west && east <= 360.0 && -90.0 <= south && north <= 90.0;
    let extent = (east - west).max(north - south);
    if is_on_earth && grid.spacing < SMALL_CELL && high - low > RELIEF_IN_DEGREES * extent {
        return Err(content.in_degrees(None, grid.middle()));
    }
    Ok(())
}

/// Terrain of a grid of elevations (m), with the map's `origin` (m) at x = y = 0. The points of the grid are the centers
/// of its cells; each square of four is halved along its shorter diagonal. Missing elevations make a hole.
///
/// # Errors
///
/// [`MeshError`], which names the file, the line and the remedy.
pub fn terrain(access: &Access, file: &str, origin: (f64, f64)) -> Result<Shape, MeshError> {
    let raster = read(access, file)?;
    of_grid(raster.grid, origin).map_err(|fault| MeshError {
        file: file.to_owned(),
        fault,
    })
}

/// The terrain of the content of a file, as [`terrain`].
///
/// # Errors
///
/// [`Fault`].
pub fn terrain_from(content: &[u8], origin: (f64, f64)) -> Result<Shape, Fault> {
    of_grid(raster_from(content)?.grid, origin)
}

fn of_grid(mut grid: Grid, origin: (f64, f64)) -> Result<Shape, Fault> {
    refuse_degrees(&grid, Content::Raster)?;
    grid.shift([-origin.0, -origin.1]);
    let surface = triangulate(&grid)?;
    Ok(Shape::Surface(Arc::new(surface)))
}

fn triangulate(grid: &Grid) -> Result<Surface, Fault> {
    let [columns, rows] = grid.n;
    if columns.saturating_mul(rows) > MOST_POINTS_OF_A_SHAPE {
        return Err(Fault::Format(format!(
            "has {columns} x {rows} points, more than {MOST_POINTS_OF_A_SHAPE}; use it as `terrain`, which resamples it"
        )));
    }
    // Numbered without the points that have no height.
    let mut number = vec![u32::MAX; grid.heights.len()];
    let mut vertices = Vec::new();
    for row in (0..rows).rev() {
        for column in 0..columns {
            let k = grid.index([column, row]);
            if grid.heights[k].is_finite() {
                number[k] = vertices.len() as u32;
                let [x, y] = grid.place([column, row]);
                vertices.push(Vec3::new(x, y, grid.heights[k]));
            }
        }
    }
    let mut triangles = Vec::new();
    for row in (0..rows - 1).rev() {
        for column in 0..columns - 1 {
            let south = grid.index([column, row]);
            let north = south + columns;
            // Counter-clockwise from above.
            let square = [south, south + 1, north + 1, north];
            if square.iter().any(|&k| number[k] == u32::MAX) {
                continue;
            }
            let [a, b, c, d] = square.map(|k| number[k]);
            let rise = |k: usize, l: usize| (grid.heights[k] - grid.heights[l]).abs();
            if rise(square[0], square[2]) <= rise(square[1], square[3]) {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    Surface::new(vertices, triangles).map_err(|error| Fault::Format(error.to_string()))
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    const GRID: &str = "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\nNODATA_value -1\n\
                        5 6 7\n1 2 3\n";

    #[test]
    fn rows_run_from_north_to_south() {
        let mut shifted = grid_from(GRID.as_bytes()).unwrap();
        shifted.shift([-100.0, -200.0]);
        let surface = triangulate(&shifted).unwrap();
        assert_eq!(surface.triangles().len(), 4);
        let height = |x: f64, y: f64| {
            let at = surface.vertices().iter().find(|v| v.x == x && v.y == y);
            at.map(|v| v.z)
        };
        assert_eq!(height(5.0, 15.0), Some(5.0));
        assert_eq!(height(25.0, 5.0), Some(3.0));
        // All look up.
        let above = Vec3::new(14.0, 9.0, 50.0);
        let found = surface.surface_point_within(&above, f64::INFINITY).unwrap();
        assert!(found.distance > 40.0);
    }

    #[test]
    fn missing_heights_leave_a_hole() {
        let grid = grid_from(GRID.replace("5 6 7", "-1 6 7").as_bytes()).unwrap();
        let surface = triangulate(&grid).unwrap();
        assert_eq!(
            (surface.triangles().len(), surface.vertices().len()),
            (2, 5)
        );
    }
}
