//! Thin solids: solids so thin, or so sharp, that water on one side is within the support of water on the other.
//!
//! By distance alone the two would interact through the solid, and both would act on the same wall
//! particles. Here points behind a thin solid are hidden: points inside it, and points beyond it where a segment
//! leaves through a face opposite to the one of its entry, or crosses a second thin solid. Past a blunt corner, whose faces
//! are not opposite, the line of sight is free.
//!
//! - Two particles do not interact through a thin solid.
//! - Every side of a thin solid, a face or some that curve away from each other, has its own wall particles behind it, as
//!   deep as the support, even where the solid ends before that ([`sample_behind`](crate::boundary::sampling::sample_behind)). They are
//!   visible to a particle through a face of their side, if the line of sight crosses no other thin solid before.
//! - Other wall particles are not visible through a thin solid.
//!
//! At any point each particle thus has a single neighbor: the particle there, or the wall that hides it. Visibility depends on
//! positions alone and is symmetric, so that pairs stay equal and opposite. A particle inside a thin solid belongs to the
//! nearest face.
//!
//! Visibility changes smoothly: if wall particles appeared and disappeared abruptly as a particle moves past an edge, the sum of
//! their gradients would jump, which agitates particles in deep water. A point `y` is visible from a particle at `x`
//! with a fraction through each possible entry face, and likewise for the exit faces:
//!
//! ```text
//! s_f = o_f²/Σ o²,   o_f = d_f(x)/|d_f(y)|   faces of d_f(x) > 0 > d_f(y), out: x and y exchanged
//! hidden through f: s_f where y is inside, else s_f Σ_e t_e g(D_fe) over e opposed to f
//! ```
//! `d_f` is the distance from the plane of a face, `o_f/(1 + o_f)` the fraction of the segment in front of that plane, whose
//! largest value marks the entry; `D_fe` the distance at which the segment passes the edge of two faces, over
//! which `g` goes from 0 at the edge to 1 at 0.8 of the support. The fractions of a point add up to one.

use crate::Vec3;
use crate::neighbors::cells::CellGrid;

/// The side of a thin solid through which a wall particle is visible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facet {
    /// Number of the thin solid, in the order of [`Fluid::add_thin_solid`](crate::Fluid::add_thin_solid).
    pub solid: u32,
    /// Number of the side.
    pub side: u32,
}

impl Facet {
    /// No facet: a wall particle that is visible from everywhere.
    pub const NONE: Self = Self {
        solid: u32::MAX,
        side: u32::MAX,
    };
}

/// The plane of a face: outward unit normal, and its offset `n·x` in m.
pub type Plane = (Vec3, f64);

/// Distance from the edges of a face within which a segment misses it, over the support radius: lattice lines run along edges.
const SLACK: f64 = 1e-6;

/// Transition width of the occlusion at a sharp edge, over the support radius: with half of it water at an
/// edge of 30 degrees keeps moving at twice the speed.
const EDGE: f64 = 0.8;

/// Smallest ratio of distances from a plane, for a point on it.
const LEAST: f64 = 1e-6;

/// Thin solids of a fluid at their current position.
#[derive(Clone, Debug, Default)]
pub(crate) struct ThinSolids {
    planes: Vec<Plane>,
    /// Side of its thin solid to which each belongs.
    sides: Vec<u32>,
    /// End of the planes of each thin solid.
    ends: Vec<u32>,
    /// Planes of solids that thin solids extend into, the end of those of each solid, and the end of the solids of each thin solid.
    cover_planes: Vec<Plane>,
    covers: Vec<u32>,
    cover_ends: Vec<u32>,
    /// First entry of each cell, counted from one; zero without a thin solid nearby.
    first: Vec<u32>,
    entries: Vec<Near>,
    /// Cells that have an entry.
    marked: Vec<u32>,
    /// Support radius; m.
    reach: f64,
    /// Bounding boxes of the influence of each thin solid; m.
    boxes: Vec<(Vec3, Vec3)>,
}

/// A thin solid near a cell, and the next one there.
#[derive(Clone, Copy, Debug)]
struct Near {
    solid: u32,
    next: u32,
}

