//! `riprap sweep` and `riprap collect`.

use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::check::wall_seconds;
use super::run::{join_threads, start_threads, wall_time};
use super::study::means;
use super::{
    Exit, Program, checkpoint_on_signal, failed, refused, report_scene_error, say, show,
    stop_on_signal, warn,
};
use crate::messages::{Code, Coded, Message, of_writing};
use crate::run::WallLimit;
use crate::study::jobs::run_all;
use crate::study::sweep::collected::{self, Collected, State, plan_all};
use crate::study::sweep::emit::{self, Rows};
use crate::study::sweep::plan::{Planned, Sweep};
use crate::study::sweep::row::{Outcome, Terms, folder_of, run_row};
use crate::study::sweep::{page, plot};
use crate::study::trade::execute::ended;
use crate::study::trade::picture;
use crate::study::trade::results::write;

/// Time of a job over the time that the first steps of its run predict.
const TIME_FACTOR: f64 = 1.5;
/// Smallest time of a job: nobody queues for less.
const LEAST_TIME: f64 = 600.0;
/// Rows whose time is predicted.
const TIMED_ROWS: usize = 3;

/// Run a scene many times with other inputs.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    place: Place,
    /// Runs at once, one thread each; all cores when left out.
    #[arg(long, value_name = "N", conflicts_with_all = ["row", "emit"])]
    jobs: Option<usize>,
    /// Run one row alone, as clusters start it; exit code 4 when it was stopped and goes on with the same command.
    #[arg(long, value_name = "K", conflicts_with = "emit")]
    row: Option<usize>,
    /// Threads of a row.
    #[arg(long, value_name = "N", default_value_t = 1)]
    threads: usize,
    /// Wall time of a row, e.g. 5400, 90min or 1:30:00: before its end the row stops with a checkpoint. With --emit that of its job,
    /// by default 1.5 times what the first steps of three rows predict.
    #[arg(long, value_name = "T", value_parser = wall_time, conflicts_with = "jobs")]
    wall_limit: Option<Duration>,
    /// Print a script that runs the rows that have not ended elsewhere.
    #[arg(long, value_name = "ENGINE")]
    emit: Option<Engine>,
}

/// Write what the runs of a sweep say together.
#[derive(Debug, clap::Args)]
pub(crate) struct Collect {
    #[command(flatten)]
    place: Place,
}

/// A sweep and its folder.
#[derive(Debug, clap::Args)]
pub(super) struct Place {
    /// The sweep, a RON file; see docs/reference/sweeps.md.
    sweep: PathBuf,
    /// Folder of the runs and results; runs/sweep/NAME when left out. Rows that have ended there are not repeated.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Engine that runs rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Engine {
    /// A job array of Slurm.
    Slurm,
    /// A job file of HyperQueue.
    Hq,
    /// A command line a row, for GNU parallel, Snakemake or a shell.
    List,
}

impl Place {
    /// The checked sweep, and the folder of its runs.
    pub(super) fn load(&self) -> Result<(Sweep, PathBuf), Exit> {
        let sweep = Sweep::load(&self.sweep).map_err(|error| {
            report_scene_error(&error);
            Exit::BadInput
        })?;
        let name = self.sweep.file_stem().unwrap_or_default();
        let default = || Path::new("runs").join("sweep").join(name);
        Ok((sweep, self.output.clone().unwrap_or_else(default)))
    }
}

pub(crate) fn execute(arguments: &Arguments, program: &Program) -> Exit {
    let done =
        arguments
            .place
            .load()
            .and_then(|(sweep, runs)| match (arguments.row, arguments.emit) {
                (Some(number), _) => one_row(arguments, &sweep, &runs, number),
                (None, Some(engine)) => script(arguments, (&sweep, &runs), engine, program),
                (None, None) => all_rows(arguments, (&sweep, &runs), program),
            });
    done.unwrap_or_else(|exit| exit)
}

