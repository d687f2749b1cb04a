//! Convex parts of blocks, for the contact search.

use std::sync::Arc;

use nalgebra::Matrix3;

use crate::geometry::bounds::Bounds;
use crate::geometry::shape::sphere_surface_point;
use crate::{Isometry, Polyhedron, Surface, SurfacePoint, Vec3};

/// One convex part.
#[derive(Clone, Debug)]
pub(crate) enum Part {
    /// Boxed: one sphere of thousands should not take the memory of a polyhedron.
    Polyhedron(Box<Polyhedron>),
    Sphere {
        center: Vec3,
        radius: f64,
    },
    /// Never moves.
    Surface(Arc<Surface>),
}

impl Part {
    /// Becomes `reference` rotated and translated; both are of one kind. Allocates nothing.
    pub fn set_transformed(&mut self, reference: &Self, placement: &Isometry) {
        match (self, reference) {
            (Self::Polyhedron(this), Self::Polyhedron(reference)) => {
                this.set_transformed(reference, placement)
            }
            (
                Self::Sphere { center, .. },
                Self::Sphere {
                    center: reference, ..
                },
            ) => {
                *center = placement.transform_point(&(*reference).into()).coords;
            }
            _ => {}
        }
    }

    /// Becomes `reference` under `x = shift + gradient X`; a sphere only moves its center. Allocates
    /// nothing.
    pub fn set_deformed(&mut self, reference: &Self, gradient: &Matrix3<f64>, shift: &Vec3) {
        match (self, reference) {
            (Self::Polyhedron(this), Self::Polyhedron(reference)) => {
                this.set_deformed(reference, gradient, shift);
            }
            (
                Self::Sphere { center, .. },
                Self::Sphere {
                    center: reference, ..
                },
            ) => *center = gradient * *reference + shift,
            _ => {}
        }
    }

    pub fn aabb(&self) -> Bounds {
        match self {
            Self::Polyhedron(body) => body.aabb(),
            Self::Sphere { center, radius } => {
                (center.add_scalar(-radius), center.add_scalar(*radius))
            }
            Self::Surface(surface) => surface.aabb(),
        }
    }

    /// Cube root of the volume, infinite for a surface; m.
    pub fn size(&self) -> f64 {
        match self {
            Self::Polyhedron(body) => body.size(),
            Self::Sphere { radius, .. } => radius * (4.0 / 3.0 * std::f64::consts::PI).cbrt(),
            Self::Surface(_) => f64::INFINITY,
        }
    }

    pub fn is_surface(&self) -> bool {
        matches!(self, Self::Surface(_))
    }

    pub fn is_sphere(&self) -> bool {
        matches!(self, Self::Sphere { .. })
    }

    /// Smallest thickness, measured across faces, infinite for a surface; m.
    pub fn thickness(&self) -> f64 {
        match self {
            Self::Polyhedron(body) => body.thickness(),
            Self::Sphere { radius, .. } => 2.0 * radius,
            Self::Surface(_) => f64::INFINITY,
        }
    }

    /// Farthest point from a point; m.
    pub fn reach_from(&self, x: &Vec3) -> f64 {
        let farthest =
            |corners: &[Vec3]| corners.iter().map(|v| (v - x).norm()).fold(0.0, f64::max);
        match self {
            Self::Polyhedron(body) => farthest(body.vertices()),
            Self::Surface(surface) => farthest(surface.vertices()),
            Self::Sphere { center, radius } => (center - x).norm() + radius,
        }
    }

    pub fn surface_point_within(&self, x: &Vec3, cutoff: f64) -> Option<SurfacePoint> {
        match self {
            Self::Polyhedron(body) => body.surface_point_within(x, cutoff),
            Self::Sphere { center, radius } => Some(sphere_surface_point(center, *radius, x))
                .filter(|surface| surface.distance <= cutoff),
            Self::Surface(surface) => surface.surface_point_within(x, cutoff),
        }
    }
}

/// Parts may gape by this where they adjoin; × size.
const JOIN_TOLERANCE: f64 = 1e-3;

