//! Quantities with units, in every language and in `--set`.

use riprap::scene::locate::Syntax;
use riprap::scene::parse;

use super::{JSON, YAML, answers};

const RON: &str = r#"(
    title: "30 m tank", // a text is no quantity
    gravity: (0, "0 m/s2", "-1 g"),
    domain: (min: (0, 0, 0), max: ("4000 mm", "1m", "6.5616797900262469 ft")),
    materials: [
        (name: "2 rock", density: "2.65 t/m3", friction_angle_deg: "0.5 rad", cohesion: "0.2 MPa",
         elastic: (young_modulus: "10 GPa", poisson_ratio: "25 %")),
    ],
    joints: [(between: ("2 rock", "2 rock"), friction_ramp: [("0 s", 1), ("1 h", "50 %")])],
    blocks: [
        (name: "floor", material: "2 rock", motion: Fixed, shape: Box(min: (-1, -1, -0.5), max: (5, 2, 0))),
        (name: "cube", material: "2 rock", shape: Box(min: (3, 0.3, 0), max: ("350 cm", 0.8, 0.5)),
         placement: (rotate: (axis: (0, 0, 1), angle_deg: "90 deg")), velocity: ("36 km/h", 0, 0)),
    ],
    attachments: [PointLoad(block: "cube", point: (3, 0.3, 0), force: (0, 0, "-5 kN"))],
    fluid: (
        resolution: Spacing("10 cm"), dynamic_viscosity: "1 mPa s",
        regions: [(name: "column", shape: Box(min: (0, 0, 0), max: (1, 1, 1)))],
    ),
    interface: (slip: Friction("20 deg")),
    inflows: [(name: "in", min: (0, 0, 0), max: (0.5, 1, 1), towards: XMax, discharge: [("1 min", "250 l/s")])],
    time: (duration: "0.5 min"),
)"#;

#[test]
fn quantities_are_numbers_in_the_unit_of_their_field() {
    let scene = parse::read(RON)
        .unwrap_or_else(|error| panic!("{} at `{}`", error.message, &RON[error.span.clone()]));
    assert_eq!(scene.title, "30 m tank");
    assert_eq!(scene.gravity, (0.0, 0.0, -9.806_65));
    assert_eq!((scene.domain.max.0, scene.domain.max.1), (4.0, 1.0));
    assert!((scene.domain.max.2 - 2.0).abs() < 1e-12);
    let rock = &scene.materials[0];
    assert_eq!((rock.density, rock.cohesion), (2650.0, 2e5));
    assert!((rock.friction_angle_deg - 0.5_f64.to_degrees()).abs() < 1e-12);
    let elastic = rock.elastic.unwrap();
    assert_eq!((elastic.young_modulus, elastic.poisson_ratio), (10e9, 0.25));
    assert_eq!(scene.joints[0].friction_ramp, [(0.0, 1.0), (3600.0, 0.5)]);
    assert_eq!(scene.blocks[1].velocity.0, 10.0);
    assert_eq!(scene.inflows[0].discharge, [(60.0, 0.25)]);
    assert_eq!(scene.fluid.as_ref().unwrap().dynamic_viscosity, Some(1e-3));
    assert_eq!(scene.time.duration, 30.0);

    // the same texts in the other languages
    let written = |text: &str| {
        let number = |(from, to): (&str, &str)| (from.to_owned(), to.to_owned());
        [
            ("2650", "\"2.65 t/m3\""),
            ("31", "\"31 deg\""),
            ("3.5,", "\"350 cm\","),
            ("0.1}", "\"100 mm\"}"),
        ]
        .map(number)
        .iter()
        .fold(text.to_owned(), |text, (from, to)| {
            text.replacen(from, to, 1)
        })
    };
    for (text, syntax) in [(JSON, Syntax::Json), (YAML, Syntax::Yaml)] {
        let plain = parse::read_in(text, syntax).unwrap();
        assert_eq!(parse::read_in(&written(text), syntax), Ok(plain.clone()));
        // YAML needs no quotes
        let bare = written(text).replace("\"2.65 t/m3\"", "2.65 t/m3");
        assert_eq!(
            parse::read_in(&bare, syntax) == Ok(plain),
            syntax == Syntax::Yaml
        );
    }
}

/// A quantity of another dimension is answered with what was found and the units to choose from.
#[test]
fn other_dimensions_are_refused_in_their_place() {
    for (from, to, words) in [
        (
            "\"2.65 t/m3\"",
            "\"2.65 t/m2\"",
            "`density`: found \"2.65 t/m2\"; write a density in kg/m3, g/cm3, t/m3",
        ),
        (
            "\"2.65 t/m3\"",
            "\"26 kN/m3\"",
            "`density`: found \"26 kN/m3\", which is a unit weight, to be divided by gravity; write a density in",
        ),
        (
            "\"0.5 rad\"",
            "\"0.5 m\"",
            "`friction_angle_deg`: found \"0.5 m\", which is a length; write an angle in deg, rad",
        ),
        (
            "\"10 cm\"",
            "\"10 cmm\"",
            "`Spacing`: found \"10 cmm\", whose unit is not known; write a length in m, mm",
        ),
        (
            "\"350 cm\"",
            "\"3,5 m\"",
            "`max`: found \"3,5 m\" with a comma; decimals follow a point",
        ),
        (
            "\"1 h\"",
            "\"1 m\"",
            "`friction_ramp`: found \"1 m\", which is a length; write a time in s, ms, min, h, d",
        ),
        (
            "\"50 %\"",
            "\"50 s\"",
            "`friction_ramp`: found \"50 s\", which is a time; write a plain number, or one in %",
        ),
        (
            "\"20 deg\"",
            "\"20 MPa\"",
            "`Friction`: found \"20 MPa\", which is a pressure; write an angle in",
        ),
    ] {
        let text = RON.replacen(from, to, 1);
        let found = answers("scene.ron", &text, &[]);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].message.starts_with(words), "{found:?}");
        assert_eq!(&text[found[0].span.clone()], to);
    }
}

/// Errors behind a quantity are where they are in the text as written.
#[test]
fn places_behind_quantities_are_those_of_the_text() {
    for (from, to, at) in [
        (
            "time: (duration: \"0.5 min\")",
            "time: (durations: 3)",
            "durations",
        ),
        ("motion: Fixed", "motion: Fixd", "Fixd"),
        ("axis: (0, 0, 1)", "axis: (0, 0)", "(0, 0)"),
        (
            "velocity: (\"36 km/h\", 0, 0)",
            "velocity: (\"36 km/h\", 0, \"fast\")",
            "\"fast\"",
        ),
        ("\"50 %\"", "\"50 %\", 3", "(\"1 h\", \"50 %\", 3)"),
        ("time: (", "time (", " "),
        ("joints: [", "joints: [[", "["),
        ("force: (0, 0, ", "force: (NaN, 0, ", "NaN"),
        (
            "dynamic_viscosity: ",
            "dynamic_viscosit: ",
            "dynamic_viscosit",
        ),
    ] {
        assert!(RON.contains(from), "{from}");
        let text = RON.replacen(from, to, 1);
        let found = answers("scene.ron", &text, &[]);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(
            text[found[0].span.clone()].starts_with(at),
            "{to} {found:?}"
        );
    }
}
