//! Blocks on a path, and the width of the kernel, as `check` reports them.

use std::fs;

use crate::support::riprap;
use crate::support::scene::resolved_in;

/// Problems of a scene with a block on a path, and a record of its way.
fn refusals(motion: &str, record: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("way.csv"), record).unwrap();
    let problems = match resolved_in(folder.path(), &scene(motion)) {
        Ok(scene) => scene.warnings,
        Err(problems) => problems,
    };
    problems
        .into_iter()
        .map(|p| format!("{}: {}", p.path, p.message))
        .collect()
}

fn scene(motion: &str) -> String {
    format!(
        "(title: \"path\", domain: (min: (-3, 0, -1), max: (3, 1, 3)),\n\
         materials: [(name: \"m\", density: 2000, friction_angle_deg: 30)],\n\
         blocks: [(name: \"slider\", material: \"m\", motion: {motion},\n\
         shape: Box(min: (-2.5, 0, 0.1), max: (-2.1, 1, 0.3)))],\n\
         time: (duration: 1))"
    )
}

#[test]
fn wrong_paths_are_named() {
    let of = |points: &str| format!("Path(points: [{points}], file: \"way.csv\", base: 0.4)");
    let bed = of("(-2.5, 0, 0.1), (0, 0, 0.1), (2, 0, 1)");
    let good = "time [s],way [mm]\n0,200\n1,2000\n";
    assert!(
        refusals(&bed, good).is_empty(),
        "{:?}",
        refusals(&bed, good)
    );
    for (motion, record, expected) in [
        (
            of("(0, 0, 0)"),
            good,
            "blocks[0].motion.points: block `slider`: a path needs at least two points",
        ),
        (
            of("(0, 0, 0), (1, 0, 0), (0, 0, 0)"),
            good,
            "blocks[0].motion.points[1]: block `slider`: the path turns back at point 1",
        ),
        (
            of("(0, 0, 0), (1, 0, 0), (2, 0, 1), (2, 1, 2)"),
            good,
            "blocks[0].motion.points[3]: block `slider`: point 3 is not in the plane of the points before it",
        ),
        (
            bed.clone(),
            "0,0.2\n1,7\n",
            "blocks[0].motion.file: `way.csv`: the way 7 m at 1 s puts the base from 6.8",
        ),
        (
            bed.clone(),
            "0,0.1\n1,1\n",
            "blocks[0].motion.file: `way.csv`: the way 0.1 m at 0 s puts the base from -0.1",
        ),
        (
            bed.clone(),
            "0,0.2\n1,1,4\n",
            "blocks[0].motion.file: `way.csv` line 2: found 3 columns, needed 2: time, way",
        ),
        (
            of("(-2.5, 0, 0.1), (-2, 0, 0.1), (-1.9, 0, 0.2), (2, 0, 1)"),
            good,
            "blocks[0].motion.points[1]: block `slider` reaches 0.2828 m",
        ),
    ] {
        let found = refusals(&motion, record);
        assert!(
            found.iter().any(|f| f.starts_with(expected)),
            "{expected}: {found:?}"
        );
    }
}

/// A plate with water on both sides and a film thinner than the kernel are named; a tank that is deep enough is not.
#[test]
fn the_kernel_is_measured_against_bodies_and_films() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.ron");
    let tank = |level: f64, plate: f64| {
        format!(
            "(title: \"film\", domain: (min: (0, 0, 0), max: (4, 1, 3), dimensions: Two),\n\
             materials: [(name: \"m\", density: 2000, friction_angle_deg: 30)],\n\
             blocks: [(name: \"floor\", material: \"m\", motion: Fixed, shape: Box(min: (-1, -1, -1), max: (5, 2, 0))),\n\
             (name: \"left\", material: \"m\", motion: Fixed, shape: Box(min: (-1, -1, 0), max: (0, 2, 3))),\n\
             (name: \"right\", material: \"m\", motion: Fixed, shape: Box(min: (4, -1, 0), max: (5, 2, 3))),\n\
             (name: \"plate\", material: \"m\", motion: Fixed, shape: Box(min: (2, -1, 0), max: ({:?}, 2, 3)))],\n\
             fluid: (resolution: Spacing(0.1), regions: [\n\
             (name: \"sea\", shape: Box(min: (0, 0, 0), max: (2, 1, {level:?}))),\n\
             (name: \"lake\", shape: Box(min: ({:?}, 0, 0), max: (4, 1, 1)))]), time: (duration: 1))",
            2.0 + plate,
            2.0 + plate,
        )
    };
    let report = |level, plate| {
        fs::write(&path, tank(level, plate)).unwrap();
        let output = riprap(&["check", path.to_str().unwrap()]);
        let text = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        let text = text.concat();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let thin = report(0.3, 0.2);
    assert!(
        thin.contains("wider than body `plate`: 0.2000 m, 2.0 spacings"),
        "{thin}"
    );
    assert!(
        thin.contains("wider than film `sea`: 0.3000 m, 3.0 spacings"),
        "{thin}"
    );
    let thick = report(1.0, 0.9);
    assert!(!thick.contains("wider than"), "{thick}");
}
