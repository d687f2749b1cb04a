//! The common plane of two convex polyhedra: the direction in which they are farthest apart.
//!
//! For a unit normal `n` from A to B the gap is
//!
//! ```text
//! G(n) = min_B b·n − max_A a·n            > 0 apart, < 0 overlap                              [m]
//! ```
//! and the common plane maximizes it. Two ways to the maximum:
//!
//! - [`fast_common_plane`] climbs from a start normal (Nezami et al. 2004). From a cold start it ends at
//!   a local maximum for some 5 % of random pairs, an overlap that is too deep.
//! - [`separating_axes`] tries every face normal and every pair of edges that can make a face of
//!   the Minkowski difference (separating axis theorem; pruning by arcs on the Gauss map after
//!   Gregorius 2013). For overlapping bodies it is exact.
//!
//! Faces that other fixed parts, or parts of the same body, cover entirely are no candidates, and
//! neither are corners that such a part continues: a floor made of two slabs, or a slope that ends on
//! a bed, has no edge there to stop a sliding body.
//!
//! The axis of a pair is kept ([`AxisCache`]) and used again while little changes.

mod axis_cache;

use crate::{Polyhedron, Vec3};
pub(crate) use axis_cache::AxisCache;
pub use axis_cache::ContactDetection;
use axis_cache::TRUSTED_DEPTH;
use serde::{Deserialize, Serialize};

/// Features that define an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AxisKind {
    /// A face of A; the axis is its normal.
    FaceA(u32),
    /// A face of B; the axis is its normal reversed.
    FaceB(u32),
    /// A half-edge of A and one of B; the axis is their cross product.
    Edges(u32, u32),
    /// None of these: an axis between bodies that are apart.
    Other,
}

/// A trial normal of the common plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Unit normal from A to B.
    pub normal: Vec3,
    /// Gap along it, < 0 for overlap; m.
    pub gap: f64,
    /// Features that define it.
    pub kind: AxisKind,
}

/// Sine below which two directions are parallel: their cross product is round-off.
const PARALLEL: f64 = 1e-6;
/// Largest distance by which other corners may extend beyond two edges that make the common plane, along their axis; × size.
/// Round-off between almost parallel faces violates it, and so do edges of the last step that have slid past each other: the contact
/// would lie where nothing touches.
const SUPPORT_TOLERANCE: f64 = 1e-9;
/// Cosine of two degrees: an edge-edge axis closer than that to the normal of the best face stands for that face. Between faces
/// pressed together the deepest overlap depends on their last 1e-5 rad.
const ALMOST_PARALLEL: f64 = 0.999_390_8;
/// An edge-edge axis must beat the best face by this share of the overlap, and the axis of the last
/// step is kept within this share: equal axes must not alternate.
const EDGE_PREFERENCE: f64 = 0.02;
const KEEP_PREFERENCE: f64 = 0.05;
/// Share of the overlap of a face by which that of two edges must be less for them not to stand for that face, however close their
/// normals are.
const SHALLOW_EDGES: f64 = 0.5;
/// Relative difference below which sizes are equal, and inclination below which a normal is horizontal: round-off.
const EQUAL_SIZE: f64 = 1e-9;
/// Largest `x·n` over the corners, and the corner.
fn support(body: &Polyhedron, n: &Vec3) -> (f64, usize) {
    let mut best = (f64::NEG_INFINITY, 0);
    for (k, x) in body.vertices().iter().enumerate() {
        let height = x.dot(n);
        if height > best.0 {
            best = (height, k);
        }
    }
    best
}

/// `G(n)`; m.
pub fn gap_along(a: &Polyhedron, b: &Polyhedron, n: &Vec3) -> f64 {
    -support(b, &-n).0 - support(a, n).0
}

