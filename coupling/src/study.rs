//! Many runs: studies of accuracy against cost, and comparison with measurements.

pub mod compare;
pub mod trade;
