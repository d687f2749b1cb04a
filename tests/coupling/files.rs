//! Files: written, read back by this program and by the VTK library, cut and damaged on purpose.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a test stops at the first thing that is wrong, and says what it skipped"
)]

use riprap::vtk::{self, Array, PolyData, Polygons, Values};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A cloud with an array of each kind; deterministic and rough, like pressure in a splash.
fn cloud(n: usize) -> PolyData {
    let noise = |i: usize| ((i.wrapping_mul(2_654_435_761) >> 7) % 10_007) as f32 / 10_007.0;
    PolyData {
        points: (0..n)
            .map(|i| [(i % 100) as f32 * 0.01, noise(i), (i / 100) as f32 * 0.01])
            .collect(),
        polygons: Polygons::default(),
        point_data: vec![
            array(
                "Pressure",
                1,
                Values::F32((0..n).map(|i| 9810.0 * noise(i + 1)).collect()),
            ),
            array("Velocity", 3, Values::F32((0..3 * n).map(noise).collect())),
            array(
                "Density",
                1,
                Values::F64((0..n).map(|i| 1000.0 + f64::from(noise(i))).collect()),
            ),
            array("Id", 1, Values::I32((0..n as i32).collect())),
        ],
        cell_data: Vec::new(),
        time: 0.1 + 0.2,
    }
}

/// Two boxes of 2 x 1 x 0.5 and 1 x 1 x 3, with the faces counter-clockwise from outside.
fn boxes() -> PolyData {
    let mut data = PolyData {
        time: 1.25,
        ..PolyData::default()
    };
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    for (origin, size) in [
        ([0.0, 0.0, 0.0], [2.0, 1.0, 0.5]),
        ([5.0, 0.0, 0.0], [1.0, 1.0, 3.0]),
    ] {
        let first = data.points.len() as i32;
        data.points.extend((0..8).map(|corner| {
            std::array::from_fn(|axis| {
                origin[axis]
                    + if corner >> axis & 1 == 1 {
                        size[axis]
                    } else {
                        0.0f32
                    }
            })
        }));
        for face in faces {
            data.polygons
                .connectivity
                .extend(face.map(|corner| first + corner));
            data.polygons
                .offsets
                .push(data.polygons.connectivity.len() as i32);
        }
    }
    data.cell_data = vec![
        array(
            "BlockId",
            1,
            Values::I32((0..12).map(|face| face / 6).collect()),
        ),
        array(
            "Velocity",
            3,
            Values::F32((0..36).map(|i| i as f32).collect()),
        ),
    ];
    data
}

fn array(name: &str, components: usize, values: Values) -> Array {
    Array {
        name: name.into(),
        components,
        values,
    }
}

fn round_trip(data: &PolyData) -> PolyData {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.vtp");
    vtk::write(&path, data).unwrap();
    vtk::read(&path).unwrap()
}

#[test]
fn our_reader_gives_back_what_was_written() {
    // 40 000 points: several blocks per array, the last one shorter.
    for data in [cloud(0), cloud(1), cloud(40_000), boxes()] {
        assert_eq!(round_trip(&data), data);
    }
}

#[test]
fn the_vtk_library_reads_what_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let [water, blocks, empty] =
        ["water.vtp", "blocks.vtp", "empty.vtp"].map(|name| folder.path().join(name));
    vtk::write(&water, &cloud(40_000)).unwrap();
    vtk::write(&blocks, &boxes()).unwrap();
    vtk::write(&empty, &cloud(0)).unwrap();
    let Some(found) = read_back(&[&water, &blocks, &empty]) else {
        return;
    };

    for one in &found {
        assert_eq!(one["errors"].as_array().unwrap().len(), 0, "{one}");
        assert!(
            one["source"].as_str().unwrap().starts_with("riprap "),
            "{one}"
        );
    }
    let [water, blocks, empty] = found.as_slice() else {
        unreachable!("three files, three objects");
    };
    assert_eq!(water["points"], 40_000);
    assert_eq!(water["vertices"], 40_000);
    assert_eq!(water["time"].as_f64(), Some(0.1 + 0.2));
    assert_eq!(water["point_arrays"]["Id"]["max"], 39_999.0);
    assert_eq!(water["point_arrays"]["Density"]["type"], "double");
    assert_eq!(
        water["active_point"],
        serde_json::json!(["Pressure", "Velocity"])
    );
    assert_eq!(blocks["polygons"], 12);
    assert_eq!(blocks["vertices"], 0);
    assert_eq!(blocks["active_cell"], serde_json::json!([null, "Velocity"]));
    for (block, volume) in [("0", 1.0), ("1", 3.0)] {
        let found = blocks["volumes"][block].as_f64().unwrap();
        // Corners are exact in single precision, the sum is in double.
        assert!(
            (found - volume).abs() < 1e-12,
            "block {block}: volume {found}, expected {volume}"
        );
    }
    assert_eq!(empty["points"], 0);
    assert_eq!(empty["cells"], 0);
    assert_eq!(empty["point_arrays"]["Velocity"]["tuples"], 0);
}

/// What the VTK library says about `files`; nothing where Python has no such library, unless that is required.
fn read_back(files: &[&Path]) -> Option<Vec<serde_json::Value>> {
    let python = |arguments: &[&Path]| Command::new("python3").args(arguments).output();
    let import = [Path::new("-c"), Path::new("import vtk")];
    if !python(&import).is_ok_and(|output| output.status.success()) {
        let is_required = std::env::var("RIPRAP_REQUIRE_VTK").is_ok_and(|value| value == "1");
        assert!(
            !is_required,
            "python3 has no vtk package, and RIPRAP_REQUIRE_VTK=1"
        );
        println!("skipped: python3 has no vtk package");
        return None;
    }
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../tests/coupling/read_back.py");
    let arguments: Vec<&Path> = std::iter::once(script.as_path())
        .chain(files.iter().copied())
        .collect();
    let output = python(&arguments).unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Some(
        text.lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect(),
    )
}
