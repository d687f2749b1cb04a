//! Where two overlapping polyhedra touch: the contact patch and its points.
//!
//! If the common plane is a face, the face of the other body that looks at it is clipped by its
//! sides (Sutherland & Hodgman 1974), and what lies above the plane is cut off, so that the patch
//! grows from nothing and never jumps. If it is made by two edges, their closest points are the
//! contact.
//!
//! A fan of triangles around the middle of the patch is integrated by the midpoints of the
//! triangles' sides, weights a third of the area each: exact for quadratics, so that force and
//! moment of a linear overlap are exact. (Corners instead of midpoints would give the exact force
//! but twice the rocking stiffness of a square.)

use crate::{
    Polyhedron, Vec3,
    common_plane::{Axis, AxisKind},
};

/// One point of a contact patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PatchPoint {
    /// Names the point by the edges it comes from; the same while the same features touch.
    pub key: u32,
    /// World; m.
    pub position: Vec3,
    /// Share of the pair's stiffness; the shares of a patch sum to 1.
    pub weight: f64,
    /// Overlap; m.
    pub overlap: f64,
}

/// Corner of a clipped polygon and the name of the side that leaves it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Corner {
    x: Vec3,
    side: u16,
}

/// Contact patch with its buffers, reused from step to step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Patch {
    /// Points; weights sum to 1.
    pub points: Vec<PatchPoint>,
    /// Area, projected on the common plane; m². Zero for a point contact.
    pub area: f64,
    /// Does the overlap reach over the whole patch, as when a face rests flat?
    pub is_full: bool,
    corners: Vec<Corner>,
    spare: Vec<Corner>,
}

/// Side that no edge makes: the line where the overlap ends.
const WATERLINE: u16 = u16::MAX;
/// Marks sides that are edges of B.
const OF_B: u16 = 0x4000;
/// A patch keeps at most this many corners.
const MAX_CORNERS: usize = 8;
/// Mean over deepest overlap of a pyramid; a point contact is one, so that an edge or corner that
/// turns into a patch keeps its force.
pub(crate) const PYRAMID: f64 = 1.0 / 3.0;

impl Patch {
    /// Patch of two bodies with the common plane `axis`. A bonded patch keeps the parts that have
    /// opened; their overlap is negative.
    pub fn find(&mut self, a: &Polyhedron, b: &Polyhedron, axis: &Axis, is_bonded: bool) {
        self.points.clear();
        self.area = 0.0;
        self.is_full = false;
        match axis.kind {
            AxisKind::FaceA(face) => self.clip_faces((a, face as usize, 0), (b, OF_B), is_bonded),
            AxisKind::FaceB(face) => self.clip_faces((b, face as usize, OF_B), (a, 0), is_bonded),
            AxisKind::Edges(edge_a, edge_b) => {
                let key = (edge_a & 0x3fff) << 16 | (edge_b & 0x3fff) | u32::from(OF_B);
                self.push_single(key, edge_contact(a, edge_a, b, edge_b), -axis.gap * PYRAMID);
            }
            AxisKind::Other => {}
        }
        if self.points.is_empty() {
            // The face that looks at the plane misses it: a corner beside it is deepest.
            let key = u32::from(WATERLINE);
            self.push_single(key, deepest_corners(a, b, axis), -axis.gap * PYRAMID);
        }
    }

    /// Contact at one point with the whole stiffness.
    pub fn set_single(&mut self, position: Vec3, overlap: f64) {
        self.points.clear();
        self.area = 0.0;
        self.is_full = true;
        self.push_single(0, position, overlap);
    }

    fn push_single(&mut self, key: u32, position: Vec3, overlap: f64) {
        self.points.push(PatchPoint {
            key,
            position,
            weight: 1.0,
            overlap,
        });
    }

