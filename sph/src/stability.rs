//! Stability limit of acoustic waves, from the dispersion on a lattice.
//!
//! On a lattice the sums over the pairs are those of a wave of each number `k`,
//!
//! ```text
//! G(k) = Σ V ∇W sin k·r               ω = c₀ |G|                         sound                        [rad/s]
//! D(k) = 2 δ h c₀ Σ V |W'|/r (1 − cos k·r − ½ g·r sin k·r)               diffusion of the density     [1/s]
//! C(k) = α₂ h c₀ |G|²                                                    bulk viscosity           [1/s]
//! (dt/2)² ω² ≤ (1 − dt/2 C)(1 − dt/2 D)                                  stability of kick-drift-kick
//! ```
//! A step multiplies velocity and density of the wave by `((1 − C dt, −ω dt), (ω dt (1 − C dt), 1 − D dt − ω²dt²))`; one of
//! the two factors passes −1 at the limit. Without one of the losses it is `(dt/2)² ω² + dt/2 C = 1`.
//! `g = Σ V ∇W sin k·r` is the mean density gradient removed by Antuono's diffusion; for the other diffusions
//! g = 0. The limit is the minimum over all k resolved by the lattice. Walls and free surfaces reduce it by 1 to 4 %,
//! see the margin table of the benchmarks.

use crate::Vec3;
use crate::kernel::{Dimensions, Kernel, PointKernel};
use crate::scheme::{DensityDiffusion, DensityMethod};
use crate::{Settings, Stepping};

/// Waves along an axis, up to the shortest.
const N_WAVES: u32 = 12;

impl Settings {
    /// Largest step at which sound in water at rest does not grow, for a lattice of this spacing; s. `None` if only the
    /// governing step limit is known: for density from summation, and for predictor-corrector stepping.
    pub fn sound_stability(&self) -> Option<f64> {
        if self.scheme.density != DensityMethod::Continuity
            || self.scheme.stepping != Stepping::KickDriftKick
        {
            return None;
        }
        let lattice = Lattice::of(self);
        let axes = lattice.axes;
        let waves = |axis: usize| 0..=(N_WAVES * u32::from(axes[axis]));
        let mut longest = f64::INFINITY;
        for i in waves(0) {
            for j in waves(1) {
                for k in waves(2) {
                    let number = Vec3::new(f64::from(i), f64::from(j), f64::from(k))
                        * (std::f64::consts::PI / f64::from(N_WAVES));
                    let number = number.component_div(&Vec3::from(self.particle_spacing));
                    longest = longest.min(lattice.limit(&number, self));
                }
            }
        }
        Some(longest)
    }
}

/// Neighbors of a lattice particle.
struct Lattice {
    /// Along which it extends.
    axes: [bool; 3],
    /// Offsets (m) and `V W'/r` (1/m²).
    neighbors: Vec<(Vec3, f64)>,
}

impl Lattice {
    fn of(settings: &Settings) -> Self {
        let spacing = settings.particle_spacing;
        let (axes, width) = match settings.dimensions {
            Dimensions::Three => ([true; 3], 1.0),
            Dimensions::Two { width } => ([true, false, true], width),
        };
        let support = settings.support_radius();
        let kernel = PointKernel::new(settings.scheme.kernel, support, settings.dimensions);
        let along = |axis: usize| spacing[axis] * f64::from(u8::from(axes[axis]));
        let volume: f64 = (0..3).filter(|&a| axes[a]).map(|a| spacing[a]).product();
        let reach: [i32; 3] = std::array::from_fn(|axis| {
            i32::from(axes[axis]) * (support / spacing[axis]).ceil() as i32
        });
        let mut neighbors = Vec::new();
        for k in -reach[2]..=reach[2] {
            for j in -reach[1]..=reach[1] {
                for i in -reach[0]..=reach[0] {
                    let offset = Vec3::new(
                        f64::from(i) * along(0),
                        f64::from(j) * along(1),
                        f64::from(k) * along(2),
                    );
                    let r = offset.norm();
                    if 0.0 < r && r < support {
                        neighbors.push((offset, volume * width * kernel.gradient_factor(r)));
                    }
                }
            }
        }
        Self { axes, neighbors }
    }

    /// Largest stable step for a wave number (1/m); s.
    fn limit(&self, number: &Vec3, settings: &Settings) -> f64 {
        let (mut gradient, mut spread) = (Vec3::zeros(), 0.0);
        for (offset, factor) in &self.neighbors {
            let phase = number.dot(offset);
            gradient -= offset * (factor * phase.sin());
            spread -= factor * (1.0 - phase.cos());
        }
        let omega = settings.sound_speed * gradient.norm();
        let bulk = settings.scheme.bulk_viscosity
            * settings.smoothing_length
            * settings.sound_speed
            * gradient.norm_squared();
        let (delta, corrected) = match settings.scheme.diffusion {
            DensityDiffusion::None => (0.0, 0.0),
            DensityDiffusion::MolteniColagrossi(delta) | DensityDiffusion::Fourtakas(delta) => {
                (delta, 0.0)
            }
            // the mean gradient is −Σ V W'/r r sin k·r too
            DensityDiffusion::Antuono(delta) => (delta, 0.5 * gradient.norm_squared()),
        };
        let rate = 2.0
            * delta
            * settings.smoothing_length
            * settings.sound_speed
            * (spread - corrected).max(0.0);
        limit((omega, bulk, rate))
    }
}

