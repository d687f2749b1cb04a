//! Ends of a flume, and gauges.

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::support::{riprap, run, table, words};
use riprap::scene;
use riprap::table::Start;
use riprap::world::World;

const GRAVITY: f64 = 9.81;

/// A scene written into a folder.
fn written(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("scene.ron");
    std::fs::write(&path, text).unwrap();
    path
}

/// The world of a scene, without a run folder.
fn world(text: &str) -> (World, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let (scene, _) = scene::load(&written(folder.path(), text), &[]).unwrap();
    (riprap::run::build(&scene).unwrap(), folder)
}

fn advance(world: &mut World, until: f64) {
    crate::support::scene::advance(world, until, until, |_| {});
}

/// A plane flume 0.2 m deep: a piston at its left end makes waves 1 m long, a layer of that length takes them.
fn flume() -> String {
    let gauges: Vec<String> = (0..N_GAUGES)
        .map(|k| {
            format!(
                "SurfaceElevation(name: \"s{k}\", x: {}, y: 0.5)",
                1.5 + place(k)
            )
        })
        .collect();
    format!(
        "(title: \"waves\", domain: (min: (-0.1, 0, -0.2), max: (4.2, 1, 0.5), dimensions: Two),
        materials: [(name: \"wall\", density: 2400, friction_angle_deg: 30)],
        blocks: [
            (name: \"floor\", material: \"wall\", motion: Fixed, shape: Box(min: (-0.5, -1, -0.3), max: (4.3, 2, 0))),
            (name: \"paddle\", material: \"wall\", shape: Box(min: (-0.3, -1, -0.05), max: (0, 2, 0.5)),
             motion: Sinusoid(direction: (1, 0, 0), amplitude: 0.01, period: {PERIOD}, ramp: {PERIOD})),
            (name: \"right\", material: \"wall\", motion: Fixed, shape: Box(min: (4, -1, 0), max: (4.3, 2, 0.7))),
        ],
        fluid: (resolution: Spacing(0.02), regions: [
            (name: \"flume\", shape: Box(min: (0, 0, 0), max: (4, 1, 0.2))),
        ]),
        absorbers: [(name: \"beach\", min: (3, 0, -0.1), max: (4, 1, 0.5), towards: XMax)],
        time: (duration: 8.7),
        gauges: [{}],
        output: (gauge_interval: 0.0217, frame_interval: 20.0))",
        gauges.join(", ")
    )
}

/// ω² = g k tanh(k d) with k = 2π/1 m, d = 0.2 m; s.
const PERIOD: f64 = 0.868;
const N_GAUGES: u32 = 11;

/// Place of a gauge after the first: half a wave length in all; m.
fn place(gauge: u32) -> f64 {
    0.05 * f64::from(gauge)
}

/// Amplitudes of the waves to the right and to the left that fit the gauges best over the last two
/// periods: η = Re (a e^{−ikx} + b e^{ikx}) e^{iωt}; m.
fn incident_and_reflected(rows: &[Vec<f64>]) -> (f64, f64) {
    let omega = 2.0 * PI / PERIOD;
    let end = rows.last().unwrap()[0];
    let last: Vec<_> = rows
        .iter()
        .filter(|row| end - 2.0 * PERIOD < row[0])
        .collect();
    let (mut right, mut left, mut cross) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    for gauge in 0..N_GAUGES {
        let column = gauge as usize + 1;
        let mean = last.iter().map(|row| row[column]).sum::<f64>() / last.len() as f64;
        let share = |part: fn(f64) -> f64| {
            let sum: f64 = last
                .iter()
                .map(|row| (row[column] - mean) * part(omega * row[0]))
                .sum();
            2.0 * sum / last.len() as f64
        };
        let (re, im) = (share(f64::cos), -share(f64::sin));
        let (s, c) = (2.0 * PI * place(gauge)).sin_cos();
        // the amplitude times e^{ikx} and e^{−ikx}
        right = [right[0] + re * c - im * s, right[1] + re * s + im * c];
        left = [left[0] + re * c + im * s, left[1] + im * c - re * s];
        // Σ e^{2ikx}
        cross = [cross[0] + c * c - s * s, cross[1] + 2.0 * c * s];
    }
    // n a + X b = right, X* a + n b = left
    let n = f64::from(N_GAUGES);
    let det = n * n - cross[0].powi(2) - cross[1].powi(2);
    let a = [
        n * right[0] - cross[0] * left[0] + cross[1] * left[1],
        n * right[1] - cross[0] * left[1] - cross[1] * left[0],
    ];
    let b = [
        n * left[0] - cross[0] * right[0] - cross[1] * right[1],
        n * left[1] - cross[0] * right[1] + cross[1] * right[0],
    ];
    (a[0].hypot(a[1]) / det, b[0].hypot(b[1]) / det)
}

#[test]
fn an_absorbing_layer_a_wave_length_long_reflects_little() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let summary = run(&written(folder.path(), &flume()), &out, &["--threads", "2"]);
    let (there, back) = incident_and_reflected(&table(&out.join("gauges.csv")));
    println!(
        "{there:.5} m there, {back:.5} m back, {:.4}; energy {}, momentum {}",
        back / there,
        summary["energy"],
        summary["momentum_residual"],
    );
    // 2 (cosh 2kd − 1)/(sinh 2kd + 2kd) × 0.01 m = 0.0120 m, less what viscosity takes on 1.7 m; measured 0.0109
    assert!((0.008..0.0125).contains(&there), "{there}");
    assert!(back / there < 0.05, "{}", back / there);
    // the foot of the paddle stands two and a half spacings deep in the bed; ten times the error of the step, 0.0007 J of 5.0 J
    let term = |name: &str| summary["energy"][name].as_f64().unwrap();
    assert!(
        term("residual").abs() < 1.5e-3 * term("external_work"),
        "{}",
        term("residual")
    );
    assert!(0.0 < summary["energy"]["absorbed"].as_f64().unwrap());
    assert!(summary["momentum_residual"].as_f64().unwrap() < 1e-6);
}

/// A tank of 0.6 m by 0.4 m of still water, 0.2 m wide between walls, or plane.
fn tank(dimensions: &str, gauges: &str) -> String {
    let (front, back, sides) = match dimensions {
        "Two" => (0.0, 0.2, ""),
        _ => (
            -0.1,
            0.3,
            "(name: \"front\", material: \"wall\", motion: Fixed, shape: Box(min: (-0.3, -0.3, 0), max: (0.9, 0, 0.7))),
             (name: \"back\", material: \"wall\", motion: Fixed, shape: Box(min: (-0.3, 0.2, 0), max: (0.9, 0.5, 0.7))),",
        ),
    };
    format!(
        "(title: \"tank\", domain: (min: (-0.2, {front}, -0.2), max: (0.8, {back}, 0.6), dimensions: {dimensions}),
        materials: [(name: \"wall\", density: 2400, friction_angle_deg: 30)],
        blocks: [
            (name: \"floor\", material: \"wall\", motion: Fixed, shape: Box(min: (-0.3, -1, -0.3), max: (0.9, 2, 0))),
            (name: \"left\", material: \"wall\", motion: Fixed, shape: Box(min: (-0.3, -1, 0), max: (0, 2, 0.7))),
            (name: \"right\", material: \"wall\", motion: Fixed, shape: Box(min: (0.6, -1, 0), max: (0.9, 2, 0.7))),
            {sides}
        ],
        fluid: (resolution: Spacing(0.02), regions: [
            (name: \"tank\", shape: Box(min: (0, 0, 0), max: (0.6, 0.2, 0.4))),
        ]),
        time: (duration: 0.5),
        gauges: [{gauges}],
        output: (gauge_interval: 0.01, frame_interval: 5.0))"
    )
}

#[test]
fn gauges_read_still_water_on_walls_and_in_it() {
    let (depth, length, width) = (0.4, 0.6, 0.2);
    for (dimensions, until) in [("Two", 0.5), ("Three", 0.2)] {
        let mut wrong = Vec::new();
        // ten times long waves, and calm
        let scheme = "numerics: (viscosity: Artificial(0.02), time_step_factor: 0.5, sound_speed: 19.8), time: (";
        let text = tank(dimensions, "").replace("time: (", scheme);
        let (mut world, _folder) = world(&text);
        advance(&mut world, until);
        let fluid = &world.water.as_ref().unwrap().fluid;
        let scale = 1000.0 * GRAVITY * depth;
        for (place, x, z) in [
            ("floor", 0.3, 0.0),
            ("wall", 0.0, 0.2),
            ("wall, high", 0.6, 0.35),
            ("corner", 0.0, 0.0),
            ("middle", 0.31, 0.203),
            ("near the surface", 0.3, 0.39),
        ] {
            let sample = fluid.sample(&riprap_sph::Vec3::new(x, 0.07, z)).unwrap();
            let error = (sample.pressure - 1000.0 * GRAVITY * (depth - z)) / scale;
            println!(
                "{dimensions}, {place}: pressure off by {:.3} % of ρ g H, speed {:.1e} m/s",
                100.0 * error,
                sample.velocity.norm()
            );
            // the compressed column is 0.25 % heavier at the bottom than ρ₀ g H
            // half a spacing below the surface the scheme itself is off: measured 2.1 %
            // in space, with a support of 2.6 spacings, the particles' own pressures are: 1.1 % in the middle,
            // 2.7 % in the corner
            let bound = if dimensions == "Three" || z > 0.38 {
                0.03
            } else {
                0.01
            };
            if bound <= error.abs() {
                wrong.push(format!("{dimensions}, {place}: {error}"));
            }
        }
        for x in [0.0, 0.1, 0.307, 0.6] {
            let surface = fluid.surface_elevation(x, 0.07).unwrap();
            println!(
                "{dimensions}: surface at {x}: {:.3} spacings off",
                (surface - depth) / 0.02
            );
            // on a wall half the kernel is empty, and what is left is uneven: measured 0.13
            let bound = if (0.05..0.55).contains(&x) { 0.1 } else { 0.2 };
            if bound * 0.02 <= (surface - depth).abs() {
                wrong.push(format!("{dimensions}, surface at {x}: {surface}"));
            }
        }
        assert!(
            fluid
                .sample(&riprap_sph::Vec3::new(0.3, 0.07, 0.45))
                .is_none()
        );
        let floor = world.fluid_load(0).force;
        let (left, right) = (world.fluid_load(1).force, world.fluid_load(2).force);
        let weight = 1000.0 * GRAVITY * depth * length * width;
        let thrust = 0.5 * 1000.0 * GRAVITY * depth * depth * width;
        println!(
            "{dimensions}: floor {:.4}, walls {:.4} and {:.4} of theory",
            -floor.z / weight,
            -left.x / thrust,
            right.x / thrust
        );
        assert!((-floor.z / weight - 1.0).abs() < 0.02);
        assert!((right.x / thrust - 1.0).abs() < 0.05);
        // what the blocks get is what the fluid gives
        let walls = world.water.as_ref().unwrap().walls.as_ref().unwrap();
        let rest: riprap_sph::Vec3 = (3..world.blocks.n_blocks())
            .map(|block| world.fluid_load(block).force)
            .sum();
        let sum = floor + left + right + rest + walls.force_on_fluid();
        assert!(sum.norm() < 1e-4 * weight, "{sum}");
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}

/// A plane channel 2 m long and 0.2 m deep with water at 0.5 m/s.
const CHANNEL: &str = "(title: \"channel\",
    domain: (min: (-0.3, 0, -0.2), max: (2.3, 1, 0.4), dimensions: Two),
    materials: [(name: \"wall\", density: 2400, friction_angle_deg: 30)],
    blocks: [(name: \"floor\", material: \"wall\", motion: Fixed, shape: Box(min: (-0.4, -1, -0.3), max: (2.4, 2, 0)))],
    fluid: (resolution: Spacing(0.02), regions: [
        (name: \"river\", shape: Box(min: (0, 0, 0), max: (2.2, 1, 0.2)), velocity: (0.5, 0, 0)),
    ]),
    inflows: [(name: \"spring\", min: (-0.2, 0, 0), max: (0, 1, 0.3), towards: XMax, discharge: [(0, 0.1)], depth: [(0, 0.2)])],
    outflows: [(name: \"sea\", min: (2, 0, 0), max: (2.2, 1, 0.3), towards: XMax, depth: [(0, 0.2)])],
    time: (duration: 4.0))";

#[test]
fn a_uniform_flow_stays_uniform_and_no_mass_is_lost() {
    let scheme = "viscosity: Artificial(0.02), time_step_factor: 0.5, sound_speed: 14";
    uniform_flow(&format!("stepping: KickDriftKick, {scheme}"), 4.0);
    uniform_flow(&format!("stepping: PredictorCorrector, {scheme}"), 2.0);
}

fn uniform_flow(numerics: &str, until: f64) {
    let text = CHANNEL.replace("time: (", &format!("numerics: ({numerics}), time: ("));
    let (mut world, _folder) = world(&text);
    let at_start = world.water.as_ref().unwrap().fluid.mass();
    advance(&mut world, until);
    let water = world.water.as_ref().unwrap();
    let fluid = &water.fluid;
    // one inflow, one outflow
    let [inflow, outflow] = water.openings.passed().first_chunk().unwrap();
    let change = fluid.mass() - at_start;
    println!("{inflow:?}, {outflow:?}, change {change} kg");
    let booked = inflow.mass_in - outflow.mass_out - fluid.removed().mass;
    assert!(
        (change - booked).abs() < 1e-9 * at_start,
        "{change} {booked}"
    );
    assert_eq!(fluid.removed().count, 0);
    // 0.1 m³/s, to a row of particles of 4 kg
    let expected = 100.0 * until;
    assert!((inflow.mass_in - expected).abs() < 8.0);
    let ids: BTreeSet<_> = fluid.particles().id.iter().copied().collect();
    assert_eq!(ids.len(), fluid.particles().len());
    for x in [0.3, 0.7, 1.0, 1.5, 1.8] {
        let surface = fluid.surface_elevation(x, 0.5).unwrap();
        let speeds = [0.04, 0.1, 0.16].map(|z| {
            let point = riprap_sph::Vec3::new(x, 0.5, z);
            fluid.sample(&point).unwrap().velocity.x
        });
        println!("x = {x}: depth {surface:.4} m, speeds {speeds:.4?} m/s");
        assert!((surface - 0.2).abs() < 0.02 * 0.2 + 0.1 * 0.02);
        assert!(
            speeds.iter().all(|u| (u / 0.5 - 1.0).abs() < 0.02),
            "{x}: {speeds:?}"
        );
    }
    let energy = world.energy();
    println!(
        "momentum residual {:e}, energy {energy:?}",
        world.momentum_residual()
    );
    assert!(world.momentum_residual() < 1e-6);
    // pressure at each end gave or took ½ ρ g H² u per second, 390 J in all; measured 17 J
    assert!(energy.residual.abs() < 25.0, "{}", energy.residual);
}

#[test]
fn wrong_openings_say_what_to_change() {
    for (from, to, said) in [
        (
            "discharge: [(0, 0.1)]",
            "discharge: []",
            "give either velocity or discharge",
        ),
        ("(0, 0.1)]", "(0, 0.1), (0, 0.2)]", "times must increase"),
        (
            "min: (-0.2, 0, 0), max: (0, 1",
            "min: (-0.05, 0, 0), max: (0, 1",
            "water must see",
        ),
        (
            "max: (0, 1, 0.3)",
            "max: (0.1, 1, 0.3)",
            "end the region at its face",
        ),
        (
            "towards: XMax, depth",
            "towards: ZMax, depth",
            "cannot go to ZMax",
        ),
        (
            "time: (duration: 4.0)",
            "time: (duration: 4.0, settle: 1.0)",
            "leave settle out",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let text = CHANNEL.replace(from, to);
        assert_ne!(text, CHANNEL, "{from}");
        let path = written(folder.path(), &text);
        let output = riprap(&["check", path.to_str().unwrap()]);
        // lines are broken to the width of the terminal
        let words: Vec<String> = words(&output)
            .split_whitespace()
            .filter(|word| !matches!(*word, "│" | "·" | "×" | "|"))
            .map(str::to_owned)
            .collect();
        assert!(
            words.join(" ").contains(said),
            "{said}: {}",
            words.join(" ")
        );
        assert_eq!(output.status.code(), Some(2), "{said}");
    }
}

#[test]
fn twenty_gauges_cost_next_to_nothing() {
    let gauges: Vec<String> = (0..5)
        .flat_map(|k| {
            let x = 0.05 + 0.1 * f64::from(k);
            [
                format!("SurfaceElevation(name: \"s{k}\", x: {x}, y: 0.1)"),
                format!("Pressure(name: \"p{k}\", position: ({x}, 0.1, 0.1))"),
                format!("Velocity(name: \"v{k}\", position: ({x}, 0.1, 0.2))"),
                format!("BlockForce(name: \"f{k}\", block: \"right\")"),
            ]
        })
        .collect();
    let (mut world, folder) = world(&tank("Three", &gauges.join(", ")));
    let (scene, _) = scene::load(&folder.path().join("scene.ron"), &[]).unwrap();
    let mut observer =
        riprap::observe::gauges::Gauges::new(folder.path(), &scene, &world, Start::New).unwrap();
    let (mut steps, mut looks) = (0.0, 0.0);
    for _ in 0..60 {
        let start = Instant::now();
        let step = world.next_step(1.0).unwrap();
        world.step(step).unwrap();
        steps += start.elapsed().as_secs_f64();
        let start = Instant::now();
        riprap::observe::Observer::observe(&mut observer, &world).unwrap();
        looks += start.elapsed().as_secs_f64();
    }
    let dt = world.clock().last_dt.unwrap();
    // one look at the gauges per 10 ms, not one a step
    let share = looks / steps * (dt / 0.01);
    println!(
        "{} s a step, {} s a look, {:.3} % of the run at 100 Hz",
        steps / 60.0,
        looks / 60.0,
        100.0 * share
    );
    // measured 0.9 % by itself for these 6000 particles, of which five forces on a wall are most; the share falls
    // with their number. Other tests run at the same time
    assert!(share < 0.03, "{share}");
}

/// A box of `length` by `height` on a floor at its left end, in a plane; m.
fn dam(
    [length, height]: [f64; 2],
    spacing: f64,
    room: [f64; 2],
    fluid: &str,
    rest: &str,
) -> String {
    let (wall, [far, top]) = (5.0 * spacing, room);
    format!(
        "(title: \"dam\", domain: (min: (-{wall}, 0, -{wall}), max: ({far}, 1, {top}), dimensions: Two),
        materials: [(name: \"wall\", density: 2400, friction_angle_deg: 30)],
        blocks: [
            (name: \"floor\", material: \"wall\", motion: Fixed,
             shape: Box(min: (-{wall}, -1, -{wall}), max: ({far}, 2, 0))),
            (name: \"back\", material: \"wall\", motion: Fixed, shape: Box(min: (-{wall}, -1, 0), max: (0, 2, {top}))),
        ],
        fluid: ({fluid}, resolution: Spacing({spacing}),
         regions: [(name: \"dam\", shape: Box(min: (0, 0, 0), max: ({length}, 1, {height})))]),
        {rest}, time: (duration: 5))"
    )
}

/// G13.
#[test]
fn mud_slumps_until_its_yield_stress_holds_it() {
    let (density, yield_stress, side) = (1500.0, 60.0, 0.2);
    let mud = format!(
        "density: {density}, rheology: Bingham(dynamic_viscosity: 8, yield_stress: {yield_stress}, \
         regularization: Bilinear(1000))"
    );
    let spacing = side / 16.0;
    let text = dam(
        [side; 2],
        spacing,
        [1.2, 0.3],
        &mud,
        "interface: (slip: None)",
    );
    let (mut world, _folder) = world(&text);
    advance(&mut world, 2.5);
    let positions = &world.water.as_ref().unwrap().fluid.particles().position;
    let front = positions.iter().map(|x| x.x).fold(0.0, f64::max) + 0.5 * spacing;
    let n = positions.iter().filter(|x| x.x < side).count();
    let depth = n as f64 * spacing * spacing / side;
    // H² = 2 τ (x_f − x)/(ρ g), and as much mud as before: 2/3 √(2 τ/(ρ g)) x_f^1.5
    let root = (2.0 * yield_stress / (density * GRAVITY)).sqrt();
    let exact = (1.5 * side * side / root).powf(2.0 / 3.0);
    let below = |x: f64| 2.0 / 3.0 * root * (exact - x).powf(1.5);
    let exact_depth = (below(0.0) - below(side)) / side;
    println!(
        "G13: front {front:.3} m, {exact:.3} exact; depth of the first fifth {depth:.4} m, {exact_depth:.4} exact"
    );
    // asked 10 %. Measured -2.9 and -3.1 % on implicit steps: it creeps on, and inertia took it a little too far at the rear
    assert!((front / exact - 1.0).abs() < 0.1, "{front}");
    assert!((depth / exact_depth - 1.0).abs() < 0.1, "{depth}");
}

/// S09.
#[test]
fn a_long_dam_breaks_as_shallow_water_does() {
    let (depth, spacing) = (0.2, 0.01);
    let length = 8.0 * depth;
    let text = dam(
        [length, depth],
        spacing,
        [5.0, 0.3],
        "density: 1000",
        "interface: (slip: Free)",
    );
    let (mut world, _folder) = world(&text);
    let unit = (depth / GRAVITY).sqrt();
    let (mut fronts, mut n, mut flow, mut samples) = (Vec::new(), 0, 0.0, 0);
    // the wave that runs back meets the rear wall after 8 units
    for k in 0..=20 {
        advance(&mut world, (4.0 + 0.15 * f64::from(k)) * unit);
        let particles = world.water.as_ref().unwrap().fluid.particles();
        let tip = particles.position.iter().map(|x| x.x).fold(0.0, f64::max);
        fronts.push((world.time(), tip));
        samples += 1;
        for (x, v) in particles.position.iter().zip(&particles.velocity) {
            if (x.x - length).abs() < 0.25 * depth {
                n += 1;
                flow += v.x;
            }
        }
    }
    let per_width = spacing * spacing / (0.5 * depth * f64::from(samples));
    let (height, flow) = (f64::from(n) * per_width, flow * per_width);
    let ((t0, x0), (t1, x1)) = (fronts[0], fronts[fronts.len() - 1]);
    let wave = (GRAVITY * depth).sqrt();
    let front = (x1 - x0) / (t1 - t0) / (2.0 * wave);
    let (height, flow) = (
        height / (4.0 / 9.0 * depth),
        flow / (8.0 / 27.0 * depth * wave),
    );
    println!("S09, over Ritter's: front {front:.3}, depth at the dam {height:.3}, flow {flow:.3}");
    // asked: of the order of 10 % past three units of time
    assert!((height - 1.0).abs() < 0.1, "{height}");
    assert!((flow - 1.0).abs() < 0.1, "{flow}");
    assert!((front - 1.0).abs() < 0.1, "{front}");
}

/// Water that sloshes in a tank: a transducer in a wall reads the mean of the pressure over its face and its while, a gauge at a
/// point single samples of it.
#[test]
fn a_transducer_averages_over_its_face_and_a_while() {
    let text = "(title: \"transducer\", domain: (min: (-0.1, 0, -0.1), max: (1.1, 1, 0.8), dimensions: Two),
        materials: [(name: \"wall\", density: 2400, friction_angle_deg: 30)],
        blocks: [
            (name: \"floor\", material: \"wall\", motion: Fixed, shape: Box(min: (-0.2, -1, -0.2), max: (1.2, 2, 0))),
            (name: \"left\", material: \"wall\", motion: Fixed, shape: Box(min: (-0.2, -1, 0), max: (0, 2, 0.9))),
            (name: \"right\", material: \"wall\", motion: Fixed, shape: Box(min: (1, -1, 0), max: (1.2, 2, 0.9))),
        ],
        fluid: (resolution: Spacing(0.025), regions: [(name: \"tank\", shape: Box(min: (0, 0, 0), max: (1, 1, 0.4)))]),
        time: (duration: 1.0),
        gauges: [
            Pressure(name: \"point\", position: (0, 0.5, 0.1)),
            Pressure(name: \"while\", position: (0, 0.5, 0.1), averaging_time: 0.1),
            Pressure(name: \"face\", position: (0, 0.5, 0.1), diameter: 0.1, averaging_time: 0.1),
            Pressure(name: \"air\", position: (0, 0.5, 0.7), diameter: 0.1, averaging_time: 0.1),
        ],
        output: (gauge_interval: 0.002, frame_interval: 20.0))";
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    run(&written(folder.path(), text), &out, &["--threads", "1"]);
    let rows = table(&out.join("gauges.csv"));
    let end = rows.last().unwrap();
    // a mean of rows 2 ms apart, of steps of a third of that
    let last: Vec<f64> = (rows.iter())
        .filter(|row| end[0] - 0.1 < row[0])
        .map(|row| row[1])
        .collect();
    let of_rows = last.iter().sum::<f64>() / last.len() as f64;
    let still = 1000.0 * GRAVITY * 0.3;
    println!(
        "transducer: {:.1}, face {:.1} of {still:.1} Pa, rows {of_rows:.1}",
        end[2], end[3]
    );
    assert!(
        (end[2] / of_rows - 1.0).abs() < 0.01,
        "{} {of_rows}",
        end[2]
    );
    // pressure is nearly linear over the face; a hundredth is what the still tank misses
    assert!((end[3] / still - 1.0).abs() < 0.02, "{} {still}", end[3]);
    assert!(end[4].is_nan());
}
