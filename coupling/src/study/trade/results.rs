//! Results of a study: value, error and cost of each run, `trade.csv` and `front.csv`.

use std::io;
use std::path::Path;

use super::execute::{ended, folder_of};
use super::file::{OutputFile, StudyFile, TruthFile};
use super::front::{Point, error_per_doubling, front};
use super::outcome::{Cost, CostOf, Outcome, point};
use super::plan::{Planned, Skipped, Study, finest};
use crate::files::table::{TableData, TableError, TextRow, TextTable, read_table, texts};
use crate::output::run_folder;
use crate::study::compare::{Options, Series, compare_files};

/// Reads the results of the completed runs of a study.
pub fn collect(study: &Study, runs: &Path) -> Vec<Outcome> {
    let ended_runs = study.runs.iter().filter_map(|run| {
        let folder = folder_of(runs, run);
        Some((run, ended(&folder)?, folder))
    });
    let mut all: Vec<Outcome> = ended_runs
        .map(|(run, ended, folder)| {
            let judged = match ended.completed {
                true => judge(&study.file, study.folder(), run.block, &folder),
                false => Err(ended.message),
            };
            let (value, error, message) = match judged {
                Ok((value, error)) => (value, error, String::new()),
                Err(message) => (None, None, message),
            };
            Outcome {
                choice: run.choice.clone(),
                key: run.key.clone(),
                value,
                error,
                is_stable: ended.completed,
                message,
                cost: cost(&folder),
            }
        })
        .collect();
    judge_by_finest(study, &mut all);
    all
}

/// Value and error of a single run, from the folder of the study and the folder of the run.
///
/// # Errors
///
/// A message if it has no value.
pub fn judge(
    study: &StudyFile,
    study_folder: &Path,
    block: Option<usize>,
    folder: &Path,
) -> Result<(Option<f64>, Option<f64>), String> {
    let output = &study.output;
    let value = || value_of(output, block, folder);
    let relative = |truth: f64, scale: &Option<f64>| {
        let value = value()?;
        let scale = scale.unwrap_or(truth).abs();
        Ok((Some(value), Some((value - truth).abs() / scale)))
    };
    match &study.truth {
        TruthFile::Value { value, scale, .. } => relative(*value, scale),
        TruthFile::Closed { form, scale } => relative(form.value(), scale),
        TruthFile::Finest { .. } => Ok((Some(value()?), None)),
        TruthFile::Record {
            file,
            shift,
            window,
        } => {
            let options = Options {
                shift: *shift,
                from: window.map(|(from, _)| from),
                to: window.map(|(_, to)| to),
                ..Options::default()
            };
            let (path, record) = (folder.join(&output.file), study_folder.join(file));
            let reports = compare_files(&path, &record, Some(&output.column), options)
                .map_err(|error| error.to_string())?;
            let error = reports
                .first()
                .and_then(|one| one.comparison.normalized_rms_error);
            Ok((None, error))
        }
    }
}

/// Evaluated quantity of a run, from its folder; of one block, in a table with rows of several.
///
/// # Errors
///
/// A message if the run has no such value.
pub fn value_of(output: &OutputFile, block: Option<usize>, folder: &Path) -> Result<f64, String> {
    let path = folder.join(&output.file);
    let mut table = read_table(&path).map_err(|error| error.to_string())?;
    if let Some(block) = block {
        table = of_block(table, block).map_err(|error| error.to_string())?;
    }
    let series = Series::from_table(&table, &output.column).map_err(|error| error.to_string())?;
    let taken = output.take.and_then(|take| take.of(&series));
    taken.ok_or_else(|| format!("`{}` does not contain the requested data", output.column))
}

/// The rows of a table for one block.
fn of_block(mut table: TableData, block: usize) -> Result<TableData, TableError> {
    let is_of: Vec<bool> = (table.column("block")?.iter().map(|&b| b == block as f64)).collect();
    for values in &mut table.values {
        let mut is_of = is_of.iter();
        values.retain(|_| is_of.next() == Some(&true));
    }
    Ok(table)
}

/// The run with the finest value of the knob named by the reference, the others at their first values.
pub fn finest_run<'a>(study: &StudyFile, all: &'a [Outcome]) -> Option<&'a Outcome> {
    let TruthFile::Finest { knob } = &study.truth else {
        return None;
    };
    let k = study.knobs.iter().position(|one| one.name == *knob)?;
    let finest = finest(&study.knobs[k])?;
    along(all, k).find(|found| found.choice[k] == finest)
}

