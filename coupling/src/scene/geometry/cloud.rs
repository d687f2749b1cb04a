//! Clouds of scattered points: as terrain, with their outliers left out and their gaps known.

mod las;
pub mod neighbors;
mod outliers;
mod plane;
mod report;
mod surface;

use std::num::NonZero;

use rayon::prelude::*;

use super::crs::{Content, Crs};
use super::terrain::grid::{Grid, MapGrid};
use crate::files::points::cloud_from;
use crate::scene::access::Access;
use crate::scene::access::fault::{Fault, MeshError};
use neighbors::Neighbors;
pub use report::{CloudReport, Gap, Steps};

/// Largest number of points of a cloud; each takes 150 bytes.
const MOST_POINTS: usize = 20_000_000;
/// Largest number of points of a grid; each takes 16 bytes.
const MOST_CELLS: f64 = 50e6;
/// Of these, for each point of a cloud, and in any case: a few stray points far away make an extent of nothing but gaps.
const MOST_CELLS_A_POINT: f64 = 100.0;
const CELLS_OF_FEW: f64 = 1e6;
/// Neighbors of a point in the mean that is its spacing: on a square lattice all are one spacing away.
const FOR_SPACING: NonZero<usize> = NonZero::<usize>::MIN.saturating_add(4 - 1);
/// Farthest that a place with an elevation is from a point; × spacing. Among points strewn at random one place of 10⁸ is
/// farther.
const WIDEST_GAP: f64 = 3.0;
/// Width of a cloud that counts as a line; × length.
const ON_A_LINE: f64 = 1e-6;
/// Largest coordinate; m. The earth is 4e7 m around.
const FARTHEST: f64 = 1e9;
/// Difference of heights at one place that is told; × spacing.
const STEP: f64 = 0.1;
/// Tolerance of round-off at the edge of a grid; × cell.
const ROUND_OFF: f64 = 1e-6;

/// Scattered points with their reference system.
#[derive(Clone, Debug, PartialEq)]
pub struct Cloud {
    /// Points in map coordinates, in the order of the file; m.
    pub points: Vec<[f64; 3]>,
    /// Number of points that the file has, those included that are not of the ground.
    pub n_in_file: usize,
    /// Reference system of the map, if known.
    pub crs: Option<Crs>,
}

/// Extension of a file, in lower case, that names a cloud.
pub fn is_cloud(extension: &str, content: impl FnOnce() -> Option<Vec<u8>>) -> bool {
    match extension {
        "xyz" | "csv" | "las" | "laz" => true,
        // of a raster or of a cloud
        "txt" => content().is_some_and(|content| !starts_like_a_raster(&content)),
        _ => false,
    }
}

/// True for the header of an ESRI ASCII grid.
fn starts_like_a_raster(content: &[u8]) -> bool {
    let start = String::from_utf8_lossy(&content[..content.len().min(200)]).to_lowercase();
    let word = start.split_whitespace().next().unwrap_or_default();
    let of_rasters = ["ncols", "nrows", "xll", "yll", "cellsize", "nodata_value"];
    of_rasters.iter().any(|key| word.starts_with(key))
}

/// Cloud of a file that the scene names, in map coordinates. Of a LAS file with classes the points of the ground are taken.
/// The reference system is that of the file, or of the `.prj` file beside it.
///
/// # Errors
///
/// [`MeshError`], which names the file, the line and the remedy.
pub fn read(access: &Access, file: &str) -> Result<Cloud, MeshError> {
    let of = |fault| MeshError {
        file: file.to_owned(),
        fault,
    };
    let content = access.read(file).map_err(of)?;
    let mut cloud = cloud_of(&content).map_err(of)?;
    if cloud.crs.is_none() {
        cloud.crs = Crs::beside(access, file)?;
    }
    if let Some(crs) = &cloud.crs {
        let middle = cloud.middle();
        crs.in_meters(Content::Cloud, middle).map_err(of)?;
    }
    Ok(cloud)
}

