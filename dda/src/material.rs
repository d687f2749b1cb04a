//! Rock materials, and the joint that two of them make where they touch.

use crate::BlockError;
use serde::{Deserialize, Serialize};

/// Isotropic linear elasticity of deformable blocks; rigid blocks ignore it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastic {
    /// Young's modulus, > 0; Pa.
    pub young_modulus: f64,
    /// Poisson's ratio, above −1 and below 0.5; –.
    pub poisson_ratio: f64,
    /// Viscosity of the strain rate, ≥ 0 (Kelvin & Voigt); Pa s.
    pub viscosity: f64,
}

impl Elastic {
    /// `(1 − ν²)/E`; 1/Pa.
    fn plane_compliance(&self) -> f64 {
        (1.0 - self.poisson_ratio * self.poisson_ratio) / self.young_modulus
    }
}

/// A rock or wall material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Density, > 0; kg/m³.
    pub density: f64,
    /// Friction angle of its joints, 0 ≤ φ < π/2; rad.
    pub friction_angle: f64,
    /// Friction angle once a joint has slipped or broken, at most the other; the same if none; rad.
    pub residual_friction_angle: Option<f64>,
    /// Cohesion of a joint until it breaks, ≥ 0; Pa.
    pub cohesion: f64,
    /// Cohesion of a joint that has broken, 0 to `cohesion`; Pa.
    pub residual_cohesion: f64,
    /// Tensile strength of a joint until it breaks, ≥ 0; Pa.
    pub tensile_strength: f64,
    /// Normal restitution, 0 to 1; below exp(−2) = 0.135 the contact is critically damped and
    /// rebounds with that; –.
    pub restitution: f64,
    /// Normal penalty stiffness of a whole contact, > 0; N/m.
    pub contact_stiffness: f64,
    /// Normal stiffness of its joints per area, > 0; Pa/m. Where both materials have one it is used
    /// instead of `contact_stiffness`.
    pub joint_stiffness: Option<f64>,
    /// Shear over normal penalty stiffness, ≥ 0; –.
    pub shear_stiffness_ratio: f64,
    /// Resistance of spheres to rolling, ≥ 0: torque over normal force and effective radius; –.
    pub rolling_friction: f64,
    /// Elastic moduli.
    pub elastic: Option<Elastic>,
}

impl Material {
    pub(crate) fn check(&self, material: usize) -> Result<(), BlockError> {
        let Self {
            density,
            friction_angle,
            residual_friction_angle,
            cohesion,
            residual_cohesion,
            tensile_strength,
            restitution,
            contact_stiffness,
            joint_stiffness,
            shear_stiffness_ratio,
            rolling_friction,
            elastic,
        } = *self;
        let half_pi = std::f64::consts::FRAC_PI_2;
        let mut fields = vec![
            ("density", density, density > 0.0, "must be > 0 kg/m³"),
            (
                "friction_angle",
                friction_angle,
                (0.0..half_pi).contains(&friction_angle),
                "must be in [0, π/2) rad",
            ),
            ("cohesion", cohesion, cohesion >= 0.0, "must be >= 0 Pa"),
            (
                "residual_cohesion",
                residual_cohesion,
                (0.0..=cohesion).contains(&residual_cohesion),
                "must be in [0, cohesion] Pa",
            ),
            (
                "tensile_strength",
                tensile_strength,
                tensile_strength >= 0.0,
                "must be >= 0 Pa",
            ),
            (
                "restitution",
                restitution,
                (0.0..=1.0).contains(&restitution),
                "must be in [0, 1]",
            ),
            (
                "contact_stiffness",
                contact_stiffness,
                contact_stiffness > 0.0,
                "must be > 0 N/m",
            ),
            (
                "shear_stiffness_ratio",
                shear_stiffness_ratio,
                shear_stiffness_ratio >= 0.0,
                "must be >= 0",
            ),
            (
                "rolling_friction",
                rolling_friction,
                rolling_friction >= 0.0,
                "must be >= 0",
            ),
        ];
        if let Some(angle) = residual_friction_angle {
            let is_good = (0.0..=friction_angle).contains(&angle);
            let rule = "must be in [0, friction_angle] rad";
            fields.push(("residual_friction_angle", angle, is_good, rule));
        }
        if let Some(stiffness) = joint_stiffness {
            let is_good = stiffness > 0.0;
            fields.push(("joint_stiffness", stiffness, is_good, "must be > 0 Pa/m"));
        }
        if let Some(elastic) = elastic {
            let (e, nu) = (elastic.young_modulus, elastic.poisson_ratio);
            fields.push(("young_modulus", e, e > 0.0, "must be > 0 Pa"));
            let eta = elastic.viscosity;
            fields.push(("viscosity", eta, eta >= 0.0, "must be >= 0 Pa s"));
            fields.push((
                "poisson_ratio",
                nu,
                nu > -1.0 && nu < 0.5,
                "must be above -1 and below 0.5",
            ));
        }
        match first_bad(fields) {
            Some((field, value, rule)) => Err(BlockError::Material {
                material,
                field,
                value,
                rule,
            }),
            None => Ok(()),
        }
    }
}

