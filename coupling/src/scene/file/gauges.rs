//! What is recorded: instruments, and the ways of falling blocks.

use serde::{Deserialize, Serialize};

use super::Triple;

/// A recording instrument.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum GaugeFile {
    /// Height of the free surface over a point of the plan; m, NaN when dry.
    SurfaceElevation {
        /// Column name in `gauges.csv`.
        name: String,
        /// m.
        x: f64,
        /// m.
        y: f64,
    },
    /// Pressure at a point; Pa, NaN when dry.
    Pressure {
        /// Column name.
        name: String,
        /// m.
        position: Triple,
    },
    /// Fluid velocity at a point, three columns; m/s, NaN when dry.
    Velocity {
        /// Column name.
        name: String,
        /// m.
        position: Triple,
    },
    /// Force and moment on a block from fluid and from contacts, twelve columns; N, N m about the
    /// centroid.
    BlockForce {
        /// Column name.
        name: String,
        /// Name of the block.
        block: String,
    },
    /// Highest point that water touches above a line of the plan; m, NaN when dry. It is under the outermost particle: still water
    /// reads up to a spacing too low.
    RunUp {
        /// Column name.
        name: String,
        /// Start of the line, (x, y); m.
        from: (f64, f64),
        /// End of the line, (x, y); m.
        to: (f64, f64),
    },
    /// How far along a line of the plan water on the ground has come; m from its start, NaN when dry.
    Front {
        /// Column name.
        name: String,
        /// Start of the line, (x, y); m.
        from: (f64, f64),
        /// End of the line, (x, y); m.
        to: (f64, f64),
    },
    /// Water that passed over a line, to the right of it as one walks from its start to its end: two columns, the net volume since t = 0
    /// (m³) and the mean discharge since the last row (m³/s). What leaves the domain is not seen to pass: keep it well inside. Along a periodic axis its ends go a spacing past the domain.
    Overtopping {
        /// What its columns begin with.
        name: String,
        /// Start of the line, (x, y); m.
        from: (f64, f64),
        /// End of the line, (x, y); m.
        to: (f64, f64),
    },
    /// How many free blocks are farther from where they were at t = 0 than a distance, or have left the domain: damage
    /// of an armour layer.
    Displaced {
        /// Column name.
        name: String,
        /// What the names of the blocks that are looked at begin with; every free block when empty.
        blocks: String,
        /// Distance of the centroid beyond which a block counts, its edge say; m.
        farther_than: f64,
    },
}

/// On which blocks forces and moments are recorded by source: `forces.csv` has a row of means per block and interval,
/// `contacts.csv` one per block, partner and time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForcesFile {
    /// Names of free blocks; every free block when empty.
    #[serde(default)]
    pub blocks: Vec<String>,
    /// Over which forces are means; s. As `output.gauge_interval` when left out.
    #[serde(default)]
    pub interval: Option<f64>,
}

/// Maps over the plan: `maximum_elevation.asc`, `first_arrival.asc`, `inundation_depth.asc` in coordinates of the map, and
/// `maps.vtp` on the ground.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapsFile {
    /// Distance of their points; two particle spacings when left out; m.
    #[serde(default)]
    pub spacing: Option<f64>,
    /// Between two looks at the water; extremes are those of the looks; s. A two-hundredth of the duration when left out.
    #[serde(default)]
    pub interval: Option<f64>,
    /// Water has come where its surface differs from that at t = 0 by more than this, and where dry land is wet; a quarter of a particle
    /// spacing when left out; m.
    #[serde(default)]
    pub arrival_threshold: Option<f64>,
}

/// Blocks that are followed as one body: where it is, how fast, what of it is under water. `masses.csv` has a row per time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MassFile {
    /// What its columns begin with.
    pub name: String,
    /// What the names of its free blocks begin with.
    pub blocks: String,
}

/// Which blocks are followed on their way: `trajectories.csv` has a row per block and time, `rockfall.csv`
/// one per block.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrajectoriesFile {
    /// Names of free blocks; every free block when empty.
    #[serde(default)]
    pub blocks: Vec<String>,
    /// Between two looks at a block; extremes are those of the looks; s. A thousandth of the duration when
    /// left out.
    #[serde(default)]
    pub interval: Option<f64>,
}
