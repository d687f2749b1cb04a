//! Random scenes of blocks, water and gauges: each is refused with words or takes fifty steps to a finite state.
//!
//! `PROPTEST_CASES=2000 cargo test --release --test coupling random_scenes` tries more of them; what fails is kept beside this file.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::Duration;

use proptest::prelude::*;
use proptest::test_runner::{FileFailurePersistence, RngAlgorithm, TestRng, TestRunner};
use riprap::memory::Available;
use riprap::run::{Event, Plan, RunError, run};
use riprap::scene;
use riprap::scene::access::{Access, FilesFrom};

/// Few enough for continuous integration.
const CASES: u32 = 60;
/// Steps that each scene takes.
const STEPS: u64 = 50;
/// So that a case takes a fraction of a second: some two thousand particles.
const MEMORY: u64 = 60_000_000;

/// A number of three digits: what fails can be read.
fn number(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    range.prop_map(|x| (x * 1e3).round() / 1e3)
}

fn place(low: [f64; 3], high: [f64; 3]) -> impl Strategy<Value = String> {
    (
        number(low[0]..high[0]),
        number(low[1]..high[1]),
        number(low[2]..high[2]),
    )
        .prop_map(|(x, y, z)| format!("({x:?}, {y:?}, {z:?})"))
}

/// A body about the origin, no larger than some tenths of a meter.
fn shape() -> impl Strategy<Value = String> {
    let size = || number(0.05..0.3);
    let extent = || (size(), size(), size());
    let points = prop::collection::vec(place([-0.2; 3], [0.2; 3]), 4..9);
    prop_oneof![
        3 => extent().prop_map(|(x, y, z)| format!("Box(min: (0, 0, 0), max: ({x:?}, {y:?}, {z:?}))")),
        1 => extent().prop_map(|(x, y, z)| format!("Wedge(length: {x:?}, height: {z:?}, width: {y:?})")),
        2 => points.prop_map(|points| format!("Hull(points: [{}])", points.join(", "))),
        2 => number(0.03..0.2).prop_map(|r| format!("Sphere(center: (0, 0, 0), radius: {r:?})")),
        1 => (size(), size()).prop_map(|(a, b)| format!(
            "Extrusion(polygon: [(0, 0), ({a:?}, 0), ({a:?}, {b:?}), (0, {b:?})], axis: Y, from: 0, to: {a:?})"
        )),
        1 => size().prop_map(|a| format!(
            "Polyhedra(parts: [(vertices: [(0, 0, 0), ({a:?}, 0, 0), (0, {a:?}, 0), (0, 0, {a:?})], \
             faces: [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])])"
        )),
    ]
}

fn motion() -> impl Strategy<Value = String> {
    prop_oneof![
        5 => Just("Free".to_owned()),
        2 => Just("Fixed".to_owned()),
        1 => (number(0.01..0.2), number(0.1..2.0), number(0.0..360.0)).prop_map(|(amplitude, period, phase)| format!(
            "Sinusoid(direction: (1, 0, 0.5), amplitude: {amplitude:?}, period: {period:?}, phase_deg: {phase:?})"
        )),
    ]
}

/// The rest of the entry of a block that moves freely; spheres do not deform.
fn extras() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => Just(String::new()),
        1 => place([-1.0; 3], [1.0; 3]).prop_map(|v| format!("velocity: {v}, ")),
        1 => place([-9.0; 3], [9.0; 3]).prop_map(|w| format!("angular_velocity: {w}, ")),
        1 => Just("deformable: (), ".to_owned()),
        1 => Just("deformable: (model: Corotational), ".to_owned()),
        1 => Just("hold: (directions: [X, Y], turning: Held), ".to_owned()),
        1 => Just("sealed: true, ".to_owned()),
    ]
}

