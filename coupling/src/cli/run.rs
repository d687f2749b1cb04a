//! `riprap run`.

mod resume;

use std::io::{IsTerminal, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use super::accuracy::{self, Asked, Budget};
use super::{Exit, default_folder, files_from, load, say, show, stop_on_signal};
use crate::cli::check::describe;
use crate::output::checkpoint_file::{self as checkpoint, Checkpoint};
use crate::output::run_folder::{self, ArchivedScene, Existing};
use crate::output::summary::Summary;
use crate::run::{Ending, Event, Plan, Progress, run};
use crate::scene::access::Access;
use crate::scene::parse::Override;
use crate::scene::resolve::Scene;
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
    /// Resume a stopped run from its last checkpoint, to bitwise the same result as without the stop.
    #[arg(long, conflicts_with_all = ["force", "error"])]
    resume: bool,
    /// Wall time between checkpoints in seconds. Another one is written when a run is stopped or fails.
    #[arg(long, value_name = "T", default_value_t = 600.0, value_parser = seconds)]
    checkpoint_interval: f64,
    /// No progress, only errors.
    #[arg(long)]
    quiet: bool,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    let mut overrides = arguments.set.clone();
    if let Some(until) = arguments.until {
        overrides.push(Override {
            path: "time.duration".to_owned(),
            value: format!("{until:?}"),
        });
    }
    let files = files_from(arguments.allow_outside);
    let mut scene = match load(&arguments.case, &overrides, files) {
        Ok(scene) => scene,
        Err(exit) => return exit,
    };
    let folder = arguments
        .output
        .clone()
        .unwrap_or_else(|| default_folder(&arguments.case));
    let from = match place_of_run(arguments, &scene, &folder) {
        Ok(from) => from,
        Err(exit) => return exit,
    };
    let stop = Arc::new(AtomicBool::new(false));
    stop_on_signal(&stop);
    let chosen = match arguments.error {
        None => None,
        Some(budget) => {
            let asked = Asked {
                case: &arguments.case,
                budget,
                of: arguments.of.as_deref(),
                overrides: &overrides,
                folder: &folder,
                jobs: arguments.threads,
            };
            let chosen = match accuracy::plan(&asked, &scene, &stop) {
                Ok(chosen) => chosen,
                Err(exit) => return exit,
            };
            // settings of the user take precedence over chosen ones
            let all = [chosen.overrides.as_slice(), &overrides].concat();
            scene = match load(&arguments.case, &all, files) {
                Ok(scene) => scene,
                Err(exit) => return exit,
            };
            Some(chosen)
        }
    };
    let archived = ArchivedScene::of(&scene).and_then(|archived| {
        if from.is_none() {
            archived.write(&arguments.case, &folder)?;
        }
        Ok(archived)
    });
    let archived = match archived {
        Ok(archived) => archived,
        Err(message) => {
            say(&format!("error: {message}"));
            return Exit::BadInput;
        }
    };
    if let Some(threads) = arguments.threads
        && let Err(error) = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()
    {
        say(&format!("error: cannot start {threads} threads: {error}"));
        return Exit::BadInput;
    }
    if !arguments.quiet {
        let access = Access {
            files,
            ..Access::of(arguments.case.parent().unwrap_or(Path::new(".")))
        };
        say(&describe(&scene, &access));
    }
    let mut line = ProgressLine::new(arguments.quiet);
    let plan = Plan {
        folder: &folder,
        from,
        scene_hash: checkpoint::scene_hash(&archived.text),
        checkpoint_interval: Duration::from_secs_f64(arguments.checkpoint_interval),
    };
    let ended = run(&scene, plan, &stop, &mut |event| line.tell(&event));
    line.end();
    match ended {
        Ok((summary, ending)) => {
            if !arguments.quiet {
                show(&closing_words(&summary, &folder));
            }
            match (ending, chosen) {
                (Ending::Interrupted, _) => {
                    if !arguments.quiet {
                        show("to continue: the same command with --resume");
                    }
                    Exit::Interrupted
                }
                (Ending::Completed, None) => Exit::Done,
                (Ending::Completed, Some(chosen)) => match chosen.judge(&scene, &folder) {
                    Ok(words) => {
                        show(&words);
                        Exit::Done
                    }
                    Err(message) => {
                        say(&format!("error: the run cannot be evaluated: {message}"));
                        Exit::Failed
                    }
                },
            }
        }
        Err(error) => {
            say(&format!(
                "error: {error}\nearlier output is in {}",
                folder.display()
            ));
            Exit::Failed
        }
    }
}

