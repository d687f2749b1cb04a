//! Turbulent shear of a wall on the layer of fluid next to it.
//!
//! The boundary layer of water along a bed is often thinner than a particle spacing. It is not resolved then, and a wall
//! where the fluid sticks drags along a layer of one spacing instead. The law of the wall, averaged over the height `δ` of the
//! layer that touches the wall, gives the stress from the layer's mean speed along the wall:
//!
//! ```text
//! U/u* = (ln(δ/z_0) − 1)/κ,   z_0 = k_s/30 + ν/(9 u*),   τ = ρ u*²            κ = 0.40
//! τ    = ρ 2 ν U/δ   in a viscous layer, where it is larger
//! ```
//! `k_s` is Nikuradse's (1933) equivalent sand roughness, and the sum in `z_0` the transition of Colebrook (1939) from
//! smooth to rough walls. Manning's coefficient of a bed is about `k_s^(1/6)/25`, in s/m^(1/3).
//!
//! The stress acts on the fluid within one spacing, spread over it by a weight `ω` of the distance whose integral
//! from the wall is one spacing, so that a film of one row bears all of it, as deep water does.

use crate::kernel::{Dimensions, Kernel, KernelChoice, PointKernel};

/// Kármán's constant.
const KARMAN: f64 = 0.40;
/// Length of roughness of a smooth wall, times `u*/ν`.
const SMOOTH: f64 = 1.0 / 9.0;
/// Sand roughness over length of roughness.
const SAND: f64 = 30.0;
/// Passes of Newton's method, for round-off from a guess that is off by a factor of two.
const N_PASSES: usize = 4;
/// Distances in the table of a kernel.
const N_DISTANCES: usize = 64;

/// The law of the wall for a layer of given height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallLaw {
    /// Height `δ` of the layer; m, above zero.
    pub height: f64,
    /// Molecular kinematic viscosity `ν` of the fluid; m²/s, >= 0.
    pub kinematic_viscosity: f64,
    /// Equivalent sand roughness `k_s` of the wall; m, >= 0.
    pub roughness: f64,
}

impl WallLaw {
    /// Shear stress over density, `u*²`, at a mean speed of the layer relative to the wall (m/s); m²/s².
    ///
    /// The logarithm counts as no less than 2: a roughness above the height has no law of the wall.
    pub fn stress_over_density(&self, speed: f64) -> f64 {
        let speed = speed.abs();
        let mut friction_velocity = 0.05 * speed;
        for _ in 0..N_PASSES {
            // Newton's method for u* (ln(δ/z_0) − 1) = κ U
            let least = friction_velocity.max(f64::MIN_POSITIVE);
            let smooth = SMOOTH * self.kinematic_viscosity / least;
            let length = (self.roughness / SAND + smooth).max(f64::MIN_POSITIVE);
            let logarithm = (self.height / length).ln();
            friction_velocity = if logarithm < 2.0 {
                KARMAN * speed
            } else {
                let share = smooth / length;
                (KARMAN * speed + friction_velocity * share) / (logarithm - 1.0 + share)
            };
        }
        let viscous = 2.0 * self.kinematic_viscosity * speed / self.height;
        (friction_velocity * friction_velocity).max(viscous)
    }

    /// Weight `ω` of a fluid particle at a distance from the wall (m): 1 up to half the height, 0 from one and a half on.
    pub fn weight(&self, distance: f64) -> f64 {
        (1.5 - distance / self.height).clamp(0.0, 1.0)
    }

    /// Force on a particle per volume and density, against its velocity along the wall: `ω τ/(ρ δ)`; m/s².
    pub fn deceleration(&self, speed: f64, distance: f64) -> f64 {
        self.weight(distance) * self.stress_over_density(speed) / self.height
    }
}

/// Distance from a plane wall, from the wall's part of a particle's concentration.
///
/// ```text
/// D(z) = −Σ V_w x·∇W = ∫ (−r W') f(z/r) dV,   f: share of the sphere, or circle, of radius r behind the wall
/// ```
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlaneDistances {
    support_radius: f64,
    /// `D` at equal steps from the wall to the end of the support; falls to 0.
    divergence: Vec<f64>,
}

