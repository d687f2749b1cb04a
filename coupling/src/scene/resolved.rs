//! A scene that can run: geometry, initial water, and every number chosen.

pub mod recording;
pub mod register;

use std::ops::Range;

use riprap_dda::{Attachment, BlockDefinition, Hold, JointOverride, Material, Vec3};
use riprap_sph::boundary::wall_particles::Slip;
use riprap_sph::{Absorber, Dimensions, Preset, Rheology, Sleeping, Symmetry};

use super::error::Problem;
pub use super::file::{Axis, SideFile as Side};
use super::file::{SceneFile, planes_of_symmetry};
use super::fill::Lattice;
use super::geometry::grains::GrainsReport;
use super::geometry::mesh::{Deviation, Survey};
use super::geometry::rock_mass::RockMassReport;
use super::geometry::terrain::Terrain;
use super::wave_maker::WaveMaker;
use crate::grains;
use crate::openings::Openings;
use crate::walls::WallMethod;
use crate::walls::penalty::WallSettings;
use crate::world::{OutOfDomain, Weakening};
use recording::{
    Barrier, BlockTable, Counter, Gauge, Handoff, Maps, Output, Reaction, TrackedMass, Tracking,
};
use register::Register;

/// Settling of free blocks before t = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Settling {
    /// Largest speed at rest; m/s.
    pub speed: f64,
    /// Time for which it must hold; s.
    pub time: f64,
    /// Longest duration; s.
    pub at_most: f64,
    /// Fixed blocks that are removed at t = 0, ascending.
    pub gates: Vec<usize>,
}

/// A scene that can run; constant during the run.
#[derive(Clone, Debug)]
pub struct Scene {
    /// One line that names the experiment.
    pub title: String,
    /// Acceleration of gravity; m/s².
    pub gravity: Vec3,
    /// Modeled box.
    pub domain: Domain,
    /// Simulated time, after settling; s.
    pub duration: f64,
    /// Duration before t = 0 in which the water comes to rest; s.
    pub settle: f64,
    /// Settling of the free blocks before t = 0.
    pub settle_blocks: Option<Settling>,
    /// Wall time that a run may take; s.
    pub wall_limit: Option<f64>,
    /// Speed below which nothing moves (m/s), and the time for which it must hold (s), to end the run; `None`: it takes its duration.
    pub stop_at_rest: Option<[f64; 2]>,
    /// Fastest motion expected, from which sound speed and stiffnesses follow; m/s.
    pub expected_speed: f64,
    /// Fastest motion expected, fronts of water that nothing holds at the start included; m/s.
    pub fastest_flow: f64,
    /// Blocks in the order of the file; those of rock masses, slides and grains follow.
    pub blocks: Vec<BlockDefinition>,
    /// Name of each block.
    pub block_names: Vec<String>,
    /// Groups, materials and joint sets of the blocks by name.
    pub register: Register,
    /// Sealing of the narrow joints of each block against water.
    pub is_sealed: Vec<bool>,
    /// Mesh files among the shapes of blocks.
    pub meshes: Vec<MeshSource>,
    /// Digital terrain model.
    pub terrain: Option<Terrain>,
    /// Reports of rock masses and slides, whose blocks are in `blocks`.
    pub rock_masses: Vec<RockMassReport>,
    /// Reports of grains, whose spheres are in `blocks`.
    pub grains: Vec<GrainsReport>,
    /// Their blocks, list by list, and whether water flows around them.
    pub grain_lists: Vec<GrainList>,
    /// Pistons among the blocks that make waves.
    pub wave_makers: Vec<WaveMaker>,
    /// Loads, supports and bolts.
    pub attachments: Vec<Attachment>,
    /// Constraints of blocks, by number.
    pub holds: Vec<(usize, Hold)>,
    /// Materials in the order of the file.
    pub materials: Vec<Material>,
    /// Joint properties between two materials that replace those derived from the two.
    pub joints: Vec<JointOverride>,
    /// Joints that weaken with time.
    pub weakenings: Vec<Weakening>,
    /// Settings of the block solver.
    pub block_settings: riprap_dda::Settings,
    /// Water, if the scene has any.
    pub fluid: Option<FluidScene>,
    /// Files and intervals.
    pub output: Output,
    /// Table of the motion of blocks.
    pub block_table: BlockTable,
    /// Recording instruments.
    pub gauges: Vec<Gauge>,
    /// Blocks for which forces are recorded by source; `None`: not recorded.
    pub forces: Option<Tracking>,
    /// Blocks whose paths are recorded; `None`: not recorded.
    pub trajectories: Option<Tracking>,
    /// Maps of wave impact; `None`: not drawn.
    pub maps: Option<Maps>,
    /// Groups of blocks tracked as one body.
    pub masses: Vec<TrackedMass>,
    /// Counters of blocks in regions.
    pub counters: Vec<Counter>,
    /// Contact forces between sides of blocks.
    pub reactions: Vec<Reaction>,
    /// Barriers with records of their own.
    pub barriers: Vec<Barrier>,
    /// Hand-off of the water; `None`: not in the run.
    pub handoff: Option<Handoff>,
    /// Doubtful points that do not stop the scene.
    pub warnings: Vec<Problem>,
    /// Blocks of rock masses, slides and grains; `None` without.
    pub made: Option<Made>,
    /// The scene as written, with rock masses, slides and grains as they are.
    pub(super) source: SceneFile,
}

