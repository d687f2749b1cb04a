//! Terrain from rasters, surveys and maps, and what is refused.

use super::*;

/// Rows run from the north; a cell may be named by its center or its corner.
#[test]
fn centres_and_corners_of_cells_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let raster = valley();
    raster.write(&folder.path().join("center.asc"), hummocky);
    let corner = raster.corner.map(|x| x - 0.5 * raster.cell);
    let named = ("xllcorner", "yllcorner");
    raster.write_named(&folder.path().join("corner.asc"), named, corner, hummocky);
    let of = |file: &str| {
        let terrain = format!("(sources: [(file: \"{file}\")])");
        terrain_of(folder.path(), &terrain).unwrap().grid
    };
    let grid = of("center.asc");
    assert_eq!(grid, of("corner.asc"));
    let [x, y] = grid.place([7, 11]);
    assert_eq!([x, y], [70.0, -40.0]);
    assert_eq!(grid.height([x, y]), Some(hummocky(x, y)));
}

/// A map 1e6 m off and a kilometer high gives the scene the same terrain: heights in a file of 1e6 m have 1e-10 m of round-off.
#[test]
fn a_far_map_is_shifted_to_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let near = valley();
    near.write(&folder.path().join("near.asc"), hummocky);
    let far = Raster {
        corner: [1e6, 5e6 - 150.0],
        ..valley()
    };
    far.write(&folder.path().join("far.asc"), |x, y| {
        hummocky(x - 1e6, y - 5e6) + 1000.0
    });
    let near = terrain_of(folder.path(), "(sources: [(file: \"near.asc\")])").unwrap();
    let far = "(sources: [(file: \"far.asc\")], origin: (1e6, 5e6, 1000))";
    let far = terrain_of(folder.path(), far).unwrap();
    assert_eq!(
        (near.grid.corner, near.grid.n),
        (far.grid.corner, far.grid.n)
    );
    let heights = near.grid.heights.iter().zip(&far.grid.heights);
    let worst = heights.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("heights differ by {worst:.1e} m");
    assert!(worst < 1e-9);
    assert_eq!(near.surface.triangles(), far.surface.triangles());
}

/// Land that has 0 for water over a bathymetry in feet: each counts where it has heights, and a strip between is filled.
#[test]
fn land_and_bathymetry_are_merged() {
    let folder = tempfile::tempdir().unwrap();
    let slope = |x: f64| 100.0 - 0.5 * x;
    valley().write(&folder.path().join("land.asc"), |x, _| slope(x).max(0.0));
    let feet = |x: f64, _: f64| {
        if x < 225.0 {
            f64::NAN
        } else {
            (slope(x) - 3.0) / 0.3048
        }
    };
    valley().write(&folder.path().join("sea.asc"), feet);
    let sources = "sources: [(file: \"land.asc\", heights: (0.1, 9000)), (file: \"sea.asc\", height_scale: 0.3048, height_shift: 3)]";
    let refused = terrain_of(folder.path(), &format!("({sources})")).unwrap_err();
    println!("{}", refused.message);
    assert_eq!(refused.path, "terrain.sources");
    assert!(
        refused
            .message
            .contains("no source has a height at (200.00, -150.00) m")
    );
    let terrain = terrain_of(folder.path(), &format!("({sources}, gaps: Filled(30))")).unwrap();
    // heights of the land at 200 m, of both beside it, are 0.0 or below
    assert_eq!(terrain.n_filled, 3 * 31);
    for point in terrain.grid.points() {
        let [x, _] = terrain.grid.place(point);
        let z = terrain.grid.heights[terrain.grid.index(point)];
        // a membrane between two rims of a plane is the plane
        assert!((z - slope(x)).abs() < 1e-6, "{x} {z}");
    }
    let narrow = terrain_of(folder.path(), &format!("({sources}, gaps: Filled(10))")).unwrap_err();
    assert_eq!(narrow.path, "terrain.gaps");
}

