//! `riprap handoff`: files of a run's water, whose volume and momentum are those of its particles.

use std::path::Path;

use serde_json::Value;

use crate::support::{case, riprap, run, table, words};

fn hand_over(folder: &Path, more: &[&str]) -> Value {
    let mut arguments = vec!["handoff", folder.to_str().unwrap()];
    arguments.extend(more);
    let output = riprap(&arguments);
    assert!(output.status.success(), "{}", words(&output));
    println!("{}", String::from_utf8_lossy(&output.stdout));
    let text = std::fs::read_to_string(folder.join("handoff/handoff.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// Relative to a scale.
fn assert_near(found: &Value, expected: &Value, scale: f64) {
    let (found, expected) = (found.as_f64().unwrap(), expected.as_f64().unwrap());
    assert!(
        (found - expected).abs() <= 1e-12 * scale,
        "{found} for {expected}"
    );
}

#[test]
fn still_water_is_handed_over_as_still() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let more = [
        "--until",
        "0.1",
        "--set",
        "time.settle=0",
        "--set",
        "fluid.resolution=Spacing(0.05)",
    ];
    run(&case("still_tank.ron"), &out, &more);
    let numbers = hand_over(&out, &[]);
    let volume = numbers["volume_of_particles_m3"].as_f64().unwrap();
    assert_near(
        &numbers["volume_of_columns_m3"],
        &numbers["volume_of_particles_m3"],
        volume,
    );
    let level = numbers["still_water_level_m"].as_f64().unwrap();
    let rows = table(&out.join("handoff/section.csv"));
    let wet: Vec<&Vec<f64>> = rows.iter().filter(|row| 0.0 < row[3]).collect();
    assert!(10 < wet.len());
    // over the step of its bed and beside its walls samples of the ground are an eighth of a cell, and water keeps off by half a spacing
    let off = wet.iter().filter(|row| 0.01 < (row[2] - level).abs());
    assert!(off.count() <= 6, "{wet:?}");
    // a bed that is flat over three cells has the level to the compression of the water, ρ g z/(ρ c²) of its depth
    let flat = rows
        .windows(3)
        .filter(|rows| rows.iter().all(|row| 0.0 < row[3] && row[1] == rows[1][1]));
    let errors: Vec<f64> = flat.map(|rows| (rows[1][2] - level).abs()).collect();
    assert!(
        5 < errors.len() && errors.iter().all(|error| *error < 0.005),
        "{errors:?}"
    );
    assert!(wet.iter().all(|row| row[4].abs() < 0.02), "nothing moves");
}

/// Water in space that falls apart: all files, and both sides of what is conserved.
#[test]
fn a_dam_break_in_space_keeps_volume_and_momentum() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let scene = folder.path().join("scene.ron");
    std::fs::write(
        &scene,
        r#"(
    title: "A column of water falls apart",
    domain: (min: (-0.2, -0.2, -0.2), max: (2.2, 0.8, 1.2)),
    materials: [(name: "rock", density: 2400, friction_angle_deg: 30)],
    blocks: [
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.2, -0.2, -0.2), max: (2.2, 0.8, 0))),
        (name: "west", material: "rock", motion: Fixed, shape: Box(min: (-0.2, -0.2, 0), max: (0, 0.8, 1.2))),
        (name: "east", material: "rock", motion: Fixed, shape: Box(min: (2, -0.2, 0), max: (2.2, 0.8, 1.2))),
        (name: "south", material: "rock", motion: Fixed, shape: Box(min: (0, -0.2, 0), max: (2, 0, 1.2))),
        (name: "north", material: "rock", motion: Fixed, shape: Box(min: (0, 0.6, 0), max: (2, 0.8, 1.2))),
    ],
    fluid: (resolution: Spacing(0.05), regions: [(name: "water", shape: Box(min: (0, 0, 0), max: (0.8, 0.6, 0.6)))]),
    time: (duration: 0.3),
)"#,
    )
    .unwrap();
    run(&scene, &out, &[]);
    let numbers = hand_over(
        &out,
        &["--format", "netcdf,esri,funwave,geoclaw", "--look", "2"],
    );
    let volume = numbers["volume_of_particles_m3"].as_f64().unwrap();
    assert!((volume / (0.8 * 0.6 * 0.6) - 1.0).abs() < 1e-3);
    assert_near(
        &numbers["volume_of_columns_m3"],
        &numbers["volume_of_particles_m3"],
        volume,
    );
    let momentum = &numbers["momentum_of_particles_kg_m_per_s"];
    let scale = momentum[0].as_f64().unwrap();
    // it flows to the east
    assert!(0.1 < scale / (1000.0 * volume));
    for axis in 0..2 {
        assert_near(
            &numbers["momentum_of_columns_kg_m_per_s"][axis],
            &momentum[axis],
            scale,
        );
    }
    let at = |name: &str| out.join("handoff").join(name);
    for name in [
        "handoff.nc",
        "eta.asc",
        "eta.tif",
        "u.asc",
        "funwave/input.txt",
        "geoclaw/hv.xyz",
        "look.csv",
    ] {
        assert!(at(name).exists(), "{name}");
    }
    // a text of a file as it is read elsewhere: discharge through a section is what the columns say
    let lines = std::fs::read_to_string(at("geoclaw/hu.xyz")).unwrap();
    let cells: Vec<Vec<f64>> = lines
        .lines()
        .map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect())
        .collect();
    let [nx, ny] = [0, 1].map(|k| numbers["cells"][k].as_u64().unwrap() as usize);
    assert_eq!(cells.len(), nx * ny);
    assert!(
        cells[1][0] > cells[0][0] && cells[nx][1] < cells[0][1],
        "from the north-west, row by row"
    );
    let area = 0.1 * 0.1;
    // compressed water of dry and half open cells has momentum, too
    let carried: f64 = cells.iter().map(|cell| 1000.0 * cell[2] * area).sum();
    assert!((carried / scale - 1.0).abs() < 0.05, "{carried} of {scale}");
    // the front has left its column and the rest stands
    let advice = numbers["fitness"]["advice"].as_str().unwrap();
    assert!(["NotYet", "ShallowWater"].contains(&advice), "{advice}");
}

