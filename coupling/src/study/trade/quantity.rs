//! Quantity of a study, evaluated from a record of a run.

use nalgebra::{Matrix4, Vector4};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::compare::Series;

/// Evaluation of a column. A record that is too short or contains only gaps has no value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Take {
    /// Time mean over a window.
    Mean {
        /// Its start; s.
        from: f64,
        /// Its end; s.
        to: f64,
    },
    /// Largest value in a window.
    Maximum {
        /// Its start; s.
        from: f64,
        /// Its end; s.
        to: f64,
    },
    /// Smallest value in a window.
    Minimum {
        /// Its start; s.
        from: f64,
        /// Its end; s.
        to: f64,
    },
    /// Largest minus smallest value in a window, such as a wave height.
    Height {
        /// Its start; s.
        from: f64,
        /// Its end; s.
        to: f64,
    },
    /// `At(t)`: value at a time, linearly interpolated; s.
    At(f64),
    /// Change over a window divided by its length, such as the speed of a front; unit of the record, 1/s.
    Rate {
        /// Its start; s.
        from: f64,
        /// Its end; s.
        to: f64,
    },
    /// Height, from trough to crest, of the best-fit sine with a given period; the mean may drift.
    Harmonic {
        /// s.
        period: f64,
        /// Start of the window; s.
        from: f64,
        /// Its end; s.
        to: f64,
    },
    /// Time at which the record first reaches a level from below, linearly interpolated; s.
    Arrival {
        /// In the unit of the column.
        level: f64,
    },
    /// First crest above a level: the highest value before the record falls to half of that height.
    FirstCrest {
        /// Level at rest, in the unit of the column.
        level: f64,
    },
    /// Mean time between upward crossings of a level; s.
    Period {
        /// In the unit of the column.
        level: f64,
        /// Start of the evaluation; s.
        from: f64,
    },
}

impl Take {
    /// The value; `None` if the record is too short, contains only gaps, or has no crest.
    pub fn of(&self, series: &Series) -> Option<f64> {
        if let Self::Mean { from, to }
        | Self::Maximum { from, to }
        | Self::Minimum { from, to }
        | Self::Height { from, to }
        | Self::Harmonic { from, to, .. } = *self
            && !covers(series, from, to)
        {
            return None;
        }
        match *self {
            Self::Mean { from, to } => mean(series, from, to),
            Self::Maximum { from, to } => extreme(series, from, to, f64::max),
            Self::Minimum { from, to } => extreme(series, from, to, f64::min),
            Self::Height { from, to } => {
                let (high, low) = (
                    extreme(series, from, to, f64::max)?,
                    extreme(series, from, to, f64::min)?,
                );
                Some(high - low)
            }
            Self::Harmonic { period, from, to } => harmonic(series, period, from, to),
            Self::At(time) => series.at(time),
            Self::Rate { from, to } => {
                Some((series.at(to)? - series.at(from)?) / (to - from)).filter(|r| r.is_finite())
            }
            Self::Arrival { level } => arrival(series, level),
            Self::FirstCrest { level } => first_crest(series, level),
            Self::Period { level, from } => period(series, level, from),
        }
    }
}

/// Whether a record covers a window, up to one sampling interval: a run that ended early has no mean over a later
/// window.
fn covers(series: &Series, from: f64, to: f64) -> bool {
    let Some((first, last)) = series.time.first().zip(series.time.last()) else {
        return false;
    };
    let interval = (last - first) / series.time.len() as f64;
    first - interval <= from && to <= last + interval
}

/// By the trapezoidal rule between finite samples, so that uneven sampling has no effect.
fn mean(series: &Series, from: f64, to: f64) -> Option<f64> {
    let inside = series.within(Some((from, to)));
    let samples: Vec<(f64, f64)> = inside.samples().filter(|(_, v)| v.is_finite()).collect();
    let (first, last) = samples.first().zip(samples.last())?;
    let length = last.0 - first.0;
    let area: f64 = samples
        .windows(2)
        .map(|pair| 0.5 * (pair[0].1 + pair[1].1) * (pair[1].0 - pair[0].0))
        .sum();
    (0.0 < length).then(|| area / length)
}

fn extreme(series: &Series, from: f64, to: f64, better: fn(f64, f64) -> f64) -> Option<f64> {
    let inside = series.within(Some((from, to)));
    let values = inside.value.into_iter().filter(|v| v.is_finite());
    values.reduce(better)
}

/// By least squares of mean, drift, cosine and sine.
fn harmonic(series: &Series, period: f64, from: f64, to: f64) -> Option<f64> {
    let inside = series.within(Some((from, to)));
    let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for (t, v) in inside.samples().filter(|(_, v)| v.is_finite()) {
        let (sin, cos) = (std::f64::consts::TAU * t / period).sin_cos();
        let row = Vector4::new(1.0, (t - from) / period, cos, sin);
        normal += row * row.transpose();
        right += row * v;
    }
    let fitted = normal.cholesky()?.solve(&right);
    Some(2.0 * fitted[2].hypot(fitted[3]))
}

