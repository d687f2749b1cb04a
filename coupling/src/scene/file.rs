//! The scene as it is written, in RON, JSON or YAML: the schema, nothing checked beyond types.
//!
//! Units are SI; angles are in degrees, and a field that is not SI says so in its name. A field of
//! type `Option` has no fixed default: `None` means "riprap chooses", and the choice is written
//! into the run folder's `case.ron`, so that a scene read from there leaves nothing open.
//! The comments here are the scene reference, `docs/reference/scene`, and the JSON schema; a number names its unit twice, in its
//! comment and as `x-unit`, by which quantities such as "25 mm" are converted. A test holds all of that together.

mod attachments;
mod blocks;
mod bulk;
mod conversions;
mod fluid;
mod gauges;
mod handoff;
mod interface;
mod materials;
mod numerics;
mod openings;
mod output;
mod records;
mod shapes;
mod terrain;
mod waves;

use riprap_dda::Vec3;
use riprap_sph::Symmetry;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use attachments::AttachmentFile;
pub use blocks::{
    BlockFile, DeformableFile, DeformableModelFile, HoldFile, JointFacesFile, MotionFile,
    PlacementFile, RotationFile, TurningFile,
};
pub use bulk::{
    GrainRegionFile, GrainSizeFile, GrainsFile, InWaterFile, JointSetFile, RockMassFile,
    SliversFile,
};
pub use fluid::{
    AddedMassFile, DragLawFile, FlowFile, FluidFile, GrainExchangeFile, LatticeFile, RegionFile,
    RegionShapeFile, RegularizationFile, ResolutionFile, RheologyFile,
};
pub use gauges::{ForcesFile, GaugeFile, GaugeKindFile, MapsFile, MassFile, TrajectoriesFile};
pub use handoff::{HandoffFile, HandoffFormat, HandoffLineFile, HandoffTimesFile};
pub use interface::{InterfaceFile, SlipFile, WallMethodFile};
pub use materials::{ElasticFile, JointFile, MaterialFile};
pub use numerics::{
    BlockIntegratorFile, ContactDetectionFile, ContactSolverFile, DensityDiffusionFile,
    DensityFile, KernelFile, NegativePressure, NormalLawFile, NumericsFile, PrecisionFile, Preset,
    RestingFile, RollingLawFile, ShiftingFile, SleepingFile, StateEquationFile, StaticDampingFile,
    StepBoundFile, SteppingFile, ViscosityFile, ViscousStepFile,
};
pub use openings::{AbsorberFile, InflowFile, OutflowFile};
pub use output::{
    BlockField, BlockTableFile, BoxFile, CameraFile, FramesFile, OutputFile, TableFormatFile,
    WaterField, WaterFramesFile,
};
pub use records::{BarrierFile, CounterFile, ReactionFile};
pub use shapes::{PartFile, ShapeFile, SplitFile};
pub use terrain::{
    ExcavationFile, FailureSurfaceFile, GapsFile, HeightsFile, OutlineFile, SlideFile, TerrainFile,
};
pub use waves::{SpectrumFile, WavesFile};

use crate::world::OutOfDomain;

/// A vector or point as written, `(x, y, z)`.
pub type Triple = (f64, f64, f64);

