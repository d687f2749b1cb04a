//! Pictures of a run: the overview drawn with it, rendered frames, a page that plays it, and a script that opens it in ParaView.

pub(crate) mod chart;
pub mod color;
pub mod overview;
pub mod overview_data;
pub mod paraview;
pub mod render;
pub mod report;