/// Bodies that mostly keep clear of each other: each has a place of its own, two layers of three.
fn blocks() -> impl Strategy<Value = Vec<String>> {
    let turn = (place([-1.0; 3], [1.0; 3]), number(-180.0..180.0));
    let entry = (
        shape(),
        motion(),
        extras(),
        [number(0.1..0.2), number(0.1..0.35), number(0.0..0.2)],
        prop::option::weighted(0.4, turn),
    );
    prop::collection::vec(entry, 0..6).prop_map(|entries| {
        let mut blocks = Vec::new();
        for (k, (shape, motion, extras, at, turn)) in entries.into_iter().enumerate() {
            let rotate = turn.map_or(String::new(), |(axis, angle)| {
                format!("rotate: (axis: {axis}, angle_deg: {angle:?}, about: (0.1, 0.1, 0.1)), ")
            });
            let is_ball = shape.starts_with("Sphere");
            let extras = match motion.as_str() {
                "Free" if !(is_ball && extras.starts_with("deformable")) => extras,
                _ => String::new(),
            };
            let [x, y, z] = at;
            let (x, z) = (x + 0.45 * (k % 3) as f64, z + 0.6 * (k / 3) as f64);
            blocks.push(format!(
                "(name: \"b{k}\", material: \"rock\", {extras}motion: {motion}, \
                 placement: ({rotate}translate: ({x:.3}, {y:.3}, {z:.3})), shape: {shape})"
            ));
        }
        blocks
    })
}

/// A tank round the domain, which closes basins.
const TANK: &str = r#"
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.3, -0.3, -0.3), max: (1.8, 1.1, 0))),
        (name: "left", material: "rock", motion: Fixed, shape: Box(min: (-0.3, -0.3, 0), max: (0, 1.1, 1.4))),
        (name: "right", material: "rock", motion: Fixed, shape: Box(min: (1.5, -0.3, 0), max: (1.8, 1.1, 1.4))),
        (name: "front", material: "rock", motion: Fixed, shape: Box(min: (0, -0.3, 0), max: (1.5, 0, 1.4))),
        (name: "back", material: "rock", motion: Fixed, shape: Box(min: (0, 0.8, 0), max: (1.5, 1.1, 1.4))),"#;

fn region() -> impl Strategy<Value = String> {
    let seed = place([0.1, 0.1, 0.05], [1.4, 0.7, 0.3]);
    let corner = (number(0.1..0.6), number(0.1..0.3), number(0.1..0.5));
    let extent = (number(0.1..0.8), number(0.1..0.4), number(0.1..0.6));
    prop_oneof![
        3 => (number(0.2..0.9), seed).prop_map(|(level, seed)| format!("Below(level: {level:?}, seed: {seed})")),
        2 => (corner, extent).prop_map(|((x, y, z), (a, b, c))| {
            format!("Box(min: ({x:?}, {y:?}, {z:?}), max: ({:?}, {:?}, {:?}))", x + a, y + b, z + c)
        }),
    ]
}

fn resolution() -> impl Strategy<Value = String> {
    prop_oneof![
        3 => number(0.06..0.2).prop_map(|spacing| format!("Spacing({spacing:?})")),
        1 => (50_u32..1500).prop_map(|count| format!("Count({count})")),
    ]
}

fn fluid() -> impl Strategy<Value = String> {
    let rheology = prop_oneof![
        6 => Just(String::new()),
        1 => Just("rheology: Newtonian(dynamic_viscosity: 2.0), ".to_owned()),
        1 => Just("rheology: Bingham(dynamic_viscosity: 1.0, yield_stress: 50.0, \
                   regularization: Papanastasiou(0.1)), ".to_owned()),
    ];
    (
        resolution(),
        region(),
        choice(&[
            "",
            "",
            ", (name: \"above\", shape: Box(min: (0.4, 0.2, 1), max: (1.2, 0.6, 1.3)))",
        ]),
        rheology,
    )
        .prop_map(|(resolution, region, above, rheology)| {
            format!(
                "fluid: ({rheology}resolution: {resolution}, regions: [(name: \"water\", shape: {region}){above}]),"
            )
        })
}

fn gauge() -> impl Strategy<Value = String> {
    let at = || place([0.0; 3], [1.5, 0.8, 1.4]);
    let line = || {
        (
            number(0.0..1.5),
            number(0.0..0.8),
            number(0.0..1.5),
            number(0.0..0.8),
        )
    };
    prop_oneof![
        (number(0.0..1.5), number(0.0..0.8))
            .prop_map(|(x, y)| format!("SurfaceElevation(name: \"?\", x: {x:?}, y: {y:?})")),
        at().prop_map(|at| format!("Pressure(name: \"?\", position: {at})")),
        at().prop_map(|at| format!("Velocity(name: \"?\", position: {at})")),
        line().prop_map(|(a, b, c, d)| format!(
            "RunUp(name: \"?\", from: ({a:?}, {b:?}), to: ({c:?}, {d:?}))"
        )),
        line().prop_map(|(a, b, c, d)| format!(
            "Front(name: \"?\", from: ({a:?}, {b:?}), to: ({c:?}, {d:?}))"
        )),
        Just("BlockForce(name: \"?\", block: \"floor\")".to_owned()),
        Just("PointMotion(name: \"?\", block: \"floor\", point: (0.0, 0.0, 0.0))".to_owned()),
        Just("Displaced(name: \"?\", blocks: \"\", farther_than: 0.1)".to_owned()),
    ]
}