/// Climbs from a start normal to a maximum of `G`, perhaps a local one.
///
/// In each round the candidates are, after Nezami et al. (2004): (a) the line between the two
/// closest corners, (b) normals of the faces that meet there, (c) cross products of the edges that
/// meet there, (d) the part of that line across each of these edges.
pub fn fast_common_plane(a: &Polyhedron, b: &Polyhedron, start: &Vec3) -> Axis {
    let mut best = Axis {
        normal: *start,
        gap: gap_along(a, b, start),
        kind: AxisKind::Other,
    };
    for _ in 0..50 {
        let before = best.gap;
        let at_a = support(a, &best.normal).1 as u32;
        let at_b = support(b, &-best.normal).1 as u32;
        let line = b.vertices()[at_b as usize] - a.vertices()[at_a as usize];
        let mut consider = |direction: Vec3, kind: AxisKind| {
            let norm = direction.norm();
            if norm > 0.0 {
                let normal = direction / norm;
                let gap = gap_along(a, b, &normal);
                if gap > best.gap {
                    best = Axis { normal, gap, kind };
                }
            }
        };
        consider(line, AxisKind::Other);
        for face in a.faces_around_vertex(at_a) {
            consider(a.face_normal(face), AxisKind::FaceA(face as u32));
        }
        for face in b.faces_around_vertex(at_b) {
            consider(-b.face_normal(face), AxisKind::FaceB(face as u32));
        }
        for edge_a in a.edges_around_vertex(at_a) {
            let along_a = edge_vector(a, edge_a);
            consider(across(&line, &along_a), AxisKind::Other);
            for edge_b in b.edges_around_vertex(at_b) {
                let along_b = edge_vector(b, edge_b);
                let cross = along_a.cross(&along_b);
                if cross.norm() > PARALLEL * along_a.norm() * along_b.norm() {
                    consider(cross, AxisKind::Edges(edge_a, edge_b));
                    consider(-cross, AxisKind::Edges(edge_a, edge_b));
                }
            }
        }
        for edge_b in b.edges_around_vertex(at_b) {
            consider(across(&line, &edge_vector(b, edge_b)), AxisKind::Other);
        }
        if best.gap - before <= 1e-12 * a.size().min(b.size()) {
            break;
        }
    }
    best
}

pub(crate) fn edge_vector(body: &Polyhedron, half_edge: u32) -> Vec3 {
    body.vertices()[body.target(half_edge) as usize]
        - body.vertices()[body.origin(half_edge) as usize]
}

fn across(line: &Vec3, edge: &Vec3) -> Vec3 {
    line - edge * (line.dot(edge) / edge.norm_squared())
}

/// The best axes among the faces of A, the faces of B and the pairs of edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeparatingAxes {
    /// Best face of A.
    pub face_a: Axis,
    /// Best face of B.
    pub face_b: Axis,
    /// Best pair of edges, if any two cross.
    pub edges: Option<Axis>,
    /// Gaps of the second best face of A, face of B and pair of edges, −∞ without; m.
    pub second_gaps: [f64; 3],
}

impl SeparatingAxes {
    /// The face of A or B that makes the plane; [`prefers_b`] chooses between almost equal ones.
    pub(crate) fn preferred_face(&self, a: &Polyhedron, b: &Polyhedron, down: &Vec3) -> Axis {
        let (first, second) = if prefers_b(a, b, &self.face_a.normal, down) {
            (self.face_b, self.face_a)
        } else {
            (self.face_a, self.face_b)
        };
        let round_off = SUPPORT_TOLERANCE * a.size().min(b.size());
        if second.gap - first.gap > KEEP_PREFERENCE * f64::max(-second.gap, 0.0) + round_off {
            second
        } else {
            first
        }
    }

    /// Excess of the gap of one of these axes over those of all others, negative if another one is better; m.
    pub(crate) fn lead(&self, axis: &Axis) -> f64 {
        let kinds = [Some(self.face_a), Some(self.face_b), self.edges];
        let others = kinds
            .into_iter()
            .zip(self.second_gaps)
            .map(|(best, second)| match best {
                Some(best) if best.kind == axis.kind => second,
                Some(best) => best.gap,
                None => f64::NEG_INFINITY,
            });
        axis.gap - others.fold(f64::NEG_INFINITY, f64::max)
    }

    /// The exact maximum of `G` over these axes, which is the common plane of overlapping bodies.
    pub fn best(&self) -> Axis {
        let face = if self.face_b.gap > self.face_a.gap {
            self.face_b
        } else {
            self.face_a
        };
        match self.edges {
            Some(edges) if edges.gap > face.gap => edges,
            _ => face,
        }
    }

    /// Best axis, but among almost equal ones a face rather than two edges, and the face of
    /// [`Self::preferred_face`].
    fn preferred(&self, a: &Polyhedron, b: &Polyhedron, down: &Vec3) -> Axis {
        let best = self.best();
        if best.gap > 0.0 {
            return best;
        }
        let face = self.preferred_face(a, b, down);
        // two edges that only begin to touch do not stand for a deep face: its springs would start with energy from nowhere
        let is_shallow = |edges: &Axis| {
            edges.gap - face.gap
                > f64::max(
                    SHALLOW_EDGES * -face.gap,
                    TRUSTED_DEPTH * a.size().min(b.size()),
                )
        };
        let is_a_face = |edges: &Axis| {
            !is_shallow(edges)
                && [&self.face_a, &self.face_b]
                    .iter()
                    .any(|face| face.normal.dot(&edges.normal) > ALMOST_PARALLEL)
        };
        match self.edges {
            Some(edges)
                if edges.gap - face.gap > EDGE_PREFERENCE * -face.gap && !is_a_face(&edges) =>
            {
                edges
            }
            _ => face,
        }
    }
}

