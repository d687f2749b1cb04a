//! Progress of a run: a line on standard error for people, or events on standard output for programs.

use std::io::{IsTerminal, Write as _};
use std::time::{Duration, Instant};

use super::json::JsonEvents;
use super::line::line;
use crate::cli::say;
use crate::cli::told::{coded, keep, warn};
use crate::messages::{Code, Message};
use crate::output::summary::SettledBlocks;
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
            Event::Settled(found) => {
                self.end();
                unsettled(found).into_iter().for_each(warn);
                if !self.is_quiet {
                    say(&settled(found));
                }
            }
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

/// Words on blocks that have settled.
fn settled(found: &SettledBlocks) -> String {
    let solid = found.solid_fraction.map_or_else(String::new, |share| {
        format!(
            "; grains fill {:.1} % of the space among them",
            100.0 * share
        )
    });
    format!(
        "settled in {:.4} s, {} steps, to a largest speed of {:.2e} m/s{solid}",
        found.time, found.steps, found.fastest
    )
}

/// Warning of blocks that were still moving when their time to settle was over.
pub(super) fn unsettled(found: &SettledBlocks) -> Option<Message> {
    (!found.at_rest).then(|| {
        let words = format!(
            "after {:.4} s of settling the fastest block still has {:.3e} m/s; let time.settle_blocks.at_most be longer, or its speed larger",
            found.time, found.fastest
        );
        Message::new(Code::StillMoving, words)
    })
}

/// Width of the terminal now; columns.
fn columns() -> usize {
    terminal_size::terminal_size_of(std::io::stderr())
        .map_or(WIDTH, |(width, _)| usize::from(width.0))
}