/// A coarser point has the mean over its square, which of a plane is its own height, and of a fine ripple nothing.
#[test]
fn coarse_points_are_means_and_fine_points_are_interpolated() {
    let folder = tempfile::tempdir().unwrap();
    let fine = Raster {
        corner: [0.0, -150.0],
        cell: 2.5,
        n: [161, 121],
    };
    // waves of two points, which a sample would take for heights
    let ripple = |x: f64| {
        if (x / 2.5).round() as i64 % 2 == 0 {
            3.0
        } else {
            -3.0
        }
    };
    fine.write(&folder.path().join("fine.asc"), |x, y| {
        0.3 * x + 0.1 * y + ripple(x)
    });
    let of = |more: &str| {
        let terrain =
            format!("(sources: [(file: \"fine.asc\")], clip: ((50, -100), (350, 100)), {more})");
        terrain_of(folder.path(), &terrain).unwrap().grid
    };
    let coarse = of("spacing: 20");
    assert_eq!((coarse.corner, coarse.n), ([60.0, -90.0], [15, 10]));
    for point in coarse.points() {
        let [x, y] = coarse.place(point);
        let z = coarse.heights[coarse.index(point)];
        assert!((z - 0.3 * x - 0.1 * y).abs() < 1e-9, "{x} {y} {z}");
    }
    let finer = of("spacing: 1.25");
    assert_eq!(finer.height([51.25, 0.0]), Some(0.3 * 51.25));
}

/// Flat ground is two triangles for any number of points; rough ground is within the tolerance at each of them.
#[test]
fn flat_ground_is_cheap_and_rough_ground_is_met() {
    let folder = tempfile::tempdir().unwrap();
    valley().write(&folder.path().join("flat.asc"), |x, y| {
        50.0 - 0.25 * x + 0.125 * y
    });
    let flat = terrain_of(folder.path(), "(sources: [(file: \"flat.asc\")])").unwrap();
    assert_eq!(flat.surface.triangles().len(), 2);
    valley().write(&folder.path().join("rough.asc"), hummocky);
    let mut before = 0;
    for tolerance in [2.0, 0.5, 0.1, 1e-9] {
        let terrain = format!("(sources: [(file: \"rough.asc\")], tolerance: {tolerance})");
        let terrain = terrain_of(folder.path(), &terrain).unwrap();
        let found = ground(&terrain);
        let off = |point| {
            let [x, y] = terrain.grid.place(point);
            (found.height_under_the_sky([x, y]).unwrap() - hummocky(x, y)).abs()
        };
        let worst = terrain.grid.points().map(off).fold(0.0, f64::max);
        let n = terrain.surface.triangles().len();
        println!("{n} triangles within {tolerance} m: {worst:.2e} m off");
        assert!(worst <= tolerance * (1.0 + 1e-9) + 1e-9 && before < n);
        before = n;
    }
    // every point but some of the western rim, which is straight: its 29 points between two corners serve against slivers only
    assert!(
        (2 * 40 * 30 - 29..=2 * 40 * 30).contains(&before),
        "{before}"
    );
}

/// Input errors are reported with their location and a remedy.
#[test]
fn wrong_terrain_and_outlines_are_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    valley().write(&folder.path().join("rough.asc"), hummocky);
    valley().write(&folder.path().join("holes.asc"), |x, y| {
        if x == 200.0 && y == 0.0 {
            f64::NAN
        } else {
            hummocky(x, y)
        }
    });
    let short = std::fs::read_to_string(folder.path().join("rough.asc")).unwrap();
    let short: Vec<&str> = short.lines().collect();
    std::fs::write(
        folder.path().join("short.asc"),
        short[..short.len() - 1].join("\n"),
    )
    .unwrap();
    let plane = "failure_surface: Plane(point: (100, 0, 100), dip_deg: 40, dip_direction_deg: 90)";
    let slide = |outline: &str, beneath: &str| {
        format!("(name: \"s\", material: \"rock\", outline: Corners([{outline}]), {beneath})")
    };
    let good = "(sources: [(file: \"rough.asc\")])";
    let square = "(60, -40), (160, -40), (160, 40), (60, 40)";
    for (terrain, slides, path, words) in [
        (
            "(sources: [(file: \"holes.asc\")])",
            String::new(),
            "terrain.sources",
            "no source has a height at (200.00, 0.00) m",
        ),
        (
            "(sources: [(file: \"short.asc\")])",
            String::new(),
            "terrain.sources[0].file",
            "has 1230 heights; 41 columns and 31 rows need 1271",
        ),
        (
            "(sources: [(file: \"rough.asc\")], clip: ((0, 0), (500, 100)))",
            String::new(),
            "terrain.sources",
            "no source has a height at (410.00, 0.00)",
        ),
        (
            "(sources: [(file: \"rough.asc\")], spacing: 1e-3)",
            String::new(),
            "terrain.spacing",
            "raise the spacing above 0.001 m",
        ),
        (
            good,
            slide("(60, -40), (460, -40), (160, 40)", plane),
            "slides[0].outline",
            "its corner at (460.00, -40.00) m is not within the terrain",
        ),
        (
            good,
            slide("(60, -40), (160, 40), (160, -40), (60, 20)", plane),
            "slides[0].outline",
            "crosses another side",
        ),
        (
            good,
            slide(
                square,
                "failure_surface: Plane(point: (100, 0, 300), dip_deg: 40, dip_direction_deg: 90)",
            ),
            "slides[0].failure_surface",
            "nowhere below the terrain",
        ),
        (
            good,
            format!(
                "{}, {}",
                slide(square, plane),
                slide(square, plane).replace("\"s\"", "\"t\"")
            ),
            "slides[1].outline",
            "overlaps another outline",
        ),
    ] {
        let problems = scene(folder.path(), terrain, &slides, "").unwrap_err();
        println!("{}: {}", problems[0].path, problems[0].message);
        assert_eq!(problems[0].path, path);
        assert!(
            problems[0].message.contains(words),
            "{}",
            problems[0].message
        );
    }
}

