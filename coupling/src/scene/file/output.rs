//! Schema of output files, intervals and camera.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Triple;

/// Output files and intervals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputFile {
    /// Interval of VTK frames; s. A fiftieth of the duration when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub frame_interval: Option<f64>,
    /// Interval of rows in `gauges.csv`; s. A five-hundredth of the duration when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub gauge_interval: Option<f64>,
    /// Interval of rows in `energy.csv`, `blocks.csv` unless it has its own, `masses.csv`, `counters.csv`, `reactions.csv` and those of barriers; s. `gauge_interval` when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
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
    /// Table of the motion of blocks, `blocks.csv`: which blocks, how often, and in which format.
    #[serde(default)]
    pub block_table: BlockTableFile,
    /// Water files that differ from all frames: interval, thinning, box.
    #[serde(default)]
    pub water: WaterFramesFile,
    /// Block files that differ from all frames: interval, box. Walls, which are written once, are always whole.
    #[serde(default)]
    pub blocks: FramesFile,
    /// Contact files that differ from all frames: interval, box.
    #[serde(default)]
    pub contact_frames: FramesFile,
    /// Files of pressures on faces that differ from all frames: interval, box.
    #[serde(default)]
    pub face_frames: FramesFile,
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
            block_table: BlockTableFile::default(),
            water: WaterFramesFile::default(),
            blocks: FramesFile::default(),
            contact_frames: FramesFile::default(),
            face_frames: FramesFile::default(),
        }
    }
}

/// Table of place, motion and forces of blocks that can move, a row per block and time. A hundred rows of 7640 blocks take 340 MB as text and
/// 96 MB as binary numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BlockTableFile {
    /// Names of the blocks; `pile_*` stands for all whose names begin with `pile_`. All that can move when empty.
    #[serde(default)]
    pub blocks: Vec<String>,
    /// Interval of its rows; s. `ledger_interval` when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub interval: Option<f64>,
    /// Format of the file.
    #[serde(default)]
    pub format: TableFormatFile,
}

/// Format of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum TableFormatFile {
    /// `blocks.csv`: text with all digits, names included.
    #[default]
    Csv,
    /// `blocks.npy`: a structured array that `numpy.load` reads. Times and places have all their digits, everything else seven.
    Npy,
}

/// Frames of the water.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WaterFramesFile {
    /// Interval; s. `frame_interval` when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub interval: Option<f64>,
    /// Every nth particle: those with a number (`Id`) that is a multiple of n; –. All particles when left out.
    #[serde(default)]
    #[schemars(extend("minimum" = 1))]
    pub stride: Option<u32>,
    /// Box outside of which no particle is written; m. All particles when left out.
    #[serde(default)]
    pub r#box: Option<BoxFile>,
}

/// Frames of blocks, contacts or pressures on faces.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FramesFile {
    /// Interval; s. `frame_interval` when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub interval: Option<f64>,
    /// Box outside of which nothing is written; m. It has to hold the centroid of a block, the point of a contact or the middle of a
    /// tile of a face. All of them when left out.
    #[serde(default)]
    pub r#box: Option<BoxFile>,
}

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxFile {
    /// Lower corner; m.
    #[schemars(extend("x-unit" = "m"))]
    pub min: Triple,
    /// Upper corner; m.
    #[schemars(extend("x-unit" = "m"))]
    pub max: Triple,
}

/// An array in the water files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
    /// Share of space that water fills between grains of averaged forces.
    Porosity,
}

/// An array in the block files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraFile {
    /// Position; m.
    #[schemars(extend("x-unit" = "m"))]
    pub position: Triple,
    /// Target point; m.
    #[schemars(extend("x-unit" = "m"))]
    pub look_at: Triple,
    /// Horizontal angle of view; degrees.
    #[serde(default = "default_field_of_view")]
    #[schemars(extend("x-unit" = "degrees"))]
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
