//! `check` tells of water that may become so fast that its sound is felt.

use std::fs;

use crate::support::{case, riprap, words};

/// Water half a meter deep in a tank, in a column of half its length or over all of it.
fn tank(length: f64, numerics: &str) -> String {
    format!(
        r#"(
    title: "Tank",
    domain: (min: (-0.3, 0, -0.3), max: (1.5, 0.1, 1.5), dimensions: Two),
    materials: [(name: "rock", density: 2400, friction_angle_deg: 30)],
    blocks: [
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, -0.3), max: (1.5, 0.1, 0))),
        (name: "left", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, 0), max: (0, 0.1, 1))),
        (name: "right", material: "rock", motion: Fixed, shape: Box(min: (1.2, 0, 0), max: (1.5, 0.1, 1))),
    ],
    fluid: (resolution: Spacing(0.05), regions: [
        (name: "water", shape: Box(min: (0, 0, 0), max: ({length}, 0.1, 0.5))),
    ]),
    numerics: ({numerics}),
    time: (duration: 0.1),
)"#
    )
}

/// The warning of `check`, if any.
fn warning(text: &str) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tank.ron");
    fs::write(&path, text).unwrap();
    let output = riprap(&["check", path.to_str().unwrap()]);
    assert!(output.status.success(), "{}", words(&output));
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    said.lines()
        .find(|line| line.contains("Mach"))
        .map(str::to_owned)
}

#[test]
fn a_dam_break_is_told_its_mach_number_and_still_water_is_not() {
    // front at 2 sqrt(g H), sound at 7 sqrt(g H) where it is chosen: 2/7; density, where it is stopped, by half of its square, 4 %
    let broken = warning(&tank(0.6, "")).unwrap();
    println!("{broken}");
    assert!(
        broken.contains("may reach 4.43 m/s, Mach 0.29") && broken.contains("rises by 4 %"),
        "{broken}"
    );
    // what it advises is enough: 1/7
    assert_eq!(warning(&tank(0.6, "expected_speed: 4.43")), None);
    assert_eq!(warning(&tank(1.2, "")), None);
    // still water with a speed of sound of four times sqrt(g H), 8.86 m/s
    let slow = warning(&tank(1.2, "sound_speed: 8.86")).unwrap();
    assert!(slow.contains("may reach 2.21 m/s, Mach 0.25"), "{slow}");
    // a fifth is allowed
    assert_eq!(warning(&tank(1.2, "preset: Preview")), None);
}

#[test]
fn a_gate_that_is_drawn_holds_no_water_and_a_paddle_does() {
    let of_case = |name: &str| {
        let output = riprap(&["check", case(name).to_str().unwrap()]);
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        said.contains("Mach")
    };
    assert!(of_case("wet_bed.ron"));
    assert!(!of_case("piston.ron"));
    assert!(!of_case("still_tank.ron"));
}

#[test]
fn a_run_with_bodies_in_water_is_told_what_their_motion_may_cost() {
    let told = |name: &str| {
        let output = riprap(&["check", case(name).to_str().unwrap()]);
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        said.contains("as water that bodies move costs more than in these steps")
    };
    assert!(told("piston.ron"));
    assert!(!told("still_tank.ron"));
}
