//! Elevations between scattered points, at the points of a grid.

use std::num::NonZero;

use rayon::prelude::*;
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::neighbors::Neighbors;
use super::plane::Plane;
use crate::scene::access::fault::Fault;
use crate::scene::geometry::terrain::grid::Grid;

/// Points whose plane continues the cloud beyond its rim.
const IN_PLANE: NonZero<usize> = NonZero::<usize>::MIN.saturating_add(8 - 1);
/// Tolerance of a point of the grid outside a triangle, so that none falls between two; × cell.
const ROUND_OFF: f64 = 1e-9;

struct Node([f64; 3]);

impl HasPosition for Node {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        Point2::new(self.0[0], self.0[1])
    }
}

/// Fills the heights of a grid, and returns the distances of its points from the nearest of the cloud; m.
///
/// Between the points heights are linear on the triangles of Delaunay. On a surface with second derivatives up to `M` they are
/// off by no more than `M R²/2`, `R` the radius of the circle through the corners (Waldron 1998). Beyond the triangles they
/// continue on the plane of the nearest points. Farther than `widest` (m) from any point there are none.
///
/// # Errors
///
/// [`Fault::Format`] for points that cannot be triangulated.
pub(super) fn interpolate(
    grid: &mut Grid,
    points: &[[f64; 3]],
    tree: &Neighbors<2>,
    widest: f64,
) -> Result<Vec<f64>, Fault> {
    let nodes = points.iter().map(|&p| Node(p)).collect();
    let net = DelaunayTriangulation::<Node>::bulk_load(nodes)
        .map_err(|error| Fault::Format(format!("cannot be triangulated: {error}")))?;
    grid.heights.fill(f64::NAN);
    for face in net.inner_faces() {
        fill_triangle(grid, face.vertices().map(|v| v.data().0));
    }
    let place = |k: usize| grid.place([k % grid.n[0], k / grid.n[0]]);
    let found: Vec<(f64, f64)> = (grid.heights.par_iter().enumerate())
        .map_init(Vec::new, |found, (k, &height)| {
            let at = place(k);
            let distance = tree.nearest(&at).distance;
            if widest < distance {
                return (f64::NAN, distance);
            }
            if height.is_finite() {
                return (height, distance);
            }
            tree.nearest_n(&at, IN_PLANE, found);
            let nearest: Vec<[f64; 3]> = found.iter().map(|n| points[n.index]).collect();
            let plane = Plane::through(&nearest);
            (plane.map_or(f64::NAN, |plane| plane.height(at)), distance)
        })
        .collect();
    let (heights, distances) = found.into_iter().unzip();
    grid.heights = heights;
    Ok(distances)
}

/// Heights of a triangle at the points of the grid within it, row by row.
fn fill_triangle(grid: &mut Grid, corners: [[f64; 3]; 3]) {
    // in cells from the corner of the grid
    let at = corners.map(|p| [0, 1].map(|axis| (p[axis] - grid.corner[axis]) / grid.spacing));
    let double_area = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    };
    let whole = double_area(at[0], at[1], at[2]);
    let range = |values: [f64; 3], n: usize| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let first = (low - ROUND_OFF).ceil().max(0.0);
        let last = (high + ROUND_OFF).floor().min(n as f64 - 1.0);
        (first <= last).then_some((first as usize, last as usize))
    };
    let Some((south, north)) = range(at.map(|p| p[1]), grid.n[1]) else {
        return;
    };
    for row in south..=north {
        let y = row as f64;
        // the sides that the row crosses, or touches
        let crossings = (0..3).flat_map(|k| {
            let (p, q) = (at[k], at[(k + 1) % 3]);
            let (low, high) = (p[1].min(q[1]), p[1].max(q[1]));
            let is_crossed = low - ROUND_OFF <= y && y <= high + ROUND_OFF;
            let share = if high - low > ROUND_OFF {
                [((y - p[1]) / (q[1] - p[1])).clamp(0.0, 1.0); 2]
            } else {
                [0.0, 1.0]
            };
            let x = share.map(|s| p[0] + s * (q[0] - p[0]));
            is_crossed.then_some(x).into_iter().flatten()
        });
        let (low, high) = crossings.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        let first = (low - ROUND_OFF).ceil().max(0.0);
        let last = (high + ROUND_OFF).floor().min(grid.n[0] as f64 - 1.0);
        if !(first <= last) {
            continue;
        }
        for column in first as usize..=last as usize {
            let k = grid.index([column, row]);
            if grid.heights[k].is_finite() {
                continue;
            }
            let x = [column as f64, y];
            let weights = [(1, 2), (2, 0), (0, 1)]
                .map(|(p, q)| (double_area(x, at[p], at[q]) / whole).max(0.0));
            let sum: f64 = weights.iter().sum();
            let height: f64 = (0..3).map(|k| weights[k] * corners[k][2]).sum();
            grid.heights[k] = height / sum;
        }
    }
}
