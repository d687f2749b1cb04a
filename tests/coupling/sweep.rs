//! `riprap sweep` and `riprap collect`: one table whoever starts the rows, rows that are stopped, refused or fail, wrong sweeps.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::evidence::THROWN;
use crate::support::{case, riprap, words};

/// Pressure in the coarse still tank over its sound speed and density.
fn tank(design: &str) -> String {
    format!(
        "(title: \"coarse\", case: {:?}, design: {design},\n\
         set: [\"time.settle=0.2\", \"output.frame_interval=1\", \"fluid.resolution=Spacing(0.1)\"],\n\
         inputs: [\n\
           (name: \"sound\", set: [\"numerics.sound_speed={{}}\"], values: Uniform(from: 20, to: 40)),\n\
           (name: \"density\", set: [\"fluid.density={{}}\"], values: Triangular(from: 950, mode: 1000, to: 1100)),\n\
           (name: \"duration\", set: [\"time.duration={{}}\"], values: Numbers([0.6]))],\n\
         outputs: [(name: \"deep\", column: \"deep\", take: Mean(from: 0.2, to: 0.6))])",
        case("still_tank.ron").canonicalize().unwrap()
    )
}

fn written(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("sweep.ron");
    std::fs::write(&path, text).unwrap();
    path
}

fn sweep(file: &Path, out: &Path, more: &[&str]) -> Output {
    let mut arguments = vec!["sweep", file.to_str().unwrap(), "-o", out.to_str().unwrap()];
    arguments.extend(more);
    riprap(&arguments)
}

fn collected(out: &Path) -> String {
    std::fs::read_to_string(out.join("collected.csv")).unwrap()
}

/// Cells of a column of a table without quoted cells before it.
fn column(table: &str, name: &str) -> Vec<String> {
    let mut lines = table.lines();
    let k = lines
        .next()
        .unwrap()
        .split(',')
        .position(|head| head == name)
        .unwrap();
    lines
        .map(|line| line.split(',').nth(k).unwrap().to_owned())
        .collect()
}

#[test]
fn rows_give_one_table_whoever_starts_them() {
    let folder = tempfile::tempdir().unwrap();
    let file = written(folder.path(), &tank("LatinHypercube(runs: 6, seed: 1)"));
    let (here, there) = (folder.path().join("here"), folder.path().join("there"));
    let output = sweep(&file, &here, &["--jobs", "2"]);
    assert!(output.status.success(), "{}", words(&output));
    let table = collected(&here);
    assert_eq!(column(&table, "exit"), ["0"; 6]);
    // hydrostatic, 0.9 m deep: 3 % ten spacings deep, as the study of this tank has it
    for (pressure, density) in column(&table, "deep").iter().zip(column(&table, "density")) {
        let exact = density.parse::<f64>().unwrap() * 9.81 * 0.9;
        assert!(
            (pressure.parse::<f64>().unwrap() / exact - 1.0).abs() < 0.03,
            "{table}"
        );
    }
    // six draws of a density that pressure is proportional to
    let effects = std::fs::read_to_string(here.join("sensitivity.csv")).unwrap();
    let strongest = &column(&effects, "rank_correlation [-]")[1];
    assert!(0.8 < strongest.parse::<f64>().unwrap(), "{effects}");
    let curve = std::fs::read_to_string(here.join("exceedance.csv")).unwrap();
    assert_eq!(curve.lines().count(), 7, "{curve}");
    let page = std::fs::read_to_string(here.join("sweep.html")).unwrap();
    assert!(page.contains("6 rows: 6 completed") && page.contains("<svg"));

    // line by line by a shell, one of them twice, in another order
    let lines = sweep(&file, &there, &["--emit", "list"]);
    let lines = String::from_utf8(lines.stdout).unwrap();
    assert_eq!(lines.lines().count(), 6);
    for line in lines.lines().rev().chain(lines.lines().take(1)) {
        let output = Command::new("sh").args(["-c", line]).output().unwrap();
        assert!(output.status.success(), "{line}: {}", words(&output));
    }
    let arguments = [
        "collect",
        file.to_str().unwrap(),
        "-o",
        there.to_str().unwrap(),
    ];
    assert!(riprap(&arguments).status.success());
    assert_eq!(collected(&there), table);
    // all have ended: nothing is left to start
    let left = sweep(&file, &there, &["--emit", "slurm"]);
    assert!(left.status.success() && left.stdout.is_empty());
}

#[test]
fn a_row_out_of_time_goes_on_to_the_same_state() {
    let folder = tempfile::tempdir().unwrap();
    // some seconds of wall time
    let text = tank("Sobol(runs: 1, seed: 1)")
        .replace("Numbers([0.6])", "Numbers([40])")
        .replace("Spacing(0.1)", "Spacing(0.05)");
    let file = written(folder.path(), &text);
    let (whole, parts) = (folder.path().join("whole"), folder.path().join("parts"));
    let output = sweep(&file, &whole, &[]);
    assert!(output.status.success(), "{}", words(&output));
    let mut stops = 0;
    loop {
        let output = sweep(&file, &parts, &["--row", "1", "--wall-limit", "1"]);
        match output.status.code() {
            Some(4) => stops += 1,
            Some(0) => break,
            _ => panic!("{}", words(&output)),
        }
        let arguments = [
            "collect",
            file.to_str().unwrap(),
            "-o",
            parts.to_str().unwrap(),
        ];
        assert_eq!(riprap(&arguments).status.code(), Some(4), "not finished");
        assert_eq!(column(&collected(&parts), "exit"), [""]);
    }
    assert!(0 < stops, "the run was too short to be stopped");
    let output = sweep(&file, &parts, &[]);
    assert!(output.status.success(), "{}", words(&output));
    assert_eq!(collected(&parts), collected(&whole));
}

