//! The loop: steps until the end, observers when due, and an orderly end whatever happens.
//!
//! Every so many steps the state is kept. A step that goes wrong takes the run back there, and on with half the step for a
//! while; where that does not help the run ends, with what was kept on disk. What is kept goes to disk now and then anyway,
//! and when the run is stopped: it goes on from there to the same bits.

mod caution;
pub mod notice;
mod observers;
mod packing;
mod watch;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use riprap_dda::{Blocks, Motion};
use riprap_sph::{Fluid, Precision};
use serde::{Deserialize, Serialize};

use crate::build_info::COMMIT;
use crate::files::table::Start;
use crate::joints::JointWater;
use crate::output::checkpoint_file::{self as checkpoint, Checkpoint, Header};
use crate::output::observe::{ObserveError, Observer};
use crate::output::summary::{Summary, TimeByPhase, peak_memory};
use crate::run::packing::packed;
use crate::saved::Saved;
use crate::scene::file::TimeFile;
use crate::scene::resolve::{Scene, vec3};
use crate::walls::Walls;
use crate::world::time_step::{CAUSES, Cause};
use crate::world::{StepError, WaterAtStart, World};
use caution::Caution;
use observers::Observers;
use watch::Watch;

/// Damping rate of settling times its duration: what moves at first is damped by `e⁻²⁰` at the end.
const SETTLING_DECAY: f64 = 20.0;
/// Share of settling, at its end, that runs without damping, so that what damping hid shows.
const UNDAMPED_SHARE: f64 = 0.1;

/// Steps from one state that is kept to the next: so that keeping it takes less than a hundredth of the time. Of blocks by
/// themselves a step takes little longer than keeping the state does.
const GOOD_INTERVAL_WITH_WATER: u64 = 100;
const GOOD_INTERVAL_OF_BLOCKS: u64 = 1000;

/// Failure of a run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The world could not be built.
    #[error("cannot build the blocks: {0}")]
    Blocks(#[from] riprap_dda::BlockError),
    /// The fluid could not be built.
    #[error("cannot build the fluid: {0}")]
    Fluid(#[from] riprap_sph::FluidError),
    /// A step failed; the last state is in the run folder.
    #[error("{0}")]
    Step(#[from] StepError),
    /// A step failed, and did so again from the last good state with shorter steps.
    #[error(
        "{error}\nit recurred from the last good state, t = {good:.6} s, with {share} of the usual step, so the step is not the cause; the checkpoint is of that state"
    )]
    Unstable {
        /// Error of the step.
        error: StepError,
        /// s.
        good: f64,
        /// Of the step that was tried last.
        share: f64,
    },
    /// A file could not be written; what was written before stays valid.
    #[error("{0}")]
    Observe(#[from] ObserveError),
    /// The state of a checkpoint is not of this scene.
    #[error("the state of the checkpoint does not fit the scene: {0}; start over with --force")]
    State(#[from] postcard::Error),
}

/// Where a run is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Whether the water is still settling.
    pub is_settling: bool,
    /// Steps since the start of this stage.
    pub steps: u64,
    /// s.
    pub time: f64,
    /// End of this stage; s.
    pub end: f64,
    /// Last step; s.
    pub dt: f64,
    /// Contact points between blocks.
    pub contacts: usize,
    /// Fastest particle or block; m/s.
    pub fastest: f64,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It reached its duration.
    Completed,
    /// It was asked to stop.
    Interrupted,
}

/// Builds the world of a scene.
///
/// # Errors
///
/// [`RunError`] when blocks or fluid refuse their settings.
pub fn build(scene: &Scene) -> Result<World, RunError> {
    let mut blocks = Blocks::with_joints(
        scene.blocks.clone(),
        scene.materials.clone(),
        &scene.joints,
        scene.block_settings,
    )?;
    for (block, hold) in &scene.holds {
        blocks.hold(*block, hold.clone())?;
    }
    blocks.attach(&scene.attachments)?;
    let fluid = match &scene.fluid {
        None => None,
        Some(water) => {
            let (start, kept) = packed(water, &scene.blocks, &blocks)?;
            let mut fluid = Fluid::new(start, water.settings.clone())?;
            if !water.rheologies.is_empty() {
                let kinds: Vec<_> = kept.iter().map(|&a| water.kinds[a as usize]).collect();
                fluid.set_rheologies(water.rheologies.clone(), &kinds)?;
            }
            let walls = Walls::new(
                water.wall_method,
                &scene.blocks,
                &blocks,
                &fluid,
                water.slip,
            );
            let is_sealed = |b: usize| scene.file.blocks[b].sealed;
            let joints = JointWater::new(&scene.blocks, &blocks, &fluid, is_sealed);
            Some(WaterAtStart {
                fluid,
                joints,
                penalty: water.walls,
                walls,
                openings: water.openings.clone(),
                absorbers: water.absorbers.clone(),
                sleeping: water.sleeping,
            })
        }
    };
    let domain = (vec3(scene.file.domain.min), vec3(scene.file.domain.max));
    let mut world = World::new(blocks, fluid, vec3(scene.file.gravity), domain)?;
    world.set_out_of_domain(scene.file.domain.leaving.into());
    world.set_weakenings(scene.weakenings.clone());
    Ok(world)
}

/// How a run is to be done.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// The run folder, which exists.
    pub folder: &'a Path,
    /// Where to go on from; the folder then holds the files of the run.
    pub from: Option<Checkpoint>,
    /// Hash of the scene as it is written in the folder, see [`checkpoint::scene_hash`].
    pub scene_hash: [u8; 32],
    /// Wall time from one checkpoint to the next.
    pub checkpoint_interval: Duration,
}