impl ThinSolids {
    /// Number of thin solids.
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    /// Takes all away.
    pub(crate) fn clear(&mut self) {
        for &cell in &self.marked {
            self.first[cell as usize] = 0;
        }
        self.marked.clear();
        self.entries.clear();
        self.planes.clear();
        self.sides.clear();
        self.ends.clear();
        self.cover_planes.clear();
        self.covers.clear();
        self.cover_ends.clear();
        self.boxes.clear();
    }

    /// Adds a convex solid that the last thin solid extends into.
    pub(crate) fn cover(&mut self, planes: impl Iterator<Item = Plane>) {
        self.cover_planes.extend(planes);
        self.covers.push(self.cover_planes.len() as u32);
        if let Some(end) = self.cover_ends.last_mut() {
            *end = self.covers.len() as u32;
        }
    }

    /// Adds a convex solid, by its planes and the sides they are of, within a box (m), for the sight of particles up to `reach` (m) from it.
    pub(crate) fn add(
        &mut self,
        planes: impl Iterator<Item = (Plane, u32)>,
        (min, max): (Vec3, Vec3),
        grid: &CellGrid,
        reach: f64,
    ) {
        let (solid, start) = (self.ends.len() as u32, self.planes.len());
        for (plane, side) in planes {
            self.planes.push(plane);
            self.sides.push(side);
        }
        self.ends.push(self.planes.len() as u32);
        self.cover_ends.push(self.covers.len() as u32);
        self.first.resize(grid.n_cells(), 0);
        self.reach = reach;
        let within = reach + 0.5 * grid.cell_size().norm();
        self.boxes
            .push((min.add_scalar(-within), max.add_scalar(within)));
        let low = grid.coordinates_of(&min.add_scalar(-reach));
        let high = grid.coordinates_of(&max.add_scalar(reach));
        for k in low[2]..=high[2] {
            for j in low[1]..=high[1] {
                for i in low[0]..=high[0] {
                    let center = grid.cell_center([i, j, k]);
                    let is_near = |(n, offset): &Plane| n.dot(&center) - offset < within;
                    if !self.planes[start..].iter().all(is_near) {
                        continue;
                    }
                    let cell = grid.cell_at([i, j, k]);
                    let next = self.first[cell];
                    if next == 0 {
                        self.marked.push(cell as u32);
                    }
                    self.entries.push(Near { solid, next });
                    self.first[cell] = self.entries.len() as u32;
                }
            }
        }
    }

    /// Whether a thin solid may be within the support of a box (m), judged by some of the axes.
    pub(crate) fn may_be_near(&self, (min, max): &(Vec3, Vec3), axes: [bool; 3]) -> bool {
        self.boxes.iter().any(|(low, high)| {
            (0..3).all(|axis| !axes[axis] || (low[axis] <= max[axis] && min[axis] <= high[axis]))
        })
    }

    /// Whether a thin solid may be within the support of a cell.
    pub(crate) fn are_near(&self, cell: usize) -> bool {
        self.first.get(cell).is_some_and(|&first| 0 < first)
    }

    fn near(&self, cell: usize) -> impl Iterator<Item = u32> {
        let mut at = self.first.get(cell).copied().unwrap_or(0);
        std::iter::from_fn(move || {
            let entry = self.entries.get((at as usize).checked_sub(1)?)?;
            at = entry.next;
            Some(entry.solid)
        })
    }

    fn planes_of(&self, solid: u32) -> &[Plane] {
        &self.planes[self.range_of(solid)]
    }

    fn range_of(&self, solid: u32) -> std::ops::Range<usize> {
        let solid = solid as usize;
        let start = solid.checked_sub(1).map_or(0, |before| self.ends[before]);
        start as usize..self.ends[solid] as usize
    }

    /// Numbers of the faces of a side, among those of its thin solid.
    fn faces_of(&self, facet: Facet) -> impl Iterator<Item = usize> + Clone {
        let sides = self.sides[self.range_of(facet.solid)].iter().enumerate();
        sides.filter_map(move |(face, &side)| (side == facet.side).then_some(face))
    }

