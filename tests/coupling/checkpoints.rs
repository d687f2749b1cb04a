//! X22: what is stopped and goes on from a checkpoint is the same to the bit as what never stopped, and nothing is lost on
//! the way.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use riprap::checkpoint::{self, Header};
use riprap::files::table::read_table;
use riprap::run::build;
use riprap::scene;
use riprap::scene::parse::Override;
use riprap::scene::resolve::Scene;
use riprap::world::World;

use crate::support::killed::{Files, TANK, difference, random, results, spawn};
use crate::support::{self, riprap, words};

/// A case with some of its fields set.
fn load(name: &str, set: &[(&str, &str)]) -> Scene {
    let set: Vec<Override> = set
        .iter()
        .map(|(path, value)| Override {
            path: (*path).to_owned(),
            value: (*value).to_owned(),
        })
        .collect();
    scene::load(&support::case(name), &set).unwrap().0
}

fn advance(world: &mut World, steps: u64, duration: f64) {
    for _ in 0..steps {
        let step = world.next_step(duration).unwrap();
        world.step(step).unwrap();
    }
}

/// Case, settings, steps before the checkpoint, and after it.
type Case = (
    &'static str,
    &'static [(&'static str, &'static str)],
    u64,
    u64,
);

/// Every kind of state: wall particles with a block that moves; the predictor-corrector with its rates; the published
/// scheme with its springs; a prescribed body and layers that absorb; floating bodies on integrals and on particles, also with
/// bulk viscosity;
/// thin solids and water in joints; an arch, deformable blocks, terrain, spheres that roll.
const CASES: &[Case] = &[
    (
        "sliding_wedge.ron",
        &[
            ("fluid.resolution", "Spacing(0.075)"),
            ("domain.max", "(5.3, 0.3, 1.8)"),
            ("blocks.wedge.shape.to", "0.3"),
        ],
        60,
        60,
    ),
    (
        "still_tank.ron",
        &[("numerics.stepping", "PredictorCorrector")],
        30,
        30,
    ),
    (
        "still_tank.ron",
        &[
            ("numerics.preset", "Mueller2003"),
            ("interface.walls", "Penalty"),
        ],
        30,
        30,
    ),
    (
        "piston.ron",
        &[("fluid.resolution", "Spacing(0.05)")],
        40,
        40,
    ),
    ("floating_boxes.ron", &[], 30, 30),
    (
        "floating_boxes.ron",
        &[("interface.walls", "Integral")],
        20,
        20,
    ),
    (
        "floating_boxes.ron",
        &[("numerics.bulk_viscosity", "0.1")],
        30,
        30,
    ),
    ("breakwater.ron", &[], 2, 3),
    ("arch.ron", &[], 300, 300),
    ("rockfall.ron", &[], 300, 300),
    ("heap.ron", &[], 100, 100),
    ("toppling.ron", &[], 100, 100),
];

#[test]
fn a_world_goes_on_from_its_bytes_as_if_it_had_not_stopped() {
    for (name, set, before, after) in CASES {
        let scene = load(name, set);
        let duration = scene.duration;
        let mut whole = build(&scene).unwrap();
        advance(&mut whole, *before, duration);
        let bytes = whole.save(Vec::new()).unwrap();
        let mut resumed = build(&scene).unwrap();
        assert!(resumed.read(&bytes).unwrap().is_empty());
        advance(&mut whole, *after, duration);
        advance(&mut resumed, *after, duration);
        println!("{name}: {} bytes", bytes.len());
        assert_eq!(resumed.state_hash(), whole.state_hash(), "{name}");
        // energies are of many things that the hash is not
        assert_eq!(resumed.energy(), whole.energy(), "{name}");
    }
}

#[test]
fn bytes_of_another_scene_are_refused() {
    let world = |level: &str| {
        let scene = load("arch.ron", &[("blocks.left.friction", level)][..0]);
        build(&scene).unwrap()
    };
    let bytes = world("").save(Vec::new()).unwrap();
    let mut other = build(&load("toppling.ron", &[])).unwrap();
    assert!(other.read(&bytes).is_err());
    // cut short anywhere
    for n in (0..bytes.len()).step_by(997) {
        assert!(world("").read(&bytes[..n]).is_err(), "{n} bytes");
    }
}

