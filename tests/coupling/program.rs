//! The whole program: scenes in, run folders out.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::support::{case, riprap, run, summary, table, words};

/// Requirements on every finished scene with water.
fn assert_sound(summary: &serde_json::Value) {
    println!(
        "{}: {} particles, {} steps, momentum residual {}, ledger residual {} J",
        summary["case"],
        summary["fluid_particles"],
        summary["steps"],
        summary["momentum_residual"],
        summary["energy"]["residual"]
    );
    assert_eq!(summary["completed"], true);
    assert_eq!(summary["particles_escaped"], 0);
    assert!(summary["momentum_residual"].as_f64().unwrap() < 1e-6);
    // a non-finite number is written as null
    for (name, value) in summary["energy"].as_object().unwrap() {
        assert!(value.is_f64(), "{name} {value}");
    }
}

/// A tenth of the published particles, the same physics.
const SMALL_WEDGE: [&str; 8] = [
    "--set",
    "fluid.resolution=Spacing(0.075)",
    "--set",
    "domain.max=(5.3, 0.3, 1.8)",
    "--set",
    "blocks.wedge.shape.to=0.3",
    "--set",
    "time.settle=0.5",
];

#[test]
fn a_small_sliding_wedge_runs_to_its_end_and_makes_a_wave() {
    let folder = tempfile::tempdir().unwrap();
    let summary = run(
        &case("sliding_wedge.ron"),
        folder.path(),
        &[&SMALL_WEDGE[..], &["--force"]].concat(),
    );
    assert_sound(&summary);
    for file in [
        "case.ron",
        "gauges.csv",
        "blocks.csv",
        "energy.csv",
        "overview.svg",
        "report.html",
        "water.pvd",
        "water.vtp.series",
        "water_00000.vtp",
        "blocks.pvd",
        "blocks_00000.vtp",
        "fixed_blocks.vtp",
    ] {
        assert!(folder.path().join(file).is_file(), "{file} is missing");
    }
    // the wedge stays in the plane of its slab and in the scene
    assert_eq!(summary["blocks_escaped"], 0);
    let blocks = table(&folder.path().join("blocks.csv"));
    let last = &blocks[blocks.len() - 1];
    assert!((last[3] - 0.15).abs() < 1e-3, "sideways to {}", last[3]);
    let gauges = table(&folder.path().join("gauges.csv"));
    let first = gauges[0][1];
    let crest = gauges.iter().map(|row| row[1]).fold(f64::MIN, f64::max);
    // the wedge displaces a fifth of the depth over its own length: a wave well above a spacing
    assert!(crest - first > 0.075, "crest {crest} from {first}");
    // dry slide: 2 cm above the water the wedge moves with g (sin 25 − tan 3 cos 25)
    let early = blocks.iter().find(|row| row[0] > 0.02).unwrap();
    let speed = early[5].hypot(early[7]);
    // before its foot is wet; 1 % for the contact taking up its load in the first steps
    assert!(
        (speed / (3.680 * early[0]) - 1.0).abs() < 0.02,
        "{speed} at {}",
        early[0]
    );
}

#[test]
fn a_small_impacting_block_runs_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let extra = [
        "--set",
        "fluid.resolution=Spacing(0.0555556)",
        "--set",
        "time.settle=0.4",
        "--until",
        "2",
    ];
    let summary = run(&case("impacting_block.ron"), folder.path(), &extra);
    assert_sound(&summary);
    assert_eq!(summary["free_blocks"], 1);
}

#[test]
fn a_small_wavemaker_runs_and_its_paddle_does_work() {
    let folder = tempfile::tempdir().unwrap();
    let extra = [
        "--set",
        "fluid.resolution=Spacing(0.5)",
        "--set",
        "domain.min=(-2.0, 0.0, -1.0)",
        "--set",
        "domain.max=(205.0, 2.0, 7.0)",
        "--set",
        "time.settle=1",
        "--until",
        "12",
    ];
    let summary = run(&case("wavemaker.ron"), folder.path(), &extra);
    assert_sound(&summary);
    assert!(summary["energy"]["external_work"].as_f64().unwrap() > 0.0);
    // nothing can touch among walls and paddle
    assert_eq!(summary["contact_updates_per_second"], 0.0);
}

