//! Schema of a study: RON, unknown fields rejected.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::quantity::Take;
use crate::output::run_folder;

/// A study: one case, one quantity with its reference value, and knobs with values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyFile {
    /// Title in tables and plots.
    pub title: String,
    /// The scene, as a path relative to the study.
    pub case: String,
    /// Fields of the scene set in all runs, as `PATH=VALUE`.
    #[serde(default)]
    pub set: Vec<String>,
    /// The quantity by which runs are compared.
    pub output: OutputFile,
    /// Its reference value.
    pub truth: TruthFile,
    /// Varied parameters.
    pub knobs: Vec<KnobFile>,
    /// Combinations that are run.
    #[serde(default)]
    pub design: DesignFile,
}

/// A quantity evaluated from a table of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputFile {
    /// Name in tables and plots.
    pub name: String,
    /// The table in the run folder.
    #[serde(default = "gauges")]
    pub file: String,
    /// Column name, with or without unit.
    pub column: String,
    /// Name of the block whose rows are used, in a table with rows of several.
    pub block: Option<String>,
    /// Evaluation of the column; a reference that is a record uses all of it.
    pub take: Option<Take>,
}

fn gauges() -> String {
    run_folder::GAUGES.to_owned()
}

/// Reference value. Errors are relative to it, or to `scale`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum TruthFile {
    /// A number and its source.
    Value {
        /// The number, in the column's unit.
        value: f64,
        /// Scale of the errors.
        scale: Option<f64>,
        /// An equation, a table, a paper.
        source: String,
    },
    /// A closed-form solution.
    Closed {
        /// The solution.
        form: ClosedForm,
        /// Scale of the errors.
        scale: Option<f64>,
    },
    /// A record, compared over time: the error is the root mean square difference over the record's range.
    Record {
        /// CSV of time and value, as a path relative to the study.
        file: String,
        /// Added to the times of runs; s.
        #[serde(default)]
        shift: f64,
        /// Window in the time of the record; s.
        window: Option<(f64, f64)>,
    },
    /// The finest run is the reference for the others and has no error itself.
    Finest {
        /// The knob whose smallest value, given by `at`, is the finest.
        knob: String,
    },
}

/// Closed-form reference values; SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum ClosedForm {
    /// Pressure of water at rest, ρ g z; Pa.
    Hydrostatic {
        /// kg/m³.
        density: f64,
        /// m/s².
        gravity: f64,
        /// Below the water level; m.
        depth: f64,
        /// Includes compressibility, c₀²ρ₀(exp(g z/c₀²) - 1); m/s.
        sound_speed: Option<f64>,
    },
    /// Period of a standing wave of small height, 2π/√(g k tanh(k d)); s.
    StandingWave {
        /// m/s².
        gravity: f64,
        /// Wave length; m.
        length: f64,
        /// Water depth; m.
        depth: f64,
    },
    /// Displacement of a block sliding from rest, g (sin β - cos β tan φ) t²/2, zero below the friction angle; m.
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
    /// Its value.
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

/// A parameter: a field with values, or values that set several fields each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KnobFile {
    /// Name in tables and plots.
    pub name: String,
    /// The first one is used while other knobs are varied.
    pub values: Vec<ValueFile>,
}

/// A value of a knob.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ValueFile {
    /// Name in tables and plots.
    pub name: String,
    /// Numerical value, if there is one: an order of convergence is fitted to it.
    pub at: Option<f64>,
    /// Fields of the scene that it sets, as `PATH=VALUE`; empty for the unchanged scene.
    #[serde(default)]
    pub set: Vec<String>,
}

/// Design of a study: the combinations of values that are run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum DesignFile {
    /// One knob varied at a time, the others at their first values.
    #[default]
    OneAtATime,
    /// All combinations.
    FullGrid,
    /// One knob at a time, then the combinations predicted to advance the Pareto front most, four at a time; those that the
    /// scene refuses are skipped and listed.
    Search {
        /// Largest total number of runs.
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
