//! Records of a run: instruments, tracked blocks, maps, files and their intervals.

use riprap_dda::Vec3;

pub use crate::scene::file::{BlockField, HandoffFormat, WaterField};
use crate::scene::file::{CameraFile, vec3};

/// Rise of the water that counts as arrival unless a scene says otherwise; × particle spacing.
pub(crate) const NOTICED_RISE: f64 = 0.25;

/// What is written into the frames of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// s.
    pub interval: f64,
    /// Every nth particle, by number; 1 for all else.
    pub stride: u32,
    /// Corners of the box outside of which nothing is written; m.
    pub within: Option<[Vec3; 2]>,
}

impl Sampling {
    /// All of it at an interval (s).
    pub fn every(interval: f64) -> Self {
        Self {
            interval,
            stride: 1,
            within: None,
        }
    }

    /// Whether a place is in the box.
    pub fn holds(&self, x: &Vec3) -> bool {
        self.within
            .is_none_or(|[min, max]| (0..3).all(|k| min[k] <= x[k] && x[k] <= max[k]))
    }
}

/// Output files and intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Interval of VTK frames unless a kind has its own; s.
    pub frame_interval: f64,
    /// Frames of the water.
    pub water: Sampling,
    /// Frames of moving blocks.
    pub blocks: Sampling,
    /// Frames of contacts.
    pub contact_frames: Sampling,
    /// Frames of pressures on faces.
    pub face_frames: Sampling,
    /// Interval of rows in `gauges.csv`; s.
    pub gauge_interval: f64,
    /// Interval of rows in `energy.csv`, `blocks.csv` unless it has its own, `masses.csv`, `counters.csv`, `reactions.csv` and those of barriers; s.
    pub ledger_interval: f64,
    /// Arrays in the water files.
    pub water_fields: Vec<WaterField>,
    /// Arrays in the block files in addition to the numbers of block, group, material and joint set.
    pub block_fields: Vec<BlockField>,
    /// Output of contact points.
    pub contacts: bool,
    /// Output of the water pressure on the faces of blocks.
    pub face_pressures: bool,
}

/// Table of the motion of blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockTable {
    /// Blocks that can move, ascending.
    pub blocks: Vec<usize>,
    /// s.
    pub interval: f64,
    /// Format of its file.
    pub format: TableFormat,
}

/// Format of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableFormat {
    /// Text.
    Csv,
    /// A structured array of NumPy.
    Npy,
}

/// A recording instrument.
#[derive(Clone, Debug, PartialEq)]
pub struct Gauge {
    /// Column name in `gauges.csv`, or the prefix of several.
    pub name: String,
    /// Recorded quantity.
    pub quantity: Quantity,
}

/// A place and a size of pressure readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureGauge {
    /// m.
    pub position: Vec3,
    /// Diameter of the face that readings are means over, 0 for a point; m.
    pub diameter: f64,
    /// Time before a row that readings are means over, 0 for a single one; s.
    pub averaging_time: f64,
}

/// Quantity of a gauge, and its location.
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// Elevation of the free surface at a point in plan view; m.
    SurfaceElevation {
        /// m.
        x: f64,
        /// m.
        y: f64,
    },
    /// Pressure at a point, or of a transducer; Pa.
    Pressure(PressureGauge),
    /// Fluid velocity at a point; m/s.
    Velocity {
        /// m.
        position: Vec3,
    },
    /// Force and moment on a block; N, N m.
    BlockForce {
        /// Number of the block.
        block: usize,
    },
    /// Position, displacement and velocity of a point that moves with a block; m, m, m/s.
    PointMotion {
        /// Number of the block.
        block: usize,
        /// Position of the point at t = 0; m.
        point: Vec3,
    },
    /// Highest wetted point along a line; m.
    RunUp(PlanLine),
    /// Position of the front of the water along a line; m from its start.
    Front(PlanLine),
    /// Volume across a line and mean discharge; m³, m³/s.
    Overtopping(PlanLine),
    /// Number of blocks farther than a distance from their initial position.
    Displaced {
        /// Numbers of the blocks.
        blocks: Vec<usize>,
        /// m.
        farther_than: f64,
    },
}

/// A line in plan view, (x, y); m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanLine {
    /// Start; m.
    pub from: [f64; 2],
    /// End; m.
    pub to: [f64; 2],
}

/// Free blocks that are sampled at an interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracking {
    /// Numbers of the blocks.
    pub blocks: Vec<usize>,
    /// Averaging or sampling interval; s.
    pub interval: f64,
}

/// Maps of wave impact in plan view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Maps {
    /// Spacing of their points; m.
    pub spacing: f64,
    /// Sampling interval; s.
    pub interval: f64,
    /// Change of the surface since t = 0 that counts as arrival; m.
    pub arrival_threshold: f64,
}

