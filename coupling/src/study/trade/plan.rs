//! Runs of a study, each with its scene and an identifying key.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::file::{DesignFile, KnobFile, StudyFile, TruthFile};
use super::outcome::Outcome;
use super::search;
use crate::messages::{Code, Message};
use crate::scene;
use crate::scene::error::{Problem, SceneError};
use crate::scene::estimate::Estimate;
use crate::scene::parse::{self, Override};
use crate::study::jobs::Job;
use crate::study::scenes::{block_named, faults, key};

/// Largest number of runs of a study: more is a typing error.
const MOST_RUNS: usize = 10_000;

/// A checked study.
#[derive(Clone, Debug)]
pub struct Study {
    /// As written.
    pub file: StudyFile,
    /// Its file.
    pub path: PathBuf,
    /// Its text, for the location of errors.
    text: String,
    /// Runs in the order of the design: the first has the first value of every knob.
    pub runs: Vec<Planned>,
    /// Combinations that the search asked for and the scene refuses.
    pub skipped: Vec<Skipped>,
}

/// A combination of values that makes no scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Skipped {
    /// Index of the value of each knob.
    pub choice: Vec<usize>,
    /// Problem of the scene.
    pub reason: String,
}

/// A run of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Planned {
    /// Index of the value of each knob.
    pub choice: Vec<usize>,
    /// Overrides, in order.
    pub overrides: Vec<Override>,
    /// Index of the block of the output, if it concerns one.
    pub block: Option<usize>,
    /// Name of the run's folder: equal for equal scenes and programs.
    pub key: String,
    /// Estimated memory; bytes.
    pub memory: u64,
}

impl Study {
    /// Reads a study and resolves its scenes.
    ///
    /// # Errors
    ///
    /// [`SceneError`] with every problem in its place, in the study or in one of its scenes.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        let (file, text) = read(path)?;
        Self::of(file, path, text)
    }

    /// Study with a given schema and text; resolves its scenes.
    ///
    /// # Errors
    ///
    /// [`SceneError`] with every problem of the scenes, in its place in the text.
    pub fn of(file: StudyFile, path: &Path, text: String) -> Result<Self, SceneError> {
        let first = choices(&file);
        let mut study = Self {
            file,
            path: path.to_owned(),
            text,
            runs: Vec::new(),
            skipped: Vec::new(),
        };
        study.add(first)?;
        Ok(study)
    }

    /// Adds runs with these values of the knobs, and skips those that the scene refuses: values that a scene takes one by
    /// one may exclude each other.
    pub fn add_possible(&mut self, choices: Vec<Vec<usize>>) {
        let case = self.case();
        for choice in choices {
            match planned(&self.file, &case, &choice) {
                Ok(run) => self.runs.push(run),
                Err((_, reason)) => self.skipped.push(Skipped { choice, reason }),
            }
        }
    }

    /// Adds runs with these values of the knobs.
    ///
    /// # Errors
    ///
    /// [`SceneError`] with every scene that cannot be, and by which value.
    fn add(&mut self, choices: Vec<Vec<usize>>) -> Result<(), SceneError> {
        let case = self.case();
        let mut problems = Vec::new();
        for choice in choices {
            match planned(&self.file, &case, &choice) {
                Ok(run) => self.runs.push(run),
                Err((path, message)) => {
                    problems.push(Problem::error(Code::UnusableStudy, path, message))
                }
            }
        }
        if problems.is_empty() {
            return Ok(());
        }
        let name = self.path.display().to_string();
        Err(SceneError::from_problems(&name, &self.text, problems))
    }

    /// Values of the knobs of further runs, given the outcomes so far; empty if the design is complete.
    pub fn next(&self, all: &[Outcome]) -> Vec<Vec<usize>> {
        let DesignFile::Search { runs } = self.file.design else {
            return Vec::new();
        };
        let knobs = self.file.knobs.iter();
        let n_values: Vec<usize> = knobs.map(|knob| knob.values.len()).collect();
        let skipped = self.skipped.iter().map(|skipped| skipped.choice.as_slice());
        let left = runs.saturating_sub(self.runs.len());
        search::next(&n_values, all, &skipped.collect(), left)
    }

    /// The folder from which its files are named.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new("."))
    }

    /// The scene that all runs start from.
    pub fn case(&self) -> PathBuf {
        self.folder().join(&self.file.case)
    }
}

