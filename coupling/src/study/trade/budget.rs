//! Settings of a study that meet an error budget with the least work.
//!
//! Measured settings are known. Others are predicted from the nearest run b, the most accurate of those that differ in
//! the fewest knobs, and from the runs in which a single knob is changed:
//!
//! ```text
//! work    w = w_b Π wₖ/wₖ'                                    k the knobs that differ, ' their values in b
//! error   e = max(|d_b + Σ Δₖ|, |d_b| Π max(1, |dₖ/dₖ'|))      Δₖ = dₖ − dₖ', deviations with signs
//!           + ½ (Σ |Δₖ| − max |Δₖ|) + ⅕ |d_b − d₀| + ½ |step between the neighbors of what is interpolated|
//! ```
//! Deviations of different origin add, those of one origin multiply: the larger counts. An improvement is trusted only
//! for b itself, with a margin of a fifth of its gain over the first settings, which may be due to canceling deviations.

use super::file::{StudyFile, TruthFile};
use super::outcome::Outcome;
use super::results::finest_run;

/// Margin of the budget for measured settings: on another build or machine agitated water gives another realization.
const MARGIN_OF_MEASURED: f64 = 1.1;
/// Margin of the budget for predicted settings; measured on the shipped studies, see `tests/coupling/budget.rs`.
const MARGIN_OF_PREDICTED: f64 = 1.4;
/// Margin on the gain of the nearest run over the first settings.
const DOUBT_OF_GAIN: f64 = 0.2;
/// Floor of deviations in divisions; –.
const LEAST_DEVIATION: f64 = 1e-4;
/// Predicted error and work of settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Index of the value of each knob.
    pub choice: Vec<usize>,
    /// Relative error.
    pub error: f64,
    /// Work in pair interactions; a contact counts as a thousand.
    pub work: f64,
    /// Whether it was measured by a run.
    pub is_measured: bool,
}

impl Expected {
    /// Upper bound of the predicted error.
    fn bound(&self) -> f64 {
        self.error
            * match self.is_measured {
                true => MARGIN_OF_MEASURED,
                false => MARGIN_OF_PREDICTED,
            }
    }
}

/// The candidate with the least work whose error is expected within the budget, margins kept; else, as an error, the one
/// with the least error, or `None` without any prediction.
///
/// # Errors
///
/// The best candidate, if it does not meet the budget.
pub fn choose(
    study: &StudyFile,
    known: &[Outcome],
    candidates: &[Vec<usize>],
    budget: f64,
) -> Result<Expected, Option<Expected>> {
    let all: Vec<Expected> = candidates
        .iter()
        .filter_map(|choice| expect(study, known, choice))
        .collect();
    let meets = all.iter().filter(|one| one.bound() <= budget);
    match meets.min_by(|a, b| a.work.total_cmp(&b.work)) {
        Some(found) => Ok(found.clone()),
        None => Err(all
            .into_iter()
            .min_by(|a, b| a.bound().total_cmp(&b.bound()))),
    }
}

/// Settings that were run, and those that differ from them in one knob.
pub fn candidates(study: &StudyFile, known: &[Outcome]) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = known.iter().map(|found| found.choice.clone()).collect();
    for found in known {
        for (k, knob) in study.knobs.iter().enumerate() {
            for value in 0..knob.values.len() {
                let mut choice = found.choice.clone();
                choice[k] = value;
                all.push(choice);
            }
        }
    }
    all.sort();
    all.dedup();
    all
}

/// Predicted error and work of settings, where a prediction is possible.
pub fn expect(study: &StudyFile, known: &[Outcome], choice: &[usize]) -> Option<Expected> {
    if let Some(found) = known.iter().find(|found| found.choice == choice) {
        let error = found.error.filter(|_| found.is_stable)?;
        return Some(Expected {
            choice: choice.to_vec(),
            error,
            work: found.cost.work(),
            is_measured: true,
        });
    }
    let first = alone(study, known, &vec![0; choice.len()])?;
    let nearest = nearest(known, choice)?;
    let base = alone(study, known, nearest)?;
    let (mut sum, mut product, mut work) = (base.deviation, base.deviation.abs(), base.work);
    let (mut all, mut largest) = (0.0, 0.0_f64);
    let mut doubt = DOUBT_OF_GAIN * (base.deviation - first.deviation).abs();
    for k in (0..choice.len()).filter(|&k| choice[k] != nearest[k]) {
        let (old, new) = (
            turned(study, known, k, nearest[k])?,
            turned(study, known, k, choice[k])?,
        );
        let change = new.deviation - old.deviation;
        sum += change;
        product *= (new.deviation / old.deviation.abs().max(LEAST_DEVIATION))
            .abs()
            .max(1.0);
        work *= new.work / old.work;
        doubt += old.doubt + new.doubt;
        all += change.abs();
        largest = largest.max(change.abs());
    }
    Some(Expected {
        choice: choice.to_vec(),
        error: sum.abs().max(product) + 0.5 * (all - largest) + doubt,
        work,
        is_measured: false,
    })
    .filter(|expected| expected.error.is_finite() && expected.work.is_finite())
}

/// The most accurate of the complete runs that differ in the fewest knobs.
fn nearest<'a>(known: &'a [Outcome], choice: &[usize]) -> Option<&'a [usize]> {
    let distance = |found: &Outcome| {
        let pairs = found.choice.iter().zip(choice);
        pairs.filter(|(a, b)| a != b).count()
    };
    known
        .iter()
        .filter(|found| found.is_stable)
        .filter_map(|found| Some((distance(found), found.error?, found.choice.as_slice())))
        .min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)))
        .map(|(_, _, choice)| choice)
}

