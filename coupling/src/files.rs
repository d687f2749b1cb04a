//! File formats shared by several wings: tables (CSV) and VTK.

pub mod table;
pub mod vtk;
