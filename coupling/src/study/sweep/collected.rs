//! Results of a sweep: a row each, and what they say together.

use std::path::Path;

use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Deserialize;

use super::file::SweepDesignFile;
use super::plan::{Planned, Row, Sweep};
use super::row::folder_of;
use super::statistics::{Estimated, Indices, exceedance, rank_correlation, sobol_indices};
use crate::files::table::texts;
use crate::messages::Message;
use crate::output::run_folder;
use crate::output::verdict::is_doubt;
use crate::study::trade::execute::ended;
use crate::study::trade::results::value_of;

/// State of the run of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Not ended yet.
    Unfinished,
    /// Reached its end.
    Completed,
    /// Failed in a step, or could not start.
    Failed,
    /// Its inputs make no scene.
    Refused,
}

/// A row with its results.
#[derive(Clone, Debug, PartialEq)]
pub struct Collected {
    /// The row.
    pub row: Row,
    /// State of its run.
    pub state: State,
    /// Name of its folder; empty for a refused one.
    pub key: String,
    /// Value of each output; NaN where there is none.
    pub outputs: Vec<f64>,
    /// Why it failed, or which output is missing.
    pub message: String,
    /// Doubts of the run's own verdict.
    pub doubts: String,
    /// Hash of its final state.
    pub state_hash: String,
    /// Wall time, with that of all its parts; s.
    pub wall_time: f64,
    /// Steps.
    pub steps: u64,
    /// Largest memory held; bytes.
    pub peak_memory: f64,
}

/// Part of a summary.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Summary {
    verdict: Vec<String>,
    state_hash: String,
    wall_time: f64,
    steps: u64,
    peak_memory: f64,
}

/// Plans all rows.
pub fn plan_all(sweep: &Sweep) -> Vec<Result<Planned, Message>> {
    sweep.rows.par_iter().map(|row| sweep.plan(row)).collect()
}

/// Reads the results of all rows, in their order.
pub fn collect(sweep: &Sweep, planned: &[Result<Planned, Message>], runs: &Path) -> Vec<Collected> {
    let rows = sweep.rows.iter().zip(planned);
    rows.map(|(row, planned)| collected(sweep, row, planned, runs))
        .collect()
}

fn collected(
    sweep: &Sweep,
    row: &Row,
    planned: &Result<Planned, Message>,
    runs: &Path,
) -> Collected {
    let mut found = Collected {
        row: row.clone(),
        state: State::Unfinished,
        key: String::new(),
        outputs: vec![f64::NAN; sweep.file.outputs.len()],
        message: String::new(),
        doubts: String::new(),
        state_hash: String::new(),
        wall_time: f64::NAN,
        steps: 0,
        peak_memory: f64::NAN,
    };
    let planned = match planned {
        Ok(planned) => planned,
        Err(message) => {
            (found.state, found.message) = (State::Refused, message.to_string());
            return found;
        }
    };
    found.key.clone_from(&planned.key);
    let folder = folder_of(runs, &planned.key);
    let Some(ended) = ended(&folder) else {
        return found;
    };
    let summary = std::fs::read_to_string(folder.join(run_folder::SUMMARY)).ok();
    let summary: Summary = summary
        .and_then(|text| serde_json::from_str(&text).ok())
        .unwrap_or_default();
    found.doubts = doubts(&summary.verdict);
    found.state_hash = summary.state_hash;
    (found.wall_time, found.steps) = (summary.wall_time, summary.steps);
    found.peak_memory = summary.peak_memory;
    if !ended.completed {
        (found.state, found.message) = (State::Failed, ended.message);
        return found;
    }
    found.state = State::Completed;
    let mut missing = Vec::new();
    let outputs = sweep.file.outputs.iter().zip(&planned.blocks);
    for (value, (output, block)) in found.outputs.iter_mut().zip(outputs) {
        match value_of(output, *block, &folder) {
            Ok(read) => *value = read,
            Err(message) => missing.push(message),
        }
    }
    found.message = missing.join("; ");
    found
}

/// Lines of a verdict that ask for a look at the run.
fn doubts(verdict: &[String]) -> String {
    let lines = verdict.iter().map(String::as_str);
    lines
        .filter(|line| is_doubt(line))
        .collect::<Vec<_>>()
        .join("; ")
}

impl State {
    /// Exit status of the run, as `riprap run` has it; empty where it has not ended.
    fn exit(self) -> &'static str {
        match self {
            Self::Unfinished => "",
            Self::Completed => "0",
            Self::Failed => "1",
            Self::Refused => "2",
        }
    }
}

/// A number as it is read back.
fn number(value: f64) -> String {
    format!("{value:?}")
}

/// `collected.csv`: inputs, outputs, exit status and hash of every row; the same on every machine and by every engine.
pub fn table(sweep: &Sweep, all: &[Collected]) -> String {
    let mut heads = vec!["row".to_owned()];
    heads.extend(sweep.file.inputs.iter().map(|input| input.name.clone()));
    heads.extend(sweep.file.replicas.iter().map(|_| "replica".to_owned()));
    heads.extend(sweep.file.outputs.iter().map(|output| output.name.clone()));
    heads.extend(["exit", "state_hash", "run", "message", "doubts"].map(str::to_owned));
    let cells = |found: &Collected| {
        let mut cells = vec![found.row.number.to_string()];
        cells.extend(found.row.inputs.iter().cloned());
        cells.extend(found.row.replica.map(|k| k.to_string()));
        cells.extend(found.outputs.iter().map(|value| number(*value)));
        cells.extend([
            found.state.exit().to_owned(),
            found.state_hash.clone(),
            found.key.clone(),
            found.message.replace('\n', " "),
            found.doubts.replace('\n', " "),
        ]);
        cells
    };
    texts(&heads, &all.iter().map(cells).collect::<Vec<_>>())
}