/// True if of two equally good faces that of body `b` makes the plane: that of the larger body; of equal ones that of the lower
/// one, with `down` the direction of gravity. This depends neither on the order of the two nor on the frame; only equal bodies
/// side by side take the first.
fn prefers_b(a: &Polyhedron, b: &Polyhedron, normal: &Vec3, down: &Vec3) -> bool {
    let larger = b.size() - a.size();
    if larger.abs() > EQUAL_SIZE * a.size() {
        return larger > 0.0;
    }
    normal.dot(down) > EQUAL_SIZE * down.norm()
}

/// Full separating-axis test.
pub fn separating_axes(a: &Polyhedron, b: &Polyhedron) -> SeparatingAxes {
    axes(a, b, Neighbors::Heeded)
}

/// Treatment of adjoining bodies: they cover faces and continue corners, or the body is considered alone.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Neighbors {
    Heeded,
    Ignored,
}

fn axes(a: &Polyhedron, b: &Polyhedron, neighbors: Neighbors) -> SeparatingAxes {
    let none = |kind| Axis {
        normal: Vec3::z(),
        gap: f64::NEG_INFINITY,
        kind,
    };
    let (first_of_a, second_of_a) = best_face(a, b, neighbors);
    let (first_of_b, second_of_b) = best_face(b, a, neighbors);
    let (edges, second_edges) = best_edges(a, b, neighbors);
    let face_a = match first_of_a {
        None => none(AxisKind::FaceA(0)),
        Some((face, gap)) => Axis {
            normal: a.face_normal(face),
            gap,
            kind: AxisKind::FaceA(face as u32),
        },
    };
    let face_b = match first_of_b {
        None => none(AxisKind::FaceB(0)),
        Some((face, gap)) => Axis {
            normal: -b.face_normal(face),
            gap,
            kind: AxisKind::FaceB(face as u32),
        },
    };
    SeparatingAxes {
        face_a,
        face_b,
        edges,
        second_gaps: [second_of_a, second_of_b, second_edges],
    }
}

/// Face of a body with the largest gap to the other body, and the gap (m); the gap of the second best. A face that overlaps counts
/// only if it is exposed and the point of the other body farthest behind it is a corner.
fn best_face(
    body: &Polyhedron,
    other: &Polyhedron,
    neighbors: Neighbors,
) -> (Option<(usize, f64)>, f64) {
    let is_alone = neighbors == Neighbors::Ignored;
    let mut best = None;
    let (mut best_gap, mut second_gap) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    for face in (0..body.n_faces()).filter(|&face| is_alone || !body.is_hidden(face)) {
        let inward = -body.face_normal(face);
        let (depth, corner) = support(other, &inward);
        let gap = -depth - body.face_offset(face);
        if gap > second_gap && (gap > 0.0 || is_alone || other.is_corner(corner as u32, &inward)) {
            if gap > best_gap {
                second_gap = best_gap;
                best_gap = gap;
                best = Some((face, gap));
            } else {
                second_gap = gap;
            }
        }
    }
    (best, second_gap)
}

/// Pair of edges with the largest gap, among those that make a face of the Minkowski difference; the gap of the second best.
fn best_edges(a: &Polyhedron, b: &Polyhedron, neighbors: Neighbors) -> (Option<Axis>, f64) {
    let is_alone = neighbors == Neighbors::Ignored;
    let mut edges: Option<Axis> = None;
    let (mut best_gap, mut second_gap) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    let mut sides = Sides::of(b);
    for edge_a in a.edges() {
        let along_a = edge_vector(a, edge_a);
        let (a1, a2) = (
            a.face_normal(a.face_of(edge_a)),
            a.face_normal(a.face_of(a.twin(edge_a))),
        );
        sides.set(b, &a2.cross(&a1));
        for edge_b in b.edges() {
            let (face_1, face_2) = (b.face_of(edge_b), b.face_of(b.twin(edge_b)));
            // a face of the difference: the arcs a1-a2 and b1-b2 cross on the unit sphere, on the same hemisphere
            let (b1_side, b2_side) = (sides.at(face_1), sides.at(face_2));
            if b1_side * b2_side >= 0.0 {
                continue;
            }
            let (b1, b2) = (b.face_normal(face_1), b.face_normal(face_2));
            let across_b = b2.cross(&b1);
            let (a1_side, a2_side) = (a1.dot(&across_b), a2.dot(&across_b));
            if a1_side * a2_side >= 0.0 || b1_side * a2_side <= 0.0 {
                continue;
            }
            let along_b = edge_vector(b, edge_b);
            let cross = along_a.cross(&along_b);
            let norm = cross.norm();
            if norm <= PARALLEL * along_a.norm() * along_b.norm() {
                continue;
            }
            let outward = if cross.dot(&(a1 + a2)) >= 0.0 {
                norm
            } else {
                -norm
            };
            let normal = cross / outward;
            let gap = normal.dot(
                &(b.vertices()[b.origin(edge_b) as usize]
                    - a.vertices()[a.origin(edge_a) as usize]),
            );
            if gap > second_gap
                && gap_along(a, b, &normal) >= gap - SUPPORT_TOLERANCE * a.size().min(b.size())
                && (gap > 0.0
                    || is_alone
                    || (a.is_ridge(edge_a, &normal) && b.is_ridge(edge_b, &-normal)))
            {
                if gap <= best_gap {
                    second_gap = gap;
                    continue;
                }
                second_gap = best_gap;
                best_gap = gap;
                edges = Some(Axis {
                    normal,
                    gap,
                    kind: AxisKind::Edges(edge_a, edge_b),
                });
            }
        }
    }
    (edges, second_gap)
}

