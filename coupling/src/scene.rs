//! Scenes: schema, validation, and the frozen scene that runs.

pub mod access;
mod attachments;
pub(crate) mod contact_dynamics;
pub mod error;
pub mod estimate;
pub mod file;
pub mod fill;
mod flow;
mod fluid;
pub(crate) mod further;
pub mod geometry;
pub mod impulse_wave;
pub mod locate;
pub mod motion;
mod names;
pub(crate) mod overlaps;
pub mod parse;
mod placed;
pub mod resolve;
pub mod resolved;
pub mod schema;
mod sleep;
mod sliding;
pub(crate) mod symmetry;
pub mod validate;
pub mod wave_maker;
mod written;

// the paths of 0.1, for one release
pub use access as reach;
pub use geometry::{cloud, crs, geotiff, grains, mesh, raster, rock_mass, shape, slides, terrain};

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use access::{Access, FilesFrom};
use error::{Problem, SceneError, Severity};
use estimate::Estimate;
use file::SceneFile;
use locate::Syntax;
use parse::Override;
use placed::Placed;
use resolved::Scene;

use crate::messages::{Code, Message};

/// Largest size of a scene; bytes.
const LARGEST_SCENE: u64 = 200_000_000;

/// Reads, checks and resolves the scene at `path` with the given overrides. Files that it names are in its folder.
///
/// # Errors
///
/// [`SceneError`] with every problem, located in the text.
pub fn load(path: &Path, overrides: &[Override]) -> Result<(Scene, SceneError), SceneError> {
    load_from(path, overrides, FilesFrom::SceneFolder)
}

/// Reads a scene as [`load`] does, with the files that it may name.
///
/// # Errors
///
/// [`SceneError`], as for [`load`].
pub fn load_from(
    path: &Path,
    overrides: &[Override],
    files: FilesFrom,
) -> Result<(Scene, SceneError), SceneError> {
    let name = path.display().to_string();
    let written = text_of(path)?;
    let access = Access {
        files,
        ..Access::of(path.parent().unwrap_or(Path::new(".")))
    };
    load_text(&name, &written, overrides, &access)
}

/// Text of the scene in a file, unread.
///
/// # Errors
///
/// [`SceneError`] when the file cannot be read or is too large.
pub fn text_of(path: &Path) -> Result<String, SceneError> {
    let refused = |message: String| {
        let name = path.display().to_string();
        SceneError::from_problems(
            &name,
            "",
            vec![Problem::error(Code::FileNotReadable, "", message)],
        )
    };
    let mut text = String::new();
    // a device may have no end
    File::open(path)
        .and_then(|file| file.take(LARGEST_SCENE + 1).read_to_string(&mut text))
        .map_err(|error| refused(format!("cannot read the scene: {error}")))?;
    if text.len() as u64 > LARGEST_SCENE {
        return Err(refused(format!(
            "the scene has more than {LARGEST_SCENE} bytes"
        )));
    }
    Ok(text)
}

/// Checks and resolves the scene written in a text, called `name` in messages; in the language of that name's ending.
///
/// # Errors
///
/// As [`load`].
pub fn load_text(
    name: &str,
    written: &str,
    overrides: &[Override],
    access: &Access,
) -> Result<(Scene, SceneError), SceneError> {
    let (text, file) = read_text(name, written, overrides)?;
    let Placed {
        file,
        written,
        systems,
    } = placed::placed(file, access).map_err(|found| refused(name, &text, found))?;
    let located = |problems: Vec<Problem>| written.located(problems);
    let problems = located(validate::values(&file));
    if problems.iter().any(|p| p.severity == Severity::Error) {
        return Err(SceneError::from_problems(name, &text, problems));
    }
    let refuse = |found: Vec<Problem>| {
        let all = problems.iter().cloned().chain(found).collect();
        Err(refused(name, &text, all))
    };
    let mut scene = match Scene::resolve_within(file, access) {
        Ok(scene) => scene,
        Err(found) => return refuse(located(found)),
    };
    let other_system = placed::other_system(&systems, &scene);
    let refusal = Estimate::of(&scene).refusal(access.memory);
    if let Some(refusal) = other_system.or(refusal) {
        return refuse(vec![refusal]);
    }
    let overlapping = overlaps::refused_by_first_step(&scene);
    if !overlapping.is_empty() {
        return refuse(overlapping);
    }
    scene.warnings = located(scene.warnings);
    scene.warnings.splice(0..0, problems);
    let warnings = refused(name, &text, scene.warnings.clone());
    Ok((scene, warnings))
}

/// The text of a scene with overrides, called `name` in messages, once it is read: its fields and variants exist, its values
/// and files are not checked yet.
///
/// # Errors
///
/// [`SceneError`] with the first problem.
pub fn read_text(
    name: &str,
    written: &str,
    overrides: &[Override],
) -> Result<(String, SceneFile), SceneError> {
    let syntax = Syntax::of(name);
    let text = parse::overridden(written, syntax, overrides)
        .map_err(|problem| SceneError::from_problems(name, written, vec![problem]))?;
    let file = parse::read_in(&text, syntax).map_err(|error| {
        let message = Message::new(error.code, error.message);
        SceneError::at_span(name, &text, error.span, &message)
    })?;
    Ok((text, file))
}

fn refused(name: &str, text: &str, problems: Vec<Problem>) -> SceneError {
    SceneError::from_problems(name, text, problems)
}
