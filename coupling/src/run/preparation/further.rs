//! The folder of a run that is taken further.

use std::fs;
use std::path::Path;

use crate::messages::{Code, Message};
use crate::output::checkpoint_file::{self as checkpoint, Checkpoint, Header};
use crate::output::run_folder::{self, ArchivedScene};

/// Makes a run folder one of the scene that takes its run further.
///
/// The checkpoint comes first: it is then of either scene, whenever the program is killed.
pub fn begin(
    scene: &ArchivedScene,
    checkpoint: &Checkpoint,
    case: &Path,
    folder: &Path,
) -> Result<(), Message> {
    let header = Header {
        scene: checkpoint::scene_hash(&scene.text),
        ..checkpoint.header.clone()
    };
    checkpoint::write(folder, &header, &checkpoint.state).map_err(Message::of)?;
    let summary = folder.join(run_folder::SUMMARY);
    match fs::remove_file(&summary) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            let what = format!("cannot remove {}: {error}", summary.display());
            return Err(Message::new(Code::CannotWrite, what));
        }
        _ => {}
    }
    scene.write(case, folder).map_err(Message::of)
}
