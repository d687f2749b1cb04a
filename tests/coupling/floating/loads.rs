//! Forces and pressures of water on blocks.

use super::*;

/// Forces by source explain what momentum a block gains: one that falls into water, turns and settles on the bed.
#[test]
fn forces_by_source_explain_the_motion() {
    let body = "(name: \"body\", material: \"m\", shape: Box(min: (0.5, 0, 0.32), max: (0.8, 0.1, 0.52)), \
                placement: (rotate: (axis: (0, 1, 0), angle_deg: 20, about: (0.65, 0, 0.42))))";
    let text = basin(1.6, 1.0, 0.3, 0.05, body, "forces: (interval: 0.02),")
        .replace("duration: 10.0", "duration: 1.5");
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.ron");
    std::fs::write(&scene, text).unwrap();
    let out = folder.path().join("out");
    let summary = support::run(&scene, &out, &[]);
    // a flow in a plane stays in it, however its blocks turn
    assert_eq!(summary["particles_escaped"], 0);
    let header = std::fs::read_to_string(out.join("forces.csv")).unwrap();
    let names: Vec<&str> = header.lines().next().unwrap().split(',').collect();
    let rows = support::table(&out.join("forces.csv"));
    let largest = |start: &str| {
        let columns = names
            .iter()
            .enumerate()
            .filter(|(_, name)| name.starts_with(start));
        let values = columns.flat_map(|(k, _)| rows.iter().map(move |row| row[k].abs()));
        values.fold(0.0, f64::max)
    };
    assert!(70 < rows.len(), "{}", rows.len());
    let weight = 2000.0 * 0.3 * 0.2 * 0.1 * G;
    for source in ["pressure", "contact", "gravity", "joint_water"] {
        println!("{source}: {:.2} of the weight", largest(source) / weight);
        assert!(0.1 * weight < largest(source), "{source}");
    }
    assert_eq!(largest("attached"), 0.0);
    println!(
        "unexplained: {:.1e} of the weight",
        largest("residual") / weight
    );
    // differences of sums over a thousand steps
    assert!(largest("residual") < 1e-9 * weight);
    let partners = support::table(&out.join("contacts.csv"));
    assert!(
        partners.iter().all(|row| row[2] == 0.0),
        "a contact with anything but the floor"
    );
}

/// A sphere of ten spacings, held under still water, feels the weight of what it displaces.
#[test]
fn a_ball_under_water_is_lifted_by_what_it_displaces() {
    let (spacing, radius, size, level): (f64, f64, f64, f64) = (0.1, 0.5, 1.8, 2.0);
    let t = 3.0 * spacing;
    let wall = |name: &str, [x0, y0, z0]: [f64; 3], [x1, y1, z1]: [f64; 3]| {
        format!(
            "(name: \"{name}\", material: \"m\", motion: Fixed, \
             shape: Box(min: ({x0:?}, {y0:?}, {z0:?}), max: ({x1:?}, {y1:?}, {z1:?}))),"
        )
    };
    let walls = [
        wall("floor", [-t, -t, -t], [size + t, size + t, 0.0]),
        wall("left", [-t, -t, 0.0], [0.0, size + t, 2.4]),
        wall("right", [size, -t, 0.0], [size + t, size + t, 2.4]),
        wall("front", [0.0, -t, 0.0], [size, 0.0, 2.4]),
        wall("back", [0.0, size, 0.0], [size, size + t, 2.4]),
    ];
    let text = format!(
        "(title: \"ball\", gravity: (0, 0, -9.81), domain: (min: ({:?}, {:?}, {:?}), max: ({:?}, {:?}, 2.4)),\n\
         materials: [(name: \"m\", density: 2000, friction_angle_deg: 0)],\n\
         blocks: [(name: \"ball\", material: \"m\", hold: (directions: [X, Y, Z], turning: Held),\n\
         shape: Sphere(center: ({:?}, {:?}, 1.0), radius: {radius:?})), {}],\n\
         fluid: (resolution: Spacing({spacing:?}),\n\
         regions: [(name: \"water\", shape: Below(level: {level:?}, seed: (0.1, 0.1, 0.1)))]), time: (duration: 10.0))",
        -t,
        -t,
        -t,
        size + t,
        size + t,
        0.5 * size,
        0.5 * size,
        walls.concat(),
    );
    let mut world = world(&text);
    // rows of water and of walls do not fit each other: it takes a second until the water is at rest
    let [force, _] = mean_load(&mut world, [1.5, 3.0]);
    let expected = RHO * G * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    println!(
        "ball: {:.1} of {expected:.1} N, {:+.2} %",
        force.z,
        100.0 * (force.z / expected - 1.0)
    );
    // asked is 1.5 % at 12 spacings across; the depth of the first layer is known to a twentieth of a spacing
    assert!(
        (force.z / expected - 1.0).abs() < 0.02,
        "{} {expected}",
        force.z
    );
    assert!(force.x.hypot(force.y) < 0.01 * expected, "{force:?}");
}

