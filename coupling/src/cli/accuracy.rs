//! `riprap run --error`: choice of settings for an error budget, and verification after the run.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::atomic::AtomicBool;

use serde::Serialize;

use super::trade::{means, spawn};
use super::{Exit, report_scene_error, say};
use crate::output::run_folder;
use crate::scene::parse::Override;
use crate::scene::resolve::Scene;
use crate::study::trade::budget::{Expected, candidates, choose};
use crate::study::trade::execute::{Progress, execute as run_all};
use crate::study::trade::file::{DesignFile, KnobFile, StudyFile, TruthFile, ValueFile};
use crate::study::trade::ladder::{Estimate, Rung, rows_for, rungs};
use crate::study::trade::outcome::Outcome;
use crate::study::trade::plan::{self, Planned, Study};
use crate::study::trade::reading::{Reading, reading};
use crate::study::trade::results::{along, collect, finest_run, judge, read};

/// Folder with studies of cases, in addition to the folder of the case.
const STUDIES: &str = "benches/trade";
/// Folder with the results of `riprap trade`.
const MEASURED: &str = "runs/trade";

/// A relative error, as `5%` or `0.05`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Budget(f64);

impl FromStr for Budget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is not an error budget; write 5% or 0.05");
        let value = match text.trim().strip_suffix('%') {
            Some(percent) => percent.trim().parse::<f64>().map(|p| p / 100.0),
            None => text.trim().parse::<f64>(),
        };
        let value = value.map_err(|_| wrong())?;
        if 0.0 < value && value < 1.0 {
            Ok(Self(value))
        } else {
            Err(wrong())
        }
    }
}

/// Accuracy requested of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked<'a> {
    pub(super) case: &'a Path,
    pub(super) budget: Budget,
    /// Quantity.
    pub(super) of: Option<&'a str>,
    /// Overrides of the user, which take precedence over the chosen ones.
    pub(super) overrides: &'a [Override],
    /// Folder of the run; coarse runs are in subfolders.
    pub(super) folder: &'a Path,
    /// Number of concurrent coarse runs.
    pub(super) jobs: Option<usize>,
}

/// Settings for a run, and the criterion of its evaluation.
#[derive(Debug)]
pub(super) struct Chosen {
    /// Chosen overrides, before those of the user.
    pub(super) overrides: Vec<Override>,
    report: Report,
    basis: Basis,
}

/// Source of a prediction.
#[derive(Debug)]
enum Basis {
    Study {
        path: PathBuf,
        file: StudyFile,
        known: Vec<Outcome>,
        choice: Vec<usize>,
    },
    Ladder {
        reading: Reading,
        /// Coarse to fine.
        rungs: [Rung; 3],
        spacing: f64,
    },
}

/// `accuracy.json`.
#[derive(Clone, Debug, Default, Serialize)]
struct Report {
    of: String,
    budget: f64,
    chosen_from: String,
    settings: Vec<String>,
    expected_error: f64,
    value: Option<f64>,
    /// Error against the reference value of the study.
    error: Option<f64>,
    /// Grid convergence index, or its substitute if the order was not observed.
    uncertainty: Option<f64>,
    observed_order: Option<f64>,
    budget_met: Option<bool>,
}

/// Chooses settings and reports them with the reason.
pub(super) fn plan(asked: &Asked, scene: &Scene, stop: &AtomicBool) -> Result<Chosen, Exit> {
    match study_of(asked) {
        Err(message) => {
            say(&format!("error: {message}"));
            Err(Exit::BadInput)
        }
        Ok(Some((path, file))) => from_study(asked, path, file),
        Ok(None) => from_ladder(asked, scene, stop),
    }
}