/// A scene that fails in a step, one that is refused, and one that completes.
#[test]
fn who_failed_and_why_is_in_the_table() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("thrown.ron"), THROWN).unwrap();
    let text = "(title: \"thrown\", case: \"thrown.ron\", design: List,\n\
         inputs: [\n\
           (name: \"speed\", set: [\"fluid.regions.water.velocity=(0, 0, -{})\"], values: Numbers([6, 0.5, 0.5])),\n\
           (name: \"sound\", set: [\"numerics.sound_speed={}\"], values: Numbers([9, -1, 20]))],\n\
         outputs: [(name: \"p\", column: \"p\", take: Maximum(from: 0, to: 0.3))])";
    let file = written(folder.path(), text);
    let out = folder.path().join("out");
    let output = sweep(&file, &out, &[]);
    let said = words(&output);
    assert!(output.status.success(), "{said}");
    let of_row = "1 of 3 rows make no scene; the first is row 2, speed 0.5, sound -1";
    assert!(said.contains(of_row), "{said}");
    let table = collected(&out);
    println!("{table}");
    assert_eq!(column(&table, "exit"), ["1", "2", "0"]);
    assert_eq!(column(&table, "p")[..2], ["NaN", "NaN"]);
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[1].contains("a shorter step does not help"), "{table}");
    assert!(lines[2].contains("sound speed must be > 0"), "{table}");
    let page = std::fs::read_to_string(out.join("sweep.html")).unwrap();
    assert!(page.contains("Runs that failed: 2"));
    // a run that failed is not repeated
    let row = sweep(&file, &out, &["--row", "1"]);
    assert_eq!(row.status.code(), Some(1), "{}", words(&row));
    let row = sweep(&file, &out, &["--row", "2"]);
    assert_eq!(row.status.code(), Some(2), "{}", words(&row));
}

#[test]
fn wrong_sweeps_are_refused_at_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |text: &str| {
        let file = written(folder.path(), text);
        let output = sweep(&file, &folder.path().join("out"), &[]);
        assert_eq!(output.status.code(), Some(2), "{}", words(&output));
        words(&output)
    };
    let right = tank("Sobol(runs: 4, seed: 1)");
    for (from, to, place, message) in [
        (
            "sound_speed={}",
            "sound_speed=3",
            ":4:",
            "has no place for the value: write {} there",
        ),
        (
            "Uniform(from: 20, to: 40)",
            "Uniform(from: 40, to: 20)",
            ":4:",
            "`to` is larger than `from`",
        ),
        (
            "mode: 1000",
            "mode: 900",
            ":5:",
            "expected from <= mode <= to",
        ),
        (
            "Sobol(runs: 4, seed: 1)",
            "Grid",
            ":4:",
            "has a distribution, which this design cannot take",
        ),
        (
            "Sobol(runs: 4, seed: 1)",
            "Sobol(runs: 0, seed: 1)",
            ":1:",
            "no runs",
        ),
        (
            "Sobol(runs: 4, seed: 1)",
            "Sobol(runs: 70000, seed: 1)",
            ":1:",
            "at most 65536",
        ),
        (
            "take: Mean(from: 0.2, to: 0.6)",
            "",
            ":7:",
            "give an evaluation of the column",
        ),
        (
            "\"density\", set",
            "\"sound\", set",
            ":5:",
            "duplicate input `sound`",
        ),
        ("Numbers([0.6])", "Numbers([])", ":6:", "no values"),
        ("inputs", "input", ":3:", "inputs"),
    ] {
        assert!(right.contains(from), "{from}");
        let said = refused(&right.replacen(from, to, 1));
        assert!(
            said.contains(message) && said.contains(place),
            "{to}: {said}"
        );
    }
    // a field that no scene has: every row
    let said = refused(&right.replace("numerics.sound_speed", "numerics.speed_of_sound"));
    assert!(said.contains("4 of 4 rows make no scene"), "{said}");
    let missing = sweep(&folder.path().join("none.ron"), folder.path(), &[]);
    assert!(words(&missing).contains("cannot read the sweep"));
    // a number of a row that there is not
    let file = written(folder.path(), &right);
    let row = sweep(&file, folder.path(), &["--row", "5"]);
    assert!(
        words(&row).contains("no row 5: the sweep has rows 1 to 4"),
        "{}",
        words(&row)
    );
}

#[test]
fn scripts_are_of_their_shell_and_name_what_is_left() {
    let folder = tempfile::tempdir().unwrap();
    let file = written(folder.path(), &tank("LatinHypercube(runs: 5, seed: 1)"));
    let out = folder.path().join("out");
    assert!(sweep(&file, &out, &["--row", "3"]).status.success());
    let script = sweep(&file, &out, &["--emit", "slurm"]);
    assert!(script.status.success(), "{}", words(&script));
    let text = String::from_utf8(script.stdout).unwrap();
    assert!(text.contains("#SBATCH --array=1-2,4-5\n"), "{text}");
    // ten minutes at least
    assert!(text.contains("#SBATCH --time=00:10:00\n"), "{text}");
    let path = folder.path().join("job.sh");
    std::fs::write(&path, &text).unwrap();
    let parsed = Command::new("bash").arg("-n").arg(&path).output().unwrap();
    assert!(parsed.status.success(), "{}", words(&parsed));
    let file = sweep(&file, &out, &["--emit", "hq", "--wall-limit", "90min"]);
    let text = String::from_utf8(file.stdout).unwrap();
    assert_eq!(
        text.matches("time_request = \"5400s\"").count(),
        4,
        "{text}"
    );
}
