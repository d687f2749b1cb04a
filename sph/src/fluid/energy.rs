//! Mass, energy and momentum of the fluid, and the accounts of what took or brought them.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::exact_sum::{self, ExactSum, Reduce};
use crate::{CHUNK, Fluid, ParticleId, Particles, Vec3};

/// Energies of the fluid; J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// `Σ ½ m v²`.
    pub kinetic: f64,
    /// `−Σ m g·x`.
    pub potential: f64,
    /// Energy of compression.
    pub internal: f64,
    /// Taken by viscosity since the ledger was opened.
    pub viscous: f64,
    /// Taken by bulk viscosity since the ledger was opened.
    pub bulk: f64,
    /// Taken by density diffusion since the ledger was opened.
    pub diffusive: f64,
    /// Carried off by removed particles since the ledger was opened.
    pub removed: f64,
}

/// Water that left the domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Removed {
    /// Particles.
    pub count: u64,
    /// Their mass; kg.
    pub mass: f64,
    /// Their momentum; kg m/s.
    pub momentum: Vec3,
    /// Their kinetic, potential and internal energy; J.
    pub energy: f64,
}

/// A sum over indices that does not depend on the number of threads.
pub(crate) fn fixed_order_sum<T>(n: usize, term: impl Fn(usize) -> T + Sync) -> T
where
    T: Send + Copy + std::ops::Add<Output = T> + Default,
{
    let partial: Vec<T> = (0..n.div_ceil(CHUNK))
        .into_par_iter()
        .with_min_len(16)
        .map(|chunk| {
            (chunk * CHUNK..((chunk + 1) * CHUNK).min(n)).fold(T::default(), |sum, a| sum + term(a))
        })
        .collect();
    partial.into_iter().fold(T::default(), |sum, x| sum + x)
}

/// Sums over the particles of the fluid, or of the part of it that a process has; exact until they are asked for.
#[derive(Clone, Debug, Default)]
pub struct ParticleSums {
    /// Number of particles.
    pub count: u64,
    /// `Σ m`; kg.
    pub mass: ExactSum,
    /// `Σ m v`; kg m/s.
    pub momentum: [ExactSum; 3],
    /// `Σ m v²`; J.
    pub twice_kinetic: ExactSum,
    /// `Σ m g·x`; J.
    pub work_of_gravity: ExactSum,
    /// Energy of compression; J.
    pub internal: ExactSum,
}

impl Reduce for ParticleSums {
    fn merge(&mut self, other: &Self) {
        let Self {
            count,
            mass,
            momentum,
            twice_kinetic,
            work_of_gravity,
            internal,
        } = self;
        *count += other.count;
        mass.merge(&other.mass);
        momentum.merge(&other.momentum);
        twice_kinetic.merge(&other.twice_kinetic);
        work_of_gravity.merge(&other.work_of_gravity);
        internal.merge(&other.internal);
    }
}

impl Fluid {
    /// Sums over all particles at their current positions and velocities.
    pub fn particle_sums(&self) -> ParticleSums {
        self.particle_sums_of(|_| true)
    }

    /// Sums over the particles that `is_own` says yes to: a process that has copies of its neighbors' particles leaves these out.
    pub fn particle_sums_of(&self, is_own: impl Fn(ParticleId) -> bool + Sync) -> ParticleSums {
        let Particles {
            id, velocity, mass, ..
        } = self.particles();
        let n = mass.len();
        // the mass of others is left out of all sums
        let own = |a: usize| if is_own(id[a]) { mass[a] } else { 0.0 };
        let [twice_kinetic, work_of_gravity, internal] = self.energy_sums(own);
        ParticleSums {
            count: fixed_order_sum(n, |a| u64::from(is_own(id[a]))),
            mass: ExactSum::over(n, own),
            momentum: exact_sum::vectors_over(n, |a| velocity[a] * own(a)),
            twice_kinetic,
            work_of_gravity,
            internal,
        }
    }

