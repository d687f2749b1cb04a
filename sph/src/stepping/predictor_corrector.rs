//! Predictor-corrector: rates and forces at the start advance the state to the middle, and those at the middle advance it
//! from the start to the end. Second order. Domínguez et al. (2022), see [`crate::scheme::Stepping`].
//!
//! ```text
//! 1 prediction                          v½ = v + dt/2 a,    x½ = x + dt/2 v,    ρ½ = ρ + dt/2 ρ'
//! 2 bodies move by dt/2
//! 3 rates and forces half way
//! 4 correction                          v₁ = v + dt a½,     ρ₁ = ρ (2 − ε)/(2 + ε),   ε = −(ρ'/ρ)½ dt
//! 5 bodies move by dt/2
//! 6 half a drift                        x₁ = x + dt/2 (v + v₁)
//! 7 evaluation at the end, rates too
//! ```

use rayon::prelude::*;

use crate::boundary::{Boundary, Part, Phase, Stage};
use crate::scheme::{DIFFUSION, DensityDiffusion};
use crate::{CHUNK, Fluid, Particles};

/// Largest step over `h/c₀` of the predictor-corrector with continuity and the usual density diffusion: the
/// same share of the lattice's 0.907 as kick-drift-kick has of its 1.54.
const SOUND: f64 = 0.59;

pub(super) fn step<B: Boundary>(
    fluid: &mut Fluid,
    boundary: &mut B,
    dt: f64,
) -> Result<(), B::Error> {
    let half = 0.5 * dt;
    fluid.predict(half);
    boundary.predicted(fluid);
    boundary.ended(Phase::Integration);
    boundary.advance(Part::FirstHalf, half)?;
    // no inflow, outflow, push-back or shifting half way, which the corrector would undo
    fluid.sorted(boundary)?;
    boundary.place(fluid, Stage::Predicted, half);
    boundary.hold(fluid, Stage::Predicted, half);
    fluid.evaluate_forces(boundary)?;
    fluid.kicked(boundary, dt, Fluid::correct);
    boundary.advance(Part::SecondHalf, half)?;
    fluid.drift(half);
    fluid.evaluate(boundary, dt)
}

/// Largest step of the predictor-corrector with continuity over `h/c₀`.
///
/// A wave grows by `(ω dt)⁴/8` per step and diffusion damps it by `D dt/2`, `D ∝ δ`: the limit scales with the cube root of
/// δ. Without diffusion there is no limit, and viscosity has to damp the growth; more than the usual diffusion does not help.
/// Bulk viscosity damps the growth, too: on a lattice the limit of 0.91 h/c₀ rises to 1.1 at `α₂ = 0.1` and 1.64 at 1, and is
/// not made use of.
pub(super) fn sound_limit(diffusion: DensityDiffusion) -> f64 {
    let delta = match diffusion {
        DensityDiffusion::None => DIFFUSION,
        DensityDiffusion::MolteniColagrossi(delta)
        | DensityDiffusion::Fourtakas(delta)
        | DensityDiffusion::Antuono(delta) => delta,
    };
    SOUND * (delta / DIFFUSION).min(1.0).cbrt()
}

impl Fluid {
    /// Advances the state to the middle of a step, `half` after its start, with the rates and accelerations of
    /// the start. Books nothing: [`Self::correct`] starts again from the start.
    pub fn predict(&mut self, half: f64) {
        // no kick need have come before, and damping may have
        self.record_speed(self.max_speed());
        self.drift(half);
        let advances_density = self.advances_density();
        let Particles {
            velocity,
            density,
            acceleration,
            ..
        } = &mut self.particles;
        self.at_start.velocity.clone_from(velocity);
        velocity
            .par_chunks_mut(CHUNK)
            .zip(acceleration.par_chunks(CHUNK))
            .for_each(|(velocity, acceleration)| {
                for (v, a) in velocity.iter_mut().zip(acceleration) {
                    *v += a * half;
                }
            });
        if advances_density {
            self.at_start.density.clone_from(density);
            self.integrate_density(|_, _, _| half);
        }
    }

    /// Advances velocities and densities from the start of a step of `dt` to its end, with the rates and
    /// accelerations half way, and books them; the positions need another half drift.
    pub fn correct(&mut self, dt: f64) {
        if self.advances_density() {
            self.book_bulk(dt);
            std::mem::swap(&mut self.particles.density, &mut self.at_start.density);
            let mut half_way = std::mem::take(&mut self.at_start.density);
            // ρ (2 − ε)/(2 + ε) − ρ = ρ' dt (ρ/ρ½) 2/(2 + ε)
            let change = self.integrate_density(|a, density, rate| {
                let epsilon = -rate / half_way[a] * dt;
                dt * density / half_way[a] * 2.0 / (2.0 + epsilon)
            });
            self.book_compression(change);
            half_way.clear();
            self.at_start.density = half_way;
        }
        std::mem::swap(&mut self.particles.velocity, &mut self.at_start.velocity);
        self.at_start.velocity.clear();
        self.kick(dt);
    }
}
