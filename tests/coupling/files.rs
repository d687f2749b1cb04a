//! Files: written, read back by this program and by the VTK library, cut and damaged on purpose.

use proptest::prelude::*;
use riprap::vtk::{self, Array, Collection, PolyData, Polygons, Values};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A cloud with an array of each kind; deterministic and rough, like pressure in a splash.
fn cloud(n: usize) -> PolyData {
    let noise = |i: usize| ((i.wrapping_mul(2_654_435_761) >> 7) % 10_007) as f32 / 10_007.0;
    PolyData {
        points: (0..n)
            .map(|i| [(i % 100) as f32 * 0.01, noise(i), (i / 100) as f32 * 0.01])
            .collect(),
        lines: Polygons::default(),
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
        names: Vec::new(),
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

/// Lines of two and of three points.
fn paths() -> PolyData {
    PolyData {
        lines: Polygons {
            connectivity: vec![0, 1, 2, 3, 4],
            offsets: vec![2, 5],
        },
        cell_data: vec![array("Order", 1, Values::I32(vec![1, 2]))],
        ..cloud(5)
    }
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
    for data in [cloud(0), cloud(1), cloud(40_000), boxes(), paths()] {
        assert_eq!(round_trip(&data), data);
    }
}

#[test]
fn the_vtk_library_reads_what_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let [water, blocks, empty] =
        ["water.vtp", "blocks.vtp", "empty.vtp"].map(|name| folder.path().join(name));
    vtk::write(&water, &cloud(40_000)).unwrap();
    let list = |name: &str, list: Vec<String>| vtk::Names {
        name: name.to_owned(),
        list,
    };
    // longer than a compressed block, beside a name of no letter and one of many bytes each
    let many: Vec<String> = (0..5000).map(|k| format!("slide.{k:04}")).collect();
    let few = ["", "Fels & \"Geröll\"", "岩"].map(str::to_owned).to_vec();
    let named = PolyData {
        names: vec![
            list("BlockNames", many.clone()),
            list("GroupNames", few.clone()),
        ],
        ..boxes()
    };
    assert_eq!(round_trip(&named), named);
    vtk::write(&blocks, &named).unwrap();
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
    assert_eq!(
        blocks["names"],
        serde_json::json!({"BlockNames": many, "GroupNames": few})
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

#[test]
fn no_bit_of_a_number_is_changed() {
    let odd = [0x7fc0_1234, 0xffc0_0000, 0x7f80_0000, 0x8000_0000, 1].map(f32::from_bits);
    let mut data = cloud(odd.len());
    data.point_data = vec![array("Odd", 1, Values::F32(odd.to_vec()))];
    let Values::F32(back) = &round_trip(&data).point_data[0].values else {
        unreachable!("single precision stays single precision");
    };
    assert_eq!(
        back.iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
        odd.map(f32::to_bits)
    );
}

#[test]
fn the_header_is_as_promised() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.vtp");
    vtk::write(&path, &cloud(2)).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    let header = &text[..text.find("<AppendedData").unwrap()];
    for promised in [
        r#"<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">"#,
        r#"<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">0.30000000000000004</DataArray>"#,
        r#"<Piece NumberOfPoints="2" NumberOfVerts="2" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">"#,
        r#"<PointData Scalars="Pressure" Vectors="Velocity">"#,
        r#"<DataArray type="Float32" Name="Pressure" NumberOfComponents="1" format="appended" offset="0"/>"#,
        r#"<DataArray type="Int32" Name="connectivity""#,
    ] {
        assert!(header.contains(promised), "{promised} is not in\n{header}");
    }
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let folder = tempfile::tempdir().unwrap();
    let data = cloud(40_000);
    let files: Vec<Vec<u8>> = [1, 2, 4]
        .map(|n_threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(n_threads)
                .build()
                .unwrap();
            let path = folder.path().join("x.vtp");
            pool.install(|| vtk::write(&path, &data)).unwrap();
            std::fs::read(&path).unwrap()
        })
        .into();
    assert!(files[0] == files[1] && files[0] == files[2]);
}

#[test]
fn a_watcher_never_sees_a_piece_of_a_collection() {
    let folder = tempfile::tempdir().unwrap();
    let mut collection = Collection::new(folder.path(), "water & rock");
    let is_done = std::sync::atomic::AtomicBool::new(false);
    let ordering = std::sync::atomic::Ordering::SeqCst;
    std::thread::scope(|scope| {
        let watcher = scope.spawn(|| {
            let mut n_seen = 0;
            while !is_done.load(ordering) {
                if let Ok(text) = std::fs::read_to_string(folder.path().join("water & rock.pvd")) {
                    assert!(text.ends_with("</VTKFile>\n"), "cut: {text}");
                    n_seen += 1;
                }
                if let Ok(text) =
                    std::fs::read_to_string(folder.path().join("water & rock.vtp.series"))
                {
                    serde_json::from_str::<serde_json::Value>(&text).unwrap();
                }
            }
            n_seen
        });
        for frame in 0..100 {
            collection
                .push(
                    f64::from(frame) * 0.1,
                    format!("water & rock_{frame:05}.vtp"),
                )
                .unwrap();
        }
        is_done.store(true, ordering);
        println!("opened the collection {} times", watcher.join().unwrap());
    });

    let names = std::fs::read_dir(folder.path()).unwrap();
    let mut names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(
        names,
        ["water & rock.pvd", "water & rock.vtp.series"],
        "nothing is left behind"
    );
    let pvd = std::fs::read_to_string(folder.path().join("water & rock.pvd")).unwrap();
    let line = r#"<DataSet timestep="0.30000000000000004" group="" part="0" file="water &amp; rock_00003.vtp"/>"#;
    assert!(pvd.contains(line), "{pvd}");
    let series = std::fs::read_to_string(folder.path().join("water & rock.vtp.series")).unwrap();
    let series: serde_json::Value = serde_json::from_str(&series).unwrap();
    assert_eq!(series["file-series-version"], "1.0");
    assert_eq!(series["files"][99]["name"], "water & rock_00099.vtp");
    assert_eq!(series["files"][3]["time"].as_f64(), Some(3.0 * 0.1));
}

#[test]
fn errors_name_the_file_and_the_reason() {
    let nowhere = Path::new("no_such_folder/x.vtp");
    let message = vtk::write(nowhere, &cloud(1)).unwrap_err().to_string();
    assert!(
        message.starts_with("cannot create no_such_folder/x.vtp: No such file"),
        "{message}"
    );
    let message = vtk::read(nowhere).unwrap_err().to_string();
    assert!(
        message.starts_with("cannot read no_such_folder/x.vtp: No such file"),
        "{message}"
    );

    let mut data = boxes();
    data.polygons.connectivity[5] = 16;
    let message = vtk::write(nowhere, &data).unwrap_err().to_string();
    let expected = "no_such_folder/x.vtp: cell 1 needs 3 or more corners, all among the 16 points, \
                    and ascending ends";
    assert_eq!(message, expected);
    let mut data = cloud(3);
    data.point_data[1].components = 1;
    let message = vtk::write(nowhere, &data).unwrap_err().to_string();
    assert_eq!(
        message,
        "no_such_folder/x.vtp: array `Velocity` has 9 values, expected 3"
    );
    let mut data = cloud(3);
    data.time = f64::NAN;
    let message = vtk::write(nowhere, &data).unwrap_err().to_string();
    assert_eq!(
        message,
        "no_such_folder/x.vtp: time must be finite, got NaN"
    );
}

/// A file on a full device: the error arrives, and nothing half-written takes the name.
#[cfg(target_os = "linux")]
#[test]
fn a_failed_write_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.vtp");
    vtk::write(&path, &cloud(5)).unwrap();
    // The hidden file becomes a device on which every write says "no space left".
    std::os::unix::fs::symlink("/dev/full", folder.path().join(".x.vtp.partial")).unwrap();
    let message = vtk::write(&path, &cloud(6)).unwrap_err().to_string();
    assert_eq!(
        message,
        format!(
            "cannot write {}: No space left on device (os error 28)",
            path.display()
        )
    );
    assert_eq!(vtk::read(&path).unwrap(), cloud(5));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// Our reader's answer to `bytes`.
fn read_bytes(bytes: &[u8]) -> Result<PolyData, vtk::VtkError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.vtp");
    std::fs::write(&path, bytes).unwrap();
    vtk::read(&path)
}

