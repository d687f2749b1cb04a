//! Rock cut out of terrain: its volume, and how it slides.

use super::*;

/// The rock between two parallel planes has the outline's area times their distance along z: 1e-9, a thousand cuts' round-off.
#[test]
fn a_slab_has_the_volume_of_its_outline() {
    let folder = tempfile::tempdir().unwrap();
    let slope = |x: f64, y: f64| 300.0 - 0.8 * x + 0.1 * y;
    valley().write(&folder.path().join("plane.asc"), slope);
    let point = slope(100.0, 0.0) - 30.0;
    let dip = 0.8_f64.hypot(0.1).atan().to_degrees();
    let direction = 0.8_f64.atan2(-0.1).to_degrees();
    let slide = format!(
        "(name: \"slab\", material: \"rock\", outline: {L_SHAPE}, {JOINTS}, {WHOLE},
          failure_surface: Plane(point: (100, 0, {point}), dip_deg: {dip}, dip_direction_deg: {direction}))"
    );
    let scene = scene(
        folder.path(),
        "(sources: [(file: \"plane.asc\")])",
        &slide,
        "",
    )
    .unwrap();
    let exact = 30.0 * L_AREA;
    let error = (volume(&scene, "slab.") / exact - 1.0).abs();
    println!("{}\nvolume off by {error:.1e}", scene.rock_masses[0]);
    assert!(error < 1e-9);
    // under the rock the failure plane, beside it the slope
    let terrain = scene.terrain.as_ref().unwrap();
    let left = ground(terrain);
    for (place, depth) in [
        ([60.0, -80.0], 30.0),
        ([190.0, 10.0], 30.0),
        ([150.0, 20.0], 0.0),
        ([54.0, 0.0], 0.0),
    ] {
        let z = left.height_under_the_sky(place).unwrap();
        assert!(
            (z + depth - slope(place[0], place[1])).abs() < 1e-9,
            "{place:?} {z}"
        );
    }
}

/// On rough ground, with a failure surface that is a raster and comes out of it, blocks fill what was taken out of the ground: 1e-9.
#[test]
fn rock_between_two_rough_surfaces_keeps_its_volume() {
    let folder = tempfile::tempdir().unwrap();
    valley().write(&folder.path().join("rough.asc"), hummocky);
    // a bowl under the slope that daylights within the outline
    let bowl =
        |x: f64, y: f64| hummocky(x, y) - 45.0 + 0.012 * ((x - 120.0).powi(2) + (y + 20.0).powi(2));
    valley().write(&folder.path().join("bowl.asc"), bowl);
    let outline = "Corners([(31, -128), (222, -131), (231, 87), (40, 91)])";
    let slide = |more: &str| {
        format!(
            "(name: \"bowl\", material: \"rock\", outline: {outline}, failure_surface: Raster(file: \"bowl.asc\"), {JOINTS}, minimum_volume: 0, {more})"
        )
    };
    let of = |more: &str| {
        let terrain = "(sources: [(file: \"rough.asc\")], tolerance: 0.5)";
        scene(folder.path(), terrain, &slide(more), "").unwrap()
    };
    let plain = of("convex_within: 0");
    let rock = plain.terrain.as_ref().unwrap().rock[0].volume;
    // a paraboloid of depth d and radius √(d/a): π d²/(2a); triangles of 10 m take 10²/12 · 4a off its depth
    let exact = std::f64::consts::PI * 45.0 / 0.012 * (0.5 * 45.0 - 100.0 / 12.0 * 4.0 * 0.012);
    println!("{}", plain.rock_masses[0]);
    println!(
        "rock {rock:.1} m3 of {exact:.1}, blocks off by {:.1e}",
        volume(&plain, "bowl.") / rock - 1.0
    );
    assert!((volume(&plain, "bowl.") / rock - 1.0).abs() < 1e-9);
    // the tolerance of 0.5 m leaves out points where that makes less
    assert!((rock / exact - 1.0).abs() < 0.005);
    let merged = of("convex_within: 0, merge_slivers: (volume_share: 0.1, aspect: 6)");
    println!("{}", merged.rock_masses[0]);
    assert!((volume(&merged, "bowl.") / rock - 1.0).abs() < 1e-9);
    assert!(merged.blocks.len() < plain.blocks.len());
    // blocks of several parts become convex as far as they may, each for no more than that
    let unions = |scene: &Scene| scene.rock_masses[0].n_unions;
    let mut left = unions(&plain);
    for share in [1e-3, 1e-2, 1e-1] {
        let convex = of(&format!("convex_within: {share}"));
        println!("{}", convex.rock_masses[0]);
        let gained = volume(&convex, "bowl.") / rock - 1.0;
        assert!((-1e-9..share).contains(&gained), "{gained:e}");
        let report = &convex.rock_masses[0];
        assert_eq!(report.n_unions + report.n_filled, unions(&plain));
        assert!(unions(&convex) < left, "{share}: {}", unions(&convex));
        left = unions(&convex);
    }
    // written out and read again it is the same scene, to the bit
    let text = merged.to_text().unwrap();
    let again = resolved_in(folder.path(), &text).unwrap();
    let shapes =
        |scene: &Scene| -> Vec<Shape> { scene.blocks.iter().map(|b| b.shape.clone()).collect() };
    assert_eq!(shapes(&merged), shapes(&again));
}