#[test]
fn a_solitary_wave_keeps_its_height_and_speed() {
    let folder = tempfile::tempdir().unwrap();
    let extra = ["--set", "fluid.resolution=Spacing(0.1)", "--until", "9.5"];
    let summary = run(&case("solitary.ron"), folder.path(), &extra);
    assert_sound(&summary);
    let gauges = table(&folder.path().join("gauges.csv"));
    // time and height above still water of the crest at a column
    let crest = |column: usize| {
        gauges
            .iter()
            .fold((0.0, f64::MIN), |best: (f64, f64), row| {
                if best.1 < row[column] - 1.0 {
                    (row[0], row[column] - 1.0)
                } else {
                    best
                }
            })
    };
    // gauges stand at x = 5, 6, 7, ... m
    let (near, far) = (crest(1), crest(16));
    let celerity = 15.0 / (far.0 - near.0);
    // sqrt(g (d + H)); measured 1.0 % faster, of which 0.5 % is the interval of the gauges
    let ratio = celerity / (9.81_f64 * 1.3).sqrt();
    println!(
        "celerity {ratio} of theory, heights {} and {} m",
        near.1, far.1
    );
    assert!((ratio - 1.0).abs() < 0.02, "celerity {ratio}");
    // measured 0.3075 and 0.3071 m
    assert!((near.1 / 0.3 - 1.0).abs() < 0.05, "height {}", near.1);
    assert!(far.1 > 0.95 * near.1, "{} after {}", far.1, near.1);
}

#[test]
fn threads_and_observers_do_not_change_a_bit_and_case_ron_repeats_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let wedge = case("sliding_wedge.ron");
    let short = [&SMALL_WEDGE[..], &["--until", "0.6"]].concat();
    let one = run(
        &wedge,
        &at("one"),
        &[&short[..], &["--threads", "1"]].concat(),
    );
    let four = run(
        &wedge,
        &at("four"),
        &[&short[..], &["--threads", "4"]].concat(),
    );
    let rarely = [
        "--set",
        "output.frame_interval=1",
        "--set",
        "output.gauge_interval=0.33",
    ];
    let quiet = run(&wedge, &at("quiet"), &[&short[..], &rarely].concat());
    let again = run(&at("one/case.ron"), &at("again"), &[]);
    for other in [&four, &quiet, &again] {
        assert_eq!(one["state_hash"], other["state_hash"]);
    }
}

/// The triangles of terrain are made on all threads, and before the run.
#[test]
fn threads_do_not_change_a_bit_on_terrain() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two] = ["1", "2"].map(|threads| {
        let options = ["--until", "0.2", "--threads", threads];
        run(
            &case("rockfall.ron"),
            &folder.path().join(threads),
            &options,
        )
    });
    assert_eq!(one["threads"], 1);
    assert_eq!(two["threads"], 2);
    assert_eq!(one["state_hash"], two["state_hash"]);
}

/// A scene without water, as text.
fn incline(friction_deg: f64) -> String {
    format!(
        r#"(
    title: "box on a plane of 30 degrees",
    domain: (min: (-10, -5, -10), max: (10, 5, 10)),
    materials: [(name: "rock", density: 2600, friction_angle_deg: {friction_deg})],
    blocks: [
        (name: "plane", material: "rock", motion: Fixed,
         shape: Box(min: (-9, -2, -1), max: (9, 2, 0)),
         placement: (rotate: (axis: (0, 1, 0), angle_deg: 30))),
        (name: "box", material: "rock",
         shape: Box(min: (-0.5, -0.5, 0), max: (0.5, 0.5, 0.3)),
         placement: (rotate: (axis: (0, 1, 0), angle_deg: 30))),
    ],
    time: (duration: 1.0),
)"#
    )
}

