//! Screens: solids so thin, or so sharp, that water on one side is within the support of water on the other.
//!
//! Distance alone would let the two see each other through the solid, and let both push on the same wall
//! particles. Here what lies behind a screen is hidden: places inside it, and those beyond it where a segment
//! leaves through a face opposed to the one it came in by, or crosses a second screen. Past a blunt corner, whose faces
//! are not opposed, sight is free.
//!
//! - Two particles do not see each other through a screen.
//! - Every face of a screen has wall particles of its own behind it, as deep as the support, even where the
//!   solid ends before that ([`sample_behind`](super::sampling::sample_behind)). A particle sees those that a look
//!   through their face has behind it, if it crosses no other screen before.
//! - Other wall particles are not seen through a screen.
//!
//! Of any place each particle so sees one thing: what is there, or the wall that hides it. All is decided by places
//! alone and alike from both ends, so that pairs stay equal and opposite. A particle inside a screen counts to the
//! face nearest to it.

use crate::Vec3;
use crate::cells::CellGrid;

/// The face of a screen through which a wall particle is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facet {
    /// Number of the screen, in the order of [`Fluid::add_screen`](crate::Fluid::add_screen).
    pub screen: u32,
    /// Number of its plane.
    pub face: u32,
}

impl Facet {
    /// None: a wall particle that is seen from everywhere.
    pub const NONE: Self = Self {
        screen: u32::MAX,
        face: u32::MAX,
    };
}

/// The plane of a face: outward unit normal, and its offset `n·x` in m.
pub type Plane = (Vec3, f64);

/// How far inside the edges of a face a segment has to hit it, over the support radius: lattices look along edges.
const SLACK: f64 = 1e-6;

/// The screens of a fluid at their present places.
#[derive(Clone, Debug, Default)]
pub(crate) struct Screens {
    planes: Vec<Plane>,
    /// Where the planes of each screen end.
    ends: Vec<u32>,
    /// Planes of solids that screens reach into, where those of each solid end, and where the solids of each screen end.
    cover_planes: Vec<Plane>,
    covers: Vec<u32>,
    cover_ends: Vec<u32>,
    /// First entry of each cell, counted from one; zero where no screen is near.
    first: Vec<u32>,
    entries: Vec<Near>,
    /// Cells that have an entry.
    marked: Vec<u32>,
    /// How far inside its edges a face has to be hit; m.
    slack: f64,
}

/// A screen near a cell, and the next one there.
#[derive(Clone, Copy, Debug)]
struct Near {
    screen: u32,
    next: u32,
}

