//! `riprap study`: the table of a study, a study that is killed, wrong studies.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::support::{case, riprap, words};

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
        "study",
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

/// Values that the scene takes one by one, and refuses together: bulk viscosity needs a rate of density. The usual scheme takes
/// short steps, so that the published one is cheaper and on the front.
#[test]
fn a_search_skips_what_the_scene_refuses_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "(title: \"coarse\", case: {:?}, design: Search(runs: 6),\n\
         set: [\"time.duration=0.3\", \"time.settle=0.1\", \"output.frame_interval=1\", \"fluid.resolution=Spacing(0.1)\"],\n\
         output: (name: \"deep\", column: \"deep\", take: Mean(from: 0.1, to: 0.3)),\n\
         truth: Closed(form: Hydrostatic(density: 1000, gravity: 9.81, depth: 0.9), scale: 9810),\n\
         knobs: [\n\
           (name: \"scheme\", values: [\n\
             (name: \"usual\", set: [\"numerics.time_step_factor=0.1\"]),\n\
             (name: \"published\", set: [\"numerics.preset=Mueller2003\", \"fluid.dynamic_viscosity=1\"])]),\n\
           (name: \"bulk\", values: [\n\
             (name: \"none\"),\n\
             (name: \"some\", set: [\"numerics.bulk_viscosity=0.1\"])])])",
        case("still_tank.ron").canonicalize().unwrap()
    );
    let (study, out) = (written(folder.path(), &text), folder.path().join("out"));
    let output = trade(&study, &out);
    assert!(output.status.success(), "{}", words(&output));
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{said}");
    let skipped: Vec<&str> = said
        .lines()
        .filter(|line| line.contains("skipped"))
        .collect();
    assert_eq!(skipped.len(), 1, "{said}");
    assert!(
        skipped[0].contains("scheme published, bulk some: ")
            && skipped[0].contains("bulk viscosity acts on the rate of density"),
        "{said}"
    );
    // the three others were run
    assert_eq!(rows(&out.join("trade.csv")).len(), 3);
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
                // the old name, for one release
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
        ("name: \"sound\"", "name: \"spacing\"", "duplicate knob"),
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

/// `accuracy.json` of a run folder.
fn accuracy(folder: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join("accuracy.json")).unwrap()).unwrap()
}

#[test]
fn a_budget_takes_the_least_work_of_the_study_and_says_whether_it_was_met() {
    let folder = tempfile::tempdir().unwrap();
    let tank = folder.path().join("tank.ron");
    std::fs::copy(case("still_tank.ron"), &tank).unwrap();
    let text = study("FullGrid")
        .replace(
            &format!("{:?}", case("still_tank.ron").canonicalize().unwrap()),
            "\"tank.ron\"",
        )
        // what sets the resolution and is NaN is no ladder of spacings
        .replace(
            "knobs: [",
            "knobs: [(name: \"preset\", values: [(name: \"Standard\", set: [\"fluid.resolution=Spacing(0.05)\"])]),",
        );
    let run = |budget: &str, name: &str| {
        let out = folder.path().join(name);
        let output = riprap(&[
            "run",
            tank.to_str().unwrap(),
            "--error",
            budget,
            "-o",
            out.to_str().unwrap(),
        ]);
        (output, out)
    };
    let study = written(folder.path(), &text);
    // nothing was measured yet: what would
    let (output, _) = run("1%", "early");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        words(&output).contains("riprap study"),
        "{}",
        words(&output)
    );
    let results = folder.path().join("results/study");
    assert!(trade(&study, &results).status.success());
    let rows = rows(&results.join("trade.csv"));
    let (errors, work) = (column(&rows, "error [-]"), column(&rows, "work [pairs]"));
    let mut sorted = errors.clone();
    sorted.sort_by(f64::total_cmp);
    // half of the runs are within it, with the tenth that is kept in hand
    let budget = 1.1001 * sorted[2];
    let best = (0..6)
        .filter(|&k| 1.1 * errors[k] <= budget)
        .min_by(|&a, &b| work[a].total_cmp(&work[b]))
        .unwrap();
    let (output, out) = run(&format!("{budget}"), "out");
    println!(
        "{}{}",
        words(&output),
        String::from_utf8_lossy(&output.stdout)
    );
    assert!(output.status.success(), "{}", words(&output));
    let found = accuracy(&out);
    // the same scene is the same run, to the bit
    let its = found["error"].as_f64().unwrap();
    assert!((its / errors[best] - 1.0).abs() < 1e-12, "{its} {errors:?}");
    assert_eq!(found["budget_met"], true);
    assert!(found["uncertainty"].as_f64().unwrap().is_finite());
    let (output, out) = run("0.0001%", "beyond");
    assert!(
        words(&output).contains("OUT OF REACH"),
        "{}",
        words(&output)
    );
    assert_eq!(accuracy(&out)["budget_met"], false);
    let named = |name: &str| {
        let out = folder.path().join("named");
        let (tank, out) = (tank.to_str().unwrap(), out.to_str().unwrap());
        riprap(&[
            "run", tank, "--error", "5%", "--of", name, "-o", out, "--force",
        ])
    };
    let output = named("mean_of_dep");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        words(&output).contains("`mean_of_deep`"),
        "{}",
        words(&output)
    );
}