#[test]
fn what_cannot_be_handed_over_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |arguments: &[&str]| {
        let output = riprap(&[&["handoff"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{}", words(&output));
        words(&output)
    };
    let empty = folder.path().to_str().unwrap();
    assert!(refused(&[empty]).contains("name the folder of a run"));
    let out = folder.path().join("run");
    let more = [
        "--until",
        "0.02",
        "--set",
        "time.settle=0",
        "--set",
        "fluid.resolution=Spacing(0.1)",
    ];
    run(&case("still_tank.ron"), &out, &more);
    let out_text = out.to_str().unwrap();
    assert!(
        refused(&[out_text, "--cell", "0.01"])
            .contains("a column is at least a particle spacing wide")
    );
    std::fs::remove_file(out.join("checkpoint.bin")).unwrap();
    assert!(refused(&[out_text]).contains("has no checkpoint"));
    // rock without water
    let out = folder.path().join("rock");
    run(&case("arch.ron"), &out, &["--until", "0.01"]);
    assert!(refused(&[out.to_str().unwrap()]).contains("no water to hand over"));
}

/// A column of water collapses in a closed box: no block drives it, so that the run hands over at its end or at given times.
const COLLAPSE: &str = r#"(
    title: "A column of water falls apart",
    domain: (min: (-0.2, -0.2, -0.2), max: (2.2, 0.8, 1.2)),
    materials: [(name: "rock", density: 2400, friction_angle_deg: 30)],
    blocks: [
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.2, -0.2, -0.2), max: (2.2, 0.8, 0))),
        (name: "west", material: "rock", motion: Fixed, shape: Box(min: (-0.2, -0.2, 0), max: (0, 0.8, 1.2))),
        (name: "east", material: "rock", motion: Fixed, shape: Box(min: (2, -0.2, 0), max: (2.2, 0.8, 1.2))),
        (name: "south", material: "rock", motion: Fixed, shape: Box(min: (0, -0.2, 0), max: (2, 0, 1.2))),
        (name: "north", material: "rock", motion: Fixed, shape: Box(min: (0, 0.6, 0), max: (2, 0.8, 1.2))),
    ],
    fluid: (resolution: Spacing(0.05), regions: [(name: "water", shape: Box(min: (0, 0, 0), max: (0.8, 0.6, 0.6)))]),
    handoff: (
        times: At([0.3, 0.1]), cell: 0.1, level: 0.2, formats: [NetCdf, Geoclaw, Swash],
        lines: [(name: "middle", from: (0.8, 0), to: (0.8, 0.6))],
    ),
    output: (gauge_interval: 0.02),
    time: (duration: 0.4),
)"#;

