//! Rates of density of all particles, and the memory that they share with what the next evaluation writes anew.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::neighbors::rest::Still;
use crate::terms::continuity::Rate;
use crate::{CHUNK, Fluid, Vec3};

/// Rates of density, one slot per particle.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Rates {
    /// By the flow and by diffusion, kg/(m³ s), and the concentration of neighbors times the number of dimensions.
    sums: Vec<Vec3>,
    /// The part of the flow's that walls make; kg/(m³ s).
    by_walls: Vec<f64>,
    /// Neighbors found, the particle itself among them.
    n_found: Vec<u32>,
    /// Whether the columns are borrowed.
    are_borrowed: bool,
}

impl Rates {
    /// Number of particles with a rate.
    pub(crate) fn len(&self) -> usize {
        self.sums.len()
    }

    /// Whether all columns have the same length.
    pub(super) fn is_whole(&self) -> bool {
        [self.by_walls.len(), self.n_found.len()] == [self.len(); 2] && !self.are_borrowed
    }

    /// That of a particle.
    #[inline(always)]
    pub(crate) fn of(&self, particle: usize) -> Rate {
        let sums = &self.sums[particle];
        Rate {
            flow: sums.x,
            diffusion: sums.y,
            crowding: sums.z,
            n_found: self.n_found[particle],
        }
    }

    /// The part of the flow's that walls make, of a particle; kg/(m³ s).
    #[inline(always)]
    pub(crate) fn by_walls(&self, particle: usize) -> f64 {
        self.by_walls[particle]
    }

    /// Adds what walls make to that of a particle.
    #[inline(always)]
    pub(crate) fn add_walls(&mut self, particle: usize, rate: &Rate) {
        self.sums[particle] += Vec3::new(rate.flow, rate.diffusion, rate.crowding);
        self.by_walls[particle] += rate.flow;
        self.n_found[particle] += rate.n_found;
    }

    /// Numbers of neighbors found.
    pub(super) fn n_found_mut(&mut self) -> &mut [u32] {
        &mut self.n_found
    }

    /// Multiplies the rates of particles by shares, one each.
    pub(super) fn scale(&mut self, shares: &[f64]) {
        self.sums
            .par_chunks_mut(CHUNK)
            .zip(shares.par_chunks(CHUNK))
            .for_each(|(sums, shares)| {
                for (sums, share) in sums.iter_mut().zip(shares) {
                    sums.x *= share;
                    sums.y *= share;
                }
            });
    }

    /// Makes room for so many particles, without walls so far.
    pub(super) fn begin(&mut self, n: usize) {
        self.sums.resize(n, Vec3::zeros());
        self.n_found.resize(n, 0);
        self.by_walls.resize(n, 0.0);
        self.by_walls
            .par_chunks_mut(CHUNK)
            .for_each(|chunk| chunk.fill(0.0));
    }

    /// Writes those of a part of the particles, which begins after so many chunks, but for chunks that no sum was made for.
    pub(super) fn write(&mut self, n_chunks: usize, rates: &[Rate], still: Still) {
        let part = n_chunks * CHUNK..n_chunks * CHUNK + rates.len();
        self.sums[part.clone()]
            .par_chunks_mut(CHUNK)
            .zip(self.n_found[part].par_chunks_mut(CHUNK))
            .zip(rates.par_chunks(CHUNK))
            .enumerate()
            .filter(|(chunk, _)| !still.has(n_chunks + chunk))
            .for_each(|(_, ((sums, n_found), rates))| {
                for ((sums, n_found), rate) in sums.iter_mut().zip(n_found).zip(rates) {
                    *sums = Vec3::new(rate.flow, rate.diffusion, rate.crowding);
                    *n_found = rate.n_found;
                }
            });
    }
}

