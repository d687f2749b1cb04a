//! A run that is killed, and what it leaves.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A tank that settles, a block that falls into it, every kind of table, frames every few steps.
pub const TANK: &str = r#"(
    title: "A block falls into a tank",
    domain: (min: (-0.3, 0, -0.3), max: (1.5, 0.1, 1.5), dimensions: Two),
    materials: [(name: "rock", density: 2400, friction_angle_deg: 30)],
    blocks: [
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, -0.3), max: (1.5, 0.1, 0))),
        (name: "left", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, 0), max: (0, 0.1, 1))),
        (name: "right", material: "rock", motion: Fixed, shape: Box(min: (1.2, 0, 0), max: (1.5, 0.1, 1))),
        (name: "cube", material: "rock", shape: Box(min: (0.5, 0, 0.5), max: (0.7, 0.1, 0.7)), velocity: (0, 0, -1)),
    ],
    fluid: (dynamic_viscosity: 0.001, resolution: Spacing(0.025), regions: [
        (name: "water", shape: Box(min: (0, 0, 0), max: (1.2, 0.1, 0.4))),
    ]),
    gauges: [SurfaceElevation(name: "g1", x: 0.2, y: 0.05)],
    counters: [Plane(name: "surface", point: (0, 0, 0.4), normal: (0, 0, -1))],
    reactions: [(name: "bed", between: ("floor", "cube"))],
    forces: (interval: 0.002),
    trajectories: (interval: 0.002),
    time: (duration: 0.4, settle: 0.2),
    output: (frame_interval: 0.02, gauge_interval: 0.002, ledger_interval: 0.002, contacts: true, face_pressures: true),
)"#;

/// Files of a run by name.
pub type Files = BTreeMap<String, Vec<u8>>;

/// Starts a run that writes a checkpoint of every state that it keeps.
pub fn spawn(case: &Path, folder: &Path, extra: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_riprap"))
        .arg("run")
        .arg(case)
        .arg("-o")
        .arg(folder)
        .args(["--quiet", "--checkpoint-interval", "0"])
        .args(extra)
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// All files of a run but those that hold wall times, and of the summary what has nothing to do with them.
pub fn results(folder: &Path) -> Files {
    let mut files: Files = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap())
        .map(|entry| {
            let name = entry.file_name().into_string().unwrap();
            (name, fs::read(entry.path()).unwrap())
        })
        .collect();
    // they hold wall times
    files.remove("checkpoint.bin");
    files.remove("progress.json");
    // its subtitle says how long the run took
    assert!(files.remove("overview.svg").unwrap().ends_with(b"</svg>\n"));
    // so does the report
    assert!(files.remove("report.html").unwrap().ends_with(b"</html>\n"));
    let summary: serde_json::Value = serde_json::from_slice(&files["summary.json"]).unwrap();
    let kept = [
        "state_hash",
        "steps",
        "energy",
        "dt_governed_by",
        "max_mach",
        "completed",
        "counters",
        "reactions",
    ];
    let kept: Vec<_> = kept.iter().map(|key| summary[key].to_string()).collect();
    files.insert("summary.json".to_owned(), kept.join("\n").into_bytes());
    files
}

/// The first file that is not in both, or not the same.
pub fn difference(found: &Files, expected: &Files) -> Option<String> {
    let names = found.keys().chain(expected.keys());
    let mut differing = names.filter(|name| found.get(*name) != expected.get(*name));
    differing.next().cloned()
}

/// A number in `0..1` (Knuth's linear congruential generator).
pub fn random(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 53) as f64
}