#[test]
fn blocks_alone_slide_as_mechanics_says_and_close_their_ledger() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("incline.ron");
    std::fs::write(&scene, incline(20.0)).unwrap();
    let summary = run(&scene, &folder.path().join("out"), &[]);
    assert_eq!(summary["fluid_particles"], 0);
    assert!(!folder.path().join("out/water.pvd").exists());
    let rows = table(&folder.path().join("out/blocks.csv"));
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    let distance = (last[2] - first[2]).hypot(last[4] - first[4]);
    // a = g (sin 30 − cos 30 tan 20) = 1.812815 m/s²; 0.5 % for the contact taking up its load
    let expected = 0.5 * 1.812_815 * last[0] * last[0];
    println!("incline: {distance:.6} m against {expected:.6} m");
    assert!((distance / expected - 1.0).abs() < 5e-3);
    let energy = &summary["energy"];
    let turned_over = energy["friction"].as_f64().unwrap() + energy["kinetic"].as_f64().unwrap();
    let residual = energy["residual"].as_f64().unwrap();
    println!("ledger: {residual:.3e} J of {turned_over:.1} J");
    assert!(residual.abs() < 1e-3 * turned_over);
}

#[test]
fn fixed_blocks_alone_cost_no_dynamics() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("walls.ron");
    std::fs::write(
        &scene,
        incline(20.0).replace(
            "(name: \"box\", material: \"rock\",",
            "(name: \"box\", material: \"rock\", motion: Fixed,",
        ),
    )
    .unwrap();
    let output = riprap(&["check", scene.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success());
    assert!(
        said.contains("no block dynamics and no contact search"),
        "{said}"
    );
    assert!(said.contains("no fluid is modeled"), "{said}");
    let summary = run(&scene, &folder.path().join("out"), &[]);
    assert_eq!(summary["contact_updates_per_second"], 0.0);
    assert_eq!(summary["momentum_residual"], 0.0);
}

#[test]
fn ctrl_c_writes_everything_and_exits_130() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let mut child = Command::new(env!("CARGO_BIN_EXE_riprap"))
        .args([
            "run",
            case("sliding_wedge.ron").to_str().unwrap(),
            "-o",
            out.to_str().unwrap(),
        ])
        .args(["--set", "time.settle=0", "--quiet"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while !out.join("water_00000.vtp").exists() {
        std::thread::sleep(Duration::from_millis(20));
    }
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(kill.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let summary = summary(&out);
    assert_eq!(summary["completed"], false);
    assert_eq!(summary["stop_reason"], "interrupted");
    assert!(out.join("overview.svg").is_file());
}

#[test]
fn an_old_run_is_not_overwritten_without_force() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("incline.ron");
    std::fs::write(&scene, incline(20.0)).unwrap();
    let out = folder.path().join("out");
    run(&scene, &out, &["--until", "0.01"]);
    std::fs::write(out.join("notes.txt"), "mine").unwrap();
    let arguments = [
        "run",
        scene.to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
        "--until",
        "0.02",
    ];
    let refused = riprap(&arguments);
    assert_eq!(refused.status.code(), Some(2));
    assert!(words(&refused).contains("--force"), "{}", words(&refused));
    assert!(
        riprap(&[&arguments[..], &["--force"]].concat())
            .status
            .success()
    );
    // what is not ours stays
    assert!(out.join("notes.txt").exists());
}

#[test]
fn a_run_by_force_leaves_nothing_of_the_old_one() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("incline.ron");
    std::fs::write(&scene, incline(20.0)).unwrap();
    let [old, new] = ["old", "new"].map(|name| folder.path().join(name));
    let all = [
        &SMALL_WEDGE[..],
        &["--until", "0.02", "--set", "output.face_pressures=true"],
        &[
            "--set",
            r#"forces=(blocks: ["wedge"], interval: 0.01)"#,
            "--set",
            r#"trajectories=(blocks: ["wedge"])"#,
            "--set",
            r#"masses=[(name: "slide", blocks: "wedge")]"#,
            "--set",
            r#"counters=[Plane(name: "toe", point: (0, 0, 0), normal: (1, 0, 0))]"#,
            "--set",
            r#"reactions=[(name: "all", between: ("*", "*"))]"#,
            "--set",
            r#"barriers=[(name: "slope", blocks: ["slope"], flow: (1, 0, 0))]"#,
            "--set",
            "maps=(interval: 0.01)",
            // a plane has no maps
            "--set",
            "domain.dimensions=Three",
            "--set",
            "domain.periodic=[Y]",
        ],
    ];
    run(&case("sliding_wedge.ron"), &old, &all.concat());
    let few = ["--until", "0.01"];
    run(&scene, &new, &few);
    let files = |folder: &Path| -> BTreeSet<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let name = |entry: std::fs::DirEntry| entry.file_name().into_string().unwrap();
        entries.map(|entry| name(entry.unwrap())).collect()
    };
    let before = files(&old);
    for file in [
        "forces.csv",
        "contacts.csv",
        "faces.pvd",
        "trajectories.csv",
        "masses.csv",
        "counters.csv",
        "reactions.csv",
        "barrier_slope.csv",
        "barrier_slope.vtp",
        "maps.vtp",
        "maximum_elevation.asc",
        "first_arrival.asc",
        "inundation_depth.asc",
        "maximum_elevation.tif",
    ] {
        assert!(before.contains(file), "{file} is not in {before:?}");
    }
    run(&scene, &old, &[&few[..], &["--force"]].concat());
    assert_eq!(files(&old), files(&new));
}