/// Reads a study by itself, and its text.
///
/// # Errors
///
/// [`SceneError`] with every problem in its place.
pub fn read(path: &Path) -> Result<(StudyFile, String), SceneError> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|error| {
        let message = format!("cannot read the study: {error}");
        SceneError::from_problems(
            &name,
            "",
            vec![Problem::error(Code::FileNotReadable, "", message)],
        )
    })?;
    Ok((read_text(&name, &text)?, text))
}

/// The study written in a text, called `name` in messages.
///
/// # Errors
///
/// As [`read`].
pub fn read_text(name: &str, text: &str) -> Result<StudyFile, SceneError> {
    let file: StudyFile = parse::read_as(text).map_err(|error| {
        let message = Message::new(error.code, error.message);
        SceneError::at_span(name, text, error.span, &message)
    })?;
    let problems = problems(&file);
    if problems.is_empty() {
        Ok(file)
    } else {
        Err(SceneError::from_problems(name, text, problems))
    }
}

/// Problems of a study, without its scene.
fn problems(study: &StudyFile) -> Vec<Problem> {
    let mut found = knob_problems(study);
    let set = study.set.iter().enumerate();
    found.extend(set.filter_map(|(s, text)| override_problem(format!("set[{s}]"), text)));
    found.extend(truth_problem(study));
    let is_record = matches!(study.truth, TruthFile::Record { .. });
    if is_record != study.output.take.is_none() {
        let message = match is_record {
            true => "the reference is a record, which uses the whole column: omit `take`",
            false => "give an evaluation of the column, such as take: Maximum(from: 0, to: 5)",
        };
        found.push(Problem::error(Code::UnusableStudy, "output", message));
    }
    let n_runs = match study.design {
        DesignFile::OneAtATime => 1,
        DesignFile::Search { runs } => runs,
        DesignFile::FullGrid => {
            let sizes = study.knobs.iter().map(|knob| knob.values.len());
            sizes.fold(1_usize, usize::saturating_mul)
        }
    };
    if MOST_RUNS < n_runs {
        let message = format!("{n_runs} runs; at most {MOST_RUNS}");
        found.push(Problem::error(Code::UnusableStudy, "design", message));
    }
    found
}

fn override_problem(path: String, text: &str) -> Option<Problem> {
    let message = Override::from_str(text).err()?;
    Some(Problem::error(Code::UnusableOverride, path, message))
}

fn knob_problems(study: &StudyFile) -> Vec<Problem> {
    let mut found = Vec::new();
    let mut refuse = |path: String, message: String| {
        found.push(Problem::error(Code::UnusableStudy, path, message))
    };
    if study.knobs.is_empty() {
        refuse("knobs".into(), "a study needs at least one knob".into());
    }
    for (k, knob) in study.knobs.iter().enumerate() {
        let name = &knob.name;
        if knob.values.is_empty() {
            let message = format!("knob `{name}` has no values");
            refuse(format!("knobs[{k}].values"), message);
        }
        if study.knobs[..k].iter().any(|other| other.name == *name) {
            let message = format!("duplicate knob `{name}`");
            refuse(format!("knobs[{k}].name"), message);
        }
        for (v, value) in knob.values.iter().enumerate() {
            let before = &knob.values[..v];
            if before.iter().any(|other| other.name == value.name) {
                let message = format!("knob `{name}` has duplicate values `{}`", value.name);
                refuse(format!("knobs[{k}].values[{v}].name"), message);
            }
            for (s, text) in value.set.iter().enumerate() {
                if let Err(message) = Override::from_str(text) {
                    refuse(format!("knobs[{k}].values[{v}].set[{s}]"), message);
                }
            }
        }
    }
    found
}

