//! Elevations that triangles follow: points of a grid, with the surfaces below the outlines.
//!
//! Plan view in units of the grid's spacing from its south-western point, where its points are whole numbers: what is computed of
//! them is exact, and does not depend on the map.

use super::super::grid::Grid;
use super::super::outline::Outline;

/// Distance of points of the grid from an outline below which they would make slivers; × spacing.
const CLEAR_OF_OUTLINES: f64 = 0.5;
/// Tolerance of points beside a side, which count for both triangles; × spacing.
const ON_SIDE: f64 = 1e-9;

/// A corner of a triangle: plan view in spacings, elevation in m.
pub(super) type Corner = [f64; 3];

/// Use of a point of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// May become a corner.
    Free,
    /// Is a corner.
    Corner,
    /// So close to an outline that it would make slivers.
    BesideOutline,
}

/// Elevations to be followed.
pub(super) struct Field<'a, B> {
    pub(super) grid: &'a Grid,
    /// Of each point.
    pub(super) uses: Vec<Use>,
    /// Outline around each point, from 1, 0 for none; empty without outlines.
    owner: Vec<u32>,
    /// Elevation of the surface below an outline at a place (m); m.
    pub(super) beneath: B,
}

/// Distances of triangles from the points of the grid; m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fit {
    /// Largest height of the triangles above a point.
    pub above: f64,
    /// Largest depth of the triangles below a point.
    pub below: f64,
    /// Largest distance of either sign at points beside outlines, which are no corners.
    pub beside_outlines: f64,
}

impl<'a, B: Fn(usize, [f64; 2]) -> f64> Field<'a, B> {
    pub(super) fn new(grid: &'a Grid, outlines: &[Outline], beneath: B) -> Self {
        let n = grid.heights.len();
        let mut field = Self {
            grid,
            uses: vec![Use::Free; n],
            owner: if outlines.is_empty() {
                Vec::new()
            } else {
                vec![0; n]
            },
            beneath,
        };
        for (number, outline) in (1..).zip(outlines) {
            field.enclose(number, outline);
            for (from, to) in outline.sides() {
                field.keep_clear(from, to);
            }
        }
        field
    }

