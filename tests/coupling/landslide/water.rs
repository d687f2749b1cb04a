//! Water on terrain: basins, maps of its reach, what overtops.

use super::*;

/// Water poured into a bowl has the volume between the ground and the level, 0.5 % at 20 rows: the lattice follows slopes in steps.
#[test]
fn water_has_the_volume_of_the_basin() {
    let folder = tempfile::tempdir().unwrap();
    // a paraboloid, 100 m deep at a radius of 120 m
    let bowl = |x: f64, y: f64| 100.0 * ((x - 200.0).powi(2) + y * y) / 120.0_f64.powi(2) - 100.0;
    let raster = Raster {
        cell: 5.0,
        n: [81, 61],
        ..valley()
    };
    raster.write(&folder.path().join("bowl.asc"), bowl);
    let water = "fluid: (resolution: Spacing(5), regions: [(name: \"lake\", shape: Below(level: 0, seed: (200, 0, -50)))])";
    let scene = scene(
        folder.path(),
        "(sources: [(file: \"bowl.asc\")], tolerance: 1e-6)",
        "",
        water,
    )
    .unwrap();
    let plan = [[0.0, -150.0], [400.0, 150.0]];
    let terrain = scene.terrain.as_ref().unwrap();
    let room = room_below(terrain, 0.0, [200.0, 0.0], plan).unwrap();
    let integral = room.volume;
    // of a paraboloid half of its cylinder; triangles of 5 m lie above it by 5²/12 (z_xx + z_yy) in the mean
    let above = 25.0 / 12.0 * 4.0 * 100.0 / 120.0_f64.powi(2);
    let exact = std::f64::consts::PI * 120.0_f64.powi(2) * (0.5 * 100.0 - above);
    let lattice = &scene.fluid.as_ref().unwrap().lattice;
    let poured = lattice.positions.len() as f64 * lattice.spacing.iter().product::<f64>();
    println!(
        "integral {integral:.0} m3 of {exact:.0}; {} particles have {poured:.0} m3, {:+.3} %",
        lattice.positions.len(),
        100.0 * (poured / integral - 1.0)
    );
    // measured 3e-5: the shore cuts triangles anywhere
    assert!((integral / exact - 1.0).abs() < 1e-4);
    assert!((poured / integral - 1.0).abs() < 0.005);
    // the apex is a point of the raster
    assert!((room.depth - 100.0).abs() < 1e-9);
    assert_eq!(room_below(terrain, 0.0, [10.0, 0.0], plan), None);
}

/// Water that gets out of the raster or over all land is refused, with the place on the map.
#[test]
fn basins_that_do_not_hold_are_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let floor = Raster {
        corner: [500_000.0, 6_000_000.0],
        cell: 10.0,
        n: [41, 31],
    };
    // a valley that goes on to the south
    floor.write(&folder.path().join("valley.asc"), |x, y| {
        0.5 * (x - 500_200.0).abs() + 0.5 * (y - 6_000_150.0).max(0.0)
    });
    for (level, words) in [
        (40.0, "leaks out of the domain at ("),
        (40.0, "on the map (0, 0, 0) is (500000, 6000000, 0) m"),
        (500.0, "above the domain"),
        (250.0, "leaks out of the domain at ("),
    ] {
        let text = format!(
            r#"(title: "no basin", domain: (min: (0, 0, -20), max: (400, 300, 300)),
                materials: [(name: "rock", density: 2600, friction_angle_deg: 30)],
                terrain: (sources: [(file: "valley.asc")], origin: (500000, 6000000, 0)),
                blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain)],
                fluid: (resolution: Spacing(5), regions: [(name: "lake", shape: Below(level: {level}, seed: (200, 100, 30)))]),
                time: (duration: 1))"#
        );
        let problems = resolved_in(folder.path(), &text).unwrap_err();
        println!("{}: {}", problems[0].path, problems[0].message);
        assert!(
            problems[0].message.contains(words),
            "{}",
            problems[0].message
        );
    }
}

