//! Cost of a run, from its first steps.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use riprap_dda::{BlockDefinition, Motion};

use crate::run::named::named;
use crate::run::{RunError, build};
use crate::scene::resolve::Scene;
use crate::world::World;
use crate::world::time_step::{Cause, Limits, TimeStep};

/// Largest wall time of the timed probe.
const PROBE_TIME: Duration = Duration::from_secs(2);
/// Wall time of a run with moving walls over that predicted from its first steps, where everything is still close to rest and
/// lists of neighbors last: measured 1.57 in a flume with a piston.
const MOVING: f64 = 1.6;
/// Largest number of steps of the probe.
const PROBE_STEPS: u32 = 50;

/// Step limits, steps, disk and wall time from a timed probe.
pub(super) fn cost(scene: &Scene) -> Result<String, RunError> {
    let mut world = build(scene)?;
    let step = world.next_step(scene.duration)?;
    let mut text = step_limits(&world, step);
    text += &governing_block(&world, scene);
    let steps = n_steps(scene, step);
    let _ = writeln!(
        text,
        "  steps          about {steps:.0}, {} block sub-steps in each",
        step.block_substeps
    );
    text += &disk(scene);
    let (taken, mut wall) = wall_time(&mut world, scene, steps)?;
    drop(world);
    let mut asleep = String::new();
    if scene.fluid.as_ref().is_some_and(|f| f.sleeping.is_some()) {
        let mut awake = scene.clone();
        if let Some(fluid) = &mut awake.fluid {
            fluid.sleeping = None;
        }
        asleep = format!(" with all water awake, {wall:.0} s with the initial sleep,");
        wall = wall_time(&mut build(&awake)?, &awake, steps)?.1;
    }
    let _ = write!(
        text,
        "  wall time      about {wall:.0} s{asleep} with {} threads, from {taken} steps on this machine",
        rayon::current_num_threads(),
    );
    let moves = |block: &BlockDefinition| !matches!(block.motion, Motion::Fixed);
    if scene.fluid.is_some() && scene.blocks.iter().any(moves) {
        let _ = write!(
            text,
            "; up to {:.0} s, as water that bodies move costs more than in these steps",
            MOVING * wall
        );
    }
    Ok(text)
}

/// Wall time of a run predicted from its first steps; s.
pub(crate) fn wall_seconds(scene: &Scene) -> Result<f64, RunError> {
    let mut world = build(scene)?;
    let step = world.next_step(scene.duration)?;
    Ok(wall_time(&mut world, scene, n_steps(scene, step))?.1)
}

/// Steps of a run that all are as long as the first.
fn n_steps(scene: &Scene, first: TimeStep) -> f64 {
    let settle = if scene.fluid.is_some() {
        scene.settle
    } else {
        0.0
    };
    ((scene.duration + settle) / first.dt).ceil()
}

/// Every limit of the step, its cause and its stability limit; the one that governs is marked.
fn step_limits(world: &World, step: TimeStep) -> String {
    let mut text = "  step limits\n".to_owned();
    let Limits { common, blocks } = world.limits();
    let stability = world.stability();
    for (cause, limit) in common.into_iter().chain([(Cause::Contact, blocks)]) {
        let value = if limit.is_finite() {
            format!("{limit:.3e} s")
        } else {
            "no limit".into()
        };
        let governs = if cause == step.cause {
            "  <- governs"
        } else {
            ""
        };
        let stable = stability
            .iter()
            .find(|(other, _)| *other == cause)
            .map_or(String::new(), |(_, dt)| format!(", stable to {dt:.3e} s"));
        let name = format!("{cause:?}").to_lowercase();
        let _ = writeln!(text, "    {name:<12} {value}{stable}{governs}");
    }
    text
}

/// Share of the volume of free blocks in those that a cheaper run would leave out; –.
const CHEAPER: f64 = 0.01;

/// The block that sets the step of the contacts, and the longer step without the small blocks that hold a hundredth of the rock.
///
/// The step of a contact goes with the square root of the mass, `dt ∝ √(m/K)`.
fn governing_block(world: &World, scene: &Scene) -> String {
    let Some(block) = world.blocks.critical_time_step().block else {
        return String::new();
    };
    let volume = |b: usize| world.blocks.volume(b);
    let mut text = format!(
        "    set by       block `{}`, {:.3e} m3\n",
        scene.block_names[block],
        volume(block)
    );
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
    if !scene.rock_masses.is_empty() && 0 < n && volume(block) < volumes[n] {
        let share: f64 = volumes[..n].iter().sum::<f64>() / all;
        let _ = writeln!(
            text,
            "                 a smallest volume of {:.1e} m3 leaves out {n} of {} blocks, {:.1} % of the rock: a step about {:.1} times \
             as long",
            volumes[n],
            volumes.len(),
            100.0 * share,
            (volumes[n] / volume(block)).sqrt()
        );
    }
    text
}

/// Disk space of the frames and gauge records.
fn disk(scene: &Scene) -> String {
    let duration = scene.duration;
    let fluid = scene.fluid.as_ref();
    let n = fluid.map_or(0, |f| f.lattice.positions.len()) as f64;
    let output = &scene.output;
    let frames = duration / output.frame_interval;
    // measured: about 30 bytes a particle and frame, compressed
    let bytes = frames * n * 30.0 + duration / output.gauge_interval * 500.0;
    format!(
        "  disk           about {:.0} MB in {frames:.0} frames\n",
        bytes / 1e6
    )
}

/// Takes some steps; returns their number, and the predicted wall time of a run, s.
fn wall_time(world: &mut World, scene: &Scene, steps: f64) -> Result<(u32, f64), RunError> {
    let (taken, wall) = probe(world, scene)?;
    Ok((taken, wall.as_secs_f64() / f64::from(taken) * steps))
}

/// Takes some steps and measures their time.
fn probe(world: &mut World, scene: &Scene) -> Result<(u32, Duration), RunError> {
    let start = Instant::now();
    let mut taken = 0;
    while taken < PROBE_STEPS && start.elapsed() < PROBE_TIME {
        let step = world.next_step(scene.duration)?;
        let stepped = world.step(step);
        stepped.map_err(|error| named(error, scene))?;
        taken += 1;
    }
    Ok((taken, start.elapsed()))
}
