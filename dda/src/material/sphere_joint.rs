//! Contact laws of spheres: linear or Hertz, with rolling resistance.

use serde::{Deserialize, Serialize};

use super::Material;
use super::joint::{Strength, series};
use super::restitution::{damping_ratio, hertz_damping};

/// Normal contact law of spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalLaw {
    /// Spring of the material's `contact_stiffness`.
    #[default]
    Linear,
    /// Hertz's, from the elastic moduli.
    Hertz,
}

/// Angular velocity that rolling resistance of spheres acts on, at each contact up to `μ_r R̃ F_n`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RollingLaw {
    /// That of one body against the other, without the part about the normal: equal and opposite torques. Spheres
    /// that turn alike do not hold each other back.
    ///
    /// ```text
    /// ω_r = (1 − n nᵀ)(ω_j − ω_i),    M_j = −M_i = −μ_r R̃ F_n ω_r/|ω_r|                                      [N m]
    /// ```
    /// Source: Ai, Chen, Rotter & Ooi (2011), models A and C.
    #[default]
    Relative,
    /// That of each sphere against the world, twist included; nothing acts on other bodies. It depends on who
    /// watches, and makes angular momentum vanish: [`Blocks::rolling_impulse`](crate::Blocks::rolling_impulse).
    ///
    /// ```text
    /// M_i = −μ_r R̃ F_n ω_i/|ω_i|,    M_j = −μ_r R̃ F_n ω_j/|ω_j|                                              [N m]
    /// ```
    /// Source: Zhou, Wright, Yang, Xu & Yu (1999), Physica A 269, 536-553, whose rolling coefficient is the length
    /// `μ_r R̃`. Theirs has the direction of even the slowest turning; here a spring leads up to the limit, as with
    /// the other law, so that a sphere can rest.
    OwnSpin,
}

/// Constants of the contact of a sphere.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SphereJoint {
    pub normal: SphereSpring,
    /// `k_t` over the tangent normal stiffness; –.
    pub shear_ratio: f64,
    /// `ξ_t`; –.
    pub shear_damping_ratio: f64,
    /// `μ_s`, `μ_d`; –.
    pub static_friction: f64,
    pub dynamic_friction: f64,
    /// `μ_r`; –.
    pub rolling_friction: f64,
    /// `μ_w`; –.
    pub twisting_friction: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum SphereSpring {
    /// `k` (N/m) and `ξ` (–).
    Linear { stiffness: f64, damping_ratio: f64 },
    /// `E*` (Pa) and `β` (–).
    Hertz { modulus: f64, damping: f64 },
}

/// A sphere's normal spring at one overlap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpringState {
    /// Elastic; N.
    pub force: f64,
    /// `dF/dδ`; N/m.
    pub tangent: f64,
}

impl SphereJoint {
    pub(super) fn between(
        first: &Material,
        second: &Material,
        strength: &Strength,
        law: NormalLaw,
    ) -> Self {
        let (k1, k2) = (first.contact_stiffness, second.contact_stiffness);
        let stiffness = series(k1, k2);
        let restitution = strength.restitution;
        let shear = series(
            k1 * first.shear_stiffness_ratio,
            k2 * second.shear_stiffness_ratio,
        );
        let normal = match (law, &first.elastic, &second.elastic) {
            (NormalLaw::Hertz, Some(a), Some(b)) => SphereSpring::Hertz {
                modulus: 1.0 / (a.plane_compliance() + b.plane_compliance()),
                damping: hertz_damping(restitution),
            },
            _ => SphereSpring::Linear {
                stiffness,
                damping_ratio: damping_ratio(restitution),
            },
        };
        Self {
            normal,
            shear_ratio: shear / stiffness,
            shear_damping_ratio: strength.shear_damping_ratio,
            static_friction: strength.friction_angle.tan(),
            dynamic_friction: strength.residual_friction_angle.tan(),
            rolling_friction: strength.rolling_friction,
            twisting_friction: strength.twisting_friction,
        }
    }

    /// At overlap `δ` (m), effective radius (m) and reduced mass `m̃` (kg).
    pub fn normal(&self, overlap: f64, effective_radius: f64) -> SpringState {
        match self.normal {
            SphereSpring::Linear { stiffness, .. } => SpringState {
                force: stiffness * overlap,
                tangent: stiffness,
            },
            SphereSpring::Hertz { modulus, .. } => {
                let k = 4.0 / 3.0 * modulus * effective_radius.sqrt();
                let root = overlap.sqrt();
                SpringState {
                    force: k * overlap * root,
                    tangent: 1.5 * k * root,
                }
            }
        }
    }

    /// Normal dashpot at one overlap, between bodies of effective mass `mass` (kg); N s/m.
    pub fn viscosity(&self, overlap: f64, effective_radius: f64, mass: f64) -> f64 {
        match self.normal {
            SphereSpring::Linear {
                stiffness,
                damping_ratio,
            } => 2.0 * damping_ratio * (stiffness * mass).sqrt(),
            SphereSpring::Hertz { modulus, damping } => {
                let k = 4.0 / 3.0 * modulus * effective_radius.sqrt();
                damping * (k * mass).sqrt() * overlap.sqrt().sqrt()
            }
        }
    }

    /// Are stiffness and dashpots the same at any overlap?
    pub fn is_linear(&self) -> bool {
        matches!(self.normal, SphereSpring::Linear { .. })
    }

    /// Energy of the normal spring; J.
    pub fn energy(&self, overlap: f64, effective_radius: f64) -> f64 {
        match self.normal {
            SphereSpring::Linear { stiffness, .. } => 0.5 * stiffness * overlap * overlap,
            SphereSpring::Hertz { modulus, .. } => {
                8.0 / 15.0 * modulus * effective_radius.sqrt() * overlap.powf(2.5)
            }
        }
    }

    /// Largest tangent stiffness until the energy that the pair has now, with the rate of closing
    /// (m/s), is in the spring; N/m.
    ///
    /// ```text
    /// 2/5 K δ_max^5/2 = 2/5 K δ^5/2 + m̃ u²/2
    /// ```
    pub fn tangent_bound(
        &self,
        overlap: f64,
        effective_radius: f64,
        rate: f64,
        mobility: f64,
    ) -> f64 {
        match self.normal {
            SphereSpring::Linear { stiffness, .. } => stiffness,
            SphereSpring::Hertz { modulus, .. } => {
                let k = 4.0 / 3.0 * modulus * effective_radius.sqrt();
                let deepest = (overlap.powf(2.5) + 1.25 * rate * rate / (mobility * k)).powf(0.4);
                1.5 * k * deepest.sqrt()
            }
        }
    }

    /// Damping ratio for the step bound of a contact to come; –.
    pub fn damping_ratio_bound(&self) -> f64 {
        match self.normal {
            SphereSpring::Linear { damping_ratio, .. } => damping_ratio,
            // β √(m̃ K) δ^1/4 = 2 ξ √(m̃ 3/2 K δ^1/2)
            SphereSpring::Hertz { damping, .. } => 0.5 * damping / 1.5_f64.sqrt(),
        }
    }
}
