//! Kick-drift-kick, the density advanced in the middle of the drift: second order, and reversible where nothing is lost.
//!
//! ```text
//! 1 half a kick                                   v½ = v + dt/2 a
//! 2 bodies move by dt
//! 3 drift; density half way, at x½ and v½         x₁ = x + dt v½,   ρ₁ = ρ + dt ρ'½
//! 4 evaluation at the end
//! 5 half a kick                                   v₁ = v½ + dt/2 a₁
//! ```
//! The density must not be advanced with the old velocities while these use the old density: every sound wave would
//! grow, whatever the step.

use crate::Fluid;
use crate::boundary::{Boundary, Part};

pub(super) fn step<B: Boundary>(
    fluid: &mut Fluid,
    boundary: &mut B,
    dt: f64,
) -> Result<(), B::Error> {
    fluid.kicked(boundary, 0.5 * dt, Fluid::kick);
    boundary.advance(Part::Whole, dt)?;
    fluid.drift_with_density(boundary, dt)?;
    fluid.evaluate(boundary, dt)?;
    fluid.kicked(boundary, 0.5 * dt, Fluid::kick);
    Ok(())
}
