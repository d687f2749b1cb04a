//! Water at rest that sleeps: what it leaves out is not missed.

use std::fs;

use crate::support::scene::{resolved_in, world};
use riprap::run::build;
use riprap::scene;
use riprap::scene::parse::Override;
use riprap::world::World;
use riprap_sph::Fluid;

/// No step is limited by it; s.
const DURATION: f64 = 100.0;

/// A case with some of its fields set.
fn case(name: &str, set: &[(&str, &str)]) -> World {
    let set: Vec<Override> = set
        .iter()
        .map(|(path, value)| Override {
            path: (*path).to_owned(),
            value: (*value).to_owned(),
        })
        .collect();
    build(&scene::load(&crate::support::case(name), &set).unwrap().0).unwrap()
}

fn fluid(world: &World) -> &Fluid {
    &world.water.as_ref().unwrap().fluid
}

fn step(world: &mut World) {
    let step = world.next_step(DURATION).unwrap();
    world.step(step).unwrap();
}

fn advance(world: &mut World, until: f64) {
    crate::support::scene::advance(world, until, DURATION, |_| {});
}

/// Settled for a time (s), as a run does it, and stopped: a run stops water that may sleep.
fn settled(mut world: World, time: f64) -> World {
    let mut gone = 0.0;
    while gone < time {
        let dt = world.next_step(DURATION).unwrap().dt;
        world.settle_step(dt, 20.0 / time).unwrap();
        gone += dt;
    }
    world.water.as_mut().unwrap().fluid.damp(0.0);
    world.release().unwrap();
    world
}

/// Every number of the fluid.
fn state(world: &World) -> Vec<f64> {
    let mut numbers = Vec::new();
    fluid(world).visit_state(|x| numbers.push(x));
    numbers
}

/// A flume in a plane with a block that falls into one end of it, at rest a spacing above the water.
fn dropped(numerics: &str) -> String {
    format!(
        r#"(
        title: "dropped",
        domain: (min: (-0.3, 0, -0.3), max: (6.3, 0.1, 1), dimensions: Two),
        materials: [(name: "rock", density: 2400, friction_angle_deg: 30)],
        blocks: [
            (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, -0.3), max: (6.3, 0.1, 0))),
            (name: "left", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, 0), max: (0, 0.1, 0.9))),
            (name: "right", material: "rock", motion: Fixed, shape: Box(min: (6, 0, 0), max: (6.3, 0.1, 0.9))),
            (name: "cube", material: "rock", shape: Box(min: (0.1, 0, 0.43), max: (0.3, 0.1, 0.63))),
        ],
        fluid: (resolution: Spacing(0.025), regions: [
            (name: "water", shape: Box(min: (0, 0, 0), max: (6, 0.1, 0.4))),
        ]),
        numerics: ({numerics}),
        time: (duration: 4),
    )"#
    )
}

/// The surface over some points of the plan while a world goes on: times, and elevations point by point; s, m.
fn record(world: &mut World, until: f64, points: &[(f64, f64)]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let (mut times, mut levels) = (Vec::new(), vec![Vec::new(); points.len()]);
    while world.time() < until {
        step(world);
        if times.last().is_none_or(|last| last + 0.01 <= world.time()) {
            times.push(world.time());
            for (levels, &(x, y)) in levels.iter_mut().zip(points) {
                levels.push(fluid(world).surface_elevation(x, y).unwrap());
            }
        }
    }
    (times, levels)
}

/// Height of the crest over the level some time (s) before it, and when half of it is reached; m, s. Water that is awake
/// all the while creeps up by a hundredth of a spacing in a second, which is no part of the wave.
fn crest(times: &[f64], levels: &[f64], before: f64) -> (f64, f64) {
    let top = levels.iter().fold(0.0, |most: f64, z| most.max(*z));
    let reached = |level: f64| {
        let k = levels.iter().position(|z| level <= *z).unwrap().max(1);
        let share = (level - levels[k - 1]) / (levels[k] - levels[k - 1]);
        times[k - 1] + share * (times[k] - times[k - 1])
    };
    let from = reached(0.5 * (top + levels[0])) - before;
    let still = levels[times.iter().position(|t| from <= *t).unwrap()];
    (top - still, reached(0.5 * (top + still)))
}

/// Runs a scene with sleep and without, compares crests and arrivals, and returns the two worlds.
fn compared(worlds: [World; 2], until: f64, before: f64, points: &[(f64, f64)]) -> [World; 2] {
    let [(one, seen), (other, expected)] = worlds.map(|mut world| {
        let seen = record(&mut world, until, points);
        (world, seen)
    });
    for (k, point) in points.iter().enumerate() {
        let (height, arrival) = crest(&seen.0, &seen.1[k], before);
        let (expected_height, expected_arrival) = crest(&expected.0, &expected.1[k], before);
        println!(
            "at {point:?}: crest {height:.4} for {expected_height:.4} m, {:+.2} %; arrival {arrival:.3} for {expected_arrival:.3} s",
            100.0 * (height / expected_height - 1.0)
        );
        assert!((height / expected_height - 1.0).abs() < 0.01, "{point:?}");
        assert!((arrival / expected_arrival - 1.0).abs() < 0.01, "{point:?}");
    }
    let (awake, all) = (one.extremes(), other.extremes());
    println!(
        "{:.3} of the pairs, {:.3} awake",
        awake.pair_interactions as f64 / all.pair_interactions as f64,
        awake.particle_steps_awake as f64 / awake.particle_steps_of_all as f64
    );
    [one, other]
}