/// Runs one row in this process.
fn one_row(arguments: &Arguments, sweep: &Sweep, runs: &Path, number: usize) -> Result<Exit, Exit> {
    let started = Instant::now();
    let row = (number.checked_sub(1)).and_then(|k| sweep.rows.get(k));
    let row = row.ok_or_else(|| {
        let message = format!(
            "no row {number}: the sweep has rows 1 to {}",
            sweep.rows.len()
        );
        refused(Message::new(Code::UnusableArgument, message))
    })?;
    join_threads(Some(arguments.threads))?;
    let (scene, planned) = sweep.scene_of(row).map_err(refused)?;
    let stop = Arc::new(AtomicBool::new(false));
    stop_on_signal(&stop);
    let checkpoint_wanted = Arc::new(AtomicBool::new(false));
    checkpoint_on_signal(&checkpoint_wanted);
    let terms = Terms {
        case: &sweep.case(),
        runs,
        wall_limit: (arguments.wall_limit).map(|limit| WallLimit { started, limit }),
        stop: &stop,
        checkpoint_wanted,
    };
    let outcome = run_row(scene, &planned.key, terms).map_err(failed)?;
    let folder = folder_of(runs, &planned.key);
    let place = format!("row {number}, in {}", folder.display());
    Ok(match outcome {
        Outcome::Ended(ended) if ended.completed => {
            say(&format!("{place}: completed"));
            Exit::Done
        }
        Outcome::Ended(ended) => {
            say(&format!("{place}: failed: {}", ended.message));
            Exit::Failed
        }
        Outcome::Stopped => {
            say(&format!("{place}: stopped; the same command goes on"));
            Exit::Interrupted
        }
        Outcome::OutOfTime => {
            say(&format!(
                "{place}: its time is over; the same command goes on"
            ));
            Exit::OutOfTime
        }
    })
}

/// Scenes of all rows; warns of those that are refused.
fn planned_rows(sweep: &Sweep) -> Result<Vec<Result<Planned, Message>>, Exit> {
    let planned = plan_all(sweep);
    let wrong = || {
        planned
            .iter()
            .zip(&sweep.rows)
            .filter_map(|(one, row)| Some((one.as_ref().err()?, row)))
    };
    let n_wrong = wrong().count();
    if let Some((message, row)) = wrong().next() {
        let inputs = sweep.file.inputs.iter().zip(&row.inputs);
        let inputs: Vec<String> = inputs
            .map(|(input, value)| format!("{} {value}", input.name))
            .collect();
        let words = format!(
            "{n_wrong} of {} rows make no scene; the first is row {}, {}: {message}",
            planned.len(),
            row.number,
            inputs.join(", ")
        );
        let told = Message::new(message.code(), words);
        if n_wrong == planned.len() {
            return Err(refused(told));
        }
        warn(told);
    }
    Ok(planned)
}

/// Rows that have not ended, each scene once.
fn unfinished<'a>(planned: &'a [Result<Planned, Message>], runs: &Path) -> Vec<&'a Planned> {
    let mut seen = std::collections::BTreeSet::new();
    let rows = planned.iter().filter_map(|one| one.as_ref().ok());
    rows.filter(|row| seen.insert(&row.key))
        .filter(|row| ended(&folder_of(runs, &row.key)).is_none())
        .collect()
}

/// Runs all rows that have not ended in processes of their own, and collects.
fn all_rows(
    arguments: &Arguments,
    (sweep, runs): (&Sweep, &Path),
    program: &Program,
) -> Result<Exit, Exit> {
    let planned = planned_rows(sweep)?;
    let stop = Arc::new(AtomicBool::new(false));
    stop_on_signal(&stop);
    let waiting = unfinished(&planned, runs);
    let (all, before) = (waiting.len(), planned.len() - waiting.len());
    let started = Instant::now();
    let tell = |ended: usize| {
        let time = started.elapsed().as_secs_f64();
        say(&format!(
            "[{time:6.0} s] {} of {} rows",
            before + ended,
            before + all
        ));
    };
    let children = Children::default();
    let execute = |row: &Planned| spawn(arguments, runs, row, (program, &children));
    let is_over = AtomicBool::new(false);
    let ended = std::thread::scope(|scope| {
        // a stop of this process alone, such as SIGTERM, is passed on; Ctrl-C reaches all anyway
        scope.spawn(|| {
            while !is_over.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(50));
                if stop.load(Ordering::Relaxed) {
                    children.stop();
                    return;
                }
            }
        });
        let ended = run_all(waiting, means(arguments.jobs), &stop, &execute, &tell);
        is_over.store(true, Ordering::Relaxed);
        ended
    });
    let all = collected::collect(sweep, &planned, runs);
    write_all(sweep, &all, runs).map_err(failed)?;
    show(&page::summary(&all));
    match ended {
        Ok(true) => {
            show(&told_files(runs));
            Ok(Exit::Done)
        }
        Ok(false) => {
            let words = "stopped; the same command continues with the remaining rows, in";
            say(&format!("{words} {}", runs.display()));
            Ok(Exit::Interrupted)
        }
        Err(error) => Err(failed(error)),
    }
}

