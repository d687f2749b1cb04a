//! Geometry of scenes: meshes, shapes, basins, overlaps, each against an exact expectation.

mod fill;
mod mesh;
mod ply;
mod shape;
mod split;
