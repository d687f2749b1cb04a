//! Scenes of blocks alone: deformable blocks, loads, bolts, holds, base shaking, damping.

use std::path::Path;

use crate::support::{riprap, run, table, words};
use riprap::output::run_folder;

/// A scene with the given blocks and further fields.
fn scene(folder: &Path, blocks: &str, further: &str) -> std::path::PathBuf {
    let path = folder.join("scene.ron");
    let text = format!(
        r#"(
    title: "blocks",
    domain: (min: (-20, -20, -20), max: (20, 20, 20)),
    materials: [(name: "rock", density: 2600, friction_angle_deg: 30, contact_stiffness: 1e9,
                 elastic: (young_modulus: 1e9, poisson_ratio: 0.25, viscosity: 2e5))],
    blocks: [{blocks}],
    {further}
)"#
    );
    std::fs::write(&path, text).unwrap();
    path
}

/// Last row of `blocks.csv` of a block.
fn last_row(folder: &Path, block: f64) -> Vec<f64> {
    let rows = table(&folder.join("blocks.csv"));
    rows.into_iter().rfind(|row| row[1] == block).unwrap()
}

const FLOOR: &str = r#"(name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-9, -9, -1), max: (9, 9, 0)))"#;

/// A deformable block under its weight and a pressure on its top settles as its moduli say; its stress is in the
/// frames.
#[test]
fn deformable_block_under_pressure() {
    let folder = tempfile::tempdir().unwrap();
    let blocks = format!(
        r#"{FLOOR}, (name: "pillar", material: "rock", shape: Box(min: (0, 0, 0), max: (1, 1, 2)),
            deformable: (model: Corotational))"#
    );
    let further = r#"attachments: [Pressure(block: "pillar", face: (0, 0, 1), pressure: 1e5)],
        time: (duration: 0.5), output: (frame_interval: 0.5)"#;
    let out = folder.path().join("out");
    let summary = run(&scene(folder.path(), &blocks, further), &out, &[]);
    // centroid: contact overlap (m g + p A)/K and half of (p + ρ g H/2) H/E
    let (load, stress) = (2600.0 * 2.0 * 9.81 + 1e5, 1e5 + 2600.0 * 9.81);
    let expected = load / 1e9 + stress * 1.0 / 1e9;
    let found = 1.0 - last_row(&out, 1.0)[4];
    println!("centroid {found:.6e} m lower, expected {expected:.6e}");
    // 0.3 %: friction at the base holds back some of the lateral strain
    assert!((found / expected - 1.0).abs() < 3e-3);
    let energy = &summary["energy"];
    assert!(energy["strain"].as_f64().unwrap() > 0.0);
    assert!(energy["strain_damping"].as_f64().unwrap() > 0.0);
    let frame = std::fs::read(out.join("blocks_00001.vtp")).unwrap();
    assert!(String::from_utf8_lossy(&frame).contains("Name=\"Stress\" NumberOfComponents=\"6\""));
}

/// A block hangs from a rock bolt: its tension is the weight, and the block does not turn away.
#[test]
fn hung_from_a_bolt() {
    let folder = tempfile::tempdir().unwrap();
    let blocks = r#"(name: "roof", material: "rock", motion: Fixed, shape: Box(min: (-2, -2, 3), max: (2, 2, 4))),
        (name: "key", material: "rock", shape: Box(min: (-0.5, -0.5, 1), max: (0.5, 0.5, 2)),
         hold: (directions: [X, Y], turning: Held))"#;
    let further = r#"attachments: [RockBolt(from: "roof", from_point: (0, 0, 3.5), to: "key", to_point: (0, 0, 1.5),
            stiffness: 1e7, pretension: 0, yield_force: 1e6)],
        numerics: (static_damping: MassProportional(20)),
        time: (duration: 2)"#;
    let out = folder.path().join("out");
    let summary = run(&scene(folder.path(), blocks, further), &out, &[]);
    let sunk = 1.5 - last_row(&out, 1.0)[4];
    let expected = 2600.0 * 9.81 / 1e7;
    println!("hangs {sunk:.6e} m lower, expected {expected:.6e}");
    assert!((sunk / expected - 1.0).abs() < 1e-6);
    assert!(summary["energy"]["static_damping"].as_f64().unwrap() > 0.0);
    println!("momentum residual {}", summary["momentum_residual"]);
    assert!(summary["momentum_residual"].as_f64().unwrap() < 1e-9);
}

