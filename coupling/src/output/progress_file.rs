//! `progress.json`: where a run is, for programs that watch it. Names are stable and end with their unit.

use std::fs;
use std::io;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use riprap_sph::ParticleId;
use serde::Serialize;

use super::checkpoint_file::Written;
use super::run_folder;
use crate::world::time_step::Cause;

/// State of a run. A program that was killed leaves `running`; its `pid` is then gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// Under way.
    Running,
    /// It reached its duration.
    Finished,
    /// It ended with an error.
    Failed,
    /// It was asked to stop, and can be resumed.
    Interrupted,
    /// It stopped before its wall limit, and can be resumed.
    WallLimit,
}

/// A particle or block that sets a limit of the step.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HeldBy {
    /// A particle.
    Particle {
        /// Its number, `Id` in frames.
        id: ParticleId,
        /// Its place; m.
        at_m: [f64; 3],
    },
    /// A block by its name.
    Block(String),
}

/// Content of `progress.json`.
#[derive(Clone, Debug, Serialize)]
pub struct ProgressFile {
    /// State of the run.
    pub state: State,
    /// Error of a failed run.
    pub message: Option<String>,
    /// Number of the process.
    pub pid: u32,
    /// `settling`, before t = 0, or `running`.
    pub stage: &'static str,
    /// Steps of this stage.
    pub step: u64,
    /// Time of this stage; s.
    pub time_s: f64,
    /// Duration of settling; s.
    pub settle_s: f64,
    /// Simulated time after settling; s.
    pub duration_s: f64,
    /// Fraction of the whole run, settling included.
    pub share: f64,
    /// Last step; s.
    pub dt_s: Option<f64>,
    /// Limit that governed it, as in `summary.json`.
    pub dt_limited_by: Option<Cause>,
    /// The particle or block by which that limit is as short as it is now.
    pub dt_held_by: Option<HeldBy>,
    /// Recent steps per second of wall time; 1/s.
    pub steps_per_s: Option<f64>,
    /// Wall time left of the whole run; s.
    pub eta_s: Option<f64>,
    /// Wall time so far, earlier starts of the program included; s.
    pub wall_time_s: f64,
    /// Particles of water.
    pub particles: usize,
    /// Blocks, the fixed ones included.
    pub blocks: usize,
    /// Memory of the process, 0 if unknown; bytes.
    pub memory_bytes: u64,
    /// Its largest value so far; bytes.
    pub peak_memory_bytes: u64,
    /// Checkpoint that this start of the program wrote last.
    pub checkpoint: Option<Written>,
    /// Checkpoints written, by earlier starts, too.
    pub checkpoints: u64,
}

/// A content and the time at which it was written.
#[derive(Serialize)]
struct Stamped<'a> {
    /// Seconds since 1970, UTC.
    updated_unix_s: f64,
    #[serde(flatten)]
    content: &'a ProgressFile,
}

impl ProgressFile {
    /// Replaces `progress.json`, at once for every reader; not synced, because it is of the moment.
    ///
    /// # Errors
    ///
    /// Those of the file system.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let stamped = Stamped {
            updated_unix_s: now.map_or(0.0, |now| now.as_secs_f64()),
            content: self,
        };
        let mut text = serde_json::to_string_pretty(&stamped)?;
        text.push('\n');
        let partial = folder.join(format!(".{}.partial", run_folder::PROGRESS));
        fs::write(&partial, text)?;
        fs::rename(&partial, folder.join(run_folder::PROGRESS))
    }
}
