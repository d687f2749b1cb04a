//! Evaluation of a run against its error budget.

use std::fmt::Write as _;
use std::path::Path;

use serde::Serialize;

use super::{Basis, Chosen};
use crate::output::run_folder;
use crate::scene::resolve::Scene;
use crate::study::trade::file::{DesignFile, KnobFile, StudyFile, TruthFile, ValueFile};
use crate::study::trade::outcome::Outcome;
use crate::study::trade::refinement::{Estimate, Level};
use crate::study::trade::results::{along, finest_run, judge};

/// `accuracy.json`.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Report {
    pub of: String,
    pub budget: f64,
    pub chosen_from: String,
    pub settings: Vec<String>,
    pub expected_error: f64,
    pub value: Option<f64>,
    /// Error against the reference value of the study.
    pub error: Option<f64>,
    /// Grid convergence index, or its substitute if the order was not observed.
    pub uncertainty: Option<f64>,
    pub observed_order: Option<f64>,
    pub budget_met: Option<bool>,
}

impl Chosen {
    /// Evaluates the run in a folder, writes `accuracy.json` and reports the result.
    pub(in crate::cli) fn judge(mut self, scene: &Scene, folder: &Path) -> Result<String, String> {
        match &self.basis {
            Basis::Study {
                path,
                file,
                known,
                choice,
            } => {
                let named = file.output.block.as_ref();
                let is_meant =
                    |name: &String| scene.block_names.iter().position(|other| other == name);
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
            Basis::Refinement {
                reading,
                levels,
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
                let mut all = levels.to_vec();
                all.push(Level {
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
    let mut levels: Vec<Level> = along(known, k)
        .filter_map(|found| {
            Some(Level {
                spacing: file.knobs[k].values[found.choice[k]].at?,
                value: found.value?,
            })
        })
        .collect();
    levels.sort_by(|a, b| b.spacing.total_cmp(&a.spacing));
    let n = levels.len();
    // the scale of errors is measured from there
    let zero = match &file.truth {
        TruthFile::Value { value, scale, .. } => scale.map(|scale| value - scale),
        TruthFile::Closed { form, scale } => scale.map(|scale| form.value() - scale),
        TruthFile::Record { .. } | TruthFile::Finest { .. } => None,
    };
    let zero = zero.unwrap_or(0.0);
    (3 <= n).then(|| {
        let finest = [levels[n - 3], levels[n - 2], levels[n - 1]];
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
