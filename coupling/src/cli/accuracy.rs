//! `riprap run --error`: choice of settings for an error budget, and verification after the run.

mod by_refinement;
mod by_study;
mod verification;

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::atomic::AtomicBool;

use super::{Exit, Program, refused};
use crate::messages::{Code, Message};
use crate::scene::parse::Override;
use crate::scene::resolve::Scene;
use crate::study::trade::file::StudyFile;
use crate::study::trade::outcome::Outcome;
use crate::study::trade::reading::Reading;
use crate::study::trade::refinement::Level;
use verification::Report;

/// A relative error, as `5%` or `0.05`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Budget(f64);

impl FromStr for Budget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is not an error budget; write 5% or 0.05");
        let value = match text.trim().strip_suffix('%') {
            Some(percent) => percent.trim().parse::<f64>().map(|p| p / 100.0),
            None => text.trim().parse::<f64>(),
        };
        let value = value.map_err(|_| wrong())?;
        if 0.0 < value && value < 1.0 {
            Ok(Self(value))
        } else {
            Err(wrong())
        }
    }
}

/// Accuracy requested of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked<'a> {
    pub(super) case: &'a Path,
    pub(super) budget: Budget,
    /// Quantity.
    pub(super) of: Option<&'a str>,
    /// Overrides of the user, which take precedence over the chosen ones.
    pub(super) overrides: &'a [Override],
    /// Folder of the run; coarse runs are in subfolders.
    pub(super) folder: &'a Path,
    /// Starts the coarse runs.
    pub(super) program: &'a Program,
    /// Number of concurrent coarse runs.
    pub(super) jobs: Option<usize>,
}

/// Settings for a run, and the criterion of its evaluation.
#[derive(Debug)]
pub(super) struct Chosen {
    /// Chosen overrides, before those of the user.
    pub(super) overrides: Vec<Override>,
    report: Report,
    basis: Basis,
}

/// Source of a prediction.
#[derive(Debug)]
enum Basis {
    Study {
        path: PathBuf,
        file: StudyFile,
        known: Vec<Outcome>,
        choice: Vec<usize>,
    },
    Refinement {
        reading: Reading,
        /// Coarse to fine.
        levels: [Level; 3],
        spacing: f64,
    },
}

/// Chooses settings and reports them with the reason.
pub(super) fn plan(asked: &Asked, scene: &Scene, stop: &AtomicBool) -> Result<Chosen, Exit> {
    match by_study::study_of(asked).map_err(|what| refused(no_estimate(what)))? {
        Some((path, file)) => by_study::choose(asked, path, file),
        None => by_refinement::choose(asked, scene, stop),
    }
}

/// Why there is no estimate of an error.
fn no_estimate(what: String) -> Message {
    Message::new(Code::NoErrorEstimate, what)
}
