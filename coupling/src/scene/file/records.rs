//! Schema of counters of blocks, of reactions between them, and of records of barriers.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{BoxFile, Triple};

/// Counter of the free blocks that pass a plane or are in a box, each by its centroid. `counters.csv` has two columns of each,
/// those that have passed (were there at t = 0 or after any step since) and those inside now; `summary.json` has the first and
/// the last time at which another block passed. A block that leaves the domain stays passed and is not inside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum CounterFile {
    /// Blocks beyond a plane, on the side that its normal points to.
    Plane {
        /// Prefix of its column names.
        name: String,
        /// Point of the plane; m.
        #[schemars(extend("x-unit" = "m"))]
        point: Triple,
        /// Normal, of any length but zero.
        #[schemars(extend("x-unit" = "-"))]
        normal: Triple,
        /// Prefix of the names of the blocks; every free block when empty.
        #[serde(default)]
        blocks: String,
    },
    /// Blocks in a box along the axes, its faces included.
    Box {
        /// Prefix of its column names.
        name: String,
        /// Lower corner; m.
        #[schemars(extend("x-unit" = "m"))]
        min: Triple,
        /// Upper corner; m.
        #[schemars(extend("x-unit" = "m"))]
        max: Triple,
        /// Prefix of the names of the blocks; every free block when empty.
        #[serde(default)]
        blocks: String,
    },
}

impl CounterFile {
    /// Its name.
    pub fn name(&self) -> &str {
        match self {
            Self::Plane { name, .. } | Self::Box { name, .. } => name,
        }
    }

    /// Prefix of the names of its blocks.
    pub fn blocks(&self) -> &str {
        match self {
            Self::Plane { blocks, .. } | Self::Box { blocks, .. } => blocks,
        }
    }
}

/// Contact forces between two sides, each one or several blocks. `reactions.csv` has the sum of the forces of the first side on
/// the second, the number of contacts that bear, and the largest normal force of a single one; `summary.json` has the largest
/// values and their times. All are those of the last step before each row; means over time are those of `forces`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReactionFile {
    /// Prefix of its column names.
    pub name: String,
    /// The two sides, each the name of a block, the beginning of names with an asterisk (`"pebble_*"`), or a material for all blocks
    /// of it. Forces between blocks of both sides cancel in the sum.
    pub between: (String, String),
    /// Direction, of any length but zero, along which the sum has a column of its own; none when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-"))]
    pub direction: Option<Triple>,
}

/// Record of a barrier: a check dam, a row of piles, a pier, a gallery, a breakwater. `barrier_NAME.csv` has the force of contacts and of
/// water on it and on each of its blocks, as means and as the largest of a step, and what passes it; `barrier_NAME.vtp` the largest loads of
/// the cells of its faces; `clogging_NAME.csv` the grains in its openings; `summary.json` arrival, peaks, values at rest and coefficients.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BarrierFile {
    /// Name, a part of the names of its files.
    pub name: String,
    /// Fixed or prescribed blocks that it consists of, each by its name or by the beginning of names with an asterisk (`"pile_*"`).
    pub blocks: Vec<String>,
    /// Direction of the flow toward it, along the bed, of any length but zero.
    #[schemars(extend("x-unit" = "-"))]
    pub flow: Triple,
    /// Point about which moments are taken; m. The middle of the lowest edge on the upstream side when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m"))]
    pub foot: Option<Triple>,
    /// Side of the square cells of its faces; m. Two particle spacings with water, half of the mean diameter of the free blocks without,
    /// when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
    pub cell: Option<f64>,
    /// Length of the reach upstream in which speed and depth of the flow are measured; m. Its height when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
    pub upstream: Option<f64>,
    /// Openings watched for clogging. The gaps between its blocks when left out; `[]`: none.
    #[serde(default)]
    pub openings: Option<Vec<BoxFile>>,
}
