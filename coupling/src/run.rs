//! The loop: steps until the end, observers when due, and an orderly end in every case.
//!
//! The state is kept every so many steps. A failed step takes the run back there, and on with half the step for a while;
//! where that does not help the run ends, with the kept state on disk and the paths of what grew first. The kept state is written to disk from time to
//! time, and when the run is stopped: a resumed run gives the same bits.

mod blow_up;
mod build;
mod counters;
mod events;
mod evidence;
pub mod ineffective;
mod last_good;
pub(crate) mod named;
mod observers;
mod pace;
mod packing;
pub mod preparation;
mod settling;
mod status;
mod step_reduction;
mod summary;
mod wall_limit;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::files::table::Start;
use crate::output::checkpoint_file::{self as checkpoint, Checkpoint, Written};
use crate::output::observe::ObserveError;
use crate::output::observe::frames::FrameFiles;
use crate::output::run_folder;
use crate::output::summary::Summary;
use crate::saved::Saved;
use crate::scene::resolve::Scene;
use crate::world::time_step::TimeStep;
use crate::world::{StepError, World};
use blow_up::BlowUpDetector;
pub use build::build;
#[cfg(test)]
pub(crate) use build::world_of;
use counters::{Costs, Counters, Stage};
pub use events::{Ending, Event, Progress, RunError};
use last_good::LastGoodState;
use named::named;
use observers::Observers;
use pace::Pace;
use status::Status;
use step_reduction::StepReduction;
use wall_limit::Reserve;
pub use wall_limit::WallLimit;

/// Time left at which a run is over, a sum of equal steps being off by round-off, × duration.
const ROUND_OFF: f64 = 1e-12;

/// Folder, start and checkpoints of a run.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// The run folder, which exists.
    pub folder: &'a Path,
    /// Checkpoint to resume from; the folder then holds the files of the run.
    pub from: Option<Checkpoint>,
    /// Hash of the scene text in the folder, see [`checkpoint::scene_hash`].
    pub scene_hash: [u8; 32],
    /// Wall time from one checkpoint to the next.
    pub checkpoint_interval: Duration,
    /// Wall time that the run may take; `None`: any.
    pub wall_limit: Option<WallLimit>,
    /// Set from outside when a checkpoint is wanted at once, and reset when it is written.
    pub checkpoint_wanted: Arc<AtomicBool>,
}

impl<'a> Plan<'a> {
    /// A run from its beginning, of a scene without a text, with a checkpoint every ten minutes.
    pub fn new(folder: &'a Path) -> Self {
        Self {
            folder,
            from: None,
            scene_hash: Default::default(),
            checkpoint_interval: Duration::from_secs(600),
            wall_limit: None,
            checkpoint_wanted: Arc::default(),
        }
    }
}

/// Runs a scene; `stop` ends it after the current step. The scene loses its initial particles, see [`Scene::release_start`].
///
/// `tell` is called with every event. The summary is written in every case, and a checkpoint of the last good state.
///
/// # Errors
///
/// [`RunError`]; everything computed before is in the folder.
pub fn run(
    scene: &mut Scene,
    plan: Plan,
    stop: &AtomicBool,
    tell: &mut dyn FnMut(Event),
) -> Result<(Summary, Ending), RunError> {
    let mut run = Run::start(scene, plan)?;
    let ending = run.until(stop, tell);
    run.finish(ending)
}

/// Position of a state in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    is_settling: bool,
    /// Time of the stage; s.
    time: f64,
    /// Steps of the stage.
    steps: u64,
}

/// A run in progress: [`Run::start`], [`Run::step`] until [`Run::is_over`], [`Run::finish`].
#[derive(Debug)]
pub struct Run<'a> {
    scene: &'a Scene,
    folder: PathBuf,
    /// Hash of the scene text.
    scene_hash: [u8; 32],
    world: World,
    /// `None` for a run in memory.
    observers: Option<Observers>,
    counters: Counters,
    costs: Costs,
    last_good: Option<LastGoodState>,
    /// States kept since the program started.
    n_kept: u64,
    started: Instant,
    checkpoint_interval: Duration,
    last_checkpoint: Instant,
    wall_limit: Option<WallLimit>,
    checkpoint_wanted: Arc<AtomicBool>,
    pace: Pace,
    reserve: Reserve,
    status: Status,
    /// Events since the last step that was told.
    notices: Vec<Event>,
}

