//! Scenes of water in a line or two.

use std::path::Path;
use std::time::Instant;

use riprap::run::build;
use riprap::scene::error::{Problem, Severity};
use riprap::scene::parse;
use riprap::scene::resolve::Scene;
use riprap::scene::validate::values;
use riprap::time_step::TimeStep;
use riprap::world::World;

use crate::row::Failure;

pub const G: f64 = 9.81;
pub const RHO: f64 = 1000.0;
/// Longest that a scene says it lasts; s.
pub const DURATION: f64 = 1e3;

/// The checked scene of a text, or all that is wrong with it.
pub fn scene(text: &str) -> Result<Scene, Failure> {
    let file = parse::read(text).map_err(|error| error.message)?;
    let errors = |problems: Vec<Problem>| -> String {
        let words: Vec<String> = problems
            .into_iter()
            .filter(|p| p.severity == Severity::Error)
            .map(|p| p.message)
            .collect();
        words.join("; ")
    };
    let refused = errors(values(&file));
    if !refused.is_empty() {
        return Err(refused.into());
    }
    Scene::resolve(file, Path::new(".")).map_err(|problems| errors(problems).into())
}

pub fn world(text: &str) -> Result<World, Failure> {
    Ok(build(&scene(text)?)?)
}

/// A tank in a plane, from x = 0 to its length, and what is in it.
#[derive(Clone, Debug)]
pub struct Tank {
    pub length: f64,
    pub level: f64,
    /// Of its walls; m.
    pub height: f64,
    pub spacing: f64,
    pub gravity: (f64, f64),
    /// Further materials and blocks.
    pub materials: String,
    pub blocks: String,
    /// Of the domain, and further fields of the scene.
    pub domain: String,
    pub numerics: String,
    /// In place of water up to the level.
    pub regions: Option<String>,
    pub more: String,
}

impl Tank {
    pub fn new(length: f64, level: f64, spacing: f64) -> Self {
        Self {
            length,
            level,
            height: 1.6 * level + 4.0 * spacing,
            spacing,
            gravity: (0.0, -G),
            materials: String::new(),
            blocks: String::new(),
            domain: String::new(),
            numerics: String::new(),
            regions: None,
            more: String::new(),
        }
    }

    pub fn text(&self) -> String {
        let Self {
            length,
            level,
            height,
            spacing,
            gravity,
            ..
        } = self;
        let t = 4.0 * spacing;
        let walls = [
            ("floor", [-t, -t, length + t, 0.0]),
            ("left", [-t, 0.0, 0.0, *height]),
            ("right", [*length, 0.0, length + t, *height]),
        ]
        .map(|(name, corners)| cuboid(name, "material: \"m\", motion: Fixed", corners));
        let water = self.regions.clone().unwrap_or_else(|| {
            format!(
                "(name: \"water\", shape: Below(level: {level:?}, seed: ({0:?}, 0.05, {0:?})))",
                0.5 * spacing
            )
        });
        format!(
            "(title: \"tank\", gravity: ({:?}, 0, {:?}),\n\
             domain: (min: ({:?}, 0.0, {:?}), max: ({:?}, 0.1, {:?}), dimensions: Two, {}),\n\
             materials: [(name: \"m\", density: 2000, friction_angle_deg: 20), {}],\n\
             blocks: [{} {}],\n\
             fluid: (resolution: Spacing({spacing:?}), regions: [{water}]),\n\
             numerics: ({}), {} time: (duration: {DURATION:?}))",
            gravity.0,
            gravity.1,
            -t,
            -t,
            length + t,
            2.0 * height,
            self.domain,
            self.materials,
            walls.concat(),
            self.blocks,
            self.numerics,
            self.more,
        )
    }

    pub fn world(&self) -> Result<World, Failure> {
        world(&self.text())
    }
}

/// A box right across the slice; corners (x, z) of its section.
pub fn cuboid(name: &str, rest: &str, [x0, z0, x1, z1]: [f64; 4]) -> String {
    format!(
        "(name: \"{name}\", {rest}, shape: Box(min: ({x0:?}, 0.0, {z0:?}), max: ({x1:?}, 0.1, {z1:?}))),"
    )
}

/// Takes steps of a share of the world's own until a time (s), and looks after each.
pub fn advance(
    world: &mut World,
    until: f64,
    mut look: impl FnMut(&World),
) -> Result<u64, Failure> {
    let mut n = 0;
    while world.time() < until {
        let step = world.next_step(DURATION)?;
        world.step(step)?;
        look(world);
        n += 1;
    }
    Ok(n)
}

/// Steps of a share of the world's own.
pub fn take(world: &mut World, n: u64, share: f64) -> Result<(), Failure> {
    for _ in 0..n {
        let step = world.next_step(DURATION)?;
        world.step(TimeStep {
            dt: share * step.dt,
            ..step
        })?;
    }
    Ok(())
}

pub fn n_particles(world: &World) -> usize {
    world
        .water
        .as_ref()
        .map_or(0, |w| w.fluid.particles().len())
}

/// Heights over the water of a column in x: highest particle.
pub fn surface(world: &World, from: f64, to: f64) -> f64 {
    let Some(water) = &world.water else {
        return f64::NAN;
    };
    let places = &water.fluid.particles().position;
    places
        .iter()
        .filter(|x| from <= x.x && x.x <= to)
        .map(|x| x.z)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Root mean square of `p − ρ g (H − z)` over `ρ g H`.
pub fn pressure_error(world: &World, level: f64) -> f64 {
    let Some(water) = &world.water else {
        return f64::NAN;
    };
    let p = water.fluid.particles();
    let square: f64 = p
        .pressure
        .iter()
        .zip(&p.position)
        .map(|(p, x)| (p - RHO * G * (level - x.z)).powi(2))
        .sum();
    (square / p.len() as f64).sqrt() / (RHO * G * level)
}

pub fn max_speed(world: &World) -> f64 {
    world.water.as_ref().map_or(0.0, |w| w.fluid.max_speed())
}

/// Runs a closure on a number of threads.
pub fn on_threads<T: Send>(n: usize, run: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build()?;
    Ok(pool.install(run))
}

/// Time that this thread has spent on a processor, where the system tells; s. Others may be at work on the machine.
pub fn busy() -> f64 {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(
        || START.get_or_init(Instant::now).elapsed().as_secs_f64(),
        |ns| 1e-9 * ns,
    )
}