    /// What is in sight past the thin solids near a cell from a place in it, at a look; `None` where that takes more.
    pub(crate) fn sight(&self, cell: usize, place: &Vec3) -> Option<Sight<'_>> {
        let mut sight = Sight::default();
        for solid in self.near(cell) {
            let mut is_inside = true;
            for plane in self.planes_of(solid).iter().filter(|p| in_front(p, place)) {
                *sight.planes.get_mut(sight.n_planes)? = Some(plane);
                sight.n_planes += 1;
                is_inside = false;
            }
            if is_inside {
                return None;
            }
            *sight.ends.get_mut(sight.n_solids)? = sight.n_planes;
            sight.n_solids += 1;
        }
        Some(sight)
    }

    /// Passage of the segment from `x` to `y` through a thin solid, and its entry, if any; `None` without a passage
    /// or if the entry is inside another solid.
    fn passage<'a>(
        &'a self,
        solid: u32,
        x: &'a Vec3,
        y: &'a Vec3,
    ) -> Option<(Passage<'a>, Option<Entry>)> {
        let planes = self.planes_of(solid);
        let passage = Passage::new(planes, x, y, EDGE * self.reach)?;
        let entry = entry(planes, x, y, SLACK * self.reach);
        let is_covered =
            entry.is_some_and(|entry| self.covers(solid, &(x + (y - x) * entry.share)));
        (!is_covered).then_some((passage, entry))
    }

    /// Whether a point is in a solid that a thin solid extends into.
    fn covers(&self, solid: u32, place: &Vec3) -> bool {
        let start_of = |ends: &[u32], k: usize| k.checked_sub(1).map_or(0, |k| ends[k] as usize);
        let first = start_of(&self.cover_ends, solid as usize);
        let mut covers = first..self.cover_ends[solid as usize] as usize;
        covers.any(|cover| {
            let planes = start_of(&self.covers, cover)..self.covers[cover] as usize;
            let mut planes = self.cover_planes[planes].iter();
            planes.all(|(n, offset)| n.dot(place) < *offset)
        })
    }

    /// Mutual visibility of two particles, from 0 to 1; `cell` is that of one of them.
    pub(crate) fn visibility(&self, cell: usize, x: &Vec3, y: &Vec3) -> f64 {
        // the same answer whoever asks
        let (x, y) = if x.as_slice() <= y.as_slice() {
            (x, y)
        } else {
            (y, x)
        };
        let (mut n_crossed, mut share) = (0, 1.0);
        for solid in self.near(cell) {
            if let Some((passage, entry)) = self.passage(solid, x, y) {
                n_crossed += usize::from(entry.is_some());
                share *= 1.0 - passage.occlusion();
            }
        }
        if 1 < n_crossed { 0.0 } else { share }
    }

    /// Visibility of a wall particle at `wall`, behind a face or no face of a thin solid, from a particle at `x`, from 0 to 1;
    /// `cell` is that of one of them.
    pub(crate) fn wall_visibility(&self, cell: usize, x: &Vec3, wall: &Vec3, facet: Facet) -> f64 {
        let (mut n_crossed, mut past_others, mut first_of_others) = (0, 1.0, f64::INFINITY);
        let mut own = None;
        for solid in self.near(cell) {
            let Some((passage, entry)) = self.passage(solid, x, wall) else {
                continue;
            };
            n_crossed += usize::from(entry.is_some());
            let at = entry.map_or(f64::INFINITY, |entry| entry.share);
            if solid == facet.solid {
                let faces = self.faces_of(facet);
                let entry_weight: f64 = faces.clone().map(|face| passage.entry_weight(face)).sum();
                let hidden: f64 = faces.map(|face| passage.hidden_through(face)).sum();
                own = Some((entry_weight, hidden, at));
            } else {
                first_of_others = at.min(first_of_others);
                past_others *= 1.0 - passage.hidden();
            }
        }
        match own {
            _ if facet == Facet::NONE && n_crossed < 2 => past_others,
            // points behind the first of two thin solids are hidden, wherever the line of sight exits
            Some((entry_weight, _, at)) if 1 < n_crossed && at < first_of_others => entry_weight,
            Some((_, hidden, _)) if n_crossed < 2 => hidden * past_others,
            _ => 0.0,
        }
    }
}

/// Faces of thin solids that a place is in front of.
#[derive(Debug, Default)]
pub(crate) struct Sight<'a> {
    /// Those of all solids, one after the other.
    planes: [Option<&'a Plane>; 24],
    n_planes: usize,
    /// One past the last of each solid.
    ends: [usize; 8],
    n_solids: usize,
}

