//! Blocks made in number: rock masses cut by joints, and balls in bulk.

use serde::{Deserialize, Serialize};

use super::{DeformableFile, ShapeFile, Triple, one};

/// A body cut into free blocks, named `name.0001` and on, by joint sets, one after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RockMassFile {
    /// Unique name.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// The body before it is cut: any shape but a ball.
    pub boundary: ShapeFile,
    /// The joints.
    pub joint_sets: Vec<JointSetFile>,
    /// Of the random numbers of scatter and persistence.
    #[serde(default)]
    pub seed: u64,
    /// Joins slivers with the neighbour with which they share the largest area; kept when left out.
    #[serde(default)]
    pub merge_slivers: Option<SliversFile>,
    /// Smaller blocks are left out, after slivers are merged, and counted; m³.
    #[serde(default)]
    pub minimum_volume: f64,
    /// More blocks are refused.
    #[serde(default = "default_maximum_blocks")]
    pub maximum_blocks: u32,
    /// Makes the blocks deformable.
    #[serde(default)]
    pub deformable: Option<DeformableFile>,
    /// No water gets into joints too narrow for particles; as of a block.
    #[serde(default)]
    pub sealed: bool,
}

/// Which blocks of a rock mass are slivers: those that pass either limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SliversFile {
    /// Less than this share of the median volume, 0 to 1.
    #[serde(default = "default_volume_share")]
    pub volume_share: f64,
    /// Longer than this many times their smallest thickness, at least 2.
    #[serde(default = "default_aspect")]
    pub aspect: f64,
}

/// Joints of one orientation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointSetFile {
    /// Dip, down from the horizontal, 0 to 90; degrees.
    pub dip_deg: f64,
    /// Dip direction, clockwise from north (+y); degrees.
    pub dip_direction_deg: f64,
    /// Distance of the joints; m.
    pub spacing: f64,
    /// A point through which one joint passes; m.
    #[serde(default)]
    pub origin: Triple,
    /// Chance that a joint cuts a block which it meets, 0 to 1.
    #[serde(default = "one")]
    pub persistence: f64,
    /// Standard deviation of the tilt of a joint about each of two axes; tilts beyond three of them are
    /// drawn again; degrees.
    #[serde(default)]
    pub scatter_deg: f64,
    /// A joint lies off its place by at most this share of the spacing, 0 to 0.5.
    #[serde(default)]
    pub spacing_scatter: f64,
}

/// Free balls, named `name_0001` and on, on a cubic lattice, filled in from below. None overlap at the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GrainsFile {
    /// Unique name.
    pub name: String,
    /// Name of their material.
    pub material: String,
    /// Where they are at the start; no ball reaches out of it.
    pub region: GrainRegionFile,
    /// Smallest and largest diameter, the same for equal balls; all between are as likely; m.
    pub diameter: (f64, f64),
    /// How many; as many as fit when left out.
    #[serde(default)]
    pub count: Option<u32>,
    /// Distance of the places of the lattice; the closest without overlap when left out: the largest diameter times
    /// (1 + 2 jitter); m.
    #[serde(default)]
    pub spacing: Option<f64>,
    /// Along each axis a ball lies off its place by at most this share of the largest diameter.
    #[serde(default = "default_jitter")]
    pub jitter: f64,
    /// Of the random numbers of sizes and places.
    #[serde(default)]
    pub seed: u64,
    /// Initial velocity; m/s.
    #[serde(default)]
    pub velocity: Triple,
}

/// Where balls are at the start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum GrainRegionFile {
    /// A box along the axes.
    Box {
        /// Lower corner; m.
        min: Triple,
        /// Upper corner; m.
        max: Triple,
    },
    /// An upright cylinder.
    Cylinder {
        /// Middle of its lower end; m.
        base: Triple,
        /// Radius; m.
        radius: f64,
        /// Height; m.
        height: f64,
    },
}

fn default_maximum_blocks() -> u32 {
    20_000
}

fn default_volume_share() -> f64 {
    0.01
}

fn default_aspect() -> f64 {
    20.0
}

fn default_jitter() -> f64 {
    0.02
}
