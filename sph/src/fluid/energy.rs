//! Mass, energy and momentum of the fluid, and the accounts of what took or brought them.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{CHUNK, Fluid, Vec3};

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

impl Fluid {
    /// Energies at the current positions and velocities; J.
    pub fn energies(&self) -> Energies {
        let particles = self.particles();
        let mass = &particles.mass;
        let gravity = self.settings().gravity;
        let state = self.state_equation();
        let n = particles.len();
        Energies {
            kinetic: 0.5 * fixed_order_sum(n, |a| mass[a] * particles.velocity[a].norm_squared()),
            potential: -fixed_order_sum(n, |a| mass[a] * gravity.dot(&particles.position[a])),
            internal: fixed_order_sum(n, |a| mass[a] * state.specific_energy(particles.density[a])),
            viscous: self.viscous_loss(),
            bulk: self.bulk_loss(),
            diffusive: self.diffusive_loss(),
            removed: self.removed().energy,
        }
    }

    /// Mass of all particles; kg.
    pub fn mass(&self) -> f64 {
        let mass = &self.particles.mass;
        fixed_order_sum(mass.len(), |a| mass[a])
    }

    /// Momentum `Σ m v`; kg m/s.
    pub fn momentum(&self) -> Vec3 {
        let (velocity, mass) = (&self.particles().velocity, &self.particles().mass);
        // nalgebra's vectors have no Default: sum their components as one array
        let sum = fixed_order_sum(velocity.len(), |a| Sum3((velocity[a] * mass[a]).into()));
        Vec3::from(sum.0)
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

    /// Resets the ledger at the start of a run.
    pub fn open_ledger(&mut self) {
        self.viscous_loss = 0.0;
        self.bulk_loss = 0.0;
        self.from_walls = 0.0;
        self.diffusive_loss = 0.0;
        self.withheld_loss = 0.0;
        self.removed = Removed::default();
        self.reflected = Vec3::zeros();
    }

    /// Root mean square of `ρ/ρ₀ − 1` over the compressed particles, those not at a free surface.
    pub fn density_error_rms(&self) -> f64 {
        let (density, reference) = (&self.particles.density, self.settings.reference_density);
        let excess = |a: usize| (density[a] / reference - 1.0).max(0.0);
        let sum = fixed_order_sum(density.len(), |a| excess(a).powi(2));
        let count = fixed_order_sum(density.len(), |a| u64::from(reference < density[a]));
        if count == 0 {
            0.0
        } else {
            (sum / count as f64).sqrt()
        }
    }
}

/// Three numbers that add up.
#[derive(Clone, Copy, Default)]
struct Sum3([f64; 3]);

impl std::ops::Add for Sum3 {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self([0, 1, 2].map(|axis| self.0[axis] + other.0[axis]))
    }
}