/// Free blocks tracked as one body.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedMass {
    /// Prefix of its column names.
    pub name: String,
    /// Numbers of the blocks.
    pub blocks: Vec<usize>,
}

/// Counter of the blocks that are or have been in a region.
#[derive(Clone, Debug, PartialEq)]
pub struct Counter {
    /// Prefix of its column names.
    pub name: String,
    /// Region of the centroids.
    pub region: CountedRegion,
    /// Numbers of the blocks.
    pub blocks: Vec<usize>,
}

/// Region whose blocks are counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CountedRegion {
    /// Half of space beyond a plane.
    Beyond {
        /// m.
        point: Vec3,
        /// Toward the region, of any length.
        normal: Vec3,
    },
    /// Box along the axes.
    Box {
        /// m.
        min: Vec3,
        /// m.
        max: Vec3,
    },
}

impl CountedRegion {
    /// Whether a place is in the region: on its boundary in a box, but not beyond a plane.
    pub fn holds(&self, x: &Vec3) -> bool {
        match self {
            Self::Beyond { point, normal } => 0.0 < normal.dot(&(x - point)),
            Self::Box { min, max } => (0..3).all(|k| min[k] <= x[k] && x[k] <= max[k]),
        }
    }
}

/// Contact forces of the blocks of one side on those of another.
#[derive(Clone, Debug, PartialEq)]
pub struct Reaction {
    /// Prefix of its column names.
    pub name: String,
    /// Numbers of the blocks that act, and of those that are acted on.
    pub between: [Vec<usize>; 2],
    /// Unit vector along which the sum has a column of its own.
    pub direction: Option<Vec3>,
}

/// Blocks recorded as a barrier.
#[derive(Clone, Debug, PartialEq)]
pub struct Barrier {
    /// Part of the names of its files.
    pub name: String,
    /// Numbers of its blocks, ascending.
    pub blocks: Vec<usize>,
    /// Name of each of them.
    pub block_names: Vec<String>,
    /// Unit vectors along the flow, across it, and from the bed up.
    pub axes: [Vec3; 3],
    /// Box around its blocks at the start along these axes; m.
    pub extent: [[f64; 2]; 3],
    /// Point about which moments are taken; m.
    pub foot: Vec3,
    /// Side of the cells of its faces; m.
    pub cell: f64,
    /// Length of the reach upstream; m.
    pub upstream: f64,
    /// Its openings.
    pub openings: Vec<BarrierOpening>,
    /// Mean diameter and mass of the free blocks; `None` without any; m, kg.
    pub grain: Option<[f64; 2]>,
    /// Mass of the free blocks; kg.
    pub released: f64,
    /// Gravity along the flow; `None` where that is not above zero; m/s².
    pub along_flow: Option<f64>,
}

/// Opening of a barrier, by coordinates along its axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarrierOpening {
    /// Sides across the flow; m.
    pub across: [f64; 2],
    /// Floor and top; m.
    pub height: [f64; 2],
}

impl Barrier {
    /// Mean diameter of the free blocks, 0 without any; m.
    pub fn mean_diameter(&self) -> f64 {
        self.grain.map_or(0.0, |[diameter, _]| diameter)
    }

    /// Coordinates of a point along its axes; m.
    pub fn coordinates(&self, x: &Vec3) -> [f64; 3] {
        self.axes.map(|axis| axis.dot(x))
    }

    /// Width across the flow, openings included; m.
    pub fn width(&self) -> f64 {
        self.extent[1][1] - self.extent[1][0]
    }

    /// Height; m.
    pub fn height(&self) -> f64 {
        self.extent[2][1] - self.extent[2][0]
    }
}

/// Hand-off of the water to a solver of the far field.
#[derive(Clone, Debug, PartialEq)]
pub struct Handoff {
    /// Instants.
    pub times: HandoffTimes,
    /// Side of a cell; m.
    pub cell: f64,
    /// Level of rest; m.
    pub level: f64,
    /// Files to write.
    pub formats: Vec<HandoffFormat>,
    /// Names of lines, and where they are.
    pub lines: Vec<(String, PlanLine)>,
}

/// Instants of a hand-off.
#[derive(Clone, Debug, PartialEq)]
pub enum HandoffTimes {
    /// By the power of the blocks and the place of the crest.
    Auto,
    /// In order; s.
    At(Vec<f64>),
}

/// Camera of `riprap render`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Position; m.
    pub position: Vec3,
    /// Target point; m.
    pub look_at: Vec3,
    /// Horizontal angle of view; degrees.
    pub field_of_view_deg: f64,
}

impl From<&CameraFile> for Viewpoint {
    fn from(file: &CameraFile) -> Self {
        Self {
            position: vec3(file.position),
            look_at: vec3(file.look_at),
            field_of_view_deg: file.field_of_view_deg,
        }
    }
}