    fn clip_faces(
        &mut self,
        reference: (&Polyhedron, usize, u16),
        other: (&Polyhedron, u16),
        is_bonded: bool,
    ) {
        let (body, face, mark) = reference;
        let (other, other_mark) = other;
        let n = body.face_normal(face);
        let incident = facing(other, &n);
        self.corners.clear();
        for e in other.face_loop(incident) {
            self.corners.push(Corner {
                x: other.vertices()[other.origin(e) as usize],
                side: side_name(e, other_mark),
            });
        }
        for e in body.face_loop(face) {
            let a = body.vertices()[body.origin(e) as usize];
            let outward = (body.vertices()[body.origin(body.next(e)) as usize] - a).cross(&n);
            self.clip(&outward, outward.dot(&a), side_name(e, mark));
        }
        let offset = body.face_offset(face);
        if !is_bonded {
            self.clip(&n, offset, WATERLINE);
        }
        self.is_full = self.corners.iter().all(|corner| corner.side != WATERLINE);
        while self.corners.len() > MAX_CORNERS {
            self.drop_least(&n);
        }
        self.push_fan(&n, offset);
    }

    /// Keeps what lies on the side `normal · x ≤ offset`.
    fn clip(&mut self, normal: &Vec3, offset: f64, side: u16) {
        self.spare.clear();
        let n = self.corners.len();
        for k in 0..n {
            let (from, to) = (self.corners[k], self.corners[(k + 1) % n]);
            let (before, after) = (normal.dot(&from.x) - offset, normal.dot(&to.x) - offset);
            let crossing = || from.x + (to.x - from.x) * (before / (before - after));
            if before <= 0.0 {
                self.spare.push(from);
                if after > 0.0 {
                    self.spare.push(Corner {
                        x: crossing(),
                        side,
                    });
                }
            } else if after <= 0.0 {
                self.spare.push(Corner {
                    x: crossing(),
                    side: from.side,
                });
            }
        }
        std::mem::swap(&mut self.corners, &mut self.spare);
    }

    /// Drops the corner that costs least area.
    fn drop_least(&mut self, n: &Vec3) {
        let count = self.corners.len();
        let lost = |k: usize| {
            let [a, b, c] = [k + count - 1, k, k + 1].map(|i| self.corners[i % count].x);
            (b - a).cross(&(c - a)).dot(n).abs()
        };
        let least = (0..count).min_by(|&i, &j| lost(i).total_cmp(&lost(j)));
        if let Some(k) = least {
            self.corners.remove(k);
        }
    }

    fn push_fan(&mut self, n: &Vec3, offset: f64) {
        let count = self.corners.len();
        if count < 3 {
            return;
        }
        let middle = self.corners.iter().map(|corner| corner.x).sum::<Vec3>() / count as f64;
        let corner = |k: usize| self.corners[k % count];
        // Seen along −n the loop of the other face runs clockwise.
        let area = |k: usize| {
            0.5 * (corner(k).x - middle)
                .cross(&(corner(k + 1).x - middle))
                .dot(n)
                .abs()
        };
        let total: f64 = (0..count).map(area).sum();
        if total.is_nan() || total <= 0.0 {
            return;
        }
        let points = &mut self.points;
        let mut push = |key: (u16, u16), x: Vec3, share: f64| {
            let overlap = offset - n.dot(&x);
            points.push(PatchPoint {
                key: u32::from(key.0) << 16 | u32::from(key.1),
                position: x + n * (0.5 * overlap),
                weight: share / (3.0 * total),
                overlap,
            });
        };
        for k in 0..count {
            let (before, here) = (corner(k + count - 1), corner(k));
            push(
                (before.side, here.side),
                0.5 * (middle + here.x),
                area((k + count - 1) % count) + area(k),
            );
            push(
                (here.side, here.side),
                0.5 * (here.x + corner(k + 1).x),
                area(k),
            );
        }
        self.area = total;
    }
}

fn side_name(half_edge: u32, mark: u16) -> u16 {
    (half_edge & 0x3fff) as u16 | mark
}

/// Of the faces at the corner that lies lowest in a direction, the one that looks most against it. Another
/// face may look more against it, but it lies higher: a spike is met before the flat beside it.
fn facing(body: &Polyhedron, n: &Vec3) -> usize {
    let mut lowest = (f64::INFINITY, 0);
    for (vertex, x) in body.vertices().iter().enumerate() {
        let height = n.dot(x);
        if height < lowest.0 {
            lowest = (height, vertex as u32);
        }
    }
    let mut best = (f64::INFINITY, 0);
    for face in body.faces_around_vertex(lowest.1) {
        let cos = body.face_normal(face).dot(n);
        if cos < best.0 {
            best = (cos, face);
        }
    }
    best.1
}

