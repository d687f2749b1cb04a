//! File formats shared by several wings: tables (CSV), VTK, and the points, lines and polygons of maps.

pub mod features;
pub mod points;
pub(crate) mod rows;
pub mod table;
pub mod units;
pub mod vtk;
