//! `riprap run`.

mod from;
mod further;
mod progress;
mod resume;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use super::accuracy::{self, Asked, Budget, Chosen};
use super::report;
use super::{Exit, default_folder, files_from, load, refused, say, show, stop_on_signal};
use crate::cli::check::describe;
use crate::output::checkpoint_file::{self as checkpoint, Checkpoint};
use crate::output::run_folder::{self, ArchivedScene, Existing};
use crate::output::summary::Summary;
use crate::output::verdict::LARGEST_MACH;
use crate::picture::color::ColorMap;
use crate::run::{Ending, Plan, RunError, run};
use crate::scene::further::Changes;
use crate::scene::parse::Override;
use crate::scene::resolve::Scene;
use progress::ProgressLine;
use resume::Found;

/// Run a scene into a folder.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The scene, a RON file; see cases/README.md.
    case: PathBuf,
    /// Run folder; runs/NAME when left out.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Set a field of the scene, e.g. --set numerics.smoothing_length_ratio=1.5; may be repeated.
    #[arg(long = "set", value_name = "PATH=VALUE")]
    set: Vec<Override>,
    /// Simulated time in seconds instead of the scene's `time.duration`.
    #[arg(long, value_name = "T")]
    until: Option<f64>,
    /// Threads; all cores when left out. Results do not depend on it.
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Use the cheapest settings with an error of a quantity below this, e.g. 5%: from the case's study, or else from
    /// three coarse runs.
    #[arg(long, value_name = "BUDGET")]
    error: Option<Budget>,
    /// The quantity: a study of the case by its file or output, or crest_at_GAUGE, trough_at_, max_of_, min_of_, mean_of_.
    #[arg(long, value_name = "NAME", requires = "error")]
    of: Option<String>,
    /// Allow the scene to name files outside of its folder; they are copied into the run folder under other names.
    #[arg(long, conflicts_with = "error")]
    allow_outside: bool,
    /// Overwrite an existing run folder.
    #[arg(long)]
    force: bool,
    /// Resume a stopped run from its last checkpoint, to bitwise the same result as without the stop; or take a run further:
    /// to a longer duration, with more gauges, other intervals of output or another camera.
    #[arg(long, conflicts_with_all = ["force", "error"])]
    resume: bool,
    /// Continue from the last good state of another run folder with other numerics (time-step factors, viscosity, diffusion,
    /// damping), in a folder of its own, which gets the records so far.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["resume", "error"])]
    from: Option<PathBuf>,
    /// Wall time between checkpoints in seconds. Another one is written when a run is stopped or fails.
    #[arg(long, value_name = "T", default_value_t = 600.0, value_parser = seconds)]
    checkpoint_interval: f64,
    /// No report.html, the page that plays the run.
    #[arg(long)]
    no_report: bool,
    /// No progress, only errors.
    #[arg(long)]
    quiet: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    match choose_and_run(arguments) {
        Ok(exit) | Err(exit) => exit,
    }
}

/// Chooses the settings, prepares the folder, runs and reports.
fn choose_and_run(arguments: &Arguments) -> Result<Exit, Exit> {
    // before the scene, whose triangles are made on all of them
    start_threads(arguments.threads)?;
    let overrides = overrides(arguments);
    let files = files_from(arguments.allow_outside);
    let scene = load(&arguments.case, &overrides, files)?;
    let folder = arguments
        .output
        .clone()
        .unwrap_or_else(|| default_folder(&arguments.case));
    let from = prepare(arguments, &scene, &folder)?;
    let stop = Arc::new(AtomicBool::new(false));
    stop_on_signal(&stop);
    let (mut scene, chosen) = match arguments.error {
        None => (scene, None),
        Some(budget) => {
            let asked = Asked {
                case: &arguments.case,
                budget,
                of: arguments.of.as_deref(),
                overrides: &overrides,
                folder: &folder,
                jobs: arguments.threads,
            };
            let chosen = accuracy::plan(&asked, &scene, &stop)?;
            // settings of the user take precedence over chosen ones
            let all = [chosen.overrides.as_slice(), &overrides].concat();
            (load(&arguments.case, &all, files)?, Some(chosen))
        }
    };
    let archived = ArchivedScene::of(&scene).map_err(refused)?;
    if from.is_none() {
        archived.write(&arguments.case, &folder).map_err(refused)?;
    }
    if !arguments.quiet {
        say(&describe(&scene));
    }
    let plan = Plan {
        folder: &folder,
        from,
        scene_hash: checkpoint::scene_hash(&archived.text),
        checkpoint_interval: Duration::from_secs_f64(arguments.checkpoint_interval),
    };
    let mut line = ProgressLine::new(arguments.quiet);
    let ended = run(&mut scene, plan, &stop, &mut |event| line.tell(&event));
    line.end();
    if !arguments.no_report {
        write_report(&folder);
    }
    let (summary, ending) = ended.map_err(|error| {
        say(&format!(
            "error: {error}\nearlier output is in {}{}",
            folder.display(),
            way_on(&error, arguments, &folder)
        ));
        Exit::Failed
    })?;
    if !arguments.quiet {
        show(&closing_words(&summary, &folder));
        if let Some(words) = compressed(&summary, &scene) {
            say(&words);
        }
    }
    match (ending, chosen) {
        (Ending::Interrupted, _) => {
            if !arguments.quiet {
                show("to continue: the same command with --resume");
            }
            Ok(Exit::Interrupted)
        }
        (Ending::Completed, None) => Ok(Exit::Done),
        (Ending::Completed, Some(chosen)) => Ok(judge(chosen, &scene, &folder)),
    }
}

