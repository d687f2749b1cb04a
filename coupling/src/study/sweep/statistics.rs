//! Statistics of many runs: exceedance with confidence bands, rank correlations, Sobol indices.

use riprap_dda::Random;

/// Quantile of the standard normal distribution for 95 % confidence.
const NORMAL: f64 = 1.959_963_984_540_054;
/// Resamples of a bootstrap.
const RESAMPLES: usize = 1000;

/// An estimate and its confidence interval of 95 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimated {
    /// The estimate.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// A point of an exceedance curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exceedance {
    /// The value.
    pub value: f64,
    /// Share of runs that reach or exceed it.
    pub share: Estimated,
}

/// Exceedance curve of some values, in increasing order, a point for each distinct value, with bands of Wilson.
///
/// The band is for one value at a time, of runs that are independent draws.
pub fn exceedance(values: &[f64]) -> Vec<Exceedance> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    let is_first = |k: &usize| *k == 0 || sorted[*k - 1] < sorted[*k];
    let point = |k: usize| Exceedance {
        value: sorted[k],
        share: wilson(n - k, n),
    };
    (0..n).filter(is_first).map(point).collect()
}

/// Share of `k` in `n` with the interval of Wilson (1927), Probable inference, Journal of the American Statistical
/// Association 22.
pub fn wilson(k: usize, n: usize) -> Estimated {
    let (k, n) = (k as f64, n as f64);
    let (p, z2) = (k / n, NORMAL * NORMAL);
    let middle = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
    let half = NORMAL / (1.0 + z2 / n) * (p * (1.0 - p) / n + z2 / (4.0 * n * n)).sqrt();
    Estimated {
        value: p,
        low: (middle - half).max(0.0),
        high: (middle + half).min(1.0),
    }
}

/// Ranks from 1; equal values share their mean rank.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let equal = order.chunk_by(|&a, &b| values[a] == values[b]);
    let mut before = 0;
    for group in equal {
        let rank = before as f64 + 0.5 * (group.len() + 1) as f64;
        group.iter().for_each(|&k| ranks[k] = rank);
        before += group.len();
    }
    ranks
}

/// Spearman's rank correlation of pairs, with the interval of Fieller, Hartley & Pearson (1957), Biometrika 44; `None` for fewer
/// than five pairs or constant values.
pub fn rank_correlation(pairs: &[(f64, f64)]) -> Option<Estimated> {
    let n = pairs.len();
    if n < 5 {
        return None;
    }
    let (x, y): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
    let (x, y) = (ranks(&x), ranks(&y));
    let mean = 0.5 * (n + 1) as f64;
    let sum = |a: &[f64], b: &[f64]| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - mean) * (b - mean)).sum()
    };
    let scale = (sum(&x, &x) * sum(&y, &y)).sqrt();
    if scale == 0.0 {
        return None;
    }
    let value = (sum(&x, &y) / scale).clamp(-1.0, 1.0);
    let half = NORMAL * (1.06 / (n - 3) as f64).sqrt();
    Some(Estimated {
        value,
        low: (value.atanh() - half).tanh(),
        high: (value.atanh() + half).tanh(),
    })
}

/// Sobol indices of an input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Indices {
    /// Share of the variance due to the input alone.
    pub first: Estimated,
    /// Share due to the input, alone and with others.
    pub total: Estimated,
}

/// Sobol indices of all inputs from samples of `[f(A), f(B), f(A with the first coordinate of B), ...]`; `None` for fewer than
/// four samples or without variance. Intervals are of a bootstrap over samples.
///
/// ```text
/// S = 1 − mean((f(B) − f(AB))²)/(2 V)        T = mean((f(A) − f(AB))²)/(2 V)
/// ```
/// Jansen (1999), Analysis of variance designs for model output, Computer Physics Communications 117.
pub fn sobol_indices(samples: &[Vec<f64>]) -> Option<Vec<Indices>> {
    let n = samples.len();
    let inputs = samples.first()?.len().checked_sub(2)?;
    if n < 4 {
        return None;
    }
    let all: Vec<usize> = (0..n).collect();
    let found = indices_of(samples, &all, inputs)?;
    let mut random = Random::new(1);
    let resampled: Vec<Vec<[f64; 2]>> = (0..RESAMPLES)
        .filter_map(|_| {
            let drawn: Vec<usize> = (0..n)
                .map(|_| (random.uniform() * n as f64) as usize)
                .collect();
            indices_of(samples, &drawn, inputs)
        })
        .collect();
    let with_interval = |input: usize, which: usize| {
        let mut values: Vec<f64> = resampled.iter().map(|of| of[input][which]).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[(share * (values.len() - 1) as f64).round() as usize];
        Estimated {
            value: found[input][which],
            low: at(0.025),
            high: at(0.975),
        }
    };
    if resampled.is_empty() {
        return None;
    }
    let of_input = |input| Indices {
        first: with_interval(input, 0),
        total: with_interval(input, 1),
    };
    Some((0..inputs).map(of_input).collect())
}

