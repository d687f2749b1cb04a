//! Blocks made in number: rock masses cut by joints, and spheres in bulk.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{DeformableFile, ShapeFile, Triple, one};

/// A body cut into free blocks, named `name.0001` and so on, by joint sets, one after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RockMassFile {
    /// Unique name.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// The body before it is cut: any shape but a sphere.
    pub boundary: ShapeFile,
    /// The joints; may be left out where the boundary is a mesh, whose shells are blocks.
    #[serde(default)]
    pub joint_sets: Vec<JointSetFile>,
    /// Seed of the random numbers for scatter and persistence.
    #[serde(default)]
    pub seed: u64,
    /// Merges each sliver with the neighbor that shares the largest area with it; slivers are kept when left out.
    #[serde(default)]
    pub merge_slivers: Option<SliversFile>,
    /// Smaller blocks are removed after slivers are merged, and counted; m³.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m³", "minimum" = 0))]
    pub minimum_volume: f64,
    /// More blocks are rejected.
    #[serde(default = "default_maximum_blocks")]
    pub maximum_blocks: u32,
    /// Makes the blocks deformable.
    #[serde(default)]
    pub deformable: Option<DeformableFile>,
    /// Keeps water out of joints too narrow for particles; as for a block.
    #[serde(default)]
    pub sealed: bool,
}

/// Definition of slivers in a rock mass: blocks beyond either limit. The smallest is merged first, until no block
/// with a neighbor is a sliver; a union that is not convex is a block of several parts. The volume is preserved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SliversFile {
    /// Volume below this fraction of the median volume, 0 to 1.
    #[serde(default = "default_volume_share")]
    #[schemars(extend("x-unit" = "-"))]
    pub volume_share: f64,
    /// Length above this multiple of the smallest thickness, at least 2.
    #[serde(default = "default_aspect")]
    #[schemars(extend("x-unit" = "-"))]
    pub aspect: f64,
}

/// Joints of one orientation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointSetFile {
    /// Name of the set, for tables and VTK files; `set 1`, `set 2` and so on when left out.
    #[serde(default)]
    pub name: Option<String>,
    /// Dip, down from the horizontal, 0 to 90; degrees.
    #[schemars(extend("x-unit" = "degrees", "minimum" = 0, "maximum" = 90))]
    pub dip_deg: f64,
    /// Dip direction, clockwise from north (+y); degrees.
    #[schemars(extend("x-unit" = "degrees"))]
    pub dip_direction_deg: f64,
    /// Spacing of the joints; m.
    #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
    pub spacing: f64,
    /// A point on one of the joints; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub origin: Triple,
    /// Probability that a joint cuts a block in its path, 0 to 1.
    #[serde(default = "one")]
    #[schemars(extend("x-unit" = "-", "minimum" = 0, "maximum" = 1))]
    pub persistence: f64,
    /// Standard deviation of the tilt of a joint about each of two axes; tilts beyond three standard deviations are
    /// redrawn; degrees.
    #[serde(default)]
    #[schemars(extend("x-unit" = "degrees", "minimum" = 0))]
    pub scatter_deg: f64,
    /// Largest offset of a joint from its regular position, as a fraction of the spacing, 0 to 0.5.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "minimum" = 0, "maximum" = 0.5))]
    pub spacing_scatter: f64,
}

/// Free spheres, named `name_0001` and so on, on a cubic lattice, placed from below without initial overlap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GrainsFile {
    /// Unique name.
    pub name: String,
    /// Name of their material.
    pub material: String,
    /// Initial region; no sphere extends beyond it.
    pub region: GrainRegionFile,
    /// Smallest and largest diameter, equal for a single size; uniform distribution between them; m.
    #[schemars(extend("x-unit" = "m"))]
    pub diameter: (f64, f64),
    /// Further sizes, mixed at random on one lattice of the largest of all.
    #[serde(default)]
    pub mixed_with: Vec<GrainSizeFile>,
    /// Number of spheres; as many as fit when left out.
    #[serde(default)]
    pub count: Option<u32>,
    /// Spacing of the lattice; the smallest without overlap when left out: the largest diameter times (1 + 2 jitter);
    /// m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub spacing: Option<f64>,
    /// Largest offset of a sphere from its lattice site along each axis, as a fraction of the largest diameter.
    #[serde(default = "default_jitter")]
    #[schemars(extend("x-unit" = "-", "minimum" = 0))]
    pub jitter: f64,
    /// Seed of the random numbers for sizes and positions.
    #[serde(default)]
    pub seed: u64,
    /// Initial velocity; m/s.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m/s"))]
    pub velocity: Triple,
    /// Forces between them and the water.
    #[serde(default)]
    pub in_water: InWaterFile,
}

/// Forces between grains and water.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum InWaterFile {
    /// Resolved for grains of eight spacings and more, averaged for smaller ones.
    #[default]
    Auto,
    /// Water flows around each grain, as around any block.
    Resolved,
    /// Water and grains share space: buoyancy from the averaged pressure, drag by a law, the opposite on the water. For grains of up to
    /// two spacings; `fluid.grains` has the numbers.
    Averaged,
}

/// A size of spheres in a mixture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GrainSizeFile {
    /// Smallest and largest diameter, equal for a single size; uniform distribution between them; m.
    #[schemars(extend("x-unit" = "m"))]
    pub diameter: (f64, f64),
    /// Share of the volume of all spheres, to the nearest sphere; the first size takes what is left.
    #[schemars(extend("x-unit" = "-", "exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub volume_share: f64,
}

/// Initial region of spheres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum GrainRegionFile {
    /// An axis-aligned box.
    Box {
        /// Lower corner; m.
        #[schemars(extend("x-unit" = "m"))]
        min: Triple,
        /// Upper corner; m.
        #[schemars(extend("x-unit" = "m"))]
        max: Triple,
    },
    /// An upright cylinder.
    Cylinder {
        /// Center of its lower end; m.
        #[schemars(extend("x-unit" = "m"))]
        base: Triple,
        /// Radius; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        radius: f64,
        /// Height; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        height: f64,
    },
    /// The inside of a closed shape.
    Inside(ShapeFile),
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
