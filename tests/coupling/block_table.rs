//! The table of the motion of blocks: which of them, how often, as text or as binary numbers.

use std::path::Path;

use riprap::files::table::{TableData, read_table};

use crate::support::scene::{errors, resolved};
use crate::support::{riprap, run, words};

/// Three pebbles that bounce, and a swinging plate.
fn scene(table: &str) -> String {
    format!(
        r#"(
    title: "Pebbles",
    domain: (min: (-2, -2, -1), max: (2, 2, 3)),
    materials: [(name: "rock", density: 2600, friction_angle_deg: 30, restitution: 0.5, contact_stiffness: 1e6)],
    blocks: [
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-2, -2, -1), max: (2, 2, 0))),
        (name: "pebble_1", material: "rock", shape: Sphere(center: (0, 0, 0.3), radius: 0.1), angular_velocity: (1, 2, 3)),
        (name: "pebble_2", material: "rock", shape: Sphere(center: (0.5, 0, 0.4), radius: 0.1)),
        (name: "pebble_3", material: "rock", shape: Sphere(center: (-0.5, 0, 0.6), radius: 0.1), velocity: (0.3, 0, 0)),
        (name: "plate", material: "rock", motion: Sinusoid(direction: (1, 0, 0), amplitude: 0.1, period: 1),
         shape: Box(min: (-0.2, -0.2, 2), max: (0.2, 0.2, 2.1))),
    ],
    time: (duration: 0.6),
    output: (frame_interval: 0.2, gauge_interval: 0.1, ledger_interval: 0.1, {table}),
)"#
    )
}

fn rows(folder: &Path, table: &str, extra: &[&str]) -> TableData {
    let file = folder.with_extension("ron");
    std::fs::write(&file, scene(table)).unwrap();
    run(&file, folder, extra);
    // that of the binary one, where there is no other
    read_table(&folder.join("blocks.csv")).unwrap()
}

/// A subset has the rows of the whole; binary numbers are those of the text, single ones to seven digits.
#[test]
fn a_binary_table_of_some_blocks_has_the_rows_of_the_text() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let whole = rows(&at("whole"), "block_table: (interval: 0.05)", &[]);
    let energies = read_table(&at("whole").join("energy.csv")).unwrap();
    // 0, 0.1, ..., 0.6 against 0, 0.05, ..., of four blocks
    assert_eq!(energies.column("time").unwrap().len(), 7);
    assert_eq!(whole.column("time").unwrap().len(), 13 * 4);
    let some = r#"block_table: (blocks: ["pebble_*"], interval: 0.05, format: Npy)"#;
    let binary = rows(&at("binary"), some, &[]);
    assert!(!at("binary").join("blocks.csv").exists());
    let ids = whole.column("block").unwrap();
    let kept: Vec<usize> = (0..ids.len()).filter(|&k| ids[k] != 4.0).collect();
    assert_eq!(kept.len(), 13 * 3);
    for (column, found) in binary.columns.iter().zip(&binary.values) {
        let expected = whole.column(&column.name).unwrap();
        let expected: Vec<f64> = kept.iter().map(|&k| expected[k]).collect();
        if ["time", "block", "x", "y", "z", "asleep"].contains(&column.name.as_str()) {
            assert_eq!(*found, expected, "{}", column.name);
        } else {
            let single: Vec<f64> = expected.iter().map(|&x| f64::from(x as f32)).collect();
            assert_eq!(*found, single, "{}", column.name);
        }
    }
    // the numbers of blocks lead to names
    let output = riprap(&[
        "inspect",
        at("binary").to_str().unwrap(),
        "--block",
        "pebble_3",
    ]);
    assert!(output.status.success(), "{}", words(&output));
}

/// In pieces, the last one after rows that a killed run left behind, the file is the same to the byte.
#[test]
fn a_binary_table_in_pieces_is_the_same_to_the_byte() {
    let folder = tempfile::tempdir().unwrap();
    let table = r#"block_table: (blocks: ["pebble_1", "plate"], interval: 0.03, format: Npy)"#;
    let (whole, pieces) = (folder.path().join("whole"), folder.path().join("pieces"));
    rows(&whole, table, &[]);
    rows(&pieces, table, &["--until", "0.25"]);
    let file = pieces.join("blocks.npy");
    let mut torn = std::fs::read(&file).unwrap();
    torn.extend([1; 333]);
    std::fs::write(&file, &torn).unwrap();
    rows(&pieces, table, &["--resume"]);
    let [expected, found] =
        [&whole, &pieces].map(|out| std::fs::read(out.join("blocks.npy")).unwrap());
    assert!(expected == found);
}

#[test]
fn blocks_that_have_no_rows_are_told() {
    for (name, told) in [
        (
            "stone_*",
            "output.block_table.blocks[0]: table of blocks: no block is called `stone_*`",
        ),
        (
            "floor",
            "output.block_table.blocks[0]: table of blocks: `floor` is fixed",
        ),
    ] {
        let text = scene(&format!(r#"block_table: (blocks: ["{name}"])"#));
        let found = errors(&text);
        assert!(found.iter().any(|line| line.starts_with(told)), "{found:?}");
    }
    let table = resolved(&scene("")).unwrap().block_table;
    assert_eq!((table.blocks, table.interval), (vec![1, 2, 3, 4], 0.1));
}
