//! Predictor-corrector: rates and forces at the start take everything half way, and those found there take it from the
//! start to the end. Second order. Domínguez et al. (2022), see [`crate::scheme::Stepping`].
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
use crate::particles::filter;
use crate::{CHUNK, Fluid, Particles, Vec3};

/// State at the start of a step, while [`Fluid::predict`] has taken the particles half way; empty otherwise.
#[derive(Clone, Debug, Default)]
pub(crate) struct AtStart {
    /// m/s.
    pub velocity: Vec<Vec3>,
    /// Empty where density is not advanced; kg/m³.
    pub density: Vec<f64>,
}

impl AtStart {
    /// Velocity and density of a particle at the start of the step, where they are another.
    pub(crate) fn of(&self, a: usize) -> (Option<Vec3>, Option<f64>) {
        (self.velocity.get(a).copied(), self.density.get(a).copied())
    }

    /// Keeps the particles whose flag is set, in order.
    pub(crate) fn retain(&mut self, keep: &[bool]) {
        filter(&mut self.velocity, keep);
        filter(&mut self.density, keep);
    }
}

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
    // nothing comes, goes, is put back or shifted half way: the corrector would undo that
    fluid.sorted(boundary)?;
    boundary.place(fluid, Stage::Predicted, half);
    boundary.hold(fluid, Stage::Predicted, half);
    fluid.evaluate_forces(boundary)?;
    fluid.kicked(boundary, dt, Fluid::correct);
    boundary.advance(Part::SecondHalf, half)?;
    fluid.drift(half);
    fluid.evaluate(boundary, dt)
}

impl Fluid {
    /// Takes everything half way through a step, `half` after its start, with the rates and accelerations of
    /// the start. Books nothing: [`Self::correct`] starts again from the start.
    pub fn predict(&mut self, half: f64) {
        // no kick need have come before, and damping may have
        self.note_speed(self.max_speed());
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
            self.take_density_on(|_, _, _| half);
        }
    }

    /// Takes velocities and densities from the start of a step of `dt` to its end, with the rates and
    /// accelerations half way, and books them; the positions want half a drift more.
    pub fn correct(&mut self, dt: f64) {
        if self.advances_density() {
            std::mem::swap(&mut self.particles.density, &mut self.at_start.density);
            let mut half_way = std::mem::take(&mut self.at_start.density);
            // ρ (2 − ε)/(2 + ε) − ρ = ρ' dt (ρ/ρ½) 2/(2 + ε)
            let change = self.take_density_on(|a, density, rate| {
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
