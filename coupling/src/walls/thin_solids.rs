//! Thin solids: bodies so thin or sharp that water on their two sides would interact through them, with walls of particles.

use riprap_dda::Blocks;
use riprap_sph::boundary::thin_solids::{Plane, are_opposed};
use riprap_sph::{Fluid, Vec3};

use super::Part;
use crate::saved::{Read, Saved};

/// Distance off a face at which others may cover it; spacings.
const OFF_FACE: f64 = 0.1;

/// Displacement of a body after which its cover is searched again; spacings.
const MOVED: f64 = 0.1;

/// Thin solids on blocks, moving with them.
///
/// Where fixed solids cover the foot of a plate, the thin solid continues through it: walls near there, with water
/// on both sides in their support, extrapolate the pressure from their own side only. Not where a body lies on its side.
#[derive(Clone, Debug, Default)]
pub(super) struct ThinSolids {
    thin_solids: Vec<ThinSolid>,
    /// Fixed parts that may cover them, and their planes.
    fixed: Vec<Part>,
    fixed_planes: Vec<Vec<Plane>>,
    /// m.
    spacing: f64,
    /// Continuation of thin solids through covered faces; m.
    support_radius: f64,
    /// Whether the fluid does not know their current position.
    are_new: bool,
}

/// A convex part of a block.
#[derive(Clone, Debug)]
struct ThinSolid {
    block: usize,
    is_fixed: bool,
    /// In the frame of the block.
    part: Part,
    /// The rest of the block, in the same frame.
    siblings: Vec<Part>,
    /// Faces at which it only seems to end: it has no end there.
    ends: Vec<bool>,
    /// Side of each face.
    side_of: Vec<u32>,
    /// Faces through which it continues.
    goes_on: Vec<bool>,
    /// Fixed parts that it may be partly inside of, as when it is drawn on into its bed.
    reaches_into: Vec<usize>,
    /// Position of the block at the last search; m.
    looked_at: Vec3,
    /// Position of the faces, by one corner, at the start of the step.
    start: Vec<(Vec3, Vec3)>,
    /// Present planes, and the box round the part; m.
    planes: Vec<Plane>,
    bounds: (Vec3, Vec3),
}

impl ThinSolids {
    /// Empty set, in front of these fixed parts, of which some faces are not ends; lengths in m.
    pub(super) fn new(
        fixed: &[Part],
        seeming_ends: impl Fn(&Part) -> Vec<bool>,
        (spacing, support_radius): (f64, f64),
    ) -> Self {
        Self {
            thin_solids: Vec::new(),
            fixed: fixed.to_vec(),
            fixed_planes: (fixed.iter().map(|part| part.planes(&seeming_ends(part)))).collect(),
            spacing,
            support_radius,
            are_new: false,
        }
    }

    /// Adds one of the parts of a block, given where the block is now; returns its number. At faces that are `ends` it only
    /// seems to end, and each is of a side.
    pub(super) fn add(
        &mut self,
        (number, parts): (usize, &[Part]),
        (ends, side_of): (Vec<bool>, Vec<u32>),
        block: usize,
        blocks: &Blocks,
    ) -> u32 {
        let turned_back = blocks.orientation(block).inverse();
        let centroid = blocks.centroid(block);
        let local = |part: &Part| {
            part.mapped(
                |normal| turned_back * normal,
                |x| turned_back * (x - centroid),
            )
        };
        let is_fixed = blocks.is_fixed(block);
        let siblings = parts.iter().enumerate().filter(|&(k, _)| k != number);
        let mut solid = ThinSolid {
            block,
            is_fixed,
            part: local(&parts[number]),
            // fixed ones are among the fixed parts
            siblings: match is_fixed {
                true => Vec::new(),
                false => siblings.map(|(_, part)| local(part)).collect(),
            },
            ends,
            side_of,
            goes_on: Vec::new(),
            reaches_into: Vec::new(),
            looked_at: Vec3::repeat(f64::INFINITY),
            start: Vec::new(),
            planes: Vec::new(),
            bounds: (Vec3::zeros(), Vec3::zeros()),
        };
        solid.look_for_cover(blocks, &self.fixed, (self.spacing, self.support_radius));
        solid.record_start(blocks);
        solid.place(blocks, (1.0, self.support_radius));
        self.are_new = true;
        self.thin_solids.push(solid);
        self.thin_solids.len() as u32 - 1
    }