    /// Plan view in spacings of a position in m.
    pub(super) fn in_spacings(&self, at: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| (at[axis] - self.grid.corner[axis]) / self.grid.spacing)
    }

    /// Position in m of a place in spacings.
    fn in_meters(&self, at: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| self.grid.corner[axis] + at[axis] * self.grid.spacing)
    }

    /// The point of a number.
    pub(super) fn point(&self, k: usize) -> [usize; 2] {
        [k % self.grid.n[0], k / self.grid.n[0]]
    }

    /// Points that a range along an axis (spacings) holds.
    pub(super) fn within(&self, axis: usize, [low, high]: [f64; 2]) -> std::ops::Range<usize> {
        let first = (low - ON_SIDE).ceil().max(0.0) as usize;
        let last = (high + ON_SIDE).floor();
        if last < 0.0 {
            return 0..0;
        }
        first..(last as usize + 1).min(self.grid.n[axis])
    }

    /// Notes the points within an outline, row by row between the crossings of its sides.
    fn enclose(&mut self, number: u32, outline: &Outline) {
        let ys = outline.corners.iter().map(|&c| self.in_spacings(c)[1]);
        let (low, high) = ys.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| {
            (low.min(y), high.max(y))
        });
        let mut crossings = Vec::new();
        for j in self.within(1, [low, high]) {
            let [_, y] = self.grid.place([0, j]);
            crossings.clear();
            crossings.extend(outline.crossings(y));
            crossings.sort_unstable_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                let [low, high] = [pair[0], pair[1]].map(|x| self.in_spacings([x, y])[0]);
                for i in self.within(0, [low, high]) {
                    let k = self.grid.index([i, j]);
                    // where two overlap, which is refused later, the first counts
                    if self.owner[k] == 0 {
                        self.owner[k] = number;
                    }
                }
            }
        }
    }

    /// Takes the points beside a side out of use.
    fn keep_clear(&mut self, from: [f64; 2], to: [f64; 2]) {
        let (a, b) = (self.in_spacings(from), self.in_spacings(to));
        let along = [b[0] - a[0], b[1] - a[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        let (low, high) = (a[1].min(b[1]), a[1].max(b[1]));
        let clear = CLEAR_OF_OUTLINES;
        for j in self.within(1, [low - clear, high + clear]) {
            // the part of the side that is near this row
            let y = j as f64;
            let share = |y: f64| ((y - a[1]) / along[1]).clamp(0.0, 1.0);
            let [s, t] = if along[1] == 0.0 {
                [0.0, 1.0]
            } else {
                [share(y - clear), share(y + clear)]
            };
            let [x, z] = [a[0] + s * along[0], a[0] + t * along[0]];
            for i in self.within(0, [x.min(z) - clear, x.max(z) + clear]) {
                let off = [i as f64 - a[0], y - a[1]];
                let share = (off[0] * along[0] + off[1] * along[1]) / square;
                // a side of no length has no share
                let share = if share.is_nan() {
                    0.0
                } else {
                    share.clamp(0.0, 1.0)
                };
                let distance = (off[0] - share * along[0]).hypot(off[1] - share * along[1]);
                if distance <= clear {
                    let k = self.grid.index([i, j]);
                    self.uses[k] = Use::BesideOutline;
                }
            }
        }
    }

    /// Visits the points of the grid within a triangle, those on its sides included: number and both coordinates.
    fn visit(&self, corners: &[Corner; 3], mut each: impl FnMut(usize, f64, f64)) {
        let [a, b, c] = corners;
        let low = a[1].min(b[1]).min(c[1]);
        let high = a[1].max(b[1]).max(c[1]);
        for j in self.within(1, [low, high]) {
            let y = j as f64;
            let (mut west, mut east) = (a[0].min(b[0]).min(c[0]), a[0].max(b[0]).max(c[0]));
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let rise = to[1] - from[1];
                if rise == 0.0 {
                    continue;
                }
                // the triangle lies to the left of its sides
                let x = from[0] + (to[0] - from[0]) * ((y - from[1]) / rise);
                if rise > 0.0 {
                    east = east.min(x);
                } else {
                    west = west.max(x);
                }
            }
            let row = j * self.grid.n[0];
            for i in self.within(0, [west, east]) {
                each(row + i, i as f64, y);
            }
        }
    }

    /// The free point in a triangle with the largest vertical distance, and that distance in whole steps of a length (m): of points
    /// whose distances are the same but for round-off it is the first, wherever the map lies.
    pub(super) fn worst(&self, corners: &[Corner; 3], step: f64) -> Option<(usize, f64)> {
        let ground = Plane::through(corners);
        let mut floor: Option<(u32, Plane)> = None;
        let mut found: Option<(usize, f64)> = None;
        self.visit(corners, |k, x, y| {
            if self.uses[k] != Use::Free {
                return;
            }
            let mut distance = (ground.height(x, y) - self.grid.heights[k]).abs();
            let owner = self.owner.get(k).map_or(0, |owner| *owner);
            if owner != 0 {
                let outline = owner as usize - 1;
                let (_, floor) = match &floor {
                    Some(known) if known.0 == owner => *known,
                    _ => *floor.insert((owner, self.floor(outline, corners))),
                };
                let own = (self.beneath)(outline, self.in_meters([x, y]));
                let below = (floor.height(x, y) - own).abs();
                // NaN: there is no such surface here, which is refused later
                distance = distance.max(below);
            }
            let steps = (distance / step).ceil();
            if found.is_none_or(|(_, most)| most < steps) {
                found = Some((k, steps));
            }
        });
        found
    }

    /// The surface below an outline between its heights at the corners of a triangle.
    fn floor(&self, outline: usize, corners: &[Corner; 3]) -> Plane {
        Plane::through(
            &corners.map(|[x, y, _]| [x, y, (self.beneath)(outline, self.in_meters([x, y]))]),
        )
    }

    /// Adds the errors of a triangle.
    pub(super) fn fit(&self, corners: &[Corner; 3], fit: &mut Fit) {
        let ground = Plane::through(corners);
        self.visit(corners, |k, x, y| {
            let off = ground.height(x, y) - self.grid.heights[k];
            match self.uses[k] {
                Use::Free => {
                    fit.above = fit.above.max(off);
                    fit.below = fit.below.max(-off);
                }
                Use::BesideOutline => fit.beside_outlines = fit.beside_outlines.max(off.abs()),
                Use::Corner => {}
            }
        });
    }
}

/// Height over plan view in spacings; m.
#[derive(Clone, Copy)]
struct Plane {
    origin: Corner,
    slope: [f64; 2],
}

impl Plane {
    fn through([a, b, c]: &[Corner; 3]) -> Self {
        let (u, v) = (
            [b[0] - a[0], b[1] - a[1], b[2] - a[2]],
            [c[0] - a[0], c[1] - a[1], c[2] - a[2]],
        );
        let twice_area = u[0] * v[1] - u[1] * v[0];
        Self {
            origin: *a,
            slope: [
                (u[2] * v[1] - u[1] * v[2]) / twice_area,
                (u[0] * v[2] - u[2] * v[0]) / twice_area,
            ],
        }
    }

    fn height(&self, x: f64, y: f64) -> f64 {
        self.origin[2] + self.slope[0] * (x - self.origin[0]) + self.slope[1] * (y - self.origin[1])
    }
}
