//! Geometry of scenes: meshes, shapes, basins, overlaps, each against an exact expectation.

#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test may stop where a library may not, and prints what it measured"
)]

#[path = "geometry/fill.rs"]
mod fill;
#[path = "geometry/mesh.rs"]
mod mesh;
#[path = "geometry/shape.rs"]
mod shape;
