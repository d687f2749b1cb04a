//! Frames of water, blocks, contacts and faces, each at its own interval, thinned out and in a box.

use std::fs;
use std::path::Path;

use riprap::files::vtk::{self, PolyData, Values};

use crate::support::killed::{TANK, difference, results, spawn};
use crate::support::{riprap, run, summary, words};

/// Half of the water, every third particle, at a fifth of the times; blocks more often than all else.
const KINDS: &str = "water: (interval: 0.1, stride: 3, box: (min: (0, 0, 0), max: (0.6, 0.1, 1))), \
    blocks: (interval: 0.01), face_frames: (interval: 0.2, box: (min: (-1, -1, 0.1), max: (2, 1, 2))), ";

fn tank() -> String {
    TANK.replace("output: (", &format!("output: ({KINDS}"))
}

/// Times and files of a collection.
fn listed(folder: &Path, stem: &str) -> Vec<(f64, String)> {
    let text = fs::read_to_string(folder.join(format!("{stem}.vtp.series"))).unwrap();
    let series: serde_json::Value = serde_json::from_str(&text).unwrap();
    let files = series["files"].as_array().unwrap().iter();
    files
        .map(|file| {
            (
                file["time"].as_f64().unwrap(),
                file["name"].as_str().unwrap().to_owned(),
            )
        })
        .collect()
}

fn ids(data: &PolyData) -> Vec<i32> {
    match &data
        .point_data
        .iter()
        .find(|array| array.name == "Id")
        .unwrap()
        .values
    {
        Values::I32(ids) => ids.clone(),
        other => unreachable!("{other:?}"),
    }
}

#[test]
fn every_kind_has_its_times_and_its_part_and_the_run_its_bits() {
    let folder = tempfile::tempdir().unwrap();
    let (case, plain) = (
        folder.path().join("kinds.ron"),
        folder.path().join("plain.ron"),
    );
    fs::write(&case, tank()).unwrap();
    fs::write(&plain, TANK).unwrap();
    let out = folder.path().join("out");
    let kinds = run(&case, &out, &["--no-report"]);
    let whole = run(&plain, &folder.path().join("plain"), &["--no-report"]);
    assert_eq!(kinds["state_hash"], whole["state_hash"]);
    for (stem, interval, n) in [
        ("water", 0.1, 5),
        ("blocks", 0.01, 41),
        ("contacts", 0.02, 21),
        ("faces", 0.2, 3),
    ] {
        let files = listed(&out, stem);
        assert_eq!(files.len(), n, "{stem}");
        for (k, (time, name)) in files.iter().enumerate() {
            // at the first step after its due time
            let late = time - k as f64 * interval;
            assert!((-1e-9..0.005).contains(&late), "{stem} {k}: {time}");
            let data = vtk::read(&out.join(name)).unwrap();
            assert!((data.time - time).abs() < 1e-12, "{name}");
            for x in &data.points {
                match stem {
                    "water" => assert!(0.0 <= x[0] && x[0] <= 0.6, "{name}: {x:?}"),
                    // half a tile below the middle of one
                    "faces" => assert!(0.1 - 0.025 <= x[2], "{name}: {x:?}"),
                    _ => {}
                }
            }
        }
    }
    // the particles are those of the whole frames at the same step
    let frame = vtk::read(&out.join("water_00000.vtp")).unwrap();
    let all = vtk::read(&folder.path().join("plain/water_00000.vtp")).unwrap();
    let expected: Vec<i32> = ids(&all)
        .into_iter()
        .zip(&all.points)
        .filter(|(id, x)| id % 3 == 0 && (0.0..=0.6).contains(&x[0]))
        .map(|(id, _)| id)
        .collect();
    assert!(30 < expected.len() && ids(&frame) == expected);
}

#[test]
fn readers_cope_with_few_particles_and_other_times() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("kinds.ron"), folder.path().join("out"));
    fs::write(&case, tank()).unwrap();
    run(&case, &out, &[]);
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(
        page.contains("1 moving block in 41 frames"),
        "blocks of the report"
    );
    assert!(
        page.contains("particles in 5 frames"),
        "water of the report"
    );
    assert!(out.join("overview.svg").is_file());
    let rendered = riprap(&["render", out.to_str().unwrap(), "--size", "64x48"]);
    assert!(rendered.status.success(), "{}", words(&rendered));
    assert!(out.join("frames/frame_00004.pov").is_file());
    let text = fs::read_to_string(out.join("case.ron")).unwrap();
    assert!(text.contains("stride: 3"), "{text}");
}

#[test]
fn a_killed_run_goes_on_to_the_same_frames_of_every_kind() {
    let folder = tempfile::tempdir().unwrap();
    let (case, whole) = (folder.path().join("kinds.ron"), folder.path().join("whole"));
    fs::write(&case, tank()).unwrap();
    assert!(spawn(&case, &whole, &[]).wait().unwrap().success());
    let broken = folder.path().join("broken");
    for wanted in ["blocks_00009.vtp", "blocks_00023.vtp"] {
        let mut child = spawn(&case, &broken, &["--resume"]);
        while !broken.join(wanted).exists() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert!(
        spawn(&case, &broken, &["--resume"])
            .wait()
            .unwrap()
            .success()
    );
    assert!(0 < summary(&broken)["resumed"].as_u64().unwrap());
    assert_eq!(difference(&results(&broken), &results(&whole)), None);
}

#[test]
fn wrong_frames_are_refused_and_useless_ones_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("tank.ron");
    fs::write(&case, TANK).unwrap();
    for (set, expected) in [
        (
            "output.water=(stride: 0)",
            "stride must be 1 or more, found 0",
        ),
        ("output.water=(stride: -2)", "tank.ron:"),
        (
            "output.blocks=(interval: 0)",
            "interval of frames must be > 0",
        ),
        (
            "output.water=(box: (min: (0, 0, 0), max: (1, 0, 1)))",
            "must exceed min",
        ),
        (
            "output.water=(interval: 50)",
            "water interval is 50 s, longer than the run",
        ),
    ] {
        let output = riprap(&["check", case.to_str().unwrap(), "--set", set]);
        assert!(
            words(&output).contains(expected),
            "{set}: {}",
            words(&output)
        );
    }
    fs::write(
        &case,
        TANK.replace("contacts: true", "contact_frames: (interval: 0.1)"),
    )
    .unwrap();
    let output = riprap(&["check", case.to_str().unwrap()]);
    assert!(
        words(&output).contains("nothing is written without `output.contacts: true`"),
        "{}",
        words(&output)
    );
}