/// Errors against the finest run.
fn judge_by_finest(study: &Study, all: &mut [Outcome]) {
    let truth = finest_run(&study.file, all).map(|found| (found.choice.clone(), found.value));
    let Some((finest, Some(truth))) = truth else {
        return;
    };
    for found in all.iter_mut().filter(|found| found.choice != finest) {
        found.error = found.value.map(|value| ((value - truth) / truth).abs());
    }
}

fn cost(folder: &Path) -> Cost {
    let text = std::fs::read_to_string(folder.join(run_folder::SUMMARY));
    let read = |text: String| serde_json::from_str(&text).ok();
    text.ok().and_then(read).unwrap_or_default()
}

/// Indices of the runs on the Pareto front: by wall time, and by work.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fronts {
    /// By wall time.
    pub by_time: Vec<usize>,
    /// By pair interactions and contacts.
    pub by_work: Vec<usize>,
}

impl Fronts {
    /// Runs that reached their end and have an error.
    pub fn of(all: &[Outcome]) -> Self {
        let by = |cost: CostOf| {
            let points: Vec<Point> = all.iter().map(|found| point(found, cost)).collect();
            front(&points)
        };
        Self {
            by_time: by(|cost| cost.wall_time),
            by_work: by(Cost::work),
        }
    }
}

/// The runs in which one knob alone is varied.
pub fn along(all: &[Outcome], knob: usize) -> impl Iterator<Item = &Outcome> + Clone {
    all.iter().filter(move |found| {
        let mut others = found.choice.iter().enumerate().filter(|(k, _)| *k != knob);
        others.all(|(_, &value)| value == 0)
    })
}

/// Factor on the error per doubling of the cost along one knob; `None` if the cost hardly changes.
pub(super) fn bought_along(all: &[Outcome], knob: usize, cost: CostOf) -> Option<f64> {
    let points: Vec<Point> = along(all, knob).map(|found| point(found, cost)).collect();
    error_per_doubling(&points)
}

/// Factor on the error per doubling of wall time, for every knob.
pub fn bought<'a>(study: &'a Study, all: &[Outcome]) -> Vec<(&'a str, Option<f64>)> {
    let knobs = study.file.knobs.iter().enumerate();
    knobs
        .map(|(k, knob)| {
            (
                knob.name.as_str(),
                bought_along(all, k, |cost| cost.wall_time),
            )
        })
        .collect()
}

/// `trade.csv`: a line per run, in the order of the design.
pub fn table(study: &Study, all: &[Outcome]) -> String {
    let fronts = Fronts::of(all);
    let rows: Vec<usize> = (0..all.len()).collect();
    lines(study, all, &fronts, &rows)
}

/// `front.csv`: the Pareto front, by wall time or by work, in order of increasing wall time.
pub fn front_table(study: &Study, all: &[Outcome]) -> String {
    let fronts = Fronts::of(all);
    let mut rows: Vec<usize> = fronts
        .by_time
        .iter()
        .chain(&fronts.by_work)
        .copied()
        .collect();
    rows.sort_by(|&a, &b| {
        all[a]
            .cost
            .wall_time
            .total_cmp(&all[b].cost.wall_time)
            .then(a.cmp(&b))
    });
    rows.dedup();
    lines(study, all, &fronts, &rows)
}

/// Heads of columns that older tables do not have.
const PENETRATION: &str = "max_wall_penetration [dp]";
const WALL_GAP: &str = "wall_gap [dp]";

/// Heads of the columns that follow those of the knobs.
const HEADS: [&str; 16] = [
    "value",
    "error [-]",
    "stable",
    "wall_time [s]",
    "work [pairs]",
    "steps",
    "particle_steps",
    "pair_interactions",
    "contact_updates",
    "peak_memory [B]",
    PENETRATION,
    WALL_GAP,
    "on_front_by_time",
    "on_front_by_work",
    "run",
    "message",
];

fn lines(study: &Study, all: &[Outcome], fronts: &Fronts, rows: &[usize]) -> String {
    let knobs = study.file.knobs.iter().map(|knob| knob.name.clone());
    let heads: Vec<String> = knobs.chain(HEADS.map(str::to_owned)).collect();
    let rows: Vec<Vec<String>> = (rows.iter())
        .map(|&row| cells(study, &all[row], fronts, row))
        .collect();
    texts(&heads, &rows)
}

