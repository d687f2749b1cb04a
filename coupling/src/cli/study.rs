//! `riprap study`.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use super::{Exit, Program, failed, report_scene_error, say, show, stop_on_signal};
use crate::messages::{Code, Coded, Message, of_writing};
use crate::scene::estimate as memory;
use crate::study::jobs::{Means, Progress};
use crate::study::trade::execute::{Ended, Executor, execute as run_all};
use crate::study::trade::outcome::Outcome;
use crate::study::trade::plan::{Planned, Study};
use crate::study::trade::results::{Fronts, bought, collect, front_table, table, write};
use crate::study::trade::{picture, plot};

/// Fraction of the free memory available to all runs.
const MEMORY_SHARE: f64 = 0.8;
/// Free memory assumed if unknown; bytes.
const UNKNOWN_MEMORY: u64 = 4_000_000_000;

/// Measure error against cost for settings of a scene.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// The study, a RON file; see benches/trade/README.md.
    study: PathBuf,
    /// Folder of the runs and results; runs/trade/NAME when left out. Completed runs there are not repeated.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Runs at once, one thread each; all cores when left out.
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
}

pub(crate) fn execute(arguments: &Arguments, program: &Program) -> Exit {
    let mut study = match Study::load(&arguments.study) {
        Ok(study) => study,
        Err(error) => {
            report_scene_error(&error);
            return Exit::BadInput;
        }
    };
    let name = arguments.study.file_stem().unwrap_or_default();
    let default = || Path::new("runs").join("trade").join(name);
    let folder = arguments.output.clone().unwrap_or_else(default);
    let stop = Arc::new(AtomicBool::new(false));
    stop_on_signal(&stop);
    let means = means(arguments.jobs);
    let case = study.case();
    let started = Instant::now();
    let tell = |progress: Progress| {
        let time = started.elapsed().as_secs_f64();
        say(&format!(
            "[{time:6.0} s] {} of {} runs",
            progress.ended, progress.all
        ));
    };
    let (ended, all) = loop {
        let runner = |run: &Planned, folder: &Path| spawn((program, &case), run, folder);
        let executor = Executor {
            means,
            stop: &stop,
            runner: &runner,
            tell: &tell,
        };
        let ended = run_all(&study, &folder, executor);
        let all = collect(&study, &folder);
        let more = match ended {
            Ok(true) => study.next(&all),
            _ => Vec::new(),
        };
        if more.is_empty() {
            break (ended, all);
        }
        study.add_possible(more);
    };
    let written = write_all(&study, &all, &folder);
    show(&words(&study, &all));
    let message = match (ended, written) {
        (Ok(true), Ok(())) => {
            show(&format!(
                "trade.csv, front.csv, trade.svg and trade.png are in {}",
                folder.display()
            ));
            return Exit::Done;
        }
        (Ok(false), Ok(())) => {
            say(&format!(
                "stopped; the same command continues with the remaining runs, in {}",
                folder.display()
            ));
            return Exit::Interrupted;
        }
        (Err(error), _) => Message::of(error),
        (_, Err(message)) => message,
    };
    failed(message)
}

/// Writes tables and plots; reports failures.
fn write_all(study: &Study, all: &[Outcome], folder: &Path) -> Result<(), Message> {
    let svg = plot::svg(study, all);
    let png =
        picture::png(&svg).map_err(|error| Message::new(Code::NothingToDraw, error.to_string()));
    let files = [
        ("trade.csv", Ok(table(study, all).into_bytes())),
        ("front.csv", Ok(front_table(study, all).into_bytes())),
        ("trade.svg", Ok(svg.into_bytes())),
        ("trade.png", png),
    ];
    files.into_iter().try_for_each(|(name, bytes)| {
        let path = folder.join(name);
        let bytes = bytes.map_err(|message| {
            let words = format!("cannot write {}: {message}", path.display());
            Message::new(message.code(), words)
        })?;
        write(&path, &bytes).map_err(|error| {
            let words = format!("cannot write {}: {error}", path.display());
            Message::new(of_writing(&error), words)
        })
    })
}

/// A run as a separate process, so that a failure or lack of memory affects no other run.
pub(super) fn spawn(
    (program, case): (&Program, &Path),
    run: &Planned,
    folder: &Path,
) -> io::Result<Option<Ended>> {
    let started = Instant::now();
    let mut command = program.command()?;
    command.arg("run").arg(case).arg("-o").arg(folder);
    command.args(["--force", "--quiet", "--threads", "1"]);
    for set in &run.overrides {
        command
            .arg("--set")
            .arg(format!("{}={}", set.path, set.value));
    }
    let output = command.output()?;
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    let wall_time = started.elapsed().as_secs_f64();
    match output.status.code() {
        Some(0) => Ok(Some(Ended {
            completed: true,
            message: String::new(),
            wall_time,
        })),
        // a failed step or start is a result. A full disk cannot store it either
        Some(1) => Ok(Some(Ended {
            completed: false,
            message: said,
            wall_time,
        })),
        Some(130) | None => Ok(None),
        Some(_) => Err(io::Error::other(said)),
    }
}

/// Number of concurrent runs, by default the number of cores, within the free memory.
pub(super) fn means(jobs: Option<usize>) -> Means {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    Means {
        workers: jobs.unwrap_or_else(cores),
        memory: (MEMORY_SHARE
            * memory::available().map_or(UNKNOWN_MEMORY, |memory| memory.bytes) as f64)
            as u64,
    }
}

/// Report of the front and of the effect of each knob.
fn words(study: &Study, all: &[Outcome]) -> String {
    let mut lines = vec![format!("{}: {}", study.file.title, study.file.output.name)];
    for &k in &Fronts::of(all).by_time {
        let found = &all[k];
        let run = study.runs.iter().find(|run| run.key == found.key);
        lines.push(format!(
            "  {:8.1} s  {:8.3} %  {}",
            found.cost.wall_time,
            100.0 * found.error.unwrap_or(f64::NAN),
            run.map_or(String::new(), |run| run.label(study)),
        ));
    }
    let failed = all.iter().filter(|found| !found.is_stable).count();
    if failed > 0 {
        lines.push(format!("  {failed} runs failed, see trade.csv"));
    }
    for skipped in &study.skipped {
        lines.push(format!("  skipped {}", skipped.label(study)));
    }
    for (knob, bought) in bought(study, all) {
        lines.push(match bought {
            Some(factor) => {
                format!("  {knob}: doubling the cost multiplies the error by {factor:.2}")
            }
            None => format!("  {knob}: the cost changes by less than half"),
        });
    }
    lines.join("\n")
}