impl Sight<'_> {
    /// Whether every thin solid has a face that both the place and a point are in front of: no line of sight then passes any.
    #[inline(always)]
    pub(crate) fn is_clear(&self, point: &Vec3) -> bool {
        let mut start = 0;
        self.ends[..self.n_solids].iter().all(|&end| {
            let planes = &self.planes[start..end];
            start = end;
            planes.iter().flatten().any(|plane| in_front(plane, point))
        })
    }
}

#[inline(always)]
fn in_front((n, offset): &Plane, point: &Vec3) -> bool {
    0.0 < n.dot(point) - offset
}

/// The plane that a point is farthest outside of, with that distance (m): below zero inside.
fn nearest(planes: &[Plane], x: &Vec3) -> (usize, f64) {
    planes
        .iter()
        .map(|(n, offset)| n.dot(x) - offset)
        .enumerate()
        .fold((0, f64::NEG_INFINITY), |most, next| {
            if most.1 < next.1 { next } else { most }
        })
}

/// Entry of a segment into a convex solid.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Entry {
    face: usize,
    /// Share of the segment before it.
    share: f64,
}

/// Entry of the segment from a particle at `x` to `y` into a convex solid, if any. A segment that starts inside enters
/// there, through the nearest face. Edges do not count: along the wall on which the solid
/// stands, the wall is visible.
fn entry(planes: &[Plane], x: &Vec3, y: &Vec3, slack: f64) -> Option<Entry> {
    let mut entry = Entry {
        face: 0,
        share: f64::NEG_INFINITY,
    };
    for (face, (n, offset)) in planes.iter().enumerate() {
        let (at_x, at_y) = (n.dot(x) - offset, n.dot(y) - offset);
        if at_x <= 0.0 {
            continue;
        }
        if 0.0 < at_y {
            return None;
        }
        let share = at_x / (at_x - at_y);
        if entry.share < share {
            entry = Entry { face, share };
        }
    }
    if entry.share < 0.0 {
        let (face, _) = nearest(planes, x);
        let (n, offset) = &planes[face];
        let share = 0.0;
        return (n.dot(y) - offset <= 0.0).then_some(Entry { face, share });
    }
    let place = x + (y - x) * entry.share;
    let is_within = |(face, (n, offset)): (usize, &Plane)| {
        face == entry.face || n.dot(&place) - offset <= -slack
    };
    planes.iter().enumerate().all(is_within).then_some(entry)
}

/// Whether two outward normals are those of opposite faces: a plate's two sides, or those of an edge sharper than 45
/// degrees. At blunter edges the region seen through the edge is a small part of the support.
pub fn are_opposed(normal: &Vec3, other: &Vec3) -> bool {
    normal.dot(other) < -0.7
}

/// Passage of the segment from a particle at `x` to `y` through a convex solid.
#[derive(Clone, Copy, Debug)]
struct Passage<'a> {
    planes: &'a [Plane],
    x: &'a Vec3,
    y: &'a Vec3,
    /// Width over which sharp edges come to hide; m.
    edge: f64,
    /// Sums of the weights of possible entry and exit faces; zero where that end is inside.
    entries: f64,
    exits: f64,
}

impl<'a> Passage<'a> {
    /// `None` if one of the faces has both ends in front of it.
    fn new(planes: &'a [Plane], x: &'a Vec3, y: &'a Vec3, edge: f64) -> Option<Self> {
        let (mut entries, mut exits) = (0.0, 0.0);
        for (n, offset) in planes {
            let (at_x, at_y) = (n.dot(x) - offset, n.dot(y) - offset);
            if 0.0 < at_x && 0.0 < at_y {
                return None;
            }
            entries += weight(at_x, at_y);
            exits += weight(at_y, at_x);
        }
        Some(Self {
            planes,
            x,
            y,
            edge,
            entries,
            exits,
        })
    }

    /// Fraction of a face in the entry.
    fn entry_weight(&self, face: usize) -> f64 {
        share_of(self.planes, face, (self.x, self.y), self.entries)
    }

    /// Fraction of a face in the exit.
    fn exit_weight(&self, face: usize) -> f64 {
        share_of(self.planes, face, (self.y, self.x), self.exits)
    }

