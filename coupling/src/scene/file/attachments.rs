//! Loads, supports and rock bolts.

use serde::{Deserialize, Serialize};

use super::Triple;

/// A load, support or rock bolt. Points are places at t = 0 and move with their block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum AttachmentFile {
    /// Constant force at a point of a block.
    PointLoad {
        /// Name of the block.
        block: String,
        /// Where; m.
        point: Triple,
        /// N.
        force: Triple,
    },
    /// Constant force per mass on a block, beside gravity.
    BodyLoad {
        /// Name of the block.
        block: String,
        /// m/s².
        acceleration: Triple,
    },
    /// Pressure on the face of a block that looks most in a direction; it follows the face.
    Pressure {
        /// Name of the block.
        block: String,
        /// Outward direction of the face at t = 0.
        face: Triple,
        /// Pushes inward if > 0; Pa.
        pressure: f64,
    },
    /// Spring that holds a point of a block at its place.
    FixedPoint {
        /// Name of the block.
        block: String,
        /// Where; m.
        point: Triple,
        /// N/m.
        stiffness: f64,
    },
    /// Elastic bar that yields, between points of two blocks.
    RockBolt {
        /// Name of the block at one end.
        from: String,
        /// Place of that end; m.
        from_point: Triple,
        /// Name of the block at the other end.
        to: String,
        /// Place of that end; m.
        to_point: Triple,
        /// Young's modulus times section over length; N/m.
        stiffness: f64,
        /// Tension at t = 0; N.
        #[serde(default)]
        pretension: f64,
        /// It takes no more than this; N.
        yield_force: f64,
    },
}