fn assert_same(found: &Files, expected: &Files) {
    assert_eq!(difference(found, expected), None);
}

#[test]
fn a_run_killed_at_any_moment_goes_on_to_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("tank.ron");
    fs::write(&case, TANK).unwrap();
    let whole = folder.path().join("whole");
    let start = std::time::Instant::now();
    assert!(spawn(&case, &whole, &[]).wait().unwrap().success());
    let duration = start.elapsed().as_secs_f64();
    let expected = results(&whole);
    let broken = folder.path().join("broken");
    let (mut seed, mut kills, mut settling, mut begun_anew) = (2026, 0, 0, 0);
    // runs are killed again and again until they are through, then another begins
    while kills < 20 {
        let mut child = spawn(&case, &broken, &["--resume"]);
        std::thread::sleep(Duration::from_secs_f64(duration * random(&mut seed)));
        if child.try_wait().unwrap().is_none() {
            child.kill().unwrap();
            child.wait().unwrap();
            kills += 1;
            let bytes = fs::read(broken.join(checkpoint::FILE)).unwrap_or_default();
            let text = fs::read_to_string(broken.join("case.ron")).unwrap_or_default();
            let hash = checkpoint::scene_hash(&text);
            match checkpoint::read(Path::new("x"), &bytes, &hash) {
                Ok(checkpoint) => settling += u32::from(checkpoint.header.is_settling),
                Err(_) => begun_anew += 1,
            }
            continue;
        }
        assert!(child.wait().unwrap().success());
        assert_same(&results(&broken), &expected);
        fs::remove_dir_all(&broken).unwrap();
    }
    assert!(
        spawn(&case, &broken, &["--resume"])
            .wait()
            .unwrap()
            .success()
    );
    assert_same(&results(&broken), &expected);
    println!("{kills} kills, {settling} while settling, {begun_anew} before the first checkpoint");
}

#[cfg(unix)]
#[test]
fn a_run_that_is_stopped_writes_a_checkpoint_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("tank.ron");
    fs::write(&case, TANK).unwrap();
    let (whole, stopped) = (folder.path().join("whole"), folder.path().join("stopped"));
    assert!(spawn(&case, &whole, &[]).wait().unwrap().success());
    let mut child = spawn(&case, &stopped, &["--checkpoint-interval", "1e6"][..0]);
    while fs::metadata(stopped.join("gauges.csv")).map_or(0, |m| m.len()) < 2000 {
        std::thread::sleep(Duration::from_millis(2));
    }
    let pid = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-TERM", &pid])
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let summary = support::summary(&stopped);
    assert_eq!(summary["stop_reason"], "interrupted");
    assert!(stopped.join(checkpoint::FILE).exists());
    assert!(
        spawn(&case, &stopped, &["--resume"])
            .wait()
            .unwrap()
            .success()
    );
    assert_eq!(support::summary(&stopped)["resumed"], 1);
    assert_same(&results(&stopped), &results(&whole));
    // and a run that is over stays as it is
    let again = riprap(&[
        "run",
        case.to_str().unwrap(),
        "-o",
        stopped.to_str().unwrap(),
        "--resume",
    ]);
    assert!(again.status.success());
    assert!(String::from_utf8_lossy(&again.stdout).contains("is complete already"));
    assert_same(&results(&stopped), &results(&whole));
}

