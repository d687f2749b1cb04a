//! Execution of the runs of a study, each in its own folder and process, as many at once as cores and memory allow.
//!
//! A run has its own working folder, named by the id of this process, so that a run that outlives a killed study does not
//! interfere. After its end its folder, with `ended.json` written last, gets its final name, and the run is never
//! repeated. An interrupted run starts again.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use super::plan::{Planned, Study};
use crate::messages::{Code, Coded, of_writing};
use crate::study::jobs::{Means, Progress, run_all};

/// Result of a completed run, as written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ended {
    /// Whether it reached its end; otherwise it failed, for instance by instability.
    pub completed: bool,
    /// Error message of a failed run.
    pub message: String,
    /// Wall time of the process; s.
    pub wall_time: f64,
}

/// Function that executes a run in a folder, on one thread; `None` if it was interrupted.
pub type Runner<'a> = dyn Fn(&Planned, &Path) -> io::Result<Option<Ended>> + Sync + 'a;

/// Error of a study.
#[derive(Debug, thiserror::Error)]
pub enum ExecuteError {
    /// A file could not be written or a process not started; completed runs are preserved.
    #[error("cannot {what} {}: {source}", path.display())]
    Io {
        /// Operation that failed.
        what: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
}

/// The folder of a run.
pub fn folder_of(runs: &Path, run: &Planned) -> PathBuf {
    runs.join(&run.key)
}

/// Result of a run, if completed.
pub fn ended(folder: &Path) -> Option<Ended> {
    let text = std::fs::read_to_string(folder.join("ended.json")).ok()?;
    serde_json::from_str(&text).ok()
}

/// Executor of the runs of a study.
#[derive(Clone, Copy)]
pub struct Executor<'a> {
    /// Cores and memory.
    pub means: Means,
    /// Ends the execution after the active runs.
    pub stop: &'a AtomicBool,
    /// Executes one run.
    pub runner: &'a Runner<'a>,
    /// Called after each run.
    pub tell: &'a (dyn Fn(Progress) + Sync),
}

/// Executes the incomplete runs of a study in a folder; returns whether all are complete.
///
/// # Errors
///
/// [`ExecuteError`] names the first file that could not be written, after the active runs have ended.
pub fn execute(study: &Study, runs: &Path, executor: Executor) -> Result<bool, ExecuteError> {
    let Executor {
        means,
        stop,
        runner,
        tell,
    } = executor;
    // two combinations may give the same scene, which is run once
    let mut seen = BTreeSet::new();
    let mut unique: Vec<&Planned> = study.runs.iter().collect();
    unique.retain(|run| seen.insert(&run.key));
    let waiting: Vec<&Planned> = unique
        .iter()
        .copied()
        .filter(|run| ended(&folder_of(runs, run)).is_none())
        .collect();
    let (all, n_before) = (unique.len(), unique.len() - waiting.len());
    let told = |ended: usize| {
        let ended = n_before + ended;
        tell(Progress { ended, all });
    };
    let execute = |run: &Planned| make(run, &folder_of(runs, run), runner);
    let is_complete = run_all(waiting, means, stop, &execute, &told)?;
    let has_ended = |run: &&&Planned| ended(&folder_of(runs, run)).is_some();
    let keys = unique.iter().filter(has_ended).map(|run| run.key.as_str());
    clear_remains(runs, &keys.collect());
    Ok(is_complete)
}

/// Executes one run and records its end; returns whether it is complete.
fn make(run: &Planned, folder: &Path, runner: &Runner) -> Result<bool, ExecuteError> {
    let failed = |what, path: &Path| {
        let path = path.to_owned();
        move |source| ExecuteError::Io { what, path, source }
    };
    let work = folder.with_extension(std::process::id().to_string());
    let _ = std::fs::remove_dir_all(&work);
    std::fs::create_dir_all(&work).map_err(failed("make", &work))?;
    let Some(ended) = runner(run, &work).map_err(failed("run in", &work))? else {
        let _ = std::fs::remove_dir_all(&work);
        return Ok(false);
    };
    let path = work.join("ended.json");
    let text =
        serde_json::to_string_pretty(&ended).map_err(|e| failed("write", &path)(e.into()))?;
    std::fs::write(&path, text + "\n").map_err(failed("write", &path))?;
    // an incomplete one, of an earlier program that worked in place
    let _ = std::fs::remove_dir_all(folder);
    std::fs::rename(&work, folder).map_err(failed("rename to", folder))?;
    Ok(true)
}

/// Removes folders left by killed studies of runs that have been completed since.
fn clear_remains(runs: &Path, ended: &BTreeSet<&str>) {
    let Ok(entries) = std::fs::read_dir(runs) else {
        return;
    };
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
        let is_remains = path
            .extension()
            .is_some_and(|e| e.to_string_lossy().parse::<u32>().is_ok());
        let key = path
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned());
        if is_remains && key.is_some_and(|key| ended.contains(key.as_str())) {
            // an orphan process that still writes recreates it, without harm
            let _ = std::fs::remove_dir_all(path);
        }
    }
}

impl Coded for ExecuteError {
    fn code(&self) -> Code {
        let Self::Io { source, .. } = self;
        of_writing(source)
    }
}