    /// Fraction of the point at `y` hidden by the solid for a line of sight through one of its faces.
    fn hidden_through(&self, face: usize) -> f64 {
        if self.exits == 0.0 {
            self.entry_weight(face)
        } else {
            self.occlusion_by(face)
        }
    }

    /// Fraction of the point at `y` hidden by the solid.
    fn hidden(&self) -> f64 {
        let faces = 0..self.planes.len();
        faces.map(|face| self.hidden_through(face)).sum()
    }

    /// Separation of two particles by the solid. A particle inside is considered at the nearest face.
    fn occlusion(&self) -> f64 {
        let faces = 0..self.planes.len();
        faces.map(|face| self.occlusion_by(face)).sum()
    }

    /// Separation of the two ends by a face and those opposite to it.
    fn occlusion_by(&self, face: usize) -> f64 {
        let share = self.entry_weight(face);
        if share == 0.0 {
            return 0.0;
        }
        let normal = &self.planes[face].0;
        let others = self.planes.iter().enumerate();
        let opposed = others.filter(|(_, (other, _))| are_opposed(normal, other));
        let occlusion_by = |(other, _): (usize, &Plane)| match self.exit_weight(other) {
            0.0 => 0.0,
            exit_weight => exit_weight * self.past_edge(face, other),
        };
        share * opposed.map(occlusion_by).sum::<f64>()
    }

    /// Penetration into the solid past the edge of two faces, from 0 to 1.
    fn past_edge(&self, face: usize, other: usize) -> f64 {
        let at = |plane: &Plane, place: &Vec3| plane.0.dot(place) - plane.1;
        let (first, second) = (&self.planes[face], &self.planes[other]);
        let (first_x, first_y) = (at(first, self.x), at(first, self.y));
        let (second_x, second_y) = (at(second, self.x), at(second, self.y));
        let across = first.0 * (second_y - second_x) - second.0 * (first_y - first_x);
        let beside = (first_x * second_y - first_y * second_x) / across.norm();
        // faces of a plate have no edge
        let depth = if beside.is_nan() {
            f64::INFINITY
        } else {
            -beside
        };
        // nothing at the edge itself, where neither face is between them any longer
        (depth / self.edge).clamp(0.0, 1.0)
    }
}

/// Weight of a possible entry face of a line of sight, from the distances of its ends from the face.
fn weight(from: f64, to: f64) -> f64 {
    if 0.0 < from && to <= 0.0 {
        (from / (-to).max(LEAST * from)).powi(2)
    } else {
        0.0
    }
}

