//! Names of blocks, groups, materials and joint sets: in tables, in VTK files, in a run taken up again.

use std::fs;
use std::path::Path;

use riprap::output::bodies;
use riprap::table::read_table;
use riprap::vtk::{self, PolyData, Values};

use crate::support::{riprap, run, words};

/// A block of 2 × 1 × 1 m in weightless space, cut by one joint of each of two sets; a post, a stone of a group, and two beads.
const JOINTED: &str = r#"(
    title: "Names",
    gravity: (0, 0, 0),
    domain: (min: (-2, -2, -2), max: (6, 6, 6)),
    materials: [(name: "granite", density: 2700, friction_angle_deg: 30), (name: "glass", density: 2500, friction_angle_deg: 20)],
    blocks: [
        (name: "post", material: "granite", motion: Fixed, shape: Box(min: (4, 4, 4), max: (5, 5, 5))),
        (name: "stone", material: "granite", group: "armor", velocity: (0.1, 0, 0), shape: Box(min: (3, 3, 0), max: (3.5, 3.5, 0.5))),
    ],
    rock_masses: [(name: "mass", material: "granite", boundary: Box(min: (0, 0, 0), max: (2, 1, 1)), joint_sets: [
        (name: "bedding", dip_deg: 0, dip_direction_deg: 0, spacing: 0.5),
        (dip_deg: 90, dip_direction_deg: 90, spacing: 1),
    ])],
    grains: [(name: "beads", material: "glass", region: Box(min: (0, 3, 0), max: (1, 4, 1)), diameter: (0.2, 0.2), count: 2)],
    forces: (blocks: ["stone"], interval: 0.005),
    time: (duration: 0.02),
    output: (ledger_interval: 0.005, frame_interval: 0.02),
)"#;

/// The run, in a folder of its own.
fn made(folder: &Path) -> std::path::PathBuf {
    let case = folder.join("names.ron");
    fs::write(&case, JOINTED).unwrap();
    let out = folder.join("out");
    run(&case, &out, &["--no-report"]);
    out
}

#[test]
fn tables_have_names_groups_materials_and_joint_sets() {
    let folder = tempfile::tempdir().unwrap();
    let out = made(folder.path());
    let rows = bodies::read(&out).unwrap();
    let told: Vec<[&str; 4]> = rows
        .iter()
        .map(|row| [&*row.name, &*row.group, &*row.material, &*row.joint_sets])
        .collect();
    let cut = "bedding + set 2";
    assert_eq!(
        told,
        [
            ["post", "", "granite", ""],
            ["stone", "armor", "granite", ""],
            ["mass.0001", "mass", "granite", cut],
            ["mass.0002", "mass", "granite", cut],
            ["mass.0003", "mass", "granite", cut],
            ["mass.0004", "mass", "granite", cut],
            ["beads_0001", "beads", "glass", ""],
            ["beads_0002", "beads", "glass", ""],
        ]
    );

    let text = fs::read_to_string(out.join("blocks.csv")).unwrap();
    let mut lines = text.lines();
    assert!(
        lines
            .next()
            .unwrap()
            .ends_with(",yaw [rad],asleep [-],name")
    );
    let first = lines.next().unwrap();
    assert!(
        first.starts_with("0.0,1,") && first.ends_with(",0,stone"),
        "{first}"
    );
    let table = read_table(&out.join("blocks.csv")).unwrap();
    let (ids, names) = (table.column("block").unwrap(), table.text("name").unwrap());
    assert!(ids.len() >= 7 * 4);
    for (id, name) in ids.iter().zip(names) {
        assert_eq!(*name, rows[*id as usize].name);
    }
    let forces = read_table(&out.join("forces.csv")).unwrap();
    assert!(!forces.text("name").unwrap().is_empty());
    assert!(
        forces
            .text("name")
            .unwrap()
            .iter()
            .all(|name| name == "stone")
    );
    let contacts = fs::read_to_string(out.join("contacts.csv")).unwrap();
    assert!(
        contacts
            .lines()
            .next()
            .unwrap()
            .ends_with(",name,partner_name")
    );
}