impl Screens {
    /// Number of screens.
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
        self.ends.clear();
        self.cover_planes.clear();
        self.covers.clear();
        self.cover_ends.clear();
    }

    /// Adds a convex solid that the last screen reaches into.
    pub(crate) fn cover(&mut self, planes: impl Iterator<Item = Plane>) {
        self.cover_planes.extend(planes);
        self.covers.push(self.cover_planes.len() as u32);
        if let Some(end) = self.cover_ends.last_mut() {
            *end = self.covers.len() as u32;
        }
    }

    /// Adds a convex solid within a box (m), for the sight of particles up to `reach` (m) from it.
    pub(crate) fn add(
        &mut self,
        planes: impl Iterator<Item = Plane>,
        (min, max): (Vec3, Vec3),
        grid: &CellGrid,
        reach: f64,
    ) {
        let (screen, start) = (self.ends.len() as u32, self.planes.len());
        self.planes.extend(planes);
        self.ends.push(self.planes.len() as u32);
        self.cover_ends.push(self.covers.len() as u32);
        self.first.resize(grid.n_cells(), 0);
        self.slack = SLACK * reach;
        let within = reach + 0.5 * grid.cell_size().norm();
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
                    self.entries.push(Near { screen, next });
                    self.first[cell] = self.entries.len() as u32;
                }
            }
        }
    }

    /// Whether a screen may be within reach of what is in a cell.
    pub(crate) fn are_near(&self, cell: usize) -> bool {
        self.first.get(cell).is_some_and(|&first| 0 < first)
    }

    fn near(&self, cell: usize) -> impl Iterator<Item = u32> {
        let mut at = self.first.get(cell).copied().unwrap_or(0);
        std::iter::from_fn(move || {
            let entry = self.entries.get((at as usize).checked_sub(1)?)?;
            at = entry.next;
            Some(entry.screen)
        })
    }

    fn planes_of(&self, screen: u32) -> &[Plane] {
        let screen = screen as usize;
        let start = screen.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.planes[start as usize..self.ends[screen] as usize]
    }

    /// Where the segment from `x` to `y` comes into a screen, if it does so outside the solids that this reaches into.
    fn entry(&self, screen: u32, x: &Vec3, y: &Vec3) -> Option<Entry> {
        let entry = entry(self.planes_of(screen), x, y, self.slack)?;
        let start_of = |ends: &[u32], k: usize| k.checked_sub(1).map_or(0, |k| ends[k] as usize);
        let first = start_of(&self.cover_ends, screen as usize);
        let covers = first..self.cover_ends[screen as usize] as usize;
        if covers.is_empty() {
            return Some(entry);
        }
        let place = x + (y - x) * entry.share;
        let is_in = |cover: usize| {
            let planes = start_of(&self.covers, cover)..self.covers[cover] as usize;
            let mut planes = self.cover_planes[planes].iter();
            planes.all(|(n, offset)| n.dot(&place) < *offset)
        };
        (!covers.into_iter().any(is_in)).then_some(entry)
    }

    /// Whether two particles see each other; `cell` is that of one of them.
    pub(crate) fn lets_see(&self, cell: usize, x: &Vec3, y: &Vec3) -> bool {
        // the same answer whoever asks
        let (x, y) = if x.as_slice() <= y.as_slice() {
            (x, y)
        } else {
            (y, x)
        };
        let mut n_crossed = 0;
        self.near(cell).all(|screen| {
            let planes = self.planes_of(screen);
            let Some(entry) = self.entry(screen, x, y) else {
                return true;
            };
            n_crossed += 1;
            n_crossed < 2 && !parts(planes, &entry, x, y)
        })
    }

    /// Whether a particle at `x` sees a wall particle at `wall`, behind a face or no face of a screen; `cell`
    /// is that of one of them.
    pub(crate) fn lets_see_wall(&self, cell: usize, x: &Vec3, wall: &Vec3, facet: Facet) -> bool {
        let (mut n_crossed, mut is_hidden) = (0, false);
        let mut first: Option<(u32, Entry)> = None;
        for screen in self.near(cell) {
            let planes = self.planes_of(screen);
            if let Some(entry) = self.entry(screen, x, wall) {
                n_crossed += 1;
                is_hidden |= n_crossed == 2 || hides(planes, &entry, x, wall);
                if first.is_none_or(|(_, other)| entry.share < other.share) {
                    first = Some((screen, entry));
                }
            }
        }
        if facet == Facet::NONE {
            return !is_hidden;
        }
        let is_own = |(screen, entry): (u32, Entry)| {
            screen == facet.screen && entry.face == facet.face as usize
        };
        is_hidden && first.is_some_and(is_own)
    }
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

/// Where a segment comes into a convex solid.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Entry {
    face: usize,
    /// Share of the segment before it.
    share: f64,
}

/// Where the segment from a particle at `x` to `y` enters a convex solid, if it does. One that starts inside enters
/// there, through the face nearest to it. An edge belongs to nothing: what looks along the wall that the solid
/// stands on sees that wall.
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

/// Whether two outward normals are those of opposed faces: a plate's two sides, or those of an edge sharper than 45
/// degrees. At blunter ones what is seen through the edge is a small part of what each particle sees.
pub fn are_opposed(normal: &Vec3, other: &Vec3) -> bool {
    normal.dot(other) < -0.7
}

/// The face through which the segment from `x` in a convex solid to `y` outside leaves it.
fn exit(planes: &[Plane], x: &Vec3, y: &Vec3) -> usize {
    let mut exit = (0, f64::INFINITY);
    for (face, (n, offset)) in planes.iter().enumerate() {
        let (at_x, at_y) = (n.dot(x) - offset, n.dot(y) - offset);
        if at_x <= 0.0 && 0.0 < at_y {
            let share = at_x / (at_x - at_y);
            if share < exit.1 {
                exit = (face, share);
            }
        }
    }
    exit.0
}

