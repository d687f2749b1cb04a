//! Materials, and what holds between two of them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rock or wall material. Between two materials the smaller friction, cohesion, tensile strength and restitution
/// apply, and the stiffnesses act in series; `joints` can override this.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialFile {
    /// Name that blocks refer to.
    pub name: String,
    /// Density; kg/m³.
    #[schemars(extend("x-unit" = "kg/m³", "exclusiveMinimum" = 0))]
    pub density: f64,
    /// Friction angle of its joints; degrees.
    #[schemars(extend("x-unit" = "degrees", "minimum" = 0, "exclusiveMaximum" = 90))]
    pub friction_angle_deg: f64,
    /// Friction angle of a joint once it has slipped or broken; degrees. As before when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "degrees", "minimum" = 0, "exclusiveMaximum" = 90))]
    pub residual_friction_angle_deg: Option<f64>,
    /// Cohesion of a joint until it breaks; Pa.
    #[serde(default)]
    #[schemars(extend("x-unit" = "Pa", "minimum" = 0))]
    pub cohesion: f64,
    /// Cohesion of a joint that has broken, at most `cohesion`; Pa.
    #[serde(default)]
    #[schemars(extend("x-unit" = "Pa", "minimum" = 0))]
    pub residual_cohesion: f64,
    /// Tensile strength of a joint until it breaks; Pa.
    #[serde(default)]
    #[schemars(extend("x-unit" = "Pa", "minimum" = 0))]
    pub tensile_strength: f64,
    /// Normal restitution, 0 to 1; values below 0.135 act as 0.135, since no dashpot exceeds critical damping.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "minimum" = 0, "maximum" = 1))]
    pub restitution: f64,
    /// Contact penalty stiffness of a block of this material; N/m. When left out, chosen for an overlap of 0.1 % of the block's
    /// size at rest and of 2 % at the expected speed, 10 % for blocks of slides. The sub-step of the blocks falls with its root:
    /// four times the stiffness takes twice the steps, while soft contacts overlap, of which `check` warns.
    #[serde(default)]
    #[schemars(extend("x-unit" = "N/m"))]
    pub contact_stiffness: Option<f64>,
    /// Normal stiffness of its joints per unit area; if both materials have one, it replaces `contact_stiffness`;
    /// Pa/m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "Pa/m"))]
    pub joint_stiffness: Option<f64>,
    /// Ratio of shear to normal penalty stiffness.
    #[serde(default = "default_shear_stiffness_ratio")]
    #[schemars(extend("x-unit" = "-"))]
    pub shear_stiffness_ratio: f64,
    /// Damping ratio `ξ_t` of the shear dashpots of its contacts, `2 ξ_t √(k_t m̃)` with the effective mass `m̃`. 1 takes 2.8 times
    /// as many steps of spheres as 0.2 does. Between two materials the mean applies. No effect with contact dynamics.
    #[serde(default = "default_shear_damping_ratio")]
    #[schemars(extend("x-unit" = "-", "minimum" = 0))]
    pub shear_damping_ratio: f64,
    /// Rolling resistance of spheres: torque over normal force and effective radius. Between two materials the mean
    /// applies.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "minimum" = 0))]
    pub rolling_friction: f64,
    /// Twisting resistance of spheres, about the normal of a contact: torque over normal force and effective radius. Between two
    /// materials the mean applies. By contact dynamics only.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "minimum" = 0))]
    pub twisting_friction: f64,
    /// Elastic moduli, required by deformable blocks and Hertz's law; rigid blocks ignore them.
    #[serde(default)]
    pub elastic: Option<ElasticFile>,
}

/// Isotropic linear elasticity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ElasticFile {
    /// Young's modulus; Pa.
    #[schemars(extend("x-unit" = "Pa", "exclusiveMinimum" = 0))]
    pub young_modulus: f64,
    /// Poisson's ratio, above -1 and below 0.5.
    #[schemars(extend("x-unit" = "-", "exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
    pub poisson_ratio: f64,
    /// Viscosity of the strain rate; Pa s.
    #[serde(default)]
    #[schemars(extend("x-unit" = "Pa s", "minimum" = 0))]
    pub viscosity: f64,
}

/// Joint properties between two materials, or within one that is named twice; properties left out are derived from
/// the two.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointFile {
    /// Names of the two materials, in either order.
    pub between: (String, String),
    /// Friction angle; degrees.
    #[serde(default)]
    #[schemars(extend("x-unit" = "degrees", "minimum" = 0, "exclusiveMaximum" = 90))]
    pub friction_angle_deg: Option<f64>,
    /// Friction angle once the joint has slipped or broken; when left out, the friction angle of this joint if it has
    /// one; degrees.
    #[serde(default)]
    #[schemars(extend("x-unit" = "degrees", "minimum" = 0, "exclusiveMaximum" = 90))]
    pub residual_friction_angle_deg: Option<f64>,
    /// Cohesion until the joint breaks; Pa.
    #[serde(default)]
    #[schemars(extend("x-unit" = "Pa", "minimum" = 0))]
    pub cohesion: Option<f64>,
    /// Cohesion once the joint has broken, at most the cohesion; Pa.
    #[serde(default)]
    #[schemars(extend("x-unit" = "Pa", "minimum" = 0))]
    pub residual_cohesion: Option<f64>,
    /// Tensile strength until the joint breaks; Pa.
    #[serde(default)]
    #[schemars(extend("x-unit" = "Pa", "minimum" = 0))]
    pub tensile_strength: Option<f64>,
    /// Normal restitution, 0 to 1; values below 0.135 act as 0.135, since no dashpot exceeds critical damping.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "minimum" = 0, "maximum" = 1))]
    pub restitution: Option<f64>,
    /// Damping ratio of the shear dashpots. No effect with contact dynamics.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "minimum" = 0))]
    pub shear_damping_ratio: Option<f64>,
    /// Rolling resistance of spheres: torque over normal force and effective radius.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "minimum" = 0))]
    pub rolling_friction: Option<f64>,
    /// Twisting resistance of spheres, about the normal of a contact: torque over normal force and effective radius. By contact
    /// dynamics only.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "minimum" = 0))]
    pub twisting_friction: Option<f64>,
    /// Rows of time and remaining fraction of the tangent of the friction angles, with linear interpolation: a slope
    /// that weakens until it fails; full strength when left out; s, -.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s, -"))]
    pub friction_ramp: Vec<(f64, f64)>,
    /// Rows of time and remaining fraction of the cohesions, likewise; s, -.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s, -"))]
    pub cohesion_ramp: Vec<(f64, f64)>,
}

fn default_shear_stiffness_ratio() -> f64 {
    0.8
}

fn default_shear_damping_ratio() -> f64 {
    riprap_dda::DEFAULT_SHEAR_DAMPING_RATIO
}
