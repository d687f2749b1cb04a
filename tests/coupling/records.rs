//! Records of blocks: counters at planes and in boxes, reactions, motion of points.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use riprap::checkpoint;
use riprap::files::table::{TableData, read_table};
use riprap::run::{Ending, Event, Plan, run as run_scene};
use riprap::summary::Summary;
use serde_json::{Value, json};

use crate::support::scene::resolved;
use crate::support::{riprap, run, words};

const G: f64 = 9.81;

/// Heights of the centers of four spheres above the plane z = 0; m.
const HEIGHTS: [f64; 4] = [0.5, 1.0, 1.5, 2.0];
/// Lower side of the domain, where they leave; m.
const BOTTOM: f64 = -0.7;
const DURATION: f64 = 0.8;
/// Blocks in free flight take a thousandth of the duration; s.
const STEP: f64 = DURATION / 1000.0;

/// Four spheres that fall through a plane and a box and out of the domain, two of them called `pebble`.
const FALLING: &str = r#"(
    title: "spheres in free fall",
    domain: (min: (-1, -1, -0.7), max: (8, 1, 3)),
    materials: [(name: "rock", density: 2600, friction_angle_deg: 30)],
    blocks: [
        (name: "pebble_1", material: "rock", shape: Sphere(center: (0, 0, 0.5), radius: 0.1)),
        (name: "pebble_2", material: "rock", shape: Sphere(center: (2, 0, 1), radius: 0.1)),
        (name: "stone_1", material: "rock", shape: Sphere(center: (4, 0, 1.5), radius: 0.1)),
        (name: "stone_2", material: "rock", shape: Sphere(center: (6, 0, 2), radius: 0.1)),
    ],
    counters: [
        Plane(name: "all", point: (3, 0, 0), normal: (0, 0, -2)),
        Plane(name: "pebbles", point: (0, 0, 0), normal: (0, 0, -1), blocks: "pebble_"),
        Plane(name: "above", point: (0, 0, 0), normal: (0, 0, 1)),
        Plane(name: "oblique", point: (0, 0, 0), normal: (1, 0, 1)),
        Box(name: "slot", min: (-1, -1, 0.2), max: (8, 1, 0.3)),
        Box(name: "never", min: (-1, 0.5, 0.2), max: (8, 1, 0.3)),
    ],
    time: (duration: 0.8),
    output: (ledger_interval: 0.1, frame_interval: 1),
)"#;

/// Time in which a sphere falls by a height (m); s.
fn fall(height: f64) -> f64 {
    (2.0 * height / G).sqrt()
}

fn written(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("scene.ron");
    fs::write(&path, text).unwrap();
    path
}

/// The entry of a name in a list of the summary.
fn named<'a>(list: &'a Value, name: &str) -> &'a Value {
    let mut entries = list.as_array().unwrap().iter();
    entries.find(|entry| entry["name"] == name).unwrap()
}

/// Whether a time is that of the first step at or after another, up to the round-off of a sum of a thousand steps.
fn is_first_step_after(found: &Value, exact: f64) -> bool {
    let late = found.as_f64().unwrap() - exact;
    println!("found {late:.2e} s after {exact:.6} s, steps of {STEP:.1e} s");
    (-1e-9..STEP + 1e-9).contains(&late)
}

/// Number of the heights that fit.
fn count(fits: impl Fn(f64) -> bool) -> f64 {
    HEIGHTS.iter().filter(|&&h| fits(h)).count() as f64
}