/// Fraction of a face in the entry of a line of sight; a line from inside enters by the nearest face.
fn share_of(planes: &[Plane], face: usize, (from, to): (&Vec3, &Vec3), sum: f64) -> f64 {
    let (n, offset) = &planes[face];
    let (at_from, at_to) = (n.dot(from) - offset, n.dot(to) - offset);
    if 0.0 < sum {
        weight(at_from, at_to) / sum
    } else if at_to <= 0.0 && nearest(planes, from).0 == face {
        1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLACK: f64 = 1e-6;

    /// A plate, 1 m thick, from -10 to 10 m across.
    fn plate() -> Vec<Plane> {
        let half = [10.0, 10.0, 0.5];
        (0..6)
            .map(|k| {
                let mut n = Vec3::zeros();
                n[k / 2] = if k % 2 == 0 { 1.0 } else { -1.0 };
                (n, half[k / 2])
            })
            .collect()
    }

    const SIDE: usize = 0;
    const TOP: usize = 4;

    fn face_seen(x: Vec3, y: Vec3) -> Option<usize> {
        entry(&plate(), &x, &y, SLACK).map(|entry| entry.face)
    }

    /// Width over which sharp edges come to hide in these tests; m.
    const WIDTH: f64 = 0.7;

    fn passage<'a>(planes: &'a [Plane], x: &'a Vec3, y: &'a Vec3) -> Option<Passage<'a>> {
        Passage::new(planes, x, y, WIDTH)
    }

    /// Separation of two particles.
    fn occlusion(planes: &[Plane], x: &Vec3, y: &Vec3) -> f64 {
        passage(planes, x, y).map_or(0.0, |passage| passage.occlusion())
    }

    /// Hidden fraction of the point at `y`, and its sum over the faces.
    fn hidden(planes: &[Plane], x: &Vec3, y: &Vec3) -> f64 {
        passage(planes, x, y).map_or(0.0, |passage| passage.hidden())
    }

    fn are_parted(x: Vec3, y: Vec3) -> bool {
        0.9 < occlusion(&plate(), &x, &y)
    }

    fn is_hidden(x: Vec3, y: Vec3) -> bool {
        0.9 < hidden(&plate(), &x, &y)
    }

    /// An edge of 30 degrees that points up, the lower side far down.
    fn edge() -> Vec<Plane> {
        let half = 15.0_f64.to_radians();
        let side = |sign: f64| (Vec3::new(sign * half.cos(), 0.0, half.sin()), 0.0);
        vec![side(1.0), side(-1.0), (-Vec3::z(), 10.0)]
    }

    /// Cells 8 m about the origin, for a support of 2 m.
    fn grid() -> Result<CellGrid, crate::FluidError> {
        CellGrid::new(
            (Vec3::repeat(-4.0), Vec3::repeat(4.0)),
            [false; 3],
            (2.0, 0.1),
            1 << 16,
        )
    }

    /// Points about the origin, up to 2 m away, reproducible.
    fn scattered(n: usize) -> impl Iterator<Item = [Vec3; 2]> {
        let mut state = 88_172_645_463_325_252_u64;
        let mut random = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        (0..n).map(move |_| [(); 2].map(|()| Vec3::from_fn(|_, _| 2.0 * random())))
    }

    #[test]
    fn every_place_is_seen_once() {
        // a corner of the plate at the origin, and the edge
        let corner: Vec<Plane> = plate()
            .iter()
            .map(|(n, o)| (*n, o - n.dot(&Vec3::new(10.0, 0.0, 0.5))))
            .collect();
        let mut n_shared = 0;
        for planes in [corner, edge()] {
            let is_inside = |x: &Vec3| nearest(&planes, x).1 <= 0.0;
            for [x, y] in scattered(20_000) {
                if is_inside(&x) {
                    continue;
                }
                let of_faces = |y: &Vec3| hidden(&planes, &x, y);
                if is_inside(&y) {
                    // only through faces, of which one or more lead there
                    assert!(
                        (of_faces(&y) - 1.0).abs() < 1e-9,
                        "{x} {y} {}",
                        of_faces(&y)
                    );
                } else {
                    // what is hidden of the wall is what water there does not see
                    let occlusion = occlusion(&planes, &x, &y);
                    assert!(
                        (0.0..1.0 + 1e-9).contains(&occlusion),
                        "{x} {y} {occlusion}"
                    );
                    assert_eq!(of_faces(&y), occlusion);
                    n_shared += usize::from(0.01 < occlusion && occlusion < 0.99);
                }
            }
        }
        assert!(100 < n_shared);
    }

    #[test]
    fn a_side_of_many_faces_is_one() -> Result<(), crate::FluidError> {
        let grid = grid()?;
        // an arch of faces 6 degrees apart, 1 m thick at most, over a flat base
        let faces = (-4..=4).map(|k| {
            let (sin, cos) = f64::from(6 * k).to_radians().sin_cos();
            let normal = Vec3::new(sin, 0.0, cos);
            ((normal, 4.0 - 3.0 * cos), 0)
        });
        let planes: Vec<(Plane, u32)> = faces.chain([((-Vec3::z(), 0.0), 1)]).collect();
        let bounds = (Vec3::new(-4.0, -4.0, 0.0), Vec3::new(4.0, 4.0, 1.0));
        let mut thin_solids = ThinSolids::default();
        thin_solids.add(planes.iter().copied(), bounds, &grid, 2.0);
        let only: Vec<Plane> = planes.iter().map(|(plane, _)| *plane).collect();
        let mut n_inside = 0;
        for [x, y] in scattered(20_000) {
            if nearest(&only, &x).1 <= 0.0 || 0.0 < nearest(&only, &y).1 {
                continue;
            }
            n_inside += 1;
            let cell = grid.cell_of(&x);
            let share =
                |side: u32| thin_solids.wall_visibility(cell, &x, &y, Facet { solid: 0, side });
            let (upper, lower) = (share(0), share(1));
            assert!(
                (upper + lower - 1.0).abs() < 1e-9,
                "{x} {y} {upper} {lower}"
            );
            if 0.0 <= x.z {
                assert_eq!(lower, 0.0, "{x} {y}");
            }
        }
        assert!(1000 < n_inside);
        Ok(())
    }

    #[test]
    fn sight_changes_by_no_more_than_places_do() {
        // places by an edge may not be less than half a spacing inside: wall particles are that deep
        let planes = edge();
        let step = 1e-4;
        let mut most: f64 = 0.0;
        for [x, y] in scattered(20_000) {
            let depth = nearest(&planes, &y).1;
            let is_wall = depth < -0.1;
            if nearest(&planes, &x).1 < 0.1 || (-0.1..0.1).contains(&depth) {
                continue;
            }
            for along in [Vec3::x(), Vec3::z()] {
                let moved = x + along * step;
                let change = if is_wall {
                    let of = |x: &Vec3, face| {
                        passage(&planes, x, &y).map_or(0.0, |p| p.hidden_through(face))
                    };
                    (of(&moved, 0) - of(&x, 0)).abs()
                } else {
                    (occlusion(&planes, &moved, &y) - occlusion(&planes, &x, &y)).abs()
                };
                most = most.max(change / step);
            }
        }
        // a hard edge gives 1/step; here it is as steep as 1/0.1 m beside a face, and twice that with odds squared
        assert!(most < 20.0, "{most}");
    }

    #[test]
    fn a_plate_hides_what_is_behind_it_and_only_that() {
        let planes = plate();
        let above = Vec3::new(0.0, 0.0, 0.7);
        let below = Vec3::new(0.3, 0.0, -0.7);
        // 0.2 of 1.4 m are above the plate
        let entry = entry(&planes, &above, &below, SLACK);
        assert!(entry.is_some_and(|e| e.face == TOP && (e.share - 1.0 / 7.0).abs() < 1e-12));
        let beside = Vec3::new(10.5, 0.0, 0.0);
        for (x, y, is_cut) in [
            (above, below, true),
            (above, Vec3::new(1.0, 0.0, 0.6), false),
            // past a blunt corner, in by the top and out by the side
            (Vec3::new(9.0, 0.0, 0.6), beside, false),
            (Vec3::new(9.0, 0.0, 0.6), Vec3::new(9.8, 0.0, -0.6), true),
        ] {
            assert_eq!(are_parted(x, y), is_cut, "{x} {y}");
            assert_eq!(are_parted(y, x), is_cut, "{y} {x}");
        }
    }

    #[test]
    fn a_particle_that_has_sunk_in_stays_on_its_side() {
        let sunk = Vec3::new(0.0, 0.0, 0.3);
        for (y, is_cut) in [
            (Vec3::new(0.1, 0.0, 0.9), false),
            (Vec3::new(0.1, 0.0, -0.6), true),
            (Vec3::new(0.0, 0.1, -0.2), true),
            (Vec3::new(0.2, 0.0, 0.3), false),
        ] {
            assert_eq!(are_parted(sunk, y), is_cut, "{y}");
            assert_eq!(are_parted(y, sunk), is_cut, "{y}");
        }
        assert_eq!(face_seen(sunk, Vec3::new(0.0, 0.0, -1.5)), Some(TOP));
    }

    #[test]
    fn a_wall_particle_is_seen_through_its_own_face_only() {
        // beyond the far side of the plate, where another face's particle could be too
        let deep = Vec3::new(9.0, 0.0, -1.0);
        let x = Vec3::new(9.5, 0.0, 1.0);
        assert_eq!(face_seen(x, deep), Some(TOP));
        assert!(is_hidden(x, deep));
        // past the corner nothing is hidden
        let open = Vec3::new(10.6, 0.0, 0.0);
        assert!(!is_hidden(x, open));
        let past_the_edge = Vec3::new(11.0, 0.0, 0.6);
        assert_eq!(
            face_seen(past_the_edge, Vec3::new(9.5, 0.0, 0.2)),
            Some(SIDE)
        );
        // just along the edge: what is below belongs to whatever the plate stands on
        let corner = Vec3::new(10.5, 0.0, 0.0);
        assert_eq!(face_seen(corner, Vec3::new(9.5, 0.0, 1.0)), None);
    }

    #[test]
    fn the_nearer_of_two_thin_solids_is_seen() -> Result<(), crate::FluidError> {
        let grid = grid()?;
        let bounds = (Vec3::new(-10.0, -10.0, -0.5), Vec3::new(10.0, 10.0, 0.5));
        let mut thin_solids = ThinSolids::default();
        let each_a_side = |planes: Vec<Plane>| planes.into_iter().zip(0..);
        thin_solids.add(each_a_side(plate()), bounds, &grid, 2.0);
        // the same plate, its middle 1.1 m higher
        let higher = plate().iter().map(|(n, o)| (*n, o + 1.1 * n.z)).collect();
        let raised = bounds.1 + Vec3::new(0.0, 0.0, 1.1);
        thin_solids.add(each_a_side(higher), (bounds.0, raised), &grid, 2.0);
        let x = Vec3::new(0.0, 0.0, 1.7);
        let cell = grid.cell_of(&x);
        let seen = |thin_solids: &ThinSolids, z: f64, solid: u32| {
            let facet = Facet { solid, side: 4 };
            0.5 < thin_solids.wall_visibility(cell, &x, &Vec3::new(0.0, 0.0, z), facet)
        };
        let sees_wall = |thin_solids: &ThinSolids, x: &Vec3, wall: &Vec3| {
            0.5 < thin_solids.wall_visibility(cell, x, wall, Facet::NONE)
        };
        let sees = |thin_solids: &ThinSolids, y: &Vec3| 0.5 < thin_solids.visibility(cell, &x, y);
        assert!(seen(&thin_solids, 0.4, 1) && !seen(&thin_solids, 0.4, 0));
        let deep = Vec3::new(0.0, 0.0, -1.0);
        assert!(!sees_wall(&thin_solids, &x, &deep));
        assert!(!sees(&thin_solids, &Vec3::new(0.0, 0.0, 0.55)));
        // inside a solid that reaches over its upper side, and not beyond it, it hides nothing
        let mound = |half: f64| {
            let sides = [Vec3::x(), -Vec3::x()].map(|n| (n, half));
            sides
                .into_iter()
                .chain([(Vec3::z(), 1.65), (-Vec3::z(), 0.0)])
        };
        let low = Vec3::new(0.0, 0.0, 1.0);
        assert!(!sees_wall(&thin_solids, &x, &low));
        thin_solids.cover(mound(0.3));
        assert!(sees_wall(&thin_solids, &x, &low) && !seen(&thin_solids, 1.0, 1));
        let aside = Vec3::new(1.0, 0.0, 0.0);
        assert!(!sees_wall(&thin_solids, &(x + aside), &(low + aside)));
        thin_solids.clear();
        assert!(!thin_solids.are_near(cell) && sees(&thin_solids, &deep));
        Ok(())
    }

    /// What is clear at a look is what the lines of sight say, bit for bit, and most of what is in sight is.
    #[test]
    fn what_is_clear_at_a_look_is_in_sight() -> Result<(), crate::FluidError> {
        let grid = grid()?;
        let mut thin_solids = ThinSolids::default();
        let bounds = (Vec3::repeat(-10.0), Vec3::repeat(10.0));
        for planes in [plate(), edge()] {
            thin_solids.add(planes.into_iter().zip(0..), bounds, &grid, 2.0);
        }
        let (mut n_clear, mut n_in_sight) = (0, 0);
        for [x, y] in scattered(5000) {
            let cell = grid.cell_of(&x);
            let Some(sight) = thin_solids.sight(cell, &x) else {
                continue;
            };
            let seen = thin_solids.visibility(cell, &x, &y);
            n_in_sight += usize::from(seen == 1.0);
            if !sight.is_clear(&y) {
                continue;
            }
            n_clear += 1;
            assert_eq!(seen, 1.0, "{x} {y}");
            let behind = |facet| thin_solids.wall_visibility(cell, &x, &y, facet);
            assert_eq!(behind(Facet::NONE), 1.0);
            assert_eq!(behind(Facet { solid: 0, side: 4 }), 0.0);
        }
        assert!(
            0 < n_clear && n_in_sight < 2 * n_clear,
            "{n_clear} {n_in_sight}"
        );
        Ok(())
    }
}
