//! Symplectic Euler: kick-drift-kick with velocities half a step behind. Geraili Mikola & Sitar (2014).
//!
//! ```text
//! 1 a kick                      v₁ = v + dt a
//! 2 bodies move by dt
//! 3 drift                       x₁ = x + dt v₁
//! 4 evaluation at the end
//! ```
//! Only with density by summation: with continuity it is forward Euler for sound.

use crate::Fluid;
use crate::boundary::{Boundary, Part};

pub(super) fn step<B: Boundary>(
    fluid: &mut Fluid,
    boundary: &mut B,
    dt: f64,
) -> Result<(), B::Error> {
    fluid.kicked(boundary, dt, Fluid::kick);
    boundary.advance(Part::Whole, dt)?;
    fluid.drift_with_density(boundary, dt)?;
    fluid.evaluate(boundary, dt)
}
