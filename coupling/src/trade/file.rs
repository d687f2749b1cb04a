//! A study as written: RON, unknown fields refused.

use serde::{Deserialize, Serialize};

use super::quantity::Take;

/// A study: one case, one number with its truth, and knobs with values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyFile {
    /// Of tables and plots.
    pub title: String,
    /// The scene, by its path from the study.
    pub case: String,
    /// Fields of the scene that all runs set, as `PATH=VALUE`.
    #[serde(default)]
    pub set: Vec<String>,
    /// The number that runs are judged by.
    pub output: OutputFile,
    /// What it should be.
    pub truth: TruthFile,
    /// What is varied.
    pub knobs: Vec<KnobFile>,
    /// Which combinations are run.
    #[serde(default)]
    pub design: DesignFile,
}

/// A number read off a table of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OutputFile {
    /// Of tables and plots.
    pub name: String,
    /// The table in the run folder.
    #[serde(default = "gauges")]
    pub file: String,
    /// Its column, with or without unit.
    pub column: String,
    /// Name of the block whose rows are meant, in a table that has rows of several.
    pub block: Option<String>,
    /// What becomes of the column; a truth that is a record takes all of it.
    pub take: Option<Take>,
}

fn gauges() -> String {
    "gauges.csv".to_owned()
}

/// What the number should be. Errors are relative to it, or to `scale`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum TruthFile {
    /// A number and where it is from; of the output's unit.
    Value {
        /// The number.
        value: f64,
        /// What errors are relative to; the number itself when left out.
        scale: Option<f64>,
        /// Where it is from: an equation, a table, a paper.
        source: String,
    },
    /// A closed form.
    Closed {
        /// Which.
        form: ClosedForm,
        /// What errors are relative to; the number itself when left out.
        scale: Option<f64>,
    },
    /// A record of one's own, compared over time: the error is the root mean square difference over the record's range.
    Record {
        /// CSV by its path from the study: time and value.
        file: String,
        /// Added to the times of runs; s.
        #[serde(default)]
        shift: f64,
        /// Window on the record's clock; s.
        window: Option<(f64, f64)>,
    },
    /// The finest of the runs: that with the smallest value of a knob. It judges the others and has no error itself.
    Finest {
        /// The knob, whose values say what they are `at`.
        knob: String,
    },
}

/// Truths that are formulas; SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ClosedForm {
    /// Pressure of water at rest, `ρ g z`, with its own compression `c₀²ρ₀(e^{g z/c₀²} − 1)` where `sound_speed` is given; Pa.
    Hydrostatic {
        /// kg/m³.
        density: f64,
        /// m/s².
        gravity: f64,
        /// Under the level; m.
        depth: f64,
        /// c₀; m/s.
        sound_speed: Option<f64>,
    },
    /// Period of a standing wave of small height, `2π/√(g k tanh(k d))`; s.
    StandingWave {
        /// m/s².
        gravity: f64,
        /// Of the wave; m.
        length: f64,
        /// Of the water; m.
        depth: f64,
    },
    /// Way of a block that slides from rest, `g (sin β − cos β tan φ) t²/2`, zero below the friction angle; m.
    Sliding {
        /// m/s².
        gravity: f64,
        /// β; degrees.
        slope_deg: f64,
        /// φ; degrees.
        friction_angle_deg: f64,
        /// s.
        time: f64,
    },
}

impl ClosedForm {
    /// Its number.
    pub fn value(&self) -> f64 {
        match *self {
            Self::Hydrostatic {
                density,
                gravity,
                depth,
                sound_speed,
            } => match sound_speed {
                None => density * gravity * depth,
                Some(c) => density * c * c * (gravity * depth / (c * c)).exp_m1(),
            },
            Self::StandingWave {
                gravity,
                length,
                depth,
            } => {
                let k = std::f64::consts::TAU / length;
                std::f64::consts::TAU / (gravity * k * (k * depth).tanh()).sqrt()
            }
            Self::Sliding {
                gravity,
                slope_deg,
                friction_angle_deg,
                time,
            } => {
                let (sin, cos) = slope_deg.to_radians().sin_cos();
                let pull = sin - cos * friction_angle_deg.to_radians().tan();
                0.5 * gravity * pull.max(0.0) * time * time
            }
        }
    }
}

/// A knob: a field with values, or values that set several fields each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnobFile {
    /// Of tables and plots.
    pub name: String,
    /// The first one is where the knob stands while others are turned.
    pub values: Vec<ValueFile>,
}

/// A value of a knob.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ValueFile {
    /// Of tables and plots.
    pub name: String,
    /// As a number, where it is one: an order of convergence is fitted to it.
    pub at: Option<f64>,
    /// Fields of the scene that it sets, as `PATH=VALUE`; none leaves the scene as it is.
    #[serde(default)]
    pub set: Vec<String>,
}

/// Which combinations of values are run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum DesignFile {
    /// One knob away from the first values of all.
    #[default]
    OneAtATime,
    /// All.
    FullGrid,
    /// One knob away from the first values of all, then those combinations that are foretold to push the front out
    /// farthest, a few at a time.
    Search {
        /// At most so many in all.
        runs: usize,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_have_known_values() {
        let still = |sound_speed| ClosedForm::Hydrostatic {
            density: 1000.0,
            gravity: 9.81,
            depth: 2.0,
            sound_speed,
        };
        assert!((still(None).value() - 19_620.0).abs() < 1e-9);
        // more by half of g z/c², and a sixth of its square
        let x: f64 = 9.81 * 2.0 / 1600.0;
        let more = still(Some(40.0)).value() / still(None).value() - 1.0;
        assert!((more - x / 2.0 - x * x / 6.0).abs() < x.powi(3), "{more}");
        // deep water: L = g T²/(2π)
        let wave = ClosedForm::StandingWave {
            gravity: 9.81,
            length: 1.0,
            depth: 10.0,
        };
        let deep = (std::f64::consts::TAU / 9.81).sqrt();
        assert!((wave.value() / deep - 1.0).abs() < 1e-12);
        // 1.812815 m/s², of tests/coupling/program.rs
        let slide = |friction_angle_deg| ClosedForm::Sliding {
            gravity: 9.81,
            slope_deg: 30.0,
            friction_angle_deg,
            time: 1.0,
        };
        assert!((slide(20.0).value() - 0.5 * 1.812_815).abs() < 1e-6);
        assert!(slide(31.0).value().abs() < 1e-300);
    }
}