/// Progress event of a run.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// A step was taken.
    Step(&'a Progress),
    /// A step went wrong.
    FellBack {
        /// Error of the step.
        error: &'a StepError,
        /// Where the run goes on from; s.
        to: f64,
        /// Share of the usual step.
        share: f64,
    },
}

/// Runs a scene; `stop` ends it after the current step.
///
/// `tell` hears of every step. The summary is written whatever happens. A run that does not reach its end leaves a
/// checkpoint of its last good state.
///
/// # Errors
///
/// [`RunError`]; everything computed before is in the folder.
pub fn run(
    scene: &Scene,
    plan: Plan,
    stop: &AtomicBool,
    tell: &mut dyn FnMut(Event),
) -> Result<(Summary, Ending), RunError> {
    let mut run = Run::start(scene, plan)?;
    let ending = run.go(stop, tell);
    run.finish(ending)
}

/// Where a run is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Stage {
    /// The water comes to rest before t = 0.
    Settling {
        /// s.
        time: f64,
        steps: u64,
    },
    Running,
}

/// Counters of a run, preserved when it is stopped and resumed.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Tally {
    stage: Stage,
    dt_min: f64,
    dt_max: f64,
    governed: BTreeMap<Cause, u64>,
    particles_at_start: usize,
    mass_at_start: f64,
    watch: Watch,
    caution: Caution,
}

/// Wall times and counts of what was done, whether it was good or not; s.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Costs {
    /// Before this start of the program.
    before: f64,
    settling: f64,
    output: f64,
    guards: f64,
    checkpoints: f64,
    n_checkpoints: u64,
    checkpoint_size: u64,
    n_resumed: u64,
}

/// The last good state.
#[derive(Debug)]
struct Good {
    state: Vec<u8>,
    is_settling: bool,
    /// Of the stage; s.
    time: f64,
    steps: u64,
    is_on_disk: bool,
}

/// A run under way.
struct Run<'a> {
    scene: &'a Scene,
    folder: PathBuf,
    /// Hash of the scene as it is written.
    scene_hash: [u8; 32],
    world: World,
    observers: Observers,
    tally: Tally,
    costs: Costs,
    good: Option<Good>,
    started: Instant,
    checkpoint_interval: Duration,
    last_checkpoint: Instant,
}