/// A triple as a vector.
pub fn vec3((x, y, z): Triple) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A complete scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// One line that names the experiment.
    pub title: String,
    /// The model, its source, and the known solution.
    #[serde(default)]
    pub description: String,
    /// Acceleration of gravity; m/s².
    #[serde(default = "standard_gravity")]
    #[schemars(extend("x-unit" = "m/s²"))]
    pub gravity: Triple,
    /// The box outside of which nothing is modeled.
    pub domain: DomainFile,
    /// Rock and wall materials, referred to by name.
    #[serde(default)]
    pub materials: Vec<MaterialFile>,
    /// Joint properties between two materials that replace those derived from the two.
    #[serde(default)]
    pub joints: Vec<JointFile>,
    /// Digital terrain model: ground of blocks with the shape `Terrain`.
    #[serde(default)]
    pub terrain: Option<TerrainFile>,
    /// Rock that slides off the terrain; its blocks are added to the list of blocks.
    #[serde(default)]
    pub slides: Vec<SlideFile>,
    /// Rock blocks, walls and wavemakers.
    #[serde(default)]
    pub blocks: Vec<BlockFile>,
    /// Bodies cut into blocks by joint sets; the blocks are added to the list of blocks.
    #[serde(default)]
    pub rock_masses: Vec<RockMassFile>,
    /// Spheres in bulk, added to the list of blocks.
    #[serde(default)]
    pub grains: Vec<GrainsFile>,
    /// Loads, supports and rock bolts on blocks.
    #[serde(default)]
    pub attachments: Vec<AttachmentFile>,
    /// Water; without it no fluid is modeled.
    #[serde(default)]
    pub fluid: Option<FluidFile>,
    /// Layers that absorb waves before they reach the end of the domain.
    #[serde(default)]
    pub absorbers: Vec<AbsorberFile>,
    /// Inflow boundaries.
    #[serde(default)]
    pub inflows: Vec<InflowFile>,
    /// Outflow boundaries.
    #[serde(default)]
    pub outflows: Vec<OutflowFile>,
    /// Coupling of fluid and blocks.
    #[serde(default)]
    pub interface: InterfaceFile,
    /// Numerical schemes and parameters.
    #[serde(default)]
    pub numerics: NumericsFile,
    /// Duration.
    pub time: TimeFile,
    /// Recording instruments, as in a laboratory.
    #[serde(default)]
    pub gauges: Vec<GaugeFile>,
    /// Forces and moments on blocks by source; not recorded when left out.
    #[serde(default)]
    pub forces: Option<ForcesFile>,
    /// Paths of falling blocks: run-out, bounce height, speed and energy; not tracked when left out.
    #[serde(default)]
    pub trajectories: Option<TrajectoriesFile>,
    /// Maps of wave impact; not drawn when left out.
    #[serde(default)]
    pub maps: Option<MapsFile>,
    /// Groups of blocks tracked as one body; those of each slide are added.
    #[serde(default)]
    pub masses: Vec<MassFile>,
    /// Counters of blocks that pass planes or are in boxes.
    #[serde(default)]
    pub counters: Vec<CounterFile>,
    /// Contact forces between two blocks or groups of blocks.
    #[serde(default)]
    pub reactions: Vec<ReactionFile>,
    /// Records of barriers: forces, peaks, passage and clogging.
    #[serde(default)]
    pub barriers: Vec<BarrierFile>,
    /// Hand-off of the water to a solver of the far field; none when left out.
    #[serde(default)]
    pub handoff: Option<HandoffFile>,
    /// Output files and intervals.
    #[serde(default)]
    pub output: OutputFile,
    /// Camera of `riprap render`; fitted to the scene when left out.
    #[serde(default)]
    pub camera: Option<CameraFile>,
}

impl SceneFile {
    /// Files that the scene names, relative to its folder.
    pub fn referenced_files(&self) -> Vec<String> {
        let mut named = self.clone();
        let mut files = Vec::new();
        named.visit_files(|file| files.push(std::mem::take(file)));
        files
    }

    /// Names files again: each gets what `rename` makes of its name.
    pub fn rename_files(&mut self, rename: impl Fn(&str) -> String) {
        self.visit_files(|file| *file = rename(file));
    }

    fn visit_files(&mut self, mut visit: impl FnMut(&mut String)) {
        let shapes = self.blocks.iter_mut().map(|block| &mut block.shape);
        let boundaries = self.rock_masses.iter_mut().map(|mass| &mut mass.boundary);
        for shape in shapes.chain(boundaries) {
            if let ShapeFile::Mesh { file, .. }
            | ShapeFile::Surface { file, .. }
            | ShapeFile::Raster { file, .. } = shape
            {
                visit(file);
            }
        }
        for block in &mut self.blocks {
            if let MotionFile::Table { file }
            | MotionFile::Shaking { file, .. }
            | MotionFile::Path { file, .. } = &mut block.motion
            {
                visit(file);
            }
        }
        for gauge in &mut self.gauges {
            if let GaugeFile::FromFile { file, .. } = gauge {
                visit(file);
            }
        }
        let mut holes = Vec::new();
        if let Some(terrain) = &mut self.terrain {
            for source in &mut terrain.sources {
                visit(&mut source.file);
            }
            let excavations = terrain.excavations.iter_mut();
            holes.extend(excavations.map(|e| (&mut e.outline, &mut e.failure_surface)));
        }
        let slides = self.slides.iter_mut();
        holes.extend(slides.map(|s| (&mut s.outline, &mut s.failure_surface)));
        for (outline, beneath) in holes {
            if let OutlineFile::File(file) = outline {
                visit(file);
            }
            if let FailureSurfaceFile::Raster { file, .. } = beneath {
                visit(file);
            }
        }
    }
}

/// The modeled box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DomainFile {
    /// Lower corner; m.
    #[schemars(extend("x-unit" = "m"))]
    pub min: Triple,
    /// Upper corner; m.
    #[schemars(extend("x-unit" = "m"))]
    pub max: Triple,
    /// Periodic directions of the fluid, with the box as the period. A slab several spacings wide and periodic across
    /// is a 2-D flume at 2-D cost.
    #[serde(default)]
    pub periodic: Vec<Axis>,
    /// Sides that are planes of symmetry: half of a symmetric flow stands for the whole. Water and blocks beyond are
    /// the mirror image of the modeled part; free blocks may not touch such a side.
    #[serde(default)]
    pub symmetry: Vec<SideFile>,
    /// Treatment of a particle or block that leaves.
    #[serde(default)]
    pub leaving: OutOfDomainFile,
    /// Flow in three dimensions or in a vertical plane along x; in the latter nothing depends on y, and masses and
    /// forces are those of a slice as wide as the domain.
    #[serde(default)]
    pub dimensions: DimensionsFile,
}

