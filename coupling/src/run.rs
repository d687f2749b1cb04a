//! The loop: steps until the end, observers when due, and an orderly end whatever happens.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use riprap_dda::{Blocks, Motion};
use riprap_sph::{Fluid, Precision};

use crate::joints::JointWater;
use crate::observe::forces::Forces;
use crate::observe::frames::Frames;
use crate::observe::gauges::Gauges;
use crate::observe::ledgers::Ledgers;
use crate::observe::pictures::Pictures;
use crate::observe::trajectories::Trajectories;
use crate::observe::{ObserveError, Observer};
use crate::packing::packed;
use crate::scene::resolve::{Scene, vec3};
use crate::summary::{Summary, TimeByPhase, peak_memory};
use crate::time_step::{CAUSES, Cause};
use crate::walls::Walls;
use crate::world::{StepError, WaterAtStart, World};

/// The commit that the program was built from, where known.
pub const COMMIT: &str = match option_env!("RIPRAP_COMMIT") {
    Some(commit) => commit,
    None => "unknown",
};

/// Damping rate of settling times its duration: what moves at first is damped by `e⁻²⁰` at the end.
const SETTLING_DECAY: f64 = 20.0;
/// Share of settling, at its end, that runs without damping, so that what damping hid shows.
const UNDAMPED_SHARE: f64 = 0.1;

/// What ends a run early.
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
    /// A file could not be written; what was written before stays valid.
    #[error("{0}")]
    Observe(#[from] ObserveError),
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
            })
        }
    };
    let domain = (vec3(scene.file.domain.min), vec3(scene.file.domain.max));
    let mut world = World::new(blocks, fluid, vec3(scene.file.gravity), domain)?;
    world.set_leaving(scene.file.domain.leaving);
    Ok(world)
}

/// Runs a scene into `folder`, which exists and is empty; `stop` ends it after the current step.
///
/// `report` hears of every step. The summary is written whatever happens.
///
/// # Errors
///
/// [`RunError`]; everything computed before is in the folder.
pub fn run(
    scene: &Scene,
    folder: &Path,
    stop: &AtomicBool,
    report: &mut dyn FnMut(&Progress),
) -> Result<(Summary, Ending), RunError> {
    let mut run = Run::start(scene, folder)?;
    let ending = run.settle(stop, report).and_then(|ending| match ending {
        Ending::Completed => run.go(stop, report),
        Ending::Interrupted => Ok(ending),
    });
    run.finish(ending)
}

/// A run under way.
struct Run<'a> {
    scene: &'a Scene,
    folder: PathBuf,
    world: World,
    observers: Observers,
    started: Instant,
    settling_wall_time: f64,
    output_time: f64,
    dt_min: f64,
    dt_max: f64,
    governed: BTreeMap<Cause, u64>,
    particles_at_start: usize,
    mass_at_start: f64,
}

struct Observers {
    frames: Frames,
    gauges: Gauges,
    ledgers: Ledgers,
    /// Absent when the scene does not ask for them.
    forces: Option<Forces>,
    trajectories: Option<Trajectories>,
    pictures: Pictures,
}

impl<'a> Run<'a> {
    fn start(scene: &'a Scene, folder: &Path) -> Result<Self, RunError> {
        let mut world = build(scene)?;
        let output = &scene.file.output;
        let observers = Observers {
            frames: Frames::new(folder, output, &world)?,
            gauges: Gauges::new(folder, scene, &world)?,
            ledgers: Ledgers::new(
                folder,
                output.ledger_interval.unwrap_or(f64::INFINITY),
                &world,
            )?,
            forces: match &scene.file.forces {
                None => None,
                Some(asked) => {
                    let chosen = asked.chosen(scene, &world);
                    world.keep_accounts(&chosen);
                    Some(Forces::new(folder, asked, (&chosen, &world))?)
                }
            },
            trajectories: match &scene.file.trajectories {
                None => None,
                Some(asked) => Some(Trajectories::new(folder, asked, scene, &world)?),
            },
            pictures: Pictures::new(scene),
        };
        Ok(Self {
            scene,
            folder: folder.to_path_buf(),
            particles_at_start: world
                .water
                .as_ref()
                .map_or(0, |w| w.fluid.particles().len()),
            mass_at_start: world.water.as_ref().map_or(0.0, |w| w.fluid.mass()),
            world,
            observers,
            started: Instant::now(),
            settling_wall_time: 0.0,
            output_time: 0.0,
            dt_min: f64::INFINITY,
            dt_max: 0.0,
            governed: BTreeMap::new(),
        })
    }

    /// Lets the water come to rest before t = 0.
    fn settle(
        &mut self,
        stop: &AtomicBool,
        report: &mut dyn FnMut(&Progress),
    ) -> Result<Ending, RunError> {
        let end = self.scene.file.time.settle;
        let rate = SETTLING_DECAY / end;
        let (mut time, mut steps) = (0.0, 0);
        if self.world.water.is_some() {
            while time < end {
                if stop.load(Ordering::Relaxed) {
                    return Ok(Ending::Interrupted);
                }
                let dt = self.world.next_step(self.scene.file.time.duration)?.dt;
                let rate = if time < (1.0 - UNDAMPED_SHARE) * end {
                    rate
                } else {
                    0.0
                };
                self.world.settle_step(dt, rate)?;
                time += dt;
                steps += 1;
                report(&Progress {
                    is_settling: true,
                    time,
                    end,
                    steps,
                    ..self.progress(dt)
                });
            }
            if steps > 0 {
                self.world.release()?;
            }
        }
        self.settling_wall_time = self.started.elapsed().as_secs_f64();
        Ok(Ending::Completed)
    }

