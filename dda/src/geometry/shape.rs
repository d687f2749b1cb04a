//! Shape of a block: a rigid union of convex polyhedra, or a sphere.

use std::sync::Arc;

use crate::{Isometry, MassProperties, Polyhedron, Surface, SurfacePoint, Vec3, mass_properties};
use nalgebra::Matrix3;

/// Geometry of a block, in its world placement at the start.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A rigid union of convex parts that adjoin but do not overlap: volume and moments are sums
    /// over the parts.
    Polyhedra(Vec<Polyhedron>),
    /// A sphere.
    Sphere {
        /// Center; m.
        center: Vec3,
        /// Radius; m.
        radius: f64,
    },
    /// Terrain or another surface of triangles, solid behind it. Has no volume and must be fixed.
    Surface(Arc<Surface>),
}

impl Shape {
    /// Volume; m³.
    pub fn volume(&self) -> f64 {
        self.mass_properties().volume
    }

    /// Smallest thickness of any part, measured across faces, infinite for a surface; m.
    pub fn thickness(&self) -> f64 {
        match self {
            Self::Polyhedra(parts) => parts
                .iter()
                .map(Polyhedron::thickness)
                .fold(f64::INFINITY, f64::min),
            Self::Sphere { radius, .. } => 2.0 * radius,
            Self::Surface(_) => f64::INFINITY,
        }
    }

    /// Volume, centroid and second moment for density 1.
    pub fn mass_properties(&self) -> MassProperties {
        match self {
            Self::Polyhedra(parts) => {
                let parts: Vec<MassProperties> = parts.iter().map(mass_properties).collect();
                MassProperties::of_union(&parts)
            }
            Self::Sphere { center, radius } => MassProperties::of_sphere(*center, *radius),
            Self::Surface(surface) => {
                let (lower, upper) = surface.aabb();
                MassProperties {
                    volume: 0.0,
                    centroid: 0.5 * (lower + upper),
                    second_moment: Matrix3::zeros(),
                }
            }
        }
    }

    /// Lower and upper corner of the axis-aligned box around it; m.
    pub fn aabb(&self) -> (Vec3, Vec3) {
        match self {
            Self::Polyhedra(parts) => parts.iter().map(Polyhedron::aabb).fold(
                (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)),
                |all, part| (all.0.inf(&part.0), all.1.sup(&part.1)),
            ),
            Self::Sphere { center, radius } => {
                let half = Vec3::repeat(*radius);
                (center - half, center + half)
            }
            Self::Surface(surface) => surface.aabb(),
        }
    }

    /// The shape, rotated and translated.
    pub fn transformed(&self, placement: &Isometry) -> Self {
        match self {
            Self::Polyhedra(parts) => Self::Polyhedra(
                parts
                    .iter()
                    .map(|part| part.transformed(placement))
                    .collect(),
            ),
            Self::Sphere { center, radius } => Self::Sphere {
                center: placement.transform_point(&(*center).into()).coords,
                radius: *radius,
            },
            Self::Surface(surface) => Self::Surface(Arc::new(surface.transformed(placement))),
        }
    }

    /// Signed distance to the surface, with foot and normal.
    ///
    /// Exact outside every part, and inside a single part. Inside a union the faces between parts
    /// count as surface, so that the depth is a lower bound there.
    pub fn signed_distance(&self, x: &Vec3) -> SurfacePoint {
        match self {
            Self::Polyhedra(parts) => parts
                .iter()
                .filter_map(|part| part.surface_point_within(x, f64::INFINITY))
                .reduce(|best, this| if closer(&this, &best) { this } else { best }),
            Self::Sphere { center, radius } => Some(sphere_surface_point(center, *radius, x)),
            Self::Surface(surface) => surface.surface_point_within(x, f64::INFINITY),
        }
        .unwrap_or(SurfacePoint {
            distance: f64::INFINITY,
            normal: Vec3::z(),
            point: *x,
        })
    }
}

/// Outside all parts the nearest counts, inside some the deepest: both have the least distance.
fn closer(this: &SurfacePoint, best: &SurfacePoint) -> bool {
    this.distance < best.distance
}

/// Closest point of a sphere; from its center, any direction is right and up is taken.
pub(crate) fn sphere_surface_point(center: &Vec3, radius: f64, x: &Vec3) -> SurfacePoint {
    let offset = x - center;
    let from_center = offset.norm();
    let normal = if from_center > 0.0 {
        offset / from_center
    } else {
        Vec3::z()
    };
    SurfacePoint {
        distance: from_center - radius,
        normal,
        point: center + normal * radius,
    }
}
