//! Cost of a run, from its first steps.

use std::fmt;
use std::time::{Duration, Instant};

use riprap_dda::{BlockDefinition, Integrator, Motion};
use serde::Serialize;

use super::disk::Disk;
use crate::run::named::named;
use crate::run::{RunError, build};
use crate::scene::contact_dynamics;
use crate::scene::resolve::Scene;
use crate::world::World;
use crate::world::time_step::{BlockSteps, Cause, Limits, TimeStep};

/// Largest wall time of the timed probe.
const PROBE_TIME: Duration = Duration::from_secs(2);
/// Wall time of a run with moving walls over that predicted from its first steps, where everything is still close to rest and
/// lists of neighbors last: measured 1.57 in a flume with a piston.
const MOVING: f64 = 1.6;
/// Largest number of steps of the probe with water, where all are as long as the first and cost about as much.
const PROBE_STEPS: u32 = 50;

/// Step limits, steps, disk and wall time from a timed probe.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Cost {
    pub step: Step,
    /// With water those of a run whose steps all are as long as the first.
    pub steps: f64,
    pub disk: Disk,
    pub wall_time: WallTime,
    /// The same blocks by the other integrator; `null` with water, without free blocks, and where that has no model for them.
    pub otherwise: Option<Otherwise>,
}

/// Step and wall time by the integrator that the scene does not take.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Otherwise {
    /// Contact dynamics, or springs.
    pub is_contact_dynamics: bool,
    pub dt_s: f64,
    pub predicted_s: f64,
}

/// The first step and its limits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Step {
    pub dt_s: f64,
    /// The limit that governs it.
    pub limited_by: Cause,
    /// Steps of the blocks inside it, 1 where one spans several.
    pub block_substeps: u32,
    /// Step of the blocks.
    pub block_dt_s: f64,
    pub limits: Vec<Limit>,
    /// The block that sets the step of the contacts.
    pub set_by_block: Option<GoverningBlock>,
}

/// A limit of the step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Limit {
    pub cause: Cause,
    /// With its safety factor; `null`: no limit.
    pub dt_s: Option<f64>,
    /// Stability limit, where it is known.
    pub stable_to_s: Option<f64>,
}

/// The block that sets the step of the contacts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct GoverningBlock {
    pub name: String,
    pub volume_m3: f64,
    pub without_small: Option<WithoutSmall>,
}

/// A rock mass without its small blocks, which hold a hundredth of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct WithoutSmall {
    pub smallest_volume_m3: f64,
    pub blocks_left_out: usize,
    pub blocks: usize,
    pub share_of_rock: f64,
    /// The step over that with them.
    pub step_ratio: f64,
}

/// Predicted wall time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct WallTime {
    /// With all water awake.
    pub predicted_s: f64,
    /// With the initial sleep, where water may sleep.
    pub with_sleep_s: Option<f64>,
    /// Where bodies move water, which then costs more than in the first steps.
    pub up_to_s: Option<f64>,
    pub threads: usize,
    /// Steps that were timed.
    pub timed_steps: u32,
}

/// Cost of a run of a scene.
pub(super) fn cost(scene: &Scene) -> Result<Cost, RunError> {
    let mut world = build(scene)?;
    let first = world.next_step(scene.duration)?;
    let (block_substeps, block_dt_s) = match first.of_blocks {
        BlockSteps::Inside(n) => (n, first.dt / f64::from(n)),
        BlockSteps::Spanning(period) => (1, period),
    };
    let step = Step {
        dt_s: first.dt,
        limited_by: first.cause,
        block_substeps,
        block_dt_s,
        limits: step_limits(&world),
        set_by_block: governing_block(&world, scene),
    };
    let whole = predicted(&mut world, scene, first)?;
    drop(world);
    let (mut predicted_s, mut with_sleep_s) = (whole.wall_s, None);
    if scene.fluid.as_ref().is_some_and(|f| f.sleeping.is_some()) {
        let mut awake = scene.clone();
        if let Some(fluid) = &mut awake.fluid {
            fluid.sleeping = None;
        }
        with_sleep_s = Some(whole.wall_s);
        predicted_s = predicted(&mut build(&awake)?, &awake, first)?.wall_s;
    }
    let moves = |block: &BlockDefinition| !matches!(block.motion, Motion::Fixed);
    let is_moved = scene.fluid.is_some() && scene.blocks.iter().any(moves);
    Ok(Cost {
        step,
        steps: whole.steps,
        disk: Disk::of(scene),
        wall_time: WallTime {
            predicted_s,
            with_sleep_s,
            up_to_s: is_moved.then_some(MOVING * predicted_s),
            threads: rayon::current_num_threads(),
            timed_steps: whole.timed_steps,
        },
        otherwise: otherwise(scene),
    })
}