impl<'a> Run<'a> {
    fn start(scene: &'a Scene, plan: Plan) -> Result<Self, RunError> {
        let mut world = build(scene)?;
        let begin = match plan.from {
            None => Start::Anew,
            Some(_) => Start::Again,
        };
        let observers = Observers::new(scene, plan.folder, &mut world, begin)?;
        let fluid = world.water.as_ref().map(|water| &water.fluid);
        let settles = fluid.is_some() && 0.0 < scene.file.time.settle;
        let mut run = Self {
            scene,
            folder: plan.folder.to_path_buf(),
            scene_hash: plan.scene_hash,
            tally: Tally {
                stage: match settles {
                    true => Stage::Settling {
                        time: 0.0,
                        steps: 0,
                    },
                    false => Stage::Running,
                },
                dt_min: f64::INFINITY,
                dt_max: 0.0,
                governed: BTreeMap::new(),
                particles_at_start: fluid.map_or(0, |f| f.particles().len()),
                mass_at_start: fluid.map_or(0.0, Fluid::mass),
                watch: Watch::default(),
                caution: Caution::default(),
            },
            world,
            observers,
            costs: Costs::default(),
            good: None,
            started: Instant::now(),
            checkpoint_interval: plan.checkpoint_interval,
            last_checkpoint: Instant::now(),
        };
        match plan.from {
            None if !settles => run.begin()?,
            None => {}
            Some(checkpoint) => {
                run.read(&checkpoint.state)?;
                run.costs.n_resumed += 1;
            }
        }
        Ok(run)
    }

    /// Takes steps until the end.
    fn go(&mut self, stop: &AtomicBool, tell: &mut dyn FnMut(Event)) -> Result<Ending, RunError> {
        let end = self.scene.file.time.duration;
        while self.is_settling() || self.world.time() < end {
            if stop.load(Ordering::Relaxed) {
                return Ok(Ending::Interrupted);
            }
            if self.is_good_due() {
                self.keep_good()?;
            }
            match self.take_step() {
                Ok(dt) => tell(Event::Step(&self.progress(dt))),
                Err(RunError::Step(error)) => self.fall_back(error, tell)?,
                Err(error) => return Err(error),
            }
        }
        Ok(Ending::Completed)
    }

    /// A step of whichever stage it is; returns its size, s.
    fn take_step(&mut self) -> Result<f64, RunError> {
        let TimeFile {
            duration, settle, ..
        } = self.scene.file.time;
        let share = self.tally.caution.share(self.place().0);
        let step = self.world.next_step_within(duration, share)?;
        match &mut self.tally.stage {
            Stage::Settling { time, steps } => {
                let is_damped = *time < (1.0 - UNDAMPED_SHARE) * settle;
                let rate = if is_damped {
                    SETTLING_DECAY / settle
                } else {
                    0.0
                };
                self.world.settle_step(step.dt, rate)?;
                *time += step.dt;
                *steps += 1;
                if settle <= *time {
                    self.world.release()?;
                    self.costs.settling = self.wall_time();
                    self.begin()?;
                }
            }
            Stage::Running => {
                self.world.step(step)?;
                let tally = &mut self.tally;
                tally.dt_min = tally.dt_min.min(step.dt);
                tally.dt_max = tally.dt_max.max(step.dt);
                *tally.governed.entry(step.cause).or_default() += 1;
                self.look()?;
                self.observe()?;
            }
        }
        Ok(step.dt)
    }

    /// t = 0.
    fn begin(&mut self) -> Result<(), RunError> {
        self.tally.stage = Stage::Running;
        self.tally.watch = Watch::of(&self.world);
        self.tally.caution = Caution::default();
        Ok(self.observe()?)
    }

    /// Looks now and then for what no single step shows.
    fn look(&mut self) -> Result<(), StepError> {
        if !Watch::is_due(&self.world) {
            return Ok(());
        }
        let start = Instant::now();
        let seen = self.tally.watch.look(&self.world);
        self.costs.guards += start.elapsed().as_secs_f64();
        seen
    }

    fn observe(&mut self) -> Result<(), ObserveError> {
        let start = Instant::now();
        let observed = self.observers.observe(&self.world);
        self.costs.output += start.elapsed().as_secs_f64();
        observed
    }

    fn is_settling(&self) -> bool {
        self.tally.stage != Stage::Running
    }

    /// Time (s) and steps of the stage.
    fn place(&self) -> (f64, u64) {
        match self.tally.stage {
            Stage::Settling { time, steps } => (time, steps),
            Stage::Running => (self.world.time(), self.world.clock().steps),
        }
    }