/// Notes the faces of a body that others cover entirely, and the extensions of the others from its corners. The others never move
/// relative to it.
pub(crate) fn note_neighbors(body: &mut Polyhedron, others: &[&Polyhedron]) {
    for face in 0..body.n_faces() {
        if is_covered(body, face, others) {
            body.hide_face(face);
        }
    }
    let slack = JOIN_TOLERANCE * body.size();
    let extensions = |x: &Vec3| -> Vec<Vec3> {
        let holders = others.iter().filter(|other| holds(other, x, slack));
        holders
            .flat_map(|other| other.vertices().iter().map(|v| v - x))
            .filter(|offset| offset.norm() > slack)
            .collect()
    };
    let at = |v: u32| body.vertices()[v as usize];
    let mut beyond: Vec<Vec<Vec3>> = body.vertices().iter().map(extensions).collect();
    beyond.extend(body.half_edges().map(|e| {
        if e < body.twin(e) {
            extensions(&(0.5 * (at(body.origin(e)) + at(body.target(e)))))
        } else {
            Vec::new()
        }
    }));
    body.set_beyond(&beyond);
}

fn holds(body: &Polyhedron, x: &Vec3, slack: f64) -> bool {
    (0..body.n_faces()).all(|face| body.plane_distance(face, x) <= slack)
}

/// True if other bodies cover a face: sampled at the middle of the face and points near its corners and sides, a little outside.
fn is_covered(body: &Polyhedron, face: usize, others: &[&Polyhedron]) -> bool {
    let corners: Vec<Vec3> = body
        .face_vertices(face)
        .map(|v| body.vertices()[v as usize])
        .collect();
    let n = corners.len();
    let middle = corners.iter().sum::<Vec3>() / n as f64;
    let slack = JOIN_TOLERANCE * body.size();
    let outside = body.face_normal(face) * (2.0 * slack);
    let is_inside = |x: Vec3| others.iter().any(|other| holds(other, &x, slack));
    is_inside(middle + outside)
        && (0..n).all(|k| {
            let side = 0.5 * (corners[k] + corners[(k + 1) % n]);
            [0.999, 0.9, 0.66, 0.33].iter().all(|share| {
                [corners[k], side]
                    .iter()
                    .all(|x| is_inside(middle + (x - middle) * *share + outside))
            })
        })
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn hidden(body: &Polyhedron, others: &[Polyhedron]) -> Vec<usize> {
        let mut body = body.clone();
        note_neighbors(&mut body, &others.iter().collect::<Vec<_>>());
        (0..body.n_faces())
            .filter(|&face| body.is_hidden(face))
            .collect()
    }

    #[test]
    fn only_faces_that_are_covered_all_over_are_hidden() {
        let cube = Polyhedron::cuboid(Vec3::zeros(), Vec3::repeat(1.0)).unwrap();
        let beside =
            |y: f64| Polyhedron::cuboid(Vec3::new(1.0, y, 0.0), Vec3::new(2.0, 1.0, 1.0)).unwrap();
        assert_eq!(hidden(&cube, &[beside(0.0)]), [5]); // +x
        assert_eq!(hidden(&cube, &[beside(0.1)]), [0; 0]);
        assert_eq!(hidden(&cube, &[]), [0; 0]);
        // A slope that ends where a bed begins.
        let slope = Polyhedron::extrusion(
            &[[-5.0, -1.0], [0.0, -1.0], [0.0, 0.0], [-5.0, 2.9]],
            1,
            -2.0,
            2.0,
        )
        .unwrap();
        let bed = Polyhedron::cuboid(Vec3::new(0.0, -2.0, -1.0), Vec3::new(8.0, 2.0, 0.0)).unwrap();
        assert_eq!(hidden(&bed, &slope), [4]); // −x
        assert_eq!(hidden(&slope[0], std::slice::from_ref(&bed)).len(), 1);
        // The bed's end is no corner of the whole, from whatever side.
        let mut bed = bed;
        note_neighbors(&mut bed, &[&slope[0]]);
        let end = bed
            .vertices()
            .iter()
            .position(|x| x.x == 0.0 && x.z == 0.0)
            .unwrap() as u32;
        assert!(
            !bed.is_corner(end, &Vec3::new(-0.866, 0.0, 0.5))
                && !bed.is_corner(end, &Vec3::new(0.0, -0.1, 0.1))
        );
        // Where two halves of a box meet, its corners stay corners.
        let halves = [beside(0.0), cube.clone()];
        let mut first = cube;
        note_neighbors(&mut first, &[&halves[0]]);
        let seam = first
            .vertices()
            .iter()
            .position(|x| *x == Vec3::repeat(1.0))
            .unwrap() as u32;
        assert!(
            first.is_corner(seam, &Vec3::new(0.0, 1.0, 1.0))
                && !first.is_corner(seam, &Vec3::repeat(1.0))
        );
    }
}
