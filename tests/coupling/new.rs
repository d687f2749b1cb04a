//! Scenes of `riprap new`: they pass their check without a word, run, and are not overwritten.

use std::path::{Path, PathBuf};

use riprap::scene::access::Access;
use riprap::scene::impulse_wave::SlideImpact;
use riprap::scene::load_text;
use riprap::scene::resolved::Scene;

use crate::support::{case, riprap, run, words};

/// A folder with the raster of the fjord and the outline of its slide, in map coordinates.
fn with_fjord() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(case("fjord.asc"), folder.path().join("fjord.asc")).unwrap();
    let outline = "x,y\n411100,6903885\n411380,6903885\n411380,6904115\n411100,6904115\n";
    std::fs::write(folder.path().join("outline.csv"), outline).unwrap();
    folder
}

/// Writes a scene into a folder; files of the folder are named `@file`.
fn new(folder: &Path, arguments: &str) -> std::process::Output {
    let out = folder.join("my.ron");
    let words = arguments
        .split_whitespace()
        .map(|word| match word.strip_prefix('@') {
            Some(file) => folder.join(file).to_str().unwrap().to_owned(),
            None => word.to_owned(),
        });
    let all: Vec<String> = ["new".to_owned()].into_iter().chain(words).collect();
    let mut all: Vec<&str> = all.iter().map(String::as_str).collect();
    all.extend(["--out", out.to_str().unwrap()]);
    riprap(&all)
}

/// The scene that was written, free of errors and warnings.
fn checked(folder: &Path) -> Scene {
    let path = folder.join("my.ron");
    let text = std::fs::read_to_string(&path).unwrap();
    let longest = text.lines().map(|line| line.chars().count()).max();
    assert!(longest <= Some(170), "{longest:?} characters in a line");
    let (scene, warnings) = load_text("my.ron", &text, &[], &Access::of(folder)).unwrap();
    assert!(warnings.located().is_empty(), "{warnings}");
    scene
}

/// Writes a scene of a kind, checks it, and runs it for a while.
fn written_and_run(folder: &Path, arguments: &str, until: &str) -> Scene {
    let output = new(folder, arguments);
    assert!(output.status.success(), "{arguments}: {}", words(&output));
    assert!(!words(&output).contains("warning"), "{}", words(&output));
    let scene = checked(folder);
    let summary = run(
        &folder.join("my.ron"),
        &folder.join("run"),
        &["--until", until],
    );
    assert_eq!(summary["completed"], true);
    assert!(summary["steps"].as_u64().unwrap() >= 3);
    scene
}

const SLOPE: &str = "slope --dem @fjord.asc --outline @outline.csv --level 0 --spacing 40";

/// The ground along the outline dips at 42 degrees to the east; water is 120 m deep and 1000 m wide.
#[test]
fn a_slope_is_laid_out_by_its_terrain() {
    let folder = with_fjord();
    let scene = written_and_run(folder.path(), &format!("{SLOPE} --dip 34"), "0.4");
    let terrain = scene.terrain.as_ref().unwrap();
    let slide = SlideImpact::of(&terrain.rock[0], &scene).unwrap();
    assert!((slide.slope.to_degrees() - 34.0).abs() < 0.1, "{slide:?}");
    // as in README: 2.0 million m3
    assert!(
        (slide.volume / 2.03e6 - 1.0).abs() < 0.05,
        "{}",
        slide.volume
    );
    // the outline in small coordinates: the origin is in the middle of the domain, the still water at z = 0
    let (min, max) = (scene.domain.min, scene.domain.max);
    assert!(
        (min.x + max.x).abs() <= 20.0 && (min.y + max.y).abs() <= 20.0,
        "{min} {max}"
    );
    assert_eq!(terrain.origin.2, 0.0);
    // all of the water and both shores, which are 1000 m apart, at the slide
    assert!(max.x - min.x > 1500.0 && scene.domain.symmetry.len() == 2);
    let fluid = scene.fluid.as_ref().unwrap();
    assert!((fluid.lattice.depth - 120.0).abs() < 40.0);
    let names: Vec<&str> = scene
        .gauges
        .iter()
        .map(|gauge| gauge.name.as_str())
        .collect();
    assert_eq!(names, ["near", "middle", "far", "opposite"]);
    // the joints leave a few dozen blocks, none of them a splinter
    let free = scene.rock_masses[0].n_blocks;
    assert!((20..150).contains(&free), "{free}");
}

