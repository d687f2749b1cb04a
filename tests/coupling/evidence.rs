//! A run that fails leaves what shows why, and its last good state goes on with other numerics in another folder.

use std::fs;
use std::path::Path;

use riprap::files::table::read_table;
use riprap::vtk::{self, PolyData, Values};

use crate::checkpoints::HARD;
use crate::support::killed::{TANK, spawn};
use crate::support::{riprap, summary, words};

/// Water thrown down at two thirds of its speed of sound: where it hits the floor it is compressed by more than it may be.
pub const THROWN: &str = r#"(
    title: "Thrown",
    domain: (min: (-0.3, 0, -0.3), max: (0.9, 0.1, 2), dimensions: Two),
    materials: [(name: "rock", density: 2400, friction_angle_deg: 30)],
    blocks: [
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, -0.3), max: (0.9, 0.1, 0))),
        (name: "left", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, 0), max: (0, 0.1, 2))),
        (name: "right", material: "rock", motion: Fixed, shape: Box(min: (0.6, 0, 0), max: (0.9, 0.1, 2))),
    ],
    fluid: (dynamic_viscosity: 0.001, resolution: Spacing(0.025), regions: [
        (name: "water", shape: Box(min: (0, 0, 0.3), max: (0.6, 0.1, 0.7)), velocity: (0, 0, -6)),
    ]),
    numerics: (sound_speed: 9),
    gauges: [Pressure(name: "p", position: (0.3, 0.05, 0.05))],
    time: (duration: 0.3),
    output: (frame_interval: 0.02, gauge_interval: 0.002, ledger_interval: 0.002),
)"#;

/// Runs a scene that fails; what it said.
fn failed(case: &Path, out: &Path, extra: &[&str]) -> String {
    let mut arguments = vec!["run", case.to_str().unwrap(), "-o", out.to_str().unwrap()];
    arguments.extend(extra);
    let output = riprap(&arguments);
    assert_eq!(output.status.code(), Some(1), "{}", words(&output));
    let message = words(&output);
    println!("{message}");
    message
}

fn column(data: &PolyData, name: &str) -> Vec<f64> {
    let array = data.point_data.iter().find(|array| array.name == name);
    match &array.unwrap().values {
        Values::F32(values) => values.iter().map(|&x| f64::from(x)).collect(),
        Values::F64(values) => values.clone(),
        Values::I32(values) => values.iter().map(|&x| f64::from(x)).collect(),
    }
}

/// The three lines that name what grew first, and the file of paths.
fn findings(message: &str) -> Vec<&str> {
    let lines = message.lines();
    let mut lines = lines.skip_while(|line| !line.contains(" to grow: "));
    let three: Vec<&str> = lines.by_ref().take(3).collect();
    assert!(lines.next().unwrap().starts_with("earlier output is in "));
    three
}

#[test]
fn water_that_fails_leaves_the_paths_of_what_grew_first() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("thrown.ron"), folder.path().join("out"));
    fs::write(&case, THROWN).unwrap();
    let message = failed(&case, &out, &["--quiet"]);
    let three = findings(&message);
    // it hits the floor first
    assert!(
        three[0].starts_with("first to grow: particle ") && three[0].contains("block `floor`"),
        "{message}"
    );
    assert!(three[1].starts_with("its density: "), "{message}");
    assert!(three[2].contains("paths of the last 20 steps: offenders.vtp"));

    let data = vtk::read(&out.join("offenders.vtp")).unwrap();
    let lines: Vec<&[i32]> = data.lines.iter().collect();
    // twenty steps and the state before them
    assert!(!lines.is_empty() && lines.iter().all(|line| line.len() == 21));
    let (step, time, id) = (
        column(&data, "Step"),
        column(&data, "Time"),
        column(&data, "Id"),
    );
    let (order, density) = (column(&data, "Order"), column(&data, "Density"));
    let velocity = column(&data, "Velocity");
    for line in &lines {
        let line: Vec<usize> = line.iter().map(|&point| point as usize).collect();
        let (first, last) = (line[0], line[20]);
        assert!(line.windows(2).all(|w| step[w[1]] == step[w[0]] + 1.0));
        assert!(
            line.iter()
                .all(|&p| id[p] == id[first] && order[p] == order[first])
        );
        // the path is that of the velocity: to the way of one acceleration over the window, a fifth of it here
        let way = f64::from(data.points[last][2] - data.points[first][2]);
        let mean = line.iter().map(|&p| velocity[3 * p + 2]).sum::<f64>() / 21.0;
        let expected = mean * (time[last] - time[first]);
        assert!(
            (way - expected).abs() < 0.2 * expected.abs() + 1e-4,
            "{way} {expected}"
        );
    }
    // the first that grew is named by the message, and its density grew beyond twice the largest deviation before
    let first = format!("particle {} ", id[0]);
    assert!(three[0].contains(&first), "{first}: {message}");
    assert!(1020.0 < density[20], "{density:?}");
    // the error is in the summary, too, and the state at the end is that of the last attempt
    let summary = summary(&out);
    assert!(summary["stop_reason"].as_str().unwrap().contains(three[0]));
    assert_eq!(summary["fell_back"], 2);
}

