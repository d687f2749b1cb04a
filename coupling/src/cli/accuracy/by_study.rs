//! Choice of settings from the results of a study of the case.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::verification::Report;
use super::{Asked, Basis, Budget, Chosen, no_estimate};
use crate::cli::{Exit, refused, say};
use crate::scene::parse::Override;
use crate::study::trade::budget::{self, Expected, candidates};
use crate::study::trade::file::StudyFile;
use crate::study::trade::outcome::Outcome;
use crate::study::trade::plan;
use crate::study::trade::results::read;

/// Folder with studies of cases, in addition to the folder of the case.
const STUDIES: &str = "benches/trade";
/// Folder with the results of `riprap study`.
const MEASURED: &str = "runs/trade";

/// The study of the case with a name: that of its file or its output; by default the only one.
pub(super) fn study_of(asked: &Asked) -> Result<Option<(PathBuf, StudyFile)>, String> {
    let case = asked.case.canonicalize().ok();
    let folder = asked.case.parent().unwrap_or(Path::new("."));
    let mut found = Vec::new();
    for folder in [folder, Path::new(STUDIES)] {
        let Ok(entries) = folder.read_dir() else {
            continue;
        };
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        paths.sort();
        let is_ron = |path: &PathBuf| path.extension().is_some_and(|end| end == "ron");
        for path in paths.into_iter().filter(is_ron) {
            // other files are scenes
            let Ok((file, _)) = plan::read(&path) else {
                continue;
            };
            let of = path.parent().map(|folder| folder.join(&file.case));
            if of.and_then(|of| of.canonicalize().ok()) == case {
                found.push((path, file));
            }
        }
    }
    let stem = |path: &Path| path.file_stem().map(|s| s.to_string_lossy().into_owned());
    match asked.of {
        Some(name) => {
            let is_meant = |(path, file): &(PathBuf, StudyFile)| {
                file.output.name == name || stem(path).as_deref() == Some(name)
            };
            Ok(found.into_iter().find(is_meant))
        }
        None if found.len() < 2 => Ok(found.pop()),
        None => {
            let names: Vec<String> = found.iter().filter_map(|(path, _)| stem(path)).collect();
            Err(format!(
                "the case has several studies: choose one with --of: {}",
                names.join(", ")
            ))
        }
    }
}

/// Results of a study, measured here or shipped with it.
fn measured(path: &Path, file: &StudyFile) -> Result<(PathBuf, Vec<Outcome>), String> {
    let name = path.file_stem().unwrap_or_default();
    let beside = path.parent().unwrap_or(Path::new(".")).join("results");
    let places = [Path::new(MEASURED), &beside].map(|folder| folder.join(name).join("trade.csv"));
    let Some(table) = places.iter().find(|place| place.is_file()) else {
        return Err(format!(
            "no results of {0} yet: run `riprap study {0}`",
            path.display()
        ));
    };
    Ok((table.clone(), read(file, table)?))
}

/// Choice from the results of a study.
struct FromStudy {
    file: StudyFile,
    /// `trade.csv`.
    table: PathBuf,
    known: Vec<Outcome>,
    expected: Expected,
    /// Whether the choice is expected to meet the budget.
    is_within: bool,
}

/// Chooses the cheapest settings that meet the budget, or the most accurate ones.
pub(super) fn choose(asked: &Asked, path: PathBuf, file: StudyFile) -> Result<Chosen, Exit> {
    let (table, known) = measured(&path, &file).map_err(|what| refused(no_estimate(what)))?;
    let Budget(budget) = asked.budget;
    let found = budget::choose(&file, &known, &candidates(&file, &known), budget);
    let (expected, is_within) = match found {
        Ok(expected) => (expected, true),
        Err(Some(best)) => (best, false),
        Err(None) => {
            return Err(refused(no_estimate(format!(
                "no run in {} has an error",
                table.display()
            ))));
        }
    };
    // frames and gauges are left to the user
    let of_study = file.set.iter().filter(|set| !set.starts_with("output."));
    let values = file.knobs.iter().zip(&expected.choice);
    let of_values = values.flat_map(|(knob, &value)| &knob.values[value].set);
    let settings: Vec<String> = of_study.chain(of_values).cloned().collect();
    let overrides = settings
        .iter()
        .map(|set| Override::from_str(set))
        .collect::<Result<Vec<Override>, String>>()
        .map_err(|message| refused(no_estimate(format!("{}: {message}", path.display()))))?;
    let chosen = FromStudy {
        file,
        table,
        known,
        expected,
        is_within,
    };
    say(&words(asked, &chosen));
    let FromStudy {
        file,
        table,
        known,
        expected,
        ..
    } = chosen;
    Ok(Chosen {
        overrides,
        report: Report {
            of: file.output.name.clone(),
            budget,
            chosen_from: table.display().to_string(),
            settings,
            expected_error: expected.error,
            ..Report::default()
        },
        basis: Basis::Study {
            path,
            file,
            known,
            choice: expected.choice,
        },
    })
}

/// Report of the choice, its reason, and the effects that it neglects.
fn words(asked: &Asked, chosen: &FromStudy) -> String {
    let FromStudy {
        file,
        table,
        known,
        expected,
        is_within,
    } = chosen;
    let Budget(budget) = asked.budget;
    let mut text = format!(
        "{} % of {}: {}, from the {} runs in {}",
        100.0 * budget,
        file.output.name,
        match is_within {
            true => "the least work predicted to suffice",
            false => "OUT OF REACH of the study; the most accurate",
        },
        known.len(),
        table.display(),
    );
    let first = known
        .iter()
        .find(|found| found.choice.iter().all(|&v| v == 0));
    // other settings are those of the case or a preset
    let turned = file.knobs.iter().zip(&expected.choice);
    for (knob, &value) in turned.filter(|(_, value)| **value != 0) {
        let _ = write!(text, "\n  {:<32} {}", knob.name, knob.values[value].name);
    }
    let _ = write!(
        text,
        "\n  {} error {:.2} %, {:.2e} pair interactions{}",
        match expected.is_measured {
            true => "measured",
            false => "predicted, never run:",
        },
        100.0 * expected.error,
        expected.work,
        first.map_or(String::new(), |first| format!(
            ", {:.2} times those of the study's first settings",
            expected.work / first.cost.work()
        )),
    );
    for set in file.set.iter().filter(|set| !set.starts_with("output.")) {
        let _ = write!(text, "\n  as in the study: {set}");
    }
    for set in asked.overrides {
        let _ = write!(
            text,
            "\n  NOT in the study, by --set: {}={}",
            set.path, set.value
        );
    }
    text
}
