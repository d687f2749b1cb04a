//! `riprap new`: scenes to start from, every choice commented.

mod barrier;
mod digits;
mod flume;
mod rockfall;
mod slope;
mod survey;
mod wavemaker;

use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::{Exit, refused, report_scene_error, say, told};
use crate::messages::{Code, Message, of_writing};
use crate::scene::access::Access;
use crate::scene::error::SceneError;
use crate::scene::load_text;
use crate::scene::resolve::Scene;

/// Acceleration of gravity where a scene does not say otherwise; m/s².
const GRAVITY: f64 = 9.81;

/// Write a scene to start from, every choice commented.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    kind: Kind,
}

/// Kinds of scenes.
#[derive(Debug, clap::Subcommand)]
enum Kind {
    /// Rock slope above water, on terrain: waves, run-up, maps.
    Slope(slope::Options),
    /// Water channel with a paddle that makes a solitary wave.
    Flume(flume::Options),
    /// Water channel with a paddle that makes regular waves, and a layer that absorbs them.
    Wavemaker(wavemaker::Options),
    /// Boulders released on terrain: paths, bounce heights, run-out.
    Rockfall(rockfall::Options),
    /// Grains that run down a chute against a barrier.
    Barrier(barrier::Options),
}

/// File that is written.
#[derive(Debug, clap::Args)]
struct Target {
    /// The scene to write; `my_slope.ron` and the like when left out.
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite an existing file.
    #[arg(long)]
    force: bool,
}

/// Scene as text, with the files that it needs beside it.
struct Draft {
    scene: String,
    /// Names and contents.
    beside: Vec<(String, String)>,
    /// Decisions and doubts that the user should know of.
    notes: Vec<String>,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    let (target, name) = match &arguments.kind {
        Kind::Slope(options) => (&options.target, "my_slope.ron"),
        Kind::Flume(options) => (&options.target, "my_flume.ron"),
        Kind::Wavemaker(options) => (&options.target, "my_wavemaker.ron"),
        Kind::Rockfall(options) => (&options.target, "my_rockfall.ron"),
        Kind::Barrier(options) => (&options.target, "my_barrier.ron"),
    };
    let path = target.out.clone().unwrap_or_else(|| PathBuf::from(name));
    if path.exists() && !target.force {
        return refused(exists(&path));
    }
    let draft = match &arguments.kind {
        Kind::Slope(options) => slope::draft(options, &path),
        Kind::Flume(options) => flume::draft(options, &path),
        Kind::Wavemaker(options) => wavemaker::draft(options),
        Kind::Rockfall(options) => rockfall::draft(options, &path),
        Kind::Barrier(options) => barrier::draft(options),
    };
    let draft = draft.map_err(|fault| Message::new(Code::UnusableArgument, fault));
    match draft.and_then(|draft| write(&draft, &path, target).map(|()| draft)) {
        Ok(draft) => report(&draft, &path),
        Err(fault) => refused(fault),
    }
}

fn exists(path: &Path) -> Message {
    let what = format!(
        "`{}` exists; choose another name with --out, or --force to overwrite it",
        path.display()
    );
    Message::new(Code::WouldOverwrite, what)
}

/// Writes the scene and the files beside it.
fn write(draft: &Draft, path: &Path, target: &Target) -> Result<(), Message> {
    let folder = folder_of(path);
    let failed = |path: &Path, error: &std::io::Error| {
        let what = format!("cannot write `{}`: {error}", path.display());
        Message::new(of_writing(error), what)
    };
    std::fs::create_dir_all(folder).map_err(|error| failed(folder, &error))?;
    let beside = draft.beside.iter();
    let files = beside.map(|(name, content)| (folder.join(name), content));
    for (path, content) in files.chain([(path.to_owned(), &draft.scene)]) {
        let file = OpenOptions::new()
            .write(true)
            .create(true)
            .truncate(true)
            .create_new(!target.force)
            .open(&path);
        file.and_then(|mut file| file.write_all(content.as_bytes()))
            .map_err(|error| match error.kind() {
                std::io::ErrorKind::AlreadyExists => exists(&path),
                _ => failed(&path, &error),
            })?;
    }
    Ok(())
}

/// Checks the written scene and tells what comes next.
fn report(draft: &Draft, path: &Path) -> Exit {
    for note in &draft.notes {
        say(note);
    }
    let shown = path.display();
    match checked(&draft.scene, path) {
        Ok((_, warnings)) => {
            if !warnings.located().is_empty() {
                told::problems(&warnings);
            }
            let typed = as_typed(path);
            say(&format!(
                "wrote {shown}; next: riprap check {typed}, riprap run {typed}"
            ));
            Exit::Done
        }
        Err(error) => {
            say(&format!("wrote {shown}, which needs your hand:"));
            report_scene_error(&error);
            Exit::BadInput
        }
    }
}

/// A path as a shell takes it, in quotes where it needs them.
fn as_typed(path: &Path) -> String {
    let shown = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "._-+/\\:".contains(c);
    match shown.chars().all(is_plain) {
        true => shown,
        false => format!("\"{shown}\""),
    }
}

/// Reads a scene that is, or will be, at a path.
fn checked(scene: &str, path: &Path) -> Result<(Scene, SceneError), SceneError> {
    let access = Access::of(folder_of(path));
    load_text(&path.display().to_string(), scene, &[], &access)
}

/// Folder of a file, the working directory for a mere name.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Name of a file as seen from a scene: both in one folder, or the file below that of the scene.
///
/// # Errors
///
/// A message for a file that is missing or elsewhere.
fn name_beside(file: &Path, path: &Path) -> Result<String, String> {
    let shown = file.display();
    let real = file
        .canonicalize()
        .map_err(|error| format!("cannot read `{shown}`: {error}"))?;
    let folder = folder_of(path).canonicalize();
    let below = folder
        .ok()
        .and_then(|folder| Some(real.strip_prefix(folder).ok()?.to_owned()));
    let Some(below) = below else {
        let remedy = folder_of(file).join(path.file_name().unwrap_or_default());
        return Err(format!(
            "`{shown}` must lie in the folder of the scene or below: copy it there, or write the scene to it with --out {}",
            remedy.display()
        ));
    };
    let parts = below
        .components()
        .map(|part| part.as_os_str().to_string_lossy());
    Ok(parts.collect::<Vec<_>>().join("/"))
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn paths_with_blanks_are_quoted() {
        assert_eq!(as_typed(Path::new("runs/my-1.ron")), "runs/my-1.ron");
        assert_eq!(as_typed(Path::new("my scene.ron")), "\"my scene.ron\"");
    }

    #[test]
    fn files_are_named_from_the_folder_of_the_scene() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["maps", "scenes"] {
            std::fs::create_dir(at(name)).unwrap();
        }
        std::fs::write(at("maps/land.asc"), "").unwrap();
        let named = |scene: &str| name_beside(&at("maps/land.asc"), &at(scene));
        assert_eq!(named("my.ron"), Ok("maps/land.asc".to_owned()));
        assert_eq!(named("maps/my.ron"), Ok("land.asc".to_owned()));
        let elsewhere = named("scenes/my.ron").unwrap_err();
        let remedy = format!("--out {}", at("maps/my.ron").display());
        assert!(elsewhere.ends_with(&remedy), "{elsewhere}");
        assert!(name_beside(&at("sea.asc"), &at("my.ron")).is_err());
    }
}
