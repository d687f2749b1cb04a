//! Limit of the wall time of a run, as batch systems set it: the run ends in good order before it.

use std::time::{Duration, Instant};

/// Reserve for what cannot be measured before the end, such as the overview; share of the limit.
const MARGIN: f64 = 0.01;
/// The same at most.
const LARGEST_MARGIN: Duration = Duration::from_secs(60);
/// Safety of the measured costs: a disk may be slower than it was.
const SAFETY: f64 = 1.5;
/// Decay of the longest step: one that was slow once does not count forever.
const DECAY: f64 = 0.99;

/// Wall time that a run may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WallLimit {
    /// Start of the program.
    pub started: Instant,
    /// From then on.
    pub limit: Duration,
}

/// Wall times of what is still to be done when a run ends, as measured so far; s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Reserve {
    step: f64,
    output: f64,
    checkpoint: Option<f64>,
}

impl Reserve {
    pub fn add_step(&mut self, wall: f64) {
        self.step = wall.max(DECAY * self.step);
    }

    pub fn add_output(&mut self, wall: f64) {
        self.output = wall.max(self.output);
    }

    pub fn add_checkpoint(&mut self, wall: f64) {
        self.checkpoint = Some(wall.max(self.checkpoint.unwrap_or(0.0)));
    }

    /// Whether the cost of a checkpoint is known.
    pub fn knows_checkpoint(&self) -> bool {
        self.checkpoint.is_some()
    }

    /// A step more, the last records, the pictures (as long as these), and a checkpoint; s.
    fn total(&self) -> f64 {
        SAFETY * (self.step + 2.0 * self.output + self.checkpoint.unwrap_or(0.0))
    }
}

impl WallLimit {
    /// Whether there is no time for another step at `now`.
    pub(super) fn is_reached(&self, now: Instant, reserve: &Reserve) -> bool {
        let margin = self.limit.mul_f64(MARGIN).min(LARGEST_MARGIN);
        let used = now.saturating_duration_since(self.started).as_secs_f64();
        self.limit.as_secs_f64() <= used + reserve.total() + margin.as_secs_f64()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cost_of_the_end_is_kept_back() {
        let started = Instant::now();
        let limit = WallLimit {
            started,
            limit: Duration::from_secs(1000),
        };
        let is_reached = |after: u64, reserve: &Reserve| {
            limit.is_reached(started + Duration::from_secs(after), reserve)
        };
        let mut reserve = Reserve::default();
        // 10 s of margin
        assert!(!is_reached(989, &reserve) && is_reached(990, &reserve));
        reserve.add_checkpoint(20.0);
        reserve.add_checkpoint(4.0);
        reserve.add_output(10.0);
        reserve.add_step(20.0);
        // 1.5 × (20 + 20 + 20)
        assert!(!is_reached(899, &reserve) && is_reached(900, &reserve));
    }
}