    /// Appends the state to a byte buffer: the result of the last search, which is not done in every step.
    pub(super) fn save(&self, out: Vec<u8>) -> Saved {
        let found = |s: &ThinSolid| (s.looked_at, s.goes_on.clone(), s.reaches_into.clone());
        let found: Vec<_> = self.thin_solids.iter().map(found).collect();
        postcard::to_extend(&found, out)
    }

    /// Takes it over again; they are to be placed after that.
    pub(super) fn read<'a>(&mut self, bytes: &'a [u8]) -> Read<'a> {
        type Found = (Vec3, Vec<bool>, Vec<usize>);
        let (found, rest) = postcard::take_from_bytes::<Vec<Found>>(bytes)?;
        let fits = |(solid, found): (&ThinSolid, &Found)| {
            found.1.len() == solid.goes_on.len() && found.2.iter().all(|&k| k < self.fixed.len())
        };
        if found.len() != self.thin_solids.len() || !self.thin_solids.iter().zip(&found).all(fits) {
            return Err(postcard::Error::DeserializeBadEncoding);
        }
        for (solid, found) in self.thin_solids.iter_mut().zip(found) {
            (solid.looked_at, solid.goes_on, solid.reaches_into) = found;
        }
        Ok(rest)
    }

    /// Remembers where they are: before the blocks move.
    pub(super) fn record_start(&mut self, blocks: &Blocks) {
        for solid in self.thin_solids.iter_mut().filter(|solid| !solid.is_fixed) {
            solid.record_start(blocks);
        }
    }

    /// Places them at half of the step just taken by the blocks.
    pub(super) fn place_half_way(&mut self, blocks: &Blocks) {
        self.place(blocks, 0.5);
    }

    /// Places them at the blocks.
    pub(super) fn place_at_end(&mut self, blocks: &Blocks) {
        self.place(blocks, 1.0);
    }

    fn place(&mut self, blocks: &Blocks, share: f64) {
        let Self {
            thin_solids,
            fixed,
            spacing,
            support_radius,
            are_new,
            ..
        } = self;
        for solid in thin_solids.iter_mut().filter(|solid| !solid.is_fixed) {
            solid.look_for_cover(blocks, fixed, (*spacing, *support_radius));
            solid.place(blocks, (share, *support_radius));
            *are_new = true;
        }
    }

    /// Passes them to the fluid, if it does not know their current position.
    pub(super) fn set_up(&mut self, fluid: &mut Fluid) {
        if !self.are_new && fluid.n_thin_solids() == self.thin_solids.len() {
            return;
        }
        fluid.clear_thin_solids();
        for solid in &self.thin_solids {
            let planes = solid.planes.iter().zip(&solid.side_of);
            fluid.add_thin_solid(planes.map(|(&plane, &side)| (plane, side)), solid.bounds);
            for &fixed in &solid.reaches_into {
                fluid.cover_thin_solid(self.fixed_planes[fixed].iter().copied());
            }
        }
        self.are_new = false;
    }
}

impl Part {
    /// Whether some of it is deeper than a depth (m) behind each face of another.
    fn reaches_past(&self, other: &Self, depth: f64) -> bool {
        other.faces.iter().all(|(normal, corners)| {
            let reaches =
                |origin: &Vec3| self.corners().any(|x| normal.dot(&(x - origin)) < -depth);
            corners.first().is_some_and(reaches)
        })
    }