    /// Whether the state is to be kept now. By the number of steps, so that a run that was stopped keeps the same ones.
    fn is_good_due(&self) -> bool {
        let (time, steps) = self.place();
        let interval = match self.world.water {
            Some(_) => GOOD_INTERVAL_WITH_WATER,
            None => GOOD_INTERVAL_OF_BLOCKS,
        };
        let is_known = self
            .good
            .as_ref()
            .is_some_and(|good| (good.is_settling, good.steps) == (self.is_settling(), steps));
        steps.is_multiple_of(interval) && !is_known && !self.tally.caution.is_on(time)
    }

    fn keep_good(&mut self) -> Result<(), RunError> {
        let start = Instant::now();
        self.tally.caution.rest();
        let mut state = self.good.take().map_or_else(Vec::new, |good| good.state);
        state.clear();
        let (time, steps) = self.place();
        self.good = Some(Good {
            state: self.save(state)?,
            is_settling: self.is_settling(),
            time,
            steps,
            is_on_disk: false,
        });
        self.costs.guards += start.elapsed().as_secs_f64();
        if self.checkpoint_interval <= self.last_checkpoint.elapsed() {
            self.write_checkpoint()?;
        }
        Ok(())
    }

    /// Writes the last good state to disk, if it is not there.
    fn write_checkpoint(&mut self) -> Result<(), ObserveError> {
        let start = Instant::now();
        let Some(good) = self.good.as_mut().filter(|good| !good.is_on_disk) else {
            return Ok(());
        };
        self.observers.sync()?;
        let header = Header {
            build: checkpoint::build(),
            scene: self.scene_hash,
            is_settling: good.is_settling,
            time: good.time,
            steps: good.steps,
        };
        self.costs.checkpoint_size = checkpoint::write(&self.folder, &header, &good.state)?;
        good.is_on_disk = true;
        self.last_checkpoint = Instant::now();
        self.costs.n_checkpoints += 1;
        self.costs.checkpoints += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Back to the last good state, to go on with shorter steps; the error where that was in vain.
    fn fall_back(&mut self, error: StepError, tell: &mut dyn FnMut(Event)) -> Result<(), RunError> {
        let Some(good) = self.good.take().filter(|_| error.is_of_the_step()) else {
            return Err(error.into());
        };
        let (to, caution) = (good.time, self.tally.caution);
        let Some(next) = caution.after(self.place().0, to) else {
            self.good = Some(good);
            return Err(RunError::Unstable {
                error,
                good: to,
                share: caution.share(to),
            });
        };
        // what it cost stays spent
        let costs = self.costs;
        let read = self.read(&good.state);
        self.good = Some(good);
        read?;
        self.costs = costs;
        self.tally.caution = next;
        tell(Event::FellBack {
            error: &error,
            to,
            share: next.share(to),
        });
        Ok(())
    }

    /// Appends the state of the run to some bytes.
    fn save(&self, out: Vec<u8>) -> Saved {
        let costs = Costs {
            before: self.wall_time(),
            ..self.costs
        };
        let out = postcard::to_extend(&(&self.tally, costs), out)?;
        let out = self.world.save(out)?;
        self.observers.save(out)
    }

    /// Takes it over again.
    fn read(&mut self, state: &[u8]) -> Result<(), RunError> {
        let rest;
        ((self.tally, self.costs), rest) = postcard::take_from_bytes(state)?;
        let rest = self.world.read(rest)?;
        let rest = self.observers.read(rest)?;
        match rest.is_empty() {
            true => Ok(()),
            false => Err(postcard::Error::DeserializeBadEncoding.into()),
        }
    }

    /// Since the run began, whenever it was under way; s.
    fn wall_time(&self) -> f64 {
        self.costs.before + self.started.elapsed().as_secs_f64()
    }

    fn progress(&self, dt: f64) -> Progress {
        let world = &self.world;
        let blocks = &world.blocks;
        let fastest_block = (0..blocks.n_blocks())
            .filter(|&b| blocks.is_free(b))
            .map(|b| blocks.velocity(b).norm())
            .fold(0.0, f64::max);
        let fastest_particle = world.water.as_ref().map_or(0.0, |w| w.fluid.max_speed());
        let (time, steps) = self.place();
        let TimeFile {
            duration, settle, ..
        } = self.scene.file.time;
        Progress {
            is_settling: self.is_settling(),
            steps,
            time,
            end: if self.is_settling() { settle } else { duration },
            dt,
            contacts: blocks.n_contacts(),
            fastest: fastest_block.max(fastest_particle),
        }
    }

    /// Writes the last state of a run that ended early, the overview and the summary.
    fn finish(mut self, ending: Result<Ending, RunError>) -> Result<(Summary, Ending), RunError> {
        let completed = matches!(ending, Ok(Ending::Completed));
        let kept = if completed {
            // what is left of a run that is over does no harm
            let _ = checkpoint::remove(&self.folder);
            Ok(())
        } else {
            // before anything else is written, which the checkpoint does not know of
            let kept = self.write_checkpoint();
            // the run ends with its own error; that the last frame could not be written either
            // must not hide it
            let _ = self.observers.frames.observe_last(&self.world);
            let _ = self.observers.gauges.observe_last(&self.world);
            let _ = self.observers.ledgers.observe_last(&self.world);
            kept
        };
        let stop_reason = match &ending {
            Ok(Ending::Completed) => "completed".to_owned(),
            Ok(Ending::Interrupted) => "interrupted".to_owned(),
            Err(error) => error.to_string(),
        };
        let summary = self.summary(completed, stop_reason);
        let subtitle = subtitle(&summary);
        let drawn = self.observers.finish(&self.folder, &self.world, subtitle);
        // the figures come to disk even where the picture does not
        let written = summary.write(&self.folder).and(drawn);
        let ending = ending?;
        kept?;
        written?;
        Ok((summary, ending))
    }

    fn summary(&self, completed: bool, stop_reason: String) -> Summary {
        let world = &self.world;
        let (clock, extremes, blocks) = (world.clock(), world.extremes(), &world.blocks);
        let (tally, costs) = (&self.tally, &self.costs);
        let wall_time = self.wall_time();
        let running = (wall_time - costs.settling).max(1e-9);
        let count =
            |test: &dyn Fn(usize) -> bool| (0..blocks.n_blocks()).filter(|&b| test(b)).count();
        let steps = clock.steps.max(1) as f64;
        Summary {
            case: self.scene.file.title.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: COMMIT.to_owned(),
            threads: rayon::current_num_threads(),
            precision: precision(self.scene).to_owned(),
            stepping: format!("{:?}", world.stepping()),
            completed,
            stop_reason,
            simulated_time: world.time(),
            wall_time,
            settling_wall_time: costs.settling,
            steps: clock.steps,
            block_substeps: clock.block_substeps,
            fluid_particles: tally.particles_at_start,
            wall_particles: world
                .water
                .as_ref()
                .and_then(|w| w.walls.as_ref())
                .map_or(0, Walls::n_points),
            free_blocks: count(&|b| blocks.is_free(b)),
            fixed_blocks: count(&|b| world.is_fixed(b)),
            prescribed_blocks: count(&|b| matches!(blocks.motion(b), Motion::Prescribed(_))),
            particle_spacing: self
                .scene
                .fluid
                .as_ref()
                .map_or(0.0, |f| f.walls.particle_spacing),
            mean_neighbours: extremes.pair_interactions as f64
                / extremes.particle_steps.max(1) as f64,
            particle_steps_per_second: extremes.particle_steps as f64 / running,
            particle_steps: extremes.particle_steps,
            awake_share: extremes.particle_steps_awake as f64
                / extremes.particle_steps_of_all.max(1) as f64,
            pair_interactions: extremes.pair_interactions,
            contact_updates: blocks.contact_updates(),
            pair_interactions_per_second: extremes.pair_interactions as f64 / running,
            contact_updates_per_second: blocks.contact_updates() as f64 / running,
            time_by_phase: self.time_by_phase(),
            dt_min: if tally.dt_min.is_finite() {
                tally.dt_min
            } else {
                0.0
            },
            dt_max: tally.dt_max,
            dt_governed_by: CAUSES
                .iter()
                .map(|cause| {
                    (
                        *cause,
                        tally.governed.get(cause).copied().unwrap_or(0) as f64 / steps,
                    )
                })
                .collect(),
            fell_back: tally.caution.n_falls(),
            largest_unexplained_gain: tally.watch.largest_gain(),
            resumed: costs.n_resumed,
            checkpoints: costs.n_checkpoints,
            checkpoint_bytes: costs.checkpoint_size,
            max_mach: extremes.max_mach,
            density_error_rms: world
                .water
                .as_ref()
                .map_or(0.0, |w| w.fluid.density_error_rms()),
            particles_escaped: world.water.as_ref().map_or(0, |w| w.fluid.removed().count),
            mass_escaped: world.water.as_ref().map_or(0.0, |w| w.fluid.removed().mass),
            fluid_mass: [
                tally.mass_at_start,
                world.water.as_ref().map_or(0.0, |w| w.fluid.mass()),
            ],
            openings: world
                .water
                .as_ref()
                .map_or(Vec::new(), |w| w.openings.passed().to_vec()),
            particles_pushed_back: extremes.particles_pushed_back,
            blocks_escaped: extremes.blocks_removed,
            max_wall_penetration_over_spacing: extremes.max_wall_penetration_over_spacing,
            max_block_overlap_over_size: blocks.max_overlap_over_size(),
            momentum_residual: world.momentum_residual(),
            energy: world.energy(),
            state_hash: world.state_hash(),
            peak_memory: peak_memory(),
        }
    }

    fn time_by_phase(&self) -> TimeByPhase {
        let phases = self.world.phases();
        TimeByPhase {
            neighbours: phases.neighbors.as_secs_f64(),
            density: phases.density.as_secs_f64(),
            forces: phases.forces.as_secs_f64(),
            contact_detection: phases.broad_phase.as_secs_f64(),
            contact_forces: phases.contacts.as_secs_f64(),
            wall_search: phases.wall_search.as_secs_f64(),
            coupling: phases.coupling.as_secs_f64(),
            integration: phases.integration.as_secs_f64(),
            output: self.costs.output,
            guards: self.costs.guards,
            checkpoints: self.costs.checkpoints,
        }
    }
}

/// Width of the numbers in the fluid's sums; blocks are always in double precision.
fn precision(scene: &Scene) -> &'static str {
    match scene.fluid.as_ref().map(|f| f.settings.scheme.precision) {
        Some(Precision::Single) => "f32 pair sums",
        Some(Precision::Double) | None => "f64",
    }
}