/// A jointed slab on its failure plane: it stands where friction holds it, and slides as one body where it does not,
/// `s = ½ g (sin α − tan φ cos α) t²`.
#[test]
fn a_slab_slides_down_its_scar() {
    let folder = tempfile::tempdir().unwrap();
    let alpha = 40.0_f64.to_radians();
    let slope = |x: f64, _: f64| 300.0 - alpha.tan() * x;
    valley().write(&folder.path().join("plane.asc"), slope);
    let slide = |joints: &str| {
        format!(
            "(name: \"slab\", material: \"rock\", outline: Corners([(60, -40), (160, -40), (160, 40), (60, 40)]), {joints}
              failure_surface: Plane(point: (100, 0, {}), dip_deg: 40, dip_direction_deg: 90))",
            slope(100.0, 0.0) - 25.0
        )
    };
    // open downhill: the ground ends where the slab does
    let terrain = "(sources: [(file: \"plane.asc\")], excavations: [(outline: Corners([(160, -60), (390, -60), (390, 60), (160, 60)]),
                    failure_surface: Plane(point: (100, 0, 191.09), dip_deg: 40, dip_direction_deg: 90))])";
    let merged = format!("{JOINTS}, {WHOLE}, merge_slivers: (volume_share: 0.2, aspect: 6),");
    for (friction, joints) in [(20.0_f64, merged.as_str()), (20.0, ""), (45.0, &merged)] {
        let further = "numerics: (block_time_step_factor: 0.5)";
        let mut scene = scene(folder.path(), terrain, &slide(joints), further).unwrap();
        for material in &mut scene.materials {
            material.friction_angle = friction.to_radians();
            // a slab of one block sinks in by 1 mm under its weight, one of three layers on joints of 1e9 N/m by 20 cm, on those of
            // 1e10 N/m by 2 cm
            material.contact_stiffness = match friction {
                _ if joints.is_empty() => 1e12,
                20.0 => 1e9,
                _ => 1e10,
            };
        }
        let free: Vec<usize> = (0..scene.blocks.len())
            .filter(|&b| scene.block_names[b].starts_with("slab"))
            .collect();
        let mut world = run::build(&scene).unwrap();
        let center = |world: &riprap::world::World| {
            let mass: f64 = free.iter().map(|&b| world.blocks.mass(b)).sum();
            let moment: Vec3 = free
                .iter()
                .map(|&b| world.blocks.centroid(b) * world.blocks.mass(b))
                .sum();
            moment / mass
        };
        let start = center(&world);
        let end = if friction == 20.0 { 1.5 } else { 0.8 };
        while world.time() < end {
            let step = world.next_step(end).unwrap();
            world.step(step).unwrap();
        }
        let way = (center(&world) - start).norm();
        let expected = 0.5
            * G
            * (alpha.sin() - friction.to_radians().tan() * alpha.cos()).max(0.0)
            * end
            * end;
        println!(
            "{} blocks, {friction} degrees: {way:.4} m of {expected:.4} m",
            free.len()
        );
        // what stands sinks in, as far again as it would at rest
        let sag = if expected == 0.0 { 0.05 } else { 0.0 };
        assert!((way - expected).abs() < 0.02 * expected + sag);
    }
}

/// A joint that loses its friction in two seconds: the block stands until `tan φ s(t) = tan α`, and then goes with
/// `v̇ = g (sin α − s(t) tan φ cos α)`.
#[test]
fn a_block_goes_when_its_friction_has_fallen() {
    let folder = tempfile::tempdir().unwrap();
    let alpha = 30.0_f64.to_radians();
    valley().write(&folder.path().join("plane.asc"), |x, _| {
        300.0 - alpha.tan() * x
    });
    let at = 300.0 - alpha.tan() * 100.0;
    let text = format!(
        r#"(title: "a block", domain: (min: (0, -150, -100), max: (400, 150, 400)),
            materials: [(name: "rock", density: 2500, friction_angle_deg: 40, contact_stiffness: 1e9)],
            joints: [(between: ("rock", "rock"), friction_ramp: [(0.5, 1), (2.5, 0)])],
            terrain: (sources: [(file: "plane.asc")]),
            blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain),
                     (name: "block", material: "rock", shape: Box(min: (-3, -3, 0), max: (3, 3, 2)),
                      placement: (rotate: (axis: (0, 1, 0), angle_deg: 30), translate: (100, 0, {at})))],
            time: (duration: 2))"#
    );
    let scene = resolved_in(folder.path(), &text).unwrap();
    let mut world = run::build(&scene).unwrap();
    let share = |t: f64| 1.0 - 0.5 * (t - 0.5);
    let place = world.blocks.centroid(1);
    let limit = alpha.tan() / 40.0_f64.to_radians().tan();
    let start = 0.5 + 2.0 * (1.0 - limit);
    let end = 2.0;
    while world.time() < end {
        let step = world.next_step(end).unwrap();
        world.step(step).unwrap();
        if world.time() < 0.95 * start {
            // its weight sinks it in by 2 mm, and strains its shear springs as much
            assert!((world.blocks.centroid(1) - place).norm() < 0.01);
        }
    }
    // integral of g (sin α − s tan φ cos α) from the start on, s linear: its mean is that of the ends
    let mean = 0.5 * (share(start) + share(end));
    let expected =
        G * (alpha.sin() - mean * 40.0_f64.to_radians().tan() * alpha.cos()) * (end - start);
    let found = world.blocks.velocity(1).norm();
    println!("goes at {start:.3} s; at {end} s {found:.4} m/s of {expected:.4} m/s");
    assert!((found / expected - 1.0).abs() < 0.01);
}