fn choice(values: &'static [&'static str]) -> impl Strategy<Value = String> {
    prop::sample::select(values).prop_map(str::to_owned)
}

fn numerics() -> impl Strategy<Value = String> {
    (
        choice(&[
            "Standard",
            "Standard",
            "Preview",
            "Reference",
            "Mueller2003",
        ]),
        choice(&[
            "",
            "",
            "",
            "stepping: PredictorCorrector, ",
            "stepping: SymplecticEuler, ",
            "precision: Double, ",
            "shifting: Fickian(1.0), ",
            "viscosity: Laminar, ",
            "viscosity: Morris, viscous_step: Implicit, ",
            "kernel: CubicSpline, ",
            "state_equation: Tait, ",
        ]),
        choice(&[
            "",
            "",
            "contact_detection: FastCommonPlane, ",
            "normal_law: Hertz, ",
        ]),
        choice(&[
            "",
            "",
            "walls: Penalty, ",
            "walls: Integral, ",
            "walls: Particles, ",
        ]),
        choice(&[
            "",
            "slip: Rough(0.002), ",
            "slip: None, ",
            "slip: Friction(20), ",
        ]),
    )
        .prop_map(|(preset, scheme, contact, walls, slip)| {
            format!("interface: ({walls}{slip}), numerics: (preset: {preset}, {scheme}{contact}),")
        })
}

/// A scene as text, so that it takes the way that a user's does.
fn scene_text() -> impl Strategy<Value = String> {
    let domain = choice(&[
        "",
        "",
        "",
        "periodic: [Y], ",
        "dimensions: Two, ",
        "leaving: Fail, ",
        "symmetry: [YMin], ",
    ]);
    let gravity = choice(&[
        "",
        "",
        "",
        "gravity: (0, 0, 0), ",
        "gravity: (1.5, 0, -9.81), ",
    ]);
    let gauges = prop::collection::vec(gauge(), 0..4);
    let settle = choice(&["", "", "", ", settle: 0.02"]);
    (blocks(), prop::option::weighted(0.75, fluid()), gauges, numerics(), (domain, gravity, settle)).prop_map(
        |(blocks, fluid, gauges, numerics, (domain, gravity, settle))| {
            // what is mirrored is water
            let domain = if fluid.is_none() && domain.starts_with("symmetry") {
                ""
            } else {
                &domain
            };
            let gauges: Vec<String> = gauges
                .iter()
                .enumerate()
                .map(|(k, gauge)| gauge.replace('?', &format!("g{k}")))
                .collect();
            format!(
                "(title: \"random\", {gravity}domain: (min: (0, 0, 0), max: (1.5, 0.8, 1.4), {domain}),\n\
                 materials: [(name: \"rock\", density: 2400, friction_angle_deg: 30, \
                 elastic: (young_modulus: 1e7, poisson_ratio: 0.2))],\n\
                 blocks: [{TANK}\n{}],\n{}\n{numerics}\ngauges: [{}],\ntime: (duration: 1{settle}),\n\
                 output: (frame_interval: 0.2, gauge_interval: 0.001))",
                blocks.join(",\n"),
                fluid.unwrap_or_default(),
                gauges.join(", "),
            )
        },
    )
}

fn small_machine() -> Access<'static> {
    Access {
        folder: Path::new("."),
        files: FilesFrom::SceneFolder,
        memory: Some(Available { bytes: MEMORY }),
    }
}

