//! Extrapolation from three coarse runs to finer ones, where there is no study.
//!
//! ```text
//! e(s) = safety · |f∞ − f₁| (s/s₁)^p / |f₁ − f₀|        f₀ the value that means nothing, such as the level of rest
//! ```
//! `p` and `f∞` are Richardson's where the three come closer from one side; an order that schemes do not have is taken for the
//! nearest that they have, with a larger safety factor (Oberkampf & Roy 2010, Verification and Validation in Scientific
//! Computing, 8.7). Where they do not, the error is taken to fall with the spacing itself from the largest difference between
//! any two. Only the error of the spacing is seen: what a scheme or a scene does wrong at any spacing is not.

use super::front::convergence;

/// Roache's safety factor where the order was observed.
const SAFETY: f64 = 1.25;
/// The same where it was not, or is none that a scheme has.
const SAFETY_WITHOUT_ORDER: f64 = 3.0;
/// Orders that a scheme of second order shows on the way to its limit.
const ORDERS: std::ops::RangeInclusive<f64> = 0.5..=2.5;
/// Formal order, the most that is counted on.
const FORMAL_ORDER: f64 = 2.0;
/// Rows of water of the rungs, of those of the finest.
const RUNGS: [f64; 3] = [0.5, std::f64::consts::FRAC_1_SQRT_2, 1.0];
/// Rows of the finest rung, of those of the scene.
const FINEST_RUNG: f64 = 2.0 / 3.0;
/// Rows of the finest rung at least.
const LEAST_ROWS: f64 = 10.0;
/// Rows of the final run at most, of those of the scene: a spacing is what its author is ready to pay for.
const MOST_ROWS: f64 = 2.0;

/// A number at a spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rung {
    /// m.
    pub spacing: f64,
    /// Of any unit.
    pub value: f64,
}

/// How the error falls with the spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Observed, or the nearest that schemes have; none where the runs do not come closer from one side.
    pub order: Option<f64>,
    /// Whether the order is the observed one: else coarser runs than the finest are not believed.
    pub is_observed: bool,
    /// Richardson's limit, where there is an order.
    pub limit: Option<f64>,
    /// Relative error of the finest, safety included: the grid convergence index where there is an order.
    pub error: f64,
    spacing: f64,
}

impl Estimate {
    /// Of three runs, coarse to fine, about a value that means nothing.
    pub fn of(rungs: [Rung; 3], zero: f64) -> Self {
        let values = rungs.map(|rung| rung.value - zero);
        let found = convergence(rungs.map(|rung| rung.spacing), values);
        let spacing = rungs[2].spacing;
        if let Some(found) = found {
            let (order, safety) = match ORDERS.contains(&found.order) {
                true => (found.order, SAFETY),
                false => (
                    found.order.clamp(*ORDERS.start(), FORMAL_ORDER),
                    SAFETY_WITHOUT_ORDER,
                ),
            };
            let gain = (rungs[1].spacing / spacing).powf(order) - 1.0;
            let left = (values[2] - values[1]) / gain;
            return Self {
                order: Some(order),
                is_observed: order == found.order,
                limit: Some(rungs[2].value + left),
                error: safety * (left / values[2]).abs(),
                spacing,
            };
        }
        let pairs = [(0, 1), (0, 2), (1, 2)];
        let slope = pairs
            .map(|(a, b)| ((values[a] - values[b]) / (rungs[a].spacing - rungs[b].spacing)).abs())
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

    /// The order where it is what was observed, not the nearest that schemes have.
    pub fn observed_order(&self) -> Option<f64> {
        self.order.filter(|_| self.is_observed)
    }

    /// Expected at another spacing (m).
    pub fn error_at(&self, spacing: f64) -> f64 {
        self.error * (spacing / self.spacing).powf(self.order.unwrap_or(1.0))
    }

    /// Coarsest spacing that is expected to meet a budget; m.
    pub fn spacing_for(&self, budget: f64) -> f64 {
        self.spacing * (budget / self.error).powf(1.0 / self.order.unwrap_or(1.0))
    }
}

/// Rows of water of the three rungs for a scene with so many, coarse to fine.
pub fn rungs(rows: f64) -> [f64; 3] {
    let finest = (FINEST_RUNG * rows).max(LEAST_ROWS).round();
    RUNGS.map(|share| (share * finest).round())
}

/// Rows of the run that is to meet a budget: whole, so that the surface stays where it is; at least those of the coarsest
/// rung, of the finest where no order was observed, at most twice those of the scene.
pub fn rows_for(estimate: &Estimate, budget: f64, depth: f64, rows: f64) -> f64 {
    let wanted = depth / estimate.spacing_for(budget);
    // NaN of a ladder that says nothing is as much as may be
    let most = (MOST_ROWS * rows).round();
    if wanted.is_nan() {
        return most;
    }
    let least = rungs(rows)[if estimate.is_observed { 0 } else { 2 }];
    wanted.ceil().clamp(least.min(most), most)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ladder(value: impl Fn(f64) -> f64) -> [Rung; 3] {
        [0.1, 0.07, 0.05].map(|spacing| Rung {
            spacing,
            value: value(spacing),
        })
    }

    #[test]
    fn an_order_is_used_where_there_is_one() {
        let found = Estimate::of(ladder(|s| 3.0 + 0.2 * (1.0 + 4.0 * s * s)), 3.0);
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
        let found = Estimate::of(ladder(|s| 1.0 + s.powi(5)), 0.0);
        assert!(
            (found.order.unwrap_or(0.0) - 2.0).abs() < 1e-12,
            "{found:?}"
        );
        let left = (0.07_f64.powi(5) - 0.05_f64.powi(5)) / ((0.07_f64 / 0.05).powi(2) - 1.0);
        assert!((found.error - 3.0 * left).abs() < 1e-3 * left, "{found:?}");
        assert_eq!(found.observed_order(), None);
        // nor is anything coarser than the finest rung
        assert_eq!(rows_for(&found, 0.9, 1.0, 30.0), 20.0);
    }

    #[test]
    fn without_an_order_the_largest_difference_counts() {
        let found = Estimate::of(ladder(|s| if s == 0.07 { 1.1 } else { 1.0 }), 0.0);
        assert_eq!(found.order, None);
        // 0.1 over 0.02 m, at 0.05 m, three times for safety
        assert!((found.error - 0.75).abs() < 1e-12, "{found:?}");
        assert!((found.error_at(0.025) - 0.375).abs() < 1e-12);
    }

    #[test]
    fn rows_are_whole_and_bounded() {
        assert_eq!(rungs(30.0), [10.0, 14.0, 20.0]);
        assert_eq!(rungs(8.0), [5.0, 7.0, 10.0]);
        let found = Estimate::of(ladder(|s| 1.0 + s), 0.0);
        // e = 1.25 s/(1 + 0.05): 2.5 % at 0.021 m
        assert_eq!(rows_for(&found, 0.025, 1.0, 30.0), 48.0);
        assert_eq!(rows_for(&found, 0.001, 1.0, 30.0), 60.0);
        assert_eq!(rows_for(&found, 0.9, 1.0, 30.0), 10.0);
    }
}