/// A run of blocks that was stopped half way, with two checkpoints.
fn stopped(folder: &Path) -> (std::path::PathBuf, std::path::PathBuf) {
    let case = folder.join("tank.ron");
    fs::write(&case, TANK).unwrap();
    let out = folder.join("out");
    let mut child = spawn(&case, &out, &[]);
    while !out.join(checkpoint::PREVIOUS).exists() {
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    (case, out)
}

/// Message of `--resume` for a folder that it must not change.
fn refusal(case: &Path, out: &Path, extra: &[&str]) -> String {
    let listing = |out: &Path| -> BTreeMap<String, Vec<u8>> {
        let entries = fs::read_dir(out).unwrap().map(|entry| entry.unwrap());
        entries
            .map(|e| {
                (
                    e.file_name().into_string().unwrap(),
                    fs::read(e.path()).unwrap(),
                )
            })
            .collect()
    };
    let before = listing(out);
    let mut arguments = vec![
        "run",
        case.to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
        "--resume",
    ];
    arguments.extend(extra);
    let output = riprap(&arguments);
    assert_eq!(output.status.code(), Some(2), "{}", words(&output));
    assert!(before == listing(out), "a refused run changed the folder");
    words(&output)
}

#[test]
fn what_cannot_go_on_says_why_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = stopped(folder.path());
    let (file, previous) = (out.join(checkpoint::FILE), out.join(checkpoint::PREVIOUS));
    let good = fs::read(&file).unwrap();

    let message = refusal(&case, &out, &["--until", "0.3"]);
    assert!(
        message.contains("the run had `duration: 0.4,`, and now it would be `duration: 0.3,`"),
        "{message}"
    );

    let hash = checkpoint::scene_hash(&fs::read_to_string(out.join("case.ron")).unwrap());
    let state = checkpoint::read(&file, &good, &hash).unwrap();
    fs::remove_file(&previous).unwrap();
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 1;
    let mut newer = good.clone();
    newer["riprap checkpoint\n".len()] += 1;
    for (bytes, expected) in [
        (
            &good[..good.len() / 2],
            "is damaged: its bytes are not those that were written, or not all of them",
        ),
        (&good[..40], "is damaged"),
        (&good[..0], "is not a checkpoint of riprap"),
        (
            &flipped,
            "is damaged: its bytes are not those that were written, or not all of them",
        ),
        (
            &newer,
            "is a checkpoint of format 12, and this riprap reads format 11",
        ),
        (&b"solid cube"[..], "is not a checkpoint of riprap"),
    ] {
        fs::write(&file, bytes).unwrap();
        let message = refusal(&case, &out, &[]);
        assert!(message.contains(expected), "{message}");
    }
    // of another build, of another scene
    let header = state.header;
    let older = Header {
        build: "0.0.9 (abc)".to_owned(),
        ..header.clone()
    };
    checkpoint::write(&out, &older, &state.state).unwrap();
    fs::remove_file(&previous).unwrap();
    let message = refusal(&case, &out, &[]);
    assert!(
        message.contains("was written by riprap 0.0.9 (abc), and this is riprap"),
        "{message}"
    );
    let other = Header {
        scene: [0; 32],
        ..header.clone()
    };
    checkpoint::write(&out, &other, &state.state).unwrap();
    fs::remove_file(&previous).unwrap();
    let message = refusal(&case, &out, &[]);
    assert!(
        message.contains("belongs to another scene than the case.ron beside it"),
        "{message}"
    );
    // a state that is whole, but of other blocks
    checkpoint::write(&out, &header, &state.state[..state.state.len() - 1]).unwrap();
    fs::remove_file(&previous).unwrap();
    let run = riprap(&[
        "run",
        case.to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
        "--resume",
    ]);
    assert_eq!(run.status.code(), Some(1));
    assert!(
        words(&run).contains("error: the checkpoint does not match the observers of this run"),
        "{}",
        words(&run)
    );
}

/// A run to its end in a folder.
fn ran(case: &Path, out: &Path, extra: &[&str]) {
    assert!(spawn(case, out, extra).wait().unwrap().success());
}

#[test]
fn a_run_taken_further_is_the_longer_run() {
    let folder = tempfile::tempdir().unwrap();
    let (case, longer) = (folder.path().join("t.ron"), folder.path().join("2t.ron"));
    fs::write(&case, TANK).unwrap();
    fs::write(&longer, TANK.replace("duration: 0.4", "duration: 0.8")).unwrap();
    let (whole, further) = (folder.path().join("whole"), folder.path().join("further"));
    ran(&longer, &whole, &[]);
    ran(&case, &further, &[]);
    assert_ne!(
        support::summary(&further)["state_hash"],
        support::summary(&whole)["state_hash"]
    );
    ran(&longer, &further, &["--resume"]);
    assert_same(&results(&further), &results(&whole));
}

