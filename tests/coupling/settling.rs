//! Blocks that settle before t = 0, behind gates.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use riprap::checkpoint;
use riprap::run::{Ending, Event, Plan, Run};
use riprap::scene::resolve::Scene;

use crate::support::killed::{difference, results};
use crate::support::scene::{errors, resolved, resolved_in};
use crate::support::{riprap, run, summary, table, words};

/// Springs do not resist the spin of a sphere about its only contact: such a one creeps for long.
const SPEED: f64 = 2e-3;
const DURATION: f64 = 0.4;

/// 300 grains in a box whose right side is a gate; a flap that swings from the start, out of reach; records that begin at the start.
fn grains(settling: &str) -> String {
    format!(
        r#"(
    title: "Grains behind a gate",
    domain: (min: (-1, -1, -1), max: (3, 2, 3)),
    materials: [
        (name: "grain", density: 2500, friction_angle_deg: 30, restitution: 0.2, contact_stiffness: 2e5, rolling_friction: 0.1),
        (name: "bed", density: 2500, friction_angle_deg: 30, restitution: 0.2, contact_stiffness: 2e5, rolling_friction: 0.1),
    ],
    blocks: [
        (name: "floor", material: "bed", motion: Fixed, shape: Box(min: (-0.2, -0.2, -0.2), max: (2.5, 1, 0))),
        (name: "back", material: "bed", motion: Fixed, shape: Box(min: (-0.2, -0.2, 0), max: (0, 1, 1.6))),
        (name: "near", material: "bed", motion: Fixed, shape: Box(min: (0, -0.2, 0), max: (2.5, 0, 1.6))),
        (name: "far", material: "bed", motion: Fixed, shape: Box(min: (0, 0.8, 0), max: (2.5, 1, 1.6))),
        (name: "gate", material: "bed", motion: Fixed, shape: Box(min: (0.8, 0, 0), max: (0.9, 0.8, 1.6))),
        (name: "flap", material: "bed", motion: Sinusoid(direction: (0, 0, 1), amplitude: 0.1, period: 1),
         shape: Box(min: (2, 0.3, 2), max: (2.2, 0.5, 2.2))),
    ],
    grains: [(name: "pile", material: "grain", region: Box(min: (0, 0, 0), max: (0.8, 0.8, 1.6)), diameter: (0.09, 0.1), count: 300)],
    numerics: (block_step_bound: Eigenvalues),
    time: (duration: {DURATION}, {settling}),
    masses: [(name: "pile", blocks: "pile")],
    trajectories: (interval: 0.1),
    counters: [Box(name: "box", min: (-0.1, -0.1, -0.1), max: (0.85, 0.9, 2), blocks: "pile")],
    output: (frame_interval: 0.1, ledger_interval: 0.05),
)"#
    )
}

fn settled() -> String {
    grains(&format!(
        r#"settle_blocks: (speed: {SPEED}, time: 0.1, at_most: 10, gates: ["ga*"])"#
    ))
}

fn scene(text: &str) -> Scene {
    let scene = resolved(text).unwrap_or_else(|problems| panic!("{problems:?}"));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    scene
}

