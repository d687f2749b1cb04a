//! The engine: a run of riprap in a thread of its own, which answers questions between its steps.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use riprap::messages::{Coded, Message};
use riprap::output::checkpoint_file::Checkpoint;
use riprap::output::observe::gauges::PresentGauges;
use riprap::run::{Ending, Event, Plan, Run};
use riprap::scene::resolve::Scene;
use riprap::world::World;

use crate::errors::run_error;
use crate::wait::{STACK, for_reply};

/// Work for the engine.
type Job = Box<dyn FnOnce(&mut Engine<'_>) + Send>;

/// Failure of the engine.
#[derive(Clone, Debug)]
pub enum Failure {
    /// The run failed.
    Run(Message),
    /// The run is over, and its world gone.
    Ended,
}

impl Failure {
    fn of(error: impl Coded) -> Self {
        Self::Run(Message::of(error))
    }

    /// `riprap.RunError`.
    fn raised(&self, py: Python<'_>) -> PyErr {
        match self {
            Self::Run(message) => run_error(py, &message.to_string(), message.code().as_str()),
            Self::Ended => run_error(py, "the run has ended; riprap.open reads its folder", ""),
        }
    }
}

/// Beginning of a run and its records.
#[derive(Debug)]
pub struct Start {
    /// Threads of its own; all cores without.
    pub threads: Option<usize>,
    /// Hash of the scene as written.
    pub scene_hash: [u8; 32],
    /// State to continue from.
    pub from: Option<Checkpoint>,
    /// Records; a run in memory has none.
    pub records: Option<Records>,
}

/// Records of a run in a folder that is prepared.
#[derive(Debug)]
pub struct Records {
    /// The run folder.
    pub folder: PathBuf,
    /// Wall time between two checkpoints.
    pub checkpoint_interval: Duration,
}

/// Where to advance to.
#[derive(Clone, Copy, Debug)]
pub enum Goal {
    /// The first step at or after a time after settling; s.
    Time(f64),
    /// A number of steps, those of settling included.
    Steps(u64),
}

/// End of an advance.
#[derive(Debug)]
pub struct Advanced {
    /// Time; s.
    pub time: f64,
    /// Warnings: steps that failed and were repeated with shorter ones.
    pub notes: Vec<String>,
}

/// A run and its gauges.
pub struct Engine<'s> {
    /// `None` after its end.
    run: Option<Run<'s>>,
    gauges: PresentGauges,
    scene_hash: [u8; 32],
    has_records: bool,
}

impl<'s> Engine<'s> {
    fn new(scene: &'s mut Scene, start: Start) -> Result<Self, Failure> {
        let has_records = start.records.is_some();
        let scene_hash = start.scene_hash;
        let run = match start.records {
            Some(records) => Run::start(
                scene,
                Plan {
                    from: start.from,
                    scene_hash,
                    checkpoint_interval: records.checkpoint_interval,
                    ..Plan::new(&records.folder)
                },
            ),
            None => Run::in_memory(scene).and_then(|mut run| {
                if let Some(checkpoint) = &start.from {
                    run.restore(checkpoint)?;
                }
                Ok(run)
            }),
        };
        let run = run.map_err(Failure::of)?;
        let mut gauges = PresentGauges::new(run.scene(), run.world());
        if !run.is_settling() {
            gauges.follow(run.world());
        }
        Ok(Self {
            run: Some(run),
            gauges,
            scene_hash,
            has_records,
        })
    }

