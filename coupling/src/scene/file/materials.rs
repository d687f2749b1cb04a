//! Materials, and what holds between two of them.

use serde::{Deserialize, Serialize};

/// A rock or wall material. Where two meet, the lesser friction, cohesion, tension and
/// restitution hold, and the stiffnesses act in series; `joints` can say otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialFile {
    /// Name that blocks refer to.
    pub name: String,
    /// Density; kg/m³.
    pub density: f64,
    /// Friction angle of its joints; degrees.
    pub friction_angle_deg: f64,
    /// Friction angle of a joint once it has slipped or broken; the same when left out; degrees.
    #[serde(default)]
    pub residual_friction_angle_deg: Option<f64>,
    /// Cohesion of a joint until it breaks; Pa.
    #[serde(default)]
    pub cohesion: f64,
    /// Cohesion of a joint that has broken, at most `cohesion`; Pa.
    #[serde(default)]
    pub residual_cohesion: f64,
    /// Tensile strength of a joint until it breaks; Pa.
    #[serde(default)]
    pub tensile_strength: f64,
    /// Normal restitution, 0 to 1; what is below 0.135 rebounds with 0.135, as no dashpot is more than critical.
    #[serde(default)]
    pub restitution: f64,
    /// Contact penalty stiffness of a block of this material; N/m.
    #[serde(default)]
    pub contact_stiffness: Option<f64>,
    /// Normal stiffness of its joints per area; where both materials have one it holds instead of
    /// `contact_stiffness`; Pa/m.
    #[serde(default)]
    pub joint_stiffness: Option<f64>,
    /// Shear over normal penalty stiffness.
    #[serde(default = "default_shear_stiffness_ratio")]
    pub shear_stiffness_ratio: f64,
    /// Resistance of balls to rolling: torque over normal force and effective radius. Where two materials
    /// meet, their mean.
    #[serde(default)]
    pub rolling_friction: f64,
    /// Elastic moduli, which deformable blocks and Hertz's law need; rigid blocks ignore them.
    #[serde(default)]
    pub elastic: Option<ElasticFile>,
}

/// Isotropic linear elasticity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElasticFile {
    /// Young's modulus; Pa.
    pub young_modulus: f64,
    /// Poisson's ratio, above -1 and below 0.5.
    pub poisson_ratio: f64,
    /// Viscosity of the strain rate; Pa s.
    #[serde(default)]
    pub viscosity: f64,
}

/// What holds between two materials, or within one named twice; what is left out follows from the two.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointFile {
    /// Names of the two materials, in either order.
    pub between: (String, String),
    /// Friction angle; degrees.
    #[serde(default)]
    pub friction_angle_deg: Option<f64>,
    /// Friction angle once the joint has slipped or broken; that of this joint when left out, if it has one;
    /// degrees.
    #[serde(default)]
    pub residual_friction_angle_deg: Option<f64>,
    /// Cohesion until the joint breaks; Pa.
    #[serde(default)]
    pub cohesion: Option<f64>,
    /// Cohesion once the joint has broken, at most the cohesion; Pa.
    #[serde(default)]
    pub residual_cohesion: Option<f64>,
    /// Tensile strength until the joint breaks; Pa.
    #[serde(default)]
    pub tensile_strength: Option<f64>,
    /// Normal restitution, 0 to 1; what is below 0.135 rebounds with 0.135, as no dashpot is more than critical.
    #[serde(default)]
    pub restitution: Option<f64>,
    /// Resistance of balls to rolling: torque over normal force and effective radius.
    #[serde(default)]
    pub rolling_friction: Option<f64>,
    /// Rows of time and share of the tangent of the friction angles that is left, linear between them: a slope that weakens until it
    /// fails; all of it when left out; s, -.
    #[serde(default)]
    pub friction_ramp: Vec<(f64, f64)>,
    /// Rows of time and share of the cohesions that is left, likewise; s, -.
    #[serde(default)]
    pub cohesion_ramp: Vec<(f64, f64)>,
}

fn default_shear_stiffness_ratio() -> f64 {
    0.8
}
