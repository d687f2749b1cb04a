//! Choice of the spacing by extrapolation from three coarse runs, where there is no study of the case.

use std::path::Path;
use std::str::FromStr;
use std::sync::atomic::AtomicBool;

use super::verification::Report;
use super::{Asked, Basis, Budget, Chosen, no_estimate};
use crate::cli::study::{means, spawn};
use crate::cli::{Exit, failed, refused, report_scene_error, say};
use crate::scene::parse::Override;
use crate::scene::resolve::Scene;
use crate::study::jobs::Progress;
use crate::study::trade::execute::{Executor, execute as run_all};
use crate::study::trade::file::{DesignFile, KnobFile, StudyFile, TruthFile, ValueFile};
use crate::study::trade::plan::{Planned, Study};
use crate::study::trade::reading::{Reading, reading};
use crate::study::trade::refinement::{Estimate, Level, levels, rows_for};
use crate::study::trade::results::collect;

/// Folder of the coarse runs, in the run folder.
const COARSE_RUNS: &str = "refinement";

/// Runs three coarse levels and chooses the spacing by extrapolation.
pub(super) fn choose(asked: &Asked, scene: &Scene, stop: &AtomicBool) -> Result<Chosen, Exit> {
    let Some(fluid) = &scene.fluid else {
        return Err(refused(no_estimate(
            "a scene without water has no spacing to refine: write a study of it, see benches/trade/README.md".to_owned(),
        )));
    };
    let reading = reading(asked.of, scene).map_err(|what| refused(no_estimate(what)))?;
    let Budget(budget) = asked.budget;
    let (depth, rows) = (
        fluid.lattice.depth,
        fluid.lattice.depth / fluid.lattice.spacing[2],
    );
    let levels = levels(rows).map(|rows| depth / rows);
    say(&format!(
        "{} % of {}: no study of this case has it; extrapolated from three coarse runs at {} m",
        100.0 * budget,
        reading.output.name,
        levels.map(|s| format!("{s:.4}")).join(", ")
    ));
    let levels = run_levels(asked, &reading, levels, stop)?;
    let estimate = Estimate::of(levels, reading.zero);
    let chosen = rows_for(&estimate, budget, depth, rows);
    let spacing = depth / chosen;
    let expected = estimate.error_at(spacing);
    say(&words(&estimate, &levels, spacing, budget, rows));
    let resolution = format!("fluid.resolution=Spacing({spacing:?})");
    Ok(Chosen {
        overrides: Override::from_str(&resolution)
            .map_err(|what| refused(no_estimate(what)))
            .into_iter()
            .collect(),
        report: Report {
            of: reading.output.name.clone(),
            budget,
            chosen_from: asked.folder.join(COARSE_RUNS).display().to_string(),
            settings: vec![resolution],
            expected_error: expected,
            ..Report::default()
        },
        basis: Basis::Refinement {
            reading,
            levels,
            spacing,
        },
    })
}

fn words(estimate: &Estimate, levels: &[Level; 3], spacing: f64, budget: f64, rows: f64) -> String {
    let values: Vec<String> = levels
        .iter()
        .map(|level| format!("{:.5} at {:.4} m", level.value, level.spacing))
        .collect();
    let order = match (estimate.order, estimate.limit) {
        (Some(order), Some(limit)) => format!("order {order:.2}, limit {limit:.5}"),
        _ => "no monotonic convergence: error from their largest difference".to_owned(),
    };
    let expected = estimate.error_at(spacing);
    let verdict = match expected <= budget * 1.0001 {
        true => "chosen".to_owned(),
        false => format!("OUT OF REACH of twice the scene's {rows:.0} rows; chosen"),
    };
    format!(
        "  {}\n  {order}\n  {verdict}: spacing {spacing:.4} m, expected error {:.2} % of the spacing alone; what the scheme \
         or the scene do wrong at any spacing is not in it",
        values.join(", "),
        100.0 * expected,
    )
}

/// Executes the three runs, coarse to fine.
fn run_levels(
    asked: &Asked,
    reading: &Reading,
    spacings: [f64; 3],
    stop: &AtomicBool,
) -> Result<[Level; 3], Exit> {
    let value = |spacing: f64| ValueFile {
        name: format!("{spacing:.4}"),
        at: Some(spacing),
        set: vec![format!("fluid.resolution=Spacing({spacing:?})")],
    };
    let set = asked.overrides.iter();
    let file = StudyFile {
        title: format!("refinement of {}", reading.output.name),
        case: asked
            .case
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
        set: set
            .map(|set| format!("{}={}", set.path, set.value))
            .collect(),
        output: reading.output.clone(),
        truth: TruthFile::Finest {
            knob: "spacing".into(),
        },
        knobs: vec![KnobFile {
            name: "spacing".into(),
            values: spacings.map(value).to_vec(),
        }],
        design: DesignFile::OneAtATime,
    };
    let study = Study::of(file, asked.case, String::new()).map_err(|error| {
        report_scene_error(&error);
        Exit::BadInput
    })?;
    let folder = asked.folder.join(COARSE_RUNS);
    let runner = |run: &Planned, folder: &Path| spawn((asked.program, asked.case), run, folder);
    let tell = |progress: Progress| say(&format!("  {} of {} runs", progress.ended, progress.all));
    let without = |message: String| failed(no_estimate(message));
    let executor = Executor {
        means: means(asked.jobs),
        stop,
        runner: &runner,
        tell: &tell,
    };
    let ended = run_all(&study, &folder, executor);
    if !ended.map_err(failed)? {
        return Err(Exit::Interrupted);
    }
    let all = collect(&study, &folder);
    let value = |k: usize| {
        let found = all.iter().find(|found| found.choice == [k]);
        found.and_then(|found| found.value).ok_or_else(|| {
            let message = found.map_or("it is gone", |found| &found.message);
            let name = &reading.output.name;
            without(format!(
                "the run with {:.4} m has no {name}: {message}",
                spacings[k]
            ))
        })
    };
    let level = |k: usize| {
        Ok(Level {
            spacing: spacings[k],
            value: value(k)?,
        })
    };
    Ok([level(0)?, level(1)?, level(2)?])
}
