//! Schema of recording instruments and tracked blocks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Triple;

/// A recording instrument.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum GaugeFile {
    /// Elevation of the free surface of the connected water at a point in plan view, spray above it left out; m, NaN when dry.
    SurfaceElevation {
        /// Column name in `gauges.csv`.
        name: String,
        /// Position along x, in plan view; m.
        #[schemars(extend("x-unit" = "m"))]
        x: f64,
        /// Position along y, in plan view; m.
        #[schemars(extend("x-unit" = "m"))]
        y: f64,
    },
    /// Pressure at a point, or as a transducer measures it: the mean over a disc that faces away from the nearest wall (upward
    /// in open water), over the time before each row. Dry parts of a disc and of a while count as 0; Pa, NaN when all are dry.
    Pressure {
        /// Column name.
        name: String,
        /// Position; m.
        #[schemars(extend("x-unit" = "m"))]
        position: Triple,
        /// Diameter of the disc, ≥ 0; m.
        #[serde(default)]
        #[schemars(extend("x-unit" = "m"))]
        diameter: f64,
        /// Averaging time, ≥ 0; s.
        #[serde(default)]
        #[schemars(extend("x-unit" = "s"))]
        averaging_time: f64,
    },
    /// Fluid velocity at a point, three columns; m/s, NaN when dry.
    Velocity {
        /// Column name.
        name: String,
        /// Position; m.
        #[schemars(extend("x-unit" = "m"))]
        position: Triple,
    },
    /// Force and moment on a block from fluid and from contacts, twelve columns, each the mean since the last row; N, N m
    /// about the centroid.
    BlockForce {
        /// Column name.
        name: String,
        /// Name of the block.
        block: String,
    },
    /// Motion of a point of a block, nine columns: position and displacement since t = 0 (m), velocity (m/s). NaN once the
    /// block has left the domain.
    PointMotion {
        /// Prefix of its column names.
        name: String,
        /// Name of the block.
        block: String,
        /// Position at t = 0; it moves with the block; m.
        #[schemars(extend("x-unit" = "m"))]
        point: Triple,
    },
    /// Highest wetted point along a line in plan view, on ground or up a wall, single drops left out; m, NaN when dry. Water
    /// at rest at t = 0 reads its level.
    RunUp {
        /// Column name.
        name: String,
        /// Start of the line, (x, y); m.
        #[schemars(extend("x-unit" = "m"))]
        from: (f64, f64),
        /// End of the line, (x, y); m.
        #[schemars(extend("x-unit" = "m"))]
        to: (f64, f64),
    },
    /// Position of the front of the water on the ground along a line in plan view; m from its start, NaN when dry.
    Front {
        /// Column name.
        name: String,
        /// Start of the line, (x, y); m.
        #[schemars(extend("x-unit" = "m"))]
        from: (f64, f64),
        /// End of the line, (x, y); m.
        #[schemars(extend("x-unit" = "m"))]
        to: (f64, f64),
    },
    /// Water that has crossed a line, positive to the right of the direction from start to end: two columns, the net
    /// volume since t = 0 (m³) and the mean discharge since the last row (m³/s). Water that leaves the domain is not
    /// counted: keep the line well inside.
    Overtopping {
        /// Prefix of its column names.
        name: String,
        /// Start of the line, (x, y); m.
        #[schemars(extend("x-unit" = "m"))]
        from: (f64, f64),
        /// End of the line, (x, y); m.
        #[schemars(extend("x-unit" = "m"))]
        to: (f64, f64),
    },
    /// Number of free blocks farther than a distance from their position at t = 0, or outside of the domain: damage
    /// of an armor layer.
    Displaced {
        /// Column name.
        name: String,
        /// Prefix of the names of the blocks; every free block when empty.
        blocks: String,
        /// Distance of the centroid beyond which a block is displaced, such as its edge; m.
        #[schemars(extend("x-unit" = "m"))]
        farther_than: f64,
    },
    /// A gauge in map coordinates, `OnMap(SurfaceElevation(name: "quay", x: 412100, y: 6904200))`; m.
    OnMap(Box<GaugeFile>),
    /// A gauge at each point, or along each line, of a file in map coordinates; called as the file calls it, or after the file
    /// with a number.
    FromFile {
        /// Path, relative to the scene file: .geojson, .shp, or points with columns name, x, y and z (.csv, .txt).
        file: String,
        /// Kind of the gauges.
        kind: GaugeKindFile,
    },
}

/// Kind of the gauges of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum GaugeKindFile {
    /// At points.
    SurfaceElevation,
    /// At points with an elevation.
    Pressure,
    /// At points with an elevation.
    Velocity,
    /// Along lines of two points.
    RunUp,
    /// Along lines of two points.
    Front,
    /// Across lines of two points.
    Overtopping,
}

/// Blocks for which forces and moments are recorded by source: `forces.csv` has a row of means per block and
/// interval, `contacts.csv` one per block, partner and time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ForcesFile {
    /// Names of blocks, free, fixed or with prescribed motion; every free block when empty.
    #[serde(default)]
    pub blocks: Vec<String>,
    /// Averaging interval of the forces; s. `output.gauge_interval` when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub interval: Option<f64>,
}

/// Maps in plan view: `maximum_elevation.asc`, `first_arrival.asc`, `inundation_depth.asc` in map coordinates, each
/// also as GeoTIFF (`.tif`) and with the map's `.prj`, and `maps.vtp` on the ground.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MapsFile {
    /// Spacing of their points; two particle spacings when left out; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
    pub spacing: Option<f64>,
    /// Sampling interval; extremes are those of the samples; s. A two-hundredth of the duration when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub interval: Option<f64>,
    /// Change of the surface, or depth on dry land, that counts as arrival: beyond all that the still water at the same
    /// place did before a wave could have come; a quarter of a particle spacing when left out; m.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
    pub arrival_threshold: Option<f64>,
}

/// Blocks tracked as one body: its position, speed and submerged volume. `masses.csv` has a row per time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MassFile {
    /// Prefix of its column names.
    pub name: String,
    /// Prefix of the names of its free blocks.
    pub blocks: String,
}

/// Blocks whose paths are recorded: `trajectories.csv` has a row per block and time, `rockfall.csv` one per block.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrajectoriesFile {
    /// Names of free blocks; every free block when empty.
    #[serde(default)]
    pub blocks: Vec<String>,
    /// Sampling interval; extremes are those of the samples; s. A thousandth of the duration when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub interval: Option<f64>,
}
