//! Comparison of two surfaces over the area that both cover: differences of height, distances both ways, volumes.

mod load;
mod nearest;
mod report;

use serde::Serialize;

use crate::messages::{Code, Coded};
use crate::scene::geometry::terrain::grid::Grid;
use crate::scene::geometry::terrain::sources::Source;

pub use load::load;
pub use report::{json, table, text};

/// Most points of the lattice.
const MOST_POINTS: f64 = 4e6;
/// Points across surfaces of triangles, which have no cells.
const POINTS_ACROSS: f64 = 400.0;
/// Tolerance of round-off at the rim; × cell.
const ROUND_OFF: f64 = 1e-6;
/// Share of the points of the stated quantile; –.
const MOST: f64 = 0.95;

/// Two surfaces, compared. The first minus the second.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceComparison {
    /// Area that both cover; m².
    pub area: f64,
    /// Spacing of the points of comparison; m.
    pub cell: f64,
    /// Number of these.
    pub n_points: usize,
    /// Differences of height; m.
    pub height: Differences,
    /// Volume of the first above the second; m³.
    pub fill: f64,
    /// Volume of the second above the first; m³.
    pub cut: f64,
    /// Distances of the points of the first to the nearest of the second surface; m.
    pub to_second: Distances,
    /// Distances of the points of the second to the nearest of the first surface; m.
    pub to_first: Distances,
    /// The largest of these distances, that of Hausdorff; m.
    pub hausdorff: f64,
}

/// Signed differences, their mean and root mean square over the area.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Differences {
    /// m.
    pub mean: f64,
    /// m.
    pub rms: f64,
    /// Absolute value that 95 % of the points do not exceed; m.
    pub most: f64,
    /// Largest absolute value at the points; m.
    pub largest: f64,
}

/// Distances at the points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distances {
    /// m.
    pub mean: f64,
    /// m.
    pub rms: f64,
    /// That 95 % of the points do not exceed; m.
    pub most: f64,
    /// m.
    pub largest: f64,
}

/// Reason why two surfaces cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum SurfaceError {
    /// A file cannot be read, or is no surface.
    #[error("{0}")]
    Unreadable(String),
    /// Two reference systems.
    #[error("`{first}` is in {of_first}, `{second}` in {of_second}; project one of them")]
    Systems {
        /// The first file.
        first: String,
        /// Its system.
        of_first: String,
        /// The second file.
        second: String,
        /// Its system.
        of_second: String,
    },
    /// Nothing in common.
    #[error(
        "no area is covered by both: `{first}` goes from ({:.2}, {:.2}) to ({:.2}, {:.2}), `{second}` from ({:.2}, {:.2}) to ({:.2}, {:.2})",
        of_first[0][0], of_first[0][1], of_first[1][0], of_first[1][1],
        of_second[0][0], of_second[0][1], of_second[1][0], of_second[1][1]
    )]
    Apart {
        /// The first file.
        first: String,
        /// Its smallest and largest x and y; m.
        of_first: [[f64; 2]; 2],
        /// The second file.
        second: String,
        /// Its smallest and largest x and y; m.
        of_second: [[f64; 2]; 2],
    },
    /// Too many points.
    #[error(
        "{n:.0} points of comparison are more than {MOST_POINTS:.0}; raise --cell above {cell} m"
    )]
    TooFine {
        /// Number of points.
        n: f64,
        /// Their spacing; m.
        cell: f64,
    },
}

