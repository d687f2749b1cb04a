//! Progress of a run: clock, counts, extremes and wall time by phase.

use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::world::ledger::Ledger;

/// Everything that a step counts, beside the state of the media.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Progress {
    pub clock: Clock,
    pub ledger: Ledger,
    pub held: Held,
    pub extremes: Extremes,
    pub phases: PhaseTimes,
}

/// Time and steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    /// Simulated time; s.
    pub time: f64,
    /// Steps taken.
    pub steps: u64,
    /// Steps of the blocks inside them.
    pub block_substeps: u64,
    /// Size of the last step; s.
    pub last_dt: Option<f64>,
}

impl Clock {
    /// Advances the time by a step of `dt` (s).
    pub(crate) fn tick(&mut self, dt: f64, block_substeps: u32) {
        self.time += dt;
        self.steps += 1;
        self.block_substeps += u64::from(block_substeps);
        self.last_dt = Some(dt);
    }
}

/// Blocks that are held in place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Held {
    /// No block, during a run.
    #[default]
    NoBlock,
    /// All: the water settles.
    AllBlocks,
    /// Those on prescribed paths: the others settle.
    Paths,
}

/// Running extremes and counts of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Extremes {
    /// Largest particle speed over sound speed.
    pub max_mach: f64,
    /// Deepest particle inside a solid, over the spacing.
    pub max_wall_penetration_over_spacing: f64,
    /// Particles found inside a solid and pushed back, or stopped on their path through one or into too narrow an opening.
    pub particles_pushed_back: u64,
    /// Times that a particle crushed at a surface was relieved.
    pub reliefs: u64,
    /// Blocks that left the domain.
    pub blocks_removed: u64,
    /// Ordered neighbor pairs summed over all steps.
    pub pair_interactions: u64,
    /// Products of implicit viscous steps, summed over all steps.
    pub viscous_products: u64,
    /// Particles that sums were made for, summed over all steps.
    pub particle_steps: u64,
    /// Particles that were awake, summed over all steps.
    pub particle_steps_awake: u64,
    /// All particles, summed over all steps.
    pub particle_steps_of_all: u64,
}

/// Wall time by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseTimes {
    /// Sorting and neighbor search.
    pub neighbors: Duration,
    /// Densities and pressures.
    pub density: Duration,
    /// Pair forces in the fluid.
    pub forces: Duration,
    /// Blocks: which pairs may touch.
    pub broad_phase: Duration,
    /// Blocks: narrow phase with the contact law, which share a loop, and the sums for each block.
    pub contacts: Duration,
    /// Placement of walls, and search of particles near them.
    pub wall_search: Duration,
    /// Sums and forces between particles and blocks.
    pub coupling: Duration,
    /// Kicks and drifts of both media, step limits.
    pub integration: Duration,
}

/// Laps of wall time.
#[derive(Debug)]
pub(crate) struct Stopwatch(Instant);

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Self(Instant::now())
    }

    pub(crate) fn lap(&mut self) -> Duration {
        let now = Instant::now();
        let lap = now - self.0;
        self.0 = now;
        lap
    }
}
