//! Loads, supports and rock bolts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Triple;

/// A load, support or rock bolt. Points are positions at t = 0, before any settling, and move with their block.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum AttachmentFile {
    /// Constant force at a point of a block.
    PointLoad {
        /// Name of the block.
        block: String,
        /// Point of application; m.
        #[schemars(extend("x-unit" = "m"))]
        point: Triple,
        /// Force; N.
        #[schemars(extend("x-unit" = "N"))]
        force: Triple,
    },
    /// Constant force per mass on a block, in addition to gravity.
    BodyLoad {
        /// Name of the block.
        block: String,
        /// Acceleration; m/s².
        #[schemars(extend("x-unit" = "m/s²"))]
        acceleration: Triple,
    },
    /// Pressure on the face of a block whose normal is closest to a direction; it follows the face.
    Pressure {
        /// Name of the block.
        block: String,
        /// Outward direction of the face at t = 0.
        #[schemars(extend("x-unit" = "-"))]
        face: Triple,
        /// Positive inward; Pa.
        #[schemars(extend("x-unit" = "Pa"))]
        pressure: f64,
    },
    /// Spring that holds a point of a block in position.
    FixedPoint {
        /// Name of the block.
        block: String,
        /// Position; m.
        #[schemars(extend("x-unit" = "m"))]
        point: Triple,
        /// Stiffness; N/m.
        #[schemars(extend("x-unit" = "N/m", "exclusiveMinimum" = 0))]
        stiffness: f64,
    },
    /// Elastic-plastic bar between points of two blocks.
    RockBolt {
        /// Name of the block at one end.
        from: String,
        /// Position of that end; m.
        #[schemars(extend("x-unit" = "m"))]
        from_point: Triple,
        /// Name of the block at the other end.
        to: String,
        /// Position of that end; m.
        #[schemars(extend("x-unit" = "m"))]
        to_point: Triple,
        /// Young's modulus times cross section over length; N/m.
        #[schemars(extend("x-unit" = "N/m", "exclusiveMinimum" = 0))]
        stiffness: f64,
        /// Tension at t = 0; N.
        #[serde(default)]
        #[schemars(extend("x-unit" = "N"))]
        pretension: f64,
        /// Yield force, the largest tension; N.
        #[schemars(extend("x-unit" = "N", "exclusiveMinimum" = 0))]
        yield_force: f64,
    },
    /// Point of a free block that stays where it is at t = 0, while the block turns about it: exact, with contact dynamics.
    HeldPoint {
        /// Name of the block.
        block: String,
        /// Position; m.
        #[schemars(extend("x-unit" = "m"))]
        point: Triple,
    },
    /// Point that two blocks have in common, about which they turn: exact, with contact dynamics.
    BallJoint {
        /// Name of one block.
        from: String,
        /// Name of the other block, which may be fixed or prescribed.
        to: String,
        /// Position at t = 0; m.
        #[schemars(extend("x-unit" = "m"))]
        point: Triple,
    },
    /// Rigid bar without mass between points of two blocks, as long as they are apart at t = 0: exact, with contact dynamics.
    Rod {
        /// Name of the block at one end.
        from: String,
        /// Position of that end at t = 0; m.
        #[schemars(extend("x-unit" = "m"))]
        from_point: Triple,
        /// Name of the block at the other end, which may be fixed or prescribed.
        to: String,
        /// Position of that end at t = 0; m.
        #[schemars(extend("x-unit" = "m"))]
        to_point: Triple,
        /// Largest force in tension and compression, at which it breaks for good; N. None when left out.
        #[serde(default)]
        #[schemars(extend("x-unit" = "N", "exclusiveMinimum" = 0))]
        strength: Option<f64>,
    },
}

impl AttachmentFile {
    /// Names of its blocks, one or two.
    pub fn blocks(&self) -> Vec<&str> {
        match self {
            Self::PointLoad { block, .. }
            | Self::BodyLoad { block, .. }
            | Self::Pressure { block, .. }
            | Self::FixedPoint { block, .. }
            | Self::HeldPoint { block, .. } => vec![block],
            Self::RockBolt { from, to, .. }
            | Self::BallJoint { from, to, .. }
            | Self::Rod { from, to, .. } => vec![from, to],
        }
    }
}