/// Middle between the closest points of two edges' lines, kept on the edges.
fn edge_contact(a: &Polyhedron, edge_a: u32, b: &Polyhedron, edge_b: u32) -> Vec3 {
    let ends = |body: &Polyhedron, e: u32| {
        let from = body.vertices()[body.origin(e) as usize];
        (from, body.vertices()[body.target(e) as usize] - from)
    };
    let ((p, u), (q, v)) = (ends(a, edge_a), ends(b, edge_b));
    let (uu, uv, vv) = (u.norm_squared(), u.dot(&v), v.norm_squared());
    let w = q - p;
    let determinant = uu * vv - uv * uv;
    let on_a = if determinant > 0.0 {
        ((w.dot(&u) * vv - w.dot(&v) * uv) / determinant).clamp(0.0, 1.0)
    } else {
        0.5
    };
    let on_b = (((p + u * on_a) - q).dot(&v) / vv).clamp(0.0, 1.0);
    0.5 * (p + u * on_a + q + v * on_b)
}

/// Mean, by depth, of the corners that overlap of the body without the plane's face, lifted to the middle
/// of the overlap. A mean, so that an edge that comes in level is not held at one end.
fn deepest_corners(a: &Polyhedron, b: &Polyhedron, axis: &Axis) -> Vec3 {
    let (body, toward) = match axis.kind {
        AxisKind::FaceB(_) => (a, axis.normal),
        _ => (b, -axis.normal),
    };
    let height = |x: &Vec3| x.dot(&toward);
    let highest = body
        .vertices()
        .iter()
        .map(height)
        .fold(f64::NEG_INFINITY, f64::max);
    let plane = highest + axis.gap;
    let (mut sum, mut total) = (Vec3::zeros(), 0.0);
    for x in body.vertices().iter().filter(|x| height(x) >= plane) {
        // Touching only, all count alike.
        let depth = if axis.gap < 0.0 {
            height(x) - plane
        } else {
            1.0
        };
        sum += x * depth;
        total += depth;
    }
    sum / total + toward * (0.5 * axis.gap)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::{Isometry, common_plane::separating_axes};

    fn touching(offset: Vec3, turn: f64) -> Patch {
        let a = Polyhedron::cuboid(Vec3::repeat(-0.5), Vec3::repeat(0.5)).unwrap();
        let b = a.transformed(&Isometry::new(offset, Vec3::z() * turn));
        let mut patch = Patch::default();
        patch.find(&a, &b, &separating_axes(&a, &b).best(), false);
        patch
    }

    #[test]
    fn area_of_two_unit_squares() {
        // D16
        let shifted = touching(Vec3::new(0.3, 0.2, 1.0 - 1e-4), 0.0);
        assert!((shifted.area - 0.56).abs() < 1e-12, "{}", shifted.area);
        let turned = touching(Vec3::new(0.0, 0.0, 1.0 - 1e-4), std::f64::consts::FRAC_PI_4);
        assert!(
            (turned.area - 2.0 * (2.0_f64.sqrt() - 1.0)).abs() < 1e-12,
            "{}",
            turned.area
        );
    }

    #[test]
    fn weights_integrate_quadratics() {
        let patch = touching(Vec3::new(0.3, 0.2, 1.0 - 1e-4), 0.0);
        let middle = Vec3::new(0.15, 0.1, 0.5);
        let sum = |f: &dyn Fn(&PatchPoint) -> f64| patch.points.iter().map(f).sum::<f64>();
        assert!((sum(&|p| p.weight) - 1.0).abs() < 1e-15);
        assert!(sum(&|p| p.weight * (p.position - middle).x).abs() < 1e-15);
        // Mean square distance from the middle of a side of 0.7 m.
        assert!((sum(&|p| p.weight * (p.position - middle).x.powi(2)) - 0.49 / 12.0).abs() < 1e-15);
        assert!(
            patch.is_full
                && patch
                    .points
                    .iter()
                    .all(|p| (p.overlap - 1e-4).abs() < 1e-15)
        );
    }

    #[test]
    fn keys_are_unique() {
        let patch = touching(Vec3::new(0.0, 0.0, 1.0 - 1e-4), 0.7);
        let mut keys: Vec<u32> = patch.points.iter().map(|p| p.key).collect();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), 16);
    }
}
