//! Pace of a run: simulated time over wall time, recent steps weighing more.

/// Wall time over which the pace is averaged, at least; s.
const LEAST_MEMORY: f64 = 20.0;
/// The same as a share of the wall time so far: what is left of a long run is estimated from a long part of it.
const MEMORY: f64 = 0.25;

/// Decaying sums of wall time, simulated time and steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pace {
    /// Wall time so far; s.
    elapsed: f64,
    wall: f64,
    simulated: f64,
    steps: f64,
}

impl Pace {
    /// Adds a step that took `wall` and advanced the run by `simulated` seconds, less than none if it fell back.
    pub fn add(&mut self, wall: f64, simulated: f64) {
        self.elapsed += wall;
        let memory = (MEMORY * self.elapsed).max(LEAST_MEMORY);
        let kept = (-wall / memory).exp();
        self.wall = kept * self.wall + wall;
        self.simulated = kept * self.simulated + simulated;
        self.steps = kept * self.steps + 1.0;
    }

    /// Wall time for `rest` seconds of simulated time; s. `None` before the run has advanced.
    pub fn left(&self, rest: f64) -> Option<f64> {
        let left = rest * self.wall / self.simulated;
        (0.0 < self.simulated && left.is_finite()).then_some(left)
    }

    /// Steps per second of wall time; 1/s.
    pub fn steps_per_second(&self) -> f64 {
        self.steps / self.wall.max(1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_takes_as_long_as_recent_steps_say() {
        let mut pace = Pace::default();
        assert_eq!(pace.left(1.0), None);
        // 10 s of settling with 0.1 s a step of 1 ms
        for _ in 0..100 {
            pace.add(0.1, 1e-3);
        }
        let left = pace.left(2.0);
        assert!(
            left.is_some_and(|left| (left - 200.0).abs() < 1e-6),
            "{left:?}"
        );
        assert!((pace.steps_per_second() - 10.0).abs() < 1e-6);
        // steps become four times shorter: after a few memories only they count
        for _ in 0..2000 {
            pace.add(0.1, 0.25e-3);
        }
        let left = pace.left(1.0);
        assert!(
            left.is_some_and(|left| (left / 400.0 - 1.0).abs() < 0.05),
            "{left:?}"
        );
    }

    #[test]
    fn a_run_that_falls_back_more_than_it_advances_has_no_pace() {
        let mut pace = Pace::default();
        pace.add(0.1, 1e-3);
        pace.add(0.1, -5e-3);
        assert_eq!(pace.left(1.0), None);
    }
}
