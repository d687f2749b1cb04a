//! From scene text to a checked scene.

mod attachments;
pub mod error;
pub mod file;
pub mod fill;
mod flow;
mod fluid;
pub mod grains;
pub mod locate;
pub mod mesh;
pub mod motion;
pub mod parse;
pub mod raster;
pub mod resolve;
pub mod rock_mass;
pub mod shape;
pub(crate) mod symmetry;
pub mod validate;

use std::path::Path;

use error::{Problem, SceneError, Severity};
use parse::Override;
use resolve::Scene;

/// Reads, checks and resolves the scene at `path` with the given overrides.
///
/// # Errors
///
/// [`SceneError`] with every problem in its place in the text.
pub fn load(path: &Path, overrides: &[Override]) -> Result<(Scene, SceneError), SceneError> {
    let name = path.display().to_string();
    let written = std::fs::read_to_string(path).map_err(|error| {
        let message = format!("cannot read the scene: {error}");
        SceneError::from_problems(&name, "", vec![Problem::error("", message)])
    })?;
    let folder = path.parent().unwrap_or(Path::new("."));
    load_text(&name, &written, overrides, folder)
}

/// Checks and resolves the scene written in a text, called `name` in messages. Files that it names are in `folder`.
///
/// # Errors
///
/// As [`load`].
pub fn load_text(
    name: &str,
    written: &str,
    overrides: &[Override],
    folder: &Path,
) -> Result<(Scene, SceneError), SceneError> {
    let text = parse::overridden(written, overrides)
        .map_err(|problem| SceneError::from_problems(name, written, vec![problem]))?;
    let file = parse::read(&text)
        .map_err(|error| SceneError::at_span(name, &text, error.span, error.message))?;
    let problems = validate::values(&file);
    if problems.iter().any(|p| p.severity == Severity::Error) {
        return Err(SceneError::from_problems(name, &text, problems));
    }
    match Scene::resolve(file, folder) {
        Ok(mut scene) => {
            scene.warnings.splice(0..0, problems);
            let warnings = SceneError::from_problems(name, &text, scene.warnings.clone());
            Ok((scene, warnings))
        }
        Err(found) => {
            let all = problems.into_iter().chain(found).collect();
            Err(SceneError::from_problems(name, &text, all))
        }
    }
}
