//! Evidence of a failure: the last steps before it once more, with a look at what grows first.
//!
//! A run that goes well pays nothing for it. One that failed goes back to the last good state and takes the same steps, which
//! are the same to the bit: once to find what grows first, and once to record its path.

mod growth;
mod paths;

use super::{Run, RunError};
use crate::files::vtk;
use crate::output::run_folder;
use crate::saved::Saved;
use crate::world::StepError;
use growth::Growth;
use paths::Paths;

/// Steps before a failure that are looked at.
const WINDOW: u64 = 20;

impl Run<'_> {
    /// Adds what grew first to the failure of a step, and leaves its paths in the run folder.
    ///
    /// Failures of another kind stay as they are; so does one whose evidence cannot be had, which must not hide it.
    pub(super) fn with_evidence(&mut self, failure: RunError) -> RunError {
        if !matches!(failure, RunError::Step(_) | RunError::Unstable { .. }) {
            return failure;
        }
        // the same steps end in the same state, but for what counts wall time
        let (counters, costs) = (self.counters.clone(), self.costs);
        let phases = self.world.phases();
        let findings = self.examine();
        (self.counters, self.costs) = (counters, costs);
        self.world.progress.phases = phases;
        match findings {
            Ok(Some(findings)) => RunError::Examined {
                failure: Box::new(failure),
                findings,
            },
            Ok(None) | Err(_) => failure,
        }
    }

    /// Repeats the last steps and writes the paths of what grew first; its description, or `None` without a good state.
    fn examine(&mut self) -> Result<Option<String>, RunError> {
        let Some(good) = self.last_good.take() else {
            return Ok(None);
        };
        let (end, reduction) = (self.place(), self.counters.reduction);
        self.go_back(&good.state)?;
        self.counters.reduction = reduction;
        drop(good);
        while self.place().is_settling == end.is_settling && self.place().steps + WINDOW < end.steps
        {
            self.advance()?;
        }
        let begin = self.save_bare(Vec::new())?;
        let mut growth = Growth::of(&self.world);
        let error = self.repeat(end.steps, |run, (step, _)| growth.look(&run.world, step));
        let grown = growth.most_suspect(error.as_ref(), &self.world);
        self.go_back(&begin)?;
        let mut paths = Paths::new(grown);
        let place = self.place();
        paths.record(&self.world, self.scene, (place.steps, place.time));
        self.repeat(end.steps, |run, (step, time)| {
            paths.record(&run.world, run.scene, (step, time));
        });
        // the failed step counts, although the clock has not ticked after it
        paths.shorten(WINDOW as usize + 1);
        vtk::write(&self.folder.join(run_folder::OFFENDERS), &paths.poly_data())
            .map_err(crate::output::observe::ObserveError::from)?;
        Ok(paths.in_words(self.scene, growth.scales()))
    }

    /// Takes steps up to the failure, which `end` steps came before at most, and looks at the state after each with its
    /// number and time (s), the failed one included; returns the failure.
    fn repeat(&mut self, end: u64, mut look: impl FnMut(&Self, (u64, f64))) -> Option<StepError> {
        let mut step = self.place().steps;
        loop {
            let before = self.place().time;
            let dt = self.next_step().map_or(0.0, |step| step.dt);
            let stepped = self.advance();
            step += 1;
            // a step that was not taken has no state of its own
            if !matches!(stepped, Err(StepError::Stalled { .. })) {
                look(self, (step, before + dt));
            }
            match stepped {
                Err(error) => return Some(error),
                Ok(_) if end < step => return None,
                Ok(_) => {}
            }
        }
    }

    /// Appends the state without that of the observers.
    pub(super) fn save_bare(&self, out: Vec<u8>) -> Saved {
        let out = postcard::to_extend(&(&self.counters, self.costs), out)?;
        self.world.save(out)
    }

    /// Restores a state but for the observers, whose files stay as they are.
    pub(super) fn go_back(&mut self, state: &[u8]) -> Result<(), RunError> {
        let rest;
        ((self.counters, self.costs), rest) = postcard::take_from_bytes(state)?;
        self.world.read(rest)?;
        Ok(())
    }
}