/// The study of the case with a name: that of its file or its output; by default the only one.
fn study_of(asked: &Asked) -> Result<Option<(PathBuf, StudyFile)>, String> {
    let case = asked.case.canonicalize().ok();
    let folder = asked.case.parent().unwrap_or(Path::new("."));
    let mut found = Vec::new();
    for folder in [folder, Path::new(STUDIES)] {
        let Ok(entries) = folder.read_dir() else {
            continue;
        };
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        paths.sort();
        let is_ron = |path: &PathBuf| path.extension().is_some_and(|end| end == "ron");
        for path in paths.into_iter().filter(is_ron) {
            // other files are scenes
            let Ok((file, _)) = plan::read(&path) else {
                continue;
            };
            let of = path.parent().map(|folder| folder.join(&file.case));
            if of.and_then(|of| of.canonicalize().ok()) == case {
                found.push((path, file));
            }
        }
    }
    let stem = |path: &Path| path.file_stem().map(|s| s.to_string_lossy().into_owned());
    match asked.of {
        Some(name) => {
            let is_meant = |(path, file): &(PathBuf, StudyFile)| {
                file.output.name == name || stem(path).as_deref() == Some(name)
            };
            Ok(found.into_iter().find(is_meant))
        }
        None if found.len() < 2 => Ok(found.pop()),
        None => {
            let names: Vec<String> = found.iter().filter_map(|(path, _)| stem(path)).collect();
            Err(format!(
                "the case has several studies: choose one with --of: {}",
                names.join(", ")
            ))
        }
    }
}

/// Results of a study, measured here or shipped with it.
fn measured(path: &Path, file: &StudyFile) -> Result<(PathBuf, Vec<Outcome>), String> {
    let name = path.file_stem().unwrap_or_default();
    let beside = path.parent().unwrap_or(Path::new(".")).join("results");
    let places = [Path::new(MEASURED), &beside].map(|folder| folder.join(name).join("trade.csv"));
    let Some(table) = places.iter().find(|place| place.is_file()) else {
        return Err(format!(
            "no results of {0} yet: run `riprap trade {0}`",
            path.display()
        ));
    };
    Ok((table.clone(), read(file, table)?))
}

fn from_study(asked: &Asked, path: PathBuf, file: StudyFile) -> Result<Chosen, Exit> {
    let (table, known) = measured(&path, &file).map_err(|message| {
        say(&format!("error: {message}"));
        Exit::BadInput
    })?;
    let Budget(budget) = asked.budget;
    let (expected, meets) = match choose(&file, &known, &candidates(&file, &known), budget) {
        Ok(expected) => (expected, true),
        Err(Some(best)) => (best, false),
        Err(None) => {
            say(&format!(
                "error: no run in {} has an error",
                table.display()
            ));
            return Err(Exit::BadInput);
        }
    };
    // frames and gauges are left to the user
    let of_study = file.set.iter().filter(|set| !set.starts_with("output."));
    let values = file.knobs.iter().zip(&expected.choice);
    let of_values = values.flat_map(|(knob, &value)| &knob.values[value].set);
    let settings: Vec<String> = of_study.chain(of_values).cloned().collect();
    let overrides = settings
        .iter()
        .map(|set| Override::from_str(set))
        .collect::<Result<Vec<Override>, String>>()
        .map_err(|message| {
            say(&format!("error: {}: {message}", path.display()));
            Exit::BadInput
        })?;
    say(&words_of_study(
        asked, &file, &known, &expected, meets, &table,
    ));
    Ok(Chosen {
        overrides,
        report: Report {
            of: file.output.name.clone(),
            budget,
            chosen_from: table.display().to_string(),
            settings,
            expected_error: expected.error,
            ..Report::default()
        },
        basis: Basis::Study {
            path,
            file,
            known,
            choice: expected.choice,
        },
    })
}