/// Cloud in the content of a file: LAS, LAZ, or a table.
///
/// # Errors
///
/// [`Fault`].
pub fn cloud_of(content: &[u8]) -> Result<Cloud, Fault> {
    let cloud = if las::is_las(content) {
        las::cloud_of(content)?
    } else {
        let points = cloud_from(&String::from_utf8_lossy(content));
        let points = points.map_err(|fault| Fault::Format(fault.to_string()))?;
        Cloud {
            n_in_file: points.len(),
            points,
            crs: None,
        }
    };
    if cloud.points.len() > MOST_POINTS {
        let n = cloud.points.len();
        return Err(Fault::Format(format!(
            "has {n} points, more than {MOST_POINTS}; thin it"
        )));
    }
    Ok(cloud)
}

impl Cloud {
    fn middle(&self) -> [f64; 2] {
        let (low, high) = extent(&self.points);
        [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]))
    }

    /// Elevations at the points of a grid from the southwestern corner of the cloud, `cell` (m) apart, or by its spacing. Outliers
    /// are left out; places far from any point have no elevation. Any order of the points gives the same bits.
    ///
    /// # Errors
    ///
    /// [`Fault::Format`] for clouds that make no surface, or too large a grid.
    pub fn grid(&self, cell: Option<f64>) -> Result<(MapGrid, CloudReport), Fault> {
        if let Some(far) = (self.points.iter().flatten()).find(|value| !(value.abs() < FARTHEST)) {
            return Err(Fault::Format(format!(
                "has a coordinate of {far} m, beyond any map; export it again"
            )));
        }
        let (points, heights_apart) = one_a_place(&self.points);
        refuse_lines(&points)?;
        let (low, _) = extent(&points);
        // about the corner, where differences lose no digits
        let near: Vec<[f64; 3]> = (points.iter())
            .map(|p| [p[0] - low[0], p[1] - low[1], p[2]])
            .collect();
        let tree = tree_of(&near)?;
        let (spacing, widest_spacing) = spacings(&tree);
        let is_outlier = outliers::outliers(&near, &tree, spacing);
        let outliers: Vec<[f64; 3]> = (points.iter().zip(&is_outlier))
            .filter_map(|(p, is_outlier)| is_outlier.then_some(*p))
            .collect();
        let kept: Vec<[f64; 3]> = (near.iter().zip(&is_outlier))
            .filter_map(|(p, is_outlier)| (!is_outlier).then_some(*p))
            .collect();
        let tree = if outliers.is_empty() {
            tree
        } else {
            tree_of(&kept)?
        };
        let mut grid = lattice(&kept, cell.unwrap_or_else(|| rounded(spacing)))?;
        let widest = WIDEST_GAP * spacing.max(grid.spacing / WIDEST_GAP);
        let distances = surface::interpolate(&mut grid, &kept, &tree, widest)?;
        let report = CloudReport {
            n_in_file: self.n_in_file,
            n_points: self.points.len(),
            spacing,
            widest_spacing,
            outliers,
            steps: Steps::of(&heights_apart, STEP * spacing),
            widest_gap: widest,
            n_gaps: distances.iter().filter(|d| widest < **d).count(),
            gap: Gap::of(&grid, &distances, [low[0], low[1]]),
            within: [1.0, 2.0].map(|n| {
                let near = distances.iter().filter(|d| **d <= n * spacing);
                near.count() as f64 / distances.len() as f64
            }),
        };
        grid.shift([low[0], low[1]]);
        let grid = MapGrid {
            grid,
            crs: self.crs.clone(),
        };
        Ok((grid, report))
    }
}

fn tree_of(points: &[[f64; 3]]) -> Result<Neighbors<2>, Fault> {
    Neighbors::of(points.iter().map(|p| [p[0], p[1]]).collect())
        .ok_or_else(|| Fault::Format("has no points; export it again".into()))
}

/// Lowest and highest coordinates; m.
fn extent(points: &[[f64; 3]]) -> ([f64; 3], [f64; 3]) {
    points.iter().fold(
        ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]),
        |(low, high), p| {
            (
                [0, 1, 2].map(|axis| f64::min(low[axis], p[axis])),
                [0, 1, 2].map(|axis| f64::max(high[axis], p[axis])),
            )
        },
    )
}

