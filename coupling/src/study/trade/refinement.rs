//! Extrapolation from three coarse runs to finer ones, where there is no study.
//!
//! ```text
//! e(s) = safety · |f∞ − f₁| (s/s₁)^p / |f₁ − f₀|        f₀ the value that means nothing, such as the level of rest
//! ```
//! `p` and `f∞` are Richardson's where the three converge monotonically; an order beyond that of the schemes is replaced by
//! the nearest possible one, with a larger safety factor (Oberkampf & Roy 2010, Verification and Validation in Scientific
//! Computing, 8.7). Otherwise the error is assumed proportional to the spacing, from the largest difference between
//! any two. Only the discretization error is estimated, not errors of the scheme or the scene that are independent of spacing.

use super::front::convergence;

/// Roache's safety factor for an observed order.
const SAFETY: f64 = 1.25;
/// Safety factor for an order that was not observed or is beyond that of the schemes.
const SAFETY_WITHOUT_ORDER: f64 = 3.0;
/// Range of orders that a second-order scheme may show before its asymptotic range.
const ORDERS: std::ops::RangeInclusive<f64> = 0.5..=2.5;
/// Formal order, the largest one assumed.
const FORMAL_ORDER: f64 = 2.0;
/// Rows of water of the runs, over those of the finest.
const LEVELS: [f64; 3] = [0.5, std::f64::consts::FRAC_1_SQRT_2, 1.0];
/// Rows of the finest run, over those of the scene.
const FINEST_LEVEL: f64 = 2.0 / 3.0;
/// Smallest number of rows of the finest run.
const LEAST_ROWS: f64 = 10.0;
/// Largest number of rows of the final run, over those of the scene, whose spacing reflects the acceptable cost.
const MOST_ROWS: f64 = 2.0;

/// A value at a spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// m.
    pub spacing: f64,
    /// Of any unit.
    pub value: f64,
}

/// Convergence of the error with the spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Observed order, or the nearest possible one; `None` without monotonic convergence.
    pub order: Option<f64>,
    /// Whether the order is the observed one; otherwise coarser runs than the finest are not trusted.
    pub is_observed: bool,
    /// Richardson's limit, where there is an order.
    pub limit: Option<f64>,
    /// Relative error of the finest, including the safety factor: the grid convergence index if there is an order.
    pub error: f64,
    spacing: f64,
}

impl Estimate {
    /// From three runs, coarse to fine, relative to a reference value such as the level at rest.
    pub fn of(levels: [Level; 3], zero: f64) -> Self {
        let values = levels.map(|level| level.value - zero);
        let found = convergence(levels.map(|level| level.spacing), values);
        let spacing = levels[2].spacing;
        if let Some(found) = found {
            let (order, safety) = match ORDERS.contains(&found.order) {
                true => (found.order, SAFETY),
                false => (
                    found.order.clamp(*ORDERS.start(), FORMAL_ORDER),
                    SAFETY_WITHOUT_ORDER,
                ),
            };
            let gain = (levels[1].spacing / spacing).powf(order) - 1.0;
            let left = (values[2] - values[1]) / gain;
            return Self {
                order: Some(order),
                is_observed: order == found.order,
                limit: Some(levels[2].value + left),
                error: safety * (left / values[2]).abs(),
                spacing,
            };
        }
        let pairs = [(0, 1), (0, 2), (1, 2)];
        let slope = pairs
            .map(|(a, b)| ((values[a] - values[b]) / (levels[a].spacing - levels[b].spacing)).abs())
            .into_iter()
            .fold(0.0, f64::max);
        Self {
            order: None,
            is_observed: false,
            limit: None,
            error: SAFETY_WITHOUT_ORDER * (slope * spacing / values[2]).abs(),
            spacing,
        }
    }

    /// The order if it is the observed one.
    pub fn observed_order(&self) -> Option<f64> {
        self.order.filter(|_| self.is_observed)
    }

    /// Expected error at another spacing (m).
    pub fn error_at(&self, spacing: f64) -> f64 {
        self.error * (spacing / self.spacing).powf(self.order.unwrap_or(1.0))
    }