/// A trough six rows deep with a cube that falls into one end of it.
fn trough(numerics: &str) -> String {
    format!(
        r#"(
        title: "trough",
        domain: (min: (-0.2, -0.2, -0.2), max: (3.2, 0.48, 0.9)),
        materials: [(name: "rock", density: 2400, friction_angle_deg: 30)],
        blocks: [
            (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.2, -0.2, -0.2), max: (3.2, 0.48, 0))),
            (name: "left", material: "rock", motion: Fixed, shape: Box(min: (-0.2, -0.2, 0), max: (0, 0.48, 0.6))),
            (name: "right", material: "rock", motion: Fixed, shape: Box(min: (3, -0.2, 0), max: (3.2, 0.48, 0.6))),
            (name: "front", material: "rock", motion: Fixed, shape: Box(min: (0, -0.2, 0), max: (3, 0, 0.6))),
            (name: "back", material: "rock", motion: Fixed, shape: Box(min: (0, 0.28, 0), max: (3, 0.48, 0.6))),
            (name: "cube", material: "rock", shape: Box(min: (0.05, 0.04, 0.26), max: (0.25, 0.24, 0.46)), velocity: (0, 0, -1)),
        ],
        fluid: (resolution: Spacing(0.04), regions: [
            (name: "water", shape: Box(min: (0, 0, 0), max: (3, 0.28, 0.24))),
        ]),
        numerics: ({numerics}),
        time: (duration: 4),
    )"#
    )
}

#[test]
fn nothing_of_still_water_moves() {
    let still = [
        ("numerics.sleeping", "()"),
        ("time.settle", "0"),
        ("fluid.resolution", "Spacing(0.05)"),
    ];
    let mut world = case("still_tank.ron", &still);
    step(&mut world);
    let before = state(&world);
    for _ in 0..50 {
        step(&mut world);
    }
    println!(
        "{} of {} awake",
        fluid(&world).n_awake(),
        fluid(&world).particles().len()
    );
    assert!(state(&world) == before, "something moved");
    let extremes = world.extremes();
    assert_eq!(
        (extremes.pair_interactions, extremes.particle_steps),
        (0, 0)
    );
}

/// The solitary wave of `cases/solitary.ron` on ten rows: where it has not come yet, nothing is computed.
#[test]
fn a_solitary_wave_is_the_same_in_water_that_sleeps_before_it() {
    let coarse = ("fluid.resolution", "Spacing(0.1)");
    let worlds = [
        case("solitary.ron", &[coarse, ("numerics.sleeping", "()")]),
        case("solitary.ron", &[coarse]),
    ];
    let points = [5.0, 10.0, 15.0].map(|x| (x, 0.5));
    let [with, without] = compared(worlds, 7.0, 2.0, &points);
    let (energy, expected) = (with.energy(), without.energy());
    println!(
        "energy residual {:.3e} for {:.3e} of {:.3e} J, lost to sleep {:.3e} J; momentum {:.1e} for {:.1e}",
        energy.residual,
        expected.residual,
        energy.external_work,
        energy.sleep_loss,
        with.momentum_residual(),
        without.momentum_residual()
    );
    // what holds sleeping water does no work: nothing more is unexplained than without
    let more = (energy.residual - expected.residual).abs();
    assert!(more < 1e-3 * energy.external_work, "{more} J");
    // what it does to the rest is a force that is booked; round-off of single precision
    assert!(with.momentum_residual() < 1e-5);
    // the same particles, summed in another order
    assert_eq!(
        fluid(&with).particles().len(),
        fluid(&without).particles().len()
    );
    assert!((fluid(&with).mass() / fluid(&without).mass() - 1.0).abs() < 1e-14);
    let pairs = [&with, &without].map(|world| world.extremes().pair_interactions as f64);
    assert!(pairs[0] < 0.6 * pairs[1], "{pairs:?}");
}

/// A block falls into one end of a trough: a wave of all lengths and a crack that goes through all of the water at once.
#[test]
fn a_crack_does_not_wake_the_water_that_a_wave_will() {
    // steps shorter than the rows of the record
    let scheme = "viscosity: Artificial(0.02), time_step_factor: 0.5";
    let worlds = ["sleeping: (), ", ""]
        .map(|sleeping| settled(world(&trough(&format!("{sleeping}{scheme}"))), 0.5));
    let points = [1.0, 1.4].map(|x| (x, 0.14));
    let [with, without] = compared(worlds, 0.9, 0.3, &points);
    let (energy, expected) = (with.energy(), without.energy());
    let more = (energy.residual - expected.residual).abs();
    println!(
        "energy residual {:.3e} for {:.3e} of {:.3e} J lost; momentum {:.1e}",
        energy.residual,
        expected.residual,
        expected.lost(),
        with.momentum_residual()
    );
    assert!(more < 0.01 * expected.lost(), "{more} J");
    let pairs = [&with, &without].map(|world| world.extremes().pair_interactions as f64);
    assert!(pairs[0] < 0.9 * pairs[1], "{pairs:?}");
}