/// Effect of a value of a knob, the others at their first values.
fn turned(study: &StudyFile, known: &[Outcome], knob: usize, value: usize) -> Option<Alone> {
    let mut single = vec![0; study.knobs.len()];
    single[knob] = value;
    match known.iter().any(|found| found.choice == single) {
        true => alone(study, known, &single),
        false => between(study, known, knob, value),
    }
}

/// Effect of changing one knob alone.
#[derive(Clone, Copy, Debug)]
struct Alone {
    /// Error with the sign of value less truth, where both are numbers.
    deviation: f64,
    /// Uncertainty of the deviation.
    doubt: f64,
    work: f64,
}

/// Effect measured by a complete run.
fn alone(study: &StudyFile, known: &[Outcome], choice: &[usize]) -> Option<Alone> {
    let found = known.iter().find(|found| found.choice == choice)?;
    let error = found.error.filter(|_| found.is_stable)?;
    let truth = match &study.truth {
        TruthFile::Value { value, .. } => Some(*value),
        TruthFile::Closed { form, .. } => Some(form.value()),
        TruthFile::Finest { .. } => finest_run(study, known).and_then(|found| found.value),
        TruthFile::Record { .. } => None,
    };
    let sign = truth
        .zip(found.value)
        .map_or(1.0, |(truth, value)| (value - truth).signum());
    Some(Alone {
        deviation: sign * error,
        doubt: 0.0,
        work: found.cost.work(),
    })
}

/// Effect of a numerical value between its neighbors that were run; linear in its logarithm.
fn between(study: &StudyFile, known: &[Outcome], knob: usize, value: usize) -> Option<Alone> {
    let values = &study.knobs[knob].values;
    let at = values[value].at?;
    let points = || {
        (0..values.len()).filter_map(|value| {
            let mut single = vec![0; study.knobs.len()];
            single[knob] = value;
            Some((values[value].at?, alone(study, known, &single)?))
        })
    };
    let below = points().filter(|(x, _)| *x < at);
    let (x0, low) = below.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let above = points().filter(|(x, _)| at < *x);
    let (x1, high) = above.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let share = (at / x0).ln() / (x1 / x0).ln();
    Some(Alone {
        deviation: low.deviation + share * (high.deviation - low.deviation),
        doubt: 0.5 * (high.deviation - low.deviation).abs(),
        work: low.work * (high.work / low.work).powf(share),
    })
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;
    use crate::study::trade::file::{DesignFile, KnobFile, OutputFile, ValueFile};
    use crate::study::trade::outcome::Cost;

    /// A knob that makes the work two and a half times less and one that takes most of the error; the truth is 1.
    fn study() -> StudyFile {
        let knob = |name: &str, at: &[f64]| KnobFile {
            name: name.into(),
            values: at
                .iter()
                .map(|&at| ValueFile {
                    name: at.to_string(),
                    at: Some(at),
                    set: Vec::new(),
                })
                .collect(),
        };
        StudyFile {
            title: String::new(),
            case: String::new(),
            set: Vec::new(),
            output: OutputFile {
                name: String::new(),
                file: String::new(),
                column: String::new(),
                block: None,
                take: None,
            },
            truth: TruthFile::Value {
                value: 1.0,
                scale: None,
                source: String::new(),
            },
            knobs: vec![knob("a", &[1.0, 2.0, 4.0]), knob("b", &[0.0, 1.0])],
            design: DesignFile::OneAtATime,
        }
    }

    fn found(choice: [usize; 2], value: f64, work: f64) -> Outcome {
        Outcome {
            choice: choice.to_vec(),
            key: String::new(),
            value: Some(value),
            error: Some((value - 1.0).abs()),
            is_stable: true,
            message: String::new(),
            cost: Cost {
                pair_interactions: work,
                ..Cost::default()
            },
        }
    }

    #[test]
    fn deviations_add_and_work_multiplies() {
        let known = [
            found([0, 0], 1.10, 1000.0),
            found([2, 0], 1.15, 400.0),
            found([0, 1], 1.02, 1500.0),
        ];
        let expected = expect(&study(), &known, &[2, 1]).unwrap();
        // from the better one, 0.02: 0.02 + 0.05 by their sum, more than 0.02 x 1.5; and a fifth of the 0.08 that it has won
        assert!((expected.error - 0.086).abs() < 1e-12, "{expected:?}");
        assert!((expected.work - 600.0).abs() < 1e-9, "{expected:?}");
        // half way over the logarithm, and half of the step in doubt
        let between = expect(&study(), &known, &[1, 0]).unwrap();
        assert!((between.error - 0.15).abs() < 1e-12, "{between:?}");
        assert!((between.work - (1000.0_f64 * 400.0).sqrt()).abs() < 1e-9);
        assert!(!between.is_measured);
    }

    #[test]
    fn the_least_work_within_the_budget_is_chosen_or_the_best_is_told() {
        let known = [
            found([0, 0], 1.10, 1000.0),
            found([2, 0], 1.15, 400.0),
            found([0, 1], 1.02, 1500.0),
        ];
        let all = candidates(&study(), &known);
        assert_eq!(all.len(), 6);
        let chosen = |budget: f64| choose(&study(), &known, &all, budget);
        assert_eq!(chosen(0.2).unwrap().choice, [2, 0]);
        assert_eq!(chosen(0.05).unwrap().choice, [0, 1]);
        assert_eq!(chosen(0.01).unwrap_err().unwrap().choice, [0, 1]);
        assert_eq!(choose(&study(), &[], &all, 0.1), Err(None));
    }
}
