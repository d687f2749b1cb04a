//! From scene text to a checked scene.

pub mod error;
pub mod file;
