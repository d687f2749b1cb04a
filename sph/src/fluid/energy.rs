//! Energy and momentum of the fluid.

use rayon::prelude::*;

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
    /// Taken by density diffusion since the ledger was opened.
    pub diffusive: f64,
    /// Carried off by removed particles since the ledger was opened.
    pub removed: f64,
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
            diffusive: self.diffusive_loss(),
            removed: self.removed().energy,
        }
    }

    /// Momentum `Σ m v`; kg m/s.
    pub fn momentum(&self) -> Vec3 {
        let (velocity, mass) = (&self.particles().velocity, &self.particles().mass);
        // nalgebra's vectors have no Default: sum their components as one array
        let sum = fixed_order_sum(velocity.len(), |a| Sum3((velocity[a] * mass[a]).into()));
        Vec3::from(sum.0)
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
