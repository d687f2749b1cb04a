//! Wave makers in scenes: the motion of the piston, and the report about it.

use std::path::Path;

use riprap::scene::access::Access;
use riprap::scene::load_text;
use riprap::scene::resolve::Scene;
use riprap_dda::{Motion, PrescribedMotion, Vec3};

/// A flume of 10 m with 0.5 m of water above a floor at 0.13 m.
fn flume(motion: &str) -> String {
    format!(
        "(title: \"flume\",
          domain: (min: (-1, 0, -0.5), max: (11, 1, 2), dimensions: Two),
          materials: [(name: \"rock\", density: 2600, friction_angle_deg: 35)],
          blocks: [
              (name: \"paddle\", material: \"rock\", shape: Box(min: (-0.4, 0, 0), max: (0, 1, 1.5)),
               motion: {motion}),
              (name: \"floor\", material: \"rock\", motion: Fixed, shape: Box(min: (-1, 0, -0.5), max: (11, 1, 0.13))),
              (name: \"end\", material: \"rock\", motion: Fixed, shape: Box(min: (10, 0, 0.13), max: (11, 1, 1.5))),
          ],
          fluid: (resolution: Spacing(0.05), regions: [
              (name: \"flume\", shape: Below(level: 0.63, seed: (5, 0.5, 0.4)))]),
          time: (duration: 12))"
    )
}

fn scene(motion: &str) -> (Scene, String) {
    let access = Access::of(Path::new("."));
    let (scene, warnings) = load_text("flume.ron", &flume(motion), &[], &access).unwrap();
    (scene, format!("{warnings:?}"))
}

/// Message and place of a refusal, with the place of `word` in the text of the flume.
fn refusal(motion: &str, word: &str) -> (String, String) {
    let access = Access::of(Path::new("."));
    let text = flume(motion);
    let error = load_text("flume.ron", &text, &[], &access).unwrap_err();
    let before = &text[..text.find(word).unwrap()];
    let line = before.lines().count();
    let column = before.len() - before.rfind('\n').unwrap();
    let place = format!("line: {line}, column: {column},");
    (format!("{error:?}"), place)
}

fn places(scene: &Scene) -> (Vec<f64>, Vec<Vec3>) {
    let Motion::Prescribed(PrescribedMotion::Table {
        time, displacement, ..
    }) = &scene.blocks[0].motion
    else {
        panic!("the paddle has no record");
    };
    (time.clone(), displacement.clone())
}

/// The depth is that from the floor, which is not the bottom of the domain, to the level, and the piston moves along the
/// direction that is given, of any length.
#[test]
fn a_piston_moves_for_the_water_before_it() {
    let (found, warnings) = scene("Waves(direction: (3, 0, 0), waves: Solitary(height: 0.1))");
    let maker = &found.wave_makers[0];
    assert!(
        (maker.piston.water.depth - 0.5).abs() < 1e-12,
        "{}",
        maker.piston.water.depth
    );
    let (time, place) = places(&found);
    // Goring's stroke with Rayleigh's decay, but for what tanh 4 leaves out
    let stroke = (16.0 * 0.1 * 0.6 / 3.0_f64).sqrt() * 4.0_f64.tanh();
    assert!((place.last().unwrap() - Vec3::new(stroke, 0.0, 0.0)).norm() < 1e-12);
    assert!(time.windows(2).all(|pair| pair[0] < pair[1]));
    assert!(!warnings.contains("block `paddle`"), "{warnings}");
}

#[test]
fn a_given_depth_takes_the_place_of_the_measured_one() {
    let (found, _) =
        scene("Waves(direction: (1, 0, 0), depth: 0.4, waves: Regular(height: 0.05, period: 1.5))");
    assert_eq!(found.wave_makers[0].piston.water.depth, 0.4);
    // also where no region of water reaches the piston's face, as in a box that begins two spacings before it
    let box_of_water = "shape: Box(min: (0.1, 0, 0.13), max: (10, 1, 0.63))";
    let text = flume("Waves(direction: (1, 0, 0), depth: 0.4, waves: Solitary(height: 0.05))")
        .replace(
            "shape: Below(level: 0.63, seed: (5, 0.5, 0.4))",
            box_of_water,
        );
    let (apart, _) = load_text("flume.ron", &text, &[], &Access::of(Path::new("."))).unwrap();
    assert_eq!(apart.wave_makers[0].piston.water.depth, 0.4);
    // it covers the run
    assert!((places(&found).0.last().unwrap() - 12.0).abs() < 1e-12);
}

/// Each kind says its scales.
#[test]
fn a_report_tells_the_scales_of_the_waves() {
    for (waves, expected) in [
        (
            "Regular(height: 0.05, period: 1.5)",
            "regular waves, height 0.05 m, period 1.5 s, on 0.5000 m: length 2.8265 m, kh 1.111",
        ),
        (
            "Solitary(height: 0.1)",
            "solitary wave, height 0.1 m, on 0.5000 m",
        ),
        (
            "Irregular(height: 0.05, period: 1.5)",
            "irregular waves, significant height 0.05 m, peak period 1.5 s",
        ),
        (
            "Focused(amplitude: 0.05, period: 1.5, distance: 5, time: 9)",
            "group of waves, 0.05 m high 5 m before it at 9 s",
        ),
    ] {
        let (found, _) = scene(&format!("Waves(direction: (1, 0, 0), waves: {waves})"));
        let text = found.wave_makers[0].description(Some(0.05));
        assert!(text.starts_with(expected), "{text}");
        for word in ["kh ", "H/h ", "H/L ", "stroke ", "spacings"] {
            assert!(text.contains(word), "{word}: {text}");
        }
    }
}

/// Waves that break, come too late, or take the piston out of the domain are warned of, with the number to change.
#[test]
fn waves_that_will_not_do_are_warned_of() {
    for (waves, expected) in [
        (
            "Solitary(height: 0.45)",
            "waves of 0.4500 m break on 0.5000 m of water, by McCowan (1894) above 0.3900 m",
        ),
        ("Regular(height: 0.3, period: 1)", "by Miche (1944) above"),
        ("Regular(height: 0.1, period: 5)", "times H L2/h3 = 26.3"),
        (
            "Focused(amplitude: 0.05, period: 1.5, distance: 8, time: 3)",
            "they come too late; let time be",
        ),
        (
            "Regular(height: 0.12, period: 20)",
            "out of the domain; let domain.min reach",
        ),
    ] {
        let (_, warnings) = scene(&format!("Waves(direction: (1, 0, 0), waves: {waves})"));
        assert!(warnings.contains(expected), "{waves}: {warnings}");
    }
}

/// Wrong numbers are refused at their place, with what would be right.
#[test]
fn wrong_waves_are_refused_at_their_place() {
    for (motion, word, expected) in [
        (
            "Waves(direction: (1, 0, 0), waves: Regular(height: -0.05, period: 1.5))",
            "-0.05",
            "block `paddle`: height of the waves must be > 0, found -0.05",
        ),
        (
            "Waves(direction: (1, 0, 1), waves: Solitary(height: 0.1))",
            "(1, 0, 1)",
            "must be horizontal, found (1.0, 0.0, 1.0); let its z be 0",
        ),
        (
            "Waves(direction: (1, 0, 0), waves: Irregular(spectrum: Jonswap(0.2), height: 0.1, period: 2))",
            "Jonswap",
            "peak enhancement of Jonswap must be from 1 to 10, found 0.2",
        ),
        (
            "Waves(direction: (-1, 0, 0), waves: Solitary(height: 0.1))",
            "(-1, 0, 0)",
            "no water stands before it along its direction",
        ),
        (
            "Waves(direction: (1, 0, 0), waves: Solitari(height: 0.1))",
            "Solitari",
            "did you mean `Solitary`?",
        ),
    ] {
        let (told, place) = refusal(motion, word);
        assert!(told.contains(expected), "{motion}: {told}");
        assert!(told.contains(&place), "{motion}: {place} {told}");
    }
}

/// A layer shorter than the waves sends much of them back; one as long as they are is not talked about. Waves of 2.5 s on 0.5 m of water
/// are 5.2 m long, of a paddle that is a sinusoid as of one that computes its motion.
#[test]
fn layers_shorter_than_the_waves_are_told() {
    let access = Access::of(Path::new("."));
    let warned = |motion: &str, from: f64| {
        let layer = format!(
            "absorbers: [(name: \"beach\", min: ({from:?}, 0, 0), max: (10, 1, 2), towards: XMax)], time:"
        );
        let text = flume(motion).replace("time:", &layer);
        let (_, warnings) = load_text("flume.ron", &text, &[], &access).unwrap();
        let words = format!("{warnings:?}");
        words.contains("absorber `beach` is") && words.contains("of a wave of 5.2")
    };
    let sinusoid = "Sinusoid(direction: (1, 0, 0), amplitude: 0.02, period: 2.5)";
    for motion in [
        "Waves(direction: (1, 0, 0), waves: Regular(height: 0.02, period: 2.5))",
        sinusoid,
    ] {
        assert!(warned(motion, 7.0), "{motion}");
        assert!(!warned(motion, 4.5), "{motion}");
    }
}
