//! Exchange across the boundary of the fluid: particles added and removed, velocities and densities
//! imposed. Every change returns its contribution, so that ledgers close.

use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

use rayon::prelude::*;

use crate::fluid::MAX_PARTICLES;
use crate::particles::filter;
use crate::{CHUNK, Fluid, FluidError, Vec3};

/// Contribution of a change to the fluid; negative for a removal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exchange {
    /// Particles.
    pub count: i64,
    /// kg.
    pub mass: f64,
    /// kg m/s.
    pub momentum: Vec3,
    /// Kinetic, potential and internal energy; J.
    pub energy: f64,
}

impl AddAssign for Exchange {
    fn add_assign(&mut self, other: Self) {
        self.count += other.count;
        self.mass += other.mass;
        self.momentum += other.momentum;
        self.energy += other.energy;
    }
}

/// A particle to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewParticle {
    /// m.
    pub position: Vec3,
    /// m/s.
    pub velocity: Vec3,
    /// Density, from which the mass follows; kg/m³.
    pub density: f64,
}

/// Velocity and density that a particle is held at.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Imposed {
    /// Index in the present order.
    pub particle: u32,
    /// m/s.
    pub velocity: Vec3,
    /// Of the water; unchanged if absent; kg/m³.
    pub density: Option<f64>,
}

/// A layer that takes the motion out of waves before they meet the end of the domain.
///
/// ```text
/// dv/dt = −f v,   f = f₀ (s/L)²,   s from 0 where the layer begins to L where it ends
/// ```
/// The quadratic ramp is the customary one (DualSPHysics): a step would reflect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Absorber {
    /// Lower corner; m.
    pub min: Vec3,
    /// Upper corner; m.
    pub max: Vec3,
    /// Direction of the ramp: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Whether it ends at the upper side.
    pub upward: bool,
    /// `f₀`; 1/s.
    pub rate: f64,
}

impl Absorber {
    /// `f` at a point; 1/s.
    pub fn rate_at(&self, x: &Vec3) -> f64 {
        if (0..3).any(|axis| x[axis] < self.min[axis] || self.max[axis] < x[axis]) {
            return 0.0;
        }
        let (low, high) = (self.min[self.axis], self.max[self.axis]);
        let share = (x[self.axis] - low) / (high - low);
        let share = if self.upward { share } else { 1.0 - share };
        self.rate * share * share
    }
}

impl Fluid {
    /// Damps the velocities in the layers over `dt`: `v e^{−f dt}`, unconditionally stable.
    /// Returns the (negative) contribution.
    pub fn absorb(&mut self, layers: &[Absorber], dt: f64) -> Exchange {
        if layers.is_empty() {
            return Exchange::default();
        }
        let particles = &mut self.particles;
        let partial: Vec<Exchange> = particles
            .velocity
            .par_chunks_mut(CHUNK)
            .zip(particles.position.par_chunks(CHUNK))
            .zip(particles.mass.par_chunks(CHUNK))
            .map(|((velocity, position), mass)| {
                let mut sum = Exchange::default();
                for ((v, x), m) in velocity.iter_mut().zip(position).zip(mass) {
                    let rate: f64 = layers.iter().map(|layer| layer.rate_at(x)).sum();
                    if 0.0 < rate {
                        let after = *v * (-rate * dt).exp();
                        sum.momentum += (after - *v) * *m;
                        sum.energy += 0.5 * m * (after.norm_squared() - v.norm_squared());
                        *v = after;
                    }
                }
                sum
            })
            .collect();
        partial.into_iter().fold(Exchange::default(), |mut sum, x| {
            sum += x;
            sum
        })
    }

    /// Imposes given velocities on particles, and densities where given; returns the contribution.
    pub fn impose(&mut self, imposed: &[Imposed]) -> Exchange {
        let mut sum = Exchange::default();
        for one in imposed {
            let a = one.particle as usize;
            let mass = self.particles.mass[a];
            let before = std::mem::replace(&mut self.particles.velocity[a], one.velocity);
            sum.momentum += (one.velocity - before) * mass;
            sum.energy += 0.5 * mass * (one.velocity.norm_squared() - before.norm_squared());
            if let Some(density) = one.density {
                let before = self.particles.water_density(a);
                self.particles.set_water_density(a, density);
                sum.energy += mass
                    * (self.state.specific_energy(density) - self.state.specific_energy(before));
            }
            self.record_speed(one.velocity.norm());
        }
        sum
    }

    /// Adds particles with new numbers; returns the contribution. They take part
    /// from the next [`Self::refresh`] on, which sorts them.
    ///
    /// # Errors
    ///
    /// [`FluidError::TooManyParticles`].
    pub fn add(&mut self, new: &[NewParticle]) -> Result<Exchange, FluidError> {
        let count = self.particles.n_made() as usize + new.len();
        if MAX_PARTICLES <= count {
            return Err(FluidError::TooManyParticles {
                count,
                limit: MAX_PARTICLES,
            });
        }
        let mut sum = Exchange::default();
        for one in new {
            let mass = one.density * self.particle_volume();
            self.particles
                .push(one.position, one.velocity, one.density, mass);
            if let Some(sleep) = &mut self.sleep {
                sleep.home.push(one.position);
            }
            sum += self.content(self.particles.len() - 1);
            self.record_speed(one.velocity.norm());
        }
        if !new.is_empty() {
            self.forget_order();
        }
        Ok(sum)
    }

    /// Removes particles for which `leaves` holds, and books each under the number it returns, below
    /// `accounts.len()`; the contributions to `accounts` are negative.
    pub fn take_out(&mut self, leaves: impl Fn(&Vec3) -> Option<usize>, accounts: &mut [Exchange]) {
        let mut keep = Vec::new();
        for a in 0..self.particles.len() {
            let Some(account) = leaves(&self.particles.position[a]) else {
                continue;
            };
            if keep.is_empty() {
                keep.resize(self.particles.len(), true);
            }
            keep[a] = false;
            let content = self.content(a);
            accounts[account] += Exchange {
                count: -content.count,
                mass: -content.mass,
                momentum: -content.momentum,
                energy: -content.energy,
            };
        }
        if !keep.is_empty() {
            self.particles.retain(&keep);
            if let Some(sleep) = &mut self.sleep {
                filter(&mut sleep.home, &keep);
            }
            self.forget_order();
        }
    }

    /// Mass, momentum and energy of a particle.
    pub(crate) fn content(&self, a: usize) -> Exchange {
        let x = self.particles.position[a];
        // the velocity of a predictor was not booked
        let at_start = self.at_start.of(a);
        let (v, density) = (
            at_start.0.unwrap_or(self.particles.velocity[a]),
            at_start.1.unwrap_or(self.particles.density[a]),
        );
        let mass = self.particles.mass[a];
        let of_water = density / self.particles.porosity_of(a);
        let specific = 0.5 * v.norm_squared() - self.settings.gravity.dot(&x)
            + self.state.specific_energy(of_water);
        Exchange {
            count: 1,
            mass,
            momentum: v * mass,
            energy: mass * specific,
        }
    }
}