/// Name, value, whether it is in its range, and the range.
type Field = (&'static str, f64, bool, &'static str);

fn first_bad(fields: Vec<Field>) -> Option<(&'static str, f64, &'static str)> {
    fields
        .into_iter()
        .find(|(_, value, is_good, _)| !(*is_good && value.is_finite()))
        .map(|(field, value, _, rule)| (field, value, rule))
}

/// Joint properties between two materials that override those derived from the two. Omitted properties are derived from
/// them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointOverride {
    /// Positions in the list of materials, in either order; twice the same for a material against itself.
    pub materials: (usize, usize),
    /// Friction angle, 0 ≤ φ < π/2; rad.
    pub friction_angle: Option<f64>,
    /// Friction angle once the joint has slipped or broken, 0 to the friction angle; if there is a friction angle
    /// here but none of these, the same as that; rad.
    pub residual_friction_angle: Option<f64>,
    /// Cohesion until the joint breaks, ≥ 0; Pa.
    pub cohesion: Option<f64>,
    /// Cohesion once the joint has broken, 0 to the cohesion; if there is none here, what follows from the two, at
    /// most the cohesion; Pa.
    pub residual_cohesion: Option<f64>,
    /// Tensile strength until the joint breaks, ≥ 0; Pa.
    pub tensile_strength: Option<f64>,
    /// Normal restitution, 0 to 1; –.
    pub restitution: Option<f64>,
    /// Resistance of spheres to rolling, ≥ 0: torque over normal force and effective radius; –.
    pub rolling_friction: Option<f64>,
}

impl JointOverride {
    fn concerns(&self, first: usize, second: usize) -> bool {
        self.materials == (first, second) || self.materials == (second, first)
    }
}

/// Strength of a joint.
#[derive(Clone, Copy, Debug)]
struct Strength {
    friction_angle: f64,
    residual_friction_angle: f64,
    cohesion: f64,
    residual_cohesion: f64,
    tensile_strength: f64,
    restitution: f64,
    rolling_friction: f64,
}

impl Strength {
    fn between(first: &Material, second: &Material) -> Self {
        let residual = |m: &Material| m.residual_friction_angle.unwrap_or(m.friction_angle);
        Self {
            friction_angle: first.friction_angle.min(second.friction_angle),
            residual_friction_angle: residual(first).min(residual(second)),
            cohesion: first.cohesion.min(second.cohesion),
            residual_cohesion: first.residual_cohesion.min(second.residual_cohesion),
            tensile_strength: first.tensile_strength.min(second.tensile_strength),
            restitution: first.restitution.min(second.restitution),
            rolling_friction: 0.5 * (first.rolling_friction + second.rolling_friction),
        }
    }

    fn overridden(self, by: &JointOverride) -> Self {
        let residual = by.residual_friction_angle.or(by.friction_angle);
        let cohesion = by.cohesion.unwrap_or(self.cohesion);
        Self {
            friction_angle: by.friction_angle.unwrap_or(self.friction_angle),
            residual_friction_angle: residual.unwrap_or(self.residual_friction_angle),
            cohesion,
            residual_cohesion: by
                .residual_cohesion
                .unwrap_or_else(|| self.residual_cohesion.min(cohesion)),
            tensile_strength: by.tensile_strength.unwrap_or(self.tensile_strength),
            restitution: by.restitution.unwrap_or(self.restitution),
            rolling_friction: by.rolling_friction.unwrap_or(self.rolling_friction),
        }
    }

