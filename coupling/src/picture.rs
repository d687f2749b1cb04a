//! Pictures of a run: the overview drawn with it, rendered frames, and a page that plays it.

pub(crate) mod chart;
pub mod color;
pub mod overview;
pub mod overview_data;
pub mod render;
pub mod report;