fn written(data: &PolyData) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.vtp");
    vtk::write(&path, data).unwrap();
    std::fs::read(&path).unwrap()
}

proptest! {
    #[test]
    fn a_cut_file_is_an_error(cut in 0.0..1.0f64, is_cloud: bool) {
        let data = if is_cloud { cloud(500) } else { boxes() };
        let bytes = written(&data);
        // The last byte is a line feed and may be missing.
        let end = ((bytes.len() - 1) as f64 * cut) as usize;
        prop_assert!(read_bytes(&bytes[..end]).is_err());
    }

    /// A flipped bit in the text may change a name; one in the numbers is noticed, or sits in an unused bit.
    #[test]
    fn a_flipped_bit_is_an_error_or_harmless(place in 0.0..1.0f64, bit in 0..8u32, is_cloud: bool) {
        let data = if is_cloud { cloud(500) } else { boxes() };
        let mut bytes = written(&data);
        let place = (bytes.len() as f64 * place) as usize;
        bytes[place] ^= 1 << bit;
        let start = bytes.windows(8).position(|window| window == b"Appended").unwrap_or(0);
        match read_bytes(&bytes) {
            Ok(found) => prop_assert!(place < start || found == data, "flipped bit {bit} of byte {place}"),
            Err(error) => prop_assert!(error.to_string().contains("x.vtp")),
        }
    }

    #[test]
    fn noise_is_an_error(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(read_bytes(&bytes).is_err());
    }

    /// Noise in the place of the numbers, behind a header that is right.
    #[test]
    fn noise_behind_a_header_is_an_error(noise in proptest::collection::vec(any::<u8>(), 0..300)) {
        let bytes = written(&cloud(20));
        let start = bytes.windows(4).position(|window| window == b"   _").unwrap_or(0);
        let mut damaged = bytes[..start + 4].to_vec();
        damaged.extend(noise);
        damaged.extend(b"\n  </AppendedData>\n</VTKFile>\n");
        prop_assert!(read_bytes(&damaged).is_err());
    }
}

/// Report of the VTK library on `files`; `None` where Python lacks the library, unless it is required.
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