    fn fields(&self) -> Vec<Field> {
        let Self {
            friction_angle,
            residual_friction_angle,
            cohesion,
            residual_cohesion,
            tensile_strength,
            restitution,
            rolling_friction,
        } = *self;
        vec![
            (
                "friction_angle",
                friction_angle,
                (0.0..std::f64::consts::FRAC_PI_2).contains(&friction_angle),
                "must be in [0, π/2) rad",
            ),
            (
                "residual_friction_angle",
                residual_friction_angle,
                (0.0..=friction_angle).contains(&residual_friction_angle),
                "must be in [0, friction_angle] rad",
            ),
            ("cohesion", cohesion, cohesion >= 0.0, "must be >= 0 Pa"),
            (
                "residual_cohesion",
                residual_cohesion,
                (0.0..=cohesion).contains(&residual_cohesion),
                "must be in [0, cohesion] Pa",
            ),
            (
                "tensile_strength",
                tensile_strength,
                tensile_strength >= 0.0,
                "must be >= 0 Pa",
            ),
            (
                "restitution",
                restitution,
                (0.0..=1.0).contains(&restitution),
                "must be in [0, 1]",
            ),
            (
                "rolling_friction",
                rolling_friction,
                rolling_friction >= 0.0,
                "must be >= 0",
            ),
        ]
    }
}

/// Scaling of the pair's stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Scaling {
    /// N/m of the whole contact: weights of flat faces sum to 1.
    Point,
    /// Pa/m: weights are areas.
    Area,
}