/// A tank of 1 m by 0.1 m on a flat raster of a map, 50 m above its zero.
fn tank(folder: &Path, region: &str, further: &str) -> PathBuf {
    let floor = Raster {
        corner: [499_999.5, 5_999_999.5],
        cell: 0.1,
        n: [21, 12],
    };
    floor.write(&folder.join("floor.asc"), |_, _| 50.0);
    let text = format!(
        r#"(title: "a tank on a map", domain: (min: (0, 0, -0.2), max: (1, 0.1, 0.7), periodic: [Y]),
            materials: [(name: "wall", density: 2500, friction_angle_deg: 30)],
            terrain: (sources: [(file: "floor.asc")], origin: (500000, 6000000, 50), crs: "EPSG:25833"),
            blocks: [(name: "floor", material: "wall", motion: Fixed, shape: Terrain),
                     (name: "west", material: "wall", motion: Fixed, shape: Box(min: (-0.2, -0.1, -0.2), max: (0, 0.2, 0.7))),
                     (name: "east", material: "wall", motion: Fixed, shape: Box(min: (1, -0.1, -0.2), max: (1.2, 0.2, 0.7)))],
            fluid: (resolution: Spacing(0.02), regions: [{region}]),
            {further})"#
    );
    let path = folder.join("tank.ron");
    std::fs::write(&path, text).unwrap();
    path
}

/// Highest water and first arrival of a standing wave `η = a cos kx sin ωt` over its first three quarters: `a |cos kx|`, and
/// `asin(threshold/(a cos kx))/ω`; grids in coordinates of the map.
#[test]
fn maps_show_how_high_and_when() {
    let folder = tempfile::tempdir().unwrap();
    let region = "(name: \"water\", shape: Box(min: (0, 0, 0), max: (1, 0.1, 0.4)),
                   flow: StandingWave(height: 0.04, length: 2, depth: 0.4, crest: 0))";
    let further =
        "time: (duration: 0.95), maps: (interval: 0.02, spacing: 0.05, arrival_threshold: 0.005)";
    let case = tank(folder.path(), region, further);
    let run_folder = folder.path().join("run");
    support::run(&case, &run_folder, &[]);
    let read = |name: &str| {
        let text = std::fs::read(run_folder.join(format!("{name}.asc"))).unwrap();
        riprap::scene::raster::grid_from(&text).unwrap()
    };
    let (highest, arrival) = (read("maximum_elevation"), read("first_arrival"));
    assert_eq!(highest.n, [20, 2]);
    let corner = [500_000.025, 6_000_000.025];
    assert!((0..2).all(|axis| (highest.corner[axis] - corner[axis]).abs() < 1e-6));
    let image = std::fs::read(run_folder.join("maximum_elevation.tif")).unwrap();
    let image = riprap::scene::geotiff::raster_from(&image).unwrap();
    let crs = riprap::scene::crs::Crs::of_epsg(25_833).unwrap();
    let prj = std::fs::read_to_string(run_folder.join("maximum_elevation.prj")).unwrap();
    assert_eq!((image.crs, prj), (Some(crs.clone()), crs.wkt));
    let far = |axis: usize| (image.grid.corner[axis] - highest.corner[axis]).abs();
    assert!(image.grid.n == highest.n && far(0).max(far(1)) < 1e-6);
    // three digits in the one, 2⁻¹⁹ of 50 m in the other
    let pairs = image.grid.heights.iter().zip(&highest.heights);
    assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 6e-4));
    let (a, k) = (0.02, std::f64::consts::PI);
    let omega = (G * k * (k * 0.4).tanh()).sqrt();
    let mut worst: f64 = 0.0;
    for i in 0..20 {
        let x = 0.025 + 0.05 * f64::from(i);
        let rise = highest.heights[i as usize] - 50.4;
        worst = worst.max((rise - a * (k * x).cos().abs()).abs());
    }
    println!("highest water off by {:.2} a at most", worst / a);
    // a is one spacing: the surface is known to some tenths of it
    assert!(worst < 0.3 * a);
    let expected = (0.005 / (a * (k * 0.025).cos())).asin() / omega;
    println!(
        "arrives at {} s, by theory {expected:.3} s",
        arrival.heights[0]
    );
    assert!((0.0..0.041).contains(&(arrival.heights[0] - expected)));
    let maps = riprap::vtk::read(&run_folder.join("maps.vtp")).unwrap();
    assert_eq!((maps.points.len(), maps.polygons.offsets.len()), (40, 19));
    assert_eq!(maps.point_data.len(), 3);
}