/// Cost by the other integrator, for blocks alone.
fn otherwise(scene: &Scene) -> Option<Otherwise> {
    let is_free = |block: &BlockDefinition| matches!(block.motion, Motion::Free);
    if scene.fluid.is_some() || !scene.blocks.iter().any(is_free) {
        return None;
    }
    let is_contact_dynamics = scene.block_settings.integrator == Integrator::CentralDifference;
    let mut other = scene.clone();
    other.block_settings.integrator = match is_contact_dynamics {
        true => contact_dynamics::suitable(&scene.blocks, &scene.gravity, scene.duration),
        false => Integrator::CentralDifference,
    };
    // not an error of this scene
    let mut world = build(&other).ok()?;
    let first = world.next_step(scene.duration).ok()?;
    let whole = predicted(&mut world, &other, first).ok()?;
    Some(Otherwise {
        is_contact_dynamics,
        dt_s: scene.duration / whole.steps,
        predicted_s: whole.wall_s,
    })
}

/// Wall time of a run predicted from its first steps; s.
pub(crate) fn wall_seconds(scene: &Scene) -> Result<f64, RunError> {
    let mut world = build(scene)?;
    let first = world.next_step(scene.duration)?;
    Ok(predicted(&mut world, scene, first)?.wall_s)
}

/// A whole run as its first steps predict it.
struct Predicted {
    timed_steps: u32,
    steps: f64,
    wall_s: f64,
}

/// Takes the first steps of a run and measures their time.
fn predicted(world: &mut World, scene: &Scene, first: TimeStep) -> Result<Predicted, RunError> {
    match scene.fluid {
        Some(_) => with_water(world, scene, first),
        None => of_blocks(world, scene),
    }
}

/// The prediction from steps that all are as long and as costly as the first ones.
fn with_water(world: &mut World, scene: &Scene, first: TimeStep) -> Result<Predicted, RunError> {
    let start = Instant::now();
    let mut taken = 0;
    while taken < PROBE_STEPS && start.elapsed() < PROBE_TIME {
        advance(world, scene)?;
        taken += 1;
    }
    let steps = ((scene.duration + scene.settle) / first.dt).ceil();
    Ok(Predicted {
        timed_steps: taken,
        steps,
        wall_s: start.elapsed().as_secs_f64() / f64::from(taken) * steps,
    })
}

/// The prediction for blocks alone, whose first steps may be of free flight, long and without contacts: the second half of the
/// probe stands for the rest of the run, unless it came to its end.
fn of_blocks(world: &mut World, scene: &Scene) -> Result<Predicted, RunError> {
    let start = Instant::now();
    let mut taken = 0;
    let mut half = None;
    while world.time() < scene.duration && start.elapsed() < PROBE_TIME {
        advance(world, scene)?;
        taken += 1;
        if half.is_none() && PROBE_TIME / 2 <= start.elapsed() {
            half = Some((world.time(), taken, start.elapsed()));
        }
    }
    let wall = start.elapsed();
    // a step of more than half of the probe has nothing behind it
    let half = half.filter(|(time, ..)| *time < world.time());
    let (from, taken_by_half, wall_at_half) = half.unwrap_or((0.0, 0, Duration::ZERO));
    let whole = scene.duration + scene.longest_settling();
    let rest = (whole - world.time()).max(0.0) / (world.time() - from);
    Ok(Predicted {
        timed_steps: taken,
        steps: rest
            .mul_add(f64::from(taken - taken_by_half), f64::from(taken))
            .ceil(),
        wall_s: rest.mul_add((wall - wall_at_half).as_secs_f64(), wall.as_secs_f64()),
    })
}

fn advance(world: &mut World, scene: &Scene) -> Result<(), RunError> {
    let step = world.next_step(scene.duration)?;
    let stepped = world.step(step);
    stepped.map_err(|error| named(error, scene))?;
    Ok(())
}

/// Every limit of the step, its cause and its stability limit.
fn step_limits(world: &World) -> Vec<Limit> {
    let Limits {
        common,
        blocks,
        cause_of_blocks,
        blocks_in_water: _,
    } = world.limits();
    let stability = world.stability();
    let all = common.into_iter().chain([(cause_of_blocks, blocks)]);
    all.map(|(cause, dt)| Limit {
        cause,
        dt_s: Some(dt).filter(|dt| dt.is_finite()),
        stable_to_s: stability
            .iter()
            .find(|(other, _)| *other == cause)
            .map(|(_, dt)| *dt),
    })
    .collect()
}