/// Compares two surfaces at points `cell` (m) apart, or as far as those of the coarser. Exchanged surfaces give the same figures
/// with the sign of the differences reversed, cut for fill, and one way for the other.
///
/// Between the points both surfaces are linear on the same triangles; mean, root mean square and volumes are exact for these.
///
/// # Errors
///
/// [`SurfaceError`].
pub fn compare_surfaces(
    first: &Source,
    second: &Source,
    cell: Option<f64>,
) -> Result<SurfaceComparison, SurfaceError> {
    if let (Some(a), Some(b)) = (&first.crs, &second.crs)
        && !a.agrees_with(b)
    {
        return Err(SurfaceError::Systems {
            first: first.file.clone(),
            of_first: a.to_string(),
            second: second.file.clone(),
            of_second: b.to_string(),
        });
    }
    let apart = || SurfaceError::Apart {
        first: first.file.clone(),
        of_first: first.extent(),
        second: second.file.clone(),
        of_second: second.extent(),
    };
    let lattice = lattice(first, second, cell)?.ok_or_else(apart)?;
    let mut grids = [first, second].map(|source| {
        let heights = lattice
            .points()
            .map(|point| source.height(lattice.place(point)));
        Grid {
            heights: heights.map(|z| z.unwrap_or(f64::NAN)).collect(),
            ..lattice.clone()
        }
    });
    let squares = common_squares(&mut grids);
    if squares.is_empty() {
        return Err(apart());
    }
    let [a, b] = &grids;
    let integrals = Integrals::over(a, b, &squares);
    let known: Vec<usize> = (0..a.heights.len())
        .filter(|&k| a.heights[k].is_finite())
        .collect();
    let sizes = known.iter().map(|&k| (a.heights[k] - b.heights[k]).abs());
    let (most, largest) = quantiles(sizes.collect());
    let [to_second, to_first] = [(a, b), (b, a)].map(|(from, to)| {
        let distances = nearest::distances(from, to, &known, &squares);
        let n = distances.len() as f64;
        let mean = distances.iter().sum::<f64>() / n;
        let rms = (distances.iter().map(|d| d * d).sum::<f64>() / n).sqrt();
        let (most, largest) = quantiles(distances);
        Distances {
            mean,
            rms,
            most,
            largest,
        }
    });
    Ok(SurfaceComparison {
        area: integrals.area,
        cell: lattice.spacing,
        n_points: known.len(),
        height: Differences {
            mean: (integrals.above - integrals.below) / integrals.area,
            rms: (integrals.square / integrals.area).sqrt(),
            most,
            largest,
        },
        fill: integrals.above,
        cut: integrals.below,
        to_second,
        to_first,
        hausdorff: f64::max(to_second.largest, to_first.largest),
    })
}

/// The 95 % quantile and the largest of some numbers.
fn quantiles(mut values: Vec<f64>) -> (f64, f64) {
    let largest = values.iter().copied().fold(0.0, f64::max);
    let k = (MOST * (values.len().max(1) - 1) as f64).round() as usize;
    match values.get(k) {
        Some(_) => (*values.select_nth_unstable_by(k, f64::total_cmp).1, largest),
        None => (0.0, largest),
    }
}

/// Points in the extent that both have, on those of the coarser; `None` without two each way.
fn lattice(
    first: &Source,
    second: &Source,
    cell: Option<f64>,
) -> Result<Option<Grid>, SurfaceError> {
    let extents = [first.extent(), second.extent()];
    let low = [0, 1].map(|axis| f64::max(extents[0][0][axis], extents[1][0][axis]));
    let high = [0, 1].map(|axis| f64::min(extents[0][1][axis], extents[1][1][axis]));
    let spacings = [first.spacing(), second.spacing()];
    let coarser = spacings.iter().flatten().copied().fold(0.0, f64::max);
    let across = f64::max(high[0] - low[0], high[1] - low[1]) / POINTS_ACROSS;
    let cell = cell.unwrap_or(if coarser > 0.0 { coarser } else { across });
    // of two grids of one spacing that of the lesser corner, whichever is the first
    let mut corners: Vec<[f64; 2]> = (0..2)
        .filter(|&k| spacings[k] == Some(coarser))
        .map(|k| extents[k][0])
        .collect();
    corners.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let anchor = corners.first().copied().unwrap_or(low);
    let start = [0, 1].map(|axis| ((low[axis] - anchor[axis]) / cell - ROUND_OFF).ceil());
    let corner = [0, 1].map(|axis| anchor[axis] + start[axis] * cell);
    let count = [0, 1].map(|axis| ((high[axis] - corner[axis]) / cell + ROUND_OFF).floor() + 1.0);
    if !(count[0] >= 2.0 && count[1] >= 2.0) {
        return Ok(None);
    }
    let n = count[0] * count[1];
    if n > MOST_POINTS {
        return Err(SurfaceError::TooFine { n, cell });
    }
    let n = count.map(|count| count as usize);
    Ok(Some(Grid {
        n,
        corner,
        spacing: cell,
        heights: Vec::new(),
    }))
}

