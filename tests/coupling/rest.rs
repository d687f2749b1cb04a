//! Runs that end once nothing moves any more.

use crate::support::{riprap, run, summary, words};

const FRICTION: f64 = 0.5;
const SPEED: f64 = 2.0;

/// A block that slides on a level floor, by springs or contact dynamics.
fn sliding(blocks: &str) -> String {
    format!(
        r#"(
    title: "A block slides until friction stops it",
    domain: (min: (-2, -2, -1), max: (4, 2, 2)),
    materials: [(name: "rock", density: 2600, friction_angle_deg: {}, contact_stiffness: 1e9)],
    blocks: [
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-2, -2, -1), max: (4, 2, 0))),
        (name: "block", material: "rock", shape: Box(min: (-0.5, -0.5, 0), max: (0.5, 0.5, 0.3)), velocity: ({SPEED}, 0, 0)),
    ],
    numerics: (blocks: {blocks}),
    time: (duration: 5, stop_at_rest: (speed: 0.01, time: 0.2)),
)"#,
        FRICTION.atan().to_degrees()
    )
}

/// v/(μ g) and a fifth of a second.
#[test]
fn a_run_ends_when_its_block_has_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.ron");
    let stop = SPEED / (FRICTION * 9.81) + 0.2;
    for (name, blocks) in [
        ("springs", "CentralDifference"),
        ("dynamics", "ContactDynamics(time_step: 0.002)"),
    ] {
        std::fs::write(&scene, sliding(blocks)).unwrap();
        let out = folder.path().join(name);
        run(&scene, &out, &[]);
        let ended = summary(&out);
        assert_eq!(ended["completed"], true);
        assert_eq!(ended["stop_reason"], "completed: at rest");
        let time = ended["simulated_time"].as_f64().unwrap();
        // 0.01 m/s are reached 2 ms before rest; springs under the block swing for some hundredths of a second
        assert!(
            (-0.01..0.06).contains(&(time - stop)),
            "{name}: {time} {stop}"
        );
        // there is nothing more to do
        let output = riprap(&[
            "run",
            scene.to_str().unwrap(),
            "-o",
            out.to_str().unwrap(),
            "--resume",
        ]);
        assert!(output.status.success(), "{}", words(&output));
        assert_eq!(ended, summary(&out));
    }
}

/// A run in two pieces ends at the same step.
#[test]
fn a_run_in_pieces_ends_at_the_same_step() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.ron");
    std::fs::write(&scene, sliding("CentralDifference")).unwrap();
    let whole = folder.path().join("whole");
    run(&scene, &whole, &[]);
    let pieces = folder.path().join("pieces");
    // in the middle of the time at rest
    run(&scene, &pieces, &["--until", "0.5"]);
    run(&scene, &pieces, &["--resume", "--until", "5"]);
    let [whole, pieces] = [summary(&whole), summary(&pieces)];
    for key in ["simulated_time", "steps", "state_hash"] {
        assert_eq!(whole[key], pieces[key], "{key}");
    }
}

#[test]
fn speeds_and_times_of_rest_are_positive() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.ron");
    for (old, new, what) in [
        ("speed: 0.01", "speed: 0", "speed at rest"),
        ("time: 0.2", "time: -1", "time at rest"),
    ] {
        let text = sliding("CentralDifference").replace(old, new);
        std::fs::write(&scene, text).unwrap();
        let output = riprap(&["check", scene.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(2));
        assert!(words(&output).contains(what), "{}", words(&output));
    }
}
