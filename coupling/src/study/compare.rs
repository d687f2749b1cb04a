//! Comparison of a computed series with a reference.
//!
//! ```text
//! window   times of the reference that the computed series covers too, within the limits asked for
//! range    max r − min r over the window
//! error    √( mean (c − r)² ) / range        c interpolated linearly to the times of r
//! ```
//!
//! Samples that are NaN in either series are skipped, without interpolation across them. Undefined results, such as an
//! error relative to a range of zero, are `None`, never NaN.

mod reference;
mod report;
pub mod surfaces;

pub use reference::ReferenceColumns;
pub use report::{CompareError, Report, compare_files, compare_with, json, text};
use serde::Serialize;

/// A quantity over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Times, ascending; s.
    pub time: Vec<f64>,
    /// A value per time; NaN in a gap.
    pub value: Vec<f64>,
}

/// Options of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Added to the times of the computed series; s.
    pub shift: f64,
    /// Start of the window in the time of the reference; the beginning of both series if not given; s.
    pub from: Option<f64>,
    /// End of the window; the end of both series if not given; s.
    pub to: Option<f64>,
    /// Deviation from the initial value, as a fraction of the largest one of the reference, that defines the arrival of a wave.
    pub arrival_fraction: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            shift: 0.0,
            from: None,
            to: None,
            // Above the noise of wave gauges, which is a few percent, and still on the front of the wave.
            arrival_fraction: 0.1,
        }
    }
}

/// Result of [`compare`]; `None` where undefined.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Root mean square difference divided by `reference_range`.
    pub normalized_rms_error: Option<f64>,
    /// Computed maximum minus the reference's, each over its own samples in the window; unit of the values.
    pub peak_error: Option<f64>,
    /// Computed minimum minus the reference's; unit of the values.
    pub trough_error: Option<f64>,
    /// Computed arrival minus the reference's; positive if late; s.
    pub arrival_time_error: Option<f64>,
    /// Pearson's correlation.
    pub correlation: Option<f64>,
    /// Maximum minus minimum of the reference in the window; unit of the values.
    pub reference_range: Option<f64>,
    /// Number of reference samples compared.
    pub n: usize,
    /// First and last time compared; s.
    pub window: Option<(f64, f64)>,
}

/// Compares `computed` with `reference`.
pub fn compare(computed: &Series, reference: &Series, options: Options) -> Comparison {
    let computed = Series {
        time: computed
            .time
            .iter()
            .map(|time| time + options.shift)
            .collect(),
        value: computed.value.clone(),
    };
    let start = options.from.unwrap_or(f64::NEG_INFINITY);
    let end = options.to.unwrap_or(f64::INFINITY);
    let pairs: Vec<Pair> = reference
        .samples()
        .filter(|&(time, r)| start <= time && time <= end && r.is_finite())
        .filter_map(|(time, r)| computed.at(time).map(|c| Pair { time, c, r }))
        .collect();
    let window = pairs
        .first()
        .zip(pairs.last())
        .map(|(first, last)| (first.time, last.time));
    let computed = computed.within(window);
    let reference = reference.within(window);

    let n = pairs.len();
    let range = pairs_range(&pairs, |pair| pair.r);
    let mean_square = pairs
        .iter()
        .map(|pair| (pair.c - pair.r).powi(2))
        .sum::<f64>()
        / n as f64;
    let difference =
        |extreme: fn(&Series) -> Option<f64>| Some(extreme(&computed)? - extreme(&reference)?);
    Comparison {
        normalized_rms_error: range
            .filter(|&range| range > 0.0)
            .map(|range| mean_square.sqrt() / range),
        peak_error: difference(Series::maximum),
        trough_error: difference(Series::minimum),
        arrival_time_error: arrival_time_error(&computed, &reference, options.arrival_fraction),
        correlation: correlation(&pairs),
        reference_range: range,
        n,
        window,
    }
}

