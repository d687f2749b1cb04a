//! `riprap check --json`: one object with stable names that end with their unit.

use std::path::Path;

use serde::Serialize;

use super::cost::{Cost, cost};
use super::describe::lines;
use super::facts::{Memory, Model};
use super::mach;
use crate::build_info::COMMIT;
use crate::cli::problems::{Problem, problems};
use crate::cli::{Exit, failed, show};
use crate::messages::{Code, Message};
use crate::run::ineffective::ineffective_options;
use crate::scene::access::FilesFrom;
use crate::scene::parse::Override;
use crate::scene::{self, resolve::Scene};

/// Report of a scene. What a scene with errors does not have is `null`.
#[derive(Serialize)]
struct Report<'a> {
    /// The scene file.
    scene: String,
    version: &'static str,
    commit: &'static str,
    /// Whether the scene can run.
    is_valid: bool,
    problems: Vec<Problem<'a>>,
    title: Option<&'a str>,
    model: Option<Model>,
    memory: Option<Memory>,
    cost: Option<Cost>,
    /// Warnings about numbers of the model.
    warnings: Vec<String>,
    /// Reason why there is no cost.
    error: Option<String>,
    /// The lines of the report in words.
    text: Vec<Words>,
}

/// A line of the report in words.
#[derive(Serialize)]
struct Words {
    heading: &'static str,
    text: String,
}

/// Prints the report of a scene.
pub(super) fn report(case: &Path, overrides: &[Override], files: FilesFrom) -> Exit {
    let loaded = scene::load_from(case, overrides, files);
    let (scene, found) = match &loaded {
        Ok((scene, warnings)) => (Some(scene), warnings),
        Err(errors) => (None, errors),
    };
    let (cost, error) = match scene.map(cost) {
        None => (None, None),
        Some(Ok(cost)) => (Some(cost), None),
        Some(Err(error)) => (None, Some(error.to_string())),
    };
    let exit = match (scene, &error) {
        (None, _) => Exit::BadInput,
        (Some(_), Some(_)) => Exit::Failed,
        (Some(_), None) => Exit::Done,
    };
    let report = Report {
        scene: case.display().to_string(),
        version: env!("CARGO_PKG_VERSION"),
        commit: COMMIT,
        is_valid: scene.is_some(),
        problems: problems(found),
        title: scene.map(|scene| scene.title.as_str()),
        model: scene.map(Model::of),
        memory: scene.map(Memory::of),
        cost,
        warnings: scene.map_or_else(Vec::new, warnings),
        error,
        text: scene.map_or_else(Vec::new, |scene| lines(scene).map(Words::from).collect()),
    };
    match serde_json::to_string_pretty(&report) {
        Ok(text) => {
            show(&text);
            exit
        }
        Err(error) => failed(Message::new(Code::CannotWrite, error.to_string())),
    }
}

fn warnings(scene: &Scene) -> Vec<String> {
    let ineffective = ineffective_options(scene).into_iter();
    ineffective
        .map(|one| format!("no effect at this resolution: {one}"))
        .chain(mach::warning(scene).map(|warning| warning.to_string()))
        .collect()
}

impl From<(&'static str, String)> for Words {
    fn from((heading, text): (&'static str, String)) -> Self {
        Self { heading, text }
    }
}