/// `cost.csv`: wall time, steps and memory of every row, which depend on the machine.
pub fn cost_table(all: &[Collected]) -> String {
    let heads = ["row", "wall_time [s]", "steps", "peak_memory [B]", "run"].map(str::to_owned);
    let cells = |found: &Collected| {
        vec![
            found.row.number.to_string(),
            number(found.wall_time),
            found.steps.to_string(),
            number(found.peak_memory),
            found.key.clone(),
        ]
    };
    texts(&heads, &all.iter().map(cells).collect::<Vec<_>>())
}

/// Values of an output that are draws of its distribution: of a design for indices only the two independent ones of each sample.
pub fn draws(sweep: &Sweep, all: &[Collected], output: usize) -> Vec<f64> {
    let is_draw = |k: usize| match sweep.file.design {
        SweepDesignFile::SobolIndices { .. } => k % (sweep.file.inputs.len() + 2) < 2,
        _ => true,
    };
    let values = all.iter().enumerate().filter(|(k, _)| is_draw(*k));
    values
        .map(|(_, found)| found.outputs[output])
        .filter(|value| value.is_finite())
        .collect()
}

/// Pairs of a numerical input and an output.
pub fn pairs(all: &[Collected], input: usize, output: usize) -> Vec<(f64, f64)> {
    let pair = |found: &Collected| {
        let x = found.row.inputs[input].parse().ok()?;
        Some((x, found.outputs[output])).filter(|(_, y)| y.is_finite())
    };
    all.iter().filter_map(pair).collect()
}

/// Effect of an input on an output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect {
    /// Rank correlation.
    pub rank: Option<Estimated>,
    /// Sobol indices, of a design for them.
    pub indices: Option<Indices>,
}

/// Effect of every input on an output.
pub fn effects(sweep: &Sweep, all: &[Collected], output: usize) -> Vec<Effect> {
    let n = sweep.file.inputs.len();
    let indices = match sweep.file.design {
        SweepDesignFile::SobolIndices { .. } => {
            let samples = all.chunks(n + 2).map(|sample| {
                let values = sample.iter().map(|found| found.outputs[output]);
                values.collect::<Vec<f64>>()
            });
            // a sample with a failed run says nothing
            let whole = samples.filter(|sample| sample.iter().all(|value| value.is_finite()));
            sobol_indices(&whole.collect::<Vec<_>>())
        }
        _ => None,
    };
    let effect = |input| Effect {
        rank: rank_correlation(&pairs(all, input, output)),
        indices: indices.as_ref().map(|indices| indices[input]),
    };
    (0..n).map(effect).collect()
}

/// `exceedance.csv`: for each output the share of runs that reach a value, with its confidence interval of 95 %.
pub fn exceedance_table(sweep: &Sweep, all: &[Collected]) -> String {
    let heads = ["output", "value", "exceedance [-]", "low [-]", "high [-]"].map(str::to_owned);
    let outputs = sweep.file.outputs.iter().enumerate();
    let rows = outputs.flat_map(|(k, output)| {
        let curve = exceedance(&draws(sweep, all, k)).into_iter();
        curve.map(|point| {
            let Estimated { value, low, high } = point.share;
            let numbers = [point.value, value, low, high].map(number);
            std::iter::once(output.name.clone())
                .chain(numbers)
                .collect()
        })
    });
    texts(&heads, &rows.collect::<Vec<Vec<String>>>())
}

/// `sensitivity.csv`: effect of every input on every output.
pub fn sensitivity_table(sweep: &Sweep, all: &[Collected]) -> String {
    let of = |name: &str| ["", "_low", "_high"].map(|end| format!("{name}{end} [-]"));
    let mut heads = ["output", "input"].map(str::to_owned).to_vec();
    heads.extend(
        ["rank_correlation", "first_index", "total_index"]
            .iter()
            .flat_map(|name| of(name)),
    );
    let cells = |estimated: Option<Estimated>| match estimated {
        Some(Estimated { value, low, high }) => [value, low, high].map(number),
        None => [f64::NAN; 3].map(number),
    };
    let mut rows = Vec::new();
    for (k, output) in sweep.file.outputs.iter().enumerate() {
        for (input, effect) in sweep.file.inputs.iter().zip(effects(sweep, all, k)) {
            let Effect { rank, indices } = effect;
            let estimates = [rank, indices.map(|of| of.first), indices.map(|of| of.total)];
            let mut row = vec![output.name.clone(), input.name.clone()];
            row.extend(estimates.into_iter().flat_map(cells));
            rows.push(row);
        }
    }
    texts(&heads, &rows)
}

/// Number of rows in a state.
pub fn count(all: &[Collected], state: State) -> usize {
    all.iter().filter(|found| found.state == state).count()
}
