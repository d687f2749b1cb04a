//! Terms of the sums over neighbors, one file each.
//!
//! All pair forces are written with volumes, `F_ab = −V_a V_b f_ab ∇W_ab` with `f_ab = f_ba`: momentum
//! is conserved whatever the masses. `V = m/ρ`.

pub(crate) mod concentration;
pub(crate) mod continuity;
pub(crate) mod drag;
pub(crate) mod extrapolation;
pub(crate) mod gradient;
pub(crate) mod momentum;
pub(crate) mod summation;
pub(crate) mod sums;

pub(crate) use crate::simd::lanes3::{Lanes3, add_scaled, dot, minus, signed, splat3, totals};
