//! Rock blocks and water in one explicit engine: scene, world, run, observers, files.

pub mod scene;
pub mod vtk;
