//! `riprap trade`: the table of a study, a study that is killed, wrong studies.
#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops at the first thing that is wrong, and measured figures stand beside their bounds"
)]

#[path = "../support/mod.rs"]
mod support;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use support::{case, riprap, words};

/// Pressure in the coarse still tank, for three spacings and two sound speeds.
fn study(design: &str) -> String {
    format!(
        "(title: \"coarse\", case: {:?}, design: {design},\n\
         set: [\"time.duration=0.6\", \"time.settle=0.2\", \"output.frame_interval=1\"],\n\
         output: (name: \"deep\", column: \"deep\", take: Mean(from: 0.2, to: 0.6)),\n\
         truth: Closed(form: Hydrostatic(density: 1000, gravity: 9.81, depth: 0.9), scale: 9810),\n\
         knobs: [\n\
           (name: \"spacing\", values: [\n\
             (name: \"0.1\", at: 0.1, set: [\"fluid.resolution=Spacing(0.1)\"]),\n\
             (name: \"0.05\", at: 0.05),\n\
             (name: \"0.08\", at: 0.08, set: [\"fluid.resolution=Spacing(0.08)\"])]),\n\
           (name: \"sound\", values: [\n\
             (name: \"slow\", set: [\"numerics.sound_speed=20\"]),\n\
             (name: \"fast\", set: [\"numerics.sound_speed=40\"])])])",
        case("still_tank.ron").canonicalize().unwrap()
    )
}

fn written(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("study.ron");
    std::fs::write(&path, text).unwrap();
    path
}

fn trade(study: &Path, out: &Path) -> Output {
    riprap(&[
        "trade",
        study.to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
    ])
}

/// Lines of a table by the names of its columns, without those that a clock makes.
fn rows(path: &Path) -> Vec<Vec<(String, String)>> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
    let heads: Vec<String> = lines.next().unwrap().collect();
    let by_clock = ["wall_time [s]", "peak_memory [B]", "on_front_by_time"];
    lines
        .map(|cells| {
            let cells = heads.iter().cloned().zip(cells);
            cells
                .filter(|(head, _)| !by_clock.contains(&head.as_str()))
                .collect()
        })
        .collect()
}

fn column(rows: &[Vec<(String, String)>], name: &str) -> Vec<f64> {
    let cell = |row: &Vec<(String, String)>| {
        let (_, text) = row.iter().find(|(head, _)| head == name).unwrap();
        text.parse().unwrap()
    };
    rows.iter().map(cell).collect()
}

#[test]
fn a_grid_gives_a_row_per_run_and_work_as_theory_has_it() {
    let folder = tempfile::tempdir().unwrap();
    let (study, out) = (
        written(folder.path(), &study("FullGrid")),
        folder.path().join("out"),
    );
    let output = trade(&study, &out);
    assert!(output.status.success(), "{}", words(&output));
    let rows = rows(&out.join("trade.csv"));
    assert_eq!(rows.len(), 6);
    let (errors, work) = (column(&rows, "error [-]"), column(&rows, "work [pairs]"));
    println!("errors {errors:?}\nwork {work:?}");
    // measured 1.2 % at most, ten spacings deep: every run is one of water at rest
    assert!(errors.iter().all(|error| *error < 0.03), "{errors:?}");
    // twice the sound speed, twice the steps; step counts are whole
    for pair in work.chunks(2) {
        assert!((pair[1] / pair[0] - 2.0).abs() < 0.05, "{work:?}");
    }
    // half the spacing in a plane: four times the particles and twice the steps, and fewer of them at edges
    let ratio = work[2] / work[0];
    assert!((7.0..12.0).contains(&ratio), "{ratio}");
    let svg = std::fs::read_to_string(out.join("trade.svg")).unwrap();
    assert!(
        12 <= svg.matches("<circle").count(),
        "each run in two plots"
    );
    let png = std::fs::read(out.join("trade.png")).unwrap();
    assert_eq!(&png[1..4], b"PNG");
    // nothing is run twice: the second time takes no longer than reading
    let table = std::fs::read(out.join("trade.csv")).unwrap();
    let output = trade(&study, &out);
    assert!(words(&output).contains("6 of 6 runs"), "{}", words(&output));
    assert_eq!(words(&output).lines().count(), 1, "{}", words(&output));
    assert_eq!(std::fs::read(out.join("trade.csv")).unwrap(), table);
}

