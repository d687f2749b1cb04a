//! Who is who among the blocks of a run: `bodies.csv`, attitudes in `blocks.csv`, `riprap inspect`.

use std::fs;

use riprap::output::bodies;
use riprap::table::read_table;

use crate::support::{riprap, run, words};

/// A cube that turns by one radian a second about z, without weight, beside one that stands.
const SPIN: &str = r#"(
    title: "Spin",
    gravity: (0, 0, 0),
    domain: (min: (-2, -2, -2), max: (2, 2, 2)),
    materials: [(name: "rock", density: 2500, friction_angle_deg: 30)],
    blocks: [
        (name: "old post", material: "rock", motion: Fixed, shape: Box(min: (1, 1, 1), max: (1.5, 1.5, 1.5))),
        (name: "cube", material: "rock", velocity: (0.1, 0, 0), angular_velocity: (0, 0, 1),
         shape: Box(min: (-0.2, -0.2, -0.2), max: (0.2, 0.2, 0.2))),
    ],
    time: (duration: 0.5),
    output: (ledger_interval: 0.1),
)"#;

#[test]
fn blocks_have_names_and_attitudes() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("spin.ron");
    fs::write(&case, SPIN).unwrap();
    let out = folder.path().join("out");
    run(&case, &out, &["--no-report"]);
    let rows = bodies::read(&out).unwrap();
    let told: Vec<_> = rows
        .iter()
        .map(|row| (row.block, row.name.as_str(), row.kind.as_str()))
        .collect();
    assert_eq!(told, [(0, "old post", "fixed"), (1, "cube", "free")]);
    assert!((rows[1].mass - 2500.0 * 0.064).abs() < 1e-9 && (rows[1].volume - 0.064).abs() < 1e-12);

    let table = read_table(&out.join("blocks.csv")).unwrap();
    let last = |name: &str| *table.column(name).unwrap().last().unwrap();
    // a cube has no axis that it would rather turn about: the angle is that of the time, to the square of the step
    let angle = last("time");
    assert!((angle - 0.5).abs() < 1e-3);
    assert!(
        (last("yaw") - angle).abs() < 1e-6,
        "{} for {angle}",
        last("yaw")
    );
    assert!(
        (last("qz") - (0.5 * angle).sin()).abs() < 1e-6
            && (last("qw") - (0.5 * angle).cos()).abs() < 1e-6
    );
    assert!(last("roll").abs() < 1e-9 && last("pitch").abs() < 1e-9);

    let inspect = |more: &[&str]| {
        let output = riprap(&[&["inspect", out.to_str().unwrap()], more].concat());
        assert!(output.status.success(), "{}", words(&output));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let told = inspect(&[]);
    println!("{told}");
    assert!(
        told.contains("2 blocks, 1 of them fixed; at t = 0.5"),
        "{told}"
    );
    let line = told.lines().find(|line| line.contains("cube")).unwrap();
    assert!(
        line.contains("free") && line.contains("1.600e2") && line.contains("0.050"),
        "{line}"
    );
    assert!(!told.contains("post") && inspect(&["--all"]).contains("old post"));
    assert!(
        line.contains("rock") && line.contains("moves"),
        "group, material and state: {line}"
    );
    let history = inspect(&["--block", "cube"]);
    let rows: Vec<&str> = history.lines().skip(2).collect();
    assert!(
        history.starts_with("block 1 `cube`, free: 1.600e2 kg") && rows.len() == 6,
        "{history}"
    );
    assert!(rows[5].trim_start().starts_with("0.5") && rows[5].contains("0.050"));
    let wrong = riprap(&["inspect", out.to_str().unwrap(), "--block", "cub"]);
    assert_eq!(wrong.status.code(), Some(1));
    assert!(words(&wrong).contains("`cube`"), "{}", words(&wrong));
    // a run under way: its last row is not complete
    let rows = fs::read_to_string(out.join("blocks.csv")).unwrap();
    fs::write(out.join("blocks.csv"), rows.clone() + "0.6,1,0.06").unwrap();
    fs::remove_file(out.join("summary.json")).unwrap();
    assert!(inspect(&[]).contains("; at t = 0.5"));
    // a run of an earlier version: no list of bodies, no names in the table
    fs::remove_file(out.join("bodies.csv")).unwrap();
    let shorter = |line: &str| line.rsplitn(3, ',').last().unwrap_or_default().to_owned();
    let old: Vec<String> = rows.lines().map(shorter).collect();
    fs::write(out.join("blocks.csv"), old.join("\n") + "\n").unwrap();
    let told = inspect(&["--all"]);
    let line = told.lines().find(|line| line.contains("cube")).unwrap();
    assert!(line.contains("moving") && line.contains("0.050"), "{told}");
    let before = inspect(&["--at", "0.25"]);
    assert!(before.contains("at t = 0.2"), "{before}");
    let nothing = riprap(&["inspect", folder.path().join("none").to_str().unwrap()]);
    assert_eq!(nothing.status.code(), Some(1));
    assert!(words(&nothing).contains("case.ron"), "{}", words(&nothing));
}

#[test]
fn shells_and_man_know_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let commands = [
        "new", "run", "check", "render", "report", "paraview", "inspect", "compare", "study",
    ];
    let bash = riprap(&["completions", "bash"]);
    let bash = String::from_utf8_lossy(&bash.stdout).into_owned();
    let pages = folder.path().join("man");
    assert!(riprap(&["man", pages.to_str().unwrap()]).status.success());
    for command in commands {
        assert!(
            bash.contains(&format!("riprap__subcmd__{command}"))
                || bash.contains(&format!("riprap__{command}")),
            "{command}"
        );
        let page = fs::read_to_string(pages.join(format!("riprap-{command}.1"))).unwrap();
        assert!(page.contains(".SH OPTIONS"), "{command}");
    }
}
