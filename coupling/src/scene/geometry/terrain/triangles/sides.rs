//! Sides of outlines, cut into pieces that the triangles around can meet without slivers.

use std::collections::BTreeSet;

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};

use super::super::grid::Grid;
use super::super::outline::Outline;
use super::TrianglesError;

/// Distance of a corner from a side of another outline below which it lies on it; × spacing.
const ON_SIDE: f64 = 1e-9;

/// A side of an outline, or the part of one between corners of other outlines on it; from the lower end, so that two outlines that
/// share it have the same one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// Number of the first outline that has it.
    pub(super) outline: usize,
    from: [f64; 2],
    to: [f64; 2],
    /// Places where it may be cut, its ends included, evenly spaced, less one.
    pub(super) n: u32,
}

impl Side {
    /// Position of place k of n; m.
    pub(super) fn place(&self, k: u32) -> [f64; 2] {
        if k == 0 {
            self.from
        } else if k == self.n {
            self.to
        } else {
            let share = f64::from(k) / f64::from(self.n);
            [0, 1].map(|axis| self.from[axis] + share * (self.to[axis] - self.from[axis]))
        }
    }

    /// Places to cut it at, in ascending order with both ends, so that the straight lines between are within a tolerance (m) of
    /// two surfaces (m).
    pub(super) fn cuts(&self, surfaces: [&dyn Fn([f64; 2]) -> f64; 2], tolerance: f64) -> Vec<u32> {
        let heights = surfaces
            .map(|height| -> Vec<f64> { (0..=self.n).map(|k| height(self.place(k))).collect() });
        let mut cuts = vec![0];
        let mut open = vec![(0, self.n)];
        while let Some((from, to)) = open.pop() {
            let off = |k: u32| {
                let share = f64::from(k - from) / f64::from(to - from);
                let of = |heights: &Vec<f64>| {
                    let [a, b, own] = [from, to, k].map(|k| heights[k as usize]);
                    (a + share * (b - a) - own).abs()
                };
                of(&heights[0]).max(of(&heights[1]))
            };
            let worst = (from + 1..to).max_by(|&k, &l| off(k).total_cmp(&off(l)).then(l.cmp(&k)));
            match worst.filter(|&k| off(k) > tolerance) {
                Some(k) => open.extend([(k, to), (from, k)]),
                None => cuts.push(to),
            }
        }
        cuts
    }
}

/// Sides of outlines, each once.
///
/// # Errors
///
/// [`TrianglesError::Outside`] and [`TrianglesError::Crossing`].
pub(super) fn sides(grid: &Grid, outlines: &[Outline]) -> Result<Vec<Side>, TrianglesError> {
    check(grid, outlines)?;
    let mut known = BTreeSet::new();
    let mut sides = Vec::new();
    let all = outlines.iter().enumerate();
    for (outline, (from, to)) in all.flat_map(|(o, outline)| outline.sides().map(move |s| (o, s))) {
        let ends = parts(grid, outlines, from, to);
        for pair in ends.windows(2) {
            let (from, to) = match pair[0].partial_cmp(&pair[1]) {
                Some(std::cmp::Ordering::Less) => (pair[0], pair[1]),
                _ => (pair[1], pair[0]),
            };
            let length = (to[0] - from[0]).hypot(to[1] - from[1]) / grid.spacing;
            let bits = [from[0], from[1], to[0], to[1]].map(f64::to_bits);
            if 0.0 < length && known.insert(bits) {
                let n = length.round().max(1.0) as u32;
                sides.push(Side {
                    outline,
                    from,
                    to,
                    n,
                });
            }
        }
    }
    Ok(sides)
}

/// Ends of a side with the corners of other outlines on it, in order.
fn parts(grid: &Grid, outlines: &[Outline], from: [f64; 2], to: [f64; 2]) -> Vec<[f64; 2]> {
    let along = [to[0] - from[0], to[1] - from[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let share = |[x, y]: [f64; 2]| ((x - from[0]) * along[0] + (y - from[1]) * along[1]) / square;
    let is_on = |&corner: &[f64; 2]| {
        let s = share(corner);
        let off = [0, 1].map(|axis| corner[axis] - from[axis] - s * along[axis]);
        0.0 < s
            && s < 1.0
            && corner != from
            && corner != to
            && off[0].hypot(off[1]) <= ON_SIDE * grid.spacing
    };
    let corners = outlines.iter().flat_map(|outline| &outline.corners);
    let mut ends: Vec<[f64; 2]> = corners.copied().filter(is_on).collect();
    ends.sort_unstable_by(|&a, &b| share(a).total_cmp(&share(b)));
    ends.dedup();
    ends.insert(0, from);
    ends.push(to);
    ends
}

/// Checks that the corners are within the grid and that no side crosses another.
fn check(grid: &Grid, outlines: &[Outline]) -> Result<(), TrianglesError> {
    let (low, high) = (grid.corner, grid.far_corner());
    let mut net = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    for (number, outline) in outlines.iter().enumerate() {
        let mut handles = Vec::with_capacity(outline.corners.len());
        for &at in &outline.corners {
            let is_within = (0..2).all(|axis| low[axis] < at[axis] && at[axis] < high[axis]);
            if !(is_within && grid.height(at).is_some()) {
                return Err(TrianglesError::Outside {
                    outline: number,
                    at,
                    low,
                    high,
                });
            }
            handles.push(net.insert(Point2::new(at[0], at[1]))?);
        }
        for (k, &from) in handles.iter().enumerate() {
            let next = (k + 1) % handles.len();
            if net.try_add_constraint(from, handles[next]).is_empty() {
                return Err(TrianglesError::Crossing {
                    outline: number,
                    from: outline.corners[k],
                    to: outline.corners[next],
                });
            }
        }
    }
    Ok(())
}