fn read(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The flow out of a column through a line is what the column loses; a run that is stopped and resumed hands over the same bits.
#[test]
fn a_run_hands_over_at_its_times_and_records_its_lines() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.ron");
    std::fs::write(&scene, COLLAPSE).unwrap();
    let whole = folder.path().join("whole");
    run(&scene, &whole, &[]);
    let path = whole.join("handoff_lines.csv");
    let rows = table(&path);
    // to the right of a line to the north is east
    let passed: f64 = rows
        .windows(2)
        .map(|pair| 0.5 * (pair[0][3] + pair[1][3]) * (pair[1][0] - pair[0][0]))
        .sum();
    let mut beyond = Vec::new();
    for at in ["t_0.1", "t_0.3"] {
        let text = read(&whole, &format!("handoff/{at}/handoff.json"));
        let numbers: Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(numbers["reason"], "Given");
        assert_eq!(numbers["still_water_level_m"], 0.2);
        let text =
            String::from_utf8(read(&whole, &format!("handoff/{at}/geoclaw/hu.xyz"))).unwrap();
        let eta =
            String::from_utf8(read(&whole, &format!("handoff/{at}/geoclaw/eta.xyz"))).unwrap();
        let value = |line: &str| line.rsplit(' ').next().unwrap().parse::<f64>().unwrap();
        let x = |line: &str| line.split(' ').next().unwrap().parse::<f64>().unwrap();
        // over the bed, which is 0.2 m below the level
        let volume = eta
            .lines()
            .filter(|line| 0.8 < x(line))
            .map(|line| value(line) + 0.2)
            // tops of walls are higher
            .filter(|depth| *depth < 0.6)
            .map(|depth| depth * 0.01);
        beyond.push(volume.sum::<f64>());
        assert!(
            text.lines().map(value).sum::<f64>() > 0.0,
            "it runs to the east"
        );
    }
    // 0.3 s of the 0.4 s; the strip and the cells are one to two spacings wide, a twentieth of what has passed
    let until: f64 = rows
        .windows(2)
        .filter(|pair| pair[1][0] < 0.31)
        .map(|pair| 0.5 * (pair[0][3] + pair[1][3]) * (pair[1][0] - pair[0][0]))
        .sum();
    assert!((until / beyond[1] - 1.0).abs() < 0.15, "{until} {beyond:?}");
    assert!(until < passed && beyond[0] < beyond[1]);
    // faster below than above: the front runs along the floor
    let last = rows.last().unwrap();
    assert!(
        last[4..].iter().all(|u| 0.0 < *u) && last[13] < last[5],
        "{last:?}"
    );
    let series = String::from_utf8(read(&whole, "handoff/t_0.3/swash/middle_u10.txt")).unwrap();
    assert!(series.starts_with("000000.000 0.000000\n"), "{series}");
    let input = String::from_utf8(read(&whole, "handoff/t_0.3/swash/INPUT")).unwrap();
    assert!(
        input.contains("REG -0.150 -0.150 0. 23 9 0.1 0.1"),
        "{input}"
    );
    // in two pieces
    let pieces = folder.path().join("pieces");
    run(&scene, &pieces, &["--until", "0.2"]);
    run(&scene, &pieces, &["--resume", "--until", "0.4"]);
    for name in [
        "handoff_lines.csv",
        "handoff/t_0.1/handoff.nc",
        "handoff/t_0.3/handoff.nc",
        "handoff/t_0.3/handoff.json",
        "handoff/t_0.3/swash/middle_discharge.txt",
    ] {
        assert!(read(&whole, name) == read(&pieces, name), "{name}");
    }
}

/// A block that plunges into a lake: the hand-off is made once it drives the water no more.
#[test]
fn a_wave_is_handed_over_once_it_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.ron");
    let lake = COLLAPSE
        .replace("times: At([0.3, 0.1]), cell: 0.1, level: 0.2, formats: [NetCdf, Geoclaw, Swash],", "")
        .replace("max: (0.8, 0.6, 0.6)", "max: (2, 0.6, 0.4)")
        .replace("\n    ],\n    fluid", "\n        (name: \"stone\", material: \"rock\", shape: Box(min: (0.1, 0.1, 0.45), max: (0.4, 0.5, 0.65)), velocity: (0, 0, -1.5)),\n    ],\n    fluid")
        .replace("duration: 0.4", "duration: 1.5");
    std::fs::write(&scene, &lake).unwrap();
    let out = folder.path().join("run");
    run(&scene, &out, &[]);
    let numbers: Value = serde_json::from_slice(&read(&out, "handoff/handoff.json")).unwrap();
    assert_eq!(numbers["reason"], "PowerSpent", "{numbers}");
    let [power, largest] = ["power_w", "largest_power_w"].map(|key| numbers[key].as_f64().unwrap());
    assert!(power < 0.01 * largest, "{numbers}");
    let time = numbers["time_s"].as_f64().unwrap();
    assert!(0.1 < time && time < 1.0, "{time}");
    // an absorbing layer beside the splash takes the crest before that
    let layered = lake.replace(
        "    handoff:",
        "    absorbers: [(name: \"end\", min: (0.7, 0, 0), max: (2, 0.6, 1), towards: XMax)],\n    handoff:",
    );
    std::fs::write(&scene, layered).unwrap();
    let early = folder.path().join("early");
    run(&scene, &early, &[]);
    let numbers: Value = serde_json::from_slice(&read(&early, "handoff/handoff.json")).unwrap();
    assert_eq!(numbers["reason"], "WaveAtAbsorber", "{numbers}");
    assert!(numbers["time_s"].as_f64().unwrap() < time, "{numbers}");
}

#[test]
fn mistakes_in_a_hand_off_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.ron");
    let said = |old: &str, new: &str| {
        assert!(COLLAPSE.contains(old));
        std::fs::write(&scene, COLLAPSE.replace(old, new)).unwrap();
        let output = riprap(&["check", scene.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(2), "{}", words(&output));
        words(&output)
    };
    assert!(said("At([0.3, 0.1])", "At([0.3, -4])").contains("-4 s is before the start"));
    assert!(said("to: (0.8, 0.6))", "to: (0.8, 0))").contains("begins and ends at the same place"));
    assert!(said("\"middle\"", "\"the middle\"").contains("use letters, digits"));
    assert!(said("cell: 0.1,", "cell: 0,").contains("handoff: cell"));
    assert!(said("[NetCdf,", "[NetCDF,").contains("NetCdf"));
}