#[test]
fn threads_and_checkpoints_do_not_change_a_bit() {
    let text = dropped("sleeping: ()");
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let mut world = world(&text);
            advance(&mut world, 0.25);
            let bytes = world.save(Vec::new()).unwrap();
            advance(&mut world, 0.5);
            (bytes, world)
        })
    };
    let ((bytes, one), (_, two)) = (run(1), run(2));
    let n_awake = fluid(&one).n_awake();
    println!("{n_awake} of {} awake", fluid(&one).particles().len());
    assert!(0 < n_awake && n_awake < fluid(&one).particles().len());
    let mut resumed = world(&text);
    assert!(resumed.read(&bytes).unwrap().is_empty());
    advance(&mut resumed, 0.5);
    for other in [&two, &resumed] {
        assert_eq!(other.state_hash(), one.state_hash());
        assert_eq!(other.energy(), one.energy());
        assert_eq!(fluid(other).n_awake(), n_awake);
    }
}

/// A paddle strokes and rests, and strokes again, in water that is damped everywhere.
#[test]
fn water_that_has_calmed_down_sleeps_again_and_wakes_again() {
    let folder = tempfile::tempdir().unwrap();
    let record = "time [s], x [m], y [m], z [m]\n0, 0, 0, 0\n0.1, 0, 0, 0\n0.4, 0.05, 0, 0\n5, 0.05, 0, 0\n5.3, 0, 0, 0\n9, 0, 0, 0\n";
    fs::write(folder.path().join("paddle.csv"), record).unwrap();
    let text = r#"(
        title: "strokes",
        domain: (min: (-0.3, 0, -0.3), max: (3.3, 0.1, 1), dimensions: Two),
        materials: [(name: "rock", density: 2400, friction_angle_deg: 30)],
        blocks: [
            (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, -0.3), max: (3.3, 0.1, 0))),
            (name: "right", material: "rock", motion: Fixed, shape: Box(min: (3, 0, 0), max: (3.3, 0.1, 0.9))),
            (name: "paddle", material: "rock", motion: Table(file: "paddle.csv"), shape: Box(min: (-0.2, 0, 0), max: (0, 0.1, 0.9))),
        ],
        fluid: (resolution: Spacing(0.03), regions: [
            (name: "water", shape: Box(min: (0, 0, 0), max: (3, 0.1, 0.39))),
        ]),
        absorbers: [
            (name: "one", min: (0, 0, 0), max: (3, 0.1, 0.9), towards: XMax, rate: 5),
            (name: "other", min: (0, 0, 0), max: (3, 0.1, 0.9), towards: XMin, rate: 5),
        ],
        numerics: (sleeping: (time: 0.5)),
        time: (duration: 9),
    )"#;
    let mut world = build(&resolved_in(folder.path(), text).unwrap()).unwrap();
    let n = fluid(&world).particles().len();
    let mut awake = |until: f64| {
        let (mut least, mut most) = (n, 0);
        while world.time() < until {
            step(&mut world);
            let n_awake = fluid(&world).n_awake();
            (least, most) = (least.min(n_awake), most.max(n_awake));
        }
        (least, most)
    };
    let (start, stroke, calm, again) = (awake(0.1), awake(4.0), awake(4.9), awake(6.0));
    println!(
        "awake of {n}: {start:?} before, {stroke:?} by a stroke, {calm:?} in calm, {again:?} by another"
    );
    // beside the paddle it never sleeps
    assert!(start.1 < n / 4 && n / 2 < stroke.1 && calm.0 < n / 4 && n / 2 < again.1);
    assert!(0.0 < world.energy().sleep_loss);
}

#[test]
fn what_water_cannot_sleep_with_is_refused() {
    for (numerics, more, said) in [
        ("sleeping: (displacement: 0)", "", "must be > 0"),
        ("sleeping: (), stepping: PredictorCorrector", "", "use that"),
        (
            "sleeping: (), density_diffusion: Antuono(0.1)",
            "",
            "use `Fourtakas`",
        ),
        (
            "sleeping: (), viscosity: SubParticleScale(0.12)",
            "",
            "a viscosity that varies",
        ),
        (
            "sleeping: ()",
            "interface: (walls: Integral),",
            "set `interface.walls` to Particles",
        ),
        ("sleeping: ()", "gravity: (0, 0, 0),", "give both"),
    ] {
        let text = dropped(numerics).replace("domain:", &format!("{more} domain:"));
        let path = tempfile::tempdir().unwrap();
        let file = path.path().join("scene.ron");
        fs::write(&file, &text).unwrap();
        let refused = scene::load(&file, &[]).err().unwrap();
        let words = refused.located().iter().map(|one| one.message.clone());
        let words: Vec<String> = words.collect();
        assert!(
            words.iter().any(|one| one.contains(said)),
            "{numerics} {more}: {words:?}"
        );
    }
}