/// A sphere falls by h in √(2 h/g), to a plane, to a box and to the end of the domain, where it stays counted as passed.
#[test]
fn falling_spheres_are_counted_to_the_step() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let summary = run(&written(folder.path(), FALLING), &out, &[]);
    assert_eq!(summary["blocks_escaped"], 4);
    let counters = &summary["counters"];
    let at_plane = HEIGHTS.map(fall);
    for (name, passed, inside, first, last) in [
        ("all", 4, 0, at_plane[0], at_plane[3]),
        ("pebbles", 2, 0, at_plane[0], at_plane[1]),
        ("slot", 4, 0, fall(HEIGHTS[0] - 0.3), fall(HEIGHTS[3] - 0.3)),
    ] {
        let found = named(counters, name);
        assert_eq!(
            (&found["passed"], &found["inside"]),
            (&json!(passed), &json!(inside)),
            "{name}"
        );
        assert!(is_first_step_after(&found["first_time"], first), "{name}");
        assert!(is_first_step_after(&found["last_time"], last), "{name}");
    }
    for (name, passed, time) in [
        ("above", 4, json!(0.0)),
        ("oblique", 4, json!(0.0)),
        ("never", 0, Value::Null),
    ] {
        let found = named(counters, name);
        assert_eq!(
            (&found["passed"], &found["first_time"], &found["last_time"]),
            (&json!(passed), &time, &time)
        );
    }
    let table = read_table(&out.join("counters.csv")).unwrap();
    let times = table.column("time").unwrap();
    assert_eq!(times.len(), 9);
    let rows = |name: &str, expected: &dyn Fn(f64) -> f64| {
        let expected: Vec<f64> = times.iter().map(|&t| expected(t)).collect();
        assert_eq!(table.column(name).unwrap(), expected, "{name}");
    };
    // no row is within a step of a passage
    let has_passed = |t: f64, h: f64| fall(h) < t;
    let has_left = |t: f64, h: f64| fall(h - BOTTOM) < t;
    rows("all.passed", &|t| count(|h| has_passed(t, h)));
    rows("all.inside", &|t| {
        count(|h| has_passed(t, h) && !has_left(t, h))
    });
    rows("pebbles.passed", &|t| {
        count(|h| h <= 1.0 && has_passed(t, h))
    });
    rows("above.passed", &|_| 4.0);
    rows("above.inside", &|t| count(|h| !has_passed(t, h)));
    rows("slot.passed", &|t| count(|h| fall(h - 0.3) < t));
    rows("slot.inside", &|t| {
        count(|h| fall(h - 0.3) < t && t < fall(h - 0.2))
    });
    rows("never.passed", &|_| 0.0);
}