    /// Of its faces; where it has no end they are infinitely far.
    fn planes(&self, ends: &[bool]) -> Vec<Plane> {
        let plane = |((normal, corners), &is_end): (&(Vec3, Vec<Vec3>), &bool)| {
            let offset = normal.dot(corners.first()?);
            Some((*normal, if is_end { f64::INFINITY } else { offset }))
        };
        self.faces.iter().zip(ends).filter_map(plane).collect()
    }
}

impl ThinSolid {
    /// A face by its normal and one corner, where it is now.
    fn face_now(&self, (normal, corners): &(Vec3, Vec<Vec3>), blocks: &Blocks) -> (Vec3, Vec3) {
        let turn = blocks.orientation(self.block);
        let corner = corners.first().copied().unwrap_or_default();
        (turn * normal, blocks.centroid(self.block) + turn * corner)
    }

    fn record_start(&mut self, blocks: &Blocks) {
        let mut start = std::mem::take(&mut self.start);
        start.clear();
        let faces = self.part.faces.iter();
        start.extend(faces.map(|face| self.face_now(face, blocks)));
        self.start = start;
    }

    /// Finds the faces through which it continues, if the block has moved since the last search.
    fn look_for_cover(
        &mut self,
        blocks: &Blocks,
        fixed: &[Part],
        (spacing, support_radius): (f64, f64),
    ) {
        let centroid = blocks.centroid(self.block);
        if (centroid - self.looked_at).norm() < MOVED * spacing {
            return;
        }
        self.looked_at = centroid;
        let turn = blocks.orientation(self.block);
        let now = |part: &Part| part.mapped(|normal| turn * normal, |x| centroid + turn * x);
        let part = now(&self.part);
        let siblings: Vec<Part> = self.siblings.iter().map(now).collect();
        let (min, max) = part.aabb();
        let touches = |other: &&Part| {
            let (other_min, other_max) = other.aabb();
            (0..3).all(|k| other_min[k] - spacing < max[k] && min[k] < other_max[k] + spacing)
        };
        self.reaches_into.clear();
        if !self.is_fixed {
            // a body that only rests on a solid does not continue: it hides the region beyond its foot
            let depth = OFF_FACE * spacing;
            let overlaps =
                |other: &Part| part.reaches_past(other, depth) && other.reaches_past(&part, depth);
            let near = fixed.iter().enumerate();
            let near = near.filter(|(_, other)| touches(other) && overlaps(other));
            self.reaches_into.extend(near.map(|(k, _)| k));
        }
        let others: Vec<&Part> = fixed.iter().chain(&siblings).filter(touches).collect();
        let others: Vec<&Part> = others.into_iter().filter(|other| **other != part).collect();
        let covered: Vec<bool> = part
            .faces
            .iter()
            .map(|(normal, corners)| is_covered(normal, corners, &others, spacing))
            .collect();
        let is_foot = |face: &(Vec3, Vec<Vec3>)| {
            let mut others = part.faces.iter().zip(&covered);
            !others.any(|(other, covered)| {
                !covered && are_near_and_opposed(face, other, support_radius)
            })
        };
        // a body covered all around has no foot
        let mut sides = covered.iter().zip(&self.ends);
        let is_buried = sides.all(|(&is_covered, &is_end)| is_covered || is_end);
        self.goes_on.clear();
        let faces = part.faces.iter().zip(&covered);
        self.goes_on
            .extend(faces.map(|(face, &is_covered)| is_covered && !is_buried && is_foot(face)));
    }

