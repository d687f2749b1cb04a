//! Points behind a surface that is known by the distance from it: terrain.
//!
//! The lattice is cut by the surface: a cell has the volume and the centroid of its part behind.

use rayon::prelude::*;

use super::{UnionLattice, WallSample};
use crate::Vec3;

/// A cell that is cut is divided into this many cubed.
const DIVISIONS: usize = 4;
/// Of a cell's volume: less is left out.
const LEAST_SHARE: f64 = 1e-3;

/// Points to the depth of the support radius behind a surface, within the support of fluid, cell by cell.
///
/// `height_within` returns the signed distance of a point from the surface, negative behind it, `None` beyond the given
/// distance; `is_taken` identifies points in other solids. Lengths in m.
pub fn sample_behind_surface(
    lattice: &UnionLattice,
    height_within: impl Fn(&Vec3, f64) -> Option<f64> + Sync,
    is_taken: impl Fn(&Vec3) -> bool + Sync,
) -> Vec<WallSample> {
    let (dp, support) = (lattice.particle_spacing, lattice.support_radius);
    let region = lattice.region.grown(support);
    let half_diagonal = 0.5 * 3.0_f64.sqrt() * dp;
    let first: [i64; 3] =
        [0, 1, 2].map(|k| ((region.min[k] - lattice.anchor[k]) / dp).ceil() as i64);
    let last: [i64; 3] =
        [0, 1, 2].map(|k| ((region.max[k] - lattice.anchor[k]) / dp).floor() as i64);
    let is_behind = |x: &Vec3, height: f64| height < 0.0 && !is_taken(x);
    let cell = |cell: [i64; 3]| -> Option<WallSample> {
        let middle = lattice.anchor + Vec3::from_fn(|k, _| (cell[k] as f64 + 0.5) * dp);
        let height = height_within(&middle, support + half_diagonal)?;
        if half_diagonal <= height || height <= -support {
            return None;
        }
        let along = |k: usize| ((k as f64 + 0.5) / DIVISIONS as f64 - 0.5) * dp;
        let (mut count, mut sum) = (0, Vec3::zeros());
        for k in 0..DIVISIONS {
            for j in 0..DIVISIONS {
                for i in 0..DIVISIONS {
                    let x = middle + Vec3::new(along(i), along(j), along(k));
                    // far from the surface all of a cell is on one side
                    let height = if height.abs() < half_diagonal {
                        height_within(&x, 2.0 * half_diagonal).unwrap_or(height)
                    } else {
                        height
                    };
                    if is_behind(&x, height) {
                        count += 1;
                        sum += x;
                    }
                }
            }
        }
        let share = f64::from(count) / DIVISIONS.pow(3) as f64;
        (LEAST_SHARE < share).then(|| WallSample {
            position: sum / f64::from(count),
            volume: share * dp.powi(3),
        })
    };
    let layers = (first[2]..last[2]).into_par_iter().flat_map_iter(|k| {
        let rows =
            (first[1]..last[1]).flat_map(move |j| (first[0]..last[0]).map(move |i| [i, j, k]));
        rows.filter_map(&cell)
    });
    layers.collect()
}