/// First and total index of each input, from some of the samples.
fn indices_of(samples: &[Vec<f64>], chosen: &[usize], inputs: usize) -> Option<Vec<[f64; 2]>> {
    let n = chosen.len() as f64;
    let both = || chosen.iter().flat_map(|&k| [samples[k][0], samples[k][1]]);
    let mean = both().sum::<f64>() / (2.0 * n);
    let variance = both().map(|f| (f - mean) * (f - mean)).sum::<f64>() / (2.0 * n);
    let of_input = |i: usize| {
        let squares = |base: usize| -> f64 {
            let difference = |k: &usize| samples[*k][base] - samples[*k][i + 2];
            chosen.iter().map(|k| difference(k).powi(2)).sum::<f64>() / n
        };
        [
            1.0 - squares(1) / (2.0 * variance),
            squares(0) / (2.0 * variance),
        ]
    };
    (0.0 < variance).then(|| (0..inputs).map(of_input).collect())
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::super::design;
    use super::super::file::{InputFile, SweepDesignFile, ValuesFile};
    use super::*;

    /// Ishigami & Homma (1990), An importance quantification technique, with a = 7, b = 0.1: the variance of each part is known.
    #[test]
    fn sobol_indices_of_ishigamis_function() {
        use std::f64::consts::PI;
        let input = InputFile {
            name: "x".into(),
            set: Vec::new(),
            values: ValuesFile::Uniform { from: -PI, to: PI },
        };
        let inputs = [input.clone(), input.clone(), input];
        let design = SweepDesignFile::SobolIndices {
            samples: 4096,
            seed: 1,
        };
        let rows = design::rows(&inputs, design);
        assert_eq!(rows.len(), 4096 * 5);
        let (a, b) = (7.0, 0.1);
        let values: Vec<f64> = (rows.iter())
            .map(|row| {
                let x: Vec<f64> = row.iter().map(|text| text.parse().unwrap()).collect();
                x[0].sin() + a * x[1].sin().powi(2) + b * x[2].powi(4) * x[0].sin()
            })
            .collect();
        let samples: Vec<Vec<f64>> = values.chunks(5).map(<[f64]>::to_vec).collect();
        let found = sobol_indices(&samples).unwrap();
        let p4 = PI.powi(4);
        let parts = [
            0.5 * (1.0 + b * p4 / 5.0).powi(2),
            a * a / 8.0,
            b * b * p4 * p4 * (1.0 / 18.0 - 1.0 / 50.0),
        ];
        let variance: f64 = parts.iter().sum();
        let exact = [
            (parts[0], parts[0] + parts[2]),
            (parts[1], parts[1]),
            (0.0, parts[2]),
        ];
        for (found, (first, total)) in found.iter().zip(exact) {
            for (found, exact) in [(found.first, first), (found.total, total)] {
                // three times the largest half width that 4096 samples leave
                assert!((found.value - exact / variance).abs() < 0.03);
                assert!(found.low <= found.value && found.value <= found.high);
                assert!(found.high - found.low < 0.1);
            }
        }
        assert!(
            sobol_indices(&vec![vec![1.0; 5]; 10]).is_none(),
            "no variance"
        );
    }

    #[test]
    fn intervals_of_wilson_are_those_published() {
        // Newcombe (1998), Statistics in Medicine 17, table I: 81 of 263 and 15 of 148 and 0 of 20 and 1 of 29
        for (k, n, low, high) in [
            (81, 263, 0.2553, 0.3662),
            (15, 148, 0.0624, 0.1605),
            (0, 20, 0.0, 0.1611),
            (1, 29, 0.0061, 0.1718),
        ] {
            let found = wilson(k, n);
            assert!(
                (found.low - low).abs() < 6e-5 && (found.high - high).abs() < 6e-5,
                "{found:?}"
            );
        }
    }

    #[test]
    fn exceedance_counts_equal_values_once() {
        let curve = exceedance(&[3.0, 1.0, f64::NAN, 2.0, 2.0]);
        let points: Vec<(f64, f64)> = curve.iter().map(|p| (p.value, p.share.value)).collect();
        assert_eq!(points, [(1.0, 1.0), (2.0, 0.75), (3.0, 0.25)]);
    }

    #[test]
    fn ranks_know_no_scale() {
        let pairs: Vec<(f64, f64)> = (0..30).map(f64::from).map(|x| (x, x.powi(5))).collect();
        assert!((rank_correlation(&pairs).unwrap().value - 1.0).abs() < 1e-12);
        assert_eq!(ranks(&[2.0, 1.0, 2.0]), [2.5, 1.0, 2.5]);
        let constant: Vec<(f64, f64)> = (0..30).map(|k| (f64::from(k), 1.0)).collect();
        assert!(rank_correlation(&constant).is_none());
        // Spearman (1904) by hand: ranks 1 2 3 4 5 against 2 1 4 3 5, 1 - 6 * 4/(5 * 24)
        let pairs = [
            (1.0, 20.0),
            (2.0, 10.0),
            (3.0, 40.0),
            (4.0, 30.0),
            (5.0, 50.0),
        ];
        assert!((rank_correlation(&pairs).unwrap().value - 0.8).abs() < 1e-12);
    }
}
