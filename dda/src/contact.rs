//! Contact: geometry by detection, forces by a law.

pub(crate) mod bond;
pub(crate) mod context;
pub(crate) mod detection;
pub mod dynamics;
pub(crate) mod penalty;
pub(crate) mod rates;
pub(crate) mod report;
pub(crate) mod spread;
pub(crate) mod spring;
pub(crate) mod tally;
