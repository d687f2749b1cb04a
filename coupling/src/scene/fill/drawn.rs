//! Volume of a basin as it is drawn: the space below the level that its water reaches.
//!
//! Lines along z are clipped exactly by the solids, so that the volume is exact in z; across, lines stand in the middle of
//! strips that begin and end at the corners of solids, so that it is exact for boxes and for prisms of a flow in a plane.
//! A piece of a line belongs to the water if a node of the water sees it: gaps that no particle passes are not searched.

use rayon::prelude::*;
use riprap_dda::{Shape, Surface, Vec3};

use super::obstacles::{Obstacles, Part, height, parts};
use crate::scene::file::DimensionsFile;

/// Strips across a cell that a solid comes near, at least; in a plane and in space.
const STRIPS: [usize; 2] = [8, 4];
/// The same beside a surface, whose distances take long to find and which is smooth at the scale of a cell.
const STRIPS_AT_SURFACE: usize = 2;
/// Corners in a cell from which on strips are regular.
const MOST_CORNERS: usize = 16;
/// Pieces that a line is cut into beside a surface; each is crossed at most once.
const PIECES: usize = 2;
/// Steps of the search for a crossing of a surface, whose distance is nearly linear along a line.
const STEPS: usize = 8;
/// Distance from a surface that ends the search; × length of the line.
const CLOSE: f64 = 1e-6;

/// The cells that hold a region, from the lowest row of the domain to the level.
pub(super) struct Cells<'a> {
    /// Middle of the first cell; m.
    pub(super) first: Vec3,
    /// m.
    pub(super) spacing: [f64; 3],
    /// Number of cells along each axis.
    pub(super) counts: [usize; 3],
    /// Lower and upper corner of the domain below the level, beyond which cells are cut off; m.
    pub(super) bounds: (Vec3, Vec3),
    /// Dimensions of the flow.
    pub(super) dimensions: DimensionsFile,
    /// Place of the water's node in a cell, where there is one; m.
    pub(super) water: &'a (dyn Fn([usize; 3]) -> Option<Vec3> + Sync),
}

impl Cells<'_> {
    /// Volume of the water in each column of cells, x first; m³.
    pub(super) fn columns(&self, solids: &[(String, Shape)]) -> Vec<f64> {
        let obstacles = Obstacles::new(solids, &self.first, self.spacing, self.counts);
        let [nx, ny, nz] = self.counts;
        (0..nx * ny)
            .into_par_iter()
            .map(|column| {
                let of_cell = |k| self.volume_of([column % nx, column / nx, k], &obstacles);
                (0..nz).map(of_cell).sum()
            })
            .collect()
    }

    /// Volume of the water in a cell; m³.
    fn volume_of(&self, cell: [usize; 3], obstacles: &Obstacles) -> f64 {
        let spacing = Vec3::from(self.spacing);
        let steps = Vec3::from_fn(|axis, _| cell[axis] as f64);
        let middle = self.first + steps.component_mul(&spacing);
        let low = (middle - 0.5 * spacing).sup(&self.bounds.0);
        let high = (middle + 0.5 * spacing).inf(&self.bounds.1);
        if (0..3).any(|axis| high[axis] <= low[axis]) {
            return 0.0;
        }
        let reach = 0.5 * spacing.norm();
        let parts: Vec<&Part> = obstacles
            .near(cell)
            .map(|(_, part)| part)
            .filter(|part| part.is_within(&middle, reach))
            .collect();
        // most cells are all water, or all air or rock
        if parts.is_empty() && (self.water)(cell).is_some() {
            return (high - low).product();
        }
        let eyes = self.eyes(cell, &middle);
        if eyes.is_empty() {
            return 0.0;
        }
        if parts.is_empty() {
            return (high - low).product();
        }
        let strips = [0, 1].map(|axis| self.strips(axis, (low[axis], high[axis]), &parts));
        let mut volume = 0.0;
        for &(y, dy) in &strips[1] {
            for &(x, dx) in &strips[0] {
                let foot = Vec3::new(x, y, low.z);
                for (from, to) in free_pieces(&foot, high.z, &parts) {
                    let place = Vec3::new(x, y, 0.5 * (from + to));
                    if eyes
                        .iter()
                        .any(|eye| !obstacles.is_crossed(cell, eye, &place))
                    {
                        volume += dx * dy * (to - from);
                    }
                }
            }
        }
        volume
    }

    /// Nodes of the water in a cell and beside it, the nearest first; m.
    fn eyes(&self, cell: [usize; 3], middle: &Vec3) -> Vec<Vec3> {
        let mut found: Vec<Vec3> = (0..27)
            .filter_map(|shift| {
                let steps = [shift % 3, shift / 3 % 3, shift / 9];
                let mut beside = [0; 3];
                for axis in 0..3 {
                    beside[axis] = (cell[axis] + steps[axis]).checked_sub(1)?;
                    if self.counts[axis] <= beside[axis] {
                        return None;
                    }
                }
                (self.water)(beside)
            })
            .collect();
        let distance = |x: &Vec3| (x - middle).norm_squared();
        found.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        found
    }

    /// Middle and width of the strips across a cell along an axis; m.
    fn strips(&self, axis: usize, (low, high): (f64, f64), parts: &[&Part]) -> Vec<(f64, f64)> {
        let is_plane = self.dimensions == DimensionsFile::Two;
        if is_plane && axis == 1 {
            return vec![(0.5 * (low + high), high - low)];
        }
        let has_surface = parts.iter().any(|part| matches!(part, Part::Surface(_)));
        let n = match (has_surface && !is_plane, is_plane) {
            (true, _) => STRIPS_AT_SURFACE,
            (false, true) => STRIPS[0],
            (false, false) => STRIPS[1],
        };
        let mut ends: Vec<f64> = (0..=n)
            .map(|k| low + (high - low) * (k as f64 / n as f64))
            .collect();
        let corners: Vec<f64> = parts
            .iter()
            .filter_map(|part| match part {
                Part::Convex(body) => Some(body.vertices().iter().map(|x| x[axis])),
                Part::Ball { .. } | Part::Surface(_) => None,
            })
            .flatten()
            .filter(|x| low < *x && *x < high)
            .collect();
        if corners.len() <= MOST_CORNERS {
            ends.extend(corners);
            ends.sort_by(f64::total_cmp);
        }
        let strip = |pair: &[f64]| (0.5 * (pair[0] + pair[1]), pair[1] - pair[0]);
        let strips = ends.windows(2).map(strip);
        strips.filter(|(_, width)| 0.0 < *width).collect()
    }
}

