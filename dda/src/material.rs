//! Rock materials, and the joint that two of them make where they touch.

mod joint;
mod restitution;
mod sphere_joint;

use crate::BlockError;
use crate::ranges::{Property, PropertyRange};

pub use joint::JointOverride;
pub(crate) use joint::{Joint, Scaling};
pub use restitution::{clamped_restitution, damping_ratio};
pub(crate) use sphere_joint::SphereJoint;
pub use sphere_joint::{NormalLaw, RollingLaw};

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

/// Damping ratio of the shear dashpots where nothing else is wanted; –.
pub const DEFAULT_SHEAR_DAMPING_RATIO: f64 = 0.2;

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
    /// Damping ratio `ξ_t` of the shear dashpots, ≥ 0: `2 ξ_t √(k_t m̃)`. With [`DEFAULT_SHEAR_DAMPING_RATIO`] a sliding block
    /// that stops does not oscillate; –.
    pub shear_damping_ratio: f64,
    /// Resistance of spheres to rolling, ≥ 0: torque over normal force and effective radius; –.
    pub rolling_friction: f64,
    /// Resistance of spheres to twisting about the normal, ≥ 0: torque over normal force and effective radius; –.
    pub twisting_friction: f64,
    /// Elastic moduli.
    pub elastic: Option<Elastic>,
}

impl Material {
    /// A property in SI units; `None` if the material has none.
    pub fn property(&self, property: Property) -> Option<f64> {
        let elastic = |number: fn(&Elastic) -> f64| self.elastic.as_ref().map(number);
        match property {
            Property::Density => Some(self.density),
            Property::FrictionAngle => Some(self.friction_angle),
            Property::ResidualFrictionAngle => self.residual_friction_angle,
            Property::JointStiffness => self.joint_stiffness,
            Property::Cohesion => Some(self.cohesion),
            Property::ResidualCohesion => Some(self.residual_cohesion),
            Property::TensileStrength => Some(self.tensile_strength),
            Property::Restitution => Some(self.restitution),
            Property::ContactStiffness => Some(self.contact_stiffness),
            Property::ShearStiffnessRatio => Some(self.shear_stiffness_ratio),
            Property::ShearDampingRatio => Some(self.shear_damping_ratio),
            Property::RollingFriction => Some(self.rolling_friction),
            Property::TwistingFriction => Some(self.twisting_friction),
            Property::YoungModulus => elastic(|e| e.young_modulus),
            Property::Viscosity => elastic(|e| e.viscosity),
            Property::PoissonRatio => elastic(|e| e.poisson_ratio),
        }
    }

    fn check(&self, material: usize) -> Result<(), BlockError> {
        match PropertyRange::violations(|property| self.property(property)).next() {
            Some((range, value)) => Err(BlockError::Material {
                material,
                range,
                value,
            }),
            None => Ok(()),
        }
    }
}