#[test]
fn evidence_changes_no_record_of_the_run() {
    // twice the same, and what the tables hold ends where the run failed
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("thrown.ron");
    fs::write(&case, THROWN).unwrap();
    let [one, two] = ["one", "two"].map(|name| folder.path().join(name));
    failed(&case, &one, &["--quiet", "--threads", "1"]);
    failed(&case, &two, &["--quiet", "--threads", "2"]);
    for file in ["gauges.csv", "energy.csv", "offenders.vtp"] {
        assert_eq!(
            fs::read(one.join(file)).unwrap(),
            fs::read(two.join(file)).unwrap()
        );
    }
    assert_eq!(summary(&one)["state_hash"], summary(&two)["state_hash"]);
    let gauges = read_table(&one.join("gauges.csv")).unwrap();
    let end = summary(&one)["simulated_time"].as_f64().unwrap();
    assert_eq!(gauges.column("time").unwrap().last(), Some(&end));
}

#[test]
fn blocks_that_fail_are_named_with_their_overlap_and_no_advice_was_tried_already() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("hard.ron"), folder.path().join("out"));
    fs::write(&case, HARD).unwrap();
    let message = failed(&case, &out, &[]);
    let three = findings(&message);
    assert!(
        three[0].starts_with("first to grow: block `cube` near ")
            && three[0].contains("against block `floor`: its overlap"),
        "{message}"
    );
    assert!(three[1].starts_with("its overlap: "), "{message}");
    assert!(!message.contains("quiet"), "{message}");
    // the run tried shorter steps by itself
    assert!(
        message.contains("a shorter step does not help"),
        "{message}"
    );
    for tried in ["lower the time step", "time_step_factor`", "shorten"] {
        assert!(!message.contains(tried), "{tried}: {message}");
    }
    let data = vtk::read(&out.join("offenders.vtp")).unwrap();
    assert_eq!(data.lines.len(), 1);
    assert_eq!(column(&data, "BlockId")[0], 2.0);
    let (speed, time) = (column(&data, "Speed"), column(&data, "Time"));
    // the cube does not turn: it overlaps by what its lower face, half a meter below, is below the floor's top; in single
    // precision, 1e-7 of a meter
    let overlap = column(&data, "Overlap");
    let height = |k: usize| f64::from(data.points[k][2]);
    for (k, overlap) in overlap.iter().enumerate() {
        assert!((overlap - (0.5 - height(k))).abs() < 1e-6);
    }
    // the floor slows it down, and the path is that of the speed
    let n = overlap.len() - 1;
    assert_eq!(n, 20);
    assert!(speed.windows(2).all(|v| v[1] < v[0]) && speed[0] < 800.0);
    let mean = (height(0) - height(n)) / (time[n] - time[0]);
    assert!(speed[n] < mean && mean < speed[0], "{mean} {speed:?}");
    // a folder that goes on, and ends well, holds no evidence of an end that was not its own
    let good = HARD
        .replace("-800", "-1")
        .replace("duration: 1.0", "duration: 0.01");
    fs::write(&case, good).unwrap();
    assert!(spawn(&case, &out, &["--force"]).wait().unwrap().success());
    assert!(!out.join("offenders.vtp").exists());
}

/// A message that refuses to continue, of a command that leaves both folders alone.
fn refusal(case: &Path, from: &Path, out: &Path, set: &str) -> String {
    let before = fs::read_dir(from).unwrap().count();
    let output = riprap(&[
        "run",
        case.to_str().unwrap(),
        "--from",
        from.to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
        "--set",
        set,
    ]);
    assert_eq!(output.status.code(), Some(2), "{}", words(&output));
    assert_eq!(fs::read_dir(from).unwrap().count(), before);
    words(&output)
}