#[test]
fn a_run_taken_further_keeps_its_rows_beside_new_gauges() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("tank.ron"), folder.path().join("out"));
    fs::write(&case, TANK).unwrap();
    ran(&case, &out, &[]);
    let before = read_table(&out.join("gauges.csv")).unwrap();
    for (from, to, line) in [
        ("x: 0.2,", "x: 0.3,", "x: 0.3,"),
        ("viscosity: 0.001", "viscosity: 0.002", "viscosity: 0.002,"),
        ("duration: 0.4", "duration: 0.3", "duration: 0.3,"),
    ] {
        fs::write(&case, TANK.replace(from, to)).unwrap();
        let message = refusal(&case, &out, &[]);
        assert!(
            message.contains("the run had `") && message.contains(line),
            "{message}"
        );
    }
    let more = TANK
        .replace(
            "gauges: [",
            r#"gauges: [SurfaceElevation(name: "g0", x: 0.9, y: 0.05), "#,
        )
        .replace("gauge_interval: 0.002", "gauge_interval: 0.01")
        .replace("duration: 0.4", "duration: 0.5");
    fs::write(&case, more).unwrap();
    ran(&case, &out, &["--resume"]);
    let after = read_table(&out.join("gauges.csv")).unwrap();
    let names: Vec<&str> = after.columns.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["time", "g0", "g1"]);
    let (time, new) = (after.column("time").unwrap(), after.column("g0").unwrap());
    let n_kept = new.iter().take_while(|z| z.is_nan()).count();
    assert!(100 < n_kept && time[n_kept] < 0.4, "{n_kept}");
    for name in ["time", "g1"] {
        let (now, then) = (after.column(name).unwrap(), before.column(name).unwrap());
        assert_eq!(now[..n_kept], then[..n_kept], "{name}");
    }
    let later = &time[n_kept..];
    assert!(0.49 < later[later.len() - 1]);
    assert!(later.windows(2).all(|t| 0.005 < t[1] - t[0]), "{later:?}");
    let again = folder.path().join("again");
    ran(&case, &again, &[]);
    let hash = |out: &Path| support::summary(out)["state_hash"].clone();
    assert_eq!(hash(&out), hash(&again));
}

#[test]
fn a_damaged_checkpoint_leaves_the_one_before() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = stopped(folder.path());
    let whole = folder.path().join("whole");
    assert!(spawn(&case, &whole, &[]).wait().unwrap().success());
    let file = out.join(checkpoint::FILE);
    let bytes = fs::read(&file).unwrap();
    fs::write(&file, &bytes[..bytes.len() - 7]).unwrap();
    let output = riprap(&[
        "run",
        case.to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
        "--resume",
    ]);
    assert!(output.status.success(), "{}", words(&output));
    assert!(words(&output).contains("warning: "), "{}", words(&output));
    assert!(words(&output).contains("is damaged"), "{}", words(&output));
    assert_same(&results(&out), &results(&whole));
}

#[test]
fn tables_that_became_shorter_are_not_gone_on_with() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = stopped(folder.path());
    let table = out.join("energy.csv");
    let text = fs::read_to_string(&table).unwrap();
    fs::write(&table, &text[..30]).unwrap();
    let output = riprap(&[
        "run",
        case.to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
        "--resume",
    ]);
    assert_eq!(output.status.code(), Some(1));
    let message = words(&output);
    assert!(
        message.contains("energy.csv: 30 bytes, but the run had written"),
        "{message}"
    );
}

/// A block that hits the floor harder than its contacts can bear, whatever the step, and one beside it that does not.
pub(crate) const HARD: &str = r#"(
    title: "Hard",
    domain: (min: (-5, -5, -5), max: (5, 5, 5)),
    gravity: (0, 0, 0),
    materials: [(name: "rock", density: 2400, friction_angle_deg: 30, contact_stiffness: 1e9)],
    blocks: [
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-4, -4, -2), max: (4, 4, 0))),
        (name: "quiet", material: "rock", shape: Box(min: (2, 2, 2), max: (3, 3, 3))),
        (name: "cube", material: "rock", shape: Box(min: (-0.5, -0.5, 0.5), max: (0.5, 0.5, 1.5)),
         velocity: (0, 0, -800)),
    ],
    time: (duration: 1.0),
)"#;