impl<'a> Run<'a> {
    /// Builds the world and opens the files of a run. The scene loses its initial particles.
    ///
    /// # Errors
    ///
    /// [`RunError`] when the world cannot be built, a file cannot be created or the checkpoint belongs to another scene.
    pub fn start(scene: &'a mut Scene, plan: Plan) -> Result<Self, RunError> {
        // of an earlier end, which is not that of this run
        let _ = std::fs::remove_file(plan.folder.join(run_folder::OFFENDERS));
        let start = match plan.from {
            None => Start::New,
            Some(_) => Start::Resume,
        };
        let mut run = Self::in_memory(scene)?;
        run.folder = plan.folder.to_path_buf();
        run.scene_hash = plan.scene_hash;
        run.checkpoint_interval = plan.checkpoint_interval;
        run.wall_limit = plan.wall_limit;
        run.checkpoint_wanted = plan.checkpoint_wanted;
        run.observers = Some(Observers::new(run.scene, plan.folder, &run.world, start)?);
        match plan.from {
            None if !run.is_settling() => run.observe()?,
            None => {}
            Some(checkpoint) => run.restore(&checkpoint)?,
        }
        run.write_progress(None);
        Ok(run)
    }

    /// Builds the world of a run without a folder: nothing is recorded, and the steps are those of a run with one. The scene
    /// loses its initial particles.
    ///
    /// # Errors
    ///
    /// [`RunError`] when the world cannot be built.
    pub fn in_memory(scene: &'a mut Scene) -> Result<Self, RunError> {
        let world = build(scene)?;
        scene.release_start();
        let settles = 0.0 < scene.longest_settling();
        let stage = match settles {
            true => Stage::Settling {
                time: 0.0,
                steps: 0,
            },
            false => Stage::Running,
        };
        let mut run = Self {
            scene,
            folder: PathBuf::new(),
            scene_hash: [0; 32],
            observers: None,
            counters: Counters::new(&world, stage),
            world,
            costs: Costs::default(),
            last_good: None,
            n_kept: 0,
            started: Instant::now(),
            checkpoint_interval: Duration::MAX,
            last_checkpoint: Instant::now(),
            wall_limit: None,
            checkpoint_wanted: Arc::default(),
            pace: Pace::default(),
            reserve: Reserve::default(),
            status: Status::default(),
            notices: Vec::new(),
        };
        if !settles {
            run.begin();
        }
        Ok(run)
    }

