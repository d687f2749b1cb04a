//! Designs: points of the unit cube, and the values that distributions have there.

use riprap_dda::Random;

use super::file::{InputFile, SweepDesignFile, ValuesFile};

/// Digits of drawn numbers.
const DIGITS: usize = 6;

/// Largest number of inputs of a Sobol sequence; indices take two of its dimensions an input.
pub const MOST_DIMENSIONS: usize = sobol_burley::NUM_DIMENSIONS as usize;
/// Largest number of points of a Sobol sequence.
pub const MOST_POINTS: usize = 1 << 16;

/// Values of all inputs, a row each, as they are written into the scene.
pub fn rows(inputs: &[InputFile], design: SweepDesignFile) -> Vec<Vec<String>> {
    let n = inputs.len();
    let drawn = |points: Vec<Vec<f64>>| {
        let row = |point: Vec<f64>| {
            inputs
                .iter()
                .zip(point)
                .map(|(input, u)| at(input, u))
                .collect()
        };
        points.into_iter().map(row).collect()
    };
    match design {
        SweepDesignFile::Grid => {
            let longer = |all: Vec<Vec<String>>, values: Vec<String>| {
                let with = |row: Vec<String>| {
                    let each = values.clone().into_iter();
                    each.map(move |value| [row.as_slice(), &[value]].concat())
                };
                all.into_iter().flat_map(with).collect()
            };
            inputs
                .iter()
                .filter_map(InputFile::given)
                .fold(vec![Vec::new()], longer)
        }
        SweepDesignFile::List => {
            let given: Vec<Vec<String>> = inputs.iter().filter_map(InputFile::given).collect();
            let length = given.iter().map(Vec::len).min().unwrap_or(0);
            let row = |k: usize| given.iter().map(|values| values[k].clone()).collect();
            (0..length).map(row).collect()
        }
        SweepDesignFile::LatinHypercube { runs, seed } => drawn(latin_hypercube(n, runs, seed)),
        SweepDesignFile::Sobol { runs, seed } => drawn(sobol(n, runs, seed)),
        SweepDesignFile::SobolIndices { samples, seed } => drawn(for_indices(n, samples, seed)),
    }
}

/// Points with one coordinate in each of `runs` equal parts of every dimension.
fn latin_hypercube(n: usize, runs: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut random = Random::new(seed);
    let mut points = vec![vec![0.0; n]; runs];
    for k in 0..n {
        let mut parts: Vec<usize> = (0..runs).collect();
        // Fisher and Yates
        for last in (1..runs).rev() {
            let other = (random.uniform() * (last + 1) as f64) as usize;
            parts.swap(last, other);
        }
        for (point, part) in points.iter_mut().zip(parts) {
            point[k] = (part as f64 + random.uniform()) / runs as f64;
        }
    }
    points
}

/// The first points of a scrambled Sobol sequence.
fn sobol(n: usize, runs: usize, seed: u64) -> Vec<Vec<f64>> {
    // half of the last digit keeps points off the ends, where a normal distribution has no value
    let coordinate = |k: usize, d: usize| {
        f64::from(sobol_burley::sample(k as u32, d as u32, seed as u32)) + 0.5f64.powi(25)
    };
    let point = |k: usize| (0..n).map(|d| coordinate(k, d)).collect();
    (0..runs).map(point).collect()
}

/// Points for Sobol indices: of each sample A, B, and A with one coordinate of B after the other.
///
/// Saltelli et al. (2010), Variance based sensitivity analysis of model output, Computer Physics Communications 181.
fn for_indices(n: usize, samples: usize, seed: u64) -> Vec<Vec<f64>> {
    let of_sample = |pair: Vec<f64>| {
        let (a, b) = pair.split_at(n);
        let mixed = |k: usize| {
            let mut point = a.to_vec();
            point[k] = b[k];
            point
        };
        let mut points = vec![a.to_vec(), b.to_vec()];
        points.extend((0..n).map(mixed));
        points
    };
    sobol(2 * n, samples, seed)
        .into_iter()
        .flat_map(of_sample)
        .collect()
}

