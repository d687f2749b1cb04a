//! Exact distance from a point to the surface of a convex polyhedron.
//!
//! This is the critical query of the coupling with a fluid: no allocation, and a point
//! beyond the cutoff is rejected by the first face plane with a larger distance.

use crate::{Polyhedron, Vec3};

/// The point of a surface that is closest to a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Distance to the surface, negative inside the body; m.
    pub distance: f64,
    /// Outward unit normal: from the foot to the query point outside, reversed inside.
    pub normal: Vec3,
    /// Foot, the closest point of the surface; m.
    pub point: Vec3,
}

/// Closer to an edge or corner than this, the direction to the foot is noise and the mean normal of the
/// faces that meet there stands in; × L.
const CONTACT_TOLERANCE: f64 = 1e-12;

/// Surfaces that rise by less are one plane; –.
const ROUND_OFF: f64 = 1e-9;

impl Polyhedron {
    /// Closest point of the surface, exact also over edges and corners, or `None` if the point is
    /// farther outside than `cutoff` (m). A point inside is never rejected.
    ///
    /// Inside, the closest point of a convex body lies on the face whose plane is nearest. Outside,
    /// the plane distances bound the distance from below; a foot within its face is the
    /// result, otherwise the closest of the edge points of the faces visible from the point.
    pub fn surface_point_within(&self, x: &Vec3, cutoff: f64) -> Option<SurfacePoint> {
        let mut nearest = 0;
        let mut highest = f64::NEG_INFINITY;
        for face in 0..self.n_faces() {
            let height = self.plane_distance(face, x);
            if height > highest {
                if height > cutoff {
                    return None;
                }
                highest = height;
                nearest = face;
            }
        }
        let over_face = |face: usize, height: f64| {
            let normal = self.face_normal(face);
            SurfacePoint {
                distance: height,
                normal,
                point: x - normal * height,
            }
        };
        let slack = CONTACT_TOLERANCE * self.size();
        if highest.abs() <= slack
            && let Some(normal) = self.normal_at_seam(x, slack)
        {
            return Some(SurfacePoint {
                distance: highest,
                normal,
                point: x - normal * highest,
            });
        }
        if highest <= 0.0 || self.is_over_face(nearest, x) {
            return Some(over_face(nearest, highest));
        }
        let mut best = f64::INFINITY;
        let mut foot = *x;
        for face in 0..self.n_faces() {
            let height = self.plane_distance(face, x);
            if height <= 0.0 {
                continue;
            }
            if face != nearest && self.is_over_face(face, x) {
                return Some(over_face(face, height));
            }
            for e in self.face_loop(face) {
                let (square, point) = self.closest_on_edge(e, x);
                if square < best {
                    best = square;
                    foot = point;
                }
            }
        }
        let distance = best.sqrt();
        if distance > cutoff {
            return None;
        }
        if distance <= slack {
            return Some(over_face(nearest, highest));
        }
        Some(SurfacePoint {
            distance,
            normal: (x - foot) / distance,
            point: foot,
        })
    }

    /// Mean normal of the faces that meet in an edge or a corner at `x`, which is closer than `slack` (m) to all of their planes
    /// or behind them; `None` on a single face.
    fn normal_at_seam(&self, x: &Vec3, slack: f64) -> Option<Vec3> {
        let mut sum = Vec3::zeros();
        let mut first = None;
        let mut is_seam = false;
        for face in 0..self.n_faces() {
            if self.plane_distance(face, x).abs() <= slack {
                let normal = self.face_normal(face);
                is_seam |= *first.get_or_insert(normal) != normal;
                sum += normal;
            }
        }
        is_seam.then(|| sum.normalize())
    }