    /// The run.
    pub fn run(&self) -> Result<&Run<'s>, Failure> {
        self.run.as_ref().ok_or(Failure::Ended)
    }

    /// The world.
    pub fn world(&self) -> Result<&World, Failure> {
        self.run().map(Run::world)
    }

    /// The gauges.
    pub fn gauges(&self) -> &PresentGauges {
        &self.gauges
    }

    /// Whether the run is recorded in a folder.
    pub fn has_records(&self) -> bool {
        self.has_records
    }

    /// Takes steps until the goal, the end of a run with records, or a stop.
    pub fn advance(&mut self, goal: Goal, stop: &AtomicBool) -> Result<Advanced, Failure> {
        let run = self.run.as_mut().ok_or(Failure::Ended)?;
        let (mut steps, mut notes) = (0, Vec::new());
        loop {
            let has_arrived = match goal {
                Goal::Time(time) => !run.is_settling() && time <= run.world().time(),
                Goal::Steps(n) => n <= steps,
            };
            let is_over = self.has_records && run.is_over();
            if has_arrived || is_over || stop.load(Ordering::Relaxed) {
                let time = run.world().time();
                return Ok(Advanced { time, notes });
            }
            match run.step() {
                Ok(Event::Step(_)) => steps += 1,
                Ok(Event::Frame { .. } | Event::Checkpoint(_) | Event::Settled(_)) => {}
                Ok(Event::FellBack { error, to, share }) => notes.push(format!(
                    "{error}; the run returns to t = {to:.6} s and continues with {share} of the step for a while"
                )),
                Err(error) if self.has_records => {
                    let run = self.run.take().ok_or(Failure::Ended)?;
                    // with what grew first
                    return match run.finish(Err(error)) {
                        Err(error) => Err(Failure::of(error)),
                        Ok(_) => Err(Failure::Ended),
                    };
                }
                Err(error) => return Err(Failure::of(error)),
            }
            if !run.is_settling() {
                self.gauges.follow(run.world());
            }
        }
    }

    /// Ends a run with records, and writes its last ones.
    pub fn finish(&mut self) -> Result<Ending, Failure> {
        let run = self.run.take().ok_or(Failure::Ended)?;
        let ending = match run.is_over() {
            true => Ending::Completed,
            false => Ending::Interrupted,
        };
        let finished = run.finish(Ok(ending));
        finished.map(|(_, ending)| ending).map_err(Failure::of)
    }

    /// Writes the present state to a file.
    pub fn write_state(&self, path: &Path) -> Result<u64, Failure> {
        let written = self.run()?.write_state(path, self.scene_hash);
        written.map_err(Failure::of)
    }
}

/// Access to the engine from Python.
#[derive(Debug)]
pub struct Handle {
    jobs: Sender<Job>,
}

impl Handle {
    /// Starts an engine and waits until its world stands.
    pub fn start(py: Python<'_>, scene: Scene, start: Start) -> PyResult<Self> {
        let pool = match start.threads {
            None => None,
            Some(0) => return Err(PyValueError::new_err("threads must be 1 or more")),
            Some(n) => {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
                Some(pool.map_err(|error| PyValueError::new_err(error.to_string()))?)
            }
        };
        let (jobs, waiting) = channel();
        let (answer, reply) = channel();
        let thread = thread::Builder::new().name("riprap".into());
        thread.stack_size(STACK).spawn(move || {
            let live = move || live(scene, start, &waiting, &answer);
            match pool {
                Some(pool) => pool.install(live),
                None => live(),
            }
        })?;
        for_reply(py, reply, None)?.map_err(|failure| failure.raised(py))?;
        Ok(Self { jobs })
    }

    /// Asks the engine, after what was asked before; a signal ends the wait.
    pub fn ask<T: Send + 'static>(
        &self,
        py: Python<'_>,
        question: impl FnOnce(&mut Engine<'_>) -> Result<T, Failure> + Send + 'static,
    ) -> PyResult<T> {
        for_reply(py, self.send(question), None)?.map_err(|failure| failure.raised(py))
    }

    /// Advances the engine; a signal stops it after the present step.
    pub fn advance(&self, py: Python<'_>, goal: Goal) -> PyResult<Advanced> {
        let stop = Arc::new(AtomicBool::new(false));
        let theirs = Arc::clone(&stop);
        let reply = self.send(move |engine| engine.advance(goal, &theirs));
        for_reply(py, reply, Some(&stop))?.map_err(|failure| failure.raised(py))
    }

    fn send<T: Send + 'static>(
        &self,
        question: impl FnOnce(&mut Engine<'_>) -> Result<T, Failure> + Send + 'static,
    ) -> Receiver<Result<T, Failure>> {
        let (answer, reply) = channel();
        // an engine that is lost drops the question, which the wait for the reply reports
        let _ = self.jobs.send(Box::new(move |engine| {
            let _ = answer.send(question(engine));
        }));
        reply
    }
}

/// Life of an engine: until nobody can ask any more.
fn live(mut scene: Scene, start: Start, jobs: &Receiver<Job>, ready: &Sender<Result<(), Failure>>) {
    match Engine::new(&mut scene, start) {
        Ok(mut engine) => {
            // nobody waits after a signal
            let _ = ready.send(Ok(()));
            while let Ok(job) = jobs.recv() {
                job(&mut engine);
            }
        }
        Err(failure) => {
            let _ = ready.send(Err(failure));
        }
    }
}