    /// Steps from 0 to the duration.
    fn go(
        &mut self,
        stop: &AtomicBool,
        report: &mut dyn FnMut(&Progress),
    ) -> Result<Ending, RunError> {
        let end = self.scene.file.time.duration;
        self.observe()?;
        while self.world.time() < end {
            if stop.load(Ordering::Relaxed) {
                return Ok(Ending::Interrupted);
            }
            let step = self.world.next_step(end)?;
            self.world.step(step)?;
            self.dt_min = self.dt_min.min(step.dt);
            self.dt_max = self.dt_max.max(step.dt);
            *self.governed.entry(step.cause).or_default() += 1;
            self.observe()?;
            report(&self.progress(step.dt));
        }
        Ok(Ending::Completed)
    }

    fn observe(&mut self) -> Result<(), ObserveError> {
        let start = Instant::now();
        let Observers {
            frames,
            gauges,
            ledgers,
            forces,
            trajectories,
            pictures,
        } = &mut self.observers;
        let world = &self.world;
        if gauges.is_due(world) {
            gauges.observe(world)?;
            pictures.note_gauges(gauges.last_row());
        }
        if ledgers.is_due(world) {
            ledgers.observe(world)?;
            pictures.note_energy(world);
        }
        if let Some(forces) = forces
            && forces.is_due(world)
        {
            forces.observe(world)?;
        }
        if let Some(trajectories) = trajectories
            && trajectories.is_due(world)
        {
            trajectories.observe(world)?;
        }
        pictures.note_view(world);
        if frames.is_due(world) {
            frames.observe(world)?;
        }
        self.output_time += start.elapsed().as_secs_f64();
        Ok(())
    }

    fn progress(&self, dt: f64) -> Progress {
        let world = &self.world;
        let blocks = &world.blocks;
        let fastest_block = (0..blocks.n_blocks())
            .filter(|&b| blocks.is_free(b))
            .map(|b| blocks.velocity(b).norm())
            .fold(0.0, f64::max);
        let fastest_particle = world.water.as_ref().map_or(0.0, |w| w.fluid.max_speed());
        Progress {
            is_settling: false,
            steps: world.clock().steps,
            time: world.time(),
            end: self.scene.file.time.duration,
            dt,
            contacts: blocks.n_contacts(),
            fastest: fastest_block.max(fastest_particle),
        }
    }

    /// Writes the last state of a run that ended early, the overview and the summary.
    fn finish(mut self, ending: Result<Ending, RunError>) -> Result<(Summary, Ending), RunError> {
        let completed = matches!(ending, Ok(Ending::Completed));
        if !completed {
            // the run ends with its own error; that the last frame could not be written either
            // must not hide it
            let _ = self.observers.frames.observe(&self.world);
            let _ = self.observers.gauges.observe(&self.world);
            let _ = self.observers.ledgers.observe(&self.world);
        }
        let stop_reason = match &ending {
            Ok(Ending::Completed) => "completed".to_owned(),
            Ok(Ending::Interrupted) => "interrupted".to_owned(),
            Err(error) => error.to_string(),
        };
        let summary = self.summary(completed, stop_reason);
        let subtitle = subtitle(&summary);
        let Observers {
            trajectories,
            pictures,
            ..
        } = &mut self.observers;
        let followed = match trajectories {
            None => Ok(()),
            Some(trajectories) => {
                let finished = trajectories.finish(&self.world);
                pictures.note_trajectories(trajectories);
                finished
            }
        };
        let written = pictures
            .write(&self.folder, &self.world, subtitle)
            .and_then(|_| summary.write(&self.folder))
            .and(followed);
        let ending = ending?;
        written?;
        Ok((summary, ending))
    }

    fn summary(&self, completed: bool, stop_reason: String) -> Summary {
        let world = &self.world;
        let (clock, extremes, blocks) = (world.clock(), world.extremes(), &world.blocks);
        let wall_time = self.started.elapsed().as_secs_f64();
        let running = (wall_time - self.settling_wall_time).max(1e-9);
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
            settling_wall_time: self.settling_wall_time,
            steps: clock.steps,
            block_substeps: clock.block_substeps,
            fluid_particles: self.particles_at_start,
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
            pair_interactions: extremes.pair_interactions,
            contact_updates: blocks.contact_updates(),
            pair_interactions_per_second: extremes.pair_interactions as f64 / running,
            contact_updates_per_second: blocks.contact_updates() as f64 / running,
            time_by_phase: self.time_by_phase(),
            dt_min: if self.dt_min.is_finite() {
                self.dt_min
            } else {
                0.0
            },
            dt_max: self.dt_max,
            dt_governed_by: CAUSES
                .iter()
                .map(|cause| {
                    (
                        *cause,
                        self.governed.get(cause).copied().unwrap_or(0) as f64 / steps,
                    )
                })
                .collect(),
            max_mach: extremes.max_mach,
            density_error_rms: world
                .water
                .as_ref()
                .map_or(0.0, |w| w.fluid.density_error_rms()),
            particles_escaped: world.water.as_ref().map_or(0, |w| w.fluid.removed().count),
            mass_escaped: world.water.as_ref().map_or(0.0, |w| w.fluid.removed().mass),
            fluid_mass: [
                self.mass_at_start,
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
            output: self.output_time,
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
