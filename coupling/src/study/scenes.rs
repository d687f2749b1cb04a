//! Scenes of studies: their identity, their faults, and the blocks that outputs name.

use std::path::Path;

use crate::build_info::COMMIT;
use crate::scene::error::{SceneError, Severity};
use crate::scene::parse::suggestion;
use crate::scene::resolve::Scene;

/// Name of the folder of a run: a hash of the scene with every default written out, the files that it names, and the program.
///
/// # Errors
///
/// A message that names a file that cannot be read.
pub fn key(scene: &Scene, case: &Path) -> Result<String, String> {
    let text = scene.to_text().map_err(|error| error.to_string())?;
    let mut hasher = blake3::Hasher::new();
    hasher.update(text.as_bytes());
    hasher.update(COMMIT.as_bytes());
    let folder = case.parent().unwrap_or(Path::new("."));
    for file in scene.referenced_files() {
        let path = folder.join(file);
        let bytes = std::fs::read(&path)
            .map_err(|error| format!("cannot read {}: {error}", path.display()))?;
        hasher.update(&bytes);
    }
    Ok(hasher.finalize().to_hex()[..16].to_owned())
}

/// Errors of a scene with their places, without its warnings.
pub fn faults(error: &SceneError, case: &Path) -> String {
    let found = error.located().iter();
    let errors = found.filter(|one| one.severity == Severity::Error);
    let lines = errors.map(|one| {
        format!(
            "{}:{}:{}: {}",
            case.display(),
            one.line,
            one.column,
            one.message
        )
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Index of the block that an output names, if it names one.
///
/// # Errors
///
/// A message where the scene has no such block.
pub fn block_named(name: Option<&str>, scene: &Scene) -> Result<Option<usize>, String> {
    let Some(name) = name else {
        return Ok(None);
    };
    let names: Vec<&str> = scene.block_names.iter().map(String::as_str).collect();
    match names.iter().position(|other| *other == name) {
        Some(block) => Ok(Some(block)),
        None => Err(format!(
            "no block named `{name}`{}",
            suggestion(name, &names)
        )),
    }
}
