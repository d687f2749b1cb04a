//! What is written, and how often; the eye that looks at it.

use serde::{Deserialize, Serialize};

use super::Triple;

/// What is written, and how often.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputFile {
    /// Between VTK frames; s. A fiftieth of the duration when left out.
    #[serde(default)]
    pub frame_interval: Option<f64>,
    /// Between rows of `gauges.csv`; s. A five-hundredth of the duration when left out.
    #[serde(default)]
    pub gauge_interval: Option<f64>,
    /// Between rows of `blocks.csv` and `energy.csv`; s. As `gauge_interval` when left out.
    #[serde(default)]
    pub ledger_interval: Option<f64>,
    /// Arrays of the water files. The first four when left out, all for a fluid with flow laws.
    #[serde(default)]
    pub water_fields: Option<Vec<WaterField>>,
    /// Arrays of the block files besides `BlockId`.
    #[serde(default = "all_block_fields")]
    pub block_fields: Vec<BlockField>,
    /// Whether contact points are written.
    #[serde(default)]
    pub contacts: bool,
    /// Whether the water's pressure on the faces of blocks is written, tile by tile. Thin bodies show both of their sides'
    /// pressure on each.
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

/// An array of the water files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WaterField {
    /// m/s.
    Velocity,
    /// kg/m³.
    Density,
    /// Pa.
    Pressure,
    /// Number of the particle, the same in every frame.
    Id,
    /// Apparent viscosity; Pa s.
    Viscosity,
    /// 1 where the stress is above the yield stress, 0 elsewhere.
    Yielded,
}

/// An array of the block files.
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

/// The eye of `riprap render`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraFile {
    /// Where it stands; m.
    pub position: Triple,
    /// What it looks at; m.
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