#[test]
fn without_a_study_three_coarse_runs_predict() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let run = || {
        riprap(&[
            "run",
            case("still_tank.ron").to_str().unwrap(),
            "--error",
            "5%",
            "--of",
            "mean_of_deep",
            "--set",
            "time.duration=0.6",
            "--set",
            "time.settle=0.2",
            "--force",
            "-o",
            out.to_str().unwrap(),
        ])
    };
    let output = run();
    println!(
        "{}{}",
        words(&output),
        String::from_utf8_lossy(&output.stdout)
    );
    assert!(output.status.success(), "{}", words(&output));
    let found = accuracy(&out);
    let value = found["value"].as_f64().unwrap();
    // what was asked for, of ρ g z
    assert!((value / 8829.0 - 1.0).abs() < 0.05, "{value}");
    assert!(found["uncertainty"].as_f64().unwrap() < 0.05, "{found}");
    assert_eq!(found["budget_met"], true);
    // the levels are not run twice
    let again = words(&run());
    assert!(
        again.contains("3 of 3 runs") && !again.contains("2 of 3 runs"),
        "{again}"
    );
}

#[test]
fn a_scene_is_told_what_it_would_not_notice() {
    let check = |name: &str, set: &[&str]| {
        let path = case(name);
        let sets = set.iter().flat_map(|set| ["--set", set]);
        let arguments: Vec<&str> = ["check", path.to_str().unwrap()]
            .into_iter()
            .chain(sets)
            .collect();
        let output = riprap(&arguments);
        assert!(output.status.success(), "{}", words(&output));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let of = |text: &str| {
        let lines = text
            .lines()
            .filter(|line| line.contains("no effect at this resolution"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    let still = check(
        "still_tank.ron",
        &[
            "numerics.precision=Double",
            "numerics.time_step_factor=0.25",
        ],
    );
    assert!(of(&still)[0].contains("double precision"), "{still}");
    assert!(
        of(&still)[1].contains("time-step factor of 0.25"),
        "{still}"
    );
    // a slab whose blocks go through, and one with a block that does not
    let slab = "domain=(min: (-3.2307692, 0, -0.3), max: (5.3, 0.0923077, 1.8), periodic: [Y])";
    assert!(of(&check("sliding_wedge.ron", &[slab]))[0].contains("its width"));
    let narrow = "blocks.wedge.shape=Box(min: (-1.9, 0.02, 1.2), max: (-1.7, 0.06, 1.4))";
    let text = check("sliding_wedge.ron", &[slab, narrow]);
    assert!(!text.contains("its width"), "{text}");
    // rock of 50 GPa that falls from nowhere strains by next to nothing, soft clay does not
    let column =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../benches/trade/cases/elastic_column.ron");
    let column = column.to_str().unwrap();
    assert!(!check(column, &[]).contains("deformable blocks:"));
    let stiff = "materials.rock.elastic=(young_modulus: 5e10, poisson_ratio: 0)";
    let slow = "numerics.expected_speed=0.1";
    assert!(of(&check(column, &[stiff, slow]))[0].contains("deformable blocks:"));
    // what asks for nothing is told nothing
    assert!(of(&check("still_tank.ron", &[])).is_empty());
}
