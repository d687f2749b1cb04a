//! Where a run is: its progress after a step, and `progress.json` in its folder.

use std::time::{Duration, Instant};

use super::{Ending, Place, Progress, Run, RunError};
use crate::output::checkpoint_file::Written;
use crate::output::progress_file::{HeldBy, ProgressFile, State};
use crate::output::summary::{memory, peak_memory};
use crate::world::Holder;
use crate::world::time_step::{Cause, TimeStep};

/// Wall time between two versions of `progress.json`.
const INTERVAL: Duration = Duration::from_secs(1);

/// Last news of a run.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Status {
    /// Progress after the last step.
    pub last: Option<Progress>,
    /// Checkpoint that this start of the program wrote last.
    pub checkpoint: Option<Written>,
    written: Option<Instant>,
}

impl Run<'_> {
    /// Simulated time since the start of the whole run, settling included; s.
    pub(super) fn position(&self) -> f64 {
        let Place {
            is_settling, time, ..
        } = self.place();
        if is_settling {
            time
        } else {
            self.settling() + time
        }
    }

    /// Duration of settling: as it was of blocks that lie, before that at most; s.
    fn settling(&self) -> f64 {
        let settled = self.counters.settled.as_ref();
        settled.map_or_else(
            || self.scene.longest_settling(),
            |settled| settled.found.time,
        )
    }

    pub(super) fn progress(&self, step: TimeStep) -> Progress {
        let world = &self.world;
        let blocks = &world.blocks;
        let fastest_block = (0..blocks.n_blocks())
            .filter(|&b| blocks.is_free(b))
            .map(|b| blocks.velocity(b).norm())
            .fold(0.0, f64::max);
        let fluid = world.water.as_ref().map(|water| &water.fluid);
        let Place {
            is_settling,
            time,
            steps,
        } = self.place();
        let whole = self.settling() + self.scene.duration;
        let position = self.position();
        Progress {
            is_settling,
            steps,
            time,
            end: if is_settling {
                self.settling()
            } else {
                self.scene.duration
            },
            dt: step.dt,
            cause: step.cause,
            contacts: blocks.n_contacts(),
            fastest: fastest_block.max(fluid.map_or(0.0, |fluid| fluid.max_speed())),
            particles: fluid.map_or(0, |fluid| fluid.particles().len()),
            share: (position / whole).min(1.0),
            steps_per_second: self.pace.steps_per_second(),
            left: self.pace.left((whole - position).max(0.0)),
        }
    }

    pub(super) fn write_progress_when_due(&mut self) {
        if self
            .status
            .written
            .is_none_or(|at| INTERVAL <= at.elapsed())
        {
            self.write_progress(None);
        }
    }

    fn held_by(&self, cause: Cause) -> Option<HeldBy> {
        self.world.holder(cause).map(|holder| match holder {
            Holder::Particle(id, at) => HeldBy::Particle {
                id,
                at_m: at.into(),
            },
            Holder::Block(block) => HeldBy::Block(self.scene.block_names[block].clone()),
        })
    }

    /// Writes `progress.json`, unless the run is in memory. It is no result: a run goes on without it where it cannot be written.
    pub(super) fn write_progress(&mut self, ending: Option<&Result<Ending, RunError>>) {
        if self.observers.is_none() {
            return;
        }
        let Place {
            is_settling,
            time,
            steps,
        } = self.place();
        let last = self.status.last;
        let file = ProgressFile {
            state: match ending {
                None => State::Running,
                Some(Ok(Ending::Completed)) => State::Finished,
                Some(Ok(Ending::Interrupted)) => State::Interrupted,
                Some(Ok(Ending::OutOfTime)) => State::WallLimit,
                Some(Err(_)) => State::Failed,
            },
            message: ending.and_then(|ending| ending.as_ref().err().map(RunError::to_string)),
            pid: std::process::id(),
            stage: if is_settling { "settling" } else { "running" },
            step: steps,
            time_s: time,
            settle_s: self.settling(),
            duration_s: self.scene.duration,
            share: (self.position() / (self.settling() + self.scene.duration)).min(1.0),
            dt_s: last.map(|last| last.dt),
            dt_limited_by: last.map(|last| last.cause),
            dt_held_by: last.and_then(|last| self.held_by(last.cause)),
            steps_per_s: last.map(|last| last.steps_per_second),
            eta_s: last.filter(|_| ending.is_none()).and_then(|last| last.left),
            wall_time_s: self.wall_time(),
            particles: last.map_or(self.counters.particles_at_start, |last| last.particles),
            blocks: self.world.blocks.n_blocks(),
            memory_bytes: memory(),
            peak_memory_bytes: peak_memory(),
            checkpoint: self.status.checkpoint,
            checkpoints: self.costs.n_checkpoints,
        };
        let _ = file.write(&self.folder);
        self.status.written = Some(Instant::now());
    }
}
