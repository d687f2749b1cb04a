//! The start of a run from another one: the last good state and the records of another run, in a folder of its own.

use std::fs;
use std::path::Path;

use super::resume::{self, Found};
use super::{Note, further};
use crate::messages::{Code, Message};
use crate::output::checkpoint_file::Checkpoint;
use crate::output::run_folder::{self, ArchivedScene, Existing};
use crate::scene::further::Changes;

/// Makes a run folder that continues the run of another folder, which stays as it is.
pub fn begin(
    scene: &ArchivedScene,
    case: &Path,
    other: &Path,
    (folder, existing): (&Path, Existing),
) -> Result<(Checkpoint, Vec<Note>), Message> {
    let place = |folder: &Path| fs::canonicalize(folder).ok();
    if place(other).is_some() && place(other) == place(folder) {
        let what = format!(
            "{} is the folder of the run to continue from; name another one with -o",
            folder.display()
        );
        return Err(Message::new(Code::WouldOverwrite, what));
    }
    let (checkpoint, notes) = match resume::find(scene, case, other, Changes::Numerics)? {
        Found::Checkpoint(checkpoint, notes) | Found::Further(checkpoint, notes) => {
            (checkpoint, notes)
        }
        Found::Over => {
            let what = format!("{} is complete already", other.display());
            return Err(Message::new(Code::NoCheckpoint, what));
        }
        Found::Nothing => {
            let what = format!(
                "{} contains no checkpoint to continue from",
                other.display()
            );
            return Err(Message::new(Code::NoCheckpoint, what));
        }
    };
    run_folder::create(folder, existing).map_err(Message::of)?;
    run_folder::copy_records(other, folder).map_err(Message::of)?;
    further::begin(scene, &checkpoint, case, folder)?;
    Ok((checkpoint, notes))
}