fn subtitle(summary: &Summary) -> String {
    format!(
        "{} particles, {} free blocks, {} steps, {:.3} s simulated in {:.0} s, {}",
        summary.fluid_particles,
        summary.free_blocks,
        summary.steps,
        summary.simulated_time,
        summary.wall_time,
        summary.stop_reason,
    )
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;
    use crate::files::table::read_table;
    use crate::output::run_folder;
    use crate::scene::parse;
    use riprap_sph::Vec3;

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
            folder,
            from: None,
            scene_hash: [0; 32],
            checkpoint_interval: Duration::MAX,
        }
    }

    /// Runs for 150 steps, does something to the fluid, and on to the end; what was told of it, and the summary.
    fn hit(blow: impl Fn(&mut Fluid)) -> (Vec<String>, Summary, Vec<f64>) {
        let (scene, folder) = (scene(), tempfile::tempdir().unwrap());
        let mut run = Run::start(&scene, plan(folder.path())).unwrap();
        let (stop, mut told) = (AtomicBool::new(false), Vec::new());
        let mut tell = |event: Event| match event {
            Event::Step(progress) if progress.steps == 150 => stop.store(true, Ordering::Relaxed),
            Event::Step(_) => {}
            Event::FellBack { error, .. } => told.push(error.to_string()),
        };
        assert_eq!(run.go(&stop, &mut tell).unwrap(), Ending::Interrupted);
        blow(&mut run.world.water.as_mut().unwrap().fluid);
        let stop = AtomicBool::new(false);
        let ending = run.go(&stop, &mut tell);
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
        for (factor, expected) in [(f64::NAN, "non-finite density"), (1.5, "and sound at")] {
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
        let scene = Scene::resolve(parse::read(&text).unwrap(), Path::new(".")).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let mut run = Run::start(&scene, plan(folder.path())).unwrap();
        let stop = AtomicBool::new(false);
        let ending = run.go(&stop, &mut |event| {
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
            told.len() == 1 && told[0].contains("came from nowhere within 10 steps"),
            "{told:?}"
        );
        assert_eq!(summary.fell_back, 1);
    }
}
