//! Plausibility of terrain: feet or degrees instead of meters, elevations beyond any on earth.

use super::grid::Grid;
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::TerrainFile;

/// Median slope that is rarely exceeded; degrees. Elevations in feet read as meters make 67 of 35.
const STEEP_MEDIAN_DEG: f64 = 50.0;
/// Elevation of the deepest trench and of the highest mountain; m.
const LOWEST: f64 = -11_000.0;
const HIGHEST: f64 = 9_000.0;
/// One foot; m.
const FOOT: f64 = 0.3048;
/// Tolerance of a whole number of meters; –.
const SAME_LENGTH: f64 = 1e-5;
/// Spacing below which coordinates within the range of longitude and latitude look like degrees.
const SMALL_CELL: f64 = 0.02;

/// Warnings about the elevations of a scene.
pub(super) fn warnings(grid: &Grid, file: &TerrainFile) -> Vec<Problem> {
    let mut found = Vec::new();
    let mut ask = |what: String| {
        found.push(Problem::warning(
            Code::SuspiciousTerrain,
            "terrain.sources",
            what,
        ))
    };
    let [west, south] = [
        grid.corner[0] + file.origin.0,
        grid.corner[1] + file.origin.1,
    ];
    if grid.spacing < SMALL_CELL
        && (-180.0..=360.0).contains(&west)
        && (-90.0..=90.0).contains(&south)
    {
        ask(format!(
            "points are {} apart about ({west}, {south}): are these degrees of longitude and latitude? Terrain is in meters: project it, \
             to UTM say",
            grid.spacing
        ));
    }
    let in_feet = grid.spacing * FOOT;
    let is_whole = |length: f64| {
        length.round() >= 1.0 && (length - length.round()).abs() <= SAME_LENGTH * length
    };
    if is_whole(in_feet) && !is_whole(grid.spacing) {
        ask(format!(
            "points are {} apart, {in_feet:.0} m in feet: is the plan in feet? Terrain is in meters",
            grid.spacing
        ));
    }
    let (low, high) = grid.range();
    let (low, high) = (low + file.origin.2, high + file.origin.2);
    if low < LOWEST || HIGHEST < high {
        ask(format!(
            "heights go from {low:.0} to {high:.0} m, beyond any on earth: are they in feet (`height_scale: 0.3048`), or is a number \
             for missing heights not declared as NODATA_value?"
        ));
    }
    let slope = median_slope_deg(grid);
    if STEEP_MEDIAN_DEG < slope {
        ask(format!(
            "half of the terrain is steeper than {slope:.0} degrees: are heights in feet (`height_scale: 0.3048`) and the plan in meters?"
        ));
    }
    found
}

/// The slope that half of the squares are steeper than; degrees.
fn median_slope_deg(grid: &Grid) -> f64 {
    let mut slopes: Vec<f64> = grid
        .points()
        .filter(|[i, j]| i + 1 < grid.n[0] && j + 1 < grid.n[1])
        .map(|[i, j]| {
            let z = |point| grid.heights[grid.index(point)];
            let (here, east, north) = (z([i, j]), z([i + 1, j]), z([i, j + 1]));
            (east - here).hypot(north - here) / grid.spacing
        })
        .collect();
    let middle = slopes.len() / 2;
    let (_, median, _) = slopes.select_nth_unstable_by(middle, f64::total_cmp);
    median.atan().to_degrees()
}
