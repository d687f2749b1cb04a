//! Shifting of particles towards where they are sparse.

use rayon::prelude::*;

use crate::fluid::sums;
use crate::neighbors::rest::Still;
use crate::scheme::Shifting;
use crate::{CHUNK, Dimensions, Fluid, Particles, Vec3};

/// Most that a particle is shifted along an axis in a step; × spacing.
const LONGEST_SHIFT: f64 = 0.1;

impl Fluid {
    /// Gradient of the particle concentration; walls are added afterward, and [`Self::shift`]
    /// evens it out. Only where the scheme shifts.
    pub fn update_concentration(&mut self) {
        sums::concentrations(self);
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
        let most = LONGEST_SHIFT * self.settings.least_spacing();
        let factor = -coefficient * self.settings.smoothing_length * dt;
        let Particles {
            position, velocity, ..
        } = &mut self.particles;
        let still = Still::of(self.sleep.as_deref());
        position
            .par_chunks_mut(CHUNK)
            .zip(velocity.par_chunks(CHUNK))
            .zip(self.scratch.concentrations.par_chunks(CHUNK))
            .enumerate()
            .filter(|(chunk, _)| !still.has(*chunk))
            .for_each(|(_, ((position, velocity), concentrations))| {
                for ((x, v), concentration) in position.iter_mut().zip(velocity).zip(concentrations)
                {
                    let by = factor * v.norm() * fade(concentration.divergence);
                    *x += Vec3::from(concentration.gradient).map(|g| (by * g).clamp(-most, most));
                }
            });
        let way = 3.0_f64.sqrt() * most;
        self.moved += way;
        self.approached += 2.0 * way;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FluidError, Precision, Scheme, Settings, Start};

    const SPACING: f64 = 0.05;

    /// Particles of an uneven lattice in a slice of a width (m), after a shift that the bound cuts for some.
    fn shifted(width: f64) -> Result<Vec<Vec3>, FluidError> {
        let settings = Settings {
            particle_spacing: [SPACING, width, SPACING],
            smoothing_length: 2.0 * SPACING,
            reference_density: 1000.0,
            sound_speed: 30.0,
            scheme: Scheme {
                shifting: Shifting::Fickian { coefficient: 2.0 },
                precision: Precision::Double,
                ..Scheme::artificial()
            },
            dimensions: Dimensions::Two { width },
            gravity: Vec3::zeros(),
            time_step_factor: 0.5,
            domain: (Vec3::zeros(), Vec3::new(1.0, width, 1.0)),
            periodic: [true, false, true],
            symmetry: [[false; 2]; 3],
        };
        let uneven = |i: i32, k: i32| 0.2 * f64::from((7 * i + 11 * k) % 5 - 2);
        let positions: Vec<Vec3> = (0..400)
            .map(|a| (a % 20, a / 20))
            .map(|(i, k)| {
                let x = f64::from(i) + 0.5 + uneven(i, k);
                let z = f64::from(k) + 0.5 + uneven(k, i);
                Vec3::new(x * SPACING, 0.5 * width, z * SPACING)
            })
            .collect();
        let start = Start {
            velocities: vec![Vec3::x(); positions.len()],
            positions,
            ..Start::default()
        };
        let mut fluid = Fluid::new(start, settings)?;
        fluid.refresh();
        let before = fluid.particles.position.clone();
        fluid.update_concentration();
        fluid.shift(0.05);
        let after = fluid.particles.position.iter();
        Ok(after.zip(&before).map(|(x, x0)| x - x0).collect())
    }

    #[test]
    fn the_width_of_a_slice_does_not_bound_shifts() -> Result<(), FluidError> {
        let (narrow, wide) = (shifted(0.01)?, shifted(SPACING)?);
        let longest = narrow.iter().map(|by| by.amax()).fold(0.0, f64::max);
        let bound = LONGEST_SHIFT * SPACING;
        assert!((longest - bound).abs() < 1e-12 * bound, "{longest}");
        for (narrow, wide) in narrow.iter().zip(&wide) {
            // round-off of the widths
            assert!((narrow - wide).norm() < 1e-12 * SPACING, "{narrow} {wide}");
        }
        Ok(())
    }
}
