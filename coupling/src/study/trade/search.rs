//! Search near the Pareto front: selection of the next combinations of knobs.
//!
//! The search starts with one knob at a time. The factors of work and error of each value are assumed independent of the
//! other knobs; from every run on the front, each change of one knob is then a candidate with predicted work and error.
//! The candidates predicted to advance the front most are run, a few at a time, and the front is updated.
//! Work is counted in pair interactions and contacts, so that the same runs are chosen on any machine under any load.

use std::collections::BTreeSet;

use super::front::{Point, front};
use super::outcome::{Cost, Outcome, point};

/// Runs chosen at once: constant, so that the number of cores does not change the search.
const BATCH: usize = 4;

/// Floor of errors, so that their logarithm is finite.
const LEAST_ERROR: f64 = 1e-9;

/// Logarithms of work and error.
type Logs = [f64; 2];

/// The next combinations, at most `left`, for knobs with the given numbers of values; empty when every change of one
/// knob from the front was run or is among those that are impossible.
pub fn next(
    n_values: &[usize],
    all: &[Outcome],
    impossible: &BTreeSet<&[usize]>,
    left: usize,
) -> Vec<Vec<usize>> {
    let points: Vec<Point> = all.iter().map(|found| point(found, Cost::work)).collect();
    let logs: Vec<Option<Logs>> = points.iter().map(logarithms).collect();
    let mut known: BTreeSet<&[usize]> = all.iter().map(|found| found.choice.as_slice()).collect();
    known.extend(impossible);
    let alone = |knob: usize, value: usize| {
        let is = |found: &Outcome| {
            let mut others = found.choice.iter().enumerate();
            others.all(|(k, &v)| v == if k == knob { value } else { 0 })
        };
        all.iter().position(is).and_then(|k| logs[k])
    };
    let on_front = front(&points);
    let fronts: Vec<Logs> = on_front.iter().filter_map(|&k| logs[k]).collect();
    let mut candidates: Vec<(f64, Vec<usize>)> = Vec::new();
    for &from in &on_front {
        let Some(at) = logs[from] else { continue };
        for (knob, &n) in n_values.iter().enumerate() {
            let now = all[from].choice[knob];
            for value in (0..n).filter(|&value| value != now) {
                let mut choice = all[from].choice.clone();
                choice[knob] = value;
                let Some((old, new)) = alone(knob, now).zip(alone(knob, value)) else {
                    continue;
                };
                let predicted: Logs = std::array::from_fn(|k| at[k] + new[k] - old[k]);
                let gain = gain(&fronts, &predicted);
                match candidates.iter_mut().find(|(_, other)| *other == choice) {
                    Some((most, _)) => *most = most.max(gain),
                    None if known.contains(choice.as_slice()) => {}
                    None => candidates.push((gain, choice)),
                }
            }
        }
    }
    candidates.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    let chosen = candidates.into_iter().take(BATCH.min(left));
    chosen.map(|(_, choice)| choice).collect()
}

fn logarithms(point: &Point) -> Option<Logs> {
    let is_measured = point.cost.is_finite() && 0.0 < point.cost && point.error.is_finite();
    is_measured.then(|| [point.cost.ln(), point.error.max(LEAST_ERROR).ln()])
}

/// Distance of a point ahead of a front: minimum over its members of the largest improvement in one coordinate;
/// negative behind it.
fn gain(front: &[Logs], place: &Logs) -> f64 {
    front
        .iter()
        .map(|member| (member[0] - place[0]).max(member[1] - place[1]))
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run whose work and error are products over its knobs; doubling `a` or `b` costs the same, but `b` reduces the error more.
    fn found(choice: &[usize]) -> Outcome {
        let (a, b) = (choice[0] as f64, choice[1] as f64);
        Outcome {
            choice: choice.to_vec(),
            key: String::new(),
            value: None,
            error: Some(0.1 * 0.7_f64.powf(a) * 0.4_f64.powf(b)),
            is_stable: true,
            message: String::new(),
            cost: Cost {
                pair_interactions: 1e6 * 2_f64.powf(a + b),
                ..Cost::default()
            },
        }
    }

    #[test]
    fn the_search_finds_the_front_of_the_full_grid() {
        let n_values = [4, 4];
        let grid = (0..4).flat_map(|a| (0..4).map(move |b| [a, b]));
        let full: Vec<Outcome> = grid.map(|choice| found(&choice)).collect();
        let points: Vec<Point> = full.iter().map(|f| point(f, Cost::work)).collect();
        let best: BTreeSet<Vec<usize>> = front(&points)
            .into_iter()
            .map(|k| full[k].choice.clone())
            .collect();
        let mut all: Vec<Outcome> = [[0, 0], [1, 0], [2, 0], [3, 0], [0, 1], [0, 2], [0, 3]]
            .map(|choice| found(&choice))
            .to_vec();
        // seven single changes, and the three beyond the most expensive value of the better knob
        let more = next(&n_values, &all, &BTreeSet::new(), 4);
        all.extend(more.iter().map(|choice| found(choice)));
        let ran: BTreeSet<Vec<usize>> = all.iter().map(|f| f.choice.clone()).collect();
        assert_eq!(best.len(), 7);
        assert!(best.is_subset(&ran), "{best:?} {ran:?}");
    }

    #[test]
    fn it_ends_when_all_near_the_front_was_run() {
        let all: Vec<Outcome> = [[0, 0], [0, 1], [1, 0], [1, 1]]
            .map(|choice| found(&choice))
            .to_vec();
        let (none, no_impossible) = (Vec::<Vec<usize>>::new(), BTreeSet::new());
        assert_eq!(next(&[2, 2], &all, &no_impossible, 4), none);
        assert_eq!(next(&[2, 2], &all[..3], &no_impossible, 4), [[1, 1]]);
        assert_eq!(next(&[2, 2], &all[..3], &no_impossible, 0), none);
        let impossible = BTreeSet::from([&[1, 1][..]]);
        assert_eq!(next(&[2, 2], &all[..3], &impossible, 4), none);
    }

    #[test]
    fn what_did_not_reach_its_end_leads_nowhere() {
        let mut all: Vec<Outcome> = [[0, 0], [0, 1], [1, 0]]
            .map(|choice| found(&choice))
            .to_vec();
        all[1].is_stable = false;
        assert_eq!(
            next(&[2, 2], &all, &BTreeSet::new(), 4),
            Vec::<Vec<usize>>::new()
        );
    }
}
