//! Bulk viscosity: a pressure against compression, which damps sound and leaves a flow that keeps its volume alone.
//!
//! ```text
//! q_a = ζ D_a,   D_a = ρ'_a/ρ_a = Σ_b V_b v_ab·∇W,   ζ = α₂ ρ₀ c₀ h                   [Pa]
//! dE/dt = −Σ_a V_a q_a D_a                                                            [W]
//! ```
//! ρ' is the rate of density without its diffusion. A wave of sound decays at `ζ k²/(2ρ)`; rotation and shear have no D.
//!
//! `q` is part of the pressure of a particle for all that reads one: pairs of particles, walls, bodies, gauges. Walls
//! continue the pressure of the water, and act and answer by one pair force: with `q` in all of it, or in none, momentum is
//! exact. In all of it a particle at a wall is damped by the same D that the wall's part of its rate makes, and the loss is
//! the sum above; water at rest has no D, and stays as still.
//!
//! Kick-drift-kick takes D half a step before the force, where the rates are: to a wave, Euler's rule for the damping.

use nalgebra::Vector2;
use rayon::prelude::*;

use crate::fluid::advance::FEWEST_NEIGHBORS;
use crate::fluid::energy::fixed_order_sum;
use crate::neighbors::rest::Still;
use crate::state_equation::NegativePressure;
use crate::{CHUNK, Fluid, Particles};

impl Fluid {
    /// Pressures of bulk viscosity from the rates of density just found, those of walls included.
    pub(crate) fn update_bulk_pressure(&mut self) {
        let viscosity = self.settings.bulk_viscosity();
        if viscosity == 0.0 {
            return;
        }
        let Particles {
            density,
            bulk_pressure,
            ..
        } = &mut self.particles;
        bulk_pressure.resize(density.len(), 0.0);
        let still = Still::of(self.sleep.as_deref());
        let rates = &self.scratch.rates;
        bulk_pressure
            .par_chunks_mut(CHUNK)
            .zip(density.par_chunks(CHUNK))
            .enumerate()
            .filter(|(chunk, _)| !still.has(*chunk))
            .for_each(|(chunk, (pressure, density))| {
                for (a, (q, rho)) in (chunk * CHUNK..).zip(pressure.iter_mut().zip(density)) {
                    let rate = rates.of(a);
                    // a drop has no pressure
                    *q = if rate.n_found <= FEWEST_NEIGHBORS {
                        0.0
                    } else {
                        viscosity * rate.flow / rho
                    };
                }
            });
    }

    /// Adds them to the pressures of the equation of state just found, with the same particles left out; tension is
    /// clamped where the scheme does.
    pub(super) fn add_bulk_pressure(&mut self) {
        let still = Still::kept(self.sleep.as_deref(), |kept| kept.pressure);
        let is_clamped = self.settings.scheme.negative_pressure == NegativePressure::Clamped;
        let Particles {
            pressure,
            bulk_pressure,
            ..
        } = &mut self.particles;
        pressure
            .par_chunks_mut(CHUNK)
            .zip(bulk_pressure.par_chunks_mut(CHUNK))
            .enumerate()
            .filter(|(chunk, _)| !still.has(*chunk))
            .for_each(|(_, (pressure, bulk))| {
                for (p, q) in pressure.iter_mut().zip(bulk) {
                    if is_clamped {
                        *q = q.max(-*p);
                    }
                    *p += *q;
                }
            });
    }

    /// Books the work of the present pressures of bulk viscosity in a kick of `dt` (s), by the rates of density nearest to
    /// it: the error of the booking is of second order in the step, as that of the energy itself.
    pub(crate) fn book_bulk(&mut self, dt: f64) {
        let Particles {
            density,
            mass,
            bulk_pressure,
            ..
        } = &self.particles;
        let rates = &self.scratch.rates;
        if rates.len() != density.len() {
            return;
        }
        // against all compression, and against the part that walls make
        let power = fixed_order_sum(bulk_pressure.len(), |a| {
            let factor = mass[a] * bulk_pressure[a] / (density[a] * density[a]);
            factor * Vector2::new(rates.of(a).flow, rates.by_walls(a))
        });
        self.bulk_loss += power.x * dt;
        self.from_walls += power.y * dt;
    }

    /// Energy taken by bulk viscosity since the ledger was opened; J.
    pub fn bulk_loss(&self) -> f64 {
        self.bulk_loss
    }
}