/// Points at distinct places from west to east, with the median of the heights where there are several; and those places with
/// the difference of their heights (m) instead.
fn one_a_place(points: &[[f64; 3]]) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let mut sorted = points.to_vec();
    sorted.par_sort_unstable_by(|a, b| {
        let by = |axis: usize| a[axis].total_cmp(&b[axis]);
        by(0).then(by(1)).then(by(2))
    });
    let (mut places, mut apart) = (Vec::with_capacity(sorted.len()), Vec::new());
    for here in sorted.chunk_by(|a, b| a[0] == b[0] && a[1] == b[1]) {
        let [x, y, lowest] = here[0];
        let half = here.len() / 2;
        let median = if here.len() % 2 == 0 {
            0.5 * (here[half - 1][2] + here[half][2])
        } else {
            here[half][2]
        };
        places.push([x, y, median]);
        if here.len() > 1 {
            apart.push([x, y, here[here.len() - 1][2] - lowest]);
        }
    }
    (places, apart)
}

/// Check of points at distinct places, from west to east.
fn refuse_lines(points: &[[f64; 3]]) -> Result<(), Fault> {
    let refuse = |what: String| Err(Fault::Format(what));
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return refuse("has no points; export it again".into());
    };
    let n = points.len();
    if n < 3 {
        return refuse(format!(
            "has points at {n} places; terrain needs three that are not on a line"
        ));
    }
    let (dx, dy) = (last[0] - first[0], last[1] - first[1]);
    let (low, high) = extent(points);
    let length = (high[0] - low[0]).hypot(high[1] - low[1]);
    let along = dx.hypot(dy);
    let across = |p: &[f64; 3]| ((p[0] - first[0]) * dy - (p[1] - first[1]) * dx) / along;
    let (least, most) = points
        .iter()
        .map(across)
        .fold((0.0, 0.0), |(a, b), d| (f64::min(a, d), f64::max(b, d)));
    if most - least < ON_A_LINE * length {
        return refuse(format!(
            "has all points on a line, from ({:.2}, {:.2}) to ({:.2}, {:.2}); terrain needs points on both sides of it",
            first[0], first[1], last[0], last[1]
        ));
    }
    Ok(())
}

/// Median and 95 % of the spacings of points; m.
fn spacings(tree: &Neighbors<2>) -> (f64, f64) {
    let mut all: Vec<f64> = (tree.points().par_iter())
        .map_init(Vec::new, |found, place| {
            // the nearest is the point itself
            tree.nearest_n(place, FOR_SPACING.saturating_add(1), found);
            let others = found.len().max(2) - 1;
            found.iter().map(|n| n.distance).sum::<f64>() / others as f64
        })
        .collect();
    let mut quantile = |share: f64| {
        let k = (share * (all.len() - 1) as f64).round() as usize;
        *all.select_nth_unstable_by(k, f64::total_cmp).1
    };
    (quantile(0.5), quantile(0.95))
}

/// To two digits; m.
fn rounded(spacing: f64) -> f64 {
    let text = format!("{spacing:.1e}");
    text.parse().unwrap_or(spacing)
}

/// Grid over the points, without heights.
fn lattice(points: &[[f64; 3]], cell: f64) -> Result<Grid, Fault> {
    let (low, high) = extent(points);
    let count = |axis: usize| ((high[axis] - low[axis]) / cell + ROUND_OFF).floor() + 1.0;
    let [columns, rows] = [count(0), count(1)];
    if !(columns >= 2.0 && rows >= 2.0) {
        return Err(Fault::Format(format!(
            "is {} x {} m, and cells of {cell} m make {columns} x {rows} points, needed are two each way; lower `cell`",
            high[0] - low[0],
            high[1] - low[1]
        )));
    }
    let most = (MOST_CELLS_A_POINT * points.len() as f64).clamp(CELLS_OF_FEW, MOST_CELLS);
    if columns * rows > most {
        return Err(Fault::Format(format!(
            "covers {:.0} x {:.0} m, at cells of {cell} m {columns} x {rows} points, more than {most:.0} for {} points; raise `cell`, or remove points far from the others",
            high[0] - low[0],
            high[1] - low[1],
            points.len()
        )));
    }
    let n = [columns as usize, rows as usize];
    Ok(Grid {
        n,
        corner: [low[0], low[1]],
        spacing: cell,
        heights: vec![f64::NAN; n[0] * n[1]],
    })
}