/// Southwestern corners of the squares that both have; other points lose their heights.
fn common_squares(grids: &mut [Grid; 2]) -> Vec<usize> {
    let [columns, rows] = grids[0].n;
    let is_known = |k: usize| grids.iter().all(|grid| grid.heights[k].is_finite());
    let south_west = (0..rows - 1).flat_map(|j| (0..columns - 1).map(move |i| j * columns + i));
    let squares: Vec<usize> = south_west
        .filter(|&k| corners_of(k, columns).into_iter().all(is_known))
        .collect();
    let mut is_used = vec![false; columns * rows];
    for k in squares.iter().flat_map(|&k| corners_of(k, columns)) {
        is_used[k] = true;
    }
    for grid in grids {
        for (height, is_used) in grid.heights.iter_mut().zip(&is_used) {
            if !is_used {
                *height = f64::NAN;
            }
        }
    }
    squares
}

/// Points of a square counter-clockwise from the southwest.
fn corners_of(k: usize, columns: usize) -> [usize; 4] {
    [k, k + 1, k + columns + 1, k + columns]
}

/// The triangles of a square.
fn halves_of(k: usize, columns: usize) -> [[usize; 3]; 2] {
    let [a, b, c, d] = corners_of(k, columns);
    [[a, b, c], [a, c, d]]
}

/// Integrals of the difference of two surfaces.
#[derive(Default)]
struct Integrals {
    /// m².
    area: f64,
    /// Of its positive part; m³.
    above: f64,
    /// Of its negative part, positive; m³.
    below: f64,
    /// Of its square; m⁴.
    square: f64,
}

impl Integrals {
    /// Over squares, triangle by triangle.
    ///
    /// ```text
    /// ∫ d dA = A (d₁ + d₂ + d₃)/3,   ∫ d² dA = A (d₁² + d₂² + d₃² + d₁d₂ + d₂d₃ + d₃d₁)/6
    /// ```
    fn over(a: &Grid, b: &Grid, squares: &[usize]) -> Self {
        let area = 0.5 * a.spacing * a.spacing;
        let mut sum = Self::default();
        for t in squares.iter().flat_map(|&k| halves_of(k, a.n[0])) {
            let d = t.map(|k| a.heights[k] - b.heights[k]);
            let whole = area * (d[0] + d[1] + d[2]) / 3.0;
            let above = area * positive_part(d);
            sum.area += area;
            sum.above += above;
            sum.below += above - whole;
            let products = d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
            sum.square += area * (d.iter().map(|d| d * d).sum::<f64>() + products) / 6.0;
        }
        sum
    }
}

/// Mean of the positive part of what is linear on a triangle.
///
/// ```text
/// d₁ > 0 ≥ d₂, d₃:  d₁³ / (3 (d₁ − d₂)(d₁ − d₃))
/// ```
fn positive_part(d: [f64; 3]) -> f64 {
    let mut d = d;
    d.sort_by(f64::total_cmp);
    let [low, middle, high] = d;
    let tip = |x: f64, y: f64, z: f64| x * x * x / (3.0 * (x - y) * (x - z));
    if low >= 0.0 {
        (low + middle + high) / 3.0
    } else if high <= 0.0 {
        0.0
    } else if middle <= 0.0 {
        tip(high, middle, low)
    } else {
        (low + middle + high) / 3.0 + tip(-low, -middle, -high)
    }
}

impl Coded for SurfaceError {
    fn code(&self) -> Code {
        match self {
            Self::Unreadable(_) => Code::FileNotReadable,
            Self::Systems { .. } => Code::UnusableMapSystem,
            Self::Apart { .. } => Code::NothingToCompare,
            Self::TooFine { .. } => Code::UnusableArgument,
        }
    }
}