/// A stated volume is met by the dip, a level on the map is z = 0, and without any the volume follows from the area.
#[test]
fn a_slope_has_the_volume_asked_for() {
    let folder = with_fjord();
    for (further, expected) in [
        ("--volume 1.2e6", 1.2e6),
        ("--thickness 10", 10.0 * 280.0 * 230.0),
        ("", 0.074 * 64_400f64.powf(1.45)),
    ] {
        let output = new(folder.path(), &format!("{SLOPE} --force {further}"));
        assert!(output.status.success(), "{}", words(&output));
        let scene = checked(folder.path());
        let volume = scene.terrain.as_ref().unwrap().rock[0].volume;
        // squares of a hundredth of the outline, and a dip rounded to a tenth of a degree
        assert!(
            (volume / expected - 1.0).abs() < 0.03,
            "{further}: {volume:.3e} of {expected:.3e}"
        );
    }
    let output = new(
        folder.path(),
        "slope --dem @fjord.asc --outline @outline.csv --level 20 --spacing 40 --force",
    );
    assert!(output.status.success(), "{}", words(&output));
    let scene = checked(folder.path());
    assert_eq!(scene.terrain.as_ref().unwrap().origin.2, 20.0);
    assert_eq!(scene.fluid.as_ref().unwrap().lattice.still_water_level, 0.0);
}

#[test]
fn channels_rockfall_and_barrier_run_as_written() {
    for (arguments, until) in [
        ("flume --depth 0.4 --height 0.1 --length 4", "0.02"),
        ("flume", "0.01"),
        ("wavemaker", "0.01"),
        ("wavemaker --depth 20 --height 2 --period 9", "0.05"),
        ("rockfall --dem @rockfall.asc --from 22,0", "0.05"),
        (
            "rockfall --dem @rockfall.asc --from 22,0 --count 12 --size 0.5",
            "0.05",
        ),
        ("barrier", "0.05"),
        (
            "barrier --angle 45 --length 20 --diameter 0.5 --height 3",
            "0.05",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::copy(case("rockfall.asc"), folder.path().join("rockfall.asc")).unwrap();
        println!("{arguments}");
        written_and_run(folder.path(), arguments, until);
    }
}

/// What cannot be chosen is asked for, and what cannot be is told, in one line with its remedy.
#[test]
fn what_cannot_be_chosen_is_asked_for() {
    let folder = with_fjord();
    let outside = tempfile::tempdir().unwrap();
    std::fs::copy(case("fjord.asc"), outside.path().join("far.asc")).unwrap();
    let far = outside.path().join("far.asc").display().to_string();
    std::fs::write(
        folder.path().join("level.csv"),
        "x,y\n411950,6903900\n412050,6903900\n412000,6904100\n",
    )
    .unwrap();
    std::fs::write(folder.path().join("local.csv"), "x,y\n0,0\n100,0\n0,100\n").unwrap();
    let elsewhere = format!("slope --dem {far} --outline @outline.csv --level 0");
    for (arguments, expected) in [
        ("slope --dem @fjord.asc --outline @outline.csv", "--level"),
        (
            "slope --dem @fjord.asc --outline @none.csv --level 0",
            "none.csv",
        ),
        (elsewhere.as_str(), "--out"),
        (
            "slope --dem @fjord.asc --outline @level.csv --level 0",
            "--dip and --dip-direction",
        ),
        (
            "slope --dem @fjord.asc --outline @local.csv --level 0",
            "map coordinates",
        ),
        (
            "slope --dem @fjord.asc --outline @outline.csv --level -500",
            "--level is the elevation",
        ),
        (
            "slope --dem @fjord.asc --outline @outline.csv --level 0 --volume 1e9",
            "--volume",
        ),
        (
            "slope --dem @fjord.asc --outline @outline.csv --level 0 --dip 60",
            "lower --dip",
        ),
        (
            "slope --dem @fjord.asc --outline @outline.csv --level 0 --dip 30 --volume 1e6",
            "--volume",
        ),
        ("flume --height 2", "--height"),
        ("wavemaker --height 0.6", "--period"),
        ("rockfall --dem @fjord.asc --from 412000", "northing"),
        ("rockfall --dem @fjord.asc --from 0,0", "map coordinates"),
        ("rockfall --dem @fjord.asc --from 412000,6904000", "steeper"),
        ("barrier --angle 20", "--angle"),
    ] {
        let output = new(folder.path(), arguments);
        assert_eq!(
            output.status.code(),
            Some(2),
            "{arguments}: {}",
            words(&output)
        );
        assert!(
            words(&output).contains(expected),
            "{arguments}: {}",
            words(&output)
        );
        assert!(!folder.path().join("my.ron").exists(), "{arguments}");
    }
}

#[test]
fn existing_files_are_overwritten_by_force_only() {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join("my.ron");
    std::fs::write(&path, "mine").unwrap();
    let output = new(folder.path(), "flume");
    assert_eq!(output.status.code(), Some(2));
    assert!(words(&output).contains("--force"), "{}", words(&output));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
    // nor the record beside it
    std::fs::remove_file(&path).unwrap();
    let record = folder.path().join("my_paddle.csv");
    std::fs::write(&record, "mine").unwrap();
    assert_eq!(new(folder.path(), "flume").status.code(), Some(2));
    assert_eq!(std::fs::read_to_string(&record).unwrap(), "mine");
    let output = new(folder.path(), "flume --force");
    assert!(output.status.success(), "{}", words(&output));
    checked(folder.path());
}