fn truth_problem(study: &StudyFile) -> Option<Problem> {
    let (path, message) = match &study.truth {
        TruthFile::Finest { knob } => {
            let message = match study.knobs.iter().find(|k| k.name == *knob) {
                None => {
                    let names: Vec<&str> = study.knobs.iter().map(|k| k.name.as_str()).collect();
                    let hint = parse::suggestion(knob, &names);
                    Some(format!("no knob named `{knob}`{hint}"))
                }
                Some(knob) if finest(knob).is_none() => {
                    Some(format!("the values of `{}` have no `at`", knob.name))
                }
                Some(_) => None,
            };
            ("truth.knob", message)
        }
        TruthFile::Value { value, scale, .. } => ("truth", no_scale(*value, *scale)),
        TruthFile::Closed { form, scale } => ("truth", no_scale(form.value(), *scale)),
        TruthFile::Record { .. } => ("truth", None),
    };
    Some(Problem::error(Code::UnusableStudy, path, message?))
}

/// Problem if errors cannot be relative to a reference value or its scale.
fn no_scale(truth: f64, scale: Option<f64>) -> Option<String> {
    match scale {
        _ if !truth.is_finite() => Some(format!(
            "the reference value {truth} is not a finite number"
        )),
        Some(0.0) => Some("`scale` is 0, but errors are relative to it: give another".to_owned()),
        None if truth == 0.0 => Some(
            "the reference value is 0, but errors are relative to it: give a `scale`".to_owned(),
        ),
        _ => None,
    }
}

/// The value of a knob that is finest.
pub(super) fn finest(knob: &KnobFile) -> Option<usize> {
    let at: Option<Vec<f64>> = knob.values.iter().map(|value| value.at).collect();
    let at = at?;
    (0..at.len()).min_by(|&a, &b| at[a].total_cmp(&at[b]))
}

/// Values of the knobs of all runs, in order.
fn choices(study: &StudyFile) -> Vec<Vec<usize>> {
    let n = study.knobs.len();
    match study.design {
        DesignFile::OneAtATime | DesignFile::Search { .. } => {
            let mut all = vec![vec![0; n]];
            for (k, knob) in study.knobs.iter().enumerate() {
                for value in 1..knob.values.len() {
                    let mut choice = vec![0; n];
                    choice[k] = value;
                    all.push(choice);
                }
            }
            all
        }
        DesignFile::FullGrid => study.knobs.iter().fold(vec![Vec::new()], |all, knob| {
            let longer = |choice: Vec<usize>| {
                (0..knob.values.len()).map(move |value| {
                    let mut choice = choice.clone();
                    choice.push(value);
                    choice
                })
            };
            all.into_iter().flat_map(longer).collect()
        }),
    }
}

/// A run, or where and why there is none.
fn planned(study: &StudyFile, case: &Path, choice: &[usize]) -> Result<Planned, (String, String)> {
    let chosen = study.knobs.iter().zip(choice);
    let of_values = chosen.flat_map(|(knob, &value)| &knob.values[value].set);
    let overrides: Result<Vec<Override>, String> = study
        .set
        .iter()
        .chain(of_values)
        .map(|text| Override::from_str(text))
        .collect();
    // the value that is not the first is what the run is about
    let place = match (0..choice.len()).rfind(|&k| choice[k] != 0) {
        Some(k) => format!("knobs[{k}].values[{}]", choice[k]),
        None => "case".to_owned(),
    };
    let overrides = overrides.map_err(|message| (place.clone(), message))?;
    let (scene, _) =
        scene::load(case, &overrides).map_err(|error| (place.clone(), faults(&error, case)))?;
    let block = block_named(study.output.block.as_deref(), &scene)
        .map_err(|message| ("output.block".to_owned(), message))?;
    let key = key(&scene, case).map_err(|message| (place, message))?;
    Ok(Planned {
        choice: choice.to_vec(),
        overrides,
        block,
        key,
        memory: Estimate::of(&scene).total() as u64,
    })
}

impl Job for Planned {
    fn memory(&self) -> u64 {
        self.memory
    }
}
