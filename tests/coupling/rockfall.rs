//! Falling blocks that are followed: closed forms of a thrown sphere, the tables of the rockfall case, its script.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::{case, riprap, run, table, words};

const G: f64 = 9.81;

/// Columns of a table by name, without their units.
struct Columns {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Columns {
    fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).unwrap();
        let header = text.lines().next().unwrap();
        let name = |cell: &str| cell.split(" [").next().unwrap().to_owned();
        Self {
            names: header.split(',').map(name).collect(),
            rows: table(path),
        }
    }

    fn at(&self, row: &[f64], name: &str) -> f64 {
        row[self.names.iter().position(|n| n == name).unwrap()]
    }
}

/// A plane that falls by `dip` along x, 30 m by 6 m, as a grid.
fn tilted_plane(folder: &Path, dip: f64) {
    let row: Vec<String> = (0..31)
        .map(|k| format!("{:?}", -f64::from(k) * dip.tan()))
        .collect();
    let heights = vec![row.join(" "); 7].join("\n");
    let grid = format!("ncols 31\nnrows 7\nxllcenter 0\nyllcenter -3\ncellsize 1\n{heights}\n");
    std::fs::write(folder.join("plane.asc"), grid).unwrap();
}

/// A scene of blocks on that plane.
fn scene(folder: &Path, material: &str, blocks: &str, further: &str) -> PathBuf {
    let path = folder.join("scene.ron");
    let text = format!(
        r#"(
    title: "blocks on a tilted plane",
    domain: (min: (0, -3, -20), max: (30, 3, 10)),
    materials: [(name: "rock", density: 2600, {material})],
    blocks: [(name: "plane", material: "rock", motion: Fixed, shape: Raster(file: "plane.asc")), {blocks}],
    {further}
)"#
    );
    std::fs::write(&path, text).unwrap();
    path
}