    /// As [`Self::surface_point_within`], for a sphere around `x` (m) that touches: none where another surface
    /// goes on from the edge or corner that is closest, so that a sphere rolls over seams.
    pub(crate) fn touch_point_within(&self, x: &Vec3, cutoff: f64) -> Option<SurfacePoint> {
        let surface = self.surface_point_within(x, cutoff)?;
        if !self.has_seams() || surface.distance <= 0.0 {
            return Some(surface);
        }
        let slack = CONTACT_TOLERANCE * self.size();
        let meets = |v: u32| self.is_farthest(v, &surface.normal, ROUND_OFF);
        let is_foot = |from: u32, to: u32| {
            let a = self.vertices()[from as usize];
            let along = self.vertices()[to as usize] - a;
            let share = (surface.point - a).dot(&along) / along.norm_squared();
            let is_on = (surface.point - a - along * share.clamp(0.0, 1.0)).norm() <= slack;
            is_on.then_some(share)
        };
        for face in 0..self.n_faces() {
            // Within a face there is no edge.
            if self.face_normal(face) == surface.normal {
                return Some(surface);
            }
            for e in self.face_loop(face) {
                let (from, to) = (self.origin(e), self.origin(self.next(e)));
                let Some(share) = is_foot(from, to) else {
                    continue;
                };
                let length = (self.vertices()[to as usize] - self.vertices()[from as usize]).norm();
                let end = slack / length;
                let is_free = if share <= end {
                    meets(from)
                } else if share >= 1.0 - end {
                    meets(to)
                } else {
                    self.is_farthest_edge(e, &surface.normal, ROUND_OFF)
                };
                return is_free.then_some(surface);
            }
        }
        Some(surface)
    }

    /// Does the point project into the face?
    fn is_over_face(&self, face: usize, x: &Vec3) -> bool {
        let normal = self.face_normal(face);
        self.face_loop(face).all(|e| {
            let a = self.vertices()[self.origin(e) as usize];
            let b = self.vertices()[self.origin(self.next(e)) as usize];
            normal.dot(&(b - a).cross(&(x - a))) >= 0.0
        })
    }

    /// Squared distance to an edge and the point of it that is closest.
    fn closest_on_edge(&self, half_edge: u32, x: &Vec3) -> (f64, Vec3) {
        let a = self.vertices()[self.origin(half_edge) as usize];
        let along = self.vertices()[self.origin(self.next(half_edge)) as usize] - a;
        let share = ((x - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        let point = a + along * share;
        ((x - point).norm_squared(), point)
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn box_faces_edges_corners_inside() {
        let cube = Polyhedron::cuboid(Vec3::zeros(), Vec3::repeat(1.0)).unwrap();
        let cases = [
            // query, distance, foot
            ([0.4, 0.3, 1.2], 0.2, [0.4, 0.3, 1.0]),
            ([0.4, 1.3, 1.4], 0.5, [0.4, 1.0, 1.0]),
            ([1.2, 1.3, 1.6], 0.7, [1.0, 1.0, 1.0]),
            ([0.4, 0.1, 0.5], -0.1, [0.4, 0.0, 0.5]),
            ([0.4, 1.0, 0.5], 0.0, [0.4, 1.0, 0.5]),
        ];
        for (x, distance, foot) in cases {
            let x = Vec3::from(x);
            let found = cube.surface_point_within(&x, 1.0).unwrap();
            assert!(
                (found.distance - distance).abs() < 1e-15,
                "{x:?}: {found:?}"
            );
            assert!((found.point - Vec3::from(foot)).norm() < 1e-15);
            assert!((found.normal.norm() - 1.0).abs() < 1e-15);
            assert!((x - found.normal * found.distance - found.point).norm() < 1e-15);
        }
        // On an edge and in a corner the way out is between the faces.
        for (x, normal) in [([0.4, 1.0, 1.0], [0.0, 1.0, 1.0]), ([0.0; 3], [-1.0; 3])] {
            let found = cube.surface_point_within(&Vec3::from(x), 1.0).unwrap();
            assert_eq!((found.distance, found.point), (0.0, Vec3::from(x)));
            assert!((found.normal - Vec3::from(normal).normalize()).norm() < 1e-15);
        }
        // Every plane is nearer than the cutoff, the corner is not.
        assert_eq!(
            cube.surface_point_within(&Vec3::new(1.2, 1.3, 1.6), 0.65),
            None
        );
    }
}
