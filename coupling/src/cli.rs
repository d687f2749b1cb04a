//! The command line: one file per command.

mod accuracy;
mod check;
mod compare;
mod explain;
mod handoff;
mod inspect;
mod new;
mod paraview;
mod problems;
mod program;
mod render;
mod report;
mod run;
mod schema;
mod serve;
mod shell;
mod study;
mod sweep;
mod told;

use std::ffi::OsString;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};

use crate::messages::{Code, Message};
use crate::scene::access::FilesFrom;
use crate::scene::error::SceneError;
use crate::scene::parse::Override;
use crate::scene::{self, resolve::Scene};
pub use program::Program;
pub(crate) use told::{failed, refused, warn};

/// Exit status of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exit {
    /// 0.
    Done,
    /// 1: the run failed.
    Failed,
    /// 2: wrong usage or scene.
    BadInput,
    /// 4: stopped before the wall limit, with a checkpoint to resume from.
    OutOfTime,
    /// 130: stopped by Ctrl-C or SIGTERM.
    Interrupted,
}

/// Rock blocks and water in one explicit engine.
///
/// A scene file describes an experiment; `riprap new` writes one to start from, `riprap check` reports its model and
/// cost, `riprap run` runs it into a folder of VTK files, CSV tables and pictures.
#[derive(Debug, Parser)]
#[command(
    name = "riprap",
    version,
    after_help = "\
Exit codes: 0 done, 1 the run failed, 2 wrong usage or scene, 4 stopped at the wall limit (resume), 130 interrupted.

First steps:
  riprap check cases/sliding_wedge.ron
  riprap run cases/sliding_wedge.ron
  riprap report runs/sliding_wedge"
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Write a scene to start from, every choice commented.
    New(new::Arguments),
    /// Run a scene into a folder.
    Run(run::Arguments),
    /// Check a scene and report its model and cost, without a run.
    Check(check::Arguments),
    /// Make pictures of a run with POV-Ray.
    Render(render::Arguments),
    /// Make one HTML file that plays a run.
    Report(report::Arguments),
    /// Write a Python script that opens a run in ParaView.
    Paraview(paraview::Arguments),
    /// Print who is who among the blocks of a run, where they are and how fast.
    Inspect(inspect::Arguments),
    /// Compare a recorded column with a reference.
    Compare(compare::Arguments),
    /// Measure error against cost for settings of a scene.
    #[command(alias = "trade")]
    Study(study::Arguments),
    /// Run a scene many times with inputs from a design, here or on a cluster.
    Sweep(sweep::Arguments),
    /// Write tables, exceedance curves and sensitivities of a sweep.
    Collect(sweep::Collect),
    /// Serve a sweep as a model to tools of uncertainty quantification (UM-Bridge).
    Serve(serve::Arguments),
    /// Hand the water of a run over to a solver of the far field.
    Handoff(handoff::Arguments),
    /// Explain errors and warnings by the codes behind them.
    Explain(explain::Arguments),
    /// Print the JSON schema of scenes, studies or sweeps.
    Schema(schema::Arguments),
    /// Write completions of a shell.
    Completions(shell::Completions),
    /// Write man pages.
    Man(shell::Man),
}

/// The command line with all its commands and options, for completions, man pages and the guide.
pub fn command() -> clap::Command {
    Arguments::command()
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    ExitCode::from(execute(std::env::args_os(), &Program::ThisExecutable))
}

/// Runs the program with some arguments, the first of which is its name; returns its exit code.
pub fn execute(arguments: impl IntoIterator<Item = OsString>, program: &Program) -> u8 {
    let exit = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => {
            let is_quiet =
                matches!(&arguments.command, Command::Run(arguments) if arguments.is_quiet());
            let exit = run_command(arguments.command, program);
            if let Some(line) = told::way_on().filter(|_| !is_quiet) {
                say(&line);
            }
            exit
        }
        // help and version come this way, too
        Err(error)
            if !error.use_stderr()
                || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand =>
        {
            let _ = error.print();
            match error.use_stderr() {
                true => Exit::BadInput,
                false => Exit::Done,
            }
        }
        Err(error) => told::misused(&error),
    };
    exit.code()
}