/// A sphere thrown over a plane of 30 degrees, without friction. Over the plane it rises and falls as over a floor, with
/// the upward speed `w = v_z + v_x tan α`, and a bounce leaves `e w` of it:
///
/// ```text
/// h(t) = h₀ + w t − g t²/2,   lands at h = r/cos α,   v' = v − (1 + e)(v·n) n
/// ```
#[test]
fn a_thrown_ball_has_the_bounce_height_and_run_out_of_its_parabolas() {
    let (dip, radius, restitution) = (30.0_f64.to_radians(), 0.3, 0.5);
    let (start, velocity) = ([2.0, 1.2], [3.0, 4.0]);
    let lands_at = radius / dip.cos();
    let above = start[1] + start[0] * dip.tan();
    let w = velocity[1] + velocity[0] * dip.tan();
    let first_top = above + w * w / (2.0 * G);
    let first_time = (w + (w * w + 2.0 * G * (above - lands_at)).sqrt()) / G;
    // the bounce
    let landing = [velocity[0], velocity[1] - G * first_time];
    let normal = [dip.sin(), dip.cos()];
    let inward = landing[0] * normal[0] + landing[1] * normal[1];
    let after = [0, 1].map(|k| landing[k] - (1.0 + restitution) * inward * normal[k]);
    let w = after[1] + after[0] * dip.tan();
    let second_top = lands_at + w * w / (2.0 * G);
    // the end, before it lands again
    let second_time = 0.9 * 2.0 * w / G;
    let duration = first_time + second_time;
    let run_out = velocity[0] * first_time + after[0] * second_time;
    let drop = -(velocity[1] * first_time + after[1] * second_time)
        + 0.5 * G * (first_time.powi(2) + second_time.powi(2));
    // length of a parabola: ∫ √(v_x² + (v_z − g t)²) dt
    let length = |v: [f64; 2], time: f64| {
        let primitive = |u: f64| 0.5 * (u * v[0].hypot(u) + v[0].powi(2) * (u / v[0]).asinh());
        (primitive(v[1]) - primitive(v[1] - G * time)) / G
    };
    let path_length = length(velocity, first_time) + length(after, second_time);

    let folder = tempfile::tempdir().unwrap();
    tilted_plane(folder.path(), dip);
    let ball = format!(
        r#"(name: "ball", material: "rock", velocity: ({}, 0, {}),
            shape: Sphere(center: ({}, 0.3, {}), radius: {radius}))"#,
        velocity[0], velocity[1], start[0], start[1]
    );
    let material =
        format!("friction_angle_deg: 0, restitution: {restitution}, contact_stiffness: 1e10");
    let further = format!(
        "time: (duration: {duration:?}), trajectories: (interval: 0.001), output: (frame_interval: 1),
         numerics: (block_time_step_factor: 0.02)"
    );
    let out = folder.path().join("out");
    run(&scene(folder.path(), &material, &ball, &further), &out, &[]);

    let blocks = Columns::read(&out.join("rockfall.csv"));
    assert_eq!(blocks.rows.len(), 1);
    let row = &blocks.rows[0];
    let samples = Columns::read(&out.join("trajectories.csv"));
    let second_flight = samples.rows.iter().filter(|row| row[0] > first_time);
    let second_found = second_flight
        .map(|row| samples.at(row, "height"))
        .fold(0.0, f64::max);
    // Up to the first landing only the time between looks counts: it misses g dt²/8 = 1.2e-6 m of the top. The bounce
    // takes π √(m/K) = 0.8 ms, in which gravity takes 2 g t/w = 4e-3 of the second top at most: measured 2.3e-3. The
    // small steps are for the restitution, which is 3 % too large at the usual ones.
    for (name, found, expected, tolerance) in [
        (
            "bounce height",
            blocks.at(row, "bounce_height"),
            first_top,
            1e-6,
        ),
        ("second bounce height", second_found, second_top, 4e-3),
        ("run-out", blocks.at(row, "run_out"), run_out, 4e-3),
        ("drop", blocks.at(row, "drop"), drop, 4e-3),
        (
            "angle",
            blocks.at(row, "run_out_angle"),
            (drop / run_out).atan(),
            4e-3,
        ),
        ("way", blocks.at(row, "path_length"), path_length, 4e-3),
    ] {
        let off = found / expected - 1.0;
        println!("{name}: {found:.6}, expected {expected:.6}, off by {off:.1e}");
        assert!(off.abs() < tolerance, "{name}");
    }
    // down the slope the second flight ends faster than the first
    let at_end = after[0].hypot(after[1] - G * second_time);
    let fastest = landing[0].hypot(landing[1]).max(at_end);
    let mass = 2600.0 * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    println!("max speed {} of {fastest}", blocks.at(row, "max_speed"));
    assert!((blocks.at(row, "max_speed") / fastest - 1.0).abs() < 2e-3);
    let energy = 0.5 * mass * blocks.at(row, "max_speed").powi(2);
    assert!((blocks.at(row, "max_kinetic_energy") / energy - 1.0).abs() < 1e-9);
    let page = std::fs::read_to_string(out.join("overview.svg")).unwrap();
    assert!(page.contains("bounce height [m]") && page.contains("share of blocks"));
}

