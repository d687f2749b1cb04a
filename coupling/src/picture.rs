//! Pictures of a run: the overview drawn with it, and rendered frames.

pub mod overview;
pub mod overview_data;
pub mod render;