/// Steps a scene and looks at what it leaves. Whether it took all its steps; it may be refused, or stop, with words.
fn fifty_steps(text: &str) -> Result<bool, TestCaseError> {
    let mut scene = match scene::load_text("random.ron", text, &[], &small_machine()) {
        Ok((scene, _)) => scene,
        Err(error) => {
            let words = error.to_string();
            prop_assert!(
                words.contains("random.ron:") && words.len() > 30,
                "refused without a reason: {words}"
            );
            return Ok(false);
        }
    };
    let folder = tempfile::tempdir().unwrap();
    let stop = AtomicBool::new(false);
    let mut fastest = 0.0;
    let plan = Plan {
        checkpoint_interval: Duration::ZERO,
        ..Plan::new(folder.path())
    };
    let ended = run(&mut scene, plan, &stop, &mut |event| {
        let Event::Step(progress) = event else {
            return;
        };
        fastest = progress.fastest;
        // settling has steps of its own
        if STEPS <= progress.steps && !progress.is_settling {
            stop.store(true, Ordering::Relaxed);
        }
    });
    let has_stepped = match ended {
        Ok((summary, _)) => {
            prop_assert!(f64::is_finite(fastest), "the fastest is {fastest} m/s");
            prop_assert!(
                summary.momentum_residual.is_finite(),
                "{}",
                summary.momentum_residual
            );
            for file in ["summary.json", "gauges.csv", "energy.csv"] {
                prop_assert!(folder.path().join(file).is_file(), "{file} is missing");
            }
            let energy = std::fs::read_to_string(folder.path().join("energy.csv")).unwrap();
            prop_assert!(
                !energy.contains("inf") && !energy.contains("NaN"),
                "{energy}"
            );
            true
        }
        // what leaves the domain stops a scene that asks for it, and what goes too fast stops any
        Err(
            error @ (RunError::Step(_)
            | RunError::Unstable { .. }
            | RunError::Examined { .. }
            | RunError::Fluid(_)
            | RunError::Blocks(_)),
        ) => {
            let words = error.to_string();
            prop_assert!(words.len() > 20, "stopped without a reason: {words}");
            false
        }
        Err(error) => return Err(TestCaseError::fail(error.to_string())),
    };
    Ok(has_stepped)
}

#[test]
fn a_random_scene_is_refused_with_words_or_runs() {
    let asked = std::env::var("PROPTEST_CASES")
        .ok()
        .and_then(|n| n.parse().ok());
    let cases = asked.unwrap_or(CASES);
    let config = ProptestConfig {
        cases,
        max_shrink_iters: 300,
        // a test runs in its crate's folder
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(
            "../tests/coupling/random_scenes.proptest-regressions",
        ))),
        ..ProptestConfig::default()
    };
    let stepped = AtomicU32::new(0);
    // the same ones each time, or as many new ones as are asked for
    let mut runner = match asked {
        None => TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha)),
        Some(_) => TestRunner::new(config),
    };
    let found = runner.run(&scene_text(), |text| {
        let has_stepped = fifty_steps(&text)?;
        stepped.fetch_add(u32::from(has_stepped), Ordering::Relaxed);
        Ok(())
    });
    if let Err(failure) = found {
        panic!("{failure}");
    }
    // a third of what is made makes sense: refusals alone would show little
    let stepped = stepped.into_inner();
    println!("{stepped} of {cases} took {STEPS} steps");
    assert!(cases < 4 * stepped, "{stepped} of {cases}");
}

/// Found by random scenes: the search for the acceleration of a free block asked for viscosities before there were any,
/// and later for those of the step before, in that step's order.
#[test]
fn water_rubs_along_a_free_block() {
    for (rheology, slip) in [
        ("", "Friction(20)"),
        ("", "Rough(0.001)"),
        ("rheology: Newtonian(dynamic_viscosity: 2), ", "None"),
        (
            "rheology: Newtonian(dynamic_viscosity: 2), ",
            "Friction(20)",
        ),
    ] {
        let text = format!(
            "(title: \"rubs\", domain: (min: (0, 0, 0), max: (1.5, 0.8, 1.4)),
              materials: [(name: \"rock\", density: 2400, friction_angle_deg: 30)],
              blocks: [{TANK} (name: \"a\", material: \"rock\", shape: Box(min: (0.1, 0.1, 0), max: (0.2, 0.2, 0.1)))],
              fluid: ({rheology}resolution: Spacing(0.06),
                      regions: [(name: \"water\", shape: Below(level: 0.5, seed: (0.7, 0.4, 0.2)))]),
              interface: (slip: {slip}), time: (duration: 1))"
        );
        assert!(fifty_steps(&text).unwrap(), "{slip}");
    }
}
