//! `riprap check --json`: the numbers of the report in words, of the run, and errors in their place.

use serde_json::Value;

use crate::support::{case, riprap, run};

/// A coarse wedge, a tenth of the published particles.
const SMALL: [&str; 8] = [
    "--set",
    "fluid.resolution=Spacing(0.075)",
    "--set",
    "domain.max=(5.3, 0.3, 1.8)",
    "--set",
    "blocks.wedge.shape.to=0.3",
    "--set",
    "time.settle=0.02",
];

fn checked(arguments: &[&str]) -> (Option<i32>, Value, String) {
    let output = riprap(&[&["check", "--json"], arguments].concat());
    let report = serde_json::from_slice(&output.stdout).unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), report, said)
}

#[test]
fn the_numbers_are_those_of_the_words_and_of_the_run() {
    let wedge = case("sliding_wedge.ron");
    let arguments = [
        &[wedge.to_str().unwrap()][..],
        &SMALL,
        &["--set", "time.duration=0.05"],
    ]
    .concat();
    let (code, report, said) = checked(&arguments);
    assert_eq!((code, said.as_str()), (Some(0), ""));
    assert_eq!(report["is_valid"], true);
    let output = riprap(&[&["check"], &arguments[..]].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let (model, cost) = (&report["model"], &report["cost"]);
    let water = &model["water"];
    let number = |value: &Value| value.as_f64().unwrap();
    let step = &cost["step"];
    let governing = step["limits"].as_array().unwrap().iter();
    let governing: Vec<&Value> = governing
        .filter(|limit| limit["cause"] == step["limited_by"])
        .collect();
    assert_eq!(number(&governing[0]["dt_s"]), number(&step["dt_s"]));
    for words in [
        format!(
            "{} particles, spacing {:.4} m",
            water["particles"],
            number(&water["spacing_m"])
        ),
        format!(
            "{:.2} m/s, {:.1} times",
            number(&water["sound_speed_m_per_s"]),
            number(&water["sound_speed_m_per_s"]) / number(&water["expected_speed_m_per_s"])
        ),
        format!(
            "{} free, {} prescribed, {} fixed",
            model["blocks"]["free"], model["blocks"]["prescribed"], model["blocks"]["fixed"]
        ),
        format!(
            "about {:.0}, {} block sub-steps",
            number(&cost["steps"]),
            step["block_substeps"]
        ),
        format!("{:.3e} s", number(&step["dt_s"])),
        format!(
            "up to {:.0} MB",
            (number(&report["memory"]["total_bytes"]) / 1e6).ceil()
        ),
        format!("{} frames of water", cost["disk"]["water"]["frames"]),
    ] {
        assert!(text.contains(&words), "{words} in\n{text}");
    }
    // the lines in words are there as well
    for line in report["text"].as_array().unwrap() {
        assert!(text.contains(line["text"].as_str().unwrap()), "{line}");
    }
    let folder = tempfile::tempdir().unwrap();
    let summary = run(&wedge, folder.path(), &arguments[1..]);
    assert_eq!(summary["fluid_particles"], water["particles"]);
    assert_eq!(summary["particle_spacing"], water["spacing_m"]);
    assert_eq!(summary["free_blocks"], model["blocks"]["free"]);
    assert_eq!(summary["fixed_blocks"], model["blocks"]["fixed"]);
    // the first steps are as long as the first; settling is 0.02 of 0.07 s
    let steps = number(&cost["steps"]) * number(&model["duration_s"]) / 0.07;
    assert!(
        (number(&summary["steps"]) / steps - 1.0).abs() < 0.1,
        "{} of {steps}",
        summary["steps"]
    );
    let frames = cost["disk"]["water"]["frames"].as_u64().unwrap();
    let last = |n: u64| folder.path().join(format!("water_{n:05}.vtp"));
    assert!(last(frames - 1).exists() && !last(frames).exists());
    let size: u64 = (0..frames).map(|n| last(n).metadata().unwrap().len()).sum();
    let ratio = number(&cost["disk"]["water"]["size_bytes"]) / size as f64;
    assert!((0.5..2.0).contains(&ratio), "{ratio} of the disk space");
    let blocks: u64 = (0..cost["disk"]["blocks"]["frames"].as_u64().unwrap())
        .map(|n| {
            folder
                .path()
                .join(format!("blocks_{n:05}.vtp"))
                .metadata()
                .unwrap()
                .len()
        })
        .sum();
    let ratio = number(&cost["disk"]["blocks"]["size_bytes"]) / blocks as f64;
    assert!(
        (0.5..2.0).contains(&ratio),
        "{ratio} of the disk space of blocks, {blocks}"
    );
}

#[test]
fn errors_are_objects_with_their_place_and_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wrong.ron");
    let right = std::fs::read_to_string(case("still_tank.ron")).unwrap();
    let scene = path.to_str().unwrap();
    for (text, place, words) in [
        (
            right.replace("duration:", "duratoin:"),
            "time",
            "did you mean `duration`?",
        ),
        (
            right.replace("title:", "titel:"),
            "",
            "did you mean `title`?",
        ),
        ("(".to_owned(), "", ""),
    ] {
        std::fs::write(&path, &text).unwrap();
        let (code, report, said) = checked(&[scene]);
        assert_eq!((code, said.as_str()), (Some(2), ""));
        assert_eq!(report["is_valid"], false);
        assert!(report["model"].is_null() && report["cost"].is_null());
        let problem = &report["problems"][0];
        assert_eq!(problem["severity"], "error");
        assert_eq!(problem["file"], scene);
        assert!(
            problem["message"].as_str().unwrap().contains(words),
            "{problem}"
        );
        assert!(
            problem["path"].as_str().unwrap().starts_with(place),
            "{problem}"
        );
        assert!(1 <= problem["line"].as_u64().unwrap() && 1 <= problem["column"].as_u64().unwrap());
    }
    // of a field that is read and wrong, with what is there
    std::fs::write(&path, &right).unwrap();
    let (code, report, _) = checked(&[scene, "--set", "time.duration=-1"]);
    assert_eq!(code, Some(2));
    let problem = &report["problems"][0];
    assert_eq!(
        (&problem["path"], &problem["found"]),
        (&"time.duration".into(), &"-1".into())
    );
    // a warning does not stop
    let (code, report, _) = checked(&[scene, "--set", "output.frame_interval=1e5"]);
    assert_eq!((code, &report["is_valid"]), (Some(0), &true.into()));
    assert_eq!(report["problems"][0]["severity"], "warning");
    // and one that cannot be read at all
    let (code, report, _) = checked(&["missing.ron"]);
    assert_eq!(
        (code, &report["problems"][0]["file"]),
        (Some(2), &"missing.ron".into())
    );
}