    /// Continues from a checkpoint of the same scene; a run in memory also from that of a run with a folder.
    ///
    /// # Errors
    ///
    /// [`RunError`] when the checkpoint belongs to another scene. The run can then not be continued.
    pub fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), RunError> {
        self.reopen_records(&checkpoint.state)?;
        self.read(&checkpoint.state)?;
        self.costs.n_resumed += 1;
        Ok(())
    }

    /// Writes the present state to a checkpoint file of its own, for [`Run::restore`]; returns its size in bytes.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn write_state(&self, path: &Path, scene_hash: [u8; 32]) -> Result<u64, ObserveError> {
        LastGoodState::new(self.save_bare(Vec::new())?, self.place()).write_to(path, scene_hash)
    }

    /// Scene of the run, without its initial particles.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// World of the run.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Whether the run has reached its end.
    pub fn is_over(&self) -> bool {
        let left = self.scene.duration - self.world.time();
        !self.is_settling() && (left <= ROUND_OFF * self.scene.duration || self.is_at_rest())
    }

    /// Whether nothing has moved for the time that the scene asks for.
    fn is_at_rest(&self) -> bool {
        let asked = self.scene.stop_at_rest.zip(self.counters.at_rest_since);
        asked.is_some_and(|([_, time], since)| time <= self.world.time() - since)
    }

    /// Takes a step, or falls back to the last good state.
    ///
    /// # Errors
    ///
    /// [`RunError`] when neither is possible; the run is then to be finished with it.
    pub fn step(&mut self) -> Result<Event, RunError> {
        let (start, before) = (Instant::now(), self.position());
        if self.is_good_due() {
            self.keep_good()?;
        }
        if self.checkpoint_wanted.swap(false, Ordering::Relaxed) {
            self.write_checkpoint()?;
        }
        let event = match self.take_step() {
            Ok(step) => Ok(step),
            Err(RunError::Step(error)) => Err(self.fall_back(named(error, self.scene))?),
            Err(error) => return Err(error),
        };
        let wall = start.elapsed().as_secs_f64();
        self.pace.add(wall, self.position() - before);
        self.reserve.add_step(wall);
        Ok(match event {
            Ok(step) => {
                let progress = self.progress(step);
                self.status.last = Some(progress);
                self.write_progress_when_due();
                Event::Step(progress)
            }
            Err(fallen) => fallen,
        })
    }

    /// Takes steps until the end; then all frames are on disk.
    fn until(
        &mut self,
        stop: &AtomicBool,
        tell: &mut dyn FnMut(Event),
    ) -> Result<Ending, RunError> {
        let ending = self.step_until(stop, tell);
        let written = self.await_frames();
        self.notices.drain(..).for_each(&mut *tell);
        let ending = ending?;
        written?;
        Ok(ending)
    }

    fn step_until(
        &mut self,
        stop: &AtomicBool,
        tell: &mut dyn FnMut(Event),
    ) -> Result<Ending, RunError> {
        while !self.is_over() {
            if stop.load(Ordering::Relaxed) {
                return Ok(Ending::Interrupted);
            }
            if self.is_out_of_time() {
                return Ok(Ending::OutOfTime);
            }
            let event = self.step();
            self.notices.drain(..).for_each(&mut *tell);
            tell(event?);
        }
        Ok(Ending::Completed)
    }

    /// Whether the wall time that is left is needed for the end of the run.
    fn is_out_of_time(&self) -> bool {
        let limit = self.wall_limit.as_ref();
        // a first checkpoint shows what the last one costs; a resumed run has one anyway
        let knows = self.reserve.knows_checkpoint() || 0 < self.costs.n_resumed;
        limit.is_some_and(|limit| knows && limit.is_reached(Instant::now(), &self.reserve))
    }

    /// Step of the present stage with its records.
    fn take_step(&mut self) -> Result<TimeStep, RunError> {
        let was_settling = self.is_settling();
        let step = self.advance()?;
        if was_settling && !self.is_settling() {
            self.open_records()?;
        }
        if !self.is_settling() {
            self.observe()?;
        }
        Ok(step)
    }

    /// The step that the state asks for, within the present share.
    fn next_step(&self) -> Result<TimeStep, StepError> {
        let share = self.counters.reduction.share(self.place().time);
        self.world.next_step_within(self.span(), share)
    }

    /// Duration of the present stage, or more: a thousandth of it bounds the step in free flight; s.
    fn span(&self) -> f64 {
        match &self.scene.settle_blocks {
            Some(asked) if self.is_settling() => self.scene.duration.max(asked.at_most),
            _ => self.scene.duration,
        }
    }

    /// Step of the present stage.
    fn advance(&mut self) -> Result<TimeStep, StepError> {
        let step = self.next_step()?;
        match self.counters.stage {
            Stage::Settling { .. } => {
                if self.settle(step)? {
                    self.costs.settling = self.wall_time();
                    self.begin();
                }
            }
            Stage::Running => {
                self.world.step(step)?;
                self.counters.count(step);
                if let Some([speed, _]) = self.scene.stop_at_rest {
                    let time = self.world.time();
                    self.counters.watch_rest(&self.world, speed, time);
                }
                self.check_stability()?;
            }
        }
        Ok(step)
    }

    /// t = 0.
    fn begin(&mut self) {
        self.counters.stage = Stage::Running;
        self.counters.detector = BlowUpDetector::of(&self.world);
        self.counters.reduction = StepReduction::default();
        self.counters.at_rest_since = None;
    }

    /// Periodic check for faults that no single step shows.
    fn check_stability(&mut self) -> Result<(), StepError> {
        if !BlowUpDetector::is_due(&self.world) {
            return Ok(());
        }
        let start = Instant::now();
        let seen = self.counters.detector.check(&self.world);
        self.costs.guards += start.elapsed().as_secs_f64();
        seen
    }

    fn observe(&mut self) -> Result<(), ObserveError> {
        let Some(observers) = &mut self.observers else {
            return Ok(());
        };
        let start = Instant::now();
        let observed = observers.observe(&self.world);
        let written = observers.frames.take_written();
        let wall = start.elapsed().as_secs_f64();
        self.costs.output += wall;
        self.reserve.add_output(wall);
        observed.and(written).map(|files| self.announce(files))
    }

    /// Waits for frames that are being written.
    fn await_frames(&mut self) -> Result<(), ObserveError> {
        let Some(observers) = &mut self.observers else {
            return Ok(());
        };
        let start = Instant::now();
        let awaited = observers.frames.wait();
        let written = observers.frames.take_written();
        self.costs.output += start.elapsed().as_secs_f64();
        awaited.and(written).map(|files| self.announce(files))
    }

    /// Notes frames that are on disk.
    fn announce(&mut self, written: Vec<FrameFiles>) {
        let events = written.into_iter().map(|FrameFiles { time, names }| {
            let files = names;
            Event::Frame { time, files }
        });
        self.notices.extend(events);
    }

    /// Whether water or blocks are still coming to rest before t = 0.
    pub fn is_settling(&self) -> bool {
        self.counters.stage != Stage::Running
    }

    fn place(&self) -> Place {
        let (time, steps) = match self.counters.stage {
            Stage::Settling { time, steps } => (time, steps),
            Stage::Running => (self.world.time(), self.world.clock().steps),
        };
        Place {
            is_settling: self.is_settling(),
            time,
            steps,
        }
    }

    /// Whether the state is to be kept now.
    fn is_good_due(&self) -> bool {
        let Place {
            is_settling,
            time,
            steps,
        } = self.place();
        let is_known = self
            .last_good
            .as_ref()
            .is_some_and(|good| (good.place.is_settling, good.place.steps) == (is_settling, steps));
        // a run that was stopped between two of them resumes there, and needs one to fall back to
        let is_due = self.last_good.is_none() || LastGoodState::is_due(steps, &self.world);
        is_due && !is_known && !self.counters.reduction.is_on(time)
    }

    fn keep_good(&mut self) -> Result<(), RunError> {
        let start = Instant::now();
        self.counters.reduction.end();
        let mut state = self
            .last_good
            .take()
            .map_or_else(Vec::new, |good| good.state);
        state.clear();
        self.last_good = Some(LastGoodState::new(self.save(state)?, self.place()));
        self.n_kept += 1;
        self.costs.guards += start.elapsed().as_secs_f64();
        let is_first = self.wall_limit.is_some() && !self.reserve.knows_checkpoint();
        if is_first || self.checkpoint_interval <= self.last_checkpoint.elapsed() {
            self.write_checkpoint()?;
        }
        Ok(())
    }

    /// Keeps the present state of a run that stops before it has kept another than the one it began with: a job that is shorter than
    /// the interval of these would begin there again, and the next one, too.
    fn keep_progress(&mut self, ending: &Result<Ending, RunError>) -> Result<(), RunError> {
        let is_reduced = self.counters.reduction.is_on(self.place().time);
        match ending {
            Ok(Ending::Interrupted | Ending::OutOfTime) if self.n_kept <= 1 && !is_reduced => {
                self.keep_good()
            }
            _ => Ok(()),
        }
    }

    /// Writes the last good state to disk, unless it is there.
    fn write_checkpoint(&mut self) -> Result<(), ObserveError> {
        let start = Instant::now();
        let Some(observers) = &mut self.observers else {
            return Ok(());
        };
        let Some(good) = self.last_good.as_mut().filter(|good| good.is_unwritten()) else {
            return Ok(());
        };
        observers.sync()?;
        self.costs.checkpoint_size = good.write(&self.folder, self.scene_hash)?;
        let Place {
            is_settling,
            time,
            steps,
        } = good.place;
        let written = Written {
            is_settling,
            time,
            steps,
            size: self.costs.checkpoint_size,
        };
        let wall = start.elapsed().as_secs_f64();
        self.last_checkpoint = Instant::now();
        self.costs.n_checkpoints += 1;
        self.costs.checkpoints += wall;
        self.reserve.add_checkpoint(wall);
        self.status.checkpoint = Some(written);
        self.notices.push(Event::Checkpoint(written));
        Ok(())
    }

    /// Returns to the last good state with a shorter step; the error where that is in vain.
    fn fall_back(&mut self, error: StepError) -> Result<Event, RunError> {
        if !error.is_of_the_step() {
            return Err(error.into());
        }
        let Some(good) = self.last_good.take() else {
            return Err(error.into());
        };
        let (to, reduction) = (good.place.time, self.counters.reduction);
        let Some(next) = reduction.after(self.place().time, to) else {
            self.last_good = Some(good);
            return Err(RunError::Unstable {
                error,
                good: to,
                share: reduction.share(to),
            });
        };
        // what it cost stays spent
        let costs = self.costs;
        let read = self.read(&good.state);
        self.last_good = Some(good);
        read?;
        self.costs = costs;
        self.counters.reduction = next;
        Ok(Event::FellBack {
            error,
            to,
            share: next.share(to),
        })
    }

    /// Appends the state of the run to a byte buffer.
    fn save(&self, out: Vec<u8>) -> Saved {
        let Some(observers) = &self.observers else {
            return self.save_bare(out);
        };
        let costs = Costs {
            before: self.wall_time(),
            ..self.costs
        };
        let out = postcard::to_extend(&(&self.counters, costs), out)?;
        let out = self.world.save(out)?;
        observers.save(out)
    }

    /// Restores a saved state.
    fn read(&mut self, state: &[u8]) -> Result<(), RunError> {
        let Some(observers) = &mut self.observers else {
            return self.go_back(state);
        };
        let rest;
        ((self.counters, self.costs), rest) = postcard::take_from_bytes(state)?;
        let rest = self.world.read(rest)?;
        let rest = observers.read(rest)?;
        match rest.is_empty() {
            true => Ok(()),
            false => Err(postcard::Error::DeserializeBadEncoding.into()),
        }
    }

    /// Wall time of the run, earlier starts of the program included; s.
    fn wall_time(&self) -> f64 {
        self.costs.before + self.started.elapsed().as_secs_f64()
    }

    /// Writes the overview and the summary; the checkpoint, and of an incomplete run the last state, too.
    ///
    /// # Errors
    ///
    /// The failure that ended the run, or of a file that cannot be written.
    pub fn finish(
        mut self,
        ending: Result<Ending, RunError>,
    ) -> Result<(Summary, Ending), RunError> {
        let completed = matches!(ending, Ok(Ending::Completed));
        let kept = if completed {
            // from here the run may be taken further
            let kept = self.write_checkpoint().map_err(RunError::from);
            // a leftover file of a completed run is harmless
            let _ = checkpoint::remove_previous(&self.folder);
            kept
        } else {
            // before anything else is written, which the checkpoint does not know of
            let kept = self.keep_progress(&ending);
            let kept = kept.and(self.write_checkpoint().map_err(RunError::from));
            if let Some(observers) = &mut self.observers {
                observers.observe_last(&self.world);
            }
            kept
        };
        let ending = ending.map_err(|failure| self.with_evidence(failure));
        let summary = self.summary(&ending);
        let subtitle = summary::subtitle(&summary);
        let written = match &mut self.observers {
            None => Ok(()),
            Some(observers) => {
                let drawn = observers.finish(&self.folder, &self.world, subtitle);
                // the summary is written even if the picture fails
                summary.write(&self.folder).and(drawn)
            }
        };
        self.write_progress(Some(&ending));
        let ending = ending?;
        kept?;
        written?;
        Ok((summary, ending))
    }
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;
    use crate::files::table::read_table;
    use crate::scene::parse;
    use riprap_sph::{Fluid, Vec3};

    /// Still water in a box; no settling.
    const BOX: &str = r#"(
        title: "Box",
        domain: (min: (-0.3, 0, -0.3), max: (0.9, 0.1, 0.9), dimensions: Two),
        materials: [(name: "rock", density: 2400, friction_angle_deg: 30)],
        blocks: [
            (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, -0.3), max: (0.9, 0.1, 0))),
            (name: "left", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, 0), max: (0, 0.1, 0.9))),
            (name: "right", material: "rock", motion: Fixed, shape: Box(min: (0.6, 0, 0), max: (0.9, 0.1, 0.9))),
        ],
        fluid: (dynamic_viscosity: 0.001, resolution: Spacing(0.05), regions: [
            (name: "water", shape: Box(min: (0, 0, 0), max: (0.6, 0.1, 0.4))),
        ]),
        gauges: [Pressure(name: "p", position: (0.3, 0.05, 0.1))],
        time: (duration: 0.8),
        output: (gauge_interval: 0.001),
    )"#;

    fn scene() -> Scene {
        Scene::resolve(parse::read(BOX).unwrap(), Path::new(".")).unwrap()
    }

    fn plan(folder: &Path) -> Plan<'_> {
        Plan {
            checkpoint_interval: Duration::MAX,
            ..Plan::new(folder)
        }
    }

    /// Runs for 60 steps, does something to the fluid, and on to the end; what was told of it, and the summary.
    fn hit(blow: impl Fn(&mut Fluid)) -> (Vec<String>, Summary, Vec<f64>) {
        let (mut scene, folder) = (scene(), tempfile::tempdir().unwrap());
        let mut run = Run::start(&mut scene, plan(folder.path())).unwrap();
        let (stop, mut told) = (AtomicBool::new(false), Vec::new());
        let mut tell = |event: Event| match event {
            Event::Step(progress) if progress.steps == 60 => stop.store(true, Ordering::Relaxed),
            Event::Step(_) | Event::Frame { .. } | Event::Checkpoint(_) | Event::Settled(_) => {}
            Event::FellBack { error, .. } => told.push(error.to_string()),
        };
        assert_eq!(run.until(&stop, &mut tell).unwrap(), Ending::Interrupted);
        blow(&mut run.world.water.as_mut().unwrap().fluid);
        let stop = AtomicBool::new(false);
        let ending = run.until(&stop, &mut tell);
        let (summary, ending) = run.finish(ending).unwrap();
        assert_eq!(ending, Ending::Completed);
        let gauges = read_table(&folder.path().join(run_folder::GAUGES)).unwrap();
        (told, summary, gauges.column("time").unwrap().to_vec())
    }

    #[test]
    fn what_hits_a_run_once_is_undone() {
        let faster = |factor: f64| {
            move |fluid: &mut Fluid| {
                let speed = factor * fluid.settings().sound_speed;
                fluid.set_velocity(7, Vec3::new(speed, 0.0, 0.0));
            }
        };
        let (told, whole, times) = hit(|_| {});
        assert!(told.is_empty() && whole.fell_back == 0);
        // the water is sorted in this step, after which a particle that is nowhere has no neighbors, and a density
        for (factor, expected) in [
            (f64::NAN, "velocity of particle 0 is NaN"),
            (1.5, "and sound at"),
        ] {
            let (told, summary, times_of_hit) = hit(faster(factor));
            assert!(told.len() == 1 && told[0].contains(expected), "{told:?}");
            assert_eq!(summary.fell_back, 1);
            // rows of the steps that were undone are gone, and none is missing
            assert!(times_of_hit.is_sorted_by(|a, b| a < b));
            let longest = |t: &[f64]| t.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
            assert!(longest(&times_of_hit) < 1.1 * longest(&times));
            // half the step for a while, and the whole step then
            assert!(whole.steps < summary.steps && summary.steps < whole.steps + 250);
            assert!(summary.energy.residual.abs() < 1e-3 * summary.energy.internal);
        }
    }

    #[test]
    fn a_run_stopped_on_a_row_holds_it_once() {
        // every step has a row of each table, and a frame
        let text = BOX.replace(
            "gauge_interval: 0.001",
            "gauge_interval: 1e-9, ledger_interval: 1e-9, frame_interval: 1e-9",
        );
        let mut scene = Scene::resolve(parse::read(&text).unwrap(), Path::new(".")).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let mut run = Run::start(&mut scene, plan(folder.path())).unwrap();
        let stop = AtomicBool::new(false);
        let ending = run.until(&stop, &mut |event| {
            if let Event::Step(Progress { steps: 5, .. }) = event {
                stop.store(true, Ordering::Relaxed);
            }
        });
        let (_, ending) = run.finish(ending).unwrap();
        assert_eq!(ending, Ending::Interrupted);
        for file in [run_folder::GAUGES, run_folder::ENERGY] {
            let table = read_table(&folder.path().join(file)).unwrap();
            let times = table.column("time").unwrap();
            assert!(
                times.len() == 6 && times.is_sorted_by(|a, b| a < b),
                "{file}: {times:?}"
            );
        }
        assert!(!folder.path().join(run_folder::frame("water", 6)).exists());
    }

    /// Jobs of seven steps, each resumed where the one before it stopped.
    #[test]
    fn jobs_shorter_than_the_interval_of_states_get_on() {
        let whole = {
            let mut scene = scene();
            let mut run = Run::in_memory(&mut scene).unwrap();
            (0..21).for_each(|_| drop(run.step().unwrap()));
            run.world.state_hash()
        };
        let folder = tempfile::tempdir().unwrap();
        let mut hash = String::new();
        for job in 1..=3 {
            let from = checkpoint::newest(folder.path(), &Default::default()).unwrap();
            let mut scene = scene();
            let plan = Plan {
                from: from.map(|(checkpoint, _)| checkpoint),
                ..plan(folder.path())
            };
            let mut run = Run::start(&mut scene, plan).unwrap();
            let stop = AtomicBool::new(false);
            let ending = run.until(&stop, &mut |event| match event {
                Event::Step(progress) if progress.steps == 7 * job => {
                    stop.store(true, Ordering::Relaxed);
                }
                _ => {}
            });
            let (summary, ending) = run.finish(ending).unwrap();
            assert_eq!(ending, Ending::Interrupted);
            assert_eq!((summary.steps, summary.resumed), (7 * job, job - 1));
            hash = summary.state_hash;
        }
        assert_eq!(hash, whole);
    }

    #[test]
    fn energy_from_nowhere_is_noticed_within_ten_steps() {
        // all of the water at once, slower than sound and not against a wall
        let (told, summary, _) = hit(|fluid| {
            let speed = 0.3 * fluid.settings().sound_speed;
            for a in 0..fluid.particles().len() {
                fluid.set_velocity(a, Vec3::new(0.0, 0.0, speed));
            }
        });
        assert!(
            told.len() == 1 && told[0].contains("J in 10 steps without a source"),
            "{told:?}"
        );
        assert_eq!(summary.fell_back, 1);
    }
}
