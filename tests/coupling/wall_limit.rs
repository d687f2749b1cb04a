//! Runs that end before their wall limit, and go on from there to the same files.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::support::killed::{TANK, difference, results, spawn};
use crate::support::{self, riprap, words};

fn go(case: &Path, out: &Path, extra: &[&str]) -> (Option<i32>, Duration) {
    let start = Instant::now();
    let arguments = [
        "run",
        case.to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
        "--quiet",
    ];
    let output = riprap(&[&arguments[..], extra].concat());
    (output.status.code(), start.elapsed())
}

#[test]
fn a_run_ends_before_its_limit_and_goes_on_to_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("tank.ron");
    // a part makes way if it takes the 100 steps from one kept state to the next
    fs::write(&case, TANK.replace("duration: 0.4", "duration: 2")).unwrap();
    let (whole, parts) = (folder.path().join("whole"), folder.path().join("parts"));
    let start = Instant::now();
    assert!(spawn(&case, &whole, &[]).wait().unwrap().success());
    let duration = start.elapsed().as_secs_f64();
    let limit = format!("{:.3}s", 0.5 * duration);
    let mut stops = 0;
    loop {
        let (code, wall) = go(&case, &parts, &["--resume", "--wall-limit", &limit]);
        if code == Some(0) {
            break;
        }
        assert_eq!(code, Some(4));
        // what cannot be measured before the end, on a machine that does other things, too
        assert!(
            wall.as_secs_f64() < 0.5 * duration + 2.0,
            "{wall:?} of {limit}"
        );
        let summary = support::summary(&parts);
        assert_eq!(summary["stop_reason"], "stopped at its wall limit");
        let progress = fs::read_to_string(parts.join("progress.json")).unwrap();
        assert!(progress.contains("\"state\": \"wall_limit\""), "{progress}");
        assert!(parts.join("checkpoint.bin").exists() && !parts.join("report.html").exists());
        stops += 1;
        assert!(stops < 50, "no way is made");
    }
    assert!(0 < stops);
    assert_eq!(difference(&results(&parts), &results(&whole)), None);
}

#[test]
fn the_limit_of_a_scene_is_one_too_and_may_change_on_the_way() {
    let folder = tempfile::tempdir().unwrap();
    let (case, out) = (folder.path().join("tank.ron"), folder.path().join("out"));
    let limited =
        |limit: &str| TANK.replace("settle: 0.2", &format!("settle: 0.2, wall_limit: {limit}"));
    fs::write(&case, limited("0.01")).unwrap();
    let (code, _) = go(&case, &out, &[]);
    assert_eq!(code, Some(4));
    fs::write(&case, limited("1000")).unwrap();
    assert_eq!(go(&case, &out, &["--resume"]).0, Some(0));
    assert_eq!(support::summary(&out)["completed"], true);
    // the command line takes precedence
    fs::write(&case, limited("0.01")).unwrap();
    assert_eq!(
        go(&case, &out, &["--force", "--wall-limit", "1h"]).0,
        Some(0)
    );
    fs::write(&case, limited("-1")).unwrap();
    let refused = riprap(&["check", case.to_str().unwrap()]);
    assert!(
        words(&refused).contains("wall limit must be > 0, found -1"),
        "{}",
        words(&refused)
    );
}