    /// Places it at a fraction of the path from the start of the step; faces through which it continues are moved outward by `beyond` (m).
    fn place(&mut self, blocks: &Blocks, (share, beyond): (f64, f64)) {
        let between = |from: &Vec3, to: &Vec3| from * (1.0 - share) + to * share;
        let mut planes = std::mem::take(&mut self.planes);
        planes.clear();
        let faces = self.part.faces.iter().zip(&self.start);
        let faces = faces.zip(self.ends.iter().zip(&self.goes_on));
        planes.extend(faces.map(|((face, (from_normal, from)), is)| {
            let (to_normal, to) = self.face_now(face, blocks);
            let normal = between(from_normal, &to_normal).normalize();
            let more = match is {
                (true, _) => f64::INFINITY,
                (_, true) => beyond,
                _ => 0.0,
            };
            (normal, normal.dot(&between(from, &to)) + more)
        }));
        self.planes = planes;
        // the box of the end: what it lacks half way is a small part of the cells round it
        let turn = blocks.orientation(self.block);
        let none = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        let corners = self.part.corners().map(|x| turn * x);
        let (min, max) = corners.fold(none, |(min, max), x| (min.inf(&x), max.sup(&x)));
        let centroid = blocks.centroid(self.block);
        self.bounds = (centroid + min, centroid + max);
    }
}

/// Thin regions of a part.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Thinness {
    /// Whether two of its faces are somewhere so near, or meet at so sharp an edge, that fluid on both is within the
    /// support of each other through the solid.
    pub(super) is_thin: bool,
    /// Other parts that cover a face of such an edge elsewhere: there it rests on them and is not thin.
    pub(super) stands_on: Vec<usize>,
}

/// Cosine of the angle between the outward normals of two faces, below which these are the two sides of a plate.
const PARALLEL: f64 = -0.999;

/// Cosine of the angle between the outward normals of two faces that meet, above which these are parts of one curved side.
const CURVED: f64 = 0.7;

/// Whether a face is a side of a plate: another one less than the support (m) behind it faces the other way.
pub(super) fn is_side_of_plate(part: &Part, face: usize, support_radius: f64) -> bool {
    let (normal, corners) = &part.faces[face];
    part.faces.iter().any(|(other, others_corners)| {
        let places = corners.first().zip(others_corners.first());
        let is_near = places.is_some_and(|(x, y)| normal.dot(&(x - y)) < support_radius);
        is_near && normal.dot(other) < PARALLEL
    })
}

/// Sides of a part, each by its faces: one, or those that curve away from a large one up to a similar orientation.
///
/// Wall particles behind a side have a single pressure at each position. With faces that meet at blunt edges a fluid particle
/// has many faces in its support, also distant ones.
pub(super) fn sides(part: &Part, spacing: f64) -> Vec<Vec<usize>> {
    let n = part.faces.len();
    let areas: Vec<f64> = part.faces.iter().map(|(_, x)| area(x)).collect();
    let mut largest_first: Vec<usize> = (0..n).collect();
    largest_first.sort_by(|&a, &b| areas[b].total_cmp(&areas[a]));
    let meet = |a: usize, b: usize| {
        let ((normal, corners), (other, others_corners)) = (&part.faces[a], &part.faces[b]);
        let is_near = |x: &Vec3, y: &Vec3| (x - y).norm() < 1e-6 * spacing;
        CURVED < normal.dot(other)
            && (corners.iter()).any(|x| others_corners.iter().any(|y| is_near(x, y)))
    };
    let mut is_taken = vec![false; n];
    let mut sides = Vec::new();
    for largest in largest_first {
        if std::mem::replace(&mut is_taken[largest], true) {
            continue;
        }
        let looks_the_same_way = |face: usize| 0.0 < part.faces[face].0.dot(&part.faces[largest].0);
        let mut side = vec![largest];
        let mut at = 0;
        while at < side.len() {
            let is_next =
                |&next: &usize| !is_taken[next] && looks_the_same_way(next) && meet(side[at], next);
            let next: Vec<usize> = (0..n).filter(is_next).collect();
            next.iter().for_each(|&face| is_taken[face] = true);
            side.extend(next);
            at += 1;
        }
        sides.push(side);
    }
    sides
}

/// Of a polygon; m².
fn area(corners: &[Vec3]) -> f64 {
    let Some(first) = corners.first() else {
        return 0.0;
    };
    let triangles = corners
        .windows(2)
        .map(|pair| (pair[0] - first).cross(&(pair[1] - first)));
    0.5 * triangles.sum::<Vec3>().norm()
}