/// Prepares the run folder, or finds the checkpoint to resume from.
fn place_of_run(
    arguments: &Arguments,
    scene: &Scene,
    folder: &Path,
) -> Result<Option<Checkpoint>, Exit> {
    let wrong = |message: String| {
        say(&format!("error: {message}"));
        Exit::BadInput
    };
    if arguments.resume {
        let archived = ArchivedScene::of(scene).map_err(|error| wrong(error.to_string()))?;
        match resume::find(&archived, &arguments.case, folder).map_err(wrong)? {
            Found::Over => {
                show(&format!("{} is complete already", folder.display()));
                return Err(Exit::Done);
            }
            Found::Checkpoint(checkpoint) => return Ok(Some(checkpoint)),
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
    run_folder::create(folder, existing).map_err(|error| wrong(error.to_string()))?;
    Ok(None)
}

/// A wall time.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.0..=1e9).contains(&seconds) => Ok(seconds),
        _ => Err("expected seconds, from 0 to 1e9".to_owned()),
    }
}

fn closing_words(summary: &Summary, folder: &Path) -> String {
    format!(
        "{}: t = {:.4} s, {} steps in {:.1} s, {:.3e} particle-steps/s, momentum residual {:.1e}, \
         {} particles escaped\nresults in {}: overview.svg, gauges.csv, energy.csv, water.pvd for ParaView",
        summary.stop_reason,
        summary.simulated_time,
        summary.steps,
        summary.wall_time,
        summary.particle_steps_per_second,
        summary.momentum_residual,
        summary.particles_escaped,
        folder.display(),
    )
}

/// Progress: one line updated in place on a terminal, occasional lines in a log.
struct ProgressLine {
    is_quiet: bool,
    is_terminal: bool,
    started: Instant,
    stage_started: Instant,
    was_settling: bool,
    last: Option<Instant>,
}

impl ProgressLine {
    fn new(is_quiet: bool) -> Self {
        let now = Instant::now();
        Self {
            is_quiet,
            is_terminal: std::io::stderr().is_terminal(),
            started: now,
            stage_started: now,
            was_settling: false,
            last: None,
        }
    }

    fn tell(&mut self, event: &Event) {
        match event {
            Event::Step(progress) => self.show(progress),
            Event::FellBack { error, to, share } => {
                self.end();
                say(&format!(
                    "warning: {error}\nthe run returns to t = {to:.6} s and continues with {share} of the step for a while"
                ));
            }
        }
    }

    fn show(&mut self, progress: &Progress) {
        if self.was_settling != progress.is_settling {
            self.was_settling = progress.is_settling;
            self.stage_started = Instant::now();
        }
        let interval = Duration::from_secs(if self.is_terminal { 1 } else { 30 });
        if self.is_quiet || self.last.is_some_and(|last| last.elapsed() < interval) {
            return;
        }
        self.last = Some(Instant::now());
        let share = (progress.time / progress.end).min(1.0);
        let left = self.stage_started.elapsed().as_secs_f64() * (1.0 / share.max(1e-6) - 1.0);
        let line = format!(
            "{}step {} | t {:.4} of {:.4} s ({:.0} %) | dt {:.2e} s | contacts {} | v max {:.2} m/s | left {}:{:02}",
            if progress.is_settling {
                "settling: "
            } else {
                ""
            },
            progress.steps,
            progress.time,
            progress.end,
            100.0 * share,
            progress.dt,
            progress.contacts,
            progress.fastest,
            left as u64 / 60,
            left as u64 % 60,
        );
        self.write(&line);
    }

    fn write(&self, line: &str) {
        if self.is_terminal {
            let _ = write!(std::io::stderr(), "\r\x1b[K{line}");
        } else {
            say(&format!(
                "[{:6.0} s] {line}",
                self.started.elapsed().as_secs_f64()
            ));
        }
    }

    fn end(&self) {
        if self.is_terminal && self.last.is_some() {
            say("");
        }
    }
}