/// Whether a screen that the segment from a particle at `x` comes into hides the place `y`.
fn hides(planes: &[Plane], entry: &Entry, x: &Vec3, y: &Vec3) -> bool {
    let is_inside = nearest(planes, y).1 <= 0.0;
    is_inside || are_opposed(&planes[entry.face].0, &planes[exit(planes, x, y)].0)
}

/// Whether a screen that the segment between two particles comes into is between them. One that is inside counts as
/// being at the face nearest to it.
fn parts(planes: &[Plane], entry: &Entry, x: &Vec3, y: &Vec3) -> bool {
    let (nearest_face, depth) = nearest(planes, y);
    let face = if depth <= 0.0 {
        nearest_face
    } else {
        exit(planes, x, y)
    };
    let (normal, offset) = &planes[face];
    normal.dot(x) - offset <= 0.0 && are_opposed(&planes[entry.face].0, normal)
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

    fn are_parted(x: Vec3, y: Vec3) -> bool {
        let planes = plate();
        entry(&planes, &x, &y, SLACK).is_some_and(|entry| parts(&planes, &entry, &x, &y))
    }

    fn is_hidden(x: Vec3, y: Vec3) -> bool {
        let planes = plate();
        entry(&planes, &x, &y, SLACK).is_some_and(|entry| hides(&planes, &entry, &x, &y))
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
    fn the_nearer_of_two_screens_is_seen() -> Result<(), crate::FluidError> {
        let grid = CellGrid::new(
            (Vec3::repeat(-4.0), Vec3::repeat(4.0)),
            [false; 3],
            (2.0, 0.1),
            1 << 16,
        )?;
        let bounds = (Vec3::new(-10.0, -10.0, -0.5), Vec3::new(10.0, 10.0, 0.5));
        let mut screens = Screens::default();
        screens.add(plate().into_iter(), bounds, &grid, 2.0);
        // the same plate, its middle 1.1 m higher
        let higher = plate().into_iter().map(|(n, o)| (n, o + 1.1 * n.z));
        let raised = bounds.1 + Vec3::new(0.0, 0.0, 1.1);
        screens.add(higher, (bounds.0, raised), &grid, 2.0);
        let x = Vec3::new(0.0, 0.0, 1.7);
        let cell = grid.cell_of(&x);
        let seen = |screens: &Screens, z: f64, screen: u32| {
            let facet = Facet { screen, face: 4 };
            screens.lets_see_wall(cell, &x, &Vec3::new(0.0, 0.0, z), facet)
        };
        assert!(seen(&screens, 0.4, 1) && !seen(&screens, 0.4, 0));
        let deep = Vec3::new(0.0, 0.0, -1.0);
        assert!(!screens.lets_see_wall(cell, &x, &deep, Facet::NONE));
        assert!(!screens.lets_see(cell, &x, &Vec3::new(0.0, 0.0, 0.55)));
        // inside a solid that reaches over its upper side, and not beyond it, it hides nothing
        let mound = |half: f64| {
            let sides = [Vec3::x(), -Vec3::x()].map(|n| (n, half));
            sides
                .into_iter()
                .chain([(Vec3::z(), 1.65), (-Vec3::z(), 0.0)])
        };
        let low = Vec3::new(0.0, 0.0, 1.0);
        assert!(!screens.lets_see_wall(cell, &x, &low, Facet::NONE));
        screens.cover(mound(0.3));
        assert!(screens.lets_see_wall(cell, &x, &low, Facet::NONE) && !seen(&screens, 1.0, 1));
        let aside = Vec3::new(1.0, 0.0, 0.0);
        assert!(!screens.lets_see_wall(cell, &(x + aside), &(low + aside), Facet::NONE));
        screens.clear();
        assert!(!screens.are_near(cell) && screens.lets_see(cell, &x, &deep));
        Ok(())
    }
}
