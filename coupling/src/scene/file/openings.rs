//! Where waves are absorbed, and water comes in and goes out.

use serde::{Deserialize, Serialize};

use super::{SideFile, Triple};

/// A box in which the water is damped: `dv/dt = −rate (s/L)² v`, with `s` from 0 to its length `L`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AbsorberFile {
    /// Unique name.
    pub name: String,
    /// Lower corner; m.
    pub min: Triple,
    /// Upper corner; m.
    pub max: Triple,
    /// The side at which it is strongest, the end of the flume.
    pub towards: SideFile,
    /// Damping there; chosen from depth and length when left out; 1/s.
    #[serde(default)]
    pub rate: Option<f64>,
}

/// A box of water that moves as given, filled with whole rows, and the face through which it flows in. At least a
/// support radius and a spacing long.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InflowFile {
    /// Unique name.
    pub name: String,
    /// Lower corner, on the bed; m.
    pub min: Triple,
    /// Upper corner; m.
    pub max: Triple,
    /// The side that the water goes to: the face to the modelled water.
    pub towards: SideFile,
    /// Rows of time and velocity, linear between and constant outside; this or `discharge`; s, m/s.
    #[serde(default)]
    pub velocity: Vec<(f64, f64)>,
    /// Rows of time and discharge through the face, in a plane of the slice; s, m³/s.
    #[serde(default)]
    pub discharge: Vec<(f64, f64)>,
    /// Rows of time and depth over the bottom of the box, met to whole rows of particles; that of the box
    /// when left out; s, m.
    #[serde(default)]
    pub depth: Vec<(f64, f64)>,
}

/// A box through which water leaves, keeping its velocity, and the face past which it is taken out. At least a
/// support radius long.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutflowFile {
    /// Unique name.
    pub name: String,
    /// Lower corner, on the bed; m.
    pub min: Triple,
    /// Upper corner; m.
    pub max: Triple,
    /// The side that the water goes to and leaves by.
    pub towards: SideFile,
    /// Rows of time and depth over the bottom of the box, whose pressures are held; as they come when left
    /// out; s, m.
    #[serde(default)]
    pub depth: Vec<(f64, f64)>,
}
