//! Starting point of a run that is resumed, or continued from another one.

use std::fs;
use std::path::Path;

use super::Note;
use crate::messages::{Code, Message};
use crate::output::checkpoint_file::{self as checkpoint, Checkpoint};
use crate::output::run_folder::{self, ArchivedScene};
use crate::scene::further::{self, Changes};

/// Contents of a run folder.
pub enum Found {
    /// No run to resume.
    Nothing,
    /// A completed run.
    Over,
    /// An incomplete run.
    Checkpoint(Checkpoint, Vec<Note>),
    /// A run of another scene, which this one takes further.
    Further(Checkpoint, Vec<Note>),
}

/// Examines the state of the run of a scene in a run folder, without changing it.
pub fn find(
    scene: &ArchivedScene,
    case: &Path,
    folder: &Path,
    changes: Changes,
) -> Result<Found, Message> {
    let Some(before) = read(&folder.join(run_folder::CASE))? else {
        return Ok(Found::Nothing);
    };
    let is_same = first_difference(&before, &scene.text).is_none();
    let compared = match is_same {
        true => None,
        false => further::as_before(&before, &scene.text, changes),
    };
    let compared = compared.as_ref().unwrap_or(&scene.text);
    if let Some((line, (before, now))) = first_difference(&before, compared) {
        let remedy = match changes {
            Changes::Records => "continue with the scene as it was, name another folder with -o, or start over with --force"
                .to_owned(),
            Changes::Numerics => format!(
                "{}; what may change: {}",
                further::reason_to_stay(if before.is_empty() { now } else { before }),
                further::NUMERICS
            ),
        };
        return Err(other_scene(format!(
            "{}, line {line}: the run had `{before}`, and now it would be `{now}`; {remedy}",
            folder.join(run_folder::CASE).display()
        )));
    }
    let source = case.parent().unwrap_or(Path::new("."));
    for (file, name) in &scene.names {
        let (before, now) = (fs::read(folder.join(name)), fs::read(source.join(file)));
        if before.ok() != now.ok() {
            return Err(other_scene(format!(
                "`{file}` has changed since the start of the run, see {}; start over with --force",
                folder.join(name).display()
            )));
        }
    }
    let summary = read(&folder.join(run_folder::SUMMARY))?;
    let has_ended = summary.is_some();
    let summary = summary.and_then(|text| serde_json::from_str::<serde_json::Value>(&text).ok());
    let is_over = summary.is_some_and(|summary| summary["completed"] == true);
    if is_same && is_over {
        return Ok(Found::Over);
    }
    match checkpoint::newest(folder, &checkpoint::scene_hash(&before)) {
        Err(error) => Err(Message::of(error)),
        Ok(Some((checkpoint, refused))) => {
            let mut notes: Vec<Note> = (refused.into_iter())
                .map(|r| Note::Warning(Message::of(r)))
                .collect();
            let header = &checkpoint.header;
            notes.push(Note::Information(format!(
                "resumes from {}t = {:.6} s, step {}",
                if header.is_settling { "settling, " } else { "" },
                header.time,
                header.steps
            )));
            Ok(match is_same {
                true => Found::Checkpoint(checkpoint, notes),
                false => Found::Further(checkpoint, notes),
            })
        }
        Ok(None) if has_ended => {
            let what = format!(
                "{} contains a run that ended without a checkpoint; start over with --force",
                folder.display()
            );
            Err(Message::new(Code::NoCheckpoint, what))
        }
        // killed before its first checkpoint
        Ok(None) => Ok(Found::Nothing),
    }
}

fn other_scene(what: String) -> Message {
    Message::new(Code::CheckpointMismatch, what)
}

/// A file as text, if it exists.
fn read(path: &Path) -> Result<Option<String>, Message> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => {
            let what = format!("cannot read {}: {error}", path.display());
            Err(Message::new(Code::FileNotReadable, what))
        }
    }
}

/// Number and both versions of the first line in which two texts differ.
fn first_difference<'t>(a: &'t str, b: &'t str) -> Option<(usize, (&'t str, &'t str))> {
    let longest = a.lines().count().max(b.lines().count());
    let lines = |text: &'t str| text.lines().map(str::trim).chain(std::iter::repeat(""));
    let mut both = (1..=longest).zip(lines(a).zip(lines(b)));
    both.find(|(_, (a, b))| a != b)
}