impl Fluid {
    /// Lends the rates of density the memory of pressures and accelerations, which have no use between a kick and the next
    /// evaluation, up to [`Self::close_rates`]. Neither may be read in between.
    ///
    /// Rates that a step takes over from the last one, and what sleeps, keep their own.
    pub fn open_rates(&mut self) {
        let keeps = self.settings.scheme.stepping.rates_with_forces() || self.may_sleep();
        if !keeps && !self.scratch.rates.are_borrowed {
            self.swap_columns();
        }
    }

    /// Takes the memory back that was lent to the rates of density, if it was; the rates are gone then.
    pub fn close_rates(&mut self) {
        if self.scratch.rates.are_borrowed {
            self.swap_columns();
        }
    }

    fn swap_columns(&mut self) {
        let rates = &mut self.scratch.rates;
        std::mem::swap(&mut rates.sums, &mut self.particles.acceleration);
        std::mem::swap(&mut rates.by_walls, &mut self.particles.pressure);
        std::mem::swap(&mut rates.n_found, &mut self.scratch.cell);
        rates.are_borrowed = !rates.are_borrowed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Dimensions, FluidError, Precision, Scheme, Settings, Start};

    /// A cube of water that is squeezed along x.
    fn squeezed() -> Result<Fluid, FluidError> {
        let settings = Settings {
            particle_spacing: [0.1; 3],
            smoothing_length: 0.13,
            reference_density: 1000.0,
            sound_speed: 30.0,
            scheme: Scheme {
                precision: Precision::Double,
                bulk_viscosity: 0.1,
                ..Scheme::artificial()
            },
            dimensions: Dimensions::Three,
            gravity: Vec3::new(0.0, 0.0, -9.81),
            time_step_factor: 0.5,
            domain: (Vec3::zeros(), Vec3::repeat(1.0)),
            periodic: [false; 3],
            symmetry: [[false; 2]; 3],
        };
        let at = |k: usize| 0.1 * (k % 8) as f64 + 0.15;
        let positions: Vec<Vec3> = (0..512)
            .map(|k| Vec3::new(at(k), at(k / 8), at(k / 64)))
            .collect();
        let start = Start {
            velocities: positions.iter().map(|x| Vec3::x() * (0.5 - x.x)).collect(),
            pressures: positions.iter().map(|x| 1e4 * x.z).collect(),
            positions,
        };
        let mut fluid = Fluid::new(start, settings)?;
        fluid.refresh();
        fluid.update_pressure()?;
        fluid.update_accelerations();
        Ok(fluid)
    }

    #[test]
    fn lent_memory_changes_no_bit_and_comes_back() -> Result<(), FluidError> {
        let (mut own, mut lent) = (squeezed()?, squeezed()?);
        lent.open_rates();
        assert!(lent.particles.acceleration.is_empty());
        for fluid in [&mut own, &mut lent] {
            fluid.update_rates();
            fluid.add_density_rates([(7, 2.0)].into_iter());
        }
        for a in 0..512 {
            let (rates, expected) = (&lent.scratch.rates, &own.scratch.rates);
            let (rate, by_walls) = (rates.of(a), rates.by_walls(a));
            assert_eq!(by_walls, if a == 7 { 2.0 } else { 0.0 });
            assert_eq!(rate.flow, expected.of(a).flow);
            // squeezed everywhere
            assert!(0.0 < rate.flow, "{a}: {}", rate.flow);
            assert_eq!(rate.diffusion, expected.of(a).diffusion);
            assert_eq!(rate.crowding, expected.of(a).crowding);
            assert_eq!(rate.n_found, expected.of(a).n_found);
        }
        for fluid in [&mut own, &mut lent] {
            fluid.update_bulk_pressure();
            fluid.advance_density(1e-3);
        }
        lent.close_rates();
        assert_eq!(lent.scratch.rates.len(), 0);
        for fluid in [&mut own, &mut lent] {
            fluid.update_pressure()?;
            fluid.update_accelerations();
        }
        assert_eq!(lent.particles.density, own.particles.density);
        assert_eq!(lent.particles.pressure, own.particles.pressure);
        assert_eq!(lent.particles.acceleration, own.particles.acceleration);
        Ok(())
    }
}
