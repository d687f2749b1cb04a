//! Rows of a sweep, each with its scene and an identifying key.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::design::{self, MOST_DIMENSIONS, MOST_POINTS};
use super::file::{InputFile, SweepDesignFile, SweepFile, ValuesFile};
use crate::messages::{Code, Message};
use crate::scene;
use crate::scene::error::{Problem, SceneError};
use crate::scene::estimate::Estimate;
use crate::scene::parse::{self, Override};
use crate::scene::resolve::Scene;
use crate::study::jobs::Job;
use crate::study::scenes::{block_named, faults, key};

/// Largest number of rows of a sweep: more is a typing error.
const MOST_ROWS: usize = 100_000;
/// Mark of the value in the fields that an input sets.
const VALUE: &str = "{}";

/// A checked sweep.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// As written.
    pub file: SweepFile,
    /// Its file.
    pub path: PathBuf,
    /// Its rows, in the order of the design; replicas of a combination follow each other.
    pub rows: Vec<Row>,
}

/// A row of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// From 1.
    pub number: usize,
    /// Value of each input, as it is written into the scene.
    pub inputs: Vec<String>,
    /// Number of the replica, from 1, where there are any.
    pub replica: Option<usize>,
    /// Overrides, in order.
    pub overrides: Vec<Override>,
}

/// A row with a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Planned {
    /// Number of its row.
    pub number: usize,
    /// Index of the block of each output that concerns one.
    pub blocks: Vec<Option<usize>>,
    /// Name of the run's folder: equal for equal scenes and programs.
    pub key: String,
    /// Estimated memory; bytes.
    pub memory: u64,
}

impl Job for Planned {
    fn memory(&self) -> u64 {
        self.memory
    }
}

impl Sweep {
    /// Reads a sweep and makes its rows, without their scenes.
    ///
    /// # Errors
    ///
    /// [`SceneError`] with every problem of the sweep in its place.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| {
            let message = format!("cannot read the sweep: {error}");
            let problem = Problem::error(Code::FileNotReadable, "", message);
            SceneError::from_problems(&name, "", vec![problem])
        })?;
        let file: SweepFile = parse::read_as(&text).map_err(|error| {
            let message = Message::new(error.code, error.message);
            SceneError::at_span(&name, &text, error.span, &message)
        })?;
        let problems = problems(&file);
        if !problems.is_empty() {
            return Err(SceneError::from_problems(&name, &text, problems));
        }
        let points = design::rows(&file.inputs, file.design);
        let n_replicas = file.replicas.as_ref().map_or(1, |replicas| replicas.number);
        let mut rows = Vec::with_capacity(points.len() * n_replicas);
        for inputs in points {
            for replica in 1..=n_replicas {
                let replica = file.replicas.as_ref().map(|_| replica);
                rows.push(Row {
                    number: rows.len() + 1,
                    overrides: overrides(&file, &inputs, replica),
                    inputs: inputs.clone(),
                    replica,
                });
            }
        }
        Ok(Self {
            file,
            path: path.to_owned(),
            rows,
        })
    }

    /// The scene that all runs start from.
    pub fn case(&self) -> PathBuf {
        let folder = self.path.parent().unwrap_or(Path::new("."));
        folder.join(&self.file.case)
    }

    /// Scene of a row and what is known of its run.
    ///
    /// # Errors
    ///
    /// [`Code::UnusableStudy`] and why these inputs make no scene.
    pub fn scene_of(&self, row: &Row) -> Result<(Scene, Planned), Message> {
        let case = self.case();
        let refused = |message: String| Message::new(Code::UnusableStudy, message);
        let (scene, _) =
            scene::load(&case, &row.overrides).map_err(|error| refused(faults(&error, &case)))?;
        let outputs = self.file.outputs.iter();
        let blocks: Result<Vec<_>, String> = outputs
            .map(|output| block_named(output.block.as_deref(), &scene))
            .collect();
        let planned = Planned {
            number: row.number,
            blocks: blocks.map_err(refused)?,
            key: key(&scene, &case).map_err(refused)?,
            memory: Estimate::of(&scene).total() as u64,
        };
        Ok((scene, planned))
    }

    /// What is known of the run of a row, without its scene.
    ///
    /// # Errors
    ///
    /// As [`Self::scene_of`].
    pub fn plan(&self, row: &Row) -> Result<Planned, Message> {
        self.scene_of(row).map(|(_, planned)| planned)
    }
}