#[test]
fn a_good_state_goes_on_with_other_numerics_in_a_folder_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("tank.ron"), folder.path().join("out"));
    fs::write(&case, TANK).unwrap();
    assert!(spawn(&case, &out, &[]).wait().unwrap().success());
    let before = read_table(&out.join("gauges.csv")).unwrap();
    let state = fs::read(out.join("checkpoint.bin")).unwrap();
    let from = out.to_str().unwrap();
    for (name, numerics) in [
        ("shorter", "numerics.time_step_factor=0.25"),
        ("artificial", "numerics.viscosity=Artificial(0.05)"),
        ("bulk", "numerics.bulk_viscosity=0.1"),
        ("damped", "materials.rock.restitution=0.5"),
    ] {
        let other = folder.path().join(name);
        let extra = ["--from", from, "--until", "0.45", "--set", numerics];
        assert!(
            spawn(&case, &other, &extra).wait().unwrap().success(),
            "{name}"
        );
        let after = read_table(&other.join("gauges.csv")).unwrap();
        let (then, now) = (
            before.column("time").unwrap(),
            after.column("time").unwrap(),
        );
        // all rows up to the state are those of the run before; it is kept every hundred steps
        let n_kept = then.iter().zip(now).take_while(|(a, b)| a == b).count();
        assert!(100 < n_kept && n_kept < now.len(), "{name}: {n_kept}");
        assert_eq!(
            before.column("g1").unwrap()[..n_kept],
            after.column("g1").unwrap()[..n_kept]
        );
        let (old, new) = (summary(&out), summary(&other));
        assert_eq!(new["completed"], true);
        assert_eq!(new["resumed"], 1);
        assert_ne!(old["state_hash"], new["state_hash"]);
        // nothing jumps: what the ledger cannot explain from one row to the next, over the motion
        let ledger = read_table(&other.join("energy.csv")).unwrap();
        let of = |name: &str| ledger.column(name).unwrap();
        let row = of("time").iter().position(|t| now[n_kept] <= *t).unwrap();
        let jump = of("residual")[row] - of("residual")[row - 1];
        println!(
            "{name}: residual jumps by {jump:e} of {} J",
            of("kinetic")[row]
        );
        assert!(jump.abs() < 1e-3 * of("kinetic")[row], "{name}: {jump}");
        if name == "shorter" {
            let shortest = |summary: &serde_json::Value| summary["dt_min"].as_f64().unwrap();
            assert!(shortest(&new) < 0.5 * shortest(&old));
        }
    }
    // and with bulk viscosity given up again
    let (bulk, again) = (folder.path().join("bulk"), folder.path().join("again"));
    let set = "numerics.bulk_viscosity=0";
    let extra = [
        "--from",
        bulk.to_str().unwrap(),
        "--until",
        "0.5",
        "--set",
        set,
    ];
    assert!(spawn(&case, &again, &extra).wait().unwrap().success());
    assert_eq!(fs::read(out.join("checkpoint.bin")).unwrap(), state);
    assert_eq!(summary(&out)["resumed"], 0);
}

#[test]
fn the_last_good_state_of_a_failed_run_goes_on_where_it_was_told_to() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("thrown.ron"), folder.path().join("out"));
    fs::write(&case, THROWN).unwrap();
    let message = failed(&case, &out, &["--quiet"]);
    let way = format!("--from {} -o OTHER --set ", out.display());
    assert!(message.contains(&way), "{message}");
    let other = folder.path().join("other");
    let message = failed(
        &case,
        &other,
        &[
            "--from",
            out.to_str().unwrap(),
            "--set",
            "numerics.time_step_factor=0.5",
        ],
    );
    assert!(message.contains("resumes from t = 0.0"), "{message}");
    assert_eq!(summary(&other)["resumed"], 1);
}

#[test]
fn other_bodies_and_other_loads_of_a_state_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("tank.ron"), folder.path().join("out"));
    fs::write(&case, TANK).unwrap();
    assert!(spawn(&case, &out, &[]).wait().unwrap().success());
    let other = folder.path().join("other");
    for (set, reason) in [
        (
            "blocks.right.shape=Box(min: (1.3, 0, 0), max: (1.5, 0.1, 1))",
            "the state is of these bodies and of this water",
        ),
        (
            "fluid.resolution=Spacing(0.05)",
            "the state is of these bodies and of this water",
        ),
        (
            "numerics.sound_speed=40",
            "densities carry the pressures by it",
        ),
        (
            "materials.rock.contact_stiffness=1e7",
            "contacts carry their loads by it",
        ),
        ("numerics.smoothing_length_ratio=1.6", "were made with it"),
    ] {
        let message = refusal(&case, &out, &other, set);
        println!("{message}");
        assert!(
            message.contains("the run had `") && message.contains(reason),
            "{set}: {message}"
        );
        assert!(
            message.contains("what may change: `time_step_factor`"),
            "{message}"
        );
        assert!(!other.exists());
    }
    let message = refusal(&case, &out, &out, "numerics.time_step_factor=0.5");
    assert!(
        message.contains("is the folder of the run to continue from"),
        "{message}"
    );
}
