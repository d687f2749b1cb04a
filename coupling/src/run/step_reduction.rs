//! Recovery from a failed step: from the last good state, with half the step for a while.

use serde::{Deserialize, Serialize};

/// Largest number of successive halvings of the step.
const MOST_HALVINGS: u32 = 5;
/// Successive halvings without progress after which the step is not considered the cause.
const MOST_IN_VAIN: u32 = 2;
/// Smallest progress of a useful attempt, over the time from the good state to the failure.
const FARTHER: f64 = 0.05;

/// Attempts to recover from a failure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct StepReduction {
    /// Current number of halvings.
    halvings: u32,
    in_vain: u32,
    /// Latest time reached before a failure; s.
    failed_at: f64,
    /// End of the short steps; s.
    until: f64,
    /// Number of recoveries since the start of the run.
    n_falls: u64,
}

impl StepReduction {
    /// Whether steps are short at a time (s).
    pub fn is_on(&self, time: f64) -> bool {
        0 < self.halvings && time < self.until
    }

    /// Fraction of the usual step at a time (s).
    pub fn share(&self, time: f64) -> f64 {
        match self.is_on(time) {
            true => 0.5_f64.powi(self.halvings as i32),
            false => 1.0,
        }
    }

    /// Ends the reduction after the failure was passed.
    pub fn end(&mut self) {
        *self = Self {
            n_falls: self.n_falls,
            ..Self::default()
        };
    }

    /// Reduction after another failure at a given time, from a good state; `None` if reduction does not help. Steps are short
    /// until as far beyond the failure as it is from the good state.
    pub fn after(&self, failed_at: f64, good: f64) -> Option<Self> {
        let is_first = self.halvings == 0;
        let helped = FARTHER * (self.failed_at - good) < failed_at - self.failed_at;
        let in_vain = if is_first || helped {
            0
        } else {
            self.in_vain + 1
        };
        if self.halvings == MOST_HALVINGS || in_vain == MOST_IN_VAIN {
            return None;
        }
        let failed_at = if is_first {
            failed_at
        } else {
            failed_at.max(self.failed_at)
        };
        Some(Self {
            halvings: self.halvings + 1,
            in_vain,
            failed_at,
            // beyond it even if the first step fails
            until: failed_at + (failed_at - good).max(f64::MIN_POSITIVE),
            n_falls: self.n_falls + 1,
        })
    }

    /// Number of recoveries since the start of the run.
    pub fn n_falls(&self) -> u64 {
        self.n_falls
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tries(failures: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut reduction = StepReduction::default();
        let mut shares = Vec::new();
        for failed_at in failures {
            match reduction.after(failed_at, 1.0) {
                None => break,
                Some(next) => reduction = next,
            }
            shares.push(reduction.share(1.0));
        }
        shares
    }

    #[test]
    fn a_failure_that_no_step_moves_is_given_up_soon() {
        assert_eq!(tries(std::iter::repeat_n(2.0, 9)), [0.5, 0.25]);
    }

    #[test]
    fn as_long_as_a_try_comes_farther_another_is_made_but_no_more_than_five() {
        assert_eq!(
            tries((0..9).map(|k| 2.0 + 0.2 * f64::from(k))),
            [0.5, 0.25, 0.125, 0.0625, 0.03125]
        );
    }

    #[test]
    fn steps_are_short_until_well_past_the_failure() {
        let reduction = StepReduction::default().after(2.0, 1.0);
        let share = |time: f64| reduction.map(|reduction| reduction.share(time));
        assert_eq!(
            [share(1.0), share(2.9), share(3.0)],
            [Some(0.5), Some(0.5), Some(1.0)]
        );
    }
}