/// Still water on a fixed box and its basin: each tile has `ρ g` times its depth, and those of the box lift it by what
/// it displaces.
#[test]
fn pressures_on_faces_are_those_of_still_water() {
    let (level, spacing) = (0.6, 0.02);
    let body = cuboid(
        "body",
        "material: \"m\", motion: Fixed",
        [0.4, 0.16, 0.64, 0.4],
    );
    // ten times long waves: the column is 0.5 % heavier at the bottom
    let output = "numerics: (sound_speed: 24.3), output: (face_pressures: true),";
    let mut scene = resolved(&basin(1.0, 0.9, level, spacing, &body, output)).unwrap();
    let world = build(&scene).unwrap();
    let folder = tempfile::tempdir().unwrap();
    scene.output = Output {
        frame_interval: f64::INFINITY,
        water: Sampling::every(f64::INFINITY),
        blocks: Sampling::every(f64::INFINITY),
        contact_frames: Sampling::every(f64::INFINITY),
        face_frames: Sampling::every(f64::INFINITY),
        gauge_interval: f64::INFINITY,
        ledger_interval: f64::INFINITY,
        water_fields: Vec::new(),
        block_fields: Vec::new(),
        contacts: false,
        face_pressures: true,
    };
    let mut frames = Frames::new(folder.path(), &scene, &world).unwrap();
    frames.observe(&world).unwrap();
    frames.sync().unwrap();
    let data = vtk::read(&folder.path().join("faces_00000.vtp")).unwrap();
    let (blocks, pressures) = match (&data.cell_data[0].values, &data.cell_data[1].values) {
        (Values::I32(blocks), Values::F32(pressures)) => (blocks, pressures),
        other => unreachable!("{other:?}"),
    };
    let scale = RHO * G * level;
    let (mut worst, mut lift): (f64, f64) = (0.0, 0.0);
    for ((corners, block), pressure) in data.polygons.iter().zip(blocks).zip(pressures) {
        let corners: Vec<Vec3> = (corners.iter())
            .map(|&k| Vec3::from(data.points[k as usize].map(f64::from)))
            .collect();
        let middle = corners.iter().sum::<Vec3>() / corners.len() as f64;
        let pressure = f64::from(*pressure);
        // the lattice begins half a spacing off the faces
        if middle.z < level - spacing {
            worst = worst.max((pressure - RHO * G * (level - middle.z)).abs() / scale);
        }
        if *block == 3 {
            let area: Vec3 = (corners.windows(2))
                .map(|pair| (pair[0] - corners[0]).cross(&(pair[1] - corners[0])) * 0.5)
                .sum();
            lift -= pressure * area.z;
        }
    }
    // the box is 2 m deep across the plane
    let displaced = RHO * G * 0.24 * 0.24 * 2.0;
    println!(
        "worst tile {:.3} % of ρ g H, lift {:+.3} %",
        100.0 * worst,
        100.0 * (lift / displaced - 1.0)
    );
    // the state at the start is that of rest, up to the linear equation of state over the support
    assert!(worst < 0.01, "{worst}");
    assert!((lift / displaced - 1.0).abs() < 0.01);
    assert!(blocks.contains(&0), "the basin's floor is wet too");
}

/// The work of a paddle is energy of the water or a named loss, except for 2 %, which walls introduce.
#[test]
fn the_work_of_a_paddle_is_accounted_for() {
    // far enough from the end wall that no water sees that through it
    let paddle = "(name: \"paddle\", material: \"m\", shape: Box(min: (-0.08, 0, 0), max: (0.14, 0.1, 0.9)),\n\
                  motion: Sinusoid(direction: (1, 0, 0), amplitude: 0.04, period: 1.2, ramp: 0.6))";
    let text = basin(3.0, 0.9, 0.3, 0.02, paddle, "")
        .replace("seed: (0.02, 0.05, 0.02)", "seed: (1.0, 0.05, 0.1)");
    let mut world = world(&text);
    let before = world.energy().stored();
    advance(&mut world, 3.0, DURATION, |_| ());
    let energy = world.energy();
    let gained = energy.stored() - before;
    println!(
        "work {:.3} J: gained {gained:.3}, viscous {:.3}, diffusive {:.3}, at walls {:+.4}, unexplained {:+.1e}",
        energy.external_work, energy.viscous, energy.diffusive, energy.at_walls, energy.residual
    );
    assert!(0.5 * energy.external_work < gained);
    let work = energy.external_work;
    // what walls bring in is no loss, but their error
    assert!(energy.at_walls.abs() < 0.02 * work, "{energy:?}");
    // of the stepping, 8e-6 measured
    assert!(energy.residual.abs() < 1e-4 * work, "{energy:?}");
}
