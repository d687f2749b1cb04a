//! Convex parts of blocks, as the contact search sees them.

use crate::{
    Isometry, Polyhedron, SurfacePoint, Vec3, broad_phase::Bounds, shape::sphere_surface_point,
};

/// One convex part.
#[derive(Clone, Debug)]
pub(crate) enum Part {
    Polyhedron(Polyhedron),
    Sphere { center: Vec3, radius: f64 },
}

impl Part {
    /// Becomes `reference` turned and shifted; both are of one kind. Allocates nothing.
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

    pub fn aabb(&self) -> Bounds {
        match self {
            Self::Polyhedron(body) => body.aabb(),
            Self::Sphere { center, radius } => {
                (center.add_scalar(-radius), center.add_scalar(*radius))
            }
        }
    }

    /// Cube root of the volume; m.
    pub fn size(&self) -> f64 {
        match self {
            Self::Polyhedron(body) => body.size(),
            Self::Sphere { radius, .. } => radius * (4.0 / 3.0 * std::f64::consts::PI).cbrt(),
        }
    }

    /// Farthest point from a point; m.
    pub fn reach_from(&self, x: &Vec3) -> f64 {
        match self {
            Self::Polyhedron(body) => body
                .vertices()
                .iter()
                .map(|v| (v - x).norm())
                .fold(0.0, f64::max),
            Self::Sphere { center, radius } => (center - x).norm() + radius,
        }
    }

    pub fn surface_point_within(&self, x: &Vec3, cutoff: f64) -> Option<SurfacePoint> {
        match self {
            Self::Polyhedron(body) => body.surface_point_within(x, cutoff),
            Self::Sphere { center, radius } => Some(sphere_surface_point(center, *radius, x))
                .filter(|surface| surface.distance <= cutoff),
        }
    }
}
