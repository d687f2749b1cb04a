//! `riprap run --json`: an object a line on standard output. Names are stable and end with their unit.
//!
//! ```text
//! start, settle, progress, frame, fallback, checkpoint, warning, end
//! ```

use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::{Map, Value, json};

use super::progress::unsettled;
use crate::build_info::COMMIT;
use crate::cli::problems::problems;
use crate::cli::{Exit, show};
use crate::messages::Coded;
use crate::output::checkpoint_file::Checkpoint;
use crate::output::run_folder;
use crate::output::summary::Summary;
use crate::run::{Event, Progress, RunError};
use crate::scene::error::SceneError;
use crate::scene::resolve::Scene;

/// Wall time between two events `progress`.
const INTERVAL: Duration = Duration::from_secs(1);

/// Events of a run as lines.
pub(super) struct JsonEvents {
    last: Option<Instant>,
    is_settling: bool,
}

impl JsonEvents {
    /// Events after the start of a run.
    pub fn begin(scene: &Scene, folder: &Path, from: Option<&Checkpoint>) -> Self {
        let settling = scene.longest_settling();
        let particles = |scene: &Scene| {
            let fluid = scene.fluid.as_ref();
            fluid.map_or(0, |fluid| fluid.lattice.positions.len())
        };
        let resumed = from.map(|checkpoint| {
            let header = &checkpoint.header;
            json!({ "is_settling": header.is_settling, "time_s": header.time, "step": header.steps })
        });
        emit(
            "start",
            json!({
                "title": scene.title,
                "folder": folder.display().to_string(),
                "version": env!("CARGO_PKG_VERSION"),
                "commit": COMMIT,
                "pid": std::process::id(),
                "threads": rayon::current_num_threads(),
                "particles": particles(scene),
                "blocks": scene.blocks.len(),
                "settle_s": settling,
                "duration_s": scene.duration,
                "resumed_from": resumed,
            }),
        );
        let is_settling = match from {
            None => 0.0 < settling,
            Some(checkpoint) => checkpoint.header.is_settling,
        };
        if is_settling {
            emit(
                "settle",
                json!({ "state": "started", "settle_s": settling }),
            );
        }
        Self {
            last: None,
            is_settling,
        }
    }

    pub fn tell(&mut self, event: &Event) {
        match event {
            Event::Step(progress) => self.step(progress),
            Event::Frame { time, files } => {
                // the first frame is that of t = 0
                self.settle(false);
                emit("frame", json!({ "time_s": time, "files": files }));
            }
            Event::Settled(found) => {
                self.is_settling = false;
                emit(
                    "settle",
                    json!({
                        "state": "ended", "time_s": found.time, "steps": found.steps, "at_rest": found.at_rest,
                        "fastest_m_per_s": found.fastest, "solid_fraction": found.solid_fraction,
                    }),
                );
                unsettled(found).iter().for_each(warn);
            }
            Event::Checkpoint(written) => emit("checkpoint", json!(written)),
            Event::FellBack { error, to, share } => emit(
                "fallback",
                json!({
                    "code": error.code().as_str(), "message": error.to_string(), "time_s": to,
                    "share_of_step": share,
                }),
            ),
        }
    }

    /// Notes whether water or blocks settle now.
    fn settle(&mut self, is_settling: bool) {
        if self.is_settling && !is_settling {
            self.is_settling = false;
            emit("settle", json!({ "state": "ended" }));
        }
    }

    fn step(&mut self, progress: &Progress) {
        self.settle(progress.is_settling);
        if self.last.is_some_and(|last| last.elapsed() < INTERVAL) {
            return;
        }
        self.last = Some(Instant::now());
        let stage = if progress.is_settling {
            "settling"
        } else {
            "running"
        };
        emit(
            "progress",
            json!({
                "stage": stage,
                "step": progress.steps,
                "time_s": progress.time,
                "end_s": progress.end,
                "share": progress.share,
                "dt_s": progress.dt,
                "dt_limited_by": progress.cause,
                "steps_per_s": progress.steps_per_second,
                "eta_s": progress.left,
                "particles": progress.particles,
                "contacts": progress.contacts,
                "max_speed_m_per_s": progress.fastest,
            }),
        );
    }
}

/// Warnings of a scene, or its errors.
pub(super) fn tell_problems(error: &SceneError) {
    for problem in problems(error) {
        emit("warning", json!(problem));
    }
}

/// A warning of the run.
pub(super) fn warn(doubt: &impl Coded) {
    emit(
        "warning",
        json!({ "severity": "warning", "code": doubt.code().as_str(), "message": doubt.to_string() }),
    );
}

/// The last event of a run that has a folder.
pub(super) fn end(summary: &Summary, folder: &Path, exit: Exit) {
    let state = state(exit);
    emit(
        "end",
        json!({
            "state": state, "exit_code": exit.code(), "folder": folder.display().to_string(),
            "verdict": summary.verdict, "summary": summary,
        }),
    );
}

/// The last event of a run that failed.
pub(super) fn end_failed(error: &RunError, folder: &Path) {
    // written in every case but that of a full disk
    let summary = run_folder::read_summary(folder).ok().flatten();
    emit(
        "end",
        json!({
            "state": "failed", "exit_code": Exit::Failed.code(), "folder": folder.display().to_string(),
            "code": error.code().as_str(), "message": error.to_string(), "summary": summary,
        }),
    );
}

/// The last event of a run that did not start, for reasons on standard error.
pub(super) fn end_unstarted(exit: Exit) {
    emit(
        "end",
        json!({ "state": state(exit), "exit_code": exit.code() }),
    );
}

fn state(exit: Exit) -> &'static str {
    match exit {
        Exit::Done => "finished",
        Exit::Failed => "failed",
        Exit::BadInput => "refused",
        Exit::OutOfTime => "wall_limit",
        Exit::Interrupted => "interrupted",
    }
}

/// Writes an event, its name first.
fn emit(name: &str, content: Value) {
    let mut event = Map::new();
    event.insert("event".to_owned(), json!(name));
    if let Value::Object(content) = content {
        event.extend(content);
    }
    show(&Value::Object(event).to_string());
}