#[test]
fn an_unwritable_folder_is_named() {
    let refused = riprap(&[
        "run",
        case("sliding_wedge.ron").to_str().unwrap(),
        "-o",
        "/proc/no/such/place",
    ]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        words(&refused).contains("/proc/no/such/place"),
        "{}",
        words(&refused)
    );
}

/// Every wrong scene names file, line, column, what was found and what would be right.
#[test]
fn wrong_scenes_are_explained_in_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("wrong.ron");
    let explain = |text: String| {
        std::fs::write(&scene, text).unwrap();
        let output = riprap(&["check", scene.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(2), "{}", words(&output));
        words(&output)
    };
    let right = incline(20.0);
    for (from, to, expected) in [
        (
            "density: 2600",
            "densty: 2600",
            &[
                "wrong.ron:4:",
                "unknown field `densty`",
                "did you mean `density`?",
            ][..],
        ),
        (
            "density: 2600",
            "density: -2500",
            &["wrong.ron:4:41: error: material `rock`: density must be > 0, found -2500"],
        ),
        (
            "density: 2600",
            "density: NaN",
            &[
                "wrong.ron:4:41",
                "`materials[0].density` is NaN; a number must be finite",
            ],
        ),
        (
            "density: 2600",
            "density: 1e999",
            &["wrong.ron:4:41", "1e999"],
        ),
        (
            "friction_angle_deg: 20",
            "friction_angle_deg: 95",
            &["wrong.ron:4:", "must be in [0, 90) degrees, found 95"],
        ),
        (
            "name: \"box\", material: \"rock\"",
            "name: \"box\", material: \"rok\"",
            &[
                "wrong.ron:9:",
                "`rok` is not in materials, did you mean `rock`?",
            ],
        ),
        (
            "name: \"box\"",
            "name: \"plane\"",
            &["the name `plane` is taken"],
        ),
        (
            "max: (0.5, 0.5, 0.3)",
            "max: (0.5, -0.6, 0.3)",
            &["wrong.ron:10:", "max (0.5, -0.6, 0.3) must exceed min"],
        ),
        (
            "motion: Fixed",
            "motion: Fixt",
            &[
                "wrong.ron:6:",
                "unknown variant `Fixt`",
                "did you mean `Fixed`?",
            ],
        ),
        (
            "duration: 1.0",
            "duration: 0",
            &["wrong.ron:13:", "duration must be > 0, found 0"],
        ),
        ("time: (duration: 1.0),", "", &["missing field `time`"]),
        (
            "max: (10, 5, 10)",
            "max: (10, 5, -10)",
            &["wrong.ron:3:", "domain: max"],
        ),
        (
            "axis: (0, 1, 0), angle_deg: 30))),\n    ]",
            "axis: (0, 0, 0), angle_deg: 30))),\n    ]",
            &["axis of rotation has no direction"],
        ),
        (
            "min: (-0.5, -0.5, 0)",
            "min: (-0.5, -0.5, -0.2)",
            &["block `box` overlaps block `plane` by", "move them apart"],
        ),
    ] {
        assert!(right.contains(from), "{from}");
        let message = explain(right.replacen(from, to, 1));
        for part in expected {
            assert!(
                message.contains(part),
                "for `{to}` expected `{part}` in:\n{message}"
            );
        }
    }
    // all validation errors come together
    let two = explain(
        right
            .replace("density: 2600", "density: -1")
            .replace("duration: 1.0", "duration: -1"),
    );
    assert!(
        two.contains("density must be > 0") && two.contains("duration must be > 0"),
        "{two}"
    );
}

