//! Many runs: studies of accuracy against cost, sweeps over inputs, and comparison with measurements.

pub mod compare;
pub mod jobs;
pub mod scenes;
pub mod sweep;
pub mod trade;
pub mod umbridge;
