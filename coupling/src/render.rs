//! wip
pub mod surface;