/// Constants of the contact between two materials.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Joint {
    /// Scaling of the stiffnesses.
    pub scaling: Scaling,
    /// `K`; N/m or Pa/m.
    pub normal_stiffness: f64,
    /// `K_t`; N/m or Pa/m.
    pub shear_stiffness: f64,
    /// `tan φ`; –.
    pub friction: f64,
    /// Friction coefficient once it has slipped or broken.
    pub residual_friction: f64,
    /// `c`; Pa.
    pub cohesion: f64,
    /// `c_r`, once it has broken; Pa.
    pub residual_cohesion: f64,
    /// `T`; Pa.
    pub tensile_strength: f64,
    /// `ξ_n`, from the restitution; –.
    pub damping_ratio: f64,
    /// Joint properties if one of the two is a sphere.
    pub spheres: SphereJoint,
}

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
    /// `μ_s`, `μ_d`; –.
    pub static_friction: f64,
    pub dynamic_friction: f64,
    /// `μ_r`; –.
    pub rolling_friction: f64,
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
    fn between(first: &Material, second: &Material, strength: &Strength, law: NormalLaw) -> Self {
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
            static_friction: strength.friction_angle.tan(),
            dynamic_friction: strength.residual_friction_angle.tan(),
            rolling_friction: strength.rolling_friction,
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

/// Stiffness of two half springs in series, so that equal ones keep their value.
fn series(a: f64, b: f64) -> f64 {
    if a + b > 0.0 {
        2.0 * a * b / (a + b)
    } else {
        0.0
    }
}

impl Joint {
    /// Joints of every pair of materials, row by row.
    ///
    /// # Errors
    ///
    /// [`BlockError::Material`] and [`BlockError::Joint`] for numbers out of range, [`BlockError::JointPair`] for
    /// materials that are not there, or a pair with two overrides.
    pub fn table(
        materials: &[Material],
        overrides: &[JointOverride],
        law: NormalLaw,
    ) -> Result<Vec<Self>, BlockError> {
        for (k, material) in materials.iter().enumerate() {
            material.check(k)?;
        }
        for (joint, by) in overrides.iter().enumerate() {
            let (i, j) = by.materials;
            let (Some(first), Some(second)) = (materials.get(i), materials.get(j)) else {
                let reason = "there is no such material";
                return Err(BlockError::JointPair { joint, reason });
            };
            if overrides[..joint].iter().any(|other| other.concerns(i, j)) {
                let reason = "its two materials have one already";
                return Err(BlockError::JointPair { joint, reason });
            }
            let strength = Strength::between(first, second).overridden(by);
            if let Some((field, value, rule)) = first_bad(strength.fields()) {
                return Err(BlockError::Joint {
                    joint,
                    field,
                    value,
                    rule,
                });
            }
        }
        let mut joints = Vec::with_capacity(materials.len() * materials.len());
        for (i, first) in materials.iter().enumerate() {
            for (j, second) in materials.iter().enumerate() {
                let own = Strength::between(first, second);
                let strength = match overrides.iter().find(|by| by.concerns(i, j)) {
                    Some(by) => own.overridden(by),
                    None => own,
                };
                joints.push(Self::between(first, second, &strength, law));
            }
        }
        Ok(joints)
    }

    /// Between two materials the smaller friction, cohesion, tensile strength and restitution apply, and the mean
    /// rolling friction, unless overridden; the springs act as halves in series, so that equal
    /// materials keep their value:
    ///
    /// ```text
    /// K = 2 k₁ k₂/(k₁ + k₂)                                         [N/m]
    /// ```
    /// The same rule, for the products `K · ratio`, gives the shear spring.
    fn between(first: &Material, second: &Material, strength: &Strength, law: NormalLaw) -> Self {
        let (scaling, k1, k2) = match (first.joint_stiffness, second.joint_stiffness) {
            (Some(k1), Some(k2)) => (Scaling::Area, k1, k2),
            _ => (
                Scaling::Point,
                first.contact_stiffness,
                second.contact_stiffness,
            ),
        };
        Self {
            scaling,
            normal_stiffness: series(k1, k2),
            shear_stiffness: series(
                k1 * first.shear_stiffness_ratio,
                k2 * second.shear_stiffness_ratio,
            ),
            friction: strength.friction_angle.tan(),
            residual_friction: strength.residual_friction_angle.tan(),
            cohesion: strength.cohesion,
            residual_cohesion: strength.residual_cohesion,
            tensile_strength: strength.tensile_strength,
            damping_ratio: damping_ratio(strength.restitution),
            spheres: SphereJoint::between(first, second, strength, law),
        }
    }
}

/// Restitution of a spring and dashpot whose force is never allowed to pull.
///
/// ```text
/// e = exp( −(ξ/s)(π − atan2(2ξs, s² − ξ²)) ),   s = √(1 − ξ²);   with ξ = cos θ:   e = exp(−2θ cot θ)
/// ```
/// Source: Schwager & Pöschel (2007). At ξ = 1 the rebound is exp(−2).
pub fn clamped_restitution(damping_ratio: f64) -> f64 {
    if damping_ratio >= 1.0 {
        return (-2.0_f64).exp();
    }
    let theta = damping_ratio.acos();
    (-2.0 * theta * damping_ratio / theta.sin()).exp()
}

/// Damping ratio that gives a restitution, by bisection of [`clamped_restitution`]; at most 1.
pub fn damping_ratio(restitution: f64) -> f64 {
    if restitution <= clamped_restitution(1.0) {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if clamped_restitution(middle) > restitution {
            low = middle;
        } else {
            high = middle;
        }
    }
    if restitution >= 1.0 {
        0.0
    } else {
        0.5 * (low + high)
    }
}

/// Restitution of Hertz's spring with the dashpot `β`, its force never pulling. It does not depend on the
/// speed: with `x` in units of `(m̃ v²/K)^2/5`,
///
/// ```text
/// x″ = −max(0, x^3/2 + β x^1/4 x′),    x = 0, x′ = 1 at first;    e = −x′ where the force ends
/// ```
/// Runge-Kutta with some 3000 steps in a contact.
fn hertz_restitution(damping: f64) -> f64 {
    const STEP: f64 = 1e-3;
    /// Ten contacts without damping: what is over-damped creeps back, with next to no speed.
    const LONGEST: u32 = 30_000;
    let force = |x: f64, v: f64| {
        let root = x.max(0.0).sqrt();
        x.max(0.0) * root + damping * root.sqrt() * v
    };
    let (mut x, mut v) = (0.0, 1.0);
    for _ in 0..LONGEST {
        let slope = |x: f64, v: f64| (v, -force(x, v));
        let a = slope(x, v);
        let b = slope(x + 0.5 * STEP * a.0, v + 0.5 * STEP * a.1);
        let c = slope(x + 0.5 * STEP * b.0, v + 0.5 * STEP * b.1);
        let d = slope(x + STEP * c.0, v + STEP * c.1);
        let (before, pushed) = (v, force(x, v));
        x += STEP / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0);
        v += STEP / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1);
        let push = force(x, v);
        if push <= 0.0 && v < 0.0 {
            // The force falls to zero inside the step: the rest of its impulse is a triangle.
            let share = pushed / (pushed - push);
            return -(before - 0.5 * pushed * share * STEP);
        }
    }
    -v
}

/// `β` that gives a restitution, by bisection of [`hertz_restitution`]; at most what damps critically in
/// effect.
fn hertz_damping(restitution: f64) -> f64 {
    const MOST: f64 = 4.0;
    if restitution >= 1.0 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, MOST);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if hertz_restitution(middle) > restitution {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damping_from_restitution() {
        // Values of Schwager & Pöschel's formula, five digits.
        for (restitution, ratio) in [(0.2, 0.73125), (0.5, 0.25528), (0.8, 0.07436)] {
            assert!((damping_ratio(restitution) - ratio).abs() < 1e-5);
            assert!((clamped_restitution(damping_ratio(restitution)) - restitution).abs() < 1e-12);
        }
        assert!((clamped_restitution(0.45595) - 0.32486).abs() < 1e-5);
        assert_eq!(damping_ratio(1.0), 0.0);
        assert_eq!(damping_ratio(0.0), 1.0);
    }
}