/// Values of both series at a time of the reference.
struct Pair {
    time: f64,
    c: f64,
    r: f64,
}

fn pairs_range(pairs: &[Pair], value: impl Fn(&Pair) -> f64) -> Option<f64> {
    let (min, max) = extent(pairs.iter().map(value))?;
    Some(max - min)
}

/// Smallest and largest finite value.
fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values
        .filter(|value| value.is_finite())
        .fold(None, |found, value| {
            let (min, max) = found.unwrap_or((value, value));
            Some((value.min(min), value.max(max)))
        })
}

fn correlation(pairs: &[Pair]) -> Option<f64> {
    // The correlation of a constant is undefined; the range is tested, since rounding leaves a constant some variance.
    let varies =
        |value: fn(&Pair) -> f64| pairs_range(pairs, value).is_some_and(|range| range > 0.0);
    if !varies(|pair| pair.c) || !varies(|pair| pair.r) {
        return None;
    }
    let n = pairs.len() as f64;
    let mean_c = pairs.iter().map(|pair| pair.c).sum::<f64>() / n;
    let mean_r = pairs.iter().map(|pair| pair.r).sum::<f64>() / n;
    let sum = |product: &dyn Fn(f64, f64) -> f64| -> f64 {
        pairs
            .iter()
            .map(|pair| product(pair.c - mean_c, pair.r - mean_r))
            .sum()
    };
    let (cc, rr, cr) = (sum(&|c, _| c * c), sum(&|_, r| r * r), sum(&|c, r| c * r));
    Some(cr / (cc.sqrt() * rr.sqrt())).filter(|value| value.is_finite())
}

fn arrival_time_error(computed: &Series, reference: &Series, fraction: f64) -> Option<f64> {
    let initial = reference.initial()?;
    let departures = reference.value.iter().map(|value| (value - initial).abs());
    let (_, largest) = extent(departures)?;
    let threshold = fraction * largest;
    if threshold <= 0.0 {
        return None;
    }
    Some(computed.arrival(threshold)? - reference.arrival(threshold)?)
}

impl Series {
    pub(crate) fn samples(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.time.iter().copied().zip(self.value.iter().copied())
    }

    /// Value at `time`, linear between samples; `None` outside or in a gap.
    pub(crate) fn at(&self, time: f64) -> Option<f64> {
        let after = self.time.partition_point(|&t| t < time);
        let (t1, v1) = (*self.time.get(after)?, *self.value.get(after)?);
        if t1 == time {
            return v1.is_finite().then_some(v1);
        }
        let before = after.checked_sub(1)?;
        let (t0, v0) = (*self.time.get(before)?, *self.value.get(before)?);
        Some(v0 + (v1 - v0) * (time - t0) / (t1 - t0)).filter(|value| value.is_finite())
    }

    /// The samples in `window`, and its ends, interpolated; empty without a window.
    pub(crate) fn within(&self, window: Option<(f64, f64)>) -> Self {
        let Some((start, end)) = window else {
            return Self::default();
        };
        let inside = self
            .samples()
            .filter(|&(time, _)| start < time && time < end);
        let first = self.at(start).map(|value| (start, value));
        let last = self
            .at(end)
            .filter(|_| start < end)
            .map(|value| (end, value));
        let (time, value) = first.into_iter().chain(inside).chain(last).unzip();
        Self { time, value }
    }

    fn minimum(&self) -> Option<f64> {
        extent(self.value.iter().copied()).map(|(min, _)| min)
    }

    fn maximum(&self) -> Option<f64> {
        extent(self.value.iter().copied()).map(|(_, max)| max)
    }

    fn initial(&self) -> Option<f64> {
        self.value.iter().copied().find(|value| value.is_finite())
    }