/// Base shaking from a record: a block stuck to the base follows it.
#[test]
fn base_shaking_from_a_record() {
    let folder = tempfile::tempdir().unwrap();
    // a = sin 2πt m/s² for a second and silence: the base ends at 1/(2π) m, moving no more
    let record: String = (0..=2000)
        .map(|k| {
            let t = f64::from(k) * 1e-3;
            let a = if t < 1.0 {
                (std::f64::consts::TAU * t).sin()
            } else {
                0.0
            };
            format!("{t},{a}\n")
        })
        .collect();
    std::fs::write(
        folder.path().join("quake.csv"),
        format!("# t [s], a [m/s2]\n{record}"),
    )
    .unwrap();
    let blocks = r#"(name: "base", material: "rock", motion: Shaking(direction: (1, 0, 0), file: "quake.csv"),
            shape: Box(min: (-9, -9, -1), max: (9, 9, 0))),
        (name: "slab", material: "rock", shape: Box(min: (-1, -1, 0), max: (1, 1, 0.2)))"#;
    let out = folder.path().join("out");
    run(
        &scene(folder.path(), blocks, "time: (duration: 1.5)"),
        &out,
        &[],
    );
    let (base, slab) = (last_row(&out, 0.0), last_row(&out, 1.0));
    let expected = 1.0 / std::f64::consts::TAU;
    println!("base at {:.6} m, slab at {:.6} m", base[2], slab[2]);
    // trapezoids of a sine in 1000 steps: 1e-6
    assert!((base[2] / expected - 1.0).abs() < 1e-5);
    // mu g = 5.7 m/s² > 1 m/s²: it sticks, and the contact springs swing out
    assert!((slab[2] - base[2]).abs() < 1e-5);
}

#[test]
fn wrong_attachments_are_explained_in_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let block = r#"(name: "stone", material: "rock", shape: Box(min: (0, 0, 0), max: (1, 1, 1)))"#;
    for (blocks, further, expected) in [
        (
            block.to_owned(),
            r#"attachments: [PointLoad(block: "ston", point: (0, 0, 0), force: (1, 0, 0))],"#,
            "attachment: there is no block `ston`, did you mean `stone`?",
        ),
        (
            block.replace("1)))", "1)), motion: Fixed, deformable: ())"),
            "",
            "block `stone`: it must be a free block of polyhedra; leave deformable out",
        ),
        (
            block.replace("1)))", "1)), hold: (directions: [X, X]))"),
            "",
            "block `stone`: hold X is listed twice",
        ),
        (
            block.to_owned(),
            "numerics: (static_damping: Local(1.0)),",
            "local damping must be in [0, 1), found 1",
        ),
        (
            block.replace(
                "1)))",
                "1)), motion: Shaking(direction: (1, 0, 0), file: \"no.csv\"))",
            ),
            "",
            "`no.csv`: cannot be read",
        ),
    ] {
        let further = format!("{further} time: (duration: 1)");
        let path = scene(folder.path(), &blocks, &further);
        let output = riprap(&["check", path.to_str().unwrap()]);
        let said = words(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.contains(expected) && said.contains("scene.ron:"),
            "{said}"
        );
    }
}

/// Three joint sets at right angles cut a box into 2 x 3 x 4 blocks, which then are blocks like others.
#[test]
fn rock_mass_cut_by_joints() {
    let folder = tempfile::tempdir().unwrap();
    let further = r#"rock_masses: [(name: "mass", material: "rock", boundary: Box(min: (0, 0, 0), max: (2, 3, 4)),
            joint_sets: [(dip_deg: 90, dip_direction_deg: 90, spacing: 1),
                         (dip_deg: 90, dip_direction_deg: 0, spacing: 1),
                         (dip_deg: 0, dip_direction_deg: 0, spacing: 1)])],
        time: (duration: 0.05)"#;
    let path = scene(folder.path(), FLOOR, further);
    let output = riprap(&["check", path.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        said.contains("`mass`: 24 blocks of 1.000e0 to 1.000e0 m3"),
        "{said}"
    );
    let out = folder.path().join("out");
    let summary = run(&path, &out, &[]);
    assert_eq!(summary["free_blocks"], 24);
    // case.ron makes the same blocks and runs alike
    let again = run(&out.join("case.ron"), &folder.path().join("again"), &[]);
    assert_eq!(summary["state_hash"], again["state_hash"]);
    can_be_edited(&out);
    let close = further.replace(
        "dip_deg: 0, dip_direction_deg: 0, spacing: 1",
        "dip_deg: 0, dip_direction_deg: 0, spacing: 1e-5",
    );
    let output = riprap(&[
        "check",
        scene(folder.path(), FLOOR, &close).to_str().unwrap(),
    ]);
    assert!(
        words(&output).contains("joint set 2 has the closest joints"),
        "{}",
        words(&output)
    );
}

