//! Forces on blocks as they are recorded, against the momentum that the water loses.

use std::path::Path;

use riprap::observe::Observer;
use riprap::observe::gauges::Gauges;
use riprap::scene;
use riprap::table::Start;
use riprap::world::World;
use riprap_sph::Vec3;

use crate::support::{riprap, table, words};

/// Depth of the stream, its speed and the width of the plane; m, m/s, m.
const DEPTH: f64 = 0.2;
const SPEED: f64 = 4.0;
const WIDTH: f64 = 0.1;

/// Time by which the flow at the wall is steady; s.
const STEADY: f64 = 0.2;
const END: f64 = 0.6;

/// A weightless stream `rows` spacings deep on a floor, which a wall turns upward; `motion` is that of both.
fn jet(rows: u32, motion: &str, walls: &str) -> String {
    let spacing = DEPTH / f64::from(rows);
    format!(
        "(title: \"jet\", gravity: (0, 0, 0),
        domain: (min: (-4.4, 0, -0.4), max: (0.4, {WIDTH}, 8), dimensions: Two),
        materials: [(name: \"steel\", density: 7800, friction_angle_deg: 30)],
        blocks: [
            (name: \"floor\", material: \"steel\", {motion},
             shape: Box(min: (-4.4, -0.5, -0.4), max: (0.4, 0.6, 0))),
            (name: \"wall\", material: \"steel\", {motion}, shape: Box(min: (0, -0.5, 0), max: (0.4, 0.6, 8))),
        ],
        fluid: (resolution: Spacing({spacing}), regions: [
            (name: \"jet\", shape: Box(min: (-4, 0, 0), max: (0, {WIDTH}, {DEPTH})), velocity: ({SPEED}, 0, 0))]),
        numerics: (sound_speed: 40), interface: (walls: {walls}),
        time: (duration: 0.6), output: (gauge_interval: 0.05, frame_interval: 1),
        forces: (blocks: [\"floor\", \"wall\"], interval: 0.1),
        gauges: [BlockForce(name: \"floor\", block: \"floor\"), BlockForce(name: \"wall\", block: \"wall\")])"
    )
}

fn written(folder: &Path, text: &str) -> std::path::PathBuf {
    let path = folder.join("scene.ron");
    std::fs::write(&path, text).unwrap();
    path
}

fn momentum(world: &World) -> Vec3 {
    let particles = world.water.as_ref().unwrap().fluid.particles();
    let each = particles.mass.iter().zip(&particles.velocity);
    each.map(|(m, v)| v * *m).sum()
}

/// Whatever the water loses, blocks get: free or fixed, by pressure or in particles that are stopped at a face.
#[test]
fn a_stream_gives_blocks_the_momentum_that_it_loses() {
    let fixed = "motion: Fixed";
    let held = "motion: Free, hold: (directions: [X, Y, Z], turning: Held)";
    for (rows, motion, walls) in [
        (2, fixed, "Particles"),
        (4, fixed, "Particles"),
        (8, fixed, "Particles"),
        (4, held, "Particles"),
        (4, fixed, "Penalty"),
        (4, held, "Integral"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = written(folder.path(), &jet(rows, motion, walls));
        let (scene, _) = scene::load(&path, &[]).unwrap();
        let mut world = riprap::run::build(&scene).unwrap();
        let mut gauges = Gauges::new(folder.path(), &scene, &world, Start::New).unwrap();
        let start = momentum(&world);
        let mut due = 0.0;
        let mut steady = None;
        while world.time() < END {
            if due <= world.time() {
                gauges.observe(&world).unwrap();
                due += 0.05;
            }
            if STEADY <= world.time() && steady.is_none() {
                steady = Some((world.time(), momentum(&world)));
            }
            let step = world.next_step(END).unwrap();
            world.step(step).unwrap();
        }
        gauges.observe(&world).unwrap();
        gauges.sync().unwrap();
        let rows_of_table = table(&folder.path().join("gauges.csv"));
        let pairs = rows_of_table.windows(2);
        let given: f64 = pairs
            .map(|pair| (pair[1][0] - pair[0][0]) * (pair[1][1] + pair[1][13]))
            .sum();
        let lost = (start - momentum(&world)).x;
        let stopped = [0, 1].map(|block| world.fluid_impulses(block).pushed_back.force.x);
        let (from, before) = steady.unwrap();
        let force = (before - momentum(&world)).x / (world.time() - from);
        let mean = force / (1000.0 * SPEED * SPEED * DEPTH * WIDTH);
        println!(
            "{walls:9} {rows} rows, {motion:.13}: blocks got {given:.3} of {lost:.3} N s, {:.3} N s in stopped particles; mean \
             {mean:.3} of rho U2 d",
            stopped[0] + stopped[1],
        );
        // sums in single precision
        assert!((given - lost).abs() < 1e-4 * lost, "{given} N s of {lost}");
        // the stream is turned by a right angle; at any time a particle or two have been counted early or late
        let particle = (DEPTH / f64::from(rows)).powi(2) * WIDTH * 1000.0 * SPEED;
        let bound = 0.02 + 2.0 * particle / (1000.0 * SPEED * SPEED * DEPTH * WIDTH * (END - from));
        assert!((mean - 1.0).abs() < bound, "{walls}, {rows} rows: {mean}");
    }
}

/// `forces.csv` names what a fixed block gets, and its support bears the sum.
#[test]
fn forces_on_a_fixed_block_are_borne_by_its_support() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(folder.path(), &jet(4, "motion: Fixed", "Particles"));
    let out = folder.path().join("out");
    let output = riprap(&[
        "run",
        path.to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
        "--quiet",
    ]);
    assert!(output.status.success(), "{}", words(&output));
    let forces = table(&out.join("forces.csv"));
    assert_eq!(forces.len(), 2 * 6);
    let of_wall = forces.iter().filter(|row| row[1] == 1.0);
    for row in of_wall {
        // time, block, then six columns of each source
        let fx = |source: usize| row[2 + 6 * source];
        let [pressure, stopped, restrained, gained, residual] = [0, 3, 6, 8, 9].map(fx);
        assert!(0.0 < pressure, "{row:?}");
        let borne = pressure + fx(1) + fx(2) + stopped + fx(4);
        assert!((restrained + borne).abs() < 1e-9 * borne, "{row:?}");
        assert_eq!([gained, residual], [0.0, 0.0], "{row:?}");
    }
}
