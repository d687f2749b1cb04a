//! Progress of a run on standard error.

use std::io::{IsTerminal, Write as _};
use std::time::{Duration, Instant};

use crate::cli::say;
use crate::cli::told::{coded, keep};
use crate::messages::Code;
use crate::run::{Event, Progress};

/// Progress: one line updated in place on a terminal, occasional lines in a log.
pub(super) struct ProgressLine {
    is_quiet: bool,
    is_terminal: bool,
    started: Instant,
    stage_started: Instant,
    was_settling: bool,
    last: Option<Instant>,
}

impl ProgressLine {
    pub fn new(is_quiet: bool) -> Self {
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

    pub fn tell(&mut self, event: &Event) {
        match event {
            Event::Step(progress) => self.show(progress),
            Event::FellBack { error, to, share } => {
                self.end();
                keep(Code::StepRepeated);
                say(&format!(
                    "warning: {}\nthe run returns to t = {to:.6} s and continues with {share} of the step for a while",
                    coded(error)
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

    pub fn end(&self) {
        if self.is_terminal && self.last.is_some() {
            say("");
        }
    }
}