#[test]
fn a_study_that_was_killed_ends_with_the_same_table() {
    let folder = tempfile::tempdir().unwrap();
    let study = written(folder.path(), &study("Search(runs: 6)"));
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    assert!(trade(&study, &whole).status.success());
    let ended = || {
        let entries = std::fs::read_dir(&broken).into_iter().flatten();
        entries
            .filter(|e| e.as_ref().unwrap().path().join("ended.json").exists())
            .count()
    };
    // killed with no time to clean up, with runs under way, again and again
    for enough in [1, 3, 5] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_riprap"))
            .args([
                "trade",
                study.to_str().unwrap(),
                "-o",
                broken.to_str().unwrap(),
            ])
            .stderr(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let started = Instant::now();
        while ended() < enough && started.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(5));
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let output = trade(&study, &broken);
    assert!(output.status.success(), "{}", words(&output));
    assert_eq!(
        rows(&broken.join("trade.csv")),
        rows(&whole.join("trade.csv"))
    );
    let keys: BTreeSet<String> = rows(&whole.join("trade.csv"))
        .iter()
        .map(|row| {
            row.iter()
                .find(|(head, _)| head == "run")
                .unwrap()
                .1
                .clone()
        })
        .collect();
    assert!(
        keys.iter()
            .all(|key| broken.join(key).join("summary.json").is_file())
    );
}

#[test]
fn what_fails_is_a_row_and_not_the_end_of_the_study() {
    let folder = tempfile::tempdir().unwrap();
    // slower than water falls: it is crushed
    let text = study("OneAtATime").replace(
        "(name: \"fast\", set: [\"numerics.sound_speed=40\"])",
        "(name: \"wild\", set: [\"numerics.sound_speed=1.5\"])",
    );
    let (study, out) = (written(folder.path(), &text), folder.path().join("out"));
    let output = trade(&study, &out);
    println!(
        "{}{}",
        words(&output),
        String::from_utf8_lossy(&output.stdout)
    );
    assert!(output.status.success(), "{}", words(&output));
    let stable = column(&rows(&out.join("trade.csv")), "stable");
    assert_eq!(stable.iter().sum::<f64>(), 3.0, "{stable:?}");
}

/// A falling block amid fixed ones, and a column that is not there.
#[test]
fn one_block_of_a_table_is_judged_and_a_column_that_is_not_there_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "(title: \"fall\", domain: (min: (-9, -9, -9), max: (9, 9, 9)), time: (duration: 0.5),\n\
         materials: [(name: \"m\", density: 2000, friction_angle_deg: 30)], output: (gauge_interval: 0.01), blocks: [\n\
         (name: \"low\", material: \"m\", shape: Box(min: (-1, -1, 0), max: (1, 1, 1))),\n\
         (name: \"high\", material: \"m\", shape: Box(min: (-1, -1, 4), max: (1, 1, 5)))])";
    std::fs::write(folder.path().join("fall.ron"), scene).unwrap();
    let study = |column: &str| {
        format!(
            "(title: \"fall\", case: \"fall.ron\",\n\
             output: (name: \"z\", file: \"blocks.csv\", block: \"high\", column: \"{column}\", take: At(0.4)),\n\
             truth: Value(value: 3.7152, source: \"4.5 - g t^2/2\"),\n\
             knobs: [(name: \"step\", values: [(name: \"0.8\"), (name: \"0.4\", set: [\"numerics.block_time_step_factor=0.4\"])])])"
        )
    };
    let out = folder.path().join("out");
    let output = trade(&written(folder.path(), &study("z")), &out);
    assert!(output.status.success(), "{}", words(&output));
    let errors = column(&rows(&out.join("trade.csv")), "error [-]");
    // central differences are exact for a constant force; a line between samples 0.01 s apart is off by g dt²/8
    assert!(errors.iter().all(|error| *error < 1e-4), "{errors:?}");
    let output = trade(
        &written(folder.path(), &study("height")),
        &folder.path().join("none"),
    );
    let table = std::fs::read_to_string(folder.path().join("none/trade.csv")).unwrap();
    assert!(table.contains("height"), "{table} {}", words(&output));
}

#[test]
fn a_wrong_study_is_told_where_and_what_would_be_right() {
    let folder = tempfile::tempdir().unwrap();
    let good = study("OneAtATime");
    for (from, to, expected) in [
        ("design: OneAtATime", "design: OneAtTime", "study.ron:1:"),
        (
            "numerics.sound_speed=40",
            "numerics.sound_sped=40",
            "sound_speed",
        ),
        ("scale: 9810", "scale: 0", "scale"),
        (", take: Mean(from: 0.2, to: 0.6)", "", "take"),
        ("name: \"sound\"", "name: \"spacing\"", "two knobs"),
        (
            "numerics.sound_speed=40",
            "numerics.sound_speed",
            "PATH=VALUE",
        ),
        (
            "column: \"deep\"",
            "block: \"flor\", column: \"deep\"",
            "`floor`",
        ),
    ] {
        assert_eq!(good.matches(from).count(), 1, "{from}");
        let study = written(folder.path(), &good.replace(from, to));
        let output = trade(&study, &folder.path().join("out"));
        println!("{}", words(&output));
        assert_eq!(output.status.code(), Some(2));
        assert!(
            words(&output).contains(expected),
            "{expected}: {}",
            words(&output)
        );
    }
}