/// Sides of an arc on the unit sphere on which the reversed face normals of a body lie: computed once for each face, read for
/// each of its edges.
struct Sides {
    few: [f64; Self::FEW],
    many: Vec<f64>,
}

impl Sides {
    /// Largest number of faces that need no allocation.
    const FEW: usize = 48;

    fn of(body: &Polyhedron) -> Self {
        let n = body.n_faces();
        Self {
            few: [0.0; Self::FEW],
            many: vec![0.0; if n > Self::FEW { n } else { 0 }],
        }
    }

    fn set(&mut self, body: &Polyhedron, across: &Vec3) {
        let sides = if self.many.is_empty() {
            &mut self.few[..]
        } else {
            &mut self.many[..]
        };
        for (face, side) in (0..body.n_faces()).zip(sides) {
            *side = -body.face_normal(face).dot(across);
        }
    }

    fn at(&self, face: usize) -> f64 {
        if self.many.is_empty() {
            self.few[face]
        } else {
            self.many[face]
        }
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::{Isometry, Random};

    /// Two edges that only begin to touch make the plane, though it is within two degrees of a face that is
    /// deep already: its springs once began with an energy that nobody gave them.
    #[test]
    fn edges_that_begin_to_touch_are_no_deep_face() {
        let a = Polyhedron::cuboid(Vec3::zeros(), Vec3::repeat(1.0)).unwrap();
        let mut random = Random::new(5);
        let mut tilt = || 0.03 * (random.uniform() - 0.5);
        let mut n_found = 0;
        for _ in 0..200 {
            let turn = Isometry::rotation(Vec3::new(tilt(), tilt(), 0.8));
            let place = Isometry::translation(0.7, 0.7, 1.0);
            let b = a.transformed(&(place * turn));
            let Some(edges) = separating_axes(&a, &b).edges else {
                continue;
            };
            let shift = edges.normal * (-1e-6 - edges.gap);
            let b = b.transformed(&Isometry::translation(shift.x, shift.y, shift.z));
            let axes = separating_axes(&a, &b);
            let face = axes.preferred_face(&a, &b, &Vec3::zeros());
            if axes.best().kind == edges.kind && face.gap < -1e-3 {
                n_found += 1;
                assert!(face.normal.dot(&edges.normal) > ALMOST_PARALLEL);
                let preferred = axes.preferred(&a, &b, &Vec3::zeros());
                assert_eq!(preferred.kind, edges.kind);
            }
        }
        assert!(n_found > 10, "{n_found}");
    }

    /// Of two equal boxes the lower one's face makes the plane, whichever is named first.
    #[test]
    fn equal_boxes_do_not_care_which_is_first() {
        let lower = Polyhedron::cuboid(Vec3::zeros(), Vec3::repeat(1.0)).unwrap();
        let upper = lower.transformed(&Isometry::translation(0.1, 0.2, 1.0 - 1e-4));
        let turn = Isometry::rotation(Vec3::new(0.7, -0.4, 1.9));
        for frame in [Isometry::identity(), turn] {
            let (a, b) = (lower.transformed(&frame), upper.transformed(&frame));
            let down = frame.rotation * -Vec3::z();
            let first = separating_axes(&a, &b).preferred(&a, &b, &down);
            let second = separating_axes(&b, &a).preferred(&b, &a, &down);
            assert!(matches!(first.kind, AxisKind::FaceA(_)));
            assert!(matches!(second.kind, AxisKind::FaceB(_)));
        }
    }
}
