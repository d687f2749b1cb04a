//! File formats that more than one wing reads or writes: tables (CSV) and VTK.

pub mod table;
pub mod vtk;