/// Report of the choice, its reason, and the effects that it neglects.
fn words_of_study(
    asked: &Asked,
    file: &StudyFile,
    known: &[Outcome],
    expected: &Expected,
    meets: bool,
    table: &Path,
) -> String {
    let Budget(budget) = asked.budget;
    let mut text = format!(
        "{} % of {}: {}, from the {} runs in {}",
        100.0 * budget,
        file.output.name,
        match meets {
            true => "the least work predicted to suffice",
            false => "OUT OF REACH of the study; the most accurate",
        },
        known.len(),
        table.display(),
    );
    let first = known
        .iter()
        .find(|found| found.choice.iter().all(|&v| v == 0));
    // other settings are those of the case or a preset
    let turned = file.knobs.iter().zip(&expected.choice);
    for (knob, &value) in turned.filter(|(_, value)| **value != 0) {
        let _ = write!(text, "\n  {:<32} {}", knob.name, knob.values[value].name);
    }
    let _ = write!(
        text,
        "\n  {} error {:.2} %, {:.2e} pair interactions{}",
        match expected.is_measured {
            true => "measured",
            false => "foretold, never run:",
        },
        100.0 * expected.error,
        expected.work,
        first.map_or(String::new(), |first| format!(
            ", {:.2} times those of the study's first settings",
            expected.work / first.cost.work()
        )),
    );
    for set in file.set.iter().filter(|set| !set.starts_with("output.")) {
        let _ = write!(text, "\n  as in the study: {set}");
    }
    for set in asked.overrides {
        let _ = write!(
            text,
            "\n  NOT in the study, by --set: {}={}",
            set.path, set.value
        );
    }
    text
}

fn from_ladder(asked: &Asked, scene: &Scene, stop: &AtomicBool) -> Result<Chosen, Exit> {
    let refused = |message: String| {
        say(&format!("error: {message}"));
        Exit::BadInput
    };
    let Some(fluid) = &scene.fluid else {
        return Err(refused(
            "a scene without water has no spacing to refine: write a study of it, see benches/trade/README.md".into(),
        ));
    };
    let reading = reading(asked.of, scene).map_err(refused)?;
    let Budget(budget) = asked.budget;
    let (depth, rows) = (
        fluid.lattice.depth,
        fluid.lattice.depth / fluid.lattice.spacing[2],
    );
    let rungs = rungs(rows).map(|rows| depth / rows);
    say(&format!(
        "{} % of {}: no study of this case has it; extrapolated from three coarse runs at {} m",
        100.0 * budget,
        reading.output.name,
        rungs.map(|s| format!("{s:.4}")).join(", ")
    ));
    let rungs = climb(asked, &reading, rungs, stop)?;
    let estimate = Estimate::of(rungs, reading.zero);
    let chosen = rows_for(&estimate, budget, depth, rows);
    let spacing = depth / chosen;
    let expected = estimate.error_at(spacing);
    say(&words_of_ladder(&estimate, &rungs, spacing, budget, rows));
    let resolution = format!("fluid.resolution=Spacing({spacing:?})");
    Ok(Chosen {
        overrides: Override::from_str(&resolution)
            .map_err(refused)
            .into_iter()
            .collect(),
        report: Report {
            of: reading.output.name.clone(),
            budget,
            chosen_from: asked.folder.join("ladder").display().to_string(),
            settings: vec![resolution],
            expected_error: expected,
            ..Report::default()
        },
        basis: Basis::Ladder {
            reading,
            rungs,
            spacing,
        },
    })
}

fn words_of_ladder(
    estimate: &Estimate,
    rungs: &[Rung; 3],
    spacing: f64,
    budget: f64,
    rows: f64,
) -> String {
    let values: Vec<String> = rungs
        .iter()
        .map(|rung| format!("{:.5} at {:.4} m", rung.value, rung.spacing))
        .collect();
    let order = match (estimate.order, estimate.limit) {
        (Some(order), Some(limit)) => format!("order {order:.2}, limit {limit:.5}"),
        _ => "no monotonic convergence: error from their largest difference".to_owned(),
    };
    let expected = estimate.error_at(spacing);
    let verdict = match expected <= budget * 1.0001 {
        true => "chosen".to_owned(),
        false => format!("OUT OF REACH of twice the scene's {rows:.0} rows; chosen"),
    };
    format!(
        "  {}\n  {order}\n  {verdict}: spacing {spacing:.4} m, expected error {:.2} % of the spacing alone; what the scheme \
         or the scene do wrong at any spacing is not in it",
        values.join(", "),
        100.0 * expected,
    )
}

