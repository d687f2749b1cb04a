//! `riprap paraview`: the script of a run made up here. Where ParaView is installed, `pvbatch` draws a picture with it.
//!
//! RIPRAP_REQUIRE_PARAVIEW=1 makes the absence of pvbatch a failure instead of a skipped check.

use std::fs;
use std::process::Command;

use crate::support::synthetic_run;
use crate::support::{riprap, words};

const CAMERA: &str =
    "camera: (position: (0.6, -3, 1.5), look_at: (0.6, 0.3, 0.2), field_of_view_deg: 40)";

/// Value of a setting at the top of a script.
fn setting<'a>(script: &'a str, name: &str) -> &'a str {
    let begin = format!("{name} = ");
    let line = script.lines().find(|line| line.starts_with(&begin));
    &line.unwrap()[begin.len()..]
}

#[test]
fn a_script_has_the_scales_and_the_camera_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("a run");
    synthetic_run::write(&out, &synthetic_run::tank(0.05), CAMERA, 0).unwrap();
    let output = riprap(&["paraview", out.to_str().unwrap()]);
    assert!(output.status.success(), "{}", words(&output));
    let file = out.join("open_in_paraview.py");
    let script = fs::read_to_string(&file).unwrap();
    assert_eq!(setting(&script, "SPACING"), "0.05");
    assert_eq!(setting(&script, "RUN_BESIDE"), "\".\"");
    assert_eq!(setting(&script, "COLOR"), "\"Speed\"");
    assert_eq!(setting(&script, "EYE"), "[0.6,-3.0,1.5]");
    // 40 degrees across a picture of 16 by 9 are 2 atan(tan(20) 9/16) = 23.14 up and down
    let angle: f64 = setting(&script, "VIEW_ANGLE").parse().unwrap();
    assert!((angle - 23.140).abs() < 1e-3, "{angle}");
    assert_eq!(setting(&script, "TITLE"), r#""synthetic \"run\"""#);

    // a script elsewhere finds the way to the run
    let other = folder.path().join("scripts");
    fs::create_dir(&other).unwrap();
    let elsewhere = other.join("view.py");
    let arguments = [
        "paraview",
        out.to_str().unwrap(),
        "--color",
        "elevation",
        "-o",
    ];
    let output = riprap(&[&arguments[..], &[elsewhere.to_str().unwrap()]].concat());
    assert!(output.status.success(), "{}", words(&output));
    let script = fs::read_to_string(&elsewhere).unwrap();
    assert_eq!(setting(&script, "RUN_BESIDE"), "\"../a run\"");
    assert_eq!(setting(&script, "COLOR"), "\"Elevation\"");
    let [low, high]: [f64; 2] = serde_json::from_str(setting(&script, "ELEVATIONS")).unwrap();
    assert!(
        (0.0..0.1).contains(&low) && (0.3..0.45).contains(&high),
        "{low} {high}"
    );

    let nothing = riprap(&["paraview", folder.path().to_str().unwrap()]);
    assert_eq!(nothing.status.code(), Some(1));
    assert!(words(&nothing).contains("case.ron"), "{}", words(&nothing));
}

#[test]
fn paraview_draws_the_run() {
    let has_paraview = Command::new("pvbatch")
        .arg("--version")
        .output()
        .is_ok_and(|output| output.status.success());
    if !has_paraview {
        let is_required = std::env::var("RIPRAP_REQUIRE_PARAVIEW").is_ok_and(|value| value == "1");
        assert!(!is_required, "no pvbatch, and RIPRAP_REQUIRE_PARAVIEW=1");
        println!("skipped: no pvbatch");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    synthetic_run::write(folder.path(), &synthetic_run::tank(0.05), CAMERA, 0).unwrap();
    assert!(
        riprap(&["paraview", folder.path().to_str().unwrap()])
            .status
            .success()
    );
    let picture = folder.path().join("picture.png");
    // builds for a window system need one, if only a virtual one; a server that resets when its last client leaves turns
    // away the window that comes right after pvbatch's first, short connection
    let mut command = match std::env::var_os("DISPLAY") {
        Some(_) => Command::new("pvbatch"),
        None => {
            let mut command = Command::new("xvfb-run");
            command.args(["-a", "-s", "-screen 0 1280x1024x24 -noreset", "pvbatch"]);
            command
        }
    };
    let output = command
        .arg(folder.path().join("open_in_paraview.py"))
        .args([picture.as_os_str(), "0.4".as_ref()])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", words(&output));
    let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(&picture).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height), (1280, 720));
    let n = info.color_type.samples();
    let colored = pixels
        .chunks(n)
        .filter(|p| p[..3].iter().max() > p[..3].iter().min());
    // water, blocks and legend on white: measured a fifth of the picture
    assert!(colored.count() > 1280 * 720 / 50);
}