fn arrival(series: &Series, level: f64) -> Option<f64> {
    let samples: Vec<(f64, f64)> = series.samples().filter(|(_, v)| v.is_finite()).collect();
    let k = samples.iter().position(|(_, v)| level <= *v)?;
    let Some(before) = k.checked_sub(1) else {
        return Some(samples[k].0);
    };
    let ((t, v), (u, w)) = (samples[before], samples[k]);
    Some(t + (u - t) * (level - v) / (w - v))
}

fn first_crest(series: &Series, level: f64) -> Option<f64> {
    let mut best: Option<f64> = None;
    for height in series.value.iter().map(|v| v - level) {
        // a gap is neither higher nor lower
        if best.is_none_or(|best| best < height) && 0.0 < height {
            best = Some(height);
        } else if best.is_some_and(|best| height < 0.5 * best) {
            return best;
        }
    }
    // a crest that has not passed yet may still grow
    None
}

fn period(series: &Series, level: f64, from: f64) -> Option<f64> {
    let samples: Vec<(f64, f64)> = series
        .samples()
        .filter(|(t, v)| from <= *t && v.is_finite())
        .map(|(t, v)| (t, v - level))
        .collect();
    let risings: Vec<f64> = samples
        .windows(2)
        .filter(|pair| pair[0].1 < 0.0 && 0.0 <= pair[1].1)
        .map(|pair| {
            let ((t0, v0), (t1, v1)) = (pair[0], pair[1]);
            t0 - v0 * (t1 - t0) / (v1 - v0)
        })
        .collect();
    let (first, last) = risings.first().zip(risings.last())?;
    let n = risings.len() - 1;
    (0 < n).then(|| (last - first) / n as f64)
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;

    fn series(value: impl Fn(f64) -> f64) -> Series {
        let time: Vec<f64> = (0..=400).map(|k| 0.01 * f64::from(k)).collect();
        let value = time.iter().map(|&t| value(t)).collect();
        Series { time, value }
    }

    #[test]
    fn windows_and_gaps() {
        let ramp = series(|t| t);
        // exact: the record is linear
        assert!((Take::Mean { from: 1.0, to: 3.0 }.of(&ramp).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(Take::Maximum { from: 1.0, to: 3.0 }.of(&ramp), Some(3.0));
        assert_eq!(Take::Minimum { from: 1.0, to: 3.0 }.of(&ramp), Some(1.0));
        assert_eq!(Take::Height { from: 1.0, to: 3.0 }.of(&ramp), Some(2.0));
        assert!((Take::At(1.234).of(&ramp).unwrap() - 1.234).abs() < 1e-12);
        assert_eq!(Take::At(5.0).of(&ramp), None);
        assert!((Take::Rate { from: 1.0, to: 3.0 }.of(&ramp).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(Take::Rate { from: 1.0, to: 5.0 }.of(&ramp), None);
        assert_eq!(Take::Mean { from: 1.0, to: 4.1 }.of(&ramp), None);
        let gaps = series(|_| f64::NAN);
        for take in [
            Take::Mean { from: 0.0, to: 4.0 },
            Take::Maximum { from: 0.0, to: 4.0 },
            Take::At(1.0),
            Take::Arrival { level: 0.0 },
            Take::FirstCrest { level: 0.0 },
            Take::Period {
                level: 0.0,
                from: 0.0,
            },
        ] {
            assert_eq!(take.of(&gaps), None, "{take:?}");
        }
    }

    #[test]
    fn the_arrival_is_the_first_time_at_a_level() {
        // exact: the record is linear on each side of its top at 2 s
        let hill = series(|t| 1.0 - (t - 2.0).abs());
        let arrival = |level: f64| Take::Arrival { level }.of(&hill);
        assert!((arrival(0.2345).unwrap() - 1.2345).abs() < 1e-12);
        // one that begins above the level is there from its start
        assert_eq!(arrival(-2.0), Some(0.0));
        assert_eq!(arrival(1.1), None);
    }

    #[test]
    fn the_first_crest_is_not_the_highest() {
        let waves = series(|t| 0.6 + 0.1 * (1.0 + 0.3 * t) * (3.0 * t).sin());
        let found = Take::FirstCrest { level: 0.6 }.of(&waves).unwrap();
        // near its middle at t = π/6 + 0.03, where the growing height shifts it
        assert!((0.115..0.118).contains(&found), "{found}");
        // one that only rises has none yet
        assert_eq!(Take::FirstCrest { level: 0.0 }.of(&series(|t| t)), None);
    }

    #[test]
    fn the_harmonic_of_a_drifting_sine_is_its_height() {
        let waves = series(|t| 0.6 + 0.02 * t + 0.05 * (4.0 * t + 0.3).cos());
        let take = Take::Harmonic {
            period: std::f64::consts::TAU / 4.0,
            from: 0.5,
            to: 2.6,
        };
        // exact but for round-off: the record is of the form that is fitted
        assert!((take.of(&waves).unwrap() - 0.1).abs() < 1e-10);
    }

    #[test]
    fn the_period_of_a_sine_is_its_own() {
        let sine = series(|t| 2.0 + (7.0 * t).sin());
        let take = Take::Period {
            level: 2.0,
            from: 0.5,
        };
        let found = take.of(&sine).unwrap();
        // linear between samples 0.01 s apart: (ω dt)²/8 of a step at most
        assert!(
            (found - std::f64::consts::TAU / 7.0).abs() < 1e-5,
            "{found}"
        );
    }
}