/// Water in a bowl with a flat shore, left alone for two minutes: no wave arrives, nothing is inundated, and the gauges read the level.
/// Thin water comes and goes on such a shore, by half a spacing of depth at a dozen points of this map.
#[test]
fn still_water_makes_no_wave() {
    let folder = tempfile::tempdir().unwrap();
    let raster = Raster {
        cell: 5.0,
        n: [81, 61],
        ..valley()
    };
    // 30 m deep at a radius of 120 m
    raster.write(&folder.path().join("bowl.asc"), |x, y| {
        30.0 * ((x - 200.0).powi(2) + y * y) / 120.0_f64.powi(2) - 30.0
    });
    let case = folder.path().join("bowl.ron");
    std::fs::write(
        &case,
        r#"(title: "still water in a bowl", domain: (min: (30, -140, -40), max: (370, 140, 40)),
            materials: [(name: "rock", density: 2650, friction_angle_deg: 30)],
            terrain: (sources: [(file: "bowl.asc")]),
            blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain)],
            fluid: (resolution: Spacing(6), regions: [(name: "lake", shape: Below(level: 0, seed: (200, 0, -15)))]),
            time: (settle: 10, duration: 120),
            maps: (spacing: 6),
            gauges: [SurfaceElevation(name: "middle", x: 200, y: 0), RunUp(name: "east", from: (200, 0), to: (360, 0)),
                     RunUp(name: "north", from: (200, 0), to: (200, 135))])"#,
    )
    .unwrap();
    let run_folder = folder.path().join("run");
    let summary = support::run(&case, &run_folder, &[]);
    let read = |name: &str| {
        let text = std::fs::read(run_folder.join(format!("{name}.asc"))).unwrap();
        riprap::scene::raster::grid_from(&text).unwrap()
    };
    let n_finite = |grid: &riprap::scene::terrain::grid::Grid| {
        grid.heights.iter().filter(|z| z.is_finite()).count()
    };
    let (arrival, flooded, highest) = (
        read("first_arrival"),
        read("inundation_depth"),
        read("maximum_elevation"),
    );
    assert_eq!((n_finite(&arrival), n_finite(&flooded)), (0, 0));
    // π 120² m² are 1257 squares of 6 m, those of the shore thinner than a particle
    assert!(n_finite(&highest) > 1000);
    let rows = support::table(&run_folder.join("gauges.csv"));
    let range = |column: usize| {
        let values = rows.iter().map(|row| row[column]);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| {
            (low.min(z), high.max(z))
        })
    };
    println!(
        "middle {:?}, run-up {:?} and {:?}",
        range(1),
        range(2),
        range(3)
    );
    for column in [2, 3] {
        assert_eq!(rows[0][column], 0.0);
        let (low, high) = range(column);
        // a particle at the edge moves by a fraction of a spacing
        assert!(-0.2 * 6.0 < low && high < 0.2 * 6.0, "{low} to {high}");
    }
    for gauge in summary["gauges"].as_array().unwrap() {
        assert!(gauge["arrival"].is_null(), "{gauge}");
    }
}