/// Thickness of a part between its open faces, for a support in m. Faces are open where no other part covers
/// them.
pub(super) fn thinness(
    part: &Part,
    open: &[bool],
    others: &[&Part],
    (spacing, support_radius): (f64, f64),
) -> Thinness {
    let mut thinness = Thinness::default();
    let open = || {
        let faces = part.faces.iter().zip(open);
        faces.filter_map(|(face, &open)| open.then_some(face))
    };
    for face in open() {
        let (normal, corners) = face;
        for other in open() {
            let (opposed, other_corners) = other;
            let Some(origin) = other_corners.first() else {
                continue;
            };
            if !are_opposed(normal, opposed) {
                continue;
            }
            for x in places(corners, spacing) {
                let depth = opposed.dot(&(origin - x));
                let foot = x + opposed * depth;
                if support_radius <= depth
                    || !is_on(other, &foot, spacing)
                    || cover(others, normal, &x, spacing).is_some()
                {
                    continue;
                }
                match cover(others, opposed, &foot, spacing) {
                    None => thinness.is_thin = true,
                    // a plate is equally thin above its support
                    Some(_) if normal.dot(opposed) < PARALLEL => {}
                    Some(cover) if thinness.stands_on.contains(&cover) => {}
                    Some(cover) => thinness.stands_on.push(cover),
                }
            }
        }
    }
    thinness
}

/// Whether two faces of a part face away from each other and are closer than the support (m) somewhere.
fn are_near_and_opposed(
    (normal, corners): &(Vec3, Vec<Vec3>),
    (other, other_corners): &(Vec3, Vec<Vec3>),
    support_radius: f64,
) -> bool {
    let Some(origin) = other_corners.first() else {
        return false;
    };
    let depths = corners.iter().map(|x| other.dot(&(origin - x)));
    let thickness = depths.fold(f64::INFINITY, f64::min);
    are_opposed(normal, other) && thickness < support_radius
}

/// Whether other parts cover a face completely, sampled a spacing (m) apart.
pub(super) fn is_covered(normal: &Vec3, corners: &[Vec3], others: &[&Part], spacing: f64) -> bool {
    2 < corners.len()
        && places(corners, spacing).all(|x| cover(others, normal, &x, spacing).is_some())
}

/// Other part directly in front of a point on a face, if any.
fn cover(others: &[&Part], normal: &Vec3, x: &Vec3, spacing: f64) -> Option<usize> {
    let x = x + normal * (OFF_FACE * spacing);
    others.iter().position(|part| {
        let nearest = part.nearest_plane(&x);
        nearest.is_some_and(|(_, distance)| distance <= 0.0)
    })
}

/// Whether a point in the plane of a face is on it.
fn is_on((normal, corners): &(Vec3, Vec<Vec3>), x: &Vec3, spacing: f64) -> bool {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).all(|(p, q)| {
        let side = q - p;
        side.cross(normal).dot(&(x - p)) <= 1e-6 * spacing * side.norm()
    })
}

/// Points on a face about a spacing (m) apart: a fan of triangles, each sampled inside.
fn places(corners: &[Vec3], spacing: f64) -> impl Iterator<Item = Vec3> {
    let first = corners.first().copied().unwrap_or_default();
    corners
        .get(1..)
        .unwrap_or(&[])
        .windows(2)
        .flat_map(move |pair| {
            let (u, v) = (pair[0] - first, pair[1] - first);
            let size = u.norm().max(v.norm()).max((u - v).norm());
            let n = (size / spacing).ceil().clamp(1.0, MOST_PLACES) as usize;
            let at = move |k: usize| (k as f64 + 1.0 / 3.0) / n as f64;
            (0..n).flat_map(move |i| (0..n - i).map(move |j| first + u * at(i) + v * at(j)))
        })
}

/// Largest number of samples along a side of a face in the search for its cover.
const MOST_PLACES: f64 = 200.0;

