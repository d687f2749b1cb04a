//! Which settings of a study meet an error budget with the least work.
//!
//! What was measured is known. What was not is foretold: each knob is taken to change work and error by the factors that it
//! has when it is turned alone, or by the power law through its other values where that run is missing. Nothing is promised
//! to be better than the best that was measured: a factor found where an error passes through zero foretells too much.

use super::file::StudyFile;
use super::front::PowerLaw;
use super::results::Found;

/// Kept of the budget for what was measured: another build or machine may draw another run of water that is not calm.
const MARGIN_OF_MEASURED: f64 = 1.1;
/// Kept of the budget for what is foretold; measured on the shipped studies, see `tests/coupling/budget.rs`.
const MARGIN_OF_FORETOLD: f64 = 2.0;
/// Values of a knob through which a power law says something.
const LEAST_FOR_LAW: usize = 3;

/// What is expected of settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Which value of each knob.
    pub choice: Vec<usize>,
    /// Relative.
    pub error: f64,
    /// Pair interactions, a contact as a thousand.
    pub work: f64,
    /// Whether a run has shown it.
    pub is_measured: bool,
}

impl Expected {
    /// What the error may be after all.
    fn bound(&self) -> f64 {
        self.error
            * match self.is_measured {
                true => MARGIN_OF_MEASURED,
                false => MARGIN_OF_FORETOLD,
            }
    }
}

/// The candidate with the least work whose error is expected within the budget, margins kept; else, as an error, the one
/// with the least error. None of either where nothing is known of any.
///
/// # Errors
///
/// The best there is, where it does not meet the budget.
pub fn choose(
    study: &StudyFile,
    known: &[Found],
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

/// What was run, and what is one change of a knob away from it.
pub fn candidates(study: &StudyFile, known: &[Found]) -> Vec<Vec<usize>> {
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

/// What is expected of settings, if anything.
fn expect(study: &StudyFile, known: &[Found], choice: &[usize]) -> Option<Expected> {
    if let Some(found) = known.iter().find(|found| found.choice == choice) {
        let error = found.error.filter(|_| found.is_stable)?;
        return Some(Expected {
            choice: choice.to_vec(),
            error,
            work: found.cost.work(),
            is_measured: true,
        });
    }
    let base = alone(known, &vec![0; choice.len()])?;
    let turned = (0..choice.len()).filter(|&k| choice[k] != 0);
    let mut foretold = base;
    for k in turned {
        let mut single = vec![0; choice.len()];
        single[k] = choice[k];
        let [error, work] = match known.iter().any(|found| found.choice == single) {
            true => alone(known, &single)?,
            false => by_law(study, known, k, choice[k])?,
        };
        foretold = [foretold[0] * error / base[0], foretold[1] * work / base[1]];
    }
    let best = known
        .iter()
        .filter(|found| found.is_stable)
        .filter_map(|found| found.error)
        .fold(f64::INFINITY, f64::min);
    Some(Expected {
        choice: choice.to_vec(),
        error: foretold[0].max(best),
        work: foretold[1],
        is_measured: false,
    })
    .filter(|expected| expected.error.is_finite() && expected.work.is_finite())
}

/// Error and work of a run that was made and reached its end.
fn alone(known: &[Found], choice: &[usize]) -> Option<[f64; 2]> {
    let found = known.iter().find(|found| found.choice == choice)?;
    let error = found.error.filter(|_| found.is_stable)?;
    Some([error, found.cost.work()])
}

/// Error and work of a value of a knob by the power laws through its other values, between these.
fn by_law(study: &StudyFile, known: &[Found], knob: usize, value: usize) -> Option<[f64; 2]> {
    let values = &study.knobs[knob].values;
    let at = values[value].at?;
    let points: Vec<(f64, [f64; 2])> = (0..values.len())
        .filter_map(|value| {
            let mut single = vec![0; study.knobs.len()];
            single[knob] = value;
            Some((values[value].at?, alone(known, &single)?))
        })
        .collect();
    let is_between = points.iter().any(|(x, _)| *x < at) && points.iter().any(|(x, _)| at < *x);
    if points.len() < LEAST_FOR_LAW || !is_between {
        return None;
    }
    let law = |which: usize| PowerLaw::fit(points.iter().map(|(x, y)| (*x, y[which])));
    Some([law(0)?.at(at), law(1)?.at(at)])
}