/// The scripts make the terrain that is here, and the section's ground and rock, to the letter.
#[test]
fn the_scripts_make_the_terrain_of_the_cases() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases");
    let made = |script: &str, what: &[&str]| {
        let mut command = std::process::Command::new("python3");
        let output = command.arg(cases.join(script)).args(what).output();
        output.map(|output| String::from_utf8(output.stdout).unwrap())
    };
    let text = |file: &str| std::fs::read_to_string(cases.join(file)).unwrap();
    let Ok(fjord) = made("fjord.py", &["grid"]) else {
        println!("skipped: there is no python3");
        return;
    };
    assert_eq!(fjord, text("fjord.asc"));
    assert_eq!(made("reservoir.py", &[]).unwrap(), text("reservoir.asc"));
    let section = made("fjord.py", &["section"]).unwrap();
    let scene = text("slide_section.ron");
    assert!(section.lines().count() > 10);
    for line in section.lines().filter(|line| !line.trim().is_empty()) {
        assert!(scene.contains(line.trim()), "{line}");
    }
}

/// The scene of the README is one.
#[test]
fn the_slope_of_the_readme_is_read() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    let (_, from) = readme.split_once("```ron\n").unwrap();
    let (text, _) = from.split_once("```").unwrap();
    let scene = resolved_in(&root.join("cases"), text).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert!(scene.rock_masses[0].n_blocks > 50);
    let slide = SlideImpact::of(&scene.terrain.as_ref().unwrap().rock[0], &scene).unwrap();
    // 40 to 50 m of rock over half of the outline's 280 m, 300 m above the water, on 34 degrees with a friction of 20
    assert!((20.0..40.0).contains(&slide.thickness) && (slide.width - 230.0).abs() < 1e-6);
    assert!((slide.slope.to_degrees() - 34.0).abs() < 0.1);
    let expected =
        2.0 * G * 300.0 * (1.0 - 20.0_f64.to_radians().tan() / 34.0_f64.to_radians().tan());
    assert!((slide.speed / expected.sqrt() - 1.0).abs() < 0.05);
}

/// Feet for meters and degrees for both are asked about.
#[test]
fn implausible_terrain_is_questioned() {
    let folder = tempfile::tempdir().unwrap();
    let asked = |raster: Raster, height: &dyn Fn(f64, f64) -> f64, origin: &str| -> Vec<String> {
        raster.write(&folder.path().join("odd.asc"), height);
        let terrain = format!("(sources: [(file: \"odd.asc\")], origin: {origin})");
        let terrain = terrain_of(folder.path(), &terrain).unwrap();
        terrain.warnings.iter().map(|q| q.message.clone()).collect()
    };
    let none = asked(valley(), &hummocky, "(0, 0, 0)");
    assert!(none.is_empty(), "{none:?}");
    let feet = asked(valley(), &|x, y| hummocky(x, y) / 0.3048, "(0, 0, 0)");
    assert!(
        feet[0].contains("steeper than 70 degrees: are heights in feet"),
        "{feet:?}"
    );
    let plan = Raster {
        cell: 10.0 / 0.3048,
        ..valley()
    };
    let plan = asked(plan, &|x, _| -0.5 * x, "(0, 0, 0)");
    assert!(plan[0].contains("10 m in feet"), "{plan:?}");
    let degrees = Raster {
        corner: [7.0, 62.0],
        cell: 0.001,
        n: [41, 31],
    };
    // a flat in degrees could be the bed of a flume in millimeters; 40 m over 0.04 of them could not
    let flat = asked(degrees, &|x, _| x - 7.0, "(0, 0, 0)");
    assert!(flat[0].contains("degrees of longitude"), "{flat:?}");
    let undeclared = asked(
        valley(),
        &|x, y| if x == 0.0 { -32768.0 } else { hummocky(x, y) },
        "(0, 0, 0)",
    );
    assert!(undeclared[0].contains("NODATA_value"), "{undeclared:?}");
}
