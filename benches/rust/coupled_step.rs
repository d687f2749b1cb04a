//! Cost of blocks and water together.
//!
//! `cargo bench -p riprap --bench coupled_step -- wedge` times steps of `cases/sliding_wedge.ron` with each kind of wall beside
//! steps of its water alone, the wedge fixed, and of its blocks alone. `-- crowd 100 10` times steps of water with 10 cubes of
//! four spacings in each direction that drift in it, 100 spacings of water in each direction, by phase and kind of
//! wall: a million spacings and a thousand cubes.
#![expect(clippy::print_stdout, reason = "a benchmark reports")]

use std::fmt::Write as _;
use std::path::Path;
use std::time::{Duration, Instant};

use riprap::run::build;
use riprap::scene::file::{MotionFile, Preset, SceneFile, WallMethodFile};
use riprap::scene::parse;
use riprap::scene::resolve::Scene;
use riprap::world::{PhaseTimes, World};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// No step is limited by it; s.
const DURATION: f64 = 10.0;
/// Steps before the measurement.
const WARM_UP: u32 = 5;
const METHODS: [(&str, WallMethodFile); 3] = [
    ("W1 springs", WallMethodFile::Penalty),
    ("W2 particles", WallMethodFile::Particles),
    ("W3 integrals", WallMethodFile::Integral),
];

fn main() -> Result<(), Failure> {
    let words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| word != "--bench")
        .collect();
    let number = |k: usize, default: usize| words.get(k).map_or(Ok(default), |word| word.parse());
    match words.first().map(String::as_str) {
        None | Some("wedge") => wedge(number(1, 400)? as u32),
        Some("crowd") => crowd(number(1, 48)?, number(2, 5)?, number(3, 10)? as u32),
        Some(other) => Err(format!("found `{other}`; `wedge` or `crowd` would be right").into()),
    }
}

/// Wall time of a step in the mean over some, by phase too.
struct Timed {
    step: Duration,
    phases: PhaseTimes,
}

fn read(text: &str) -> Result<SceneFile, Failure> {
    parse::read(text).map_err(|error| error.message.into())
}

fn world_of(file: SceneFile) -> Result<World, Failure> {
    let scene = Scene::resolve(file, Path::new(".")).map_err(|problems| {
        let words: Vec<String> = problems.into_iter().map(|p| p.message).collect();
        words.join("; ")
    })?;
    Ok(build(&scene)?)
}

fn timed(file: SceneFile, steps: u32) -> Result<Timed, Failure> {
    let mut world = world_of(file)?;
    let mut take = |n: u32| -> Result<(), Failure> {
        for _ in 0..n {
            let step = world.next_step(DURATION)?;
            world.step(step)?;
        }
        Ok(())
    };
    take(WARM_UP)?;
    let start = Instant::now();
    take(steps)?;
    let step = start.elapsed() / steps;
    Ok(Timed {
        step,
        phases: world.phases(),
    })
}

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}

/// The coupled step beside those of its two solvers.
fn wedge(steps: u32) -> Result<(), Failure> {
    let text = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../cases/sliding_wedge.ron"
    ))?;
    let mut file = read(&text)?;
    file.numerics.preset = Preset::Standard;
    println!("sliding_wedge, Standard, {steps} steps from the start; ms a step");
    println!("| walls | coupled | water alone | blocks alone | ratio |");
    println!("|---|---|---|---|---|");
    for (name, method) in METHODS {
        let mut coupled = file.clone();
        coupled.interface.walls = Some(method);
        let mut water = coupled.clone();
        for block in &mut water.blocks {
            block.motion = MotionFile::Fixed;
        }
        water.gauges.clear();
        let mut blocks = coupled.clone();
        blocks.fluid = None;
        blocks.gauges.clear();
        let [coupled, water, blocks] = [coupled, water, blocks].map(|file| timed(file, steps));
        let [coupled, water, blocks] =
            [coupled?, water?, blocks?].map(|timed| milliseconds(timed.step));
        println!(
            "| {name} | {coupled:.2} | {water:.2} | {blocks:.3} | {:.3} |",
            coupled / (water + blocks)
        );
    }
    Ok(())
}

/// Many blocks in much water, by phase.
fn crowd(side: usize, cubes: usize, steps: u32) -> Result<(), Failure> {
    println!("{cubes}³ cubes of 4 spacings in {side}³ spacings of water, {steps} steps; ms a step");
    println!(
        "| walls | all | wall search | share | walls' sums | neighbors | density | forces | blocks | motion |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for (name, method) in METHODS {
        let mut file = read(&crowd_scene(side, cubes)?)?;
        file.interface.walls = Some(method);
        let Timed { step, phases } = timed(file, steps)?;
        let per_step = |time: Duration| milliseconds(time) / f64::from(steps + WARM_UP);
        println!(
            "| {name} | {:.1} | {:.2} | {:.1} % | {:.1} | {:.1} | {:.1} | {:.1} | {:.2} | {:.2} |",
            milliseconds(step),
            per_step(phases.wall_search),
            100.0 * per_step(phases.wall_search) / milliseconds(step),
            per_step(phases.coupling),
            per_step(phases.neighbors),
            per_step(phases.density),
            per_step(phases.forces),
            per_step(phases.broad_phase + phases.contacts),
            per_step(phases.integration),
        );
    }
    Ok(())
}

/// A full box, spacings of a decimeter, with cubes half as heavy again as water.
fn crowd_scene(side: usize, cubes: usize) -> Result<String, std::fmt::Error> {
    let spacing = 0.1;
    let length = side as f64 * spacing;
    let wall = 4.0 * spacing;
    let mut blocks = String::new();
    let mut add = |name: &str, rest: &str, low: [f64; 3], high: [f64; 3]| {
        let [[a, b, c], [d, e, f]] = [low, high];
        writeln!(
            blocks,
            "(name: \"{name}\", material: \"rock\", {rest} shape: Box(min: ({a:?}, {b:?}, {c:?}), max: ({d:?}, {e:?}, {f:?}))),"
        )
    };
    let fixed = "motion: Fixed,";
    let (low, high, top) = (-wall, length + wall, length + 2.0 * wall);
    add("floor", fixed, [low, low, low], [high, high, 0.0])?;
    add("left", fixed, [low, low, 0.0], [0.0, high, top])?;
    add("right", fixed, [length, low, 0.0], [high, high, top])?;
    add("front", fixed, [0.0, low, 0.0], [length, 0.0, top])?;
    add("back", fixed, [0.0, length, 0.0], [length, high, top])?;
    let pitch = length / cubes as f64;
    let half = 2.0 * spacing;
    for n in 0..cubes.pow(3) {
        let middle =
            [n % cubes, n / cubes % cubes, n / cubes.pow(2)].map(|k| (k as f64 + 0.5) * pitch);
        let (from, to) = (middle.map(|x| x - half), middle.map(|x| x + half));
        add(&format!("cube_{n}"), "", from, to)?;
    }
    Ok(format!(
        "(title: \"crowd\", gravity: (0, 0, -9.81),\n\
         domain: (min: ({low:?}, {low:?}, {low:?}), max: ({high:?}, {high:?}, {top:?})),\n\
         materials: [(name: \"rock\", density: 1500, friction_angle_deg: 30)],\n\
         blocks: [{blocks}],\n\
         fluid: (resolution: Spacing({spacing:?}),\n\
         regions: [(name: \"water\", shape: Below(level: {length:?}, seed: ({spacing:?}, {spacing:?}, {spacing:?})))]),\n\
         time: (duration: 10.0))"
    ))
}
