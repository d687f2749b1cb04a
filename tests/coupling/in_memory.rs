//! A run in memory, as other programs step it: the bits and readings of a run with a folder, without a file.

use std::path::Path;

use riprap::files::table::read_table;
use riprap::observe::gauges::PresentGauges;
use riprap::output::checkpoint_file;
use riprap::output::run_folder::ArchivedScene;
use riprap::run::Run;
use riprap::scene;
use riprap::scene::resolve::Scene;

use crate::support::{self, riprap, words};

/// A cube that falls into a box of water and drives some of it over a line.
const BOX: &str = r#"(
    title: "Box",
    domain: (min: (-0.3, 0, -0.3), max: (0.9, 0.1, 0.9), dimensions: Two),
    materials: [(name: "rock", density: 2400, friction_angle_deg: 30)],
    blocks: [
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, -0.3), max: (0.9, 0.1, 0))),
        (name: "left", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, 0), max: (0, 0.1, 0.9))),
        (name: "right", material: "rock", motion: Fixed, shape: Box(min: (0.6, 0, 0), max: (0.9, 0.1, 0.9))),
        (name: "cube", material: "rock", shape: Box(min: (0.2, 0, 0.45), max: (0.3, 0.1, 0.55))),
    ],
    fluid: (dynamic_viscosity: 0.001, resolution: Spacing(0.05), regions: [
        (name: "water", shape: Box(min: (0, 0, 0), max: (0.6, 0.1, 0.4))),
    ]),
    gauges: [
        SurfaceElevation(name: "level", x: 0.45, y: 0.05),
        Pressure(name: "deep", position: (0.45, 0.05, 0.1)),
        Velocity(name: "flow", position: (0.45, 0.05, 0.2)),
        RunUp(name: "run_up", from: (0.35, 0.05), to: (0.65, 0.05)),
        Overtopping(name: "passed", from: (0.4, 0), to: (0.4, 0.1)),
        Displaced(name: "moved", blocks: "cube", farther_than: 0.05),
    ],
    time: (duration: 0.3, settle: 0.05),
    output: (frame_interval: 0.1, gauge_interval: 1e-9),
)"#;

fn written(folder: &Path) -> std::path::PathBuf {
    let path = folder.join("box.ron");
    std::fs::write(&path, BOX).unwrap();
    path
}

fn load(case: &Path) -> Scene {
    scene::load(case, &[]).unwrap().0
}

/// Steps until the end of the scene, with its gauges.
fn advance(run: &mut Run, gauges: &mut PresentGauges) {
    while !run.is_over() {
        run.step().unwrap();
        if !run.is_settling() {
            gauges.follow(run.world());
        }
    }
}

#[test]
fn a_run_in_memory_has_the_bits_and_readings_of_one_with_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let case = written(folder.path());
    let summary = support::run(&case, &folder.path().join("run"), &[]);
    let mut scene = load(&case);
    let mut run = Run::in_memory(&mut scene).unwrap();
    let mut gauges = PresentGauges::new(run.scene(), run.world());
    advance(&mut run, &mut gauges);
    assert_eq!(run.world().state_hash(), summary["state_hash"]);
    let table = read_table(&folder.path().join("run/gauges.csv")).unwrap();
    assert_eq!(gauges.names().count(), 6);
    let mut n_columns = 1;
    for name in gauges.names() {
        let reading = gauges.read(name, run.world()).unwrap();
        for (column, value) in reading.columns.iter().zip(&reading.values) {
            let recorded = table.column(&column.name).unwrap();
            assert_eq!(recorded.last(), Some(value), "{}", column.name);
            n_columns += 1;
        }
    }
    assert_eq!(n_columns, table.columns.len());
    // something has happened at each of them
    assert_eq!(gauges.read("moved", run.world()).unwrap().values, [1.0]);
    assert_ne!(gauges.read("passed", run.world()).unwrap().values[0], 0.0);
    assert!(gauges.read("none", run.world()).is_none());
}

#[test]
fn a_state_written_between_two_steps_continues_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let case = written(folder.path());
    let hash = checkpoint_file::scene_hash(&ArchivedScene::of(&load(&case)).unwrap().text);
    let path = folder.path().join("state.bin");
    // in settling, and later at a step at which no run keeps its state
    for n_steps in [5, 77] {
        let (mut scene, mut same) = (load(&case), load(&case));
        let mut run = Run::in_memory(&mut scene).unwrap();
        for _ in 0..n_steps {
            run.step().unwrap();
        }
        let size = run.write_state(&path, hash).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(bytes.len() as u64, size);
        let checkpoint = checkpoint_file::read(&path, &bytes, &hash).unwrap();
        let mut again = Run::in_memory(&mut same).unwrap();
        again.restore(&checkpoint).unwrap();
        assert_eq!(again.is_settling(), n_steps == 5);
        while !run.is_over() {
            run.step().unwrap();
            again.step().unwrap();
        }
        assert_eq!(run.world().state_hash(), again.world().state_hash());
    }
    // not another scene's
    let bytes = std::fs::read(&path).unwrap();
    assert!(checkpoint_file::read(&path, &bytes, &[0; 32]).is_err());
}

#[test]
fn the_checkpoint_of_a_run_folder_continues_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let case = written(folder.path());
    let summary = support::run(&case, &folder.path().join("run"), &[]);
    // every hundred steps a state is kept, and each written
    let part = folder.path().join("part");
    let done = riprap(&[
        "run",
        case.to_str().unwrap(),
        "-o",
        part.to_str().unwrap(),
        "--checkpoint-interval",
        "0",
        "--quiet",
    ]);
    assert!(done.status.success(), "{}", words(&done));
    let text = std::fs::read_to_string(part.join("case.ron")).unwrap();
    let hash = checkpoint_file::scene_hash(&text);
    let (checkpoint, _) = checkpoint_file::newest(&part, &hash).unwrap().unwrap();
    let mut scene = load(&case);
    let mut run = Run::in_memory(&mut scene).unwrap();
    run.restore(&checkpoint).unwrap();
    assert!(!run.is_over());
    while !run.is_over() {
        run.step().unwrap();
    }
    assert_eq!(run.world().state_hash(), summary["state_hash"]);
}