/// Runs a scene into a folder until a step, or to its end, and from its checkpoint if there is one; `records` of its summary.
pub fn part(
    (text, records): (&str, impl Fn(&Summary) -> Value),
    folder: &Path,
    until: u64,
) -> (Ending, Value) {
    let from = checkpoint::newest(folder, &Default::default()).unwrap();
    let plan = Plan {
        from: from.map(|(checkpoint, _)| checkpoint),
        ..Plan::new(folder)
    };
    let stop = AtomicBool::new(false);
    let mut tell = |event: Event| {
        if let Event::Step(progress) = event
            && progress.steps == until
        {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let mut scene = resolved(text).unwrap();
    let (summary, ending) = run_scene(&mut scene, plan, &stop, &mut tell).unwrap();
    (ending, records(&summary))
}

/// Stopped between the first passage and the last, and on the way to rest.
#[test]
fn a_resumed_run_has_the_same_records() {
    for (text, tables) in [
        (FALLING, &["counters.csv"][..]),
        (COLUMN, &["counters.csv", "reactions.csv", "gauges.csv"]),
    ] {
        let folders = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let [whole, parts] = [0, 1].map(|k| folders[k].path());
        let scene = (text, |summary: &Summary| {
            json!([summary.counters, summary.reactions])
        });
        let expected = part(scene, whole, u64::MAX);
        assert_eq!(part(scene, parts, 640).0, Ending::Interrupted);
        assert_eq!(part(scene, parts, u64::MAX), expected);
        assert_eq!(expected.0, Ending::Completed);
        for table in tables {
            let read = |folder: &Path| fs::read_to_string(folder.join(table)).unwrap();
            assert_eq!(read(parts), read(whole), "{table}");
        }
    }
}

/// Two cubes of 1 m³ on each other and on a floor of another material.
const COLUMN: &str = r#"(
    title: "a column of two cubes",
    domain: (min: (-5, -5, -2), max: (5, 5, 5)),
    materials: [
        (name: "rock", density: 2600, friction_angle_deg: 30, contact_stiffness: 1e8),
        (name: "steel", density: 7800, friction_angle_deg: 30, contact_stiffness: 1e8),
    ],
    blocks: [
        (name: "floor", material: "steel", motion: Fixed, shape: Box(min: (-2, -2, -1), max: (2, 2, 0))),
        (name: "cube_1", material: "rock", shape: Box(min: (0, 0, 0), max: (1, 1, 1))),
        (name: "cube_2", material: "rock", shape: Box(min: (0, 0, 1), max: (1, 1, 2))),
    ],
    gauges: [PointMotion(name: "corner", block: "cube_2", point: (1, 1, 2))],
    counters: [Box(name: "low", min: (-1, -1, 0), max: (2, 2, 1), blocks: "cube")],
    reactions: [
        (name: "on_cubes", between: ("floor", "cube_*")),
        (name: "on_floor", between: ("rock", "steel"), direction: (0, 0, -3)),
        (name: "upper", between: ("cube_1", "cube_2"), direction: (1, 0, 0)),
        (name: "within", between: ("cube_*", "rock")),
        (name: "apart", between: ("floor", "cube_2")),
    ],
    numerics: (static_damping: MassProportional(20)),
    time: (duration: 1.5),
    output: (gauge_interval: 0.01, frame_interval: 1),
)"#;

/// Last value of a column.
fn last(table: &TableData, name: &str) -> f64 {
    *table.column(name).unwrap().last().unwrap()
}

/// At rest the floor bears both weights, the lower cube the upper one, and the forces between the cubes cancel in their sum. A
/// square patch has nine points: corners, middle, and the centroids of the four triangles between them, each with a share of
/// (1 − s) 3/16, an eighth with the third s of the stiffness that is at the corners.
#[test]
fn reactions_of_a_column_are_its_weights() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let summary = run(&written(folder.path(), COLUMN), &out, &[]);
    let table = read_table(&out.join("reactions.csv")).unwrap();
    let weight = 2600.0 * G;
    // what is left of the vibration after the start, over the weight of a cube: measured 7e-14
    let is_near = |name: &str, expected: f64| {
        let off = (last(&table, name) - expected) / weight;
        println!(
            "{name}: {:.6e}, expected {expected:.6e}, off by {off:.1e} of a weight",
            last(&table, name)
        );
        assert!(off.abs() < 1e-10, "{name}");
    };
    for (name, [fx, fy, fz], along, contacts, largest_normal) in [
        ("on_cubes", [0.0, 0.0, 2.0], None, 9.0, 0.25),
        ("on_floor", [0.0, 0.0, -2.0], Some(2.0), 9.0, 0.25),
        ("upper", [0.0, 0.0, 1.0], Some(0.0), 9.0, 0.125),
        ("within", [0.0; 3], None, 9.0, 0.125),
        ("apart", [0.0; 3], None, 0.0, 0.0),
    ] {
        for (column, expected) in [
            ("fx", fx),
            ("fy", fy),
            ("fz", fz),
            ("largest_normal", largest_normal),
        ] {
            is_near(&format!("{name}.{column}"), expected * weight);
        }
        match along {
            Some(along) => is_near(&format!("{name}.along"), along * weight),
            None => assert!(table.column(&format!("{name}.along")).is_err()),
        }
        assert_eq!(
            last(&table, &format!("{name}.contacts")),
            contacts,
            "{name}"
        );
    }
    // the largest values are those of the table, at their times
    let times = table.column("time").unwrap();
    for (name, column) in [("on_floor", "along"), ("on_cubes", "fz"), ("within", "fz")] {
        let found = named(&summary["reactions"], name);
        let values = table.column(&format!("{name}.{column}")).unwrap();
        let row = times
            .iter()
            .position(|&time| json!(time) == found["time"])
            .unwrap();
        let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let told = found["largest"].as_f64().unwrap();
        // the cubes stand straight: the sum has no other component
        assert!(
            (values[row] - told).abs() < 1e-9 * weight && told - largest < 1e-9 * weight,
            "{name}"
        );
        let normal = table.column(&format!("{name}.largest_normal")).unwrap();
        assert_eq!(
            found["largest_normal"],
            json!(normal.iter().copied().fold(0.0, f64::max))
        );
    }
    assert_eq!(named(&summary["counters"], "low")["passed"], 1);
    // both contacts shorten under what they bear: 2 W and W over their stiffness of 1e8 N/m
    let gauges = read_table(&out.join("gauges.csv")).unwrap();
    let (z, sunk) = (last(&gauges, "corner.z"), last(&gauges, "corner.uz"));
    println!("the corner sinks by {sunk:.3e} m");
    assert!((z - 2.0 - sunk).abs() < 1e-15);
    assert!((sunk / (-3.0 * weight / 1e8) - 1.0).abs() < 1e-9);
}

