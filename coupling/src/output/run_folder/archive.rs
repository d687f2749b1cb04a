//! Copy of a scene and its inputs in the run folder: it can be run again by itself.

use std::collections::BTreeMap;
use std::path::{Component, Path};

use super::{CASE, INPUTS, RENDERED, RunFolderError, is_written_by_runs};
use crate::scene::access::is_below;
use crate::scene::parse;
use crate::scene::resolve::Scene;

/// A scene as its run folder has it.
#[derive(Clone, Debug)]
pub struct ArchivedScene {
    /// Names of the scene's files there, by those in the scene.
    pub names: BTreeMap<String, String>,
    /// The scene with these names.
    pub text: String,
}

impl ArchivedScene {
    /// Text of a scene for its run folder.
    ///
    /// # Errors
    ///
    /// [`RunFolderError::Scene`] when it cannot be written as text.
    pub fn of(scene: &Scene) -> Result<Self, RunFolderError> {
        let mut file = scene.to_file();
        let names = archived_names(&file.referenced_files());
        file.rename_files(|file| names.get(file).cloned().unwrap_or_else(|| file.to_owned()));
        let text = parse::write_noted(&file, &scene.note())?;
        Ok(Self { names, text })
    }

    /// Copies the inputs of the scene in `case` and writes `case.ron`.
    ///
    /// # Errors
    ///
    /// [`RunFolderError`] names the file.
    pub fn write(&self, case: &Path, folder: &Path) -> Result<(), RunFolderError> {
        let source = case.parent().unwrap_or(Path::new("."));
        for (file, name) in &self.names {
            let (from, to) = (source.join(file), folder.join(name));
            // a case run into its own folder already has its files there
            let is_there = from
                .canonicalize()
                .is_ok_and(|from| to.canonicalize().is_ok_and(|to| from == to));
            if is_there {
                continue;
            }
            let copied = to
                .parent()
                .map_or(Ok(()), std::fs::create_dir_all)
                .and_then(|()| std::fs::copy(&from, &to));
            copied.map_err(|source| RunFolderError::Copy {
                file: file.clone(),
                to,
                source,
            })?;
        }
        let path = folder.join(CASE);
        std::fs::write(&path, &self.text).map_err(RunFolderError::io("write", &path))
    }
}

/// Names of files in the run folder, by those in the scene. A file from outside of the scene's folder, or one that has
/// the name of a result, gets a name of its own.
fn archived_names(files: &[String]) -> BTreeMap<String, String> {
    let mut names = BTreeMap::new();
    for file in files {
        let mut parts = Path::new(file).components().filter_map(|part| match part {
            Component::Normal(name) => Some(name.to_string_lossy()),
            _ => None,
        });
        let is_taken = parts
            .next()
            .is_some_and(|first| first == RENDERED || is_written_by_runs(&first));
        if is_below(file) && !is_taken {
            names.insert(file.to_owned(), file.to_owned());
        }
    }
    for file in files {
        if names.contains_key(file) {
            continue;
        }
        let last = Path::new(file).file_name().unwrap_or_default();
        let last = last.to_string_lossy();
        let is_free = |name: &String| {
            !names
                .values()
                .any(|other| Path::new(other) == Path::new(name))
        };
        let name = (1..)
            .map(|k| format!("{INPUTS}/{k}_{last}"))
            .find(is_free)
            .unwrap_or_default();
        names.insert(file.to_owned(), name);
    }
    names
}
