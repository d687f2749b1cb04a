//! Numbers of a model, for the report in words and for programs.
//!
//! Names are stable and end with their unit; numbers without a unit are counts or ratios.

use riprap_dda::{Motion, Shape};
use riprap_sph::Dimensions;
use serde::Serialize;

use crate::scene::estimate::{Estimate, available};
use crate::scene::resolved::{FluidScene, Scene};
use crate::walls::WallMethod;

/// Numbers of a model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Model {
    /// Simulated time, after settling.
    pub duration_s: f64,
    /// Duration before t = 0 in which the water comes to rest; 0 without water.
    pub settle_s: f64,
    /// 2 or 3.
    pub dimensions: u32,
    /// Lower corner of the domain.
    pub domain_min_m: [f64; 3],
    /// Upper corner of the domain.
    pub domain_max_m: [f64; 3],
    pub blocks: Blocks,
    /// `null` without water.
    pub water: Option<Water>,
}

/// Numbers of blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(super) struct Blocks {
    pub free: usize,
    pub prescribed: usize,
    pub fixed: usize,
    /// Convex parts of all blocks.
    pub convex_parts: usize,
    /// Triangles of surfaces and terrain.
    pub triangles: usize,
}

/// Numbers of the water.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Water {
    pub particles: usize,
    pub spacing_m: f64,
    /// Depth of the deepest region.
    pub depth_m: f64,
    /// Rows of particles in it.
    pub rows_in_depth: f64,
    /// Volume of the regions as drawn.
    pub volume_drawn_m3: f64,
    /// Volume of their particles.
    pub volume_m3: f64,
    pub density_kg_per_m3: f64,
    pub preset: String,
    pub walls: &'static str,
    /// Radius of the kernel.
    pub support_m: f64,
    pub sound_speed_m_per_s: f64,
    /// Speed that the sound speed and stiffnesses follow from.
    pub expected_speed_m_per_s: f64,
    /// Fastest flow, fronts of water that nothing holds at the start included.
    pub fastest_flow_m_per_s: f64,
    /// That over the sound speed.
    pub mach: f64,
}

impl Model {
    pub fn of(scene: &Scene) -> Self {
        Self {
            duration_s: scene.duration,
            settle_s: scene.longest_settling(),
            dimensions: match scene.domain.dimensions {
                Dimensions::Two { .. } => 2,
                Dimensions::Three => 3,
            },
            domain_min_m: scene.domain.min.into(),
            domain_max_m: scene.domain.max.into(),
            blocks: Blocks::of(scene),
            water: scene.fluid.as_ref().map(|fluid| Water::of(fluid, scene)),
        }
    }
}

impl Blocks {
    pub fn of(scene: &Scene) -> Self {
        let count = |test: fn(&Motion) -> bool| {
            let moved = scene.blocks.iter().filter(|block| test(&block.motion));
            moved.count()
        };
        let sum = |of: fn(&Shape) -> usize| scene.blocks.iter().map(|b| of(&b.shape)).sum();
        Self {
            free: count(|motion| matches!(motion, Motion::Free)),
            prescribed: count(|motion| matches!(motion, Motion::Prescribed(_))),
            fixed: count(|motion| matches!(motion, Motion::Fixed)),
            convex_parts: sum(|shape| match shape {
                Shape::Polyhedra(parts) => parts.len(),
                Shape::Sphere { .. } => 1,
                Shape::Surface(_) => 0,
            }),
            triangles: sum(|shape| match shape {
                Shape::Surface(surface) => surface.triangles().len(),
                Shape::Polyhedra(_) | Shape::Sphere { .. } => 0,
            }),
        }
    }
}

impl Water {
    pub fn of(fluid: &FluidScene, scene: &Scene) -> Self {
        let settings = &fluid.settings;
        let amounts = fluid.lattice.amounts.iter();
        Self {
            particles: fluid.lattice.positions.len(),
            spacing_m: fluid.walls.particle_spacing,
            depth_m: fluid.lattice.depth,
            rows_in_depth: fluid.lattice.depth / settings.particle_spacing[2],
            volume_drawn_m3: amounts.clone().map(|amount| amount.drawn).sum(),
            volume_m3: amounts.map(|amount| amount.filled).sum(),
            density_kg_per_m3: settings.reference_density,
            preset: format!("{:?}", fluid.preset),
            walls: match fluid.wall_method {
                WallMethod::Penalty => "penalty",
                WallMethod::Particles => "particles",
                WallMethod::Integral => "integral",
            },
            support_m: settings.support_radius(),
            sound_speed_m_per_s: settings.sound_speed,
            expected_speed_m_per_s: scene.expected_speed,
            fastest_flow_m_per_s: scene.fastest_flow,
            mach: scene.fastest_flow / settings.sound_speed,
        }
    }
}

/// Memory that a run takes at most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Memory {
    pub total_bytes: f64,
    pub program_bytes: f64,
    pub water_bytes: f64,
    pub walls_bytes: f64,
    pub blocks_bytes: f64,
    /// Memory of this machine, or of the control group of this process; `null` if unknown.
    pub available_bytes: Option<u64>,
}

impl Memory {
    pub fn of(scene: &Scene) -> Self {
        let estimate = Estimate::of(scene);
        Self {
            total_bytes: estimate.total(),
            program_bytes: estimate.program,
            water_bytes: estimate.water,
            walls_bytes: estimate.walls,
            blocks_bytes: estimate.blocks,
            available_bytes: available().map(|memory| memory.bytes),
        }
    }
}
