//! Charts of falling blocks: bounce heights and run-out.

use crate::picture::overview::{Chart, Record};

/// Envelope of the heights above ground over the horizontal distance, and the heights exceeded by 10 % and
/// 50 % of the blocks.
pub(super) fn bounce_heights(heights: &[(f64, Vec<f64>)]) -> Chart {
    // NaN, where no block passed, is a gap
    let passed_by = |share: f64| -> Vec<f64> {
        let rank = |heights: &Vec<f64>| {
            let place = ((1.0 - share) * heights.len() as f64) as usize;
            let place = place.min(heights.len().saturating_sub(1));
            heights.get(place).copied().unwrap_or(f64::NAN)
        };
        heights.iter().map(|(_, heights)| rank(heights)).collect()
    };
    let curve = |name: &str, share: f64| Record {
        name: name.to_owned(),
        unit: "m".to_owned(),
        time: heights.iter().map(|(distance, _)| *distance).collect(),
        value: passed_by(share),
        ..Record::default()
    };
    Chart {
        label: "bounce height".to_owned(),
        along: "horizontal distance from the start [m]".to_owned(),
        curves: vec![
            curve("highest", 0.0),
            curve("one in ten above", 0.1),
            curve("half above", 0.5),
        ],
    }
}

/// Cumulative distribution of the run-out, as a step function.
pub(super) fn reached(run_outs: &[f64]) -> Chart {
    let n = run_outs.len() as f64;
    let steps = (0..).zip(run_outs);
    let mut stair = Record {
        name: "blocks".to_owned(),
        unit: String::new(),
        time: vec![0.0],
        value: vec![0.0],
        ..Record::default()
    };
    for (k, &run_out) in steps {
        stair.time.extend([run_out, run_out]);
        stair.value.extend([f64::from(k) / n, f64::from(k + 1) / n]);
    }
    Chart {
        label: "share of blocks".to_owned(),
        along: "went no farther than [m]".to_owned(),
        curves: vec![stair],
    }
}
