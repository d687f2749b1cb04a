//! A scene that can run.

use riprap_dda::{Attachment, BlockDefinition, Hold, JointOverride, Material};
use riprap_sph::boundary::wall_particles::Slip;
use riprap_sph::{Absorber, Rheology, Sleeping};

use super::error::Problem;
use super::file::SceneFile;
use super::fill::Lattice;
use super::geometry::grains::GrainsReport;
use super::geometry::rock_mass::RockMassReport;
use super::geometry::terrain::Terrain;
use crate::openings::Openings;
use crate::walls::WallMethod;
use crate::walls::penalty::WallSettings;
use crate::world::Weakening;

/// A scene that can run: geometry, initial water and all numbers. Nothing in it changes.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The scene with every choice written out.
    pub file: SceneFile,
    /// Blocks in the order of the file.
    pub blocks: Vec<BlockDefinition>,
    /// The lie of the land.
    pub terrain: Option<Terrain>,
    /// Reports on rock masses and slides, now blocks.
    pub rock_masses: Vec<RockMassReport>,
    /// Reports on grains, now blocks.
    pub grains: Vec<GrainsReport>,
    /// Loads, supports and bolts.
    pub attachments: Vec<Attachment>,
    /// Blocks that are held, by position, and how.
    pub holds: Vec<(usize, Hold)>,
    /// Materials in the order of the file.
    pub materials: Vec<Material>,
    /// Joints between two of them that override the derived properties.
    pub joints: Vec<JointOverride>,
    /// Joints that weaken with time.
    pub weakenings: Vec<Weakening>,
    /// Settings of the block solver.
    pub block_settings: riprap_dda::Settings,
    /// Water, where the scene has some.
    pub fluid: Option<FluidScene>,
    /// Warnings to the user.
    pub warnings: Vec<Problem>,
}

/// Water at the start and its numbers.
#[derive(Clone, Debug)]
pub struct FluidScene {
    /// Particles at the start.
    pub lattice: Lattice,
    /// Settings of the fluid solver.
    pub settings: riprap_sph::Settings,
    /// Penalty walls; without stiffness where particles hold the fluid.
    pub walls: WallSettings,
    /// Wall method.
    pub wall_method: WallMethod,
    /// Whether it slides along them.
    pub slip: Slip,
    /// Pressure of each particle of the lattice at the start; Pa.
    pub pressures: Vec<f64>,
    /// Flow laws, where there are any.
    pub rheologies: Vec<Rheology>,
    /// Number of the flow law of each particle of the lattice.
    pub kinds: Vec<u8>,
    /// Layers that damp waves.
    pub absorbers: Vec<Absorber>,
    /// Inflows and outflows.
    pub openings: Openings,
    /// Criteria of its sleep, if enabled.
    pub sleeping: Option<Sleeping>,
    /// Fastest flow expected, from which sound speed and stiffnesses follow; m/s.
    pub expected_speed: f64,
}