/// Every block of a tables' pair: its ends, way and extremes agree, and what it has of energy only falls once it
/// flies no more.
fn check_tables(out: &Path) -> (Columns, Columns) {
    let blocks = Columns::read(&out.join("rockfall.csv"));
    let samples = Columns::read(&out.join("trajectories.csv"));
    for row in &blocks.rows {
        let of = |name: &str| blocks.at(row, name);
        let way = samples.rows.iter().filter(|sample| sample[1] == row[0]);
        let way: Vec<&Vec<f64>> = way.collect();
        let column = |name: &str| {
            way.iter()
                .map(|sample| samples.at(sample, name))
                .collect::<Vec<_>>()
        };
        let largest = |name: &str| column(name).into_iter().fold(f64::NAN, f64::max);
        assert!(of("run_out") <= of("path_length"));
        assert!(of("drop") <= of("path_length"));
        assert!(
            (of("run_out_angle").tan() * of("run_out") - of("drop")).abs()
                < 1e-9 * of("path_length")
        );
        assert_eq!(largest("height"), of("bounce_height"));
        assert_eq!(largest("kinetic_energy"), of("max_kinetic_energy"));
        assert_eq!(*column("distance").last().unwrap(), of("run_out"));
        assert!(
            0.5 * of("mass") * of("max_speed").powi(2) <= of("max_kinetic_energy") * (1.0 + 1e-12)
        );
        assert!(
            column("path_length")
                .windows(2)
                .all(|pair| pair[0] <= pair[1])
        );
    }
    (blocks, samples)
}

/// A hull and a sphere with rolling friction tumble down a plane of 20 degrees, which holds both in the end (friction of
/// 30 degrees, rolling friction of 0.6 over a slope of 0.36): from their last leap on they only lose energy.
#[test]
fn blocks_that_come_to_rest_lose_energy_after_their_last_leap() {
    let dip = 20.0_f64.to_radians();
    let folder = tempfile::tempdir().unwrap();
    tilted_plane(folder.path(), dip);
    let blocks = r#"(name: "hull", material: "rock", velocity: (2, 0, 0),
            shape: Hull(points: [(2, -1, 1), (2.6, -1, 1), (2.3, -0.5, 1), (2.3, -0.8, 1.5), (2.1, -1.2, 1.4), (2.5, -0.7, 0.8)])),
        (name: "ball", material: "rock", velocity: (2, 0, 0), shape: Sphere(center: (2, 1, 1), radius: 0.3))"#;
    let material =
        "friction_angle_deg: 30, restitution: 0.3, contact_stiffness: 1e8, rolling_friction: 0.6";
    let further =
        "time: (duration: 4), trajectories: (interval: 0.005), output: (frame_interval: 1)";
    let out = folder.path().join("out");
    run(&scene(folder.path(), material, blocks, further), &out, &[]);
    let (blocks, samples) = check_tables(&out);
    assert_eq!(blocks.rows.len(), 2);
    for row in &blocks.rows {
        println!(
            "block {} went {:.2} m in {:.2} m",
            row[0],
            blocks.at(row, "run_out"),
            blocks.at(row, "path_length")
        );
        assert!(
            blocks.at(row, "end_speed") < 1e-3,
            "{}",
            blocks.at(row, "end_speed")
        );
        assert!(blocks.at(row, "run_out") > 0.5);
        let way = samples.rows.iter().filter(|sample| sample[1] == row[0]);
        let way: Vec<&Vec<f64>> = way.collect();
        let rest = samples.at(way.last().unwrap(), "height");
        // it flies no more once it never again is 0.02 m above where it comes to rest
        let last_leap = way
            .iter()
            .rposition(|s| samples.at(s, "height") > rest + 0.02);
        let energy: Vec<f64> = way[last_leap.unwrap_or(0)..]
            .iter()
            .map(|s| {
                samples.at(s, "kinetic_energy") + blocks.at(row, "mass") * G * samples.at(s, "z")
            })
            .collect();
        let scale = energy[0] - energy.last().unwrap();
        let gain = energy
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .fold(0.0, f64::max);
        println!(
            "loses {scale:.3} J after its last leap, gains at most {gain:.2e} J between two looks"
        );
        // what contact springs give back between two looks
        assert!(scale > 0.0 && gain < 0.1 * scale);
    }
}