/// Depth of the water at a place (x, y) between the lowest point of the domain and a level; `None` where a solid is at the
/// level; m.
pub fn depth_at(
    solids: &[(String, Shape)],
    [x, y]: [f64; 2],
    (bottom, level): (f64, f64),
) -> Option<f64> {
    let parts = parts(solids);
    let near: Vec<&Part> = parts
        .iter()
        .map(|(_, part)| part)
        .filter(|part| {
            let (min, max) = part.aabb();
            (min.x..=max.x).contains(&x) && (min.y..=max.y).contains(&y)
        })
        .collect();
    let pieces = free_pieces(&Vec3::new(x, y, bottom), level, &near);
    let (from, to) = *pieces.last()?;
    (to == level).then_some(to - from)
}

/// Pieces of a line along z from `foot` to a height that are in no solid: their lower and upper ends; m.
fn free_pieces(foot: &Vec3, top: f64, parts: &[&Part]) -> Vec<(f64, f64)> {
    let head = Vec3::new(foot.x, foot.y, top);
    let mut solid: Vec<(f64, f64)> = Vec::new();
    for part in parts {
        match part {
            Part::Surface(surface) => solid.extend(pieces_behind(surface, foot, top)),
            Part::Convex(_) | Part::Ball { .. } => {
                solid.extend(part.share_inside(foot, &head).map(|(enter, leave)| {
                    let length = top - foot.z;
                    (foot.z + enter * length, foot.z + leave * length)
                }))
            }
        }
    }
    solid.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut free = Vec::new();
    let mut from = foot.z;
    for (low, high) in solid {
        if from < low {
            free.push((from, low));
        }
        from = from.max(high);
    }
    if from < top {
        free.push((from, top));
    }
    free
}

/// Pieces of a line along z from `foot` to a height that are behind a surface; m.
fn pieces_behind(surface: &Surface, foot: &Vec3, top: f64) -> Vec<(f64, f64)> {
    let off = |z: f64| height(surface, &Vec3::new(foot.x, foot.y, z));
    let at = |k: usize| foot.z + (top - foot.z) * (k as f64 / PIECES as f64);
    let ends: Vec<(f64, f64)> = (0..=PIECES).map(|k| (at(k), off(at(k)))).collect();
    let mut behind = Vec::new();
    for pair in ends.windows(2) {
        let ((low, d_low), (high, d_high)) = (pair[0], pair[1]);
        match (0.0 < d_low, 0.0 < d_high) {
            (true, true) => {}
            (false, false) => behind.push((low, high)),
            (is_free_below, _) => {
                let crossing = crossing(off, (low, d_low), (high, d_high));
                behind.push(if is_free_below {
                    (crossing, high)
                } else {
                    (low, crossing)
                });
            }
        }
    }
    behind
}

/// Zero of a function between two places where it has different signs, by the false position.
fn crossing(f: impl Fn(f64) -> f64, mut low: (f64, f64), mut high: (f64, f64)) -> f64 {
    let (mut at, close) = (low.0, CLOSE * (high.0 - low.0));
    for _ in 0..STEPS {
        at = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
        let value = f(at);
        if value.abs() <= close {
            break;
        }
        if (0.0 < value) == (0.0 < low.1) {
            low = (at, value);
        } else {
            high = (at, value);
        }
    }
    at
}