fn cells(study: &Study, found: &Outcome, fronts: &Fronts, row: usize) -> Vec<String> {
    let chosen = study.file.knobs.iter().zip(&found.choice);
    let mut cells: Vec<String> = chosen
        .map(|(knob, &value)| knob.values[value].name.clone())
        .collect();
    let number = |x: Option<f64>| x.map_or("NaN".to_owned(), |x| format!("{x:?}"));
    let flag = |is: bool| u8::from(is).to_string();
    let Cost {
        wall_time,
        peak_memory,
        steps,
        particle_steps,
        pair_interactions,
        contact_updates,
        max_wall_penetration_over_spacing,
        wall_gap_over_spacing,
    } = found.cost;
    cells.extend([
        number(found.value),
        number(found.error),
        flag(found.is_stable),
        number(Some(wall_time)),
        number(Some(found.cost.work())),
        number(Some(steps)),
        number(Some(particle_steps)),
        number(Some(pair_interactions)),
        number(Some(contact_updates)),
        number(Some(peak_memory)),
        number(max_wall_penetration_over_spacing),
        number(wall_gap_over_spacing),
        flag(fronts.by_time.contains(&row)),
        flag(fronts.by_work.contains(&row)),
        found.key.clone(),
        found.message.clone(),
    ]);
    cells
}

/// Reads `trade.csv`. Rows with values no longer in the study are skipped.
///
/// # Errors
///
/// A message if the file cannot be read or is not a table of this study.
pub fn read(study: &StudyFile, path: &Path) -> Result<Vec<Outcome>, String> {
    let table = TextTable::read(path).map_err(|error| error.to_string())?;
    for knob in &study.knobs {
        table.place(&knob.name).map_err(|error| error.to_string())?;
    }
    let outcomes = table.rows().map(|row| outcome(study, &row));
    outcomes
        .filter_map(Result::transpose)
        .collect::<Result<_, _>>()
        .map_err(|error| error.to_string())
}

/// Outcome in a row; `None` where a value is no longer in the study.
fn outcome(study: &StudyFile, row: &TextRow<'_>) -> Result<Option<Outcome>, TableError> {
    let mut choice = Vec::new();
    for knob in &study.knobs {
        let text = row.text(&knob.name)?;
        let Some(place) = knob.values.iter().position(|value| value.name == text) else {
            return Ok(None);
        };
        choice.push(place);
    }
    let number = |head: &str| row.number(head);
    let if_there = |head: &str| number(head).ok().filter(|x| x.is_finite());
    Ok(Some(Outcome {
        choice,
        value: Some(number("value")?).filter(|x| x.is_finite()),
        error: Some(number("error [-]")?).filter(|x| x.is_finite()),
        is_stable: row.text("stable")? == "1",
        cost: Cost {
            wall_time: number("wall_time [s]")?,
            steps: number("steps")?,
            particle_steps: number("particle_steps")?,
            pair_interactions: number("pair_interactions")?,
            contact_updates: number("contact_updates")?,
            peak_memory: number("peak_memory [B]")?,
            max_wall_penetration_over_spacing: if_there(PENETRATION),
            wall_gap_over_spacing: if_there(WALL_GAP),
        },
        key: row.text("run")?.to_owned(),
        message: row.text("message")?.to_owned(),
    }))
}

/// Writes a file under a temporary name and renames it.
///
/// # Errors
///
/// The error of the operating system.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let temporary = path.with_extension("part");
    std::fs::write(&temporary, bytes)?;
    std::fs::rename(&temporary, path)
}

impl Planned {
    /// Its knob settings in readable form: `spacing 20 mm, kernel as it is`.
    pub fn label(&self, study: &Study) -> String {
        label(study, &self.choice)
    }
}

impl Skipped {
    /// Its knob settings in readable form, and why there is no such run.
    pub fn label(&self, study: &Study) -> String {
        let reason: Vec<&str> = self.reason.split_whitespace().collect();
        format!("{}: {}", label(study, &self.choice), reason.join(" "))
    }
}

fn label(study: &Study, choice: &[usize]) -> String {
    let chosen = study.file.knobs.iter().zip(choice);
    let each = chosen.map(|(knob, &value)| format!("{} {}", knob.name, knob.values[value].name));
    each.collect::<Vec<_>>().join(", ")
}