/// A sphere slides on a floor: what its material makes of the floor's holds, or the joint of the two.
#[test]
fn a_joint_of_two_materials() {
    let folder = tempfile::tempdir().unwrap();
    let path = |joints: &str| {
        let path = folder.path().join("slide.ron");
        let text = format!(
            r#"(title: "slide", domain: (min: (-9, -9, -9), max: (9, 9, 9)),
                materials: [(name: "glass", density: 2500, friction_angle_deg: 20, contact_stiffness: 1e7),
                            (name: "wall", density: 2500, friction_angle_deg: 30, contact_stiffness: 1e7)],
                joints: [{joints}],
                blocks: [(name: "floor", material: "wall", motion: Fixed, shape: Box(min: (-9, -9, -1), max: (9, 9, 0))),
                         (name: "ball", material: "glass", velocity: (3, 0, 0), shape: Sphere(center: (0, 0, 0.1), radius: 0.1))],
                time: (duration: 0.1), output: (ledger_interval: 0.05))"#
        );
        std::fs::write(&path, text).unwrap();
        path
    };
    for (joints, angle) in [
        ("", 20.0_f64),
        (
            r#"(between: ("glass", "wall"), friction_angle_deg: 35)"#,
            35.0,
        ),
        (
            r#"(between: ("wall", "glass"), residual_friction_angle_deg: 5)"#,
            5.0,
        ),
    ] {
        let out = folder.path().join(format!("out{angle}"));
        run(&path(joints), &out, &[]);
        let slowed = (3.0 - last_row(&out, 1.0)[5]) / 0.1;
        let expected = 9.81 * angle.to_radians().tan();
        println!("{angle} degrees: {slowed:.5} m/s2, expected {expected:.5}");
        // The sphere starts unloaded: its weight swings in.
        assert!((slowed / expected - 1.0).abs() < 1e-2);
    }
    for (joints, expected) in [
        (
            r#"(between: ("glass", "wal"))"#,
            "joint of `glass` and `wal`: material `wal` is not in materials, did you mean `wall`?",
        ),
        (
            r#"(between: ("glass", "wall")), (between: ("wall", "glass"))"#,
            "joint of `wall` and `glass`: is listed twice",
        ),
        (
            r#"(between: ("glass", "wall"), residual_friction_angle_deg: 21)"#,
            "residual friction angle must be in [0, 20], the friction angle, found 21",
        ),
        (
            r#"(between: ("glass", "wall"), residual_cohesion: 1)"#,
            "residual cohesion must be in [0, 0], the cohesion, found 1",
        ),
        (
            r#"(between: ("glass", "wall"), cohesion: 5, residual_cohesion: -1)"#,
            "residual cohesion must be in [0, 5], the cohesion, found -1",
        ),
        (
            r#"(between: ("glass", "wall"), friction_angle_deg: 90)"#,
            "joint of `glass` and `wall`: friction angle must be in [0, 90) degrees, found 90",
        ),
        (
            r#"(between: ("glass", "wall"), restitution: 1.5)"#,
            "joint of `glass` and `wall`: restitution must be in [0, 1], found 1.5",
        ),
        (
            r#"(between: ("glass", "wall"), friction: 21)"#,
            "unknown field `friction` in JointFile",
        ),
    ] {
        let output = riprap(&["check", path(joints).to_str().unwrap()]);
        let said = words(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(expected), "{said}");
    }
}

