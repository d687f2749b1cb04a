//! `riprap run`.

mod json;
mod line;
mod progress;
mod wall_time;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use rayon::ThreadPoolBuilder;

use super::accuracy::{self, Asked, Budget, Chosen};
use super::report;
use super::{
    Exit, Program, checkpoint_on_signal, default_folder, failed, files_from, load, refused, say,
    show, stop_on_signal, told, warn,
};
use crate::cli::check::describe;
use crate::messages::{Code, Coded, Message};
use crate::output::checkpoint_file::{self as checkpoint, Checkpoint};
use crate::output::run_folder::{self, ArchivedScene, Existing};
use crate::output::summary::Summary;
use crate::output::verdict::LARGEST_MACH;
use crate::picture::color::ColorMap;
use crate::run::preparation::{self, Beginning, Note, Prepared};
use crate::run::{Ending, Plan, RunError, WallLimit, run};
use crate::scene::access::FilesFrom;
use crate::scene::parse::Override;
use crate::scene::{self, resolve::Scene};
use json::JsonEvents;
use progress::{ProgressLine, Teller};
pub(super) use wall_time::wall_time;

/// Run a scene into a folder.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The scene, a RON, JSON or YAML file; see docs/reference/scene.
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
    /// Wall time, e.g. 5400, 90min, 3h30m or 1:30:00, before the end of which the run stops with a checkpoint and exit code 4; the
    /// same command with --resume continues it.
    #[arg(long, value_name = "T", value_parser = wall_time)]
    wall_limit: Option<Duration>,
    /// No report.html, the page that plays the run.
    #[arg(long)]
    no_report: bool,
    /// No progress, only errors.
    #[arg(long)]
    quiet: bool,
    /// Events for programs on standard output, a JSON object a line, instead of progress and closing words.
    #[arg(long, conflicts_with = "error")]
    json: bool,
}

impl Arguments {
    /// Whether only errors are printed.
    pub(super) fn is_quiet(&self) -> bool {
        self.quiet
    }
}

pub(crate) fn execute(arguments: &Arguments, program: &Program) -> Exit {
    match choose_and_run(arguments, (program, Instant::now())) {
        Ok(exit) => exit,
        Err(exit) => {
            if arguments.json {
                json::end_unstarted(exit);
            }
            exit
        }
    }
}

