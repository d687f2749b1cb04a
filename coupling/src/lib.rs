//! Rock blocks and water in one explicit engine: scene, world, run, observers, files.

pub mod render;
pub mod scene;
pub mod vtk;
