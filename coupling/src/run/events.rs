//! Events of a run: progress, recovery from a failed step, end and failure.

use crate::messages::{Code, Coded};
use crate::output::checkpoint_file::Written;
use crate::output::observe::ObserveError;
use crate::output::summary::SettledBlocks;
use crate::world::StepError;
use crate::world::time_step::Cause;

/// Progress of a run.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Whether water or blocks are still settling.
    pub is_settling: bool,
    /// Steps since the start of this stage.
    pub steps: u64,
    /// Time of this stage; s.
    pub time: f64,
    /// End of this stage; s.
    pub end: f64,
    /// Last step; s.
    pub dt: f64,
    /// Limit that governed it.
    pub cause: Cause,
    /// Contact points between blocks.
    pub contacts: usize,
    /// Fastest particle or block; m/s.
    pub fastest: f64,
    /// Particles of water.
    pub particles: usize,
    /// Fraction of the whole run, settling included.
    pub share: f64,
    /// Recent steps per second of wall time; 1/s.
    pub steps_per_second: f64,
    /// Wall time left of the whole run at the recent pace; s. `None` before there is a pace.
    pub left: Option<f64>,
}

/// Event of a run.
#[derive(Debug)]
pub enum Event {
    /// Completed step.
    Step(Progress),
    /// Files of a frame, by their names in the run folder.
    Frame {
        /// s.
        time: f64,
        /// Names.
        files: Vec<String>,
    },
    /// Checkpoint on disk.
    Checkpoint(Written),
    /// Blocks that settled before t = 0.
    Settled(SettledBlocks),
    /// Failed step: the run resumes from the last good state with a shorter step.
    FellBack {
        /// Error of the step.
        error: StepError,
        /// Time of the last good state; s.
        to: f64,
        /// Fraction of the usual step.
        share: f64,
    },
}

/// End of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It reached its duration.
    Completed,
    /// It was asked to stop.
    Interrupted,
    /// Its wall time was about to be used up.
    OutOfTime,
}

/// Failure of a run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// Blocks that cannot be built.
    #[error("cannot build the blocks: {0}")]
    Blocks(#[from] riprap_dda::BlockError),
    /// Fluid that cannot be built.
    #[error("cannot build the fluid: {0}")]
    Fluid(#[from] riprap_sph::FluidError),
    /// Failed step; the last state is in the run folder.
    #[error("{0}")]
    Step(#[from] StepError),
    /// Step that failed again from the last good state with shorter steps.
    #[error(
        "{error}\nthe failure recurred from the last good state, t = {good:.6} s, with {share} of the usual step: a shorter step does not help; the checkpoint is of that state"
    )]
    Unstable {
        /// Error of the step.
        error: StepError,
        /// Time of the last good state; s.
        good: f64,
        /// Fraction of the usual step in the last attempt.
        share: f64,
    },
    /// Failure of a step with what grew first in its last steps, whose paths are in the run folder.
    #[error("{failure}\n{findings}")]
    Examined {
        /// The failure.
        failure: Box<RunError>,
        /// Three lines.
        findings: String,
    },
    /// File that cannot be written; everything written before stays valid.
    #[error("{0}")]
    Observe(#[from] ObserveError),
    /// State of a checkpoint that does not belong to this scene.
    #[error("the state of the checkpoint does not fit the scene: {0}; start over with --force")]
    State(#[from] postcard::Error),
}

impl Coded for RunError {
    fn code(&self) -> Code {
        match self {
            Self::Blocks(error) => error.code(),
            Self::Fluid(error) => error.code(),
            Self::Step(error) | Self::Unstable { error, .. } => error.code(),
            Self::Examined { failure, .. } => failure.code(),
            Self::Observe(error) => error.code(),
            Self::State(_) => Code::CheckpointMismatch,
        }
    }
}