#[test]
fn what_no_step_helps_is_given_up_with_the_last_good_state_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("hard.ron"), folder.path().join("out"));
    fs::write(&case, HARD).unwrap();
    let output = riprap(&["run", case.to_str().unwrap(), "-o", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    let message = words(&output);
    // cause, place, time, figures, the field to change
    for part in [
        "warning: at t = 0.0009",
        "blocks `floor` and `cube` overlap by",
        "raise the contact stiffness",
        "returns to t = 0.000000 s and continues with 0.5 of the step",
        "recurred from the last good state, t = 0.000000 s, with 0.25 of the usual step",
    ] {
        assert!(message.contains(part), "{message}");
    }
    assert_eq!(support::summary(&out)["fell_back"], 2);
    let text = fs::read_to_string(out.join("case.ron")).unwrap();
    let bytes = fs::read(out.join(checkpoint::FILE)).unwrap();
    let kept = checkpoint::read(&out, &bytes, &checkpoint::scene_hash(&text)).unwrap();
    assert_eq!((kept.header.time, kept.header.steps), (0.0, 0));
}

#[cfg(unix)]
#[test]
fn a_disk_that_is_full_stops_a_run_that_goes_on_when_it_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("tank.ron");
    // its table of forces grows beyond half a megabyte, which nothing else does
    let text = TANK
        .replace("forces: (interval: 0.002)", "forces: (interval: 0.0001)")
        .replace("duration: 0.4", "duration: 4.0")
        .replace("frame_interval: 0.02", "frame_interval: 0.2");
    fs::write(&case, text).unwrap();
    let (whole, full) = (folder.path().join("whole"), folder.path().join("full"));
    assert!(spawn(&case, &whole, &[]).wait().unwrap().success());
    assert!(600_000 < fs::metadata(whole.join("forces.csv")).unwrap().len());
    let limited = Command::new("bash")
        .args(["-c", "trap '' XFSZ; ulimit -f 500; exec \"$@\"", "bash"])
        .args([env!("CARGO_BIN_EXE_riprap"), "run", case.to_str().unwrap()])
        .args(["-o", full.to_str().unwrap(), "--quiet"])
        .output()
        .unwrap();
    assert_eq!(limited.status.code(), Some(1), "{}", words(&limited));
    let message = words(&limited);
    assert!(message.contains("forces.csv: File too large"), "{message}");
    // what there is of the table are whole rows but for the last, and the frames so far can be read
    let summary = support::summary(&full);
    assert!(summary["simulated_time"].as_f64().unwrap() > 0.05);
    assert!(
        summary["stop_reason"]
            .as_str()
            .unwrap()
            .contains("forces.csv")
    );
    for entry in fs::read_dir(&full).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|end| end == "vtp") {
            riprap::vtk::read(&path).unwrap();
        }
    }
    assert!(spawn(&case, &full, &["--resume"]).wait().unwrap().success());
    assert_same(&results(&full), &results(&whole));
}

#[test]
fn a_folder_that_is_removed_ends_the_run_with_the_name_of_what_is_gone() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("tank.ron"), folder.path().join("out"));
    fs::write(&case, TANK).unwrap();
    let child = Command::new(env!("CARGO_BIN_EXE_riprap"))
        .arg("run")
        .args([&case, Path::new("-o"), &out, Path::new("--quiet")])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while !out.join("water.pvd").exists() {
        std::thread::sleep(Duration::from_millis(2));
    }
    fs::rename(&out, folder.path().join("elsewhere")).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let message = words(&output);
    assert!(
        message.contains("error: cannot") && message.contains("No such file"),
        "{message}"
    );
    assert!(!message.contains("panicked"), "{message}");
    // what was written before is where it was taken
    assert!(riprap::vtk::read(&folder.path().join("elsewhere/water_00000.vtp")).is_ok());
}