#[cfg(test)]
mod tests {
    use riprap_dda::{Polyhedron, Shape};

    use super::*;

    fn cuboid(min: [f64; 3], max: [f64; 3]) -> Part {
        Polyhedron::cuboid(min.into(), max.into())
            .map(|p| super::super::parts(&Shape::Polyhedra(vec![p])).remove(0))
            .unwrap_or_default()
    }

    /// A prism over a right-angled triangle with an edge of this angle; degrees.
    fn wedge(angle: f64) -> Part {
        let height = angle.to_radians().tan();
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, height]];
        let at = |y: f64| corners.map(|[x, z]| Vec3::new(x, y, z));
        let (front, back) = (at(0.0), at(1.0));
        let side = |k: usize| {
            let m = (k + 1) % 3;
            vec![front[k], front[m], back[m], back[k]]
        };
        let outward = |x: &[Vec3]| (x[1] - x[0]).cross(&(x[2] - x[0])).normalize();
        let mut faces: Vec<Vec<Vec3>> = (0..3).map(side).collect();
        faces.push(front.iter().rev().copied().collect());
        faces.push(back.to_vec());
        let middle = (front[0] + front[1] + front[2] + back[0] + back[1] + back[2]) / 6.0;
        let faces = faces.into_iter().map(|mut corners| {
            if outward(&corners).dot(&(corners[0] - middle)) < 0.0 {
                corners.reverse();
            }
            (outward(&corners), corners)
        });
        Part {
            faces: faces.collect(),
        }
    }

    #[test]
    fn plates_and_sharp_wedges_are_thin() {
        let support = 0.26;
        for (part, is_thin) in [
            (cuboid([0.0; 3], [1.0, 1.0, 0.25]), true),
            (cuboid([0.0; 3], [1.0, 1.0, 0.27]), false),
            (wedge(25.0), true),
            (wedge(60.0), true),
        ] {
            let open = vec![true; part.faces.len()];
            let is = thinness(&part, &open, &[], (0.1, support));
            assert_eq!(is.is_thin, is_thin, "{part:?}");
        }
        // 60 degrees leave 30 at the top; with that face covered the wedge is blunt
        let part = wedge(60.0);
        let open: Vec<bool> = part.faces.iter().map(|(n, _)| n.x < 0.9).collect();
        assert!(!thinness(&part, &open, &[], (0.1, support)).is_thin);
        // a sharp edge stands on a floor: its base is covered there, if not all of it
        let part = wedge(25.0);
        let floor = cuboid([-1.0, -1.0, -1.0], [0.9, 2.0, 0.0]);
        let open = vec![true; part.faces.len()];
        let on_floor = |floor: &Part| thinness(&part, &open, &[floor], (0.1, support));
        assert!(!on_floor(&floor).is_thin);
        // on half a floor it is thin, but not where it stands
        let half = cuboid([-1.0, 0.5, -1.0], [2.0, 2.0, 0.0]);
        let stands_on = vec![0];
        assert_eq!(
            on_floor(&half),
            Thinness {
                is_thin: true,
                stands_on
            }
        );
    }

    #[test]
    fn a_face_is_covered_where_all_of_it_is() {
        let plate = cuboid([0.0, 0.0, 0.0], [0.1, 1.0, 1.0]);
        let floor = cuboid([-1.0, -1.0, -1.0], [1.0, 2.0, 0.0]);
        let half = cuboid([-1.0, -1.0, -1.0], [1.0, 0.5, 0.0]);
        let rest = cuboid([-1.0, 0.5, -1.0], [1.0, 2.0, 0.0]);
        let foot = plate.faces.iter().find(|(n, _)| n.z < -0.9);
        let is = |others: &[&Part]| foot.is_some_and(|(n, x)| is_covered(n, x, others, 0.05));
        assert!(is(&[&floor]) && is(&[&half, &rest]));
        assert!(!is(&[&half]) && !is(&[]));
    }
}