#[test]
fn every_case_passes_its_check() {
    for entry in std::fs::read_dir(case("")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "ron") {
            let output = riprap(&["check", path.to_str().unwrap()]);
            assert!(
                output.status.success(),
                "{}: {}",
                path.display(),
                words(&output)
            );
        }
    }
}

#[test]
fn overrides_reach_any_field_through_the_same_checks() {
    let wedge = case("sliding_wedge.ron");
    let check = |set: &str| riprap(&["check", wedge.to_str().unwrap(), "--set", set]);
    for good in [
        "numerics.smoothing_length_ratio=1.3",
        "numerics=(time_step_factor: 0.4)",
        "blocks.wedge.velocity=(0.1, 0, 0)",
        "materials[0].restitution=0.3",
        "output.contacts=true",
        "gauges.g1.x=0.7",
    ] {
        let output = check(good);
        assert!(output.status.success(), "{good}: {}", words(&output));
    }
    for (bad, expected) in [
        ("numerics.smoothing_length=1.3", "smoothing_length_ratio"),
        (
            "numerics.smoothing_length_ratio=9",
            "must be in [1, 3], found 9",
        ),
        (
            "numerics.bulk_viscosity=-0.1",
            "bulk viscosity must be in [0, 1], found -0.1",
        ),
        (
            "numerics.bulk_viscosity=2",
            "bulk viscosity must be in [0, 1], found 2",
        ),
        (
            // the density of the published scheme is a sum
            "numerics=(preset: Mueller2003, bulk_viscosity: 0.1)",
            "bulk viscosity acts on the rate of density",
        ),
        ("blocks.wegde.velocity=(0, 0, 0)", "no such"),
        ("time.duration", "PATH=VALUE"),
    ] {
        let output = check(bad);
        assert_eq!(output.status.code(), Some(2), "{bad}");
        assert!(
            words(&output).contains(expected),
            "{bad}: {}",
            words(&output)
        );
    }
}

#[test]
fn help_teaches() {
    let output = riprap(&["--help"]);
    let help = String::from_utf8_lossy(&output.stdout).into_owned();
    for word in [
        "new",
        "run",
        "check",
        "render",
        "report",
        "inspect",
        "compare",
        "explain",
        "completions",
        "Exit codes",
        "cases/sliding_wedge.ron",
    ] {
        assert!(help.contains(word), "{word} in {help}");
    }
    assert_eq!(riprap(&["rnu"]).status.code(), Some(2));
    assert!(!Path::new("runs").exists());
}