/// Value of an input at a share of its distribution.
fn at(input: &InputFile, u: f64) -> String {
    match quantile(&input.values, u) {
        Some(value) => rounded(value).to_string(),
        None => {
            let given = input.given().unwrap_or_default();
            let k = (u * given.len() as f64) as usize;
            given
                .get(k.min(given.len().saturating_sub(1)))
                .cloned()
                .unwrap_or_default()
        }
    }
}

/// Median of an input; of given values the middle one.
pub fn median(input: &InputFile) -> String {
    at(input, 0.5)
}

/// The number with the digits of drawn numbers: the same in the table, in the scene and on every machine.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

/// Inverse of the cumulative distribution; `None` for given values.
fn quantile(values: &ValuesFile, u: f64) -> Option<f64> {
    match *values {
        ValuesFile::Numbers(_) | ValuesFile::Texts(_) => None,
        ValuesFile::Uniform { from, to } => Some(from + u * (to - from)),
        ValuesFile::LogUniform { from, to } => Some(from * (u * (to / from).ln()).exp()),
        ValuesFile::Triangular { from, mode, to } => {
            let rising = (mode - from) / (to - from);
            Some(match u < rising {
                true => from + (u * (to - from) * (mode - from)).sqrt(),
                false => to - ((1.0 - u) * (to - from) * (to - mode)).sqrt(),
            })
        }
        ValuesFile::Normal {
            mean,
            standard_deviation,
        } => Some(mean + standard_deviation * normal_quantile(u)),
        ValuesFile::LogNormal {
            median,
            standard_deviation,
        } => Some(median * (standard_deviation * normal_quantile(u)).exp()),
    }
}

/// Quantile of the standard normal distribution, relative accuracy 1e-16: algorithm AS 241 of Wichura (1988), Applied
/// Statistics 37.
fn normal_quantile(u: f64) -> f64 {
    let polynomial = |c: [f64; 8], x: f64| c.iter().rev().fold(0.0, |sum, c| sum * x + c);
    let q = u - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.425 * 0.425 - q * q;
        return q * polynomial(CENTER[0], r) / polynomial(CENTER[1], r);
    }
    let r = (-u.min(1.0 - u).ln()).sqrt();
    let tail = match r <= 5.0 {
        true => polynomial(MIDDLE[0], r - 1.6) / polynomial(MIDDLE[1], r - 1.6),
        false => polynomial(FAR[0], r - 5.0) / polynomial(FAR[1], r - 5.0),
    };
    tail.copysign(q)
}