/// Largest stable step of kick-drift-kick for a wave of angular frequency `ω` (1/s), whose velocity decays at `C` and whose
/// density at `D` (1/s); s.
fn limit((omega, of_velocity, of_density): (f64, f64, f64)) -> f64 {
    let difference = of_velocity - of_density;
    let root = (difference * difference + 4.0 * omega * omega).sqrt();
    4.0 / (of_velocity + of_density + root)
}

/// Share of the step limit of sound that bulk viscosity of coefficient `α₂` leaves: that of the shortest sound on a lattice,
/// which allows 1.75 h/c₀ without and 1.54 with the usual diffusion.
///
/// ```text
/// C = α₂ ω²       (1 − dt/2 C)(1 − dt/2 D) = (dt/2)² ω²       h/c₀ = 1
/// ```
/// Within 2 % of the lattices of `h`/spacing 1.3 to 2 in two and three dimensions, up to `α₂ = 1`.
pub(crate) fn share_left_by_bulk(alpha: f64) -> f64 {
    const FREE: f64 = 1.75;
    const USUAL: f64 = 1.54;
    let omega = 2.0 / FREE;
    let of_density = 2.0 / USUAL * (1.0 - (USUAL / FREE).powi(2));
    limit((omega, alpha * omega * omega, of_density)) / USUAL
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::Scheme;

    fn of_lattice(diffusion: DensityDiffusion, dimensions: Dimensions) -> f64 {
        damped(diffusion, dimensions, (1.3, 0.0))
    }

    /// The limit on a lattice with a smoothing length over spacing and a coefficient of bulk viscosity; h/c₀.
    fn damped(
        diffusion: DensityDiffusion,
        dimensions: Dimensions,
        (ratio, alpha): (f64, f64),
    ) -> f64 {
        let settings = Settings {
            particle_spacing: [0.1; 3],
            smoothing_length: 0.1 * ratio,
            reference_density: 1000.0,
            sound_speed: 20.0,
            scheme: Scheme {
                diffusion,
                bulk_viscosity: alpha,
                ..Scheme::artificial()
            },
            dimensions,
            gravity: Vec3::zeros(),
            time_step_factor: 0.5,
            domain: (Vec3::zeros(), Vec3::repeat(1.0)),
            periodic: [true; 3],
            symmetry: [[false; 2]; 3],
        };
        settings.sound_stability().unwrap() * 20.0 / settings.smoothing_length
    }

    /// Measured where noise in a periodic box begins to grow: 1.748 to 1.756 h/c₀ without diffusion, 1.541 to 1.548
    /// with it (benchmark of the extremes). Sampling 12 waves an axis is good to 1 %.
    #[test]
    fn a_lattice_in_space_bears_what_was_measured() {
        let free = of_lattice(DensityDiffusion::None, Dimensions::Three);
        assert!((free - 1.75).abs() < 0.0175, "{free}");
        let usual = of_lattice(DensityDiffusion::Fourtakas(0.1), Dimensions::Three);
        assert!((usual - 1.545).abs() < 0.0155, "{usual}");
    }

    /// The rule's share is that of one wave: 1.7 % off the widest lattice's at the largest coefficient.
    #[test]
    fn bulk_viscosity_takes_the_share_of_the_step_that_the_rule_says() {
        let usual = DensityDiffusion::Fourtakas(0.1);
        for dimensions in [Dimensions::Three, Dimensions::Two { width: 1.0 }] {
            for ratio in [1.3, 1.6, 2.0] {
                let free = damped(usual, dimensions, (ratio, 0.0));
                for alpha in [0.0, 0.05, 0.1, 0.3, 1.0] {
                    let share = damped(usual, dimensions, (ratio, alpha)) / free;
                    let stated = share_left_by_bulk(alpha);
                    assert!(
                        (stated / share - 1.0).abs() < 0.02,
                        "{dimensions:?}, h/dp {ratio}, bulk {alpha}: {share:.3}, stated {stated:.3}"
                    );
                }
            }
        }
    }

    /// The width of a slice is no matter, and diffusion of waves that are long only costs less.
    #[test]
    fn width_does_not_count_and_antuono_costs_less() {
        let of = |width| of_lattice(DensityDiffusion::Fourtakas(0.1), Dimensions::Two { width });
        assert!((of(0.1) / of(3.0) - 1.0).abs() < 1e-12);
        let antuono = of_lattice(DensityDiffusion::Antuono(0.1), Dimensions::Three);
        let usual = of_lattice(DensityDiffusion::Fourtakas(0.1), Dimensions::Three);
        assert!(usual < antuono, "{usual} {antuono}");
    }
}