    /// Coarsest spacing that is expected to meet a budget; m.
    pub fn spacing_for(&self, budget: f64) -> f64 {
        self.spacing * (budget / self.error).powf(1.0 / self.order.unwrap_or(1.0))
    }
}

/// Rows of water of the three runs for a scene with a given number, coarse to fine.
pub fn levels(rows: f64) -> [f64; 3] {
    let finest = (FINEST_LEVEL * rows).max(LEAST_ROWS).round();
    LEVELS.map(|share| (share * finest).round())
}

/// Rows of the run that is to meet a budget: whole rows, to preserve the surface; at least those of the coarsest
/// run, or of the finest if no order was observed, at most twice those of the scene.
pub fn rows_for(estimate: &Estimate, budget: f64, depth: f64, rows: f64) -> f64 {
    let wanted = depth / estimate.spacing_for(budget);
    // NaN without a prediction counts as the largest error
    let most = (MOST_ROWS * rows).round();
    if wanted.is_nan() {
        return most;
    }
    let least = levels(rows)[if estimate.is_observed { 0 } else { 2 }];
    wanted.ceil().clamp(least.min(most), most)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refined(value: impl Fn(f64) -> f64) -> [Level; 3] {
        [0.1, 0.07, 0.05].map(|spacing| Level {
            spacing,
            value: value(spacing),
        })
    }

    #[test]
    fn an_order_is_used_where_there_is_one() {
        let found = Estimate::of(refined(|s| 3.0 + 0.2 * (1.0 + 4.0 * s * s)), 3.0);
        // the iteration for the order stops at 1e-9
        assert!((found.order.unwrap_or(0.0) - 2.0).abs() < 1e-6, "{found:?}");
        assert!((found.limit.unwrap_or(0.0) - 3.2).abs() < 1e-8, "{found:?}");
        // 1 % at 0.05, relative to what is over 3, and a quarter for safety
        assert!((found.error - 1.25 * 0.01 / 1.01).abs() < 1e-6, "{found:?}");
        let spacing = found.spacing_for(0.05);
        assert!((found.error_at(spacing) - 0.05).abs() < 1e-12);
        assert!((spacing - 0.05 * (0.05 / found.error).sqrt()).abs() < 1e-6);
    }

    #[test]
    fn an_order_too_good_is_not_counted_on() {
        let found = Estimate::of(refined(|s| 1.0 + s.powi(5)), 0.0);
        assert!(
            (found.order.unwrap_or(0.0) - 2.0).abs() < 1e-12,
            "{found:?}"
        );
        let left = (0.07_f64.powi(5) - 0.05_f64.powi(5)) / ((0.07_f64 / 0.05).powi(2) - 1.0);
        assert!((found.error - 3.0 * left).abs() < 1e-3 * left, "{found:?}");
        assert_eq!(found.observed_order(), None);
        // nor is a run coarser than the finest
        assert_eq!(rows_for(&found, 0.9, 1.0, 30.0), 20.0);
    }

    #[test]
    fn without_an_order_the_largest_difference_counts() {
        let found = Estimate::of(refined(|s| if s == 0.07 { 1.1 } else { 1.0 }), 0.0);
        assert_eq!(found.order, None);
        // 0.1 over 0.02 m, at 0.05 m, three times for safety
        assert!((found.error - 0.75).abs() < 1e-12, "{found:?}");
        assert!((found.error_at(0.025) - 0.375).abs() < 1e-12);
    }

    #[test]
    fn rows_are_whole_and_bounded() {
        assert_eq!(levels(30.0), [10.0, 14.0, 20.0]);
        assert_eq!(levels(8.0), [5.0, 7.0, 10.0]);
        let found = Estimate::of(refined(|s| 1.0 + s), 0.0);
        // e = 1.25 s/(1 + 0.05): 2.5 % at 0.021 m
        assert_eq!(rows_for(&found, 0.025, 1.0, 30.0), 48.0);
        assert_eq!(rows_for(&found, 0.001, 1.0, 30.0), 60.0);
        assert_eq!(rows_for(&found, 0.9, 1.0, 30.0), 10.0);
    }
}
