//! Volume and mass of water: as much in particles as is drawn.

use std::path::{Path, PathBuf};

use riprap::run::build;
use riprap::scene::access::Access;
use riprap::scene::fill::Amount;
use riprap::scene::load_text;
use riprap::scene::parse::Override;
use riprap::scene::resolve::Scene;

fn cases() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases");
    let files = std::fs::read_dir(folder).unwrap();
    let mut cases: Vec<PathBuf> = files.map(|entry| entry.unwrap().path()).collect();
    cases.retain(|path| path.extension().is_some_and(|end| end == "ron"));
    cases.sort();
    cases
}

fn scene(text: &str) -> (Scene, String) {
    let (scene, warnings) = load_text("tank.ron", text, &[], &Access::of(Path::new("."))).unwrap();
    (scene, format!("{warnings:?}"))
}

fn amounts(scene: &Scene) -> Vec<Amount> {
    scene.fluid.as_ref().unwrap().lattice.amounts.clone()
}

/// Water in a tank of 2 m x 1 m, in a plane of 1 m, with a region.
fn tank(spacing: f64, region: &str, more: &str) -> String {
    format!(
        "(title: \"tank\",
          domain: (min: (-0.5, 0, -0.5), max: (2.5, 1, 2), dimensions: Two),
          materials: [(name: \"rock\", density: 2600, friction_angle_deg: 35)],
          blocks: [
              (name: \"floor\", material: \"rock\", motion: Fixed, shape: Box(min: (-0.5, 0, -0.5), max: (2.5, 1, 0))),
              (name: \"west\", material: \"rock\", motion: Fixed, shape: Box(min: (-0.5, 0, 0), max: (0, 1, 1.5))),
              (name: \"east\", material: \"rock\", motion: Fixed, shape: Box(min: (2, 0, 0), max: (2.5, 1, 1.5))),
              {more}
          ],
          fluid: (resolution: Spacing({spacing}), regions: [{region}]),
          time: (duration: 0.1))"
    )
}

/// Filled against drawn, and the mass of the particles at the start less what the water's own weight compresses, within 0.1 %
/// in all cases. The largest are coarsened: it is the same code.
#[test]
fn every_case_has_the_water_that_is_drawn() {
    for path in cases() {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let coarse = match name {
            "fjord_rockslide" => Some("Spacing(20)"),
            "isolated_building" => Some("Spacing(0.08)"),
            _ => None,
        };
        let overrides: Vec<Override> = coarse
            .iter()
            .map(|value| format!("fluid.resolution={value}").parse().unwrap())
            .collect();
        let before = std::time::Instant::now();
        let (scene, _) = riprap::scene::load(&path, &overrides).unwrap();
        let Some(fluid) = &scene.fluid else {
            continue;
        };
        let wall = before.elapsed().as_secs_f64();
        let own: f64 = fluid.lattice.spacing.iter().product();
        for (region, amount) in fluid.regions.iter().zip(&fluid.lattice.amounts) {
            let off = amount.filled / amount.drawn - 1.0;
            println!(
                "{name:22} {:10} drawn {:.6e} m3, filled {:+.4} %, particle {own:.4e} m3; {wall:.2} s",
                region.name,
                amount.drawn,
                100.0 * off
            );
            assert!(off.abs() < 1e-3, "{name}: {off}");
        }
        let filled: f64 = fluid
            .lattice
            .amounts
            .iter()
            .map(|amount| amount.filled)
            .sum();
        let of_particles = fluid.lattice.positions.len() as f64 * own;
        assert!((of_particles / filled - 1.0).abs() < 1e-9, "{name}");
    }
}

/// What packing leaves out, because it would stand above the level, is made up for.
#[test]
fn packed_water_keeps_its_volume() {
    for name in [
        "still_tank",
        "floating_boxes",
        "slide_section",
        "breakwater",
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../cases/{name}.ron"));
        let (scene, _) = riprap::scene::load(&path, &[]).unwrap();
        let world = build(&scene).unwrap();
        let fluid = &world.water.as_ref().unwrap().fluid;
        let drawn: f64 = amounts(&scene).iter().map(|amount| amount.drawn).sum();
        let filled = fluid.particles().len() as f64 * fluid.particle_volume();
        println!(
            "{name}: {} of {} particles, {:+.4} %",
            fluid.particles().len(),
            scene.fluid.as_ref().unwrap().lattice.positions.len(),
            100.0 * (filled / drawn - 1.0)
        );
        assert!((filled / drawn - 1.0).abs() < 1e-3, "{name}");
    }
}

/// A film of 10 mm at 7.5 mm is a row, 10 mm thick.
#[test]
fn boxes_are_filled_to_their_ends() {
    let film = "(name: \"film\", shape: Box(min: (0, 0, 0), max: (2, 1, 0.01)))";
    let (found, warnings) = scene(&tank(0.0075, film, ""));
    let fluid = found.fluid.as_ref().unwrap();
    assert_eq!(fluid.lattice.positions.len(), 267);
    assert!((amounts(&found)[0].filled / 0.02 - 1.0).abs() < 1e-12);
    assert!(warnings.contains("1.33 rows of 0.007500 m"), "{warnings}");
    assert!(warnings.contains("Spacing(0.010000) fits"), "{warnings}");
    // neither length is a whole number of rows, nor is their ratio
    let pair = "(name: \"deep\", shape: Box(min: (0, 0, 0), max: (0.77, 1, 0.513))),
                (name: \"shallow\", shape: Box(min: (0.8, 0, 0), max: (2, 1, 0.171)))";
    let (found, warnings) = scene(&tank(0.02, pair, ""));
    let lattice = &found.fluid.as_ref().unwrap().lattice;
    for (amount, drawn) in amounts(&found).iter().zip([0.77 * 0.513, 1.2 * 0.171]) {
        assert!((amount.drawn / drawn - 1.0).abs() < 1e-12);
        // some hundred pairs of rows to choose from leave a few 1e-4
        assert!((amount.filled / drawn - 1.0).abs() < 5e-4, "{amount:?}");
    }
    // rows end half a row from both ends of each box
    let ends = |region: u32| {
        let all = lattice.positions.iter().zip(&lattice.region);
        let heights = all.filter(|(_, r)| **r == region).map(|(x, _)| x.z);
        heights.fold((f64::INFINITY, 0.0_f64), |(a, b), z| (a.min(z), b.max(z)))
    };
    for (region, height) in [(0, 0.513), (1, 0.171)] {
        let (low, high) = ends(region);
        assert!((low + high - height).abs() < 1e-12, "{region}");
    }
    assert!(!warnings.contains("fluid region"), "{warnings}");
}

/// A film of less than half a spacing has no row, and the message tells the spacing that has one.
#[test]
fn a_film_without_a_row_is_refused_with_the_spacing_that_has_one() {
    let films = "(name: \"pool\", shape: Box(min: (0, 0, 0), max: (1, 1, 0.5))),
                 (name: \"film\", shape: Box(min: (1.1, 0, 0), max: (2, 1, 0.01)))";
    let text = tank(0.05, films, "");
    let error = load_text("tank.ron", &text, &[], &Access::of(Path::new("."))).unwrap_err();
    let told = format!("{error:?}");
    assert!(
        told.contains("fluid region `film` is too thin: no particle fits in 0.01 m along z; let fluid.resolution be Spacing(0.01)"),
        "{told}"
    );
}

/// A basin's drawn volume is exact in a plane: a step, a wedge, a ball that is half under water, and a level between rows.
#[test]
fn drawn_volumes_are_those_of_the_geometry() {
    let below = |level: f64| {
        format!("(name: \"lake\", shape: Below(level: {level}, seed: (0.1, 0.5, 0.3)))")
    };
    let step = "(name: \"step\", material: \"rock\", motion: Fixed, shape: Box(min: (1.237, 0, 0), max: (2, 1, 0.2341))),";
    let wedge = "(name: \"wedge\", material: \"rock\", motion: Fixed,
                  shape: Extrusion(polygon: [(1.013, 0), (2, 0), (2, 0.789)], axis: Y, from: 0, to: 1)),";
    let shore = 1.013 + (2.0 - 1.013) * 0.613 / 0.789;
    for (spacing, tolerance) in [(0.05, 2e-5), (0.02, 1e-5)] {
        for (level, block, drawn) in [
            (0.8, "", 1.6),
            (0.613, "", 2.0 * 0.613),
            (0.613, step, 2.0 * 0.613 - (2.0 - 1.237) * 0.2341),
            (0.613, wedge, 1.013 * 0.613 + 0.5 * (shore - 1.013) * 0.613),
        ] {
            let (found, warnings) = scene(&tank(spacing, &below(level), block));
            let amount = amounts(&found)[0];
            let off = amount.drawn / drawn - 1.0;
            println!(
                "{spacing} {level}: drawn {:.6} m3, off by {off:.1e}",
                amount.drawn
            );
            // strips that the shore ends in are an eighth of a cell wide
            assert!(off.abs() < tolerance, "{level} {block}: {off}");
            assert!((amount.filled / drawn - 1.0).abs() < 1e-4);
            assert!(!warnings.contains("fluid region"), "{warnings}");
        }
    }
}

/// A ball in a tank in space, by lines through its cells.
#[test]
fn a_ball_under_water_displaces_its_volume() {
    let ball = "(name: \"ball\", material: \"rock\", motion: Fixed, shape: Sphere(center: (1, 0.5, 0.4), radius: 0.25)),";
    let lake = "(name: \"lake\", shape: Below(level: 0.8, seed: (0.1, 0.5, 0.3)))";
    let text = tank(0.05, lake, ball).replace("dimensions: Two", "symmetry: [YMin, YMax]");
    let (found, _) = scene(&text);
    let drawn = 1.6 - 4.0 / 3.0 * std::f64::consts::PI * 0.25_f64.powi(3);
    let amount = amounts(&found)[0];
    // lines a quarter of a cell apart: measured 3.2e-5
    assert!((amount.drawn / drawn - 1.0).abs() < 1e-4, "{amount:?}");
    assert!((amount.filled / drawn - 1.0).abs() < 1e-4, "{amount:?}");
}