/// Floor, walls and gate bear the weight, nothing moves, the clock stands; without its gate the pile fails, and its account closes.
#[test]
fn grains_lie_behind_a_gate_that_is_gone_at_the_start() {
    let mut scene = scene(&settled());
    let mut run = Run::in_memory(&mut scene).unwrap();
    let number = |name: &str| {
        let names = &run.scene().block_names;
        names.iter().position(|n| n == name).unwrap()
    };
    let (gate, flap) = (number("gate"), number("flap"));
    let blocks = &run.world().blocks;
    let all = || 0..blocks.n_blocks();
    let free: Vec<usize> = all().filter(|&b| blocks.is_free(b)).collect();
    let fixed: Vec<usize> = all().filter(|&b| blocks.is_fixed(b)).collect();
    assert_eq!((free.len(), fixed.len()), (300, 5));
    let flap_at = blocks.centroid(flap);
    // on the fixed blocks, and on the gate along the flow
    let mut borne = (0.0, 0.0);
    loop {
        run.step().unwrap();
        let blocks = &run.world().blocks;
        assert_eq!(run.world().time(), 0.0);
        if !run.is_settling() {
            break;
        }
        assert_eq!(blocks.velocity(flap).norm(), 0.0);
        let down = fixed.iter().map(|&b| -blocks.contact_force(b).force.z);
        borne = (down.sum::<f64>(), blocks.contact_force(gate).force.x);
    }
    let world = run.world();
    let blocks = &world.blocks;
    assert_eq!(world.clock().steps, 0);
    let weight: f64 = free.iter().map(|&b| blocks.mass(b) * 9.81).sum();
    let (bears, on_gate) = (borne.0 / weight, borne.1);
    println!(
        "{bears} of the weight is borne, the gate has {} of it",
        on_gate / weight
    );
    // what moves at 2e-3 m/s for 0.1 s is accelerated by 2e-3 g at most in the mean, most of it by far less
    assert!((bears - 1.0).abs() < 1e-3, "{bears}");
    // a pile of 6 x 6 x 8 grains presses sideways with some tenths of its weight
    assert!(0.05 * weight < on_gate && on_gate < weight, "{on_gate}");
    assert!(blocks.is_removed(gate) && blocks.contact_force(gate).force.norm() == 0.0);
    let fastest = free.iter().map(|&b| blocks.velocity(b).norm());
    assert!(fastest.fold(0.0, f64::max) <= SPEED);
    // the flap swings from now on, at its largest speed
    assert_eq!(blocks.centroid(flap), flap_at);
    let swing = 0.1 * std::f64::consts::TAU;
    assert!((blocks.velocity(flap).z / swing - 1.0).abs() < 1e-12);
    let before = world.energy();
    assert_eq!(
        (before.friction, before.damping, before.residual),
        (0.0, 0.0, 0.0)
    );
    while !run.is_over() {
        run.step().unwrap();
    }
    let blocks = &run.world().blocks;
    let out = free.iter().filter(|&&b| 0.9 < blocks.centroid(b).x).count();
    // what fails first falls for 0.4 s, 0.8 m at most; measured 14
    assert!(5 < out, "{out} grains flowed out");
    let energy = run.world().energy();
    let released = before.potential - energy.potential;
    println!(
        "{out} out, residual {:.2e} of {released:.1} J",
        energy.residual
    );
    // measured 9e-4 of what was released, with impacts in single steps
    assert!(
        energy.residual.abs() < 3e-3 * released,
        "{}",
        energy.residual
    );
}

/// A run with records, stopped after some steps of settling or of running; what it told.
fn stopped(text: &str, folder: &Path, is_enough: impl Fn(bool, u64) -> bool) -> Vec<String> {
    let mut scene = resolved_in(folder, text).unwrap();
    let scene_text = scene.to_text().unwrap();
    std::fs::write(folder.join("case.ron"), &scene_text).unwrap();
    let hash = checkpoint::scene_hash(&scene_text);
    let from = checkpoint::newest(folder, &hash).unwrap();
    let plan = Plan {
        from: from.map(|(checkpoint, _)| checkpoint),
        scene_hash: hash,
        ..Plan::new(folder)
    };
    let (stop, mut told) = (AtomicBool::new(false), Vec::new());
    let (summary, ending) = riprap::run::run(&mut scene, plan, &stop, &mut |event| match event {
        Event::Step(progress) if is_enough(progress.is_settling, progress.steps) => {
            stop.store(true, Ordering::Relaxed);
        }
        Event::Settled(found) => told.push(format!("{found:?}")),
        _ => {}
    })
    .unwrap();
    assert_eq!(ending == Ending::Completed, summary.completed);
    told
}

/// In one piece, on another number of threads, and in four pieces, cut while it settles and while it runs: the same bits in all files.
#[test]
fn a_settled_run_in_pieces_is_the_same_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("grains.ron");
    std::fs::write(&file, settled()).unwrap();
    let outs = ["one", "two"].map(|threads| folder.path().join(threads));
    for (out, threads) in outs.iter().zip(["1", "2"]) {
        run(&file, out, &["--threads", threads]);
    }
    let whole = results(&outs[0]);
    assert_eq!(difference(&results(&outs[1]), &whole), None);
    let found = &summary(&outs[0])["settled_blocks"];
    println!("{found}");
    assert_eq!(found["at_rest"], true);
    let steps = found["steps"].as_u64().unwrap();
    // random loose packings of frictional spheres fill 0.55 to 0.64; walls are near
    let solid = found["solid_fraction"].as_f64().unwrap();
    assert!((0.5..0.66).contains(&solid), "{solid}");
    // records begin where the grains lie
    let masses = table(&outs[0].join("masses.csv"));
    assert_eq!(masses[0][0], 0.0);
    assert_eq!(masses[0][6], 0.0, "run-out of the pile at t = 0");

    let pieces = folder.path().join("pieces");
    std::fs::create_dir(&pieces).unwrap();
    let text = settled();
    let mut told = stopped(&text, &pieces, |settles, n| settles && steps / 3 <= n);
    told.extend(stopped(&text, &pieces, |settles, n| {
        settles && steps / 2 <= n
    }));
    assert!(told.is_empty(), "{told:?}");
    told.extend(stopped(&text, &pieces, |settles, n| !settles && 100 <= n));
    told.extend(stopped(&text, &pieces, |settles, n| !settles && 200 <= n));
    told.extend(stopped(&text, &pieces, |_, _| false));
    assert_eq!(told.len(), 1, "{told:?}");
    for name in [
        "energy.csv",
        "blocks.csv",
        "masses.csv",
        "trajectories.csv",
        "rockfall.csv",
        "counters.csv",
        "bodies.csv",
    ] {
        let found = std::fs::read(pieces.join(name)).unwrap();
        assert!(found == whole[name], "{name} differs");
    }
    let [ended, expected] = [&pieces, &outs[0]].map(|out| summary(out));
    for key in [
        "state_hash",
        "steps",
        "settled_blocks",
        "energy",
        "counters",
    ] {
        assert_eq!(ended[key], expected[key], "{key}");
    }
}