/// Fields of a scene with some values of the inputs.
pub fn overrides(file: &SweepFile, inputs: &[String], replica: Option<usize>) -> Vec<Override> {
    let filled = |set: &[String], value: &str| -> Vec<String> {
        set.iter().map(|text| text.replace(VALUE, value)).collect()
    };
    let of_inputs = file.inputs.iter().zip(inputs);
    let of_inputs = of_inputs.flat_map(|(input, value)| filled(&input.set, value));
    let of_replica = file.replicas.iter().zip(replica);
    let of_replica = of_replica.flat_map(|(replicas, k)| filled(&replicas.set, &k.to_string()));
    let all = file.set.iter().cloned().chain(of_inputs).chain(of_replica);
    // all were tried when the sweep was read
    all.filter_map(|text| Override::from_str(&text).ok())
        .collect()
}

/// Problems of a sweep, without its scene.
fn problems(file: &SweepFile) -> Vec<Problem> {
    let mut found = Vec::new();
    let mut refuse = |path: String, message: String| {
        found.push(Problem::error(Code::UnusableStudy, path, message));
    };
    for (s, text) in file.set.iter().enumerate() {
        if let Err(message) = Override::from_str(text) {
            refuse(format!("set[{s}]"), message);
        }
    }
    if file.inputs.is_empty() && file.replicas.is_none() {
        refuse("inputs".into(), "a sweep needs an input or replicas".into());
    }
    let is_grid = file.design == SweepDesignFile::Grid;
    let is_drawn = !(is_grid || file.design == SweepDesignFile::List);
    for (k, input) in file.inputs.iter().enumerate() {
        if file.inputs[..k]
            .iter()
            .any(|other| other.name == input.name)
        {
            refuse(
                format!("inputs[{k}].name"),
                format!("duplicate input `{}`", input.name),
            );
        }
        if input.set.is_empty() {
            let message = format!("input `{}` sets no field", input.name);
            refuse(format!("inputs[{k}].set"), message);
        }
        for (s, text) in input.set.iter().enumerate() {
            if let Some(message) = set_problem(text) {
                refuse(format!("inputs[{k}].set[{s}]"), message);
            }
        }
        if let Some(message) = values_problem(&input.values) {
            refuse(format!("inputs[{k}].values"), message);
        } else if !is_drawn && input.given().is_none() {
            let message = format!(
                "input `{}` has a distribution, which this design cannot take: give Numbers([..]), or let the design be \
                 LatinHypercube, Sobol or SobolIndices",
                input.name
            );
            refuse(format!("inputs[{k}].values"), message);
        }
    }
    if let (SweepDesignFile::List, Some(message)) = (file.design, uneven(&file.inputs)) {
        refuse("design".into(), message);
    }
    if file.outputs.is_empty() {
        refuse("outputs".into(), "a sweep needs at least one output".into());
    }
    for (k, output) in file.outputs.iter().enumerate() {
        if file.outputs[..k]
            .iter()
            .any(|other| other.name == output.name)
        {
            refuse(
                format!("outputs[{k}].name"),
                format!("duplicate output `{}`", output.name),
            );
        }
        if output.take.is_none() {
            let message = "give an evaluation of the column, such as take: Maximum(from: 0, to: 5)";
            refuse(format!("outputs[{k}]"), message.into());
        }
    }
    if let Some(replicas) = &file.replicas {
        if replicas.number == 0 {
            refuse("replicas.number".into(), "0 replicas are no run".into());
        }
        if matches!(file.design, SweepDesignFile::SobolIndices { .. }) {
            let message = "replicas cannot be told apart from inputs by Sobol indices: make the seed an input";
            refuse("replicas".into(), message.into());
        }
        for (s, text) in replicas.set.iter().enumerate() {
            if let Some(message) = set_problem(text) {
                refuse(format!("replicas.set[{s}]"), message);
            }
        }
    }
    if let Some(message) = size_problem(file) {
        refuse("design".into(), message);
    }
    found
}