/// A slope turned by a quarter about z, with its outline, its joints and its failure plane, is cut into the same blocks, which slide
/// as far. Triangles may lie across the other diagonal: volumes are the same to its tolerance.
#[test]
fn a_turned_slope_fails_alike() {
    let folder = tempfile::tempdir().unwrap();
    // 390 m by 390 m about its middle
    let square = Raster {
        corner: [-200.0, -200.0],
        cell: 10.0,
        n: [41, 41],
    };
    let slope = |x: f64, y: f64| -0.8 * x + 3.0 * (x / 37.0).sin() * (y / 29.0).cos();
    square.write(&folder.path().join("east.asc"), slope);
    // what was at (x, y) is at (-y, x)
    square.write(&folder.path().join("north.asc"), |x, y| slope(y, -x));
    let made = |file: &str, turn: f64, corners: &str, point: &str| {
        let slide = format!(
            "(name: \"slide\", material: \"rock\", outline: Corners([{corners}]),
              failure_surface: Plane(point: {point}, dip_deg: 36, dip_direction_deg: {}),
              joint_sets: [(dip_deg: 36, dip_direction_deg: {}, spacing: 15, origin: {point}),
                           (dip_deg: 60, dip_direction_deg: {}, spacing: 22, origin: (0, 0, 0)),
                           (dip_deg: 90, dip_direction_deg: {}, spacing: 19, origin: (0, 0, 0))],
              minimum_volume: 200, convex_within: 0)",
            90.0 - turn,
            90.0 - turn,
            270.0 - turn,
            360.0 - turn
        );
        let text = format!(
            r#"(title: "a slope", domain: (min: (-190, -190, -250), max: (190, 190, 250)),
                materials: [(name: "rock", density: 2600, friction_angle_deg: 10, contact_stiffness: 1e9)],
                terrain: (sources: [(file: "{file}")], tolerance: 0.001),
                slides: [{slide}],
                blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain)],
                time: (duration: 2))"#
        );
        resolved_in(folder.path(), &text).unwrap()
    };
    let east = made(
        "east.asc",
        0.0,
        "(-90, -55), (20, -55), (20, 55), (-90, 55)",
        "(20, 0, -26)",
    );
    let north = made(
        "north.asc",
        90.0,
        "(55, -90), (55, 20), (-55, 20), (-55, -90)",
        "(0, 20, -26)",
    );
    let volume = |scene: &Scene| scene.terrain.as_ref().unwrap().rock[0].volume;
    let off = volume(&north) / volume(&east) - 1.0;
    println!(
        "{} and {} blocks, volume off by {off:.1e}",
        east.rock_masses[0].n_blocks, north.rock_masses[0].n_blocks
    );
    assert!(off.abs() < 1e-4);
    assert_eq!(east.rock_masses[0].n_blocks, north.rock_masses[0].n_blocks);
    let ways = [east, north].map(|scene| {
        let mut world = run::build(&scene).unwrap();
        let free: Vec<usize> = (0..scene.blocks.len())
            .filter(|&b| world.blocks.is_free(b))
            .collect();
        let center = |world: &riprap::world::World| {
            let mass: f64 = free.iter().map(|&b| world.blocks.mass(b)).sum();
            let moments = free
                .iter()
                .map(|&b| world.blocks.centroid(b) * world.blocks.mass(b));
            moments.sum::<Vec3>() / mass
        };
        let start = center(&world);
        while world.time() < 0.3 {
            let step = world.next_step(0.3).unwrap();
            world.step(step).unwrap();
        }
        center(&world) - start
    });
    let turned = Vec3::new(-ways[0].y, ways[0].x, ways[0].z);
    println!("{:.4?} and {:.4?}", ways[0], ways[1]);
    // of a way of some meters: triangles of rough ground differ by 1 mm
    assert!((ways[1] - turned).norm() < 0.01 * ways[0].norm());
}