/// A solitary wave arrives from the paddle at `c = √(g (d + H))`, within two points of the map.
#[test]
fn a_wave_arrives_at_its_celerity() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("flume.ron");
    let case_name = case.to_str().unwrap();
    let [depth, height, length] = [0.4, 0.12, 6.0];
    let sizes = [depth, height, length].map(|size: f64| size.to_string());
    let output = support::riprap(&[
        "new", "flume", "--depth", &sizes[0], "--height", &sizes[1], "--length", &sizes[2],
        "--out", case_name,
    ]);
    assert!(output.status.success(), "{}", support::words(&output));
    // maps need a plan: a slab of four spacings, periodic across
    let text = std::fs::read_to_string(&case).unwrap();
    let slab = text
        .replace("dimensions: Two", "periodic: [Y]")
        .replace(", 1, ", ", 0.16, ")
        .replace("y: 0.5", "y: 0.08")
        .replace(", 0.5, ", ", 0.08, ");
    std::fs::write(&case, slab).unwrap();
    let run_folder = folder.path().join("run");
    let maps = "maps=(spacing: 0.1, interval: 0.02, arrival_threshold: 0.03)";
    let coarse = "fluid.resolution=Spacing(0.04)";
    // before the crest comes back from the wall
    let sets = ["--set", maps, "--set", coarse, "--until", "4.3"];
    let summary = support::run(&case, &run_folder, &sets);
    let text = std::fs::read(run_folder.join("first_arrival.asc")).unwrap();
    let arrival = riprap::scene::raster::grid_from(&text).unwrap();
    let celerity = (G * (depth + height)).sqrt();
    let at = |x: f64| arrival.heights[((x - arrival.corner[0]) / 0.1).round() as usize];
    // from where the wave has left the paddle to where the wall is still ahead of it
    let start = at(1.8);
    let mut worst: f64 = 0.0;
    for k in 0..28 {
        let x = 1.8 + 0.1 * f64::from(k);
        worst = worst.max((celerity * (at(x) - start) - (x - 1.8)).abs());
    }
    println!("front off by {:.2} points at most", worst / 0.1);
    assert!(worst < 0.2, "{worst} m");
    // the table of the summary agrees: crests of the gauges in the order of the wave
    let gauges = summary["gauges"].as_array().unwrap();
    let of = |name: &str, key: &str| {
        let gauge = gauges.iter().find(|gauge| gauge["name"] == name).unwrap();
        gauge[key].as_f64().unwrap()
    };
    for name in ["g1", "g2", "g3"] {
        // measured 0.998, 0.954 and 0.924, in another order of sums 1.016, 0.987 and 0.873: the wave loses some height at ten rows
        assert!((0.85 * height..1.05 * height).contains(&(of(name, "largest") - depth)));
        assert!(of(name, "arrival") < of(name, "time"));
    }
    // the crest by the center of its upper half: measured 0.996 and 1.002, in two orders of sums. At ten rows it is flat, within a
    // twentieth of its height for up to 0.28 s, and its highest sample anywhere in them
    let rows = support::table(&run_folder.join("gauges.csv"));
    let crest = |column: usize, name: &str| {
        let half = 0.5 * (of(name, "largest") - depth);
        let above = rows.iter().map(|row| (row[0], row[column] - depth - half));
        let (sum, weight) = above
            .filter(|(_, z)| 0.0 < *z)
            .fold((0.0, 0.0), |(sum, weight), (t, z)| {
                (sum + t * z, weight + z)
            });
        let center = sum / weight;
        let highest = of(name, "time");
        assert!((highest - center).abs() < 0.2, "{name}: {highest} {center}");
        center
    };
    let way = 0.4 * length;
    let passed = crest(3, "g3") - crest(1, "g1");
    println!("crest at {:.4} of its celerity", way / passed / celerity);
    assert!((celerity * passed / way - 1.0).abs() < 0.05);
    // and the front, which is steep: measured 1.014
    let passed = of("g3", "arrival") - of("g1", "arrival");
    assert!((celerity * passed / way - 1.0).abs() < 0.05);
}

/// The volume that crosses a line is the final volume beyond it, to the particle. The line extends past the ends of the period:
/// until the next neighbor search particles may be past them.
#[test]
fn what_has_overtopped_is_beyond_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let region = "(name: \"column\", shape: Box(min: (0, 0, 0), max: (0.3, 0.1, 0.4)))";
    let further = "time: (duration: 0.4), output: (gauge_interval: 0.01),
                   gauges: [Overtopping(name: \"line\", from: (0.5, -0.05), to: (0.5, 0.15)),
                            Overtopping(name: \"back\", from: (0.5, 0.15), to: (0.5, -0.05))]";
    let case = tank(folder.path(), region, further);
    let (scene, _) = riprap::scene::load(&case, &[]).unwrap();
    let mut world = run::build(&scene).unwrap();
    let mut gauges = Gauges::new(folder.path(), &scene, &world, Start::New).unwrap();
    while world.time() < 0.4 {
        if gauges.is_due(&world) {
            gauges.observe(&world).unwrap();
        }
        let step = world.next_step(0.4).unwrap();
        world.step(step).unwrap();
    }
    gauges.observe(&world).unwrap();
    let rows = support::table(&folder.path().join("gauges.csv"));
    let last = rows.last().unwrap();
    let fluid = &world.water.as_ref().unwrap().fluid;
    let beyond = fluid
        .particles()
        .position
        .iter()
        .filter(|x| 0.5 < x.x)
        .count() as f64;
    println!(
        "{:.6} m3 have passed, {beyond} particles are beyond",
        last[1]
    );
    assert!(beyond > 100.0 && (last[1] / (beyond * fluid.particle_volume()) - 1.0).abs() < 1e-9);
    assert_eq!(last[1], -last[3]);
    // the discharge is what the volume grew by
    let summed: f64 = rows.windows(2).map(|r| r[1][2] * (r[1][0] - r[0][0])).sum();
    assert!((summed / last[1] - 1.0).abs() < 1e-9);
}