/// Processes that run rows.
#[derive(Debug, Default)]
struct Children(Mutex<Vec<u32>>);

impl Children {
    fn ids(&self) -> std::sync::MutexGuard<'_, Vec<u32>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Asks all of them to stop with a checkpoint.
    #[cfg(unix)]
    fn stop(&self) {
        for id in self.ids().iter().filter_map(|&id| i32::try_from(id).ok()) {
            // one that has ended by itself needs no signal
            let _ =
                nix::sys::signal::kill(nix::unistd::Pid::from_raw(id), nix::sys::signal::SIGTERM);
        }
    }

    /// Elsewhere they get the signal of the console.
    #[cfg(not(unix))]
    fn stop(&self) {}

    fn wait(&self, child: Child) -> io::Result<std::process::Output> {
        let id = child.id();
        self.ids().push(id);
        let output = child.wait_with_output();
        self.ids().retain(|other| *other != id);
        output
    }
}

/// Runs a row in a process of its own, so that a failure or lack of memory affects no other; returns whether it has ended.
fn spawn(
    arguments: &Arguments,
    runs: &Path,
    row: &Planned,
    (program, children): (&Program, &Children),
) -> Result<bool, Message> {
    let not_run = |error: io::Error| {
        let message = format!("cannot run row {}: {error}", row.number);
        Message::new(of_writing(&error), message)
    };
    let mut command = program.command().map_err(not_run)?;
    command
        .arg("sweep")
        .arg(&arguments.place.sweep)
        .arg("-o")
        .arg(runs);
    command.args([
        "--row",
        &row.number.to_string(),
        "--threads",
        &arguments.threads.to_string(),
    ]);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let output = children
        .wait(command.spawn().map_err(not_run)?)
        .map_err(not_run)?;
    if ended(&folder_of(runs, &row.key)).is_some() {
        return Ok(true);
    }
    match output.status.code() {
        // stopped, also by a signal that nobody can catch
        Some(4 | 130) | None => Ok(false),
        Some(_) => {
            let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
            Err(not_run(io::Error::other(said)))
        }
    }
}

/// Prints a script that runs the rows that have not ended.
fn script(
    arguments: &Arguments,
    (sweep, runs): (&Sweep, &Path),
    engine: Engine,
    program: &Program,
) -> Result<Exit, Exit> {
    start_threads(Some(arguments.threads))?;
    let planned = planned_rows(sweep)?;
    let left = unfinished(&planned, runs);
    if left.is_empty() {
        say("all rows have ended");
        return Ok(Exit::Done);
    }
    let absolute = |path: &Path| {
        std::path::absolute(path).map_err(|error| {
            let message = format!("cannot tell where {} is: {error}", path.display());
            refused(Message::new(Code::UnusableArgument, message))
        })
    };
    let (file, runs) = (absolute(&sweep.path)?, absolute(runs)?);
    // logs are there before the first run
    std::fs::create_dir_all(&runs).map_err(|error| {
        let message = format!("cannot make {}: {error}", runs.display());
        failed(Message::new(of_writing(&error), message))
    })?;
    let mut command = program
        .words()
        .map_err(|error| failed(Message::new(of_writing(&error), error.to_string())))?;
    let text = |path: &Path| path.display().to_string();
    command.extend([
        "sweep".to_owned(),
        text(&file),
        "-o".to_owned(),
        text(&runs),
    ]);
    command.extend(["--threads".to_owned(), arguments.threads.to_string()]);
    let (wall_time, wall_time_source) = match (arguments.wall_limit, engine) {
        (Some(limit), _) => (limit, "given by --wall-limit".to_owned()),
        (None, Engine::List) => (Duration::ZERO, String::new()),
        (None, _) => predicted(sweep, &left)?,
    };
    let numbers: Vec<usize> = left.iter().map(|row| row.number).collect();
    let rows = Rows {
        name: &sweep.path.file_stem().unwrap_or_default().to_string_lossy(),
        command: &command,
        runs: &runs,
        numbers: &numbers,
        wall_time,
        wall_time_source: &wall_time_source,
        memory: left.iter().map(|row| row.memory).max().unwrap_or(0),
        threads: arguments.threads,
    };
    let text = match engine {
        Engine::Slurm => emit::slurm(&rows),
        Engine::Hq => emit::hyperqueue(&rows),
        Engine::List => emit::list(&rows),
    };
    show(text.trim_end());
    Ok(Exit::Done)
}

