//! Contact: geometry by detection, forces by a law.

pub(crate) mod detection;
pub(crate) mod penalty;
