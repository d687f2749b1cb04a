//! Analysis of the runs of a study: Pareto front, error reduction per doubling of cost, and order of convergence.

/// Cost of a run, in any unit, and its error; both above zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Wall time, or work.
    pub cost: f64,
    /// Relative error.
    pub error: f64,
}

impl Point {
    /// Whether both are finite and positive, as logarithmic axes require.
    fn is_measured(&self) -> bool {
        [self.cost, self.error]
            .iter()
            .all(|x| x.is_finite() && 0.0 < *x)
    }

    /// Pareto dominance: as good in both, better in one.
    fn beats(&self, other: &Self) -> bool {
        self.cost <= other.cost && self.error <= other.error && self != other
    }
}

/// Pareto front of points, by increasing cost. Of equal ones the first is kept.
pub fn front(points: &[Point]) -> Vec<usize> {
    let mut found: Vec<usize> = (0..points.len())
        .filter(|&k| points[k].is_measured() || points[k].error == 0.0)
        .filter(|&k| {
            let others = points
                .iter()
                .enumerate()
                .filter(|(_, p)| p.cost.is_finite());
            let mut better = others
                .filter(|&(j, other)| other.beats(&points[k]) || (j < k && *other == points[k]));
            better.next().is_none()
        })
        .collect();
    found.sort_by(|&a, &b| points[a].cost.total_cmp(&points[b].cost));
    found
}

/// Straight line in logarithms: `y = factor · x^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// –
    pub exponent: f64,
    /// `y` at `x = 1`.
    pub factor: f64,
}

impl PowerLaw {
    /// Least-squares fit through pairs of positive numbers; `None` for fewer than two different `x`.
    pub fn fit(pairs: impl Iterator<Item = (f64, f64)>) -> Option<Self> {
        let logarithms: Vec<(f64, f64)> = pairs
            .filter(|(x, y)| 0.0 < *x && 0.0 < *y && x.is_finite() && y.is_finite())
            .map(|(x, y)| (x.ln(), y.ln()))
            .collect();
        let n = logarithms.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| logarithms.iter().map(of).sum::<f64>() / n;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let spread: f64 = logarithms.iter().map(|p| (p.0 - x).powi(2)).sum();
        let common: f64 = logarithms.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        // equal values of a knob differ by no more than the digits they are typed with
        (1e-12 < spread).then(|| {
            let exponent = common / spread;
            Self {
                exponent,
                factor: (y - exponent * x).exp(),
            }
        })
    }

    /// `y` at some `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.factor * x.powf(self.exponent)
    }
}

/// Factor of the error per doubling of the cost along one knob; `None` if the cost hardly changes.
pub fn error_per_doubling(points: &[Point]) -> Option<f64> {
    let measured = points.iter().filter(|p| p.is_measured());
    let costs = || measured.clone().map(|p| p.cost);
    let (least, most) = (
        costs().fold(f64::INFINITY, f64::min),
        costs().fold(0.0, f64::max),
    );
    if most < LEAST_CHANGE_OF_COST * least {
        return None;
    }
    let law = PowerLaw::fit(measured.clone().map(|p| (p.cost, p.error)))?;
    Some(2_f64.powf(law.exponent))
}

/// Smallest ratio of costs for a slope: below it noise dominates, as with kernels, precision, diffusion.
const LEAST_CHANGE_OF_COST: f64 = 1.5;

/// Roache's grid convergence index of the finest of three values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convergence {
    /// Observed order.
    pub order: f64,
    /// Richardson's limit, in the unit of the values.
    pub limit: f64,
    /// Grid convergence index relative to the finest value, with a safety factor of 1.25.
    pub index: f64,
}

/// Observed order, limit and grid convergence index of three values by spacing, coarse to fine (m); `None` without
/// monotonic convergence.
///
/// ```text
/// p = |ln(e₃₂/e₂₁) + ln((r₂₁^p − 1)/(r₃₂^p − 1))| / ln r₂₁      limit = f₁ + (f₁ − f₂)/(r₂₁^p − 1)
/// ```
/// Source: Celik, Ghia, Roache et al. (2008), J. Fluids Eng. 130, 078001.
pub fn convergence(spacings: [f64; 3], values: [f64; 3]) -> Option<Convergence> {
    let ([h3, h2, h1], [f3, f2, f1]) = (spacings, values);
    let (coarse, fine) = (f3 - f2, f2 - f1);
    // NaN is not above zero either
    if !(0.0 < coarse * fine && h1 < h2 && h2 < h3 && 0.0 < h1) {
        return None;
    }
    let (r21, r32) = (h2 / h1, h3 / h2);
    let next = |order: f64| {
        let skew = ((r21.powf(order) - 1.0) / (r32.powf(order) - 1.0)).ln();
        ((coarse / fine).ln() + skew).abs() / r21.ln()
    };
    let order = (0..200).fold(1.0, |order, _| next(order));
    if !((next(order) - order).abs() < 1e-9 * order && 0.0 < order) {
        return None;
    }
    let gain = r21.powf(order) - 1.0;
    Some(Convergence {
        order,
        limit: f1 - fine / gain,
        index: 1.25 * (fine / f1).abs() / gain,
    })
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;

    fn point((cost, error): (f64, f64)) -> Point {
        Point { cost, error }
    }

    #[test]
    fn the_front_is_what_none_beats() {
        let points = [
            (4.0, 0.01),
            (1.0, 0.1),
            (2.0, 0.2), // dearer and worse than the second
            (2.0, 0.05),
            (2.0, 0.05), // the same again
            (8.0, f64::NAN),
            (f64::NAN, 0.001),
        ]
        .map(point);
        assert_eq!(front(&points), [1, 3, 0]);
        assert_eq!(front(&[]), [0; 0]);
    }

    #[test]
    fn a_power_law_is_found_again() {
        let pairs = [0.01, 0.02, 0.08].map(|x: f64| (x, 3.0 * x.powf(1.5)));
        let law = PowerLaw::fit(pairs.into_iter()).unwrap();
        // round-off of logarithms
        assert!((law.exponent - 1.5).abs() < 1e-12);
        assert!((law.factor / 3.0 - 1.0).abs() < 1e-12);
        assert!((law.at(0.05) / (3.0 * 0.05_f64.powf(1.5)) - 1.0).abs() < 1e-12);
        assert_eq!(PowerLaw::fit([(0.1, 1.0), (0.1, 2.0)].into_iter()), None);
    }

    #[test]
    fn a_doubling_of_cost_that_halves_the_error_is_half() {
        let points = [(1.0, 0.4), (2.0, 0.2), (4.0, 0.1)].map(point);
        assert!((error_per_doubling(&points).unwrap() - 0.5).abs() < 1e-12);
        // what costs nearly the same has no slope
        assert_eq!(
            error_per_doubling(&[(1.0, 0.4), (1.4, 0.1)].map(point)),
            None
        );
    }

    #[test]
    fn a_known_order_is_found_with_unequal_ratios() {
        let spacings = [0.05, 0.035, 0.026];
        let values = spacings.map(|h: f64| 2.0 - 5.0 * h.powf(1.7));
        let found = convergence(spacings, values).unwrap();
        // the iteration stops at 1e-9 of the order
        assert!((found.order - 1.7).abs() < 1e-7, "{found:?}");
        assert!((found.limit - 2.0).abs() < 1e-8, "{found:?}");
        assert_eq!(convergence(spacings, [1.0, 1.2, 1.1]), None);
    }
}