/// Time of a job from the first steps of the first, the middle and the last row.
fn predicted(sweep: &Sweep, left: &[&Planned]) -> Result<(Duration, String), Exit> {
    let n = left.len().min(TIMED_ROWS);
    let mut longest: f64 = 0.0;
    for k in 0..n {
        let row = left[k * (left.len() - 1) / (n - 1).max(1)];
        let (scene, _) = sweep
            .scene_of(&sweep.rows[row.number - 1])
            .map_err(refused)?;
        longest = longest.max(wall_seconds(&scene).map_err(failed)?);
    }
    let seconds = (TIME_FACTOR * longest).max(LEAST_TIME);
    let minutes = (seconds / 60.0).ceil();
    let source = format!(
        "1.5 times {longest:.0} s, predicted on this machine from the first steps of {n} rows, and at least 10 min"
    );
    Ok((Duration::from_secs_f64(60.0 * minutes), source))
}

pub(crate) fn collect(arguments: &Collect) -> Exit {
    let collected = arguments.place.load().and_then(|(sweep, runs)| {
        let planned = planned_rows(&sweep)?;
        let all = collected::collect(&sweep, &planned, &runs);
        write_all(&sweep, &all, &runs).map_err(failed)?;
        show(&page::summary(&all));
        show(&told_files(&runs));
        // a table with gaps is still a table
        Ok(match collected::count(&all, State::Unfinished) {
            0 => Exit::Done,
            _ => Exit::OutOfTime,
        })
    });
    collected.unwrap_or_else(|exit| exit)
}

fn told_files(runs: &Path) -> String {
    format!(
        "collected.csv, cost.csv, exceedance.csv, sensitivity.csv, sweep.html, sweep.svg and sweep.png are in {}",
        runs.display()
    )
}

/// Writes tables, plots and the page.
fn write_all(sweep: &Sweep, all: &[Collected], folder: &Path) -> Result<(), Message> {
    let svg = plot::svg(sweep, all);
    let png = picture::png(&svg).map_err(|error| {
        let words = format!("cannot draw the sweep: {error}");
        Message::new(Code::NothingToDraw, words)
    })?;
    let files = [
        ("collected.csv", collected::table(sweep, all).into_bytes()),
        ("cost.csv", collected::cost_table(all).into_bytes()),
        (
            "exceedance.csv",
            collected::exceedance_table(sweep, all).into_bytes(),
        ),
        (
            "sensitivity.csv",
            collected::sensitivity_table(sweep, all).into_bytes(),
        ),
        ("sweep.html", page::html(sweep, all, &svg).into_bytes()),
        ("sweep.svg", svg.into_bytes()),
        ("sweep.png", png),
    ];
    let cannot = |path: &Path, error: &io::Error| {
        let words = format!("cannot write {}: {error}", path.display());
        Message::new(of_writing(error), words)
    };
    std::fs::create_dir_all(folder).map_err(|error| cannot(folder, &error))?;
    files.into_iter().try_for_each(|(name, bytes)| {
        let path = folder.join(name);
        write(&path, &bytes).map_err(|error| cannot(&path, &error))
    })
}
