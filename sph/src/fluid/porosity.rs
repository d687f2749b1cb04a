//! Water that shares its volume with grains too small for its particles to flow around.
//!
//! ```text
//! ρ̃ = ε ρ                     carried by the particles: mass of water per volume, grains included         [kg/m³]
//! dρ̃/dt = ρ̃ Σ V_b v_ab·∇W,    V = m/ρ̃
//! p = p(ρ̃/ε)                  pressure of the water itself                                                [Pa]
//! ```
//! Pair forces act on volumes that fill all space. The part of the pressure's force that belongs to the grains is given to
//! them, and taken from the water, by whoever knows the grains: equations of Anderson & Jackson (1967), with particles after
//! Robinson, Ramaioli & Luding (2014). Density diffusion acts on the density of the water, which does not jump at the edge of
//! a bed of grains, as that of the mixture does.

use rayon::prelude::*;

use crate::fluid::energy::fixed_order_sum;
use crate::{CHUNK, Fluid};

impl Fluid {
    /// Leaves room for grains in particles that were placed as if there were none: each loses the share of its mass that grains
    /// take, and keeps its pressure. `porosity` holds the share that remains, in the present order, above 0; –.
    pub fn leave_room(&mut self, porosity: &[f64]) {
        let particles = &mut self.particles;
        for (a, &share) in porosity.iter().enumerate() {
            particles.density[a] *= share;
            particles.mass[a] *= share;
        }
        particles.porosity = porosity.to_vec();
    }

    /// Takes over the porosity at the present positions, in the present order, above 0 (–). Density stays, and the pressure follows
    /// with the next evaluation. Returns the energy of compression that grains brought in by it; J.
    ///
    /// ```text
    /// Σ m (e(ρ̃/ε₁) − e(ρ̃/ε₀))
    /// ```
    pub fn set_porosity(&mut self, porosity: &[f64]) -> f64 {
        let particles = &mut self.particles;
        if particles.porosity.is_empty() && porosity.iter().all(|&share| share == 1.0) {
            return 0.0;
        }
        particles.porosity.resize(porosity.len(), 1.0);
        let (state, before) = (&self.state, &particles.porosity);
        let brought = fixed_order_sum(porosity.len(), |a| {
            if before[a] == porosity[a] {
                return 0.0;
            }
            let energy = |share: f64| state.specific_energy(particles.density[a] / share);
            particles.mass[a] * (energy(porosity[a]) - energy(before[a]))
        });
        particles.porosity.copy_from_slice(porosity);
        brought
    }

    /// Smallest porosity of any particle; –.
    pub fn least_porosity(&self) -> f64 {
        let porosity = self.particles.porosity.par_iter().with_min_len(4096);
        porosity.copied().reduce(|| 1.0, f64::min)
    }

    /// Densities of the water itself, after [`Self::update_water_densities`]; kg/m³.
    pub(crate) fn water_densities(&self) -> &[f64] {
        match self.particles.porosity.is_empty() {
            true => &self.particles.density,
            false => &self.scratch.water_densities,
        }
    }

    pub(crate) fn update_water_densities(&mut self) {
        let particles = &self.particles;
        if particles.porosity.is_empty() {
            return;
        }
        let densities = &mut self.scratch.water_densities;
        densities.resize(particles.len(), 0.0);
        densities
            .par_chunks_mut(CHUNK)
            .enumerate()
            .for_each(|(chunk, densities)| {
                for (a, density) in (chunk * CHUNK..).zip(densities) {
                    *density = particles.water_density(a);
                }
            });
    }

    /// Turns rates of the density of water into those of the density that particles carry.
    pub(crate) fn share_rates(&mut self) {
        let porosity = &self.particles.porosity;
        if porosity.is_empty() {
            return;
        }
        let rates = self.scratch.rates.par_chunks_mut(CHUNK);
        rates
            .zip(porosity.par_chunks(CHUNK))
            .for_each(|(rates, porosity)| {
                for (rate, share) in rates.iter_mut().zip(porosity) {
                    rate.flow *= share;
                    rate.diffusion *= share;
                }
            });
    }
}
