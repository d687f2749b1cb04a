//! Joints between two materials: strength, and springs and dashpots of their contacts.

use serde::{Deserialize, Serialize};

use super::restitution::damping_ratio;
use super::{Material, NormalLaw, Property, PropertyRange, SphereJoint};
use crate::BlockError;

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
    /// Damping ratio of the shear dashpots, ≥ 0; –.
    pub shear_damping_ratio: Option<f64>,
    /// Resistance of spheres to rolling, ≥ 0: torque over normal force and effective radius; –.
    pub rolling_friction: Option<f64>,
    /// Resistance of spheres to twisting about the normal, ≥ 0: torque over normal force and effective radius; –.
    pub twisting_friction: Option<f64>,
}

impl JointOverride {
    fn concerns(&self, first: usize, second: usize) -> bool {
        self.materials == (first, second) || self.materials == (second, first)
    }
}

/// Strength and losses of a joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strength {
    pub friction_angle: f64,
    pub residual_friction_angle: f64,
    pub cohesion: f64,
    pub residual_cohesion: f64,
    pub tensile_strength: f64,
    pub restitution: f64,
    pub shear_damping_ratio: f64,
    pub rolling_friction: f64,
    pub twisting_friction: f64,
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
            shear_damping_ratio: 0.5 * (first.shear_damping_ratio + second.shear_damping_ratio),
            rolling_friction: 0.5 * (first.rolling_friction + second.rolling_friction),
            twisting_friction: 0.5 * (first.twisting_friction + second.twisting_friction),
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
            shear_damping_ratio: by.shear_damping_ratio.unwrap_or(self.shear_damping_ratio),
            rolling_friction: by.rolling_friction.unwrap_or(self.rolling_friction),
            twisting_friction: by.twisting_friction.unwrap_or(self.twisting_friction),
        }
    }

    /// A property in SI units; `None` if a joint has none.
    fn property(&self, property: Property) -> Option<f64> {
        match property {
            Property::FrictionAngle => Some(self.friction_angle),
            Property::ResidualFrictionAngle => Some(self.residual_friction_angle),
            Property::Cohesion => Some(self.cohesion),
            Property::ResidualCohesion => Some(self.residual_cohesion),
            Property::TensileStrength => Some(self.tensile_strength),
            Property::Restitution => Some(self.restitution),
            Property::ShearDampingRatio => Some(self.shear_damping_ratio),
            Property::RollingFriction => Some(self.rolling_friction),
            Property::TwistingFriction => Some(self.twisting_friction),
            Property::Density
            | Property::JointStiffness
            | Property::ContactStiffness
            | Property::ShearStiffnessRatio
            | Property::YoungModulus
            | Property::Viscosity
            | Property::PoissonRatio => None,
        }
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
    /// `e` of normal impacts; –.
    pub restitution: f64,
    /// `ξ_n`, from the restitution; –.
    pub damping_ratio: f64,
    /// `ξ_t`; –.
    pub shear_damping_ratio: f64,
    /// Joint properties if one of the two is a sphere.
    pub spheres: SphereJoint,
}

/// Stiffness of two half springs in series, so that equal ones keep their value.
pub(super) fn series(a: f64, b: f64) -> f64 {
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
            let violation =
                PropertyRange::violations(|property| strength.property(property)).next();
            if let Some((range, value)) = violation {
                return Err(BlockError::Joint {
                    joint,
                    range,
                    value,
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
    /// rolling and twisting friction and shear damping, unless overridden; the springs act as halves in series, so that equal
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
            restitution: strength.restitution,
            damping_ratio: damping_ratio(strength.restitution),
            shear_damping_ratio: strength.shear_damping_ratio,
            spheres: SphereJoint::between(first, second, strength, law),
        }
    }
}