/// Time that is not enough is told, with the speed that is left; the run goes on.
#[test]
fn grains_that_still_move_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("grains.ron");
    std::fs::write(&file, settled().replace("at_most: 10", "at_most: 0.15")).unwrap();
    let check = riprap(&["check", file.to_str().unwrap()]);
    let told = String::from_utf8_lossy(&check.stdout).into_owned() + &words(&check);
    assert!(
        told.contains("nothing is faster than 0.002 m/s for 0.1 s, 0.15 s at most, behind `gate`, removed at t = 0"),
        "{told}"
    );
    let out = folder.path().join("out");
    let output = riprap(&[
        "run",
        file.to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
        "--until",
        "0.01",
    ]);
    let told = words(&output);
    assert!(output.status.success(), "{told}");
    assert!(
        told.contains("s of settling the fastest block still has")
            && told.contains("[still-moving]"),
        "{told}"
    );
    let found = &summary(&out)["settled_blocks"];
    assert_eq!(found["at_rest"], false);
    // it has fallen for that time at most
    let fastest = found["fastest"].as_f64().unwrap();
    assert!(SPEED < fastest && fastest < 0.2 * 9.81, "{fastest}");
}

#[test]
fn what_cannot_settle_is_refused() {
    let water = r#"fluid: (resolution: Spacing(0.1), regions: [(name: "sea", shape: Box(min: (1, 0, 0), max: (2, 0.8, 0.4)))]), time:"#;
    for (old, new, told) in [
        (
            r#""ga*""#,
            r#""door""#,
            "time.settle_blocks.gates[0]: no block is called `door`",
        ),
        (
            r#""ga*""#,
            r#""pile_0001""#,
            "time.settle_blocks.gates[0]: gate `pile_0001` is not fixed",
        ),
        (
            r#""ga*""#,
            r#""flap""#,
            "time.settle_blocks.gates[0]: gate `flap` is not fixed",
        ),
        (
            "time:",
            water,
            "time.settle_blocks: water is filled in around blocks where they are drawn",
        ),
        (
            "count: 300",
            "count: 300, velocity: (1, 0, 0)",
            "time.settle_blocks: block `pile_0001` has a velocity",
        ),
        (
            "time:",
            r#"barriers: [(name: "wall", blocks: ["gate"], flow: (1, 0, 0))], time:"#,
            "time.settle_blocks.gates[0]: gate `gate` is removed at t = 0 and belongs to barrier `wall`",
        ),
        (
            "time:",
            r#"attachments: [PointLoad(block: "gate", point: (0.85, 0.4, 0.5), force: (1, 0, 0))], time:"#,
            "time.settle_blocks.gates[0]: gate `gate` is removed at t = 0 and belongs to an attachment",
        ),
    ] {
        let text = settled().replacen(old, new, 1);
        assert_ne!(text, settled());
        let found = errors(&text);
        assert!(
            found.iter().any(|line| line.contains(told)),
            "{told}: {found:?}"
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("grains.ron");
    for (old, new, told) in [
        ("speed: 0.002", "speed: 0", "speed at rest"),
        (
            "at_most: 10",
            "at_most: 0.05",
            "longest settling must be at least the time at rest of 0.1 s",
        ),
    ] {
        std::fs::write(&file, settled().replacen(old, new, 1)).unwrap();
        let output = riprap(&["check", file.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(2));
        assert!(words(&output).contains(told), "{}", words(&output));
    }
}
