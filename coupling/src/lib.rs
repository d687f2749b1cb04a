//! Rock blocks and water in one explicit engine: scene, world, run, observers, files.

pub mod compare;
pub mod overview;
pub mod scene;
pub mod table;
pub mod vtk;
