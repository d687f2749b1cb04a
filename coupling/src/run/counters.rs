//! Counters and costs of a run, for its summary.

use std::collections::BTreeMap;

use riprap_sph::Fluid;
use serde::{Deserialize, Serialize};

use super::blow_up::BlowUpDetector;
use super::step_reduction::StepReduction;
use crate::output::summary::SettledBlocks;
use crate::world::World;
use crate::world::time_step::{Cause, TimeStep};

/// Stage of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Stage {
    /// The water or the blocks come to rest before t = 0.
    Settling {
        /// s.
        time: f64,
        steps: u64,
    },
    Running,
}

/// Counters of a run, preserved when it is stopped and resumed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Counters {
    pub stage: Stage,
    /// Shortest step; s.
    pub dt_min: f64,
    /// Longest step; s.
    pub dt_max: f64,
    /// Steps by the cause that limited them.
    pub governed: BTreeMap<Cause, u64>,
    pub particles_at_start: usize,
    /// kg.
    pub mass_at_start: f64,
    pub detector: BlowUpDetector,
    pub reduction: StepReduction,
    /// Time since which nothing moves; `None` while something does, or where nobody asks; s.
    pub at_rest_since: Option<f64>,
    /// Settling of the blocks, once it has ended.
    pub settled: Option<Settled>,
}

/// Blocks that have settled.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Settled {
    pub found: SettledBlocks,
    /// The world at t = 0, for records that compare with it; empty without records.
    pub world: Vec<u8>,
}

impl Counters {
    /// Counters of a world before its first step.
    pub fn new(world: &World, stage: Stage) -> Self {
        let fluid = world.water.as_ref().map(|water| &water.fluid);
        Self {
            stage,
            dt_min: f64::INFINITY,
            dt_max: 0.0,
            governed: BTreeMap::new(),
            particles_at_start: fluid.map_or(0, |f| f.particles().len()),
            mass_at_start: fluid.map_or(0.0, Fluid::mass),
            detector: BlowUpDetector::default(),
            reduction: StepReduction::default(),
            at_rest_since: None,
            settled: None,
        }
    }

    /// Notes whether anything is faster than a speed (m/s) at a time (s).
    pub fn watch_rest(&mut self, world: &World, speed: f64, time: f64) {
        self.at_rest_since = match is_moving(world, speed) {
            true => None,
            false => self.at_rest_since.or(Some(time)),
        };
    }

    /// Counts a step.
    pub fn count(&mut self, step: TimeStep) {
        self.dt_min = self.dt_min.min(step.dt);
        self.dt_max = self.dt_max.max(step.dt);
        *self.governed.entry(step.cause).or_default() += 1;
    }
}

/// Largest speed of any point of a block, or more, zero of a removed one; m/s. Of a sphere that of its center: one that rolls moves, and one
/// that spins about its only contact is where it is.
pub(super) fn speed_of_block(world: &World, b: usize) -> f64 {
    let blocks = &world.blocks;
    if blocks.is_removed(b) {
        return 0.0;
    }
    let turning = match blocks.sphere_radius(b) {
        Some(_) => 0.0,
        None => blocks.angular_velocity(b).norm() * blocks.radius(b),
    };
    blocks.velocity(b).norm() + turning
}

/// Whether any block that can move or any water is faster than a speed (m/s).
fn is_moving(world: &World, speed: f64) -> bool {
    let moves = |b: usize| speed < speed_of_block(world, b);
    let water = world.water.as_ref();
    let flows = || {
        let fluid = &water?.fluid;
        let mut velocities = fluid.particles().velocity.iter();
        Some(velocities.any(|v| speed * speed < v.norm_squared()))
    };
    (0..world.blocks.n_blocks()).any(moves) || flows() == Some(true)
}

/// Wall times and counts, undone steps included; s.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Costs {
    /// Before this start of the program.
    pub before: f64,
    pub settling: f64,
    pub output: f64,
    pub guards: f64,
    pub checkpoints: f64,
    pub n_checkpoints: u64,
    /// Bytes.
    pub checkpoint_size: u64,
    pub n_resumed: u64,
}