/// A sphere that flies and spins about z without gravity: x = c + v t + R(ω t) r, with the velocity v + ω × R r.
#[test]
fn a_point_of_a_spinning_sphere_moves_on_its_trochoid() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"(
        title: "a spinning sphere", gravity: (0, 0, 0),
        domain: (min: (-5, -5, -5), max: (5, 5, 5)),
        materials: [(name: "rock", density: 2600, friction_angle_deg: 30)],
        blocks: [(name: "ball", material: "rock", shape: Sphere(center: (1, 0, 0), radius: 0.5),
            velocity: (0.3, 0, 0.1), angular_velocity: (0, 0, 4))],
        gauges: [PointMotion(name: "p", block: "ball", point: (1.4, 0, 0.2))],
        time: (duration: 2), output: (gauge_interval: 0.1, frame_interval: 2),
    )"#;
    let out = folder.path().join("out");
    run(&written(folder.path(), text), &out, &[]);
    let table = read_table(&out.join("gauges.csv")).unwrap();
    let times = table.column("time").unwrap();
    assert_eq!(times.len(), 21);
    for (row, &t) in times.iter().enumerate() {
        let (sin, cos) = (4.0 * t).sin_cos();
        let position = [1.0 + 0.3 * t + 0.4 * cos, 0.4 * sin, 0.2 + 0.1 * t];
        let start = [1.4, 0.0, 0.2];
        let velocity = [0.3 - 1.6 * sin, 1.6 * cos, 0.1];
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let at = |column: &str| table.column(&format!("p.{column}{axis}")).unwrap()[row];
            // a sphere turns exactly, but for the round-off of two thousand steps
            for (found, expected) in [
                (at(""), position[k]),
                (at("u"), position[k] - start[k]),
                (at("v"), velocity[k]),
            ] {
                assert!(
                    (found - expected).abs() < 1e-9,
                    "{axis} at {t}: {found} {expected}"
                );
            }
        }
    }
}

#[test]
fn wrong_records_are_explained_in_their_place() {
    let folder = tempfile::tempdir().unwrap();
    for (from, to, place, expected) in [
        (
            r#"blocks: "cube")"#,
            r#"blocks: "cub_")"#,
            "14:",
            "counter `low`: no free block has a name that begins with `cub_`, did you mean `cube`?",
        ),
        (
            "Box(name: \"low\", min: (-1, -1, 0), max: (2, 2, 1), blocks",
            "Plane(name: \"low\", point: (0, 0, 0), normal: (0, 0, 0), blocks",
            "14:",
            "counter `low`: the normal has no direction: its length must be > 0, found (0.0, 0.0, 0.0)",
        ),
        (
            "max: (2, 2, 1), blocks",
            "max: (2, -2, 1), blocks",
            "14:",
            "counter `low`: max (2.0, -2.0, 1.0) must exceed min (-1.0, -1.0, 0.0) in every direction",
        ),
        (
            r#"name: "upper""#,
            r#"name: "apart""#,
            "20:",
            "the name `apart` is taken; names in reactions must differ",
        ),
        (
            "direction: (0, 0, -3)",
            "direction: (0, 0, 0)",
            "17:",
            "reaction `on_floor`: the direction has no direction: its length must be > 0, found (0.0, 0.0, 0.0)",
        ),
        (
            r#"("floor", "cube_*")"#,
            r#"("flor", "cube_*")"#,
            "16:",
            "reaction `on_cubes`: no block and no material is called `flor`, did you mean `floor`?",
        ),
        (
            r#"("floor", "cube_*")"#,
            r#"("floor", "cub_*")"#,
            "16:",
            "reaction `on_cubes`: no block has a name that begins with `cub_`, did you mean `cube_1`?",
        ),
        (
            r#"("rock", "steel")"#,
            r#"("steel", "floor")"#,
            "17:",
            "reaction `on_floor`: no block of `steel` and `floor` is free to move",
        ),
        (
            r#"name: "cube_1", material"#,
            r#"name: "rock", material"#,
            "17:",
            "reaction `on_floor`: `rock` is the name of a block and of a material with 2 blocks; rename one of them",
        ),
        (
            r#"block: "cube_2", point"#,
            r#"block: "cube_3", point"#,
            "13:",
            "gauge `corner`: there is no block `cube_3`, did you mean `cube_1`?",
        ),
        (
            "direction: (1, 0, 0)",
            "directon: (1, 0, 0)",
            "18:",
            "unknown field `directon` in ReactionFile, did you mean `direction`?",
        ),
    ] {
        let text = COLUMN.replace(from, to);
        assert_ne!(text, COLUMN, "{from}");
        let output = riprap(&["check", written(folder.path(), &text).to_str().unwrap()]);
        let said = words(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        let is_placed = said.contains(&format!("scene.ron:{place}"));
        // messages are wrapped to the width of a terminal
        let flat = said.replace("\n  │ ", " ");
        assert!(flat.contains(expected) && is_placed, "{to}: {said}");
    }
}
