//! Observers: they sample the world when due and write files; they never change it.

pub(crate) mod arrays;
mod background;
pub mod barriers;
mod block_force;
pub mod counters;
mod crossing;
mod face_pressures;
pub mod forces;
pub mod frames;
pub mod gauges;
mod labels;
pub mod ledgers;
pub mod maps;
pub mod masses;
pub mod motions;
mod point_motion;
pub mod reactions;
pub mod trajectories;
mod transducer;

use crate::files::table::{Cell, TableError};
use crate::files::vtk::VtkError;
use crate::messages::{Code, Coded, of_writing};
use crate::saved::Saved;
use crate::world::World;
use serde::{Deserialize, Serialize};

/// Failure of an observer.
#[derive(Debug, thiserror::Error)]
pub enum ObserveError {
    /// A VTK file or collection.
    #[error(transparent)]
    Vtk(#[from] VtkError),
    /// A CSV table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Invalid state of an observer in a checkpoint.
    #[error("the checkpoint does not match the observers of this run: {0}")]
    State(#[from] postcard::Error),
    /// Any other file.
    #[error("cannot write {path}: {source}; free some space or choose another folder with -o")]
    Write {
        /// The file.
        path: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

/// Name of a block as the last cell of its row, empty where there is none.
fn name_of(names: &[String], block: usize) -> Cell<'_> {
    Cell::Text(names.get(block).map_or("", String::as_str))
}

/// Samples the world and records it.
pub trait Observer {
    /// Due times, and the time of the last record.
    fn schedule(&self) -> &Schedule;

    /// Whether the next record is due; asking changes nothing.
    fn is_due(&self, world: &World) -> bool {
        self.schedule().is_due(world.time())
    }

    /// Records the current world.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file; earlier output stays valid.
    fn observe(&mut self, world: &World) -> Result<(), ObserveError>;

    /// Records the last state of a run that ends early, unless its last step was recorded already.
    ///
    /// # Errors
    ///
    /// As [`Observer::observe`].
    fn observe_last(&mut self, world: &World) -> Result<(), ObserveError> {
        match self.schedule().last() {
            Some(time) if time == world.time() => Ok(()),
            _ => self.observe(world),
        }
    }

    /// Appends its state to a byte buffer.
    ///
    /// # Errors
    ///
    /// None is expected: the format accepts any state.
    fn save(&self, out: Vec<u8>) -> Saved;

    /// Flushes its files to disk, so that they survive a power failure; waits for those that are being written.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    fn sync(&mut self) -> Result<(), ObserveError>;

    /// Restores its state from the front of a byte buffer and removes later output; returns the
    /// rest of the bytes.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file that cannot be continued.
    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError>;
}

/// Due times at a fixed interval from zero.
///
/// An observer acts at the first step at or after its due time and records that step's own time:
/// steps are never adjusted to output times.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Schedule {
    interval: f64,
    n_done: u64,
    last: Option<f64>,
}

impl Schedule {
    /// Due at 0, `interval`, 2 `interval`, ...; s.
    pub fn every(interval: f64) -> Self {
        Self {
            interval,
            n_done: 0,
            last: None,
        }
    }

    /// Whether the next due time has been reached.
    pub fn is_due(&self, time: f64) -> bool {
        // a billionth of an interval of slack: a sum of steps may fall short of a due time by
        // round-off
        (self.n_done as f64 - 1e-9) * self.interval <= time
    }

    /// The next due time; s.
    pub fn next_due(&self) -> f64 {
        self.n_done as f64 * self.interval
    }

    /// Time of the last record; s.
    pub fn last(&self) -> Option<f64> {
        self.last
    }

    /// Continues after the last record of a saved schedule, at an interval of its own.
    pub fn resume(&mut self, saved: Self) {
        if saved.interval == self.interval {
            *self = saved;
        } else if let Some(time) = saved.last {
            self.done(time);
        }
    }

    /// Notes a record; missed due times are skipped.
    pub fn done(&mut self, time: f64) {
        self.last = Some(time);
        self.n_done = (time / self.interval + 1e-9).floor() as u64 + 1;
    }
}

impl Coded for ObserveError {
    fn code(&self) -> Code {
        match self {
            Self::Vtk(error) => error.code(),
            Self::Table(error) => error.code(),
            Self::State(_) => Code::CheckpointMismatch,
            Self::Write { source, .. } => of_writing(source),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_schedule_resumes_at_an_interval_of_its_own() {
        let mut saved = Schedule::every(0.1);
        saved.done(0.52);
        for (interval, due) in [(0.1, 0.6), (0.25, 0.75), (1.0, 1.0)] {
            let mut schedule = Schedule::every(interval);
            schedule.resume(saved);
            assert_eq!(schedule.last(), Some(0.52));
            assert!(schedule.is_due(due) && !schedule.is_due(due - 0.01));
        }
    }

    #[test]
    fn a_schedule_is_due_once_per_interval_whatever_the_step() {
        for step in [0.013, 0.1, 0.37] {
            let mut schedule = Schedule::every(0.1);
            let (mut time, mut records) = (0.0, 0);
            while time <= 3.0 {
                if schedule.is_due(time) {
                    schedule.done(time);
                    records += 1;
                }
                time += step;
            }
            // 0, 0.1, ..., 3.0, or once per step when steps are longer than the interval
            let expected = if step <= 0.1 { 30..=31 } else { 9..=9 };
            assert!(expected.contains(&records), "step {step}: {records}");
        }
    }
}