/// Problem of a field that an input sets.
fn set_problem(text: &str) -> Option<String> {
    match Override::from_str(text) {
        Err(message) => Some(message),
        Ok(one) if !one.value.contains(VALUE) => Some(format!(
            "`{text}` has no place for the value: write {{}} there, such as {}={{}}",
            one.path
        )),
        Ok(_) => None,
    }
}

/// Problem of the values of an input.
fn values_problem(values: &ValuesFile) -> Option<String> {
    let numbers: Vec<f64> = match values {
        ValuesFile::Numbers(numbers) => numbers.clone(),
        ValuesFile::Texts(texts) => vec![0.0; texts.len()],
        ValuesFile::Uniform { from, to } | ValuesFile::LogUniform { from, to } => vec![*from, *to],
        ValuesFile::Triangular { from, mode, to } => vec![*from, *mode, *to],
        ValuesFile::Normal {
            mean,
            standard_deviation,
        } => vec![*mean, *standard_deviation],
        ValuesFile::LogNormal {
            median,
            standard_deviation,
        } => vec![*median, *standard_deviation],
    };
    if numbers.is_empty() {
        return Some("no values".to_owned());
    }
    if let Some(wrong) = numbers.iter().find(|x| !x.is_finite()) {
        return Some(format!("{wrong} is not a finite number"));
    }
    match *values {
        ValuesFile::Uniform { from, to } | ValuesFile::LogUniform { from, to } if to <= from => {
            Some(format!(
                "from {from} to {to} is no range: `to` is larger than `from`"
            ))
        }
        ValuesFile::LogUniform { from, .. } if from <= 0.0 => {
            Some(format!("from {from}: a logarithm needs values > 0"))
        }
        ValuesFile::LogNormal { median, .. } if median <= 0.0 => {
            Some(format!("median {median}: a logarithm needs values > 0"))
        }
        ValuesFile::Triangular { from, mode, to } if !(from <= mode && mode <= to && from < to) => {
            Some(format!(
                "from {from}, mode {mode}, to {to}: expected from <= mode <= to"
            ))
        }
        ValuesFile::Normal {
            standard_deviation, ..
        }
        | ValuesFile::LogNormal {
            standard_deviation, ..
        } if standard_deviation <= 0.0 => Some(format!(
            "standard deviation {standard_deviation}: expected > 0"
        )),
        _ => None,
    }
}

/// Problem of lists that differ in length.
fn uneven(inputs: &[InputFile]) -> Option<String> {
    let lengths: Vec<(&str, usize)> = (inputs.iter())
        .filter_map(|input| Some((input.name.as_str(), input.given()?.len())))
        .collect();
    let (first, length) = lengths.first()?;
    let (other, wrong) = lengths.iter().find(|(_, other)| other != length)?;
    Some(format!(
        "a list takes the values of all inputs together, but `{first}` has {length} and `{other}` {wrong}"
    ))
}

/// Problem of a design with too many or too few rows.
fn size_problem(file: &SweepFile) -> Option<String> {
    let n = file.inputs.len();
    let (rows, dimensions, points) = match file.design {
        SweepDesignFile::Grid => {
            let sizes = file.inputs.iter().filter_map(InputFile::given);
            let rows = sizes
                .map(|given| given.len())
                .fold(1, usize::saturating_mul);
            (rows, 0, 0)
        }
        SweepDesignFile::List => return None,
        SweepDesignFile::LatinHypercube { runs, .. } => (runs, 0, 0),
        SweepDesignFile::Sobol { runs, .. } => (runs, n, runs),
        SweepDesignFile::SobolIndices { samples, .. } => {
            (samples.saturating_mul(n + 2), 2 * n, samples)
        }
    };
    let rows = rows.saturating_mul(file.replicas.as_ref().map_or(1, |replicas| replicas.number));
    if rows == 0 {
        return Some("no runs".to_owned());
    }
    if MOST_ROWS < rows {
        return Some(format!("{rows} runs; at most {MOST_ROWS}"));
    }
    if MOST_DIMENSIONS < dimensions || MOST_POINTS < points {
        return Some(format!(
            "{points} points in {dimensions} dimensions; at most {MOST_POINTS} and {MOST_DIMENSIONS}"
        ));
    }
    None
}