/// Blocks of rock masses and grains are recorded by the names that they get.
#[test]
fn made_blocks_are_recorded_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("names.ron");
    let asked = "trajectories: (blocks: [\"stone\", \"mass.0003\"], interval: 0.01),
        gauges: [BlockForce(name: \"bead\", block: \"beads_0002\")], forces: (blocks: [\"mass.0002\"]";
    fs::write(
        &case,
        JOINTED.replace("forces: (blocks: [\"stone\"]", asked),
    )
    .unwrap();
    let out = folder.path().join("out");
    run(&case, &out, &["--no-report"]);
    let last_cells = |file: &str| -> Vec<String> {
        let text = fs::read_to_string(out.join(file)).unwrap();
        let rows = text.lines().skip(1);
        rows.map(|row| row.rsplit(',').next().unwrap().to_owned())
            .collect()
    };
    assert_eq!(last_cells("rockfall.csv"), ["stone", "mass.0003"]);
    assert_eq!(last_cells("trajectories.csv")[..2], ["stone", "mass.0003"]);
    let of_forces = last_cells("forces.csv");
    assert!(!of_forces.is_empty() && of_forces.iter().all(|name| name == "mass.0002"));
    let gauges = fs::read_to_string(out.join("gauges.csv")).unwrap();
    assert!(
        gauges
            .lines()
            .next()
            .unwrap()
            .contains("bead.contact_fx [N]"),
        "{gauges}"
    );
}

fn integers<'a>(data: &'a PolyData, name: &str) -> &'a [i32] {
    match &data
        .cell_data
        .iter()
        .find(|array| array.name == name)
        .unwrap()
        .values
    {
        Values::I32(values) => values,
        other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn frames_have_numbers_and_the_names_they_stand_for() {
    let folder = tempfile::tempdir().unwrap();
    let out = made(folder.path());
    let data = vtk::read(&out.join("blocks_00000.vtp")).unwrap();
    let list = |name: &str| -> &[String] {
        let found = data.names.iter().find(|names| names.name == name);
        &found.unwrap().list
    };
    assert_eq!(list("GroupNames"), ["armor", "mass", "beads"]);
    assert_eq!(list("MaterialNames"), ["granite", "glass"]);
    assert_eq!(list("JointSetNames"), ["bedding", "set 2"]);
    assert_eq!(list("BlockNames").len(), 8);
    let [block, group, material, set] =
        ["BlockId", "GroupId", "MaterialId", "JointSet"].map(|name| integers(&data, name));
    for face in 0..block.len() {
        let name = &list("BlockNames")[block[face] as usize];
        let begin = name.split(['.', '_']).next().unwrap();
        let expected = if begin == "stone" { "armor" } else { begin };
        assert_eq!(list("GroupNames")[group[face] as usize], expected);
        let glass = usize::from(begin == "beads");
        assert_eq!(material[face], glass as i32);
        assert!(begin == "mass" || set[face] == -1, "{name}");
    }
    // each quarter of the mass has a face on the joint of either set, at z = 0.5 and at x = 1
    for (number, axis, place) in [(0, 2, 0.5), (1, 0, 1.0)] {
        let on: Vec<usize> = (0..set.len()).filter(|&face| set[face] == number).collect();
        assert_eq!(on.len(), 4);
        let corners: Vec<&[i32]> = data.polygons.iter().collect();
        for face in on {
            let at = corners[face].iter().map(|&c| data.points[c as usize][axis]);
            assert!(at.into_iter().all(|x| (x - place).abs() < 1e-6));
        }
    }
    let fixed = vtk::read(&out.join("fixed_blocks.vtp")).unwrap();
    assert!(integers(&fixed, "BlockId").iter().all(|&id| id == 0));
    assert!(integers(&fixed, "GroupId").iter().all(|&group| group == -1));
}

/// The archived scene keeps the labels, and makes the same blocks.
#[test]
fn the_archived_scene_runs_to_the_same_names() {
    let folder = tempfile::tempdir().unwrap();
    let out = made(folder.path());
    let again = folder.path().join("again");
    run(&out.join("case.ron"), &again, &["--no-report"]);
    for file in ["bodies.csv", "blocks.csv", "blocks_00000.vtp", "case.ron"] {
        let read = |folder: &Path| fs::read(folder.join(file)).unwrap();
        assert!(read(&out) == read(&again), "{file}");
    }
}

#[test]
fn labels_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("names.ron");
    for (from, to, expected) in [
        (
            "group: \"armor\"",
            "group: \"a,b\"",
            "has a comma, quote or line break",
        ),
        ("name: \"bedding\"", "name: \"\"", "the name is empty"),
        (
            "forces: (blocks: [\"stone\"]",
            "forces: (blocks: [\"stone\", \"mass.0007\"]",
            "no block is called `mass.0007`, did you mean `mass.0001`?",
        ),
        (
            "forces: (blocks: [\"stone\"]",
            "trajectories: (blocks: [\"mass.0003\", \"stne\"]), forces: (blocks: [\"stone\"]",
            "`stne` is not a free block of `blocks`, did you mean `stone`?",
        ),
        (
            "group: \"armor\"",
            "joint_faces: [(set: \"bedding\", faces: [0])]",
            "only the faces of a Polyhedron",
        ),
    ] {
        fs::write(&case, JOINTED.replace(from, to)).unwrap();
        let output = riprap(&["check", case.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(2), "{to}");
        assert!(words(&output).contains(expected), "{}", words(&output));
    }
}