/// Chooses the settings, prepares the folder, runs and reports. `Err` before the run.
fn choose_and_run(
    arguments: &Arguments,
    (program, started): (&Program, Instant),
) -> Result<Exit, Exit> {
    // before the scene, whose triangles are made on all of them
    join_threads(arguments.threads)?;
    let overrides = overrides(arguments);
    let files = files_from(arguments.allow_outside);
    let scene = load_told(arguments, &overrides, files)?;
    let folder = arguments
        .output
        .clone()
        .unwrap_or_else(|| default_folder(&arguments.case));
    let from = prepare(arguments, &scene, &folder)?;
    let stop = Arc::new(AtomicBool::new(false));
    stop_on_signal(&stop);
    let checkpoint_wanted = Arc::new(AtomicBool::new(false));
    checkpoint_on_signal(&checkpoint_wanted);
    let (mut scene, chosen) = match arguments.error {
        None => (scene, None),
        Some(budget) => {
            let asked = Asked {
                case: &arguments.case,
                budget,
                of: arguments.of.as_deref(),
                overrides: &overrides,
                folder: &folder,
                program,
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
    if !(arguments.quiet || arguments.json) {
        say(&describe(&scene));
    }
    let mut teller = match arguments.json {
        true => Teller::Json(JsonEvents::begin(&scene, &folder, from.as_ref())),
        false => Teller::Line(ProgressLine::new(arguments.quiet)),
    };
    let plan = Plan {
        from,
        scene_hash: checkpoint::scene_hash(&archived.text),
        checkpoint_interval: Duration::from_secs_f64(arguments.checkpoint_interval),
        wall_limit: wall_limit(arguments, &scene).map(|limit| WallLimit { started, limit }),
        checkpoint_wanted,
        ..Plan::new(&folder)
    };
    let ended = run(&mut scene, plan, &stop, &mut |event| teller.tell(&event));
    teller.end();
    // a page takes time that a run at its limit does not have
    let is_out_of_time = matches!(ended, Ok((_, Ending::OutOfTime)));
    if !(arguments.no_report || is_out_of_time) {
        write_report(&folder);
    }
    Ok(match ended {
        Ok((summary, ending)) => conclude(arguments, &scene, (&summary, ending, chosen), &folder),
        Err(error) => fail(arguments, &error, &folder),
    })
}

/// Loads the scene; its problems are told as asked for.
fn load_told(
    arguments: &Arguments,
    overrides: &[Override],
    files: FilesFrom,
) -> Result<Scene, Exit> {
    if !arguments.json {
        return load(&arguments.case, overrides, files);
    }
    match scene::load_from(&arguments.case, overrides, files) {
        Ok((scene, warnings)) => {
            json::tell_problems(&warnings);
            Ok(scene)
        }
        Err(error) => {
            json::tell_problems(&error);
            Err(Exit::BadInput)
        }
    }
}

/// Wall time that the run may take: that of the command line, or else of the scene.
fn wall_limit(arguments: &Arguments, scene: &Scene) -> Option<Duration> {
    let of_scene = || scene.wall_limit.map(Duration::from_secs_f64);
    arguments.wall_limit.or_else(of_scene)
}

/// Tells the end of a run, and judges its error if there is a budget.
fn conclude(
    arguments: &Arguments,
    scene: &Scene,
    (summary, ending, chosen): (&Summary, Ending, Option<Chosen>),
    folder: &Path,
) -> Exit {
    let exit = match ending {
        Ending::Completed => Exit::Done,
        Ending::Interrupted => Exit::Interrupted,
        Ending::OutOfTime => Exit::OutOfTime,
    };
    let warning = compressed(summary, scene);
    if arguments.json {
        warning.iter().for_each(json::warn);
        json::end(summary, folder, exit);
    } else if !arguments.quiet {
        show(&closing_words(summary, folder));
        warning.into_iter().for_each(warn);
        summary.doubts().into_iter().for_each(told::keep);
        if ending != Ending::Completed {
            show("to continue: the same command with --resume");
        }
    }
    match (ending, chosen) {
        (Ending::Completed, Some(chosen)) => judge(chosen, scene, folder),
        _ => exit,
    }
}

/// Tells the failure of a run.
fn fail(arguments: &Arguments, error: &RunError, folder: &Path) -> Exit {
    let way_on = way_on(error, arguments, folder);
    say(&format!(
        "error: {}\nearlier output is in {}{way_on}",
        told::coded(error),
        folder.display()
    ));
    if arguments.json {
        json::end_failed(error, folder);
    }
    Exit::Failed
}

/// Writes the page that plays the run, complete or not. The run does not fail with it.
fn write_report(folder: &Path) {
    let file = folder.join(run_folder::REPORT);
    if let Err(message) = report::write(folder, &file, (report::SIZE, ColorMap::default())) {
        warn(Message::new(
            message.code(),
            format!("no report: {message}"),
        ));
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

/// Sets the number of threads, for commands whose runs are on other threads than this one.
pub(super) fn start_threads(threads: Option<usize>) -> Result<(), Exit> {
    match threads {
        None => Ok(()),
        Some(threads) => start(ThreadPoolBuilder::new().num_threads(threads)),
    }
}

/// Sets the number of threads, this one among them, which runs the scene. From outside each of the hundred sums of a step
/// would be handed over to a thread, and waited for: a third of the time with some thousand particles.
pub(super) fn join_threads(threads: Option<usize>) -> Result<(), Exit> {
    let all = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    start(all.use_current_thread())
}

fn start(threads: ThreadPoolBuilder) -> Result<(), Exit> {
    threads.build_global().map_err(|error| {
        let message = format!("cannot start the threads: {error}");
        refused(Message::new(Code::UnusableArgument, message))
    })
}

/// Compares the result with the error budget.
fn judge(chosen: Chosen, scene: &Scene, folder: &Path) -> Exit {
    match chosen.judge(scene, folder) {
        Ok(words) => {
            show(&words);
            Exit::Done
        }
        Err(message) => {
            let message = format!("the run cannot be evaluated: {message}");
            failed(Message::new(Code::NoErrorEstimate, message))
        }
    }
}

/// Prepares the run folder, or finds the checkpoint to resume from.
fn prepare(
    arguments: &Arguments,
    scene: &Scene,
    folder: &Path,
) -> Result<Option<Checkpoint>, Exit> {
    let existing = match arguments.force {
        true => Existing::Replace,
        false => Existing::Keep,
    };
    let beginning = match &arguments.from {
        Some(other) => Beginning::From(other, existing),
        None if arguments.resume => Beginning::Resumed,
        None => Beginning::New(existing),
    };
    match preparation::prepare(scene, &arguments.case, folder, beginning).map_err(refused)? {
        Prepared::Ready { from, notes } => {
            for note in notes {
                match note {
                    Note::Information(line) => say(&line),
                    Note::Warning(doubt) => warn(doubt),
                }
            }
            Ok(from)
        }
        Prepared::Complete => {
            // one that was lost right at its end may lack it
            if !arguments.no_report && !folder.join(run_folder::REPORT).exists() {
                write_report(folder);
            }
            let words = format!("{} is complete already", folder.display());
            match arguments.json {
                true => say(&words),
                false => show(&words),
            }
            Err(Exit::Done)
        }
    }
}

/// A wall time.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.0..=1e9).contains(&seconds) => Ok(seconds),
        _ => Err("expected seconds, from 0 to 1e9".to_owned()),
    }
}

/// Warning of water that was so fast that its sound is felt.
fn compressed(summary: &Summary, scene: &Scene) -> Option<Message> {
    let fluid = scene.fluid.as_ref()?;
    let fastest = summary.max_mach * fluid.settings.sound_speed;
    (LARGEST_MACH < summary.max_mach).then(|| {
        let words = format!(
            "the fastest particle reached {fastest:.3} m/s, Mach {:.2}: pressures of impacts are those of sound, rho c u; \
             where they matter let numerics.expected_speed be {fastest:.2}",
            summary.max_mach
        );
        Message::new(Code::WaterNearSoundSpeed, words)
    })
}

fn closing_words(summary: &Summary, folder: &Path) -> String {
    format!(
        "{}: t = {:.4} s, {} steps in {:.1} s, {:.3e} particle-steps/s, momentum residual {:.1e}, \
         {} particles escaped\n{}\nresults in {}: {}gauges.csv, energy.csv, water.pvd for ParaView",
        summary.stop_reason,
        summary.simulated_time,
        summary.steps,
        summary.wall_time,
        summary.particle_steps_per_second,
        summary.momentum_residual,
        summary.particles_escaped,
        summary.verdict.join("\n"),
        folder.display(),
        if folder.join(run_folder::REPORT).exists() {
            "report.html for any browser, "
        } else {
            ""
        }
    )
}