    /// First time at which the deviation from the initial value, up or down, reaches `threshold`.
    fn arrival(&self, threshold: f64) -> Option<f64> {
        let initial = self.initial()?;
        let departure = |i: usize| (self.value[i] - initial).abs();
        let i = (0..self.value.len()).find(|&i| departure(i) >= threshold)?;
        // The first finite sample has no deviation, so that `i` is not zero; after a gap no refinement is possible.
        let before = i
            .checked_sub(1)
            .filter(|&before| departure(before).is_finite());
        let Some(before) = before else {
            return Some(self.time[i]);
        };
        // In signed values: a step from below to above may pass the initial value on its way.
        let target = initial + threshold.copysign(self.value[i] - initial);
        let part = (target - self.value[before]) / (self.value[i] - self.value[before]);
        Some(self.time[before] + part * (self.time[i] - self.time[before]))
    }
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// `value` sampled `n` times per second for ten seconds.
    fn series(n: usize, value: impl Fn(f64) -> f64) -> Series {
        let time: Vec<f64> = (0..=10 * n).map(|i| i as f64 / n as f64).collect();
        let value = time.iter().map(|&t| value(t)).collect();
        Series { time, value }
    }

    fn close(found: Option<f64>, expected: f64, tolerance: f64) {
        let found = found.unwrap();
        assert!(
            (found - expected).abs() <= tolerance,
            "{found}, expected {expected} within {tolerance:e}"
        );
    }

    #[test]
    fn a_series_equals_itself() {
        let wave = series(100, |t| (TAU * t).sin());
        let found = compare(&wave, &wave, Options::default());
        let expected = Comparison {
            normalized_rms_error: Some(0.0),
            peak_error: Some(0.0),
            trough_error: Some(0.0),
            arrival_time_error: Some(0.0),
            correlation: found.correlation,
            reference_range: Some(2.0),
            n: 1001,
            window: Some((0.0, 10.0)),
        };
        assert_eq!(found, expected);
        close(found.correlation, 1.0, 1e-15);
    }

    /// `1.2 sin` against `sin`: rms of `0.2 sin` over whole periods is `0.2/√2`, over a range of 2.
    #[test]
    fn a_scaled_wave() {
        let wave = series(100, |t| (TAU * t).sin());
        let larger = series(100, |t| 1.2 * (TAU * t).sin());
        let found = compare(&larger, &wave, Options::default());
        // The window holds one sample more than ten periods, a zero: √(1000/1001) times the exact value.
        close(
            found.normalized_rms_error,
            0.1 / 2f64.sqrt() * (1000.0f64 / 1001.0).sqrt(),
            1e-12,
        );
        close(found.peak_error, 0.2, 1e-15);
        close(found.trough_error, -0.2, 1e-15);
        close(found.correlation, 1.0, 1e-12);
        // 0.1 = 1.2 sin 2πt, against 0.1 = sin 2πt; linear between samples 0.01 s apart.
        let expected = ((0.1f64 / 1.2).asin() - 0.1f64.asin()) / TAU;
        close(found.arrival_time_error, expected, 2e-5);
    }

    /// `sin(x − φ)` against `sin x`: rms `√2 sin(φ/2)`, correlation `cos φ`; and `--shift` puts it right.
    #[test]
    fn a_late_wave() {
        let wave = series(100, |t| (TAU * t).sin());
        let late = series(100, |t| (TAU * (t - 0.05)).sin());
        let options = Options {
            from: Some(1.0),
            to: Some(8.995),
            ..Options::default()
        };
        let found = compare(&late, &wave, options);
        assert_eq!((found.n, found.window), (800, Some((1.0, 8.99))));
        let phi = TAU * 0.05;
        close(
            found.normalized_rms_error,
            (phi / 2.0).sin() / 2f64.sqrt(),
            1e-12,
        );
        close(found.correlation, phi.cos(), 1e-12);
        close(found.peak_error, 0.0, 1e-12);
        let found = compare(
            &late,
            &wave,
            Options {
                shift: -0.05,
                ..options
            },
        );
        // Shifted times fall on samples but for rounding.
        close(found.normalized_rms_error, 0.0, 1e-12);
    }

