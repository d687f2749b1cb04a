//! Points far from the plane of their neighbors: birds, dust, multiple echoes, typing errors.

use std::num::NonZero;

use rayon::prelude::*;

use super::neighbors::{Neighbor, Neighbors};
use super::plane::Plane;

/// Points that a plane is put through: two rings of a lattice.
const IN_PLANE: NonZero<usize> = NonZero::<usize>::MIN.saturating_add(12 - 1);
/// Distance from the plane of an outlier; × the standard deviation of the distances of its neighbors, or of all points where
/// that is more. With a normal distribution one point of 10¹⁵ is beyond.
const FAR: f64 = 8.0;
/// Standard deviation over the median of the absolute value of a normal distribution; –.
const DEVIATION_OF_MEDIAN: f64 = 1.4826;
/// Distance from the plane that no outlier is within; × spacing.
const NOT_FAR: f64 = 0.1;
/// Neighbors at least half as far off on the same side that make a point one of a crest, a wall or an edge.
const LEAST_OF_A_CREST: usize = 2;

/// Distance of a point from the plane of its neighbors.
#[derive(Clone, Copy)]
struct Distance {
    /// m.
    own: f64,
    /// Standard deviation of those of the neighbors; m.
    beside: f64,
    is_supported: bool,
}

/// Whether each point is an outlier. `spacing` (m) is that of the cloud.
pub(super) fn outliers(points: &[[f64; 3]], tree: &Neighbors<2>, spacing: f64) -> Vec<bool> {
    let distances: Vec<Distance> = (0..points.len())
        .into_par_iter()
        .map_init(Vec::new, |found, k| distance(points, tree, k, found))
        .collect();
    let mut all: Vec<f64> = distances.iter().map(|d| d.own.abs()).collect();
    let middle = all.len() / 2;
    let (_, median, _) = all.select_nth_unstable_by(middle, f64::total_cmp);
    let of_all = DEVIATION_OF_MEDIAN * *median;
    let is_outlier = |d: &Distance| {
        let near = f64::max(NOT_FAR * spacing, FAR * of_all.max(d.beside));
        near < d.own.abs() && !d.is_supported
    };
    distances.iter().map(is_outlier).collect()
}

fn distance(
    points: &[[f64; 3]],
    tree: &Neighbors<2>,
    k: usize,
    found: &mut Vec<Neighbor>,
) -> Distance {
    let [x, y, z] = points[k];
    tree.nearest_n(&[x, y], IN_PLANE.saturating_add(1), found);
    let others = found.iter().filter(|neighbor| neighbor.index != k);
    let others: Vec<[f64; 3]> = others.map(|neighbor| points[neighbor.index]).collect();
    let none = Distance {
        own: 0.0,
        beside: 0.0,
        is_supported: true,
    };
    let Some(plane) = Plane::trimmed(&others) else {
        return none;
    };
    let own = z - plane.height([x, y]);
    let beside: Vec<f64> = (others.iter())
        .map(|p| p[2] - plane.height([p[0], p[1]]))
        .collect();
    let supports = beside.iter().filter(|d| *d * own > 0.5 * own * own);
    let is_supported = supports.count() >= LEAST_OF_A_CREST;
    let mut sizes: Vec<f64> = beside.iter().map(|d| d.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    Distance {
        own,
        beside: DEVIATION_OF_MEDIAN * sizes[sizes.len() / 2],
        is_supported,
    }
}