#[expect(clippy::excessive_precision, reason = "as published")]
const CENTER: [[f64; 8]; 2] = [
    [
        3.3871328727963666080,
        1.3314166789178437745e2,
        1.9715909503065514427e3,
        1.3731693765509461125e4,
        4.5921953931549871457e4,
        6.7265770927008700853e4,
        3.3430575583588128105e4,
        2.5090809287301226727e3,
    ],
    [
        1.0,
        4.2313330701600911252e1,
        6.8718700749205790830e2,
        5.3941960214247511077e3,
        2.1213794301586595867e4,
        3.9307895800092710610e4,
        2.8729085735721942674e4,
        5.2264952788528545610e3,
    ],
];
#[expect(clippy::excessive_precision, reason = "as published")]
const MIDDLE: [[f64; 8]; 2] = [
    [
        1.42343711074968357734,
        4.63033784615654529590,
        5.76949722146069140550,
        3.64784832476320460504,
        1.27045825245236838258,
        2.41780725177450611770e-1,
        2.27238449892691845833e-2,
        7.74545014278341407640e-4,
    ],
    [
        1.0,
        2.05319162663775882187,
        1.67638483018380384940,
        6.89767334985100004550e-1,
        1.48103976427480074590e-1,
        1.51986665636164571966e-2,
        5.47593808499534494600e-4,
        1.05075007164441684324e-9,
    ],
];
#[expect(clippy::excessive_precision, reason = "as published")]
const FAR: [[f64; 8]; 2] = [
    [
        6.65790464350110377720,
        5.46378491116411436990,
        1.78482653991729133580,
        2.96560571828504891230e-1,
        2.65321895265761230930e-2,
        1.24266094738807843860e-3,
        2.71155556874348757815e-5,
        2.01033439929228813265e-7,
    ],
    [
        1.0,
        5.99832206555887937690e-1,
        1.36929880922735805310e-1,
        1.48753612908506148525e-2,
        7.86869131145613259100e-4,
        1.84631831751005468180e-5,
        1.42151175831644588870e-7,
        2.04426310338993978564e-15,
    ],
];

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        // Abramowitz & Stegun (1964), table 26.5, and the symmetry of the distribution
        for (u, x) in [
            (0.5, 0.0),
            (0.975, 1.959_963_984_540_054),
            (0.999, 3.090_232_306_167_813_5),
            (1e-9, -5.997_807_015_007_687),
        ] {
            assert!(
                (normal_quantile(u) - x).abs() < 1e-12,
                "{u}: {}",
                normal_quantile(u)
            );
            // 1 - u has lost digits of small u
            assert!((normal_quantile(1.0 - u) + x).abs() < 1e-6);
        }
        let q = |values: &ValuesFile, u| quantile(values, u).unwrap();
        let triangle = ValuesFile::Triangular {
            from: 0.0,
            mode: 1.0,
            to: 4.0,
        };
        // a quarter of the area is before the mode
        assert!((q(&triangle, 0.25) - 1.0).abs() < 1e-15);
        assert!((q(&triangle, 1.0) - 4.0).abs() < 1e-15 && q(&triangle, 0.0).abs() < 1e-15);
        let log = ValuesFile::LogUniform {
            from: 1.0,
            to: 100.0,
        };
        assert!((q(&log, 0.5) - 10.0).abs() < 1e-14);
        let log = ValuesFile::LogNormal {
            median: 3.0,
            standard_deviation: 0.5,
        };
        assert!((q(&log, 0.5) - 3.0).abs() < 1e-15);
    }

    #[test]
    fn a_latin_hypercube_has_one_point_in_each_part() {
        let points = latin_hypercube(3, 50, 7);
        for k in 0..3 {
            let mut parts: Vec<usize> = points.iter().map(|p| (p[k] * 50.0) as usize).collect();
            assert!(
                parts.windows(2).any(|pair| pair[1] < pair[0]),
                "not in order"
            );
            parts.sort_unstable();
            assert_eq!(parts, (0..50).collect::<Vec<_>>());
        }
        assert_eq!(points, latin_hypercube(3, 50, 7));
        assert_ne!(points, latin_hypercube(3, 50, 8));
    }

    /// Of 2^m points one is in each of 2^m intervals, in every dimension; a longer sequence begins with the shorter.
    #[test]
    fn a_sobol_sequence_is_balanced_and_can_be_continued() {
        let points = sobol(5, 64, 3);
        for k in 0..5 {
            let mut parts: Vec<usize> = points.iter().map(|p| (p[k] * 64.0) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..64).collect::<Vec<_>>());
        }
        assert_eq!(sobol(5, 128, 3)[..64], points[..]);
        assert_ne!(sobol(5, 64, 4), points);
    }

    fn input(values: ValuesFile) -> InputFile {
        InputFile {
            name: "x".into(),
            set: vec!["x={}".into()],
            values,
        }
    }

    #[test]
    fn grids_and_lists_take_given_values() {
        let inputs = [
            input(ValuesFile::Numbers(vec![1.0, 2.5])),
            input(ValuesFile::Texts(vec!["a".into(), "b".into()])),
        ];
        let text = |design| {
            let rows = rows(&inputs, design);
            rows.iter()
                .map(|row| row.join(" "))
                .collect::<Vec<_>>()
                .join(", ")
        };
        assert_eq!(text(SweepDesignFile::Grid), "1 a, 1 b, 2.5 a, 2.5 b");
        assert_eq!(text(SweepDesignFile::List), "1 a, 2.5 b");
        // as often as they are likely
        let drawn = rows(
            &inputs,
            SweepDesignFile::LatinHypercube { runs: 10, seed: 1 },
        );
        assert_eq!(drawn.iter().filter(|row| row[1] == "a").count(), 5);
    }

    #[test]
    fn numbers_have_six_digits() {
        assert_eq!(
            rounded(std::f64::consts::PI * 1e-3).to_string(),
            "0.00314159"
        );
        assert_eq!(rounded(20.0).to_string(), "20");
    }
}