impl Exit {
    /// Exit status of the process.
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Failed => 1,
            Self::BadInput => 2,
            Self::OutOfTime => 4,
            Self::Interrupted => 130,
        }
    }
}

fn run_command(asked: Command, program: &Program) -> Exit {
    match asked {
        Command::New(arguments) => new::execute(&arguments),
        Command::Run(arguments) => run::execute(&arguments, program),
        Command::Check(arguments) => check::execute(&arguments),
        Command::Render(arguments) => render::execute(&arguments),
        Command::Report(arguments) => report::execute(&arguments),
        Command::Paraview(arguments) => paraview::execute(&arguments),
        Command::Inspect(arguments) => inspect::execute(&arguments),
        Command::Compare(arguments) => compare::execute(&arguments),
        Command::Study(arguments) => study::execute(&arguments, program),
        Command::Sweep(arguments) => sweep::execute(&arguments, program),
        Command::Collect(arguments) => sweep::collect(&arguments),
        Command::Serve(arguments) => serve::execute(&arguments, program),
        Command::Handoff(arguments) => handoff::execute(&arguments),
        Command::Explain(arguments) => explain::execute(&arguments),
        Command::Schema(arguments) => schema::execute(&arguments),
        Command::Completions(arguments) => shell::completions(&arguments, command()),
        Command::Man(arguments) => shell::man(&arguments, command()),
    }
}

/// A line for the user on standard error, separate from results.
pub(crate) fn say(line: &str) {
    // a closed pipe, as with `| head`, is not a failure
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// A result on standard output.
pub(crate) fn show(line: &str) {
    let _ = writeln!(std::io::stdout(), "{line}");
}

/// The first signal ends the run regularly, the second immediately.
pub(crate) fn stop_on_signal(stop: &Arc<AtomicBool>) {
    let stop = Arc::clone(stop);
    let handler = move || {
        if stop.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        say("\nstopping after this step; press again to stop immediately");
    };
    // without a handler a signal ends the program in the default way
    if ctrlc::set_handler(handler).is_err() {
        warn(Message::new(
            Code::SignalsNotCaught,
            "signals cannot be caught; Ctrl-C will lose the last records",
        ));
    }
}

/// SIGUSR1 asks for a checkpoint; the run goes on. Other systems have no such signal.
#[cfg(unix)]
pub(crate) fn checkpoint_on_signal(wanted: &Arc<AtomicBool>) {
    let signal = signal_hook::consts::SIGUSR1;
    if signal_hook::flag::register(signal, Arc::clone(wanted)).is_err() {
        warn(Message::new(
            Code::SignalsNotCaught,
            "SIGUSR1 cannot be caught; it ends this run",
        ));
    }
}

#[cfg(not(unix))]
pub(crate) fn checkpoint_on_signal(_wanted: &Arc<AtomicBool>) {}

/// Loads a scene; reports its warnings or errors.
pub(crate) fn load(case: &Path, overrides: &[Override], files: FilesFrom) -> Result<Scene, Exit> {
    match scene::load_from(case, overrides, files) {
        Ok((scene, warnings)) => {
            if !warnings.located().is_empty() {
                told::problems(&warnings);
            }
            Ok(scene)
        }
        Err(error) => {
            report_scene_error(&error);
            Err(Exit::BadInput)
        }
    }
}

/// Access to files named by a scene, by the flag of a command.
pub(crate) fn files_from(allow_outside: bool) -> FilesFrom {
    if allow_outside {
        FilesFrom::Anywhere
    } else {
        FilesFrom::SceneFolder
    }
}

/// The plain lines, for editors and logs, and the source frame, for reading.
pub(crate) fn report_scene_error(error: &SceneError) {
    use miette::{GraphicalReportHandler, GraphicalTheme};
    let mut frame = String::new();
    let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor());
    told::problems(error);
    if handler.render_report(&mut frame, error).is_ok() {
        // the handler repeats the message above its frame; only the frame is new
        let frame: Vec<&str> = frame
            .lines()
            .skip_while(|line| !line.contains('╭'))
            .collect();
        say(&frame.join("\n"));
    }
}

/// Default run folder: `runs/` and the name of the case file.
pub(crate) fn default_folder(case: &Path) -> PathBuf {
    Path::new("runs").join(case.file_stem().unwrap_or_default())
}
