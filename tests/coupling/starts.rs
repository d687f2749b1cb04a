//! Blocks that overlap at the start are named before the run, with their place and depth.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use riprap::scene::access::Access;
use riprap::scene::load_text;

/// What a scene of rock is refused with, line by line, or nothing.
fn refusal(folder: &Path, scene: &str) -> Vec<String> {
    let text = format!(
        r#"(
    title: "Start",
    domain: (min: (-50, -50, -50), max: (50, 50, 50)),
    materials: [(name: "rock", density: 2600, friction_angle_deg: 30, contact_stiffness: 1e9)],
    {scene}
    time: (duration: 1),
)"#
    );
    match load_text("start.ron", &text, &[], &Access::of(folder)) {
        Ok(_) => Vec::new(),
        Err(error) => error.to_string().lines().map(str::to_owned).collect(),
    }
}

fn cube(name: &str, [x, y, z]: [f64; 3]) -> String {
    let max = [x, y, z].map(|x| x + 1.0);
    format!(
        r#"(name: "{name}", material: "rock", shape: Box(min: ({x}, {y}, {z}), max: ({}, {}, {}))),"#,
        max[0], max[1], max[2]
    )
}

/// Cubes in a row, each shifted by a distance from the one before.
fn row(n: usize, shift: f64) -> String {
    let cubes = (0..n).map(|k| cube(&format!("cube{k}"), [k as f64 * shift, 0.0, 0.0]));
    format!("blocks: [{}],", cubes.collect::<String>())
}

/// A flat raster of 1 m cells from -10 to 10 m, with a ridge of a height (m) along x = 0.
fn terrain(folder: &Path, ridge: f64) {
    let mut text =
        "ncols 21\nnrows 21\nxllcenter 500000\nyllcenter 6000000\ncellsize 1\n".to_owned();
    for _ in 0..21 {
        let heights = (0..21).map(|x| if x == 10 { ridge } else { 0.0 });
        let cells: Vec<String> = heights.map(|z| z.to_string()).collect();
        let _ = writeln!(text, "{}", cells.join(" "));
    }
    fs::write(folder.join("land.asc"), text).unwrap();
}

/// A block of 4 m on a side over the middle of the terrain, its base at a height (m).
fn on_terrain(folder: &Path, base: f64) -> Vec<String> {
    let top = base + 4.0;
    let scene = format!(
        r#"terrain: (sources: [(file: "land.asc")], origin: (500010, 6000010, 0), tolerance: 1e-3),
    blocks: [
        (name: "ground", material: "rock", motion: Fixed, shape: Terrain),
        (name: "stone", material: "rock", shape: Box(min: (-2.3, -1.7, {base}), max: (1.7, 2.3, {top}))),
    ],"#
    );
    refusal(folder, &scene)
}

#[test]
fn cubes_drawn_into_each_other_are_named_and_cubes_face_to_face_are_not() {
    let folder = Path::new(".");
    for shift in [1.0, 1.5] {
        assert_eq!(refusal(folder, &row(2, shift)), Vec::<String>::new());
    }
    assert_eq!(
        refusal(folder, &row(2, 0.7)),
        [
            "start.ron:5:14: error: block `cube0` overlaps block `cube1` by 3.000e-1 m, 30.00 % of the smaller size, near \
         (0.850, 0.500, 0.500) m; allowed are 1 %: move them apart [overlapping-blocks]"
        ]
    );
}

#[test]
fn of_many_overlaps_five_are_named_and_the_others_counted() {
    let lines = refusal(Path::new("."), &row(9, 0.9));
    assert_eq!(lines.len(), 6, "{lines:?}");
    assert!(
        lines[5]
            .ends_with("3 more pairs of blocks overlap deeper than allowed [overlapping-blocks]"),
        "{lines:?}"
    );
}

#[test]
fn a_block_in_the_ground_is_told_with_its_place_on_the_map() {
    let folder = tempfile::tempdir().unwrap();
    terrain(folder.path(), 0.0);
    assert_eq!(on_terrain(folder.path(), 0.0), Vec::<String>::new());
    let lines = on_terrain(folder.path(), -2.0);
    println!("{lines:?}");
    assert_eq!(lines.len(), 1);
    for part in [
        "block `stone` overlaps block `ground` by 2.000e0 m, 50.00 % of the smaller size",
        "-2.000) m, on the map (5000",
        "move them apart",
    ] {
        assert!(lines[0].contains(part), "{lines:?}");
    }
}

/// Depth is the distance from the ground, 1.9 m/√5 in a ridge with flanks of 2 : 1, and a fifth of the size is allowed. No corner of
/// the block is below the ground: only the contacts of the blocks see the ridge in its base.
#[test]
fn a_ridge_in_the_base_of_a_block_is_told_as_the_first_step_would_find_it() {
    let folder = tempfile::tempdir().unwrap();
    terrain(folder.path(), 2.0);
    assert_eq!(on_terrain(folder.path(), 2.0), Vec::<String>::new());
    let lines = on_terrain(folder.path(), 0.1);
    println!("{lines:?}");
    assert_eq!(lines.len(), 1);
    for part in [
        "blocks `ground` and `stone` overlap by 8.497e-1 m near (0.000, ",
        "(allowed 8.000e-1 m), on the map (5000",
        "move them apart",
    ] {
        assert!(lines[0].contains(part), "{lines:?}");
    }
}
