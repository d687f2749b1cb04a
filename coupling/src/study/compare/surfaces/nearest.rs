//! Distances of points from a surface of triangles.

use std::num::NonZero;

use rayon::prelude::*;
use riprap_dda::Vec3;

use super::halves_of;
use crate::scene::geometry::cloud::neighbors::{Neighbor, Neighbors};
use crate::scene::geometry::terrain::grid::Grid;

/// Corners that are asked for at first.
const AT_FIRST: NonZero<usize> = NonZero::<usize>::MIN.saturating_add(8 - 1);
/// Distance of a point of a triangle from its nearest corner, at most; × longest side: the center of an equilateral one.
const COVER: f64 = 0.577_350_269_189_626;

/// Distance of each of the points `known` of one grid from the triangles of another over some squares; m.
///
/// The corners come nearest first: a triangle that none of the first `n` belongs to is farther than the `n`-th corner less the
/// cover of the largest triangle, so that the search ends there.
pub(super) fn distances(from: &Grid, to: &Grid, known: &[usize], squares: &[usize]) -> Vec<f64> {
    let columns = to.n[0];
    let corner = |grid: &Grid, k: usize| {
        let [i, j] = [k % columns, k / columns].map(|n| n as f64 * grid.spacing);
        [i, j, grid.heights[k]]
    };
    let vector = |k: usize| Vec3::from(corner(to, k));
    let Some(tree) = Neighbors::of(known.iter().map(|&k| corner(to, k)).collect()) else {
        return Vec::new();
    };
    let mut is_square = vec![false; from.heights.len()];
    let mut longest = 0.0_f64;
    for &k in squares {
        is_square[k] = true;
        for [a, b, c] in halves_of(k, columns).map(|t| t.map(vector)) {
            longest = longest
                .max((b - a).norm())
                .max((c - b).norm())
                .max((a - c).norm());
        }
    }
    let cover = COVER * longest;
    let around = |k: usize| {
        let beside = [
            Some(k),
            k.checked_sub(1),
            k.checked_sub(columns),
            k.checked_sub(columns + 1),
        ];
        let squares = beside.into_iter().flatten().filter(|&s| is_square[s]);
        squares
            .flat_map(|s| halves_of(s, columns))
            .filter(move |t| t.contains(&k))
    };
    known
        .par_iter()
        .map_init(Vec::new, |found: &mut Vec<Neighbor>, &k| {
            let place = corner(from, k);
            let x = Vec3::from(place);
            let (mut best, mut n) = (f64::INFINITY, AT_FIRST);
            loop {
                tree.nearest_n(&place, n, found);
                for neighbor in found.iter() {
                    if neighbor.distance - cover >= best {
                        return best;
                    }
                    let triangles = around(known[neighbor.index]);
                    best = triangles
                        .map(|t| distance(&x, t.map(vector)))
                        .fold(best, f64::min);
                }
                if found.len() < n.get() {
                    return best;
                }
                n = n.saturating_mul(AT_FIRST);
            }
        })
        .collect()
}

/// Distance of a point from a triangle; m. Source: Ericson, Real-Time Collision Detection (2004), 5.1.5.
fn distance(x: &Vec3, [a, b, c]: [Vec3; 3]) -> f64 {
    let normal = (b - a).cross(&(c - a));
    let is_over = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|(p, q)| (q - p).cross(&(x - p)).dot(&normal) >= 0.0);
    if is_over {
        return (x - a).dot(&normal).abs() / normal.norm();
    }
    let from_side = |p: &Vec3, q: &Vec3| {
        let along = q - p;
        let share = ((x - p).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        (x - (p + along * share)).norm()
    };
    (from_side(&a, &b))
        .min(from_side(&b, &c))
        .min(from_side(&c, &a))
}
