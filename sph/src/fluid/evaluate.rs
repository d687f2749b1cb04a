//! Evaluation: rates of density, pressures and accelerations of the present state.

use rayon::prelude::*;

use crate::fluid::porosity::Flow;
use crate::fluid::sums;
use crate::neighbors::rest::Still;
use crate::scheme::{DensityDiffusion, DensityMethod};
use crate::terms::continuity::Rate;
use crate::terms::momentum::ForceDensity;
use crate::{CHUNK, Fluid, FluidError, Particles, Vec3};

/// Largest compression of a particle, in parts of the reference density: an impact at half the speed of sound compresses by a half,
/// `p = ρ c u`. Spray over obstacles does that to single particles; what blows up does not stop there.
const LARGEST_COMPRESSION: f64 = 0.5;

/// A force on a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleForce {
    /// Index in the present order.
    pub particle: u32,
    /// N.
    pub force: Vec3,
}

impl Fluid {
    /// Whether the density is advanced in time, by [`Self::update_rates`] and [`Self::advance_density`].
    pub fn advances_density(&self) -> bool {
        self.settings.scheme.density == DensityMethod::Continuity
    }

    /// Rates of density from neighbors in the fluid, at the present positions and velocities.
    pub fn update_rates(&mut self) {
        self.update_rates_of(Flow::WaterAndGrains);
    }

    /// The same of one of the flows, where grains share the volume.
    pub(crate) fn update_rates_of(&mut self, flow: Flow) {
        self.update_shared(flow);
        if let DensityDiffusion::Antuono(_) = self.settings.scheme.diffusion {
            sums::density_gradients(self);
        }
        self.n_pairs = sums::rates(self);
        self.share_rates();
        self.hold_rates();
    }

    /// Adds rates of density; kg/(m³ s), one per particle named.
    pub fn add_density_rates(&mut self, rates: impl Iterator<Item = (u32, f64)>) {
        for (particle, rate) in rates {
            let rate = Rate {
                flow: rate,
                ..Rate::default()
            };
            self.scratch.rates.add_walls(particle as usize, &rate);
        }
    }

    /// Pressures, that of bulk viscosity included, and with summation the densities, at the current positions.
    ///
    /// # Errors
    ///
    /// [`FluidError::NonFinite`] and [`FluidError::Compressed`] name the first bad particle.
    pub fn update_pressure(&mut self) -> Result<(), FluidError> {
        if !self.advances_density() {
            self.n_pairs = sums::summation(self, 1.0 / self.lattice_sum);
        }
        let Particles {
            density,
            pressure,
            porosity,
            ..
        } = &mut self.particles;
        let state = &self.state;
        let of_water = |a: usize, rho: f64| rho / porosity.get(a).copied().unwrap_or(1.0);
        let still = Still::kept(self.sleep.as_deref(), |kept| kept.pressure);
        pressure
            .par_chunks_mut(CHUNK)
            .zip(density.par_chunks(CHUNK))
            .enumerate()
            .with_min_len(16)
            .filter(|(chunk, _)| !still.has(*chunk))
            .for_each(|(chunk, (pressure, density))| {
                for (a, (p, rho)) in (chunk * CHUNK..).zip(pressure.iter_mut().zip(density)) {
                    *p = state.pressure(of_water(a, *rho));
                }
            });
        self.add_bulk_pressure();
        if let Some(sleep) = &mut self.sleep {
            sleep.kept.pressure = true;
        }
        let Particles {
            density, porosity, ..
        } = &self.particles;
        let limit = (1.0 + LARGEST_COMPRESSION) * self.settings.reference_density;
        // a NaN density is not below the limit either
        let first_bad = density
            .par_iter()
            .with_min_len(4096)
            .enumerate()
            .position_first(|(a, &rho)| {
                let rho = rho / porosity.get(a).copied().unwrap_or(1.0);
                !(0.0 < rho && rho < limit)
            });
        match first_bad {
            None => {
                self.pack_forces();
                Ok(())
            }
            Some(a) => Err(self.bad_density(a)),
        }
    }

    fn bad_density(&self, a: usize) -> FluidError {
        let (id, at) = (self.particles.id[a], self.particles.position[a]);
        let density = self.particles.water_density(a);
        if density.is_finite() && 0.0 < density {
            FluidError::Compressed {
                id,
                density,
                limit_percent: 100.0 * LARGEST_COMPRESSION,
                x: at.x,
                y: at.y,
                z: at.z,
            }
        } else {
            FluidError::NonFinite {
                id,
                quantity: "density",
                x: at.x,
                y: at.y,
                z: at.z,
            }
        }
    }

    /// Accelerations from pressure, viscosity and gravity; walls are added afterward.
    pub fn update_accelerations(&mut self) {
        self.scratch.pushes.clear();
        self.clear_plane_force();
        sums::forces(self, |fluid, n_chunks, forces| {
            fluid.hold_forces(n_chunks, forces);
            fluid.add_plane_force(n_chunks, forces);
            fluid.accelerate(n_chunks, forces);
        });
        self.sum_plane_force();
        self.hold_accelerations();
    }

    /// Accelerations of a part of the particles, which begins after so many chunks, from their forces.
    fn accelerate(&mut self, n_chunks: usize, forces: &[ForceDensity]) {
        let part = n_chunks * CHUNK..n_chunks * CHUNK + forces.len();
        let Particles {
            density,
            acceleration,
            viscous_acceleration,
            ..
        } = &mut self.particles;
        let gravity = self.settings.gravity;
        let still = Still::of(self.sleep.as_deref());
        acceleration[part.clone()]
            .par_chunks_mut(CHUNK)
            .zip(viscous_acceleration[part.clone()].par_chunks_mut(CHUNK))
            .zip(forces.par_chunks(CHUNK))
            .zip(density[part].par_chunks(CHUNK))
            .enumerate()
            .filter(|(chunk, _)| !still.has(n_chunks + chunk))
            .for_each(|(_, (((acceleration, viscous), forces), density))| {
                for (((acceleration, viscous), force), density) in acceleration
                    .iter_mut()
                    .zip(viscous)
                    .zip(forces)
                    .zip(density)
                {
                    let specific_volume = 1.0 / density;
                    let by_viscosity = Vec3::from(force.viscous) * specific_volume;
                    *viscous = by_viscosity.map(|v| v as f32).into();
                    *acceleration =
                        gravity + Vec3::from(force.pressure) * specific_volume + by_viscosity;
                }
            });
    }

    /// Adds forces, of walls and blocks, to the accelerations.
    pub fn add_forces(&mut self, forces: impl Iterator<Item = ParticleForce>) {
        for f in forces {
            let a = f.particle as usize;
            self.particles.acceleration[a] += f.force / self.particles.mass[a];
        }
    }
}