    /// `Σ m v²`, `Σ m g·x` and the energy of compression, with the mass `m` of each particle in kg; J.
    fn energy_sums(&self, mass: impl Fn(usize) -> f64 + Sync) -> [ExactSum; 3] {
        let particles = self.particles();
        let Particles {
            position, velocity, ..
        } = particles;
        let (gravity, state) = (self.settings().gravity, self.state_equation());
        let n = particles.len();
        [
            ExactSum::over(n, |a| mass(a) * velocity[a].norm_squared()),
            ExactSum::over(n, |a| mass(a) * gravity.dot(&position[a])),
            ExactSum::over(n, |a| {
                mass(a) * state.specific_energy(particles.water_density(a))
            }),
        ]
    }

    /// Energies at the current positions and velocities; J.
    pub fn energies(&self) -> Energies {
        // no more sums than these: a run asks after every step
        let mass = &self.particles.mass;
        let [twice_kinetic, work_of_gravity, internal] = self.energy_sums(|a| mass[a]);
        Energies {
            kinetic: 0.5 * twice_kinetic.value(),
            potential: -work_of_gravity.value(),
            internal: internal.value(),
            viscous: self.viscous_loss(),
            bulk: self.bulk_loss(),
            diffusive: self.diffusive_loss(),
            removed: self.removed().energy,
        }
    }

    /// Mass of all particles; kg.
    pub fn mass(&self) -> f64 {
        let mass = &self.particles.mass;
        ExactSum::over(mass.len(), |a| mass[a]).value()
    }

    /// Momentum `Σ m v`; kg m/s.
    pub fn momentum(&self) -> Vec3 {
        let (velocity, mass) = (&self.particles().velocity, &self.particles().mass);
        let sums = exact_sum::vectors_over(velocity.len(), |a| velocity[a] * mass[a]);
        Vec3::from(sums.map(|sum| sum.value()))
    }

    /// Water that left the domain since the ledger was opened.
    pub fn removed(&self) -> Removed {
        self.removed
    }

    /// Energy taken by viscosity since the ledger was opened; J.
    pub fn viscous_loss(&self) -> f64 {
        self.viscous_loss
    }

    /// Energy of compression taken by density diffusion since the ledger was opened; J.
    pub fn diffusive_loss(&self) -> f64 {
        self.diffusive_loss
    }

    /// Energy of compression withheld from crowded particles since the ledger was opened; J.
    pub fn withheld_loss(&self) -> f64 {
        self.withheld_loss
    }

    /// Energy that the fluid has from the pressure of walls since the ledger was opened, where density is advanced: of
    /// motion by their forces and of compression by their part of the rates; J.
    pub fn energy_from_walls(&self) -> f64 {
        self.from_walls
    }

    /// The same through the flux of grains that share the volume of the fluid: their averages reach walls before they do; J.
    pub fn energy_from_walls_by_grains(&self) -> f64 {
        self.from_walls_by_grains
    }

    /// Resets the ledger at the start of a run.
    pub fn open_ledger(&mut self) {
        self.viscous_loss = 0.0;
        self.bulk_loss = 0.0;
        self.from_walls = 0.0;
        self.diffusive_loss = 0.0;
        self.withheld_loss = 0.0;
        self.from_walls_by_grains = 0.0;
        self.removed = Removed::default();
        self.reflected = Vec3::zeros();
    }

    /// Root mean square of `ρ/ρ₀ − 1` over the compressed particles, those not at a free surface.
    pub fn density_error_rms(&self) -> f64 {
        let (particles, reference) = (&self.particles, self.settings.reference_density);
        let excess = |a: usize| (particles.water_density(a) / reference - 1.0).max(0.0);
        let sum = ExactSum::over(particles.len(), |a| excess(a).powi(2)).value();
        let count = fixed_order_sum(particles.len(), |a| {
            u64::from(reference < particles.water_density(a))
        });
        if count == 0 {
            0.0
        } else {
            (sum / count as f64).sqrt()
        }
    }
}