/// Executes the three runs, coarse to fine.
fn climb(
    asked: &Asked,
    reading: &Reading,
    spacings: [f64; 3],
    stop: &AtomicBool,
) -> Result<[Rung; 3], Exit> {
    let value = |spacing: f64| ValueFile {
        name: format!("{spacing:.4}"),
        at: Some(spacing),
        set: vec![format!("fluid.resolution=Spacing({spacing:?})")],
    };
    let set = asked.overrides.iter();
    let file = StudyFile {
        title: format!("ladder of {}", reading.output.name),
        case: asked
            .case
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
        set: set
            .map(|set| format!("{}={}", set.path, set.value))
            .collect(),
        output: reading.output.clone(),
        truth: TruthFile::Finest {
            knob: "spacing".into(),
        },
        knobs: vec![KnobFile {
            name: "spacing".into(),
            values: spacings.map(value).to_vec(),
        }],
        design: DesignFile::OneAtATime,
    };
    let study = Study::of(file, asked.case, String::new()).map_err(|error| {
        report_scene_error(&error);
        Exit::BadInput
    })?;
    let folder = asked.folder.join("ladder");
    let runner = |run: &Planned, folder: &Path| spawn(asked.case, run, folder);
    let tell = |progress: Progress| say(&format!("  {} of {} runs", progress.ended, progress.all));
    let failed = |message: String| {
        say(&format!("error: {message}"));
        Exit::Failed
    };
    let ended = run_all(&study, &folder, means(asked.jobs), stop, &runner, &tell);
    if !ended.map_err(|error| failed(error.to_string()))? {
        return Err(Exit::Interrupted);
    }
    let all = collect(&study, &folder);
    let value = |k: usize| {
        let found = all.iter().find(|found| found.choice == [k]);
        found.and_then(|found| found.value).ok_or_else(|| {
            let message = found.map_or("it is gone", |found| &found.message);
            let name = &reading.output.name;
            failed(format!(
                "the run with {:.4} m has no {name}: {message}",
                spacings[k]
            ))
        })
    };
    let rung = |k: usize| {
        Ok(Rung {
            spacing: spacings[k],
            value: value(k)?,
        })
    };
    Ok([rung(0)?, rung(1)?, rung(2)?])
}

impl Chosen {
    /// Evaluates the run in a folder, writes `accuracy.json` and reports the result.
    pub(super) fn judge(mut self, scene: &Scene, folder: &Path) -> Result<String, String> {
        match &self.basis {
            Basis::Study {
                path,
                file,
                known,
                choice,
            } => {
                let named = file.output.block.as_ref();
                let is_meant =
                    |name: &String| scene.file.blocks.iter().position(|b| b.name == *name);
                let study_folder = path.parent().unwrap_or(Path::new("."));
                let (value, error) = judge(file, study_folder, named.and_then(is_meant), folder)?;
                let finest = finest_run(file, known).and_then(|found| found.value);
                let against_finest = value
                    .zip(finest)
                    .map(|(v, truth)| ((v - truth) / truth).abs());
                self.report.value = value;
                self.report.error = error.or(against_finest);
                let grid = grid_of_study(file, known, choice);
                self.report.uncertainty = grid.map(|(grid, spacing)| grid.error_at(spacing));
                self.report.observed_order = grid.and_then(|(grid, _)| grid.observed_order());
                self.report.budget_met = self.report.error.map(|e| e <= self.report.budget);
            }
            Basis::Ladder {
                reading,
                rungs,
                spacing,
            } => {
                let file = StudyFile {
                    title: String::new(),
                    case: String::new(),
                    set: Vec::new(),
                    output: reading.output.clone(),
                    truth: TruthFile::Finest {
                        knob: String::new(),
                    },
                    knobs: Vec::new(),
                    design: DesignFile::OneAtATime,
                };
                let (value, _) = judge(&file, Path::new("."), None, folder)?;
                let value = value.ok_or("the run has no value")?;
                let mut all = rungs.to_vec();
                all.push(Rung {
                    spacing: *spacing,
                    value,
                });
                all.sort_by(|a, b| b.spacing.total_cmp(&a.spacing));
                all.dedup_by(|a, b| (a.spacing / b.spacing - 1.0).abs() < 1e-6);
                let n = all.len();
                let estimate = Estimate::of([all[n - 3], all[n - 2], all[n - 1]], reading.zero);
                let uncertainty = estimate.error_at(*spacing);
                self.report.value = Some(value);
                self.report.uncertainty = Some(uncertainty);
                self.report.observed_order = estimate.observed_order();
                self.report.budget_met = Some(uncertainty <= self.report.budget);
            }
        }
        let path = folder.join(run_folder::ACCURACY);
        let text = serde_json::to_string_pretty(&self.report).map_err(|error| error.to_string())?;
        std::fs::write(&path, text + "\n")
            .map_err(|error| format!("cannot write {}: {error}", path.display()))?;
        Ok(self.report.words())
    }
}

