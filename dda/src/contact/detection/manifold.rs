//! Contact manifolds: where two bodies touch, whatever the law that acts there.

use super::common_plane::AxisKind;
use crate::Vec3;
use serde::{Deserialize, Serialize};

/// One point of a manifold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ManifoldPoint {
    /// Names the point by the features it comes from; the same while the same features touch.
    pub key: u32,
    /// World; m.
    pub position: Vec3,
    /// Factor on the pair's stiffness: its share, or m² for a stiffness per area.
    pub weight: f64,
    /// Overlap, negative where a bonded patch has opened; m.
    pub overlap: f64,
}

impl ManifoldPoint {
    /// Only point of a contact, with the overlap (m) and in the middle of it.
    pub fn single(position: Vec3, overlap: f64) -> [Self; 1] {
        [Self {
            key: 0,
            position,
            weight: 1.0,
            overlap,
        }]
    }
}

/// Features that form a manifold. Springs of other features have a potential of their own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Features {
    /// Common plane of two polyhedra, and the facing face of the other body; `None` if the contact is a point.
    CommonPlane(AxisKind, Option<u32>),
    /// Plane or vertex of a surface of triangles.
    SurfacePlane(u32),
}

/// Points where two bodies touch, and the plane between them.
///
/// The points of two polyhedra lie in a list that is used again, the point of a sphere in the manifold itself, and those of a
/// body on a surface in columns that its planes share.
#[derive(Clone, Debug, Default)]
pub(crate) struct Manifold<Points> {
    /// Unit, from i to j.
    pub normal: Vec3,
    pub features: Option<Features>,
    /// Area of the overlap, projected on the plane; m². Zero for a point contact.
    pub area: f64,
    /// Weight of the points if the faces lay flat on each other; what shear stiffness refers to.
    pub flat_weight: f64,
    /// Deepest overlap along the normal; m.
    pub depth: f64,
    pub points: Points,
}

/// Contact in a single point.
pub(crate) type PointManifold = Manifold<[ManifoldPoint; 1]>;

impl PointManifold {
    /// Contact in a point of a smooth body.
    pub fn single(normal: Vec3, position: Vec3, overlap: f64) -> Self {
        Self {
            normal,
            features: None,
            area: 0.0,
            flat_weight: 1.0,
            depth: overlap,
            points: ManifoldPoint::single(position, overlap),
        }
    }

    /// World; m.
    pub fn position(&self) -> &Vec3 {
        &self.points[0].position
    }
}