impl Scene {
    /// Longest time before t = 0 in which water or blocks come to rest; s.
    pub fn longest_settling(&self) -> f64 {
        match (&self.settle_blocks, &self.fluid) {
            (Some(settling), _) => settling.at_most,
            (None, Some(_)) => self.settle,
            (None, None) => 0.0,
        }
    }

    /// Frees the initial particles, once a world holds them.
    pub fn release_start(&mut self) {
        if let Some(fluid) = &mut self.fluid {
            let lattice = &mut fluid.lattice;
            (lattice.positions, lattice.velocities) = (Vec::new(), Vec::new());
            (lattice.region, lattice.mould) = (Vec::new(), Vec::new());
            (fluid.pressures, fluid.kinds) = (Vec::new(), Vec::new());
        }
    }
}

/// Blocks that a scene does not list one by one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Made {
    /// Their number.
    pub n_blocks: usize,
    /// BLAKE3 of all blocks of the scene: equal hashes are equal blocks, to the bit.
    pub hash: String,
}

/// Modeled box.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    /// Lower corner; m.
    pub min: Vec3,
    /// Upper corner; m.
    pub max: Vec3,
    /// Periodic directions of the fluid.
    pub periodic: Vec<Axis>,
    /// Sides that are planes of symmetry.
    pub symmetry: Vec<Side>,
    /// Treatment of a particle or block that leaves.
    pub out_of_domain: OutOfDomain,
    /// Dimensions of the flow.
    pub dimensions: Dimensions,
}

impl Domain {
    /// Periodicity of each axis.
    pub fn periodic_axes(&self) -> [bool; 3] {
        [Axis::X, Axis::Y, Axis::Z].map(|axis| self.periodic.contains(&axis))
    }

    /// For each axis, whether its lower and its upper side are planes of symmetry.
    pub fn symmetry_planes(&self) -> Symmetry {
        planes_of_symmetry(&self.symmetry)
    }
}

/// Mesh file of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshSource {
    /// Number of the block.
    pub block: usize,
    /// Path, relative to the scene file.
    pub file: String,
    /// The drawing, as it is found in the file.
    pub survey: Survey,
    /// Errors of its convex parts; `None` if all shells are convex.
    pub deviation: Option<Deviation>,
}

/// Initial water, its walls and openings, and the settings of the fluid solver.
#[derive(Clone, Debug)]
pub struct FluidScene {
    /// Preset whose parameters apply where the scene has none.
    pub preset: Preset,
    /// Initial bodies of water, in the order of the file.
    pub regions: Vec<Region>,
    /// Initial particles.
    pub lattice: Lattice,
    /// Settings of the fluid solver.
    pub settings: riprap_sph::Settings,
    /// Ratio of smoothing length to particle spacing; –.
    pub smoothing_length_ratio: f64,
    /// Penalty springs of walls; without stiffness for walls of particles.
    pub walls: WallSettings,
    /// Wall method.
    pub wall_method: WallMethod,
    /// Slip along walls.
    pub slip: Slip,
    /// Choice between explicit and implicit viscous steps.
    pub viscous_steps: ViscousSteps,
    /// Molecular kinematic viscosity of the fluid, which that of the scheme may exceed; m²/s.
    pub molecular_viscosity: f64,
    /// Initial pressure of each particle of the lattice; Pa.
    pub pressures: Vec<f64>,
    /// Flow laws; none for water.
    pub rheologies: Vec<Rheology>,
    /// Number of the flow law of each particle of the lattice.
    pub kinds: Vec<u8>,
    /// Layers that absorb waves.
    pub absorbers: Vec<Absorber>,
    /// Inflows and outflows.
    pub openings: Openings,
    /// Sleep of water at rest; `None`: all water is computed.
    pub sleeping: Option<Sleeping>,
    /// Grains whose forces with the water are averages; `None`: water flows around all blocks.
    pub averaged: Option<Averaged>,
}

impl FluidScene {
    /// Blocks that water flows through, ascending.
    pub fn averaged_blocks(&self) -> &[usize] {
        self.averaged
            .as_ref()
            .map_or(&[], |averaged| &averaged.blocks)
    }
}

/// Grains whose forces with the water are averages.
#[derive(Clone, Debug, PartialEq)]
pub struct Averaged {
    /// Their blocks, ascending.
    pub blocks: Vec<usize>,
    /// Numbers of the exchange.
    pub settings: grains::Settings,
}

/// A list of grains as blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct GrainList {
    /// Its number in the file.
    pub index: usize,
    /// Its name.
    pub name: String,
    /// Its blocks.
    pub blocks: Range<usize>,
    /// Smallest and largest diameter; m.
    pub diameters: [f64; 2],
    /// kg/m³.
    pub density: f64,
    /// Whether its forces with the water are averages.
    pub is_averaged: bool,
}

/// Reasons of the choice between explicit and implicit viscous steps.
#[derive(Clone, Debug, PartialEq)]
pub struct ViscousSteps {
    /// Step limit of sound over that of viscosity in explicit steps, both at rest; –.
    pub ratio: f64,
    /// Largest apparent viscosity at rest; Pa s.
    pub viscosity: f64,
    /// Whether the scene gives it.
    pub is_given: bool,
    /// Reason why implicit steps, though worthwhile or asked for, cannot be taken.
    pub refused: Option<String>,
}

/// An initial body of water.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Name.
    pub name: String,
    /// Still-water level, of a box its top; m.
    pub level: f64,
    /// Wet point of a basin filled below a level; a box has none; m.
    pub seed: Option<Vec3>,
}
