//! Water that shares its volume with grains too small for its particles to flow around.
//!
//! ```text
//! ρ̃ = ε ρ                                   carried by the particles: mass of water per volume, grains included   [kg/m³]
//! U_a = ε_a u_a + Σ_j φ_aj v_j,   Σ_j φ_aj = 1 − ε_a                          flux of water and grains together   [m/s]
//! ε dρ/dt = ρ Σ_b V_b U_ab·∇W,    V = m/ρ̃                                    density of the water itself          [kg/(m³ s)]
//! S_a = −Σ_b V_b (p_a + p_b) ∇W + ∇·τ                                         force per volume                    [N/m³]
//! ε_a V_a S_a   on the water,     Σ_a φ_aj V_a S_a   on grain j                                                   [N]
//! ```
//! Water and grains share the force on their place by their shares of it, and the volume that both bring in there compresses the water:
//! the one is the work of the other, `Σ V_a S_a·U_a`, so that momentum and energy are exchanged without loss however unevenly grains lie.
//! At rest the pressure is that of the water alone, whatever the porosity. Sound runs as in the water alone.
//!
//! Sources: Anderson & Jackson (1967), equations; Robinson, Ramaioli & Luding (2014), with particles, whose density follows the porosity
//! itself. Density diffusion acts on the density of the water, which does not jump at the edge of a bed of grains, as that of the
//! mixture does.

use rayon::prelude::*;

use crate::fluid::advance::{FEWEST_NEIGHBORS, slowed_sound};
use crate::fluid::energy::fixed_order_sum;
use crate::fluid::scratch::WaterAlone;
use crate::{CHUNK, Fluid, Particles, Vec3};

/// Flow through a place that water shares with grains.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Flow {
    /// Of the water alone.
    Water,
    /// Of both together.
    WaterAndGrains,
}

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

    /// Takes over the porosity, above 0 (–), and the flux of grains `Σ_j φ_aj v_j` (m/s), at the present positions, in the present order.
    /// The density of the water itself stays, but for the part `drawn` (–) of what parts it from that which its own flow has carried
    /// there. Returns the energy of compression that this brought in; J.
    pub fn share_with_grains(&mut self, (porosity, flux): (&[f64], &[Vec3]), drawn: f64) -> f64 {
        let Particles {
            density,
            mass,
            porosity: before,
            carried,
            grain_flux,
            ..
        } = &mut self.particles;
        if before.is_empty() && porosity.iter().all(|&share| share == 1.0) {
            return 0.0;
        }
        before.resize(porosity.len(), 1.0);
        if carried.is_empty() {
            carried.clone_from(density);
        }
        let state = &self.state;
        // before and after
        let of_water = |a: usize, density: &[f64]| {
            let present = density[a] / before[a];
            [
                present,
                present + drawn * (carried[a] / porosity[a] - present),
            ]
        };
        let brought = fixed_order_sum(porosity.len(), |a| {
            let [present, next] = of_water(a, density);
            mass[a] * (state.specific_energy(next) - state.specific_energy(present))
        });
        for a in 0..porosity.len() {
            density[a] = of_water(a, density)[1] * porosity[a];
        }
        before.copy_from_slice(porosity);
        grain_flux.clear();
        grain_flux.extend_from_slice(flux);
        brought
    }

    /// Leaves the water its share of the forces of pressure and stress that act on its place; the grains have the rest. After
    /// [`Self::share_with_grains`] and all forces but those between water and grains.
    pub fn leave_grains_their_share(&mut self) {
        let gravity = self.settings.gravity;
        let Particles {
            porosity,
            acceleration,
            viscous_acceleration,
            ..
        } = &mut self.particles;
        let all = (porosity, acceleration, viscous_acceleration).into_par_iter();
        let shared = all.filter(|(share, _, _)| **share < 1.0);
        shared.for_each(|(share, acceleration, viscous)| {
            *acceleration = gravity + (*acceleration - gravity) * *share;
            *viscous = viscous.map(|by_viscosity| by_viscosity * *share as f32);
        });
    }

    /// Advances by `dt` (s) what the flow of the water alone carries, with the diffusion of all.
    pub(super) fn carry(&mut self, dt: f64) {
        let n_dimensions = self.settings.dimensions.count();
        let Particles {
            density, carried, ..
        } = &mut self.particles;
        if carried.is_empty() {
            return;
        }
        let rates = &self.scratch.rates;
        let all = (carried, density, &self.scratch.water_alone).into_par_iter();
        all.enumerate().for_each(|(a, (carried, density, alone))| {
            let rate = rates.of(a);
            if rate.n_found <= FEWEST_NEIGHBORS {
                *carried = *density;
                return;
            }
            let sound = slowed_sound(rate.crowding / n_dimensions);
            let flow = sound * sound * alone.compression * *carried;
            *carried += (flow + sound * rate.diffusion) * dt;
        });
    }

    /// Densities of the water itself, after [`Self::update_shared`]; kg/m³.
    pub(crate) fn water_densities(&self) -> &[f64] {
        match self.particles.porosity.is_empty() {
            true => &self.particles.density,
            false => &self.scratch.water_densities,
        }
    }

    /// Whether grains share the volume of the fluid.
    pub(crate) fn is_shared(&self) -> bool {
        !self.particles.porosity.is_empty()
    }

    /// Densities of the water itself, and a flux that compresses it.
    pub(crate) fn update_shared(&mut self, flow: Flow) {
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
        let fluxes = &mut self.scratch.fluxes;
        fluxes.resize(particles.len(), Vec3::zeros());
        match flow {
            Flow::Water => fluxes.copy_from_slice(&particles.velocity),
            Flow::WaterAndGrains => {
                (fluxes.par_iter_mut().enumerate()).for_each(|(a, flux)| *flux = particles.flux(a))
            }
        }
    }

    /// Keeps the rates of compression just found, walls included, as those of the flow of the water alone.
    pub(crate) fn keep_compression_of_water(&mut self) {
        let (rates, density) = (&self.scratch.rates, &self.particles.density);
        let kept = &mut self.scratch.water_alone;
        kept.clear();
        kept.extend(density.iter().enumerate().map(|(a, rho)| WaterAlone {
            compression: rates.of(a).flow / rho,
            by_walls: rates.by_walls(a),
        }));
    }

    /// Fluxes of water and grains together, after [`Self::update_shared`]; m/s.
    pub(crate) fn fluxes(&self) -> &[Vec3] {
        match self.particles.porosity.is_empty() {
            true => &self.particles.velocity,
            false => &self.scratch.fluxes,
        }
    }

    /// Turns rates of the density of water into those of the density that particles carry.
    pub(crate) fn share_rates(&mut self) {
        if self.is_shared() {
            self.scratch.rates.scale(&self.particles.porosity);
        }
    }
}
