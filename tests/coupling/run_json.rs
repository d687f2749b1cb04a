//! `riprap run --json` and `progress.json`: news of a run for programs.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::support::killed::{TANK, results, spawn};
use crate::support::riprap;

/// Events of a run; everything on standard output is one.
fn events(arguments: &[&str]) -> (Option<i32>, Vec<Value>) {
    let output = riprap(&[&["run", "--json"], arguments].concat());
    let text = String::from_utf8(output.stdout).unwrap();
    let events = text.lines().map(|line| serde_json::from_str(line).unwrap());
    (output.status.code(), events.collect())
}

fn named<'e>(events: &'e [Value], name: &str) -> Vec<&'e Value> {
    events
        .iter()
        .filter(|event| event["event"] == name)
        .collect()
}

fn progress(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("progress.json")).unwrap()).unwrap()
}

#[test]
fn a_run_tells_its_events_and_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("tank.ron"), folder.path().join("out"));
    fs::write(&case, TANK).unwrap();
    let (case, path) = (case.to_str().unwrap(), out.to_str().unwrap());
    let (code, events) = events(&[case, "-o", path, "--checkpoint-interval", "0"]);
    assert_eq!(code, Some(0));
    let names: Vec<&str> = events
        .iter()
        .map(|e| e["event"].as_str().unwrap())
        .collect();
    assert_eq!(
        (names[0], names[1], names[names.len() - 1]),
        ("start", "settle", "end")
    );
    let (start, end) = (&events[0], &events[events.len() - 1]);
    assert_eq!(
        (&start["duration_s"], &start["settle_s"]),
        (&0.4.into(), &0.2.into())
    );
    assert_eq!(
        (&end["state"], &end["exit_code"]),
        (&"finished".into(), &0.into())
    );
    let summary: Value =
        serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(end["summary"], summary);
    assert_eq!(end["verdict"], summary["verdict"]);
    assert_eq!(start["particles"], summary["fluid_particles"]);
    let settled: Vec<&Value> = named(&events, "settle")
        .iter()
        .map(|e| &e["state"])
        .collect();
    assert_eq!(settled, ["started", "ended"]);
    // every file of a frame is told once, and is there
    let frames = named(&events, "frame");
    let files: Vec<&str> = frames
        .iter()
        .flat_map(|e| e["files"].as_array().unwrap())
        .map(|f| f.as_str().unwrap())
        .collect();
    let water = files
        .iter()
        .filter(|file| file.starts_with("water_"))
        .count();
    assert_eq!(water, 21);
    assert!(files.iter().all(|file| out.join(file).is_file()));
    let times = frames.iter().map(|event| event["time_s"].as_f64().unwrap());
    assert!(times.is_sorted_by(|a, b| a < b));
    assert_eq!(
        named(&events, "checkpoint").len() as u64,
        summary["checkpoints"].as_u64().unwrap()
    );
    for event in named(&events, "progress") {
        assert!(
            (0.0..=1.0).contains(&event["share"].as_f64().unwrap()),
            "{event}"
        );
        assert!(0.0 < event["dt_s"].as_f64().unwrap());
    }
    let progress = progress(&out);
    assert_eq!(
        (&progress["state"], &progress["stage"]),
        (&"finished".into(), &"running".into())
    );
    assert_eq!(progress["step"], summary["steps"]);
    assert_eq!(progress["time_s"], summary["simulated_time"]);
    assert!(progress["eta_s"].is_null());
}

#[test]
fn a_scene_that_cannot_run_ends_with_its_errors() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("tank.ron");
    fs::write(
        &case,
        TANK.replace("resolution: Spacing(0.025)", "resolution: Spacing(-1)"),
    )
    .unwrap();
    let (code, events) = events(&[case.to_str().unwrap()]);
    assert_eq!(code, Some(2));
    assert_eq!(events[0]["path"], "fluid.resolution");
    assert_eq!(
        (&events[1]["event"], &events[1]["state"]),
        (&"end".into(), &"refused".into())
    );
    assert_eq!(events.len(), 2);
}

#[test]
fn progress_json_is_whole_at_every_moment_and_tells_of_a_stop() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("tank.ron"), folder.path().join("out"));
    // long enough to be looked at
    fs::write(
        &case,
        TANK.replace("duration: 0.4", "duration: 100")
            .replace("_interval: 0.0", "_interval: 1"),
    )
    .unwrap();
    let mut child = spawn(&case, &out, &[]);
    let file = out.join("progress.json");
    let (mut seen, start) = (Vec::<f64>::new(), Instant::now());
    while seen.len() < 3 {
        assert!(start.elapsed() < Duration::from_secs(60), "{seen:?}");
        std::thread::sleep(Duration::from_millis(5));
        let Ok(bytes) = fs::read(&file) else { continue };
        let progress: Value = serde_json::from_slice(&bytes).unwrap();
        assert_eq!(progress["state"], "running");
        assert_eq!(progress["pid"], child.id());
        let updated = progress["updated_unix_s"].as_f64().unwrap();
        if seen.last().is_none_or(|last| *last < updated) {
            seen.push(updated);
        }
        if seen.len() == 3 {
            assert!(
                0 < progress["step"].as_u64().unwrap() && progress["dt_s"].is_f64(),
                "{progress}"
            );
            assert!(
                progress["eta_s"].is_f64() && progress["dt_limited_by"].is_string(),
                "{progress}"
            );
            // of a still tank under sound: the fastest particle, or none while the step grows
            let holder = &progress["dt_held_by"];
            match progress["dt_limited_by"].as_str() {
                Some("sound") => assert!(holder["particle"]["id"].is_u64(), "{progress}"),
                _ => assert!(
                    holder.is_null() || holder["particle"]["id"].is_u64(),
                    "{progress}"
                ),
            }
            #[cfg(target_os = "linux")]
            assert!(1_000_000 < progress["memory_bytes"].as_u64().unwrap());
        }
    }
    signal(&child, "-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let progress = progress(&out);
    assert_eq!(progress["state"], "interrupted");
    assert!(progress["checkpoint"]["step"].is_u64(), "{progress}");
}

fn signal(child: &std::process::Child, signal: &str) {
    let killed = Command::new("kill")
        .args([signal, &child.id().to_string()])
        .status();
    assert!(killed.unwrap().success());
}

#[cfg(unix)]
#[test]
fn sigusr1_writes_a_checkpoint_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("tank.ron");
    fs::write(&case, TANK).unwrap();
    let (whole, asked) = (folder.path().join("whole"), folder.path().join("asked"));
    assert!(spawn(&case, &whole, &[]).wait().unwrap().success());
    let mut child = Command::new(env!("CARGO_BIN_EXE_riprap"))
        .args([
            "run",
            case.to_str().unwrap(),
            "-o",
            asked.to_str().unwrap(),
            "--quiet",
            "--checkpoint-interval",
            "1e6",
        ])
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !asked.join("water_00001.vtp").exists() {
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(!asked.join("checkpoint.bin").exists());
    signal(&child, "-USR1");
    let start = Instant::now();
    while !asked.join("checkpoint.bin").exists() {
        assert!(start.elapsed() < Duration::from_secs(30) && child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(child.wait().unwrap().success());
    assert_eq!(
        crate::support::killed::difference(&results(&asked), &results(&whole)),
        None
    );
}
