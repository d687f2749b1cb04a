//! Walls of all three kinds in running scenes: closure, buoyancy, a block that goes with the flow, leaks,
//! thin plates, momentum, and the scenes that are refused.

mod accounts;
mod bodies;
mod closed_in;
mod plates;
mod still;
mod whole_step;

use crate::support::scene::{
    Case, FIXED, HELD, basin, below, block, cuboid, resolved, resolved_in, triple,
};

use riprap::run::build;
use riprap::scene::{parse, validate};
use riprap::world::World;
use riprap_sph::Vec3;

const RHO: f64 = 1000.0;

const G: f64 = 9.81;

/// A scheme in which the water is calm, so that it is the walls that stir it: artificial viscosity, half the step, and a sound
/// speed of ten times long waves in water this deep (m). The default leaves 0.2 to 0.8 % of noise in its place.
fn calm(depth: f64) -> String {
    let sound = 10.0 * (G * depth).sqrt();
    format!("viscosity: Artificial(0.02), time_step_factor: 0.5, sound_speed: {sound:?}")
}

/// A basin of still water, sizes in spacings, and a block in it.
fn still(
    walls: &'static str,
    size: [usize; 3],
    shape: Option<&str>,
    more: [String; 3],
) -> (Case, f64) {
    let spacing = 1.0 / 16.0;
    let inner = size.map(|n| n as f64 * spacing);
    let repeats = more[0].contains("periodic");
    let is_plane = repeats || more[0].contains("Two");
    let top = inner[2] + 4.0 * spacing;
    let mut blocks = basin([inner[0], inner[1], top], 4.0 * spacing);
    // floor, left and right go through a slab, which has nothing at its sides
    blocks.truncate(if repeats { 3 } else { blocks.len() });
    blocks.extend(shape.map(|shape| block("body", shape, HELD)));
    let margin = if is_plane { 0.0 } else { 5.0 * spacing };
    let case = Case {
        domain: [
            [-5.0 * spacing, -margin, -5.0 * spacing],
            [
                inner[0] + 5.0 * spacing,
                inner[1] + margin,
                top + 2.0 * spacing,
            ],
        ],
        gravity: G,
        blocks,
        spacing,
        regions: below(inner[2], [1.6 * spacing, 0.5 * inner[1], 1.6 * spacing]),
        walls,
        more,
    };
    (case, spacing)
}

fn plain() -> [String; 3] {
    [String::new(), String::new(), String::new()]
}

/// Lets the water come to rest for `settle` s; mean and standard deviation of the upward force on the last
/// block over as long again.
fn upward_force(world: &mut World, settle: f64) -> (f64, f64) {
    let body = world.blocks.n_blocks() - 1;
    let mut time = 0.0;
    while time < settle {
        let dt = world.next_step(settle).unwrap().dt;
        world.settle_step(dt, 20.0 / settle).unwrap();
        time += dt;
    }
    world.release().unwrap();
    let mut forces = Vec::new();
    while world.time() < settle {
        let step = world.next_step(settle).unwrap();
        world.step(step).unwrap();
        forces.push(
            world.water.as_ref().unwrap().interface.loads()[body]
                .force
                .z,
        );
    }
    let n = forces.len() as f64;
    let mean = forces.iter().sum::<f64>() / n;
    let variance = forces.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / n;
    (mean, variance.sqrt())
}

/// Relative error of the buoyancy of a block and its noise, printed.
fn buoyancy(what: &str, case: &Case, volume: f64, settle: f64) -> (f64, f64) {
    let [error, noise, _] = at_rest(what, case, volume, settle);
    (error, noise)
}

/// The same, and the speed of the fastest water in the end; m/s.
fn at_rest(what: &str, case: &Case, volume: f64, settle: f64) -> [f64; 3] {
    let exact = RHO * G * volume;
    let mut world = case.world();
    let (mean, noise) = upward_force(&mut world, settle);
    let (error, noise) = (mean / exact - 1.0, noise / exact);
    let fastest = world.water.as_ref().unwrap().fluid.max_speed();
    println!(
        "C04 {what:28} {:9}: error {:+.2} %, noise {:.2} %, put back {}, fastest {fastest:.1e} m/s, momentum residual {:.1e}",
        case.walls,
        100.0 * error,
        100.0 * noise,
        world.extremes().particles_pushed_back,
        world.momentum_residual(),
    );
    [error, noise, fastest]
}

/// A cube of `n` spacings a side on the lattice, in the middle of a basin with five spacings round it.
fn cube(walls: &'static str, n: usize) -> (Case, f64) {
    let spacing = 1.0 / 16.0;
    let (low, high) = (5.0 * spacing, (5 + n) as f64 * spacing);
    let shape = cuboid([low; 3], [high; 3]);
    let (case, _) = still(walls, [n + 10; 3], Some(&shape), plain());
    (case, (high - low).powi(3))
}

/// Root mean squares of still water's speed over `√(gH)` and of its pressure's error over `ρgH`.
fn unrest(world: &World, depth: f64) -> (f64, f64) {
    let particles = world.water.as_ref().unwrap().fluid.particles();
    let rms = |of: &dyn Fn(usize) -> f64| {
        let sum: f64 = (0..particles.len()).map(|a| of(a).powi(2)).sum();
        (sum / particles.len() as f64).sqrt()
    };
    let speed = rms(&|a| particles.velocity[a].norm()) / (G * depth).sqrt();
    let pressure = rms(&|a| particles.pressure[a] - RHO * G * (depth - particles.position[a].z))
        / (RHO * G * depth);
    (speed, pressure)
}

#[test]
fn scenes_that_walls_cannot_hold_are_refused() {
    let ball = "Sphere(center: (0.5, 0.5, 0.5), radius: 0.2)";
    let plane = ["dimensions: Two".to_owned(), String::new(), String::new()];
    for (walls, more) in [("Particles", plane), ("Integral", plain())] {
        let (case, _) = still(walls, [16; 3], Some(ball), more);
        let errors = case.errors();
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert!(
            errors[0].starts_with("blocks[5].shape: block `body`: a sphere"),
            "{errors:?}"
        );
        assert!(
            errors[0].contains("interface.walls to Penalty"),
            "{errors:?}"
        );
    }
    for walls in ["Penalty", "Particles"] {
        let (case, _) = still(walls, [16; 3], Some(ball), plain());
        assert_eq!(case.errors(), [""; 0], "{walls}");
    }
    let of = |numerics: &str| {
        let more = [String::new(), String::new(), numerics.to_owned()];
        still("Integral", [16, 16, 16], None, more).0.errors()
    };
    for (numerics, said) in [
        ("kernel: CubicSpline", "WendlandC2"),
        ("density: Summation", "Continuity"),
    ] {
        let errors = of(numerics);
        assert!(
            errors.iter().any(|e| e.contains(said)),
            "{said}: {errors:?}"
        );
    }
    assert!(of("").is_empty(), "{:?}", of(""));
    let more = [
        String::new(),
        String::new(),
        "density: Summation".to_owned(),
    ];
    let errors = still("Particles", [16; 3], None, more).0.errors();
    assert_eq!(
        errors,
        ["interface.walls: Particles requires `numerics.density` Continuity; use Penalty"]
    );
}
