//! Preparation of a run folder: for a run from the beginning, one that is resumed, or one that continues another.

mod from;
mod further;
mod resume;

use std::path::Path;

use crate::messages::Message;
use crate::output::checkpoint_file::Checkpoint;
use crate::output::run_folder::{self, ArchivedScene, Existing};
use crate::scene::further::Changes;
use crate::scene::resolve::Scene;
use resume::Found;

/// Beginning of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beginning<'a> {
    /// At its start.
    New(Existing),
    /// Where the run in the folder stopped, or further than its end.
    Resumed,
    /// At the last good state of the run in another folder.
    From(&'a Path, Existing),
}

/// Remark on how a run begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Note {
    /// A fact, as a line.
    Information(String),
    /// A doubt.
    Warning(Message),
}

/// State of a run folder.
#[derive(Clone, Debug, PartialEq)]
pub enum Prepared {
    /// Its run is complete.
    Complete,
    /// The run may begin.
    Ready {
        /// Checkpoint to continue from; without one the folder is empty, and waits for the scene.
        from: Option<Checkpoint>,
        /// Told to the user.
        notes: Vec<Note>,
    },
}

/// Prepares the folder of a run of the scene in the file `case`, or finds the checkpoint to continue from.
///
/// # Errors
///
/// A message when the folder is used, belongs to another scene, or cannot be read or written.
pub fn prepare(
    scene: &Scene,
    case: &Path,
    folder: &Path,
    beginning: Beginning,
) -> Result<Prepared, Message> {
    let mut notes = Vec::new();
    let archived = || ArchivedScene::of(scene).map_err(Message::of);
    let existing = match beginning {
        Beginning::New(existing) => existing,
        Beginning::From(other, existing) => {
            let (checkpoint, notes) = from::begin(&archived()?, case, other, (folder, existing))?;
            let from = Some(checkpoint);
            return Ok(Prepared::Ready { from, notes });
        }
        Beginning::Resumed => {
            let archived = archived()?;
            match resume::find(&archived, case, folder, Changes::Records)? {
                Found::Over => return Ok(Prepared::Complete),
                Found::Checkpoint(checkpoint, notes) => {
                    let from = Some(checkpoint);
                    return Ok(Prepared::Ready { from, notes });
                }
                Found::Further(checkpoint, notes) => {
                    further::begin(&archived, &checkpoint, case, folder)?;
                    let from = Some(checkpoint);
                    return Ok(Prepared::Ready { from, notes });
                }
                Found::Nothing => notes.push(Note::Information(format!(
                    "{} contains no checkpoint: the run starts from the beginning",
                    folder.display()
                ))),
            }
            Existing::Replace
        }
    };
    run_folder::create(folder, existing).map_err(Message::of)?;
    Ok(Prepared::Ready { from: None, notes })
}