/// The grid convergence of a study at its first values, by the three finest values of the knob that sets the resolution, and
/// the spacing of a choice (m).
fn grid_of_study(file: &StudyFile, known: &[Outcome], choice: &[usize]) -> Option<(Estimate, f64)> {
    let sets_resolution = |value: &ValueFile| {
        let mut sets = value.set.iter();
        sets.any(|set| set.starts_with("fluid.resolution="))
    };
    // presets may set it too, but have no numerical value
    let is_spacing = |knob: &KnobFile| {
        let mut values = knob.values.iter();
        values.all(|value| value.at.is_some()) && knob.values.iter().any(sets_resolution)
    };
    let k = file.knobs.iter().position(is_spacing)?;
    let spacing = file.knobs[k].values[choice[k]].at?;
    let mut rungs: Vec<Rung> = along(known, k)
        .filter_map(|found| {
            Some(Rung {
                spacing: file.knobs[k].values[found.choice[k]].at?,
                value: found.value?,
            })
        })
        .collect();
    rungs.sort_by(|a, b| b.spacing.total_cmp(&a.spacing));
    let n = rungs.len();
    // the scale of errors is measured from there
    let zero = match &file.truth {
        TruthFile::Value { value, scale, .. } => scale.map(|scale| value - scale),
        TruthFile::Closed { form, scale } => scale.map(|scale| form.value() - scale),
        TruthFile::Record { .. } | TruthFile::Finest { .. } => None,
    };
    let zero = zero.unwrap_or(0.0);
    (3 <= n).then(|| {
        let finest = [rungs[n - 3], rungs[n - 2], rungs[n - 1]];
        (Estimate::of(finest, zero), spacing)
    })
}

impl Report {
    fn words(&self) -> String {
        let percent = |x: f64| format!("{:.2} %", 100.0 * x);
        let mut text = format!("{}:", self.of);
        if let Some(value) = self.value {
            let _ = write!(text, " {value:.6}");
        }
        if let Some(error) = self.error {
            let _ = write!(
                text,
                ", error {} against the study's reference value",
                percent(error)
            );
        }
        if let Some(uncertainty) = self.uncertainty {
            let how = match self.observed_order {
                Some(order) => format!("grid convergence index, order {order:.2}"),
                None => "no order observed, safety factor 3".to_owned(),
            };
            let _ = write!(
                text,
                ", discretization uncertainty {} ({how})",
                percent(uncertainty)
            );
        }
        let verdict = match self.budget_met {
            Some(true) => "met",
            Some(false) => "NOT met",
            None => "unknown",
        };
        let _ = write!(text, "; budget of {} {verdict}", percent(self.budget));
        text
    }
}