/// The first seconds of the case: tables agree, all blocks together gain no energy, and looking changes nothing.
#[test]
fn the_rockfall_case_in_its_first_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let summary = run(&case("rockfall.ron"), &out, &["--until", "3"]);
    assert_eq!(summary["free_blocks"], 48);
    let (blocks, samples) = check_tables(&out);
    assert_eq!(blocks.rows.len(), 48);
    let mut totals: Vec<(f64, f64)> = Vec::new();
    for row in &samples.rows {
        let mass = blocks.rows.iter().find(|b| b[0] == row[1]).unwrap()[1];
        let energy = samples.at(row, "kinetic_energy") + mass * G * samples.at(row, "z");
        match totals.last_mut() {
            Some((time, total)) if *time == row[0] => *total += energy,
            _ => totals.push((row[0], energy)),
        }
    }
    let lost = totals[0].1 - totals.last().unwrap().1;
    let gain = totals
        .windows(2)
        .map(|pair| pair[1].1 - pair[0].1)
        .fold(0.0, f64::max);
    println!("all blocks lose {lost:.0} J, gain at most {gain:.0} J between two looks");
    // contact springs that give back what they took before the look
    assert!(lost > 0.0 && gain < 0.05 * lost);
    let overlap = summary["max_block_overlap_over_size"].as_f64().unwrap();
    println!("largest overlap {overlap:.3} of the size");
    assert!(overlap < 0.1);

    let text = std::fs::read_to_string(case("rockfall.ron")).unwrap();
    let silent = text.replace("    trajectories: (interval: 0.02),\n", "");
    assert_ne!(silent, text);
    let copy = folder.path().join("silent.ron");
    std::fs::write(&copy, silent).unwrap();
    std::fs::copy(case("rockfall.asc"), folder.path().join("rockfall.asc")).unwrap();
    let silent = folder.path().join("silent");
    let without = run(&copy, &silent, &["--until", "3"]);
    assert_eq!(summary["state_hash"], without["state_hash"]);
    for name in ["rockfall.csv", "trajectories.csv"] {
        assert!(!silent.join(name).exists(), "{name}");
    }
}

#[test]
fn wrong_trajectories_are_explained_in_their_place() {
    let folder = tempfile::tempdir().unwrap();
    tilted_plane(folder.path(), 0.5);
    let ball = r#"(name: "ball", material: "rock", shape: Sphere(center: (2, 1, 3), radius: 0.3))"#;
    let material = "friction_angle_deg: 30";
    for (blocks, trajectories, expected) in [
        (
            ball,
            r#"(blocks: ["bal"])"#,
            "`bal` is not a free block of `blocks`, did you mean `ball`?",
        ),
        (
            ball,
            r#"(blocks: ["plane"])"#,
            "`plane` is not a free block of `blocks`",
        ),
        (
            ball,
            r#"(blocks: ["ball", "ball"])"#,
            "`ball` is listed twice",
        ),
        (
            ball,
            "(interval: 0)",
            "trajectories: interval must be > 0, found 0",
        ),
        ("", "()", "no block is free to move; leave trajectories out"),
        (
            ball,
            "(intervall: 1)",
            "unknown field `intervall` in TrajectoriesFile, did you mean `interval`?",
        ),
    ] {
        let further = format!("time: (duration: 1), trajectories: {trajectories}");
        let path = scene(folder.path(), material, blocks, &further);
        let output = riprap(&["check", path.to_str().unwrap()]);
        let said = words(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.contains(expected) && said.contains("scene.ron:"),
            "{said}"
        );
    }
}

/// The script makes the files that are here, to the letter.
#[test]
fn the_script_makes_terrain_and_boulders_of_the_case() {
    let script = case("rockfall.py");
    let made = |what: &str| Command::new("python3").arg(&script).arg(what).output();
    let Ok(grid) = made("grid") else {
        println!("skipped: there is no python3");
        return;
    };
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    assert_eq!(
        text(grid.stdout),
        std::fs::read_to_string(case("rockfall.asc")).unwrap()
    );
    let boulders = text(made("boulders").unwrap().stdout);
    let scene = std::fs::read_to_string(case("rockfall.ron")).unwrap();
    assert!(boulders.lines().count() == 48 && scene.contains(&boulders));
}
