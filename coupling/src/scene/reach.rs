//! What a scene may reach for: the files beside it and the memory of the machine.

use std::path::{Component, Path, PathBuf};

use super::estimate::{self, Available};
use super::mesh::Fault;

/// Where the files that a scene names may be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilesFrom {
    /// In the scene's folder and those below it, links followed.
    #[default]
    SceneFolder,
    /// Anywhere.
    Anywhere,
}

/// What a scene may reach for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach<'a> {
    /// Folder of the scene, from which it names files.
    pub folder: &'a Path,
    /// Where those files may be.
    pub files: FilesFrom,
    /// Memory that a run may take; none where the system does not tell.
    pub memory: Option<Available>,
}

impl<'a> Reach<'a> {
    /// Files in the scene's folder, and the memory of this machine.
    pub fn of(folder: &'a Path) -> Self {
        Self {
            folder,
            files: FilesFrom::default(),
            memory: estimate::available(),
        }
    }

    /// The place of a file that the scene names.
    ///
    /// # Errors
    ///
    /// [`Fault::LeavesFolder`], and what the system says of a file that is not there.
    pub fn find(&self, file: &str) -> Result<PathBuf, Fault> {
        let path = self.folder.join(file);
        if self.files == FilesFrom::Anywhere {
            return Ok(path);
        }
        // what leaves by its name is refused before the file system is asked about it
        if !is_below(file) {
            return Err(Fault::LeavesFolder { to: path });
        }
        let real = path.canonicalize()?;
        // the folder of a scene in the working directory has the empty name
        let folder = Path::new(".").join(self.folder).canonicalize()?;
        if real.starts_with(folder) {
            Ok(path)
        } else {
            Err(Fault::LeavesFolder { to: real })
        }
    }
}

/// Whether a name has no way out of the folder that it starts from, links aside.
pub fn is_below(file: &str) -> bool {
    Path::new(file)
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}
