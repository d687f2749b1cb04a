//! Degenerate input: a clear error, never a run.

use crate::row::{Failure, Length, Row, Trial};
use crate::tank::scene;

pub const TRIALS: &[Trial] = &[Trial {
    id: "X16",
    subject: "degenerate input",
    run: degenerate,
}];

fn stone(shape: &str, more: &str) -> String {
    format!(
        "(title: \"bad\", domain: (min: (-5, -5, -5), max: (5, 5, 5)),\n\
         materials: [(name: \"rock\", density: 2500, friction_angle_deg: 30)],\n\
         blocks: [(name: \"stone\", material: \"rock\", shape: {shape} {more})],\n\
         time: (duration: 1.0))"
    )
}

fn degenerate(_: Length) -> Result<Vec<Row>, Failure> {
    let cube = "Box(min: (0, 0, 0), max: (1, 1, 1))";
    let tetrahedron =
        |points: &str, faces: &str| format!("Polyhedron(vertices: [{points}], faces: [{faces}])");
    let good_points = "(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)";
    let good_faces = "[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]";
    let cases: Vec<(&str, String, bool)> = vec![
        (
            "a good tetrahedron",
            stone(&tetrahedron(good_points, good_faces), ""),
            true,
        ),
        (
            "inside out, which is turned",
            stone(
                &tetrahedron(good_points, "[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]"),
                "",
            ),
            true,
        ),
        (
            "one face turned",
            stone(
                &tetrahedron(good_points, "[0, 1, 2], [0, 1, 3], [1, 2, 3], [0, 3, 2]"),
                "",
            ),
            false,
        ),
        (
            "a face missing",
            stone(
                &tetrahedron(good_points, "[0, 2, 1], [0, 1, 3], [1, 2, 3]"),
                "",
            ),
            false,
        ),
        (
            "flat",
            stone(
                &tetrahedron("(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)", good_faces),
                "",
            ),
            false,
        ),
        (
            "coincident corners",
            stone(
                &tetrahedron("(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 1, 0)", good_faces),
                "",
            ),
            false,
        ),
        (
            "corners 1e-14 apart",
            stone(
                &tetrahedron("(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 1, 1e-14)", good_faces),
                "",
            ),
            false,
        ),
        (
            "a face of no area",
            stone(
                &tetrahedron("(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 0, 1)", good_faces),
                "",
            ),
            false,
        ),
        (
            "a corner that is not there",
            stone(
                &tetrahedron(good_points, "[0, 2, 1], [0, 1, 9], [1, 2, 3], [0, 3, 2]"),
                "",
            ),
            false,
        ),
        (
            "a face of two corners",
            stone(
                &tetrahedron(good_points, "[0, 2], [0, 1, 3], [1, 2, 3], [0, 3, 2]"),
                "",
            ),
            false,
        ),
        (
            "a corner twice in a face",
            stone(
                &tetrahedron(good_points, "[0, 2, 2], [0, 1, 3], [1, 2, 3], [0, 3, 2]"),
                "",
            ),
            false,
        ),
        (
            "a box without height",
            stone("Box(min: (0, 0, 0), max: (1, 1, 0))", ""),
            false,
        ),
        (
            "a box upside down",
            stone("Box(min: (1, 1, 1), max: (0, 0, 0))", ""),
            false,
        ),
        (
            "a hull of three points",
            stone("Hull(points: [(0, 0, 0), (1, 0, 0), (0, 1, 0)])", ""),
            false,
        ),
        (
            "a hull of points in a line",
            stone(
                "Hull(points: [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)])",
                "",
            ),
            false,
        ),
        (
            "a hull in a plane",
            stone(
                "Hull(points: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0.5, 0.5, 0)])",
                "",
            ),
            false,
        ),
        (
            "an outline that crosses itself",
            stone(
                "Extrusion(polygon: [(0, 0), (1, 1), (1, 0), (0, 1)], axis: Y, from: 0, to: 1)",
                "",
            ),
            false,
        ),
        (
            "an outline of two points",
            stone(
                "Extrusion(polygon: [(0, 0), (1, 1)], axis: Y, from: 0, to: 1)",
                "",
            ),
            false,
        ),
        (
            "an extrusion of no length",
            stone(
                "Extrusion(polygon: [(0, 0), (1, 0), (0, 1)], axis: Y, from: 1, to: 1)",
                "",
            ),
            false,
        ),
        (
            "a ball of no radius",
            stone("Sphere(center: (0, 0, 0), radius: 0)", ""),
            false,
        ),
        (
            "a ball of negative radius",
            stone("Sphere(center: (0, 0, 0), radius: -1)", ""),
            false,
        ),
        (
            "a speed that is not a number",
            stone(cube, ", velocity: (NaN, 0, 0)"),
            false,
        ),
        (
            "an infinite speed",
            stone(cube, ", velocity: (inf, 0, 0)"),
            false,
        ),
        (
            "an infinite corner",
            stone("Box(min: (0, 0, 0), max: (inf, 1, 1))", ""),
            false,
        ),
        (
            "no density",
            stone(cube, "").replace("density: 2500", "density: 0"),
            false,
        ),
        (
            "a density that is not a number",
            stone(cube, "").replace("density: 2500", "density: NaN"),
            false,
        ),
        (
            "friction of 90 degrees",
            stone(cube, "").replace("deg: 30", "deg: 90"),
            false,
        ),
        (
            "no time",
            stone(cube, "").replace("duration: 1.0", "duration: 0"),
            false,
        ),
        (
            "a domain inside out",
            stone(cube, "").replace("max: (5, 5, 5)", "max: (-6, 5, 5)"),
            false,
        ),
        (
            "an axis of no direction",
            stone(
                cube,
                ", placement: (rotate: (axis: (0, 0, 0), angle_deg: 30))",
            ),
            false,
        ),
    ];
    let n = cases.len();
    let mut accepted = Vec::new();
    let mut refused = 0;
    let mut example = String::new();
    for (name, text, is_good) in cases {
        match (scene(&text), is_good) {
            (Ok(_), true) => {}
            (Err(error), true) => accepted.push(format!("{name} is refused: {error}")),
            (Ok(_), false) => accepted.push(format!("{name} is accepted")),
            (Err(error), false) => {
                refused += 1;
                if name == "one face turned" {
                    example = error.to_string();
                }
            }
        }
    }
    Ok(vec![Row {
        pushed: "degenerate input: faces, corners, outlines, numbers".to_owned(),
        swept: format!("{n} scenes, one of them good, one inside out, which is turned as documented"),
        holds: format!("{refused} of {} refused", n - 2),
        past: format!("one face turned: \"{example}\""),
        theory: "each is an error with its place, none a run (tests: dda `polyhedron`, coupling `geometry`, `files`)".to_owned(),
        measured: if accepted.is_empty() { "none accepted".to_owned() } else { accepted.join("; ") },
        missed: (!accepted.is_empty()).then(|| accepted.join("; ")),
        ..Row::default()
    }])
}
