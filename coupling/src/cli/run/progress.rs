//! Progress of a run: a line on standard error for people, or events on standard output for programs.

use std::io::{IsTerminal, Write as _};
use std::time::{Duration, Instant};

use super::json::JsonEvents;
use super::line::line;
use crate::cli::say;
use crate::cli::told::{coded, keep};
use crate::messages::Code;
use crate::run::{Event, Progress};

/// Width of a terminal that does not tell; columns.
const WIDTH: usize = 80;

/// Where progress goes.
pub(super) enum Teller {
    Line(ProgressLine),
    Json(JsonEvents),
}

impl Teller {
    pub fn tell(&mut self, event: &Event) {
        match self {
            Self::Line(line) => line.tell(event),
            Self::Json(events) => events.tell(event),
        }
    }

    pub fn end(&self) {
        if let Self::Line(line) = self {
            line.end();
        }
    }
}

/// Progress: one line updated in place on a terminal, occasional lines in a log.
pub(super) struct ProgressLine {
    is_quiet: bool,
    is_terminal: bool,
    started: Instant,
    last: Option<Instant>,
}

impl ProgressLine {
    pub fn new(is_quiet: bool) -> Self {
        Self {
            is_quiet,
            is_terminal: std::io::stderr().is_terminal(),
            started: Instant::now(),
            last: None,
        }
    }

    fn tell(&mut self, event: &Event) {
        match event {
            Event::Step(progress) => self.show(progress),
            Event::Frame { .. } | Event::Checkpoint(_) => {}
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
        let interval = Duration::from_secs(if self.is_terminal { 1 } else { 30 });
        if self.is_quiet || self.last.is_some_and(|last| last.elapsed() < interval) {
            return;
        }
        self.last = Some(Instant::now());
        if self.is_terminal {
            // a character in the last column makes some terminals wrap
            let line = line(progress, columns().saturating_sub(1));
            let _ = write!(std::io::stderr(), "\r\x1b[K{line}");
        } else {
            let elapsed = self.started.elapsed().as_secs_f64();
            say(&format!("[{elapsed:6.0} s] {}", line(progress, usize::MAX)));
        }
    }

    fn end(&self) {
        if self.is_terminal && self.last.is_some() {
            say("");
        }
    }
}

/// Width of the terminal now; columns.
fn columns() -> usize {
    terminal_size::terminal_size_of(std::io::stderr())
        .map_or(WIDTH, |(width, _)| usize::from(width.0))
}
