//! Schema of a sweep: RON, unknown fields rejected.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::trade::file::OutputFile;

/// A sweep: one case, inputs with their values or distributions, and the quantities that are read from each run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepFile {
    /// Title in tables and plots.
    pub title: String,
    /// The scene, as a path relative to the sweep.
    pub case: String,
    /// Fields of the scene set in all runs, as `PATH=VALUE`.
    #[serde(default)]
    pub set: Vec<String>,
    /// Varied parameters.
    pub inputs: Vec<InputFile>,
    /// Quantities read from each run.
    pub outputs: Vec<OutputFile>,
    /// Combinations of inputs that are run.
    pub design: SweepDesignFile,
    /// Repetitions of every combination with other seeds.
    pub replicas: Option<ReplicasFile>,
}

/// An input and the fields of the scene that it sets.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InputFile {
    /// Name in tables and plots, with its unit, such as `friction angle [deg]`.
    pub name: String,
    /// Fields that it sets, as `PATH=VALUE` with `{}` for the value.
    pub set: Vec<String>,
    /// Its values.
    pub values: ValuesFile,
}

/// Values of an input. Drawn numbers are rounded to six digits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum ValuesFile {
    /// Given numbers, as `Numbers([1, 2])`; equally likely in a random design.
    Numbers(Vec<f64>),
    /// Given texts, as `Texts(["Standard", "Reference"])`; equally likely in a random design.
    Texts(Vec<String>),
    /// Evenly distributed.
    Uniform {
        /// Smallest value.
        from: f64,
        /// Largest value.
        to: f64,
    },
    /// With an evenly distributed logarithm.
    LogUniform {
        /// Smallest value, > 0.
        from: f64,
        /// Largest value.
        to: f64,
    },
    /// With a density that rises to a most likely value and falls behind it.
    Triangular {
        /// Smallest value.
        from: f64,
        /// Most likely value.
        mode: f64,
        /// Largest value.
        to: f64,
    },
    /// Normally distributed.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        standard_deviation: f64,
    },
    /// With a normally distributed logarithm.
    LogNormal {
        /// Median, > 0.
        median: f64,
        /// Standard deviation of the natural logarithm; –.
        standard_deviation: f64,
    },
}

/// Design of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum SweepDesignFile {
    /// All combinations of given values.
    Grid,
    /// The first values of all inputs together, then the second ones, ...: a table of runs.
    List,
    /// Latin hypercube: each input has one value in each of as many equally likely parts as there are runs.
    LatinHypercube {
        /// Runs.
        runs: usize,
        /// Any number; another one gives another draw.
        seed: u64,
    },
    /// Scrambled Sobol sequence, which a longer sweep continues.
    Sobol {
        /// Runs; best a power of 2.
        runs: usize,
        /// Any number; another one gives another draw.
        seed: u64,
    },
    /// Design for first-order and total Sobol indices: `samples × (inputs + 2)` runs.
    SobolIndices {
        /// Best a power of 2.
        samples: usize,
        /// Any number; another one gives another draw.
        seed: u64,
    },
}

/// Repetitions with other seeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReplicasFile {
    /// Repetitions of every combination.
    pub number: usize,
    /// Fields that get 1, 2, ..., as `PATH={}`, such as `rock_masses.slide.seed={}`.
    pub set: Vec<String>,
}

impl InputFile {
    /// Given values as texts; `None` for a distribution.
    pub fn given(&self) -> Option<Vec<String>> {
        match &self.values {
            ValuesFile::Numbers(numbers) => Some(numbers.iter().map(f64::to_string).collect()),
            ValuesFile::Texts(texts) => Some(texts.clone()),
            _ => None,
        }
    }
}
