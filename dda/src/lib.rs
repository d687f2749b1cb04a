//! Explicit three-dimensional discontinuous deformation analysis of polyhedral rock blocks.

mod distance;
mod measure;
mod polyhedron;
mod shape;

/// Vector of three `f64`.
pub type Vec3 = nalgebra::Vector3<f64>;
/// Turn and shift.
pub type Isometry = nalgebra::Isometry3<f64>;

pub use distance::SurfacePoint;
pub use measure::{MassProperties, face_area, mass_properties, volume};
pub use polyhedron::{Polyhedron, PolyhedronError};
pub use shape::Shape;
