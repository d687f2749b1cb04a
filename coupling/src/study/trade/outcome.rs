//! Outcome of one run of a study: value, error and cost.

use serde::Deserialize;

use super::front::Point;

/// Pair interactions at the cost of one contact update, by the speeds in benches/RESULTS.md:
/// 3e8 pairs and 3e5 contacts a second and core.
const PAIRS_PER_CONTACT: f64 = 1e3;

/// Outcome of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Index of the value of each knob.
    pub choice: Vec<usize>,
    /// Name of its folder.
    pub key: String,
    /// Evaluated quantity; `None` for an incomplete run, or if the reference is a record.
    pub value: Option<f64>,
    /// Relative error; `None` without a value, and for the reference itself.
    pub error: Option<f64>,
    /// Whether the run reached its end.
    pub is_stable: bool,
    /// Error message of an incomplete run.
    pub message: String,
    /// Cost of the run.
    pub cost: Cost,
}

/// Cost of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Cost {
    /// Wall time on one thread, settling and output included; s.
    pub wall_time: f64,
    /// Largest memory held; bytes.
    pub peak_memory: f64,
    /// Steps.
    pub steps: f64,
    /// Particles times steps.
    pub particle_steps: f64,
    /// Ordered neighbor pairs evaluated.
    pub pair_interactions: f64,
    /// Contact points evaluated.
    pub contact_updates: f64,
    /// Deepest particle in a solid over the spacing; `None` in records of older runs.
    pub max_wall_penetration_over_spacing: Option<f64>,
    /// Gap between walls and water over the spacing; `None` without such water, and in records of older runs.
    pub wall_gap_over_spacing: Option<f64>,
}

/// One of the costs of a run.
pub type CostOf = fn(&Cost) -> f64;

impl Cost {
    /// Work, independent of the machine: pair interactions, with contacts converted to them.
    pub fn work(&self) -> f64 {
        self.pair_interactions + PAIRS_PER_CONTACT * self.contact_updates
    }
}

/// Cost and error of a run, NaN where it has none.
pub fn point(found: &Outcome, cost: CostOf) -> Point {
    Point {
        cost: cost(&found.cost),
        error: found.error.filter(|_| found.is_stable).unwrap_or(f64::NAN),
    }
}
