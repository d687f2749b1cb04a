//! Schema of counters of blocks and of reactions between them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Triple;

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