/// Share of the volume of free blocks in those that a cheaper run would leave out; –.
const CHEAPER: f64 = 0.01;

/// The block that sets the step of the contacts, and the longer step without the small blocks that hold a hundredth of the rock.
///
/// The step of a contact goes with the square root of the mass, `dt ∝ √(m/K)`.
fn governing_block(world: &World, scene: &Scene) -> Option<GoverningBlock> {
    let block = world.blocks.critical_time_step().block?;
    let volume = |b: usize| world.blocks.volume(b);
    let mut volumes: Vec<f64> = (0..scene.blocks.len())
        .filter(|&b| world.blocks.is_free(b))
        .map(volume)
        .collect();
    volumes.sort_by(f64::total_cmp);
    let all: f64 = volumes.iter().sum();
    let mut left_out = 0.0;
    let small = volumes.iter().take_while(|&&volume| {
        left_out += volume;
        left_out <= CHEAPER * all
    });
    let n = small.count();
    let is_cheaper = !scene.rock_masses.is_empty() && 0 < n && volume(block) < volumes[n];
    Some(GoverningBlock {
        name: scene.block_names[block].clone(),
        volume_m3: volume(block),
        without_small: is_cheaper.then(|| WithoutSmall {
            smallest_volume_m3: volumes[n],
            blocks_left_out: n,
            blocks: volumes.len(),
            share_of_rock: volumes[..n].iter().sum::<f64>() / all,
            step_ratio: (volumes[n] / volume(block)).sqrt(),
        }),
    })
}

/// The lines of the report.
impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.step)?;
        let step = &self.step;
        write!(f, "  steps          about {:.0}, ", self.steps)?;
        match step.dt_s < step.block_dt_s {
            true => writeln!(
                f,
                "one block step in {:.1} of them",
                step.block_dt_s / step.dt_s
            )?,
            false => writeln!(f, "{} block sub-steps in each", step.block_substeps)?,
        }
        writeln!(f, "  disk           {}", self.disk)?;
        write!(f, "  wall time      {}", self.wall_time)?;
        match &self.otherwise {
            Some(otherwise) => write!(f, "\n  otherwise      {otherwise}"),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Otherwise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            is_contact_dynamics,
            dt_s,
            predicted_s,
        } = self;
        let integrator = match is_contact_dynamics {
            true => "contact dynamics (`numerics.blocks: ContactDynamics()`)",
            false => "springs (`numerics.blocks: CentralDifference`)",
        };
        write!(
            f,
            "by {integrator} about {predicted_s:.0} s, in steps of {dt_s:.1e} s"
        )
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "  step limits")?;
        for limit in &self.limits {
            let value = match limit.dt_s {
                Some(dt) => format!("{dt:.3e} s"),
                None => "no limit".to_owned(),
            };
            let stable = match limit.stable_to_s {
                Some(dt) => format!(", stable to {dt:.3e} s"),
                None => String::new(),
            };
            let governs = match limit.cause == self.limited_by {
                true => "  <- governs",
                false => "",
            };
            let name = match limit.cause {
                Cause::BlockSpeed => "block speed".to_owned(),
                Cause::BlockStep => "block step".to_owned(),
                cause => format!("{cause:?}").to_lowercase(),
            };
            writeln!(f, "    {name:<12} {value}{stable}{governs}")?;
        }
        let Some(block) = &self.set_by_block else {
            return Ok(());
        };
        writeln!(
            f,
            "    set by       block `{}`, {:.3e} m3",
            block.name, block.volume_m3
        )?;
        let Some(cheaper) = &block.without_small else {
            return Ok(());
        };
        writeln!(
            f,
            "                 a smallest volume of {:.1e} m3 leaves out {} of {} blocks, {:.1} % of the rock: a step about {:.1} times \
             as long",
            cheaper.smallest_volume_m3,
            cheaper.blocks_left_out,
            cheaper.blocks,
            100.0 * cheaper.share_of_rock,
            cheaper.step_ratio
        )
    }
}

impl fmt::Display for WallTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            predicted_s,
            with_sleep_s,
            up_to_s,
            threads,
            timed_steps,
        } = self;
        write!(f, "about {predicted_s:.0} s")?;
        if let Some(wall) = with_sleep_s {
            write!(
                f,
                " with all water awake, {wall:.0} s with the initial sleep,"
            )?;
        }
        write!(
            f,
            " with {threads} threads, from {timed_steps} steps on this machine"
        )?;
        match up_to_s {
            Some(wall) => write!(
                f,
                "; up to {wall:.0} s, as water that bodies move costs more than in these steps"
            ),
            None => Ok(()),
        }
    }
}
