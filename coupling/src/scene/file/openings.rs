//! Schema of absorbing layers, inflows and outflows.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{SideFile, Triple};

/// A box of damped water: `dv/dt = −rate (s/L)² v`, with `s` from 0 to its length `L`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AbsorberFile {
    /// Unique name.
    pub name: String,
    /// Lower corner; m.
    #[schemars(extend("x-unit" = "m"))]
    pub min: Triple,
    /// Upper corner; m.
    #[schemars(extend("x-unit" = "m"))]
    pub max: Triple,
    /// The side of strongest damping, the end of the flume.
    pub towards: SideFile,
    /// Damping rate there; chosen from depth and length when left out; 1/s.
    #[serde(default)]
    #[schemars(extend("x-unit" = "1/s", "exclusiveMinimum" = 0))]
    pub rate: Option<f64>,
}

/// A box of water with prescribed motion, filled with whole rows, and its inflow face. At least a support radius and
/// a spacing long.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InflowFile {
    /// Unique name.
    pub name: String,
    /// Lower corner, on the bed; m.
    #[schemars(extend("x-unit" = "m"))]
    pub min: Triple,
    /// Upper corner; m.
    #[schemars(extend("x-unit" = "m"))]
    pub max: Triple,
    /// The downstream side: the face to the modeled water.
    pub towards: SideFile,
    /// Rows of time and velocity, linear between rows and constant outside; this or `discharge`; s, m/s.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s, m/s"))]
    pub velocity: Vec<(f64, f64)>,
    /// Rows of time and discharge through the face, in two dimensions through the slice; s, m³/s.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s, m³/s"))]
    pub discharge: Vec<(f64, f64)>,
    /// Rows of time and depth above the bottom of the box, rounded to whole rows of particles; that of the box when
    /// left out; s, m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s, m"))]
    pub depth: Vec<(f64, f64)>,
}

/// A box through which water leaves at its own velocity, and the face beyond which it is removed. At least a support
/// radius long.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutflowFile {
    /// Unique name.
    pub name: String,
    /// Lower corner, on the bed; m.
    #[schemars(extend("x-unit" = "m"))]
    pub min: Triple,
    /// Upper corner; m.
    #[schemars(extend("x-unit" = "m"))]
    pub max: Triple,
    /// The downstream side, where water is removed.
    pub towards: SideFile,
    /// Rows of time and depth above the bottom of the box, whose pressures are imposed; free when left out; s, m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s, m"))]
    pub depth: Vec<(f64, f64)>,
}
