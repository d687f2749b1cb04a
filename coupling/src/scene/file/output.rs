//! Schema of output files, intervals and camera.

use serde::{Deserialize, Serialize};

use super::Triple;

/// Output files and intervals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputFile {
    /// Interval of VTK frames; s. A fiftieth of the duration when left out.
    #[serde(default)]
    pub frame_interval: Option<f64>,
    /// Interval of rows in `gauges.csv`; s. A five-hundredth of the duration when left out.
    #[serde(default)]
    pub gauge_interval: Option<f64>,
    /// Interval of rows in `blocks.csv` and `energy.csv`; s. `gauge_interval` when left out.
    #[serde(default)]
    pub ledger_interval: Option<f64>,
    /// Arrays in the water files. The first four when left out, all for a fluid with flow laws.
    #[serde(default)]
    pub water_fields: Option<Vec<WaterField>>,
    /// Arrays in the block files in addition to the numbers of block, group, material and joint set.
    #[serde(default = "all_block_fields")]
    pub block_fields: Vec<BlockField>,
    /// Output of contact points.
    #[serde(default)]
    pub contacts: bool,
    /// Output of the water pressure on the faces of blocks, tile by tile. Thin bodies show the pressure of both of
    /// their sides on each.
    #[serde(default)]
    pub face_pressures: bool,
}

impl Default for OutputFile {
    fn default() -> Self {
        Self {
            frame_interval: None,
            gauge_interval: None,
            ledger_interval: None,
            water_fields: None,
            block_fields: all_block_fields(),
            contacts: false,
            face_pressures: false,
        }
    }
}

/// An array in the water files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WaterField {
    /// m/s.
    Velocity,
    /// kg/m³.
    Density,
    /// Pa.
    Pressure,
    /// Particle number, the same in every frame.
    Id,
    /// Apparent viscosity; Pa s.
    Viscosity,
    /// 1 where the stress is above the yield stress, 0 elsewhere.
    Yielded,
}

/// An array in the block files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum BlockField {
    /// Of the centroid; m/s.
    Velocity,
    /// rad/s.
    AngularVelocity,
    /// From the water; N.
    ForceFluid,
    /// From other blocks; N.
    ForceContact,
}

/// Camera of `riprap render`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraFile {
    /// Position; m.
    pub position: Triple,
    /// Target point; m.
    pub look_at: Triple,
    /// Horizontal angle of view; degrees.
    #[serde(default = "default_field_of_view")]
    pub field_of_view_deg: f64,
}

fn all_block_fields() -> Vec<BlockField> {
    vec![
        BlockField::Velocity,
        BlockField::AngularVelocity,
        BlockField::ForceFluid,
        BlockField::ForceContact,
    ]
}

fn default_field_of_view() -> f64 {
    40.0
}
