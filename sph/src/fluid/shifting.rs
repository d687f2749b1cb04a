//! Shifting of particles towards where they are sparse.

use rayon::prelude::*;

use crate::neighbors::rest::Still;
use crate::scheme::Shifting;
use crate::terms::sums;
use crate::{CHUNK, Dimensions, Fluid, Particles, Vec3};

impl Fluid {
    /// Finds how unevenly the particles are spread; walls are added afterward, and [`Self::shift`]
    /// evens it out. Only where the scheme shifts.
    pub fn update_spread(&mut self) {
        sums::spreads(self);
    }

    /// Whether the scheme shifts particles.
    pub fn shifts(&self) -> bool {
        self.settings.scheme.shifting != Shifting::None
    }

    /// Moves particles towards where they are sparse, after a step of `dt`.
    ///
    /// ```text
    /// δx = −A h |v| dt ∇C,   at most 0.1 dp along each axis; fading out at the free surface
    /// ```
    /// Lind et al. (2012). The mass moves and the momentum does not: potential energy and angular
    /// momentum drift a little.
    pub fn shift(&mut self, dt: f64) {
        let Shifting::Fickian { coefficient } = self.settings.scheme.shifting else {
            return;
        };
        let inside = self.settings.dimensions.count();
        let none = match self.settings.dimensions {
            Dimensions::Two { .. } => 1.5,
            Dimensions::Three => 2.75,
        };
        let fade = |divergence: f64| ((divergence - none) / (inside - none)).clamp(0.0, 1.0);
        let most = 0.1
            * self
                .settings
                .particle_spacing
                .iter()
                .copied()
                .fold(f64::INFINITY, f64::min);
        let factor = -coefficient * self.settings.smoothing_length * dt;
        let Particles {
            position, velocity, ..
        } = &mut self.particles;
        let still = Still::of(self.sleep.as_deref());
        position
            .par_chunks_mut(CHUNK)
            .zip(velocity.par_chunks(CHUNK))
            .zip(self.scratch.spreads.par_chunks(CHUNK))
            .enumerate()
            .filter(|(chunk, _)| !still.has(*chunk))
            .for_each(|(_, ((position, velocity), spreads))| {
                for ((x, v), spread) in position.iter_mut().zip(velocity).zip(spreads) {
                    let by = factor * v.norm() * fade(spread.divergence);
                    *x += Vec3::from(spread.concentration_gradient)
                        .map(|g| (by * g).clamp(-most, most));
                }
            });
        self.moved += 3.0_f64.sqrt() * most;
    }
}
