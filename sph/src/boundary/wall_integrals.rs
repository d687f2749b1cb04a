//! Contributions of walls of exact kernel integrals to a fluid.
//!
//! The integrals are those of [`super::integral`]; the caller finds the solids near a particle and applies the resulting
//! forces. Rates of density go through [`Fluid::add_density_rates`].

use crate::boundary::integral::WallIntegral;
use crate::{Fluid, Vec3};

/// Force of a wall on a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallForce {
    /// Index in the present order.
    pub particle: u32,
    /// All of it; N.
    pub force: Vec3,
    /// The part that is booked as work of viscosity; N.
    pub viscous: Vec3,
}

impl Fluid {
    /// Adds forces of walls to the accelerations.
    pub fn add_wall_forces(&mut self, forces: impl Iterator<Item = WallForce>) {
        let particles = &mut self.particles;
        for f in forces {
            let a = f.particle as usize;
            let mass = particles.mass[a];
            particles.acceleration[a] += f.force / mass;
            let pressed = (f.force - f.viscous) / mass;
            self.scratch.pushes.push((f.particle, pressed));
            let viscous = &mut particles.viscous_acceleration[a];
            for (sum, part) in viscous.iter_mut().zip(&f.viscous) {
                *sum += (part / mass) as f32;
            }
        }
    }

    /// Adds solids to the concentration of particles, after [`Fluid::update_concentration`].
    ///
    /// ```text
    /// ∇C += ∇λ,   ∇·x += tr Q
    /// ```
    pub fn add_wall_spreads<'a>(
        &mut self,
        integrals: impl Iterator<Item = (u32, &'a WallIntegral)>,
    ) {
        for (particle, integral) in integrals {
            let concentration = &mut self.scratch.concentrations[particle as usize];
            for (sum, part) in concentration.gradient.iter_mut().zip(&integral.gradient) {
                *sum += part;
            }
            concentration.divergence += integral.moment.trace();
        }
    }
}