/// Blocks that slide farther than asked are counted, those that rest or are not asked for are not.
#[test]
fn displaced_blocks_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let cube = |name: &str, x: f64, speed: f64| {
        format!(
            r#"(name: "{name}", material: "rock", velocity: ({speed}, 0, 0),
                shape: Box(min: ({x}, 0, 0), max: ({}, 1, 1)))"#,
            x + 1.0
        )
    };
    // v²/(2 µ g) with µ = tan 30°: 0.35, 0.79 and 1.41 m
    let blocks = [
        FLOOR.to_owned(),
        cube("armour_1", -8.0, 0.0),
        cube("armour_2", -5.0, 2.0),
        cube("armour_3", -2.0, 3.0),
        cube("armour_4", 2.0, 4.0),
        cube("toe", 6.0, -3.0),
    ]
    .join(", ");
    let gauges = |prefix: &str| {
        format!(
            r#"gauges: [Displaced(name: "half", blocks: "{prefix}", farther_than: 0.5),
                Displaced(name: "one", blocks: "armour", farther_than: 1),
                Displaced(name: "any", blocks: "", farther_than: 0.5)],
            time: (duration: 1), output: (gauge_interval: 0.05)"#
        )
    };
    let out = folder.path().join("out");
    run(&scene(folder.path(), &blocks, &gauges("armour")), &out, &[]);
    let rows = table(&out.join("gauges.csv"));
    assert_eq!(rows[0][1..], [0.0, 0.0, 0.0]);
    assert_eq!(rows.last().unwrap()[1..], [2.0, 1.0, 3.0]);
    for (prefix, expected) in [
        (
            "armor",
            "gauge `half`: no free block has a name that begins with `armor`, did you mean `armour`?",
        ),
        // it is there, but it does not move
        ("floor", "begins with `floor`; expected one of armour, toe"),
    ] {
        let path = scene(folder.path(), &blocks, &gauges(prefix));
        let output = riprap(&["check", path.to_str().unwrap()]);
        let said = words(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.contains(expected) && said.contains("scene.ron:"),
            "{said}"
        );
    }
}

/// The scene of a run keeps its rock mass as written, and names the blocks that follow from it; other joints make others.
fn can_be_edited(out: &Path) {
    let path = out.join("case.ron");
    let kept = std::fs::read_to_string(&path).unwrap();
    assert!(!kept.contains("mass.0001"), "{kept}");
    let note = kept.lines().nth(1).unwrap();
    assert!(note.starts_with("// 24 blocks follow from"), "{note}");
    let edited = kept.replacen("spacing: 1.0", "spacing: 0.5", 1);
    assert_ne!(edited, kept);
    let other = out.with_file_name("edited.ron");
    std::fs::write(&other, edited).unwrap();
    let output = riprap(&["check", other.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(said.contains("`mass`: 48 blocks of"), "{said}");
    // pictures and reports have the names of all blocks, without `bodies.csv` those that the scene lists
    let names = || run_folder::read_scene(out).unwrap().block_names;
    assert_eq!((names().len(), names()[1].as_str()), (25, "mass.0001"));
    std::fs::remove_file(out.join("bodies.csv")).unwrap();
    assert_eq!(names(), ["floor"]);
}

/// Spheres of a lattice are blocks like others.
#[test]
fn grains_become_balls() {
    let folder = tempfile::tempdir().unwrap();
    let further = r#"grains: [(name: "bead", material: "rock", region: Box(min: (-1, -1, 0), max: (1, 1, 1)),
            diameter: (0.2, 0.2), jitter: 0.05, seed: 3, velocity: (0, 0, -1), count: 81)],
        time: (duration: 0.05)"#;
    let path = scene(folder.path(), FLOOR, further);
    let output = riprap(&["check", path.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    // cells of 0.22 m: 9 x 9 a layer; 81 spheres of 2600 π/6 0.2³ = 10.891 kg
    let expected =
        "grains         `bead`: 81 spheres of 2.000e-1 to 2.000e-1 m, 8.822e2 kg together";
    assert!(said.contains(expected), "{said}");
    let out = folder.path().join("out");
    let summary = run(&path, &out, &[]);
    assert_eq!(summary["free_blocks"], 81);
    // case.ron makes the same spheres and runs alike
    let again = run(&out.join("case.ron"), &folder.path().join("again"), &[]);
    assert_eq!(summary["state_hash"], again["state_hash"]);
    let kept = std::fs::read_to_string(out.join("case.ron")).unwrap();
    assert!(
        kept.contains("jitter: 0.05") && !kept.contains("bead_0001"),
        "{kept}"
    );
    for (change, expected) in [
        (
            ("count: 81", "count: 325"),
            "grains `bead`: 325 spheres do not fit, only 324 do",
        ),
        (
            ("\"rock\", region", "\"rok\", region"),
            "did you mean `rock`?",
        ),
        (
            ("(0.2, 0.2)", "(0.2, 0.1)"),
            "give the smallest, then the largest",
        ),
        (
            ("count: 81", "spacing: 0.2"),
            "spacing must be at least 0.22",
        ),
        (("count: 81", "count: 0"), "count must be > 0"),
    ] {
        let wrong = further.replace(change.0, change.1);
        let output = riprap(&[
            "check",
            scene(folder.path(), FLOOR, &wrong).to_str().unwrap(),
        ]);
        let said = words(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.contains(expected) && said.contains("scene.ron:"),
            "{said}"
        );
    }
}