/// A coordinate direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Axis {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z, up.
    Z,
}

impl Axis {
    /// 0, 1, 2 for x, y, z.
    pub fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}

/// A side of an axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum SideFile {
    /// The side of lowest x.
    XMin,
    /// The side of highest x.
    XMax,
    /// The side of lowest y.
    YMin,
    /// The side of highest y.
    YMax,
    /// The lower side.
    ZMin,
    /// The upper side.
    ZMax,
}

impl SideFile {
    /// The axis across it, 0 to 2, and whether it is the upper side.
    pub fn axis(self) -> (usize, bool) {
        match self {
            Self::XMin => (0, false),
            Self::XMax => (0, true),
            Self::YMin => (1, false),
            Self::YMax => (1, true),
            Self::ZMin => (2, false),
            Self::ZMax => (2, true),
        }
    }
}

/// Planes of symmetry among the sides: lower and upper one of each axis.
pub fn planes_of_symmetry(sides: &[SideFile]) -> Symmetry {
    let mut symmetry = Symmetry::default();
    for side in sides {
        let (axis, is_upper) = side.axis();
        symmetry[axis][usize::from(is_upper)] = true;
    }
    symmetry
}

/// Treatment of a particle or block that leaves the domain, a particle by more than a spacing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum OutOfDomainFile {
    /// It is removed and counted; its mass, momentum and energy are booked as removed.
    #[default]
    #[serde(alias = "Removed")]
    Remove,
    /// The run stops with an error that names it.
    #[serde(alias = "Error")]
    Fail,
}

impl From<OutOfDomainFile> for OutOfDomain {
    fn from(leaving: OutOfDomainFile) -> Self {
        match leaving {
            OutOfDomainFile::Remove => Self::Remove,
            OutOfDomainFile::Fail => Self::Fail,
        }
    }
}

/// Dimensions of the flow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum DimensionsFile {
    /// In a vertical plane.
    Two,
    /// Three-dimensional.
    #[default]
    Three,
}

/// Duration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimeFile {
    /// Simulated time, after settling; s.
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub duration: f64,
    /// Duration before t = 0 in which the water comes to rest: blocks are held, the fluid is damped; s. Excluded from
    /// the records and the energy ledger.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "minimum" = 0))]
    pub settle: f64,
    /// Settling of the free blocks under gravity before t = 0, as of grains behind a gate; they start as drawn when left out. Excluded from
    /// the records and the energy ledger. Of scenes without water.
    #[serde(default)]
    pub settle_blocks: Option<SettlingFile>,
    /// Wall time from the start of the program, before the end of which a run stops with a checkpoint to resume from; s. The
    /// option `--wall-limit` of `riprap run` takes precedence. No limit when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub wall_limit: Option<f64>,
    /// Ends the run before its duration once nothing moves any more; it always takes its duration when left out.
    #[serde(default)]
    pub stop_at_rest: Option<RestFile>,
}

/// Settling of free blocks: from where they are drawn they move until nothing is faster than a speed. Prescribed blocks are held at their
/// places of t = 0, ramps of joints at their first values. Clock, records and accounts start once they lie.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SettlingFile {
    /// Largest speed at rest, of any point of a block, of a sphere of its center; m/s.
    #[schemars(extend("x-unit" = "m/s", "exclusiveMinimum" = 0))]
    pub speed: f64,
    /// Time for which it must hold; s.
    #[serde(default = "tenth")]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub time: f64,
    /// Longest duration, after which a warning tells how fast the fastest block still is; s.
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub at_most: f64,
    /// Fixed blocks that hold the others meanwhile, and are removed at t = 0; `gate_*` stands for all whose names begin with `gate_`.
    #[serde(default)]
    pub gates: Vec<String>,
}

/// Rest that ends a run: no block that can move and no water is faster than a speed. A block that is only about to move, as its joint
/// weakens later, is at rest, too.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RestFile {
    /// Largest speed at rest, of any point of a block, of a sphere of its center; m/s.
    #[schemars(extend("x-unit" = "m/s", "exclusiveMinimum" = 0))]
    pub speed: f64,
    /// Time for which it must hold; s.
    #[serde(default = "one")]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub time: f64,
}

fn standard_gravity() -> Triple {
    (0.0, 0.0, -9.81)
}

fn one() -> f64 {
    1.0
}

fn tenth() -> f64 {
    0.1
}