impl PlaneDistances {
    pub(crate) fn new(choice: KernelChoice, support_radius: f64, dimensions: Dimensions) -> Self {
        let kernel = PointKernel::new(choice, support_radius, dimensions);
        let step = support_radius / N_DISTANCES as f64;
        let behind = |cosine: f64| match dimensions {
            Dimensions::Three => 0.5 * (1.0 - cosine),
            Dimensions::Two { .. } => cosine.acos() / std::f64::consts::PI,
        };
        let power = match dimensions {
            Dimensions::Three => 4,
            Dimensions::Two { .. } => 3,
        };
        let integrand = |r: f64, z: f64| -kernel.gradient_factor(r) * r.powi(power) * behind(z / r);
        let integral = |z: f64| -> f64 {
            let n = 8 * N_DISTANCES;
            let dr = (support_radius - z) / n as f64;
            (0..n)
                .map(|k| integrand(z + (k as f64 + 0.5) * dr, z) * dr)
                .sum()
        };
        let at_wall = integral(0.0);
        let half_of_all = 0.5
            * match dimensions {
                Dimensions::Three => 3.0,
                Dimensions::Two { .. } => 2.0,
            };
        let divergence = (0..=N_DISTANCES)
            .map(|k| half_of_all * integral(k as f64 * step) / at_wall)
            .collect();
        Self {
            support_radius,
            divergence,
        }
    }

    /// Distance (m) at which a plane wall has this part of the concentration; 0 in corners, where there is more wall.
    pub(crate) fn at(&self, divergence: f64) -> f64 {
        let above = self.divergence.partition_point(|&d| divergence < d);
        let (Some(&less), Some(&more)) = (
            self.divergence.get(above),
            above.checked_sub(1).and_then(|k| self.divergence.get(k)),
        ) else {
            return if above == 0 { 0.0 } else { self.support_radius };
        };
        let within = (more - divergence) / (more - less);
        (above as f64 - 1.0 + within) * self.support_radius / N_DISTANCES as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boundary::integral::plane_share;

    const WATER: WallLaw = WallLaw {
        height: 0.1,
        kinematic_viscosity: 1e-6,
        roughness: 0.0,
    };

    /// Speed of which `u*` is the friction velocity, from the law as printed.
    fn speed(law: WallLaw, friction_velocity: f64) -> f64 {
        let length = law.roughness / 30.0 + law.kinematic_viscosity / (9.0 * friction_velocity);
        friction_velocity * ((law.height / length).ln() - 1.0) / 0.4
    }

    #[test]
    fn the_law_of_smooth_and_rough_walls_is_inverted() {
        for roughness in [0.0, 1e-4, 1e-2] {
            let law = WallLaw { roughness, ..WATER };
            for u in [0.003, 0.05, 0.4] {
                let stress = law.stress_over_density(speed(law, u));
                assert!(
                    (stress / (u * u) - 1.0).abs() < 1e-6,
                    "{roughness} {u} {stress}"
                );
            }
        }
    }

    #[test]
    fn a_thin_or_slow_layer_is_viscous() {
        let thin = WallLaw {
            height: 1e-4,
            ..WATER
        };
        assert!((thin.stress_over_density(0.1) / (2.0 * 1e-6 * 0.1 / 1e-4) - 1.0).abs() < 1e-12);
        assert_eq!(WATER.stress_over_density(0.0), 0.0);
        assert_eq!(
            WATER.stress_over_density(-2.0),
            WATER.stress_over_density(2.0)
        );
        // without viscosity and roughness nothing holds
        let ideal = WallLaw {
            kinematic_viscosity: 0.0,
            ..WATER
        };
        // ln(δ/z_0) ends at 1e-308
        assert!(ideal.stress_over_density(1.0) < 1e-6);
    }

    #[test]
    fn deep_water_and_a_film_bear_the_whole_stress() {
        let d = WATER.height;
        // ∫ ω dz = δ
        let sum: f64 = (0..300)
            .map(|k| WATER.weight((f64::from(k) + 0.5) * 0.01 * d))
            .sum();
        assert!((0.01 * sum - 1.0).abs() < 1e-12, "{sum}");
        let rows = |n: u32| -> f64 { (0..n).map(|k| WATER.weight((f64::from(k) + 0.5) * d)).sum() };
        assert!((rows(1) - 1.0).abs() < 1e-12 && (rows(4) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn distances_are_those_of_a_plane() {
        let planes = [Dimensions::Three, Dimensions::Two { width: 0.7 }];
        for dimensions in planes {
            for choice in [KernelChoice::WendlandC2, KernelChoice::CubicSpline] {
                let table = PlaneDistances::new(choice, 2.0, dimensions);
                assert!(table.divergence.is_sorted_by(|a, b| a > b));
                assert_eq!(table.at(1e9), 0.0);
                assert_eq!(table.at(0.0), 2.0);
                // D(z) = d λ(z) + z A(z), A = −λ': partial integration
                if choice == KernelChoice::WendlandC2 {
                    for z in [0.1, 0.5, 1.0] {
                        let share = |z| plane_share(z, 2.0, dimensions);
                        let slope = (share(z + 1e-4) - share(z - 1e-4)) / 2e-4;
                        let d = if dimensions == Dimensions::Three {
                            3.0
                        } else {
                            2.0
                        };
                        let found = table.at(d * share(z) - z * slope);
                        assert!((found - z).abs() < 2e-3, "{dimensions:?} {z} {found}");
                    }
                }
            }
        }
    }
}
