//! The run of one row, in a folder of its own, made once by whoever starts it.
//!
//! ```text
//! DIR/key/            the run folder, with ended.json written last
//! DIR/key.lock        held by the process that runs it
//! ```

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::messages::{Message, of_writing};
use crate::output::checkpoint_file as checkpoint;
use crate::output::run_folder::{self, ArchivedScene};
use crate::run::preparation::{Beginning, Prepared, prepare};
use crate::run::{Ending, Plan, RunError, WallLimit, run};
use crate::scene::resolve::Scene;
use crate::study::trade::execute::{Ended, ended};
use crate::study::trade::results::write;

/// Time between two looks at a run that another process is at.
const WAIT: Duration = Duration::from_millis(200);

/// How a row is run.
#[derive(Debug)]
pub struct Terms<'a> {
    /// Scene file, for the files that it names.
    pub case: &'a Path,
    /// Folder of all runs.
    pub runs: &'a Path,
    /// Wall time that this process may take.
    pub wall_limit: Option<WallLimit>,
    /// Ends the run after the current step, with a checkpoint.
    pub stop: &'a AtomicBool,
    /// Set when a checkpoint is wanted at once.
    pub checkpoint_wanted: Arc<AtomicBool>,
}

/// State of a row that was started.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Its run has ended, completed or failed.
    Ended(Ended),
    /// It was stopped, with a checkpoint to go on from.
    Stopped,
    /// Its wall time was about to be used up; with a checkpoint.
    OutOfTime,
}

/// The folder of the run with a key.
pub fn folder_of(runs: &Path, key: &str) -> PathBuf {
    runs.join(key)
}

/// Runs a scene unless it has ended, from its checkpoint where there is one; waits for a process that is at it.
///
/// # Errors
///
/// A message about a file that cannot be written. A run that fails by itself is an [`Outcome`].
pub fn run_row(mut scene: Scene, key: &str, terms: Terms) -> Result<Outcome, Message> {
    let folder = folder_of(terms.runs, key);
    let Some(_lock) = locked(&folder, terms.stop)? else {
        return Ok(Outcome::Stopped);
    };
    if let Some(ended) = ended(&folder) {
        return Ok(Outcome::Ended(ended));
    }
    let archived = ArchivedScene::of(&scene).map_err(Message::of)?;
    let from = match prepare(&scene, terms.case, &folder, Beginning::Resumed)? {
        // it was lost between its end and its word of that
        Prepared::Complete => return conclude(&folder, Ok(Ending::Completed)),
        Prepared::Ready { from, notes: _ } => from,
    };
    if from.is_none() {
        archived.write(terms.case, &folder).map_err(Message::of)?;
    }
    let plan = Plan {
        from,
        scene_hash: checkpoint::scene_hash(&archived.text),
        wall_limit: terms.wall_limit,
        checkpoint_wanted: terms.checkpoint_wanted,
        ..Plan::new(&folder)
    };
    let ending = run(&mut scene, plan, terms.stop, &mut |_| ()).map(|(_, ending)| ending);
    conclude(&folder, ending)
}

/// Writes down the end of a run.
fn conclude(folder: &Path, ending: Result<Ending, RunError>) -> Result<Outcome, Message> {
    let message = match ending {
        Ok(Ending::Interrupted) => return Ok(Outcome::Stopped),
        Ok(Ending::OutOfTime) => return Ok(Outcome::OutOfTime),
        Ok(Ending::Completed) => String::new(),
        // a full disk says nothing about the scene
        Err(error @ (RunError::Observe(_) | RunError::State(_))) => return Err(Message::of(error)),
        Err(error) => error.to_string(),
    };
    let ended = Ended {
        completed: message.is_empty(),
        message,
        wall_time: wall_time(folder),
    };
    let path = folder.join("ended.json");
    let text = serde_json::to_string_pretty(&ended).map_err(io::Error::from);
    text.and_then(|text| write(&path, (text + "\n").as_bytes()))
        .map_err(|error| cannot("write", &path, &error))?;
    Ok(Outcome::Ended(ended))
}

/// Wall time of a run as its summary has it; s.
fn wall_time(folder: &Path) -> f64 {
    let text = std::fs::read_to_string(folder.join(run_folder::SUMMARY));
    let read = |text: String| serde_json::from_str::<serde_json::Value>(&text).ok();
    let summary = text.ok().and_then(read);
    summary
        .and_then(|summary| summary["wall_time"].as_f64())
        .unwrap_or(0.0)
}

/// The lock of a run; `None` when asked to stop while another process has it. It ends with the process that holds it.
fn locked(folder: &Path, stop: &AtomicBool) -> Result<Option<File>, Message> {
    let path = folder.with_extension("lock");
    let parent = folder.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(parent).map_err(|error| cannot("make", parent, &error))?;
    let options = || {
        File::options()
            .create(true)
            .write(true)
            .truncate(false)
            .open(&path)
    };
    let file = options().map_err(|error| cannot("open", &path, &error))?;
    while !stop.load(Ordering::Relaxed) {
        match file.try_lock() {
            Ok(()) => return Ok(Some(file)),
            Err(TryLockError::WouldBlock) => std::thread::sleep(WAIT),
            // a file system without locks: then nobody has one
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {
                return Ok(Some(file));
            }
            Err(TryLockError::Error(error)) => return Err(cannot("lock", &path, &error)),
        }
    }
    Ok(None)
}

fn cannot(what: &str, path: &Path, error: &io::Error) -> Message {
    let message = format!("cannot {what} {}: {error}", path.display());
    Message::new(of_writing(error), message)
}

impl Outcome {
    /// Whether nothing is left to do.
    pub fn is_ended(&self) -> bool {
        matches!(self, Self::Ended(_))
    }
}