/// Writes the page that plays the run, complete or not. The run does not fail with it.
fn write_report(folder: &Path) {
    let file = folder.join(run_folder::REPORT);
    if let Err(message) = report::write(folder, &file, (report::SIZE, ColorMap::default())) {
        say(&format!("warning: no report: {message}"));
    }
}

/// Command that continues from the last good state of a failed run.
fn way_on(error: &RunError, arguments: &Arguments, folder: &Path) -> String {
    let is_of_a_step = matches!(
        error,
        RunError::Step(_) | RunError::Unstable { .. } | RunError::Examined { .. }
    );
    if !is_of_a_step || !folder.join(checkpoint::FILE).exists() {
        return String::new();
    }
    format!(
        ", with its last good state; to continue from there with other numerics: riprap run {} --from {} -o OTHER --set ...",
        arguments.case.display(),
        folder.display()
    )
}

/// Overrides of the command line.
fn overrides(arguments: &Arguments) -> Vec<Override> {
    let until = arguments.until.map(|until| Override {
        path: "time.duration".to_owned(),
        value: format!("{until:?}"),
    });
    arguments.set.iter().cloned().chain(until).collect()
}

/// Sets the number of threads.
fn start_threads(threads: Option<usize>) -> Result<(), Exit> {
    let Some(threads) = threads else {
        return Ok(());
    };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .map_err(|error| refused(format!("cannot start {threads} threads: {error}")))
}

/// Compares the result with the error budget.
fn judge(chosen: Chosen, scene: &Scene, folder: &Path) -> Exit {
    match chosen.judge(scene, folder) {
        Ok(words) => {
            show(&words);
            Exit::Done
        }
        Err(message) => {
            say(&format!("error: the run cannot be evaluated: {message}"));
            Exit::Failed
        }
    }
}

/// Prepares the run folder, or finds the checkpoint to resume from.
fn prepare(
    arguments: &Arguments,
    scene: &Scene,
    folder: &Path,
) -> Result<Option<Checkpoint>, Exit> {
    if arguments.resume {
        let archived = ArchivedScene::of(scene).map_err(refused)?;
        let found = resume::find(&archived, &arguments.case, folder, Changes::Records);
        match found.map_err(refused)? {
            Found::Over => {
                // one that was lost right at its end may lack it
                if !arguments.no_report && !folder.join(run_folder::REPORT).exists() {
                    write_report(folder);
                }
                show(&format!("{} is complete already", folder.display()));
                return Err(Exit::Done);
            }
            Found::Checkpoint(checkpoint) => return Ok(Some(checkpoint)),
            Found::Further(checkpoint) => {
                further::begin(&archived, &checkpoint, &arguments.case, folder).map_err(refused)?;
                return Ok(Some(checkpoint));
            }
            Found::Nothing => say(&format!(
                "{} contains no checkpoint: the run starts from the beginning",
                folder.display()
            )),
        }
    }
    let existing = match arguments.force || arguments.resume {
        true => Existing::Replace,
        false => Existing::Keep,
    };
    if let Some(other) = &arguments.from {
        let archived = ArchivedScene::of(scene).map_err(refused)?;
        let begun = from::begin(&archived, &arguments.case, other, (folder, existing));
        return begun.map(Some).map_err(refused);
    }
    run_folder::create(folder, existing).map_err(refused)?;
    Ok(None)
}

/// A wall time.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.0..=1e9).contains(&seconds) => Ok(seconds),
        _ => Err("expected seconds, from 0 to 1e9".to_owned()),
    }
}

/// Warning of water that was so fast that its sound is felt.
fn compressed(summary: &Summary, scene: &Scene) -> Option<String> {
    let fluid = scene.fluid.as_ref()?;
    let fastest = summary.max_mach * fluid.settings.sound_speed;
    (LARGEST_MACH < summary.max_mach).then(|| {
        format!(
            "warning: the fastest particle reached {fastest:.3} m/s, Mach {:.2}: pressures of impacts are those of sound, rho c u; \
             where they matter let numerics.expected_speed be {fastest:.2}",
            summary.max_mach
        )
    })
}

fn closing_words(summary: &Summary, folder: &Path) -> String {
    format!(
        "{}: t = {:.4} s, {} steps in {:.1} s, {:.3e} particle-steps/s, momentum residual {:.1e}, \
         {} particles escaped\n{}\nresults in {}: report.html for any browser, gauges.csv, energy.csv, water.pvd for ParaView",
        summary.stop_reason,
        summary.simulated_time,
        summary.steps,
        summary.wall_time,
        summary.particle_steps_per_second,
        summary.momentum_residual,
        summary.particles_escaped,
        summary.verdict.join("\n"),
        folder.display(),
    )
}