    /// A ramp that starts at 3 s and rises by 2 m/s to 4 m, falling instead of rising in the other sign; late by 0.4 s.
    #[test]
    fn arrival_of_a_ramp() {
        for sign in [1.0, -1.0] {
            let ramp = |start: f64| move |t: f64| 7.0 + sign * (2.0 * (t - start)).clamp(0.0, 4.0);
            let found = compare(
                &series(7, ramp(3.4)),
                &series(100, ramp(3.0)),
                Options::default(),
            );
            // 10 % of 4 m is reached 0.2 s after the start. The computed samples are at i/7 s: the one before is at
            // 24/7 s, already on the ramp, so that linear interpolation is exact.
            close(found.arrival_time_error, 0.4, 1e-12);
        }
    }

    #[test]
    fn a_coarse_reference_is_met_by_interpolation() {
        let line = |t: f64| 3.0 - 0.5 * t;
        let found = compare(&series(3, line), &series(2, line), Options::default());
        close(found.normalized_rms_error, 0.0, 1e-15);
        assert_eq!(found.n, 21);
    }

    #[test]
    fn only_the_overlap_counts() {
        let early = Series {
            time: vec![0.0, 1.0, 2.0, 3.0],
            value: vec![0.0, 1.0, 2.0, 3.0],
        };
        let late = Series {
            time: vec![2.5, 3.0, 3.5],
            value: vec![2.5, 4.0, 99.0],
        };
        let found = compare(&early, &late, Options::default());
        assert_eq!(found.window, Some((2.5, 3.0)));
        assert_eq!(found.n, 2);
        // Differences 0 and 1, range 1.5.
        close(found.normalized_rms_error, 0.5f64.sqrt() / 1.5, 1e-15);
        close(found.peak_error, -1.0, 0.0);
    }

    #[test]
    fn gaps_are_skipped_and_not_bridged() {
        let reference = series(10, |t| t);
        let gap = |t: f64| {
            if (4.0..=5.0).contains(&t) {
                f64::NAN
            } else {
                t + 1.0
            }
        };
        let found = compare(&series(10, gap), &reference, Options::default());
        assert_eq!(found.n, 101 - 11);
        close(found.normalized_rms_error, 0.1, 1e-15);
        // In the reference too, and at its start: the initial value is the first there is.
        let found = compare(
            &reference,
            &series(10, |t| if t < 0.45 { f64::NAN } else { t }),
            Options::default(),
        );
        assert_eq!((found.n, found.window), (96, Some((0.5, 10.0))));
        close(found.arrival_time_error, 0.0, 1e-12);
    }

    #[test]
    fn constants_are_undefined_not_nan() {
        // 0.1 is the classic: the mean of many is not quite 0.1.
        let calm = series(10, |_| 0.1);
        let wave = series(10, |t| (TAU * t / 5.0).sin());
        for (computed, reference, range) in [(&calm, &calm, 0.0), (&wave, &calm, 0.0)] {
            let found = compare(computed, reference, Options::default());
            assert_eq!(found.reference_range, Some(range));
            assert_eq!(found.normalized_rms_error, None);
            assert_eq!(found.correlation, None);
            assert_eq!(found.arrival_time_error, None);
            assert!(found.peak_error.unwrap().is_finite());
        }
        let found = compare(&calm, &wave, Options::default());
        assert_eq!((found.correlation, found.arrival_time_error), (None, None));
        assert!(found.normalized_rms_error.unwrap() > 0.0);
    }

    #[test]
    fn nothing_in_common_is_undefined() {
        let wave = series(10, |t| t.sin());
        let away = Options {
            shift: 100.0,
            ..Options::default()
        };
        let nothing = Series::default();
        for found in [
            compare(&wave, &wave, away),
            compare(&nothing, &wave, Options::default()),
        ] {
            assert_eq!((found.n, found.window, found.peak_error), (0, None, None));
            assert_eq!(found.normalized_rms_error, None);
        }
    }
}
