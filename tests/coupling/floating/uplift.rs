//! Water in the joints of blocks on a bed and of a dam.

use super::*;

/// A block on the floor of a basin in a plane, held, with water on both sides of it at two levels; 16 spacings by 8.
fn block_on_the_bed(levels: [f64; 2], sealed: bool) -> (World, [f64; 2]) {
    stack_on_the_bed(levels, sealed, 1)
}

/// The same, cut into layers of equal height, from below; length times width and height of a layer.
fn stack_on_the_bed(levels: [f64; 2], sealed: bool, n_layers: usize) -> (World, [f64; 2]) {
    let (text, sizes) = stack(levels, sealed, n_layers);
    (world(&text), sizes)
}

/// The scene of that.
fn stack(levels: [f64; 2], sealed: bool, n_layers: usize) -> (String, [f64; 2]) {
    let spacing = 0.05;
    let (length, height) = (16.0 * spacing, 8.0 * spacing);
    let basin_length = length + 1.6;
    let t = 4.0 * spacing;
    let [x0, x1] = [0.8, 0.8 + length];
    let walls = [
        ("floor", [-t, -t, basin_length + t, 0.0]),
        ("left", [-t, 0.0, 0.0, 2.0]),
        ("right", [basin_length, 0.0, basin_length + t, 2.0]),
    ]
    .map(|(name, corners)| cuboid(name, "material: \"m\", motion: Fixed", corners));
    let is_under = height < levels[0];
    let regions = if is_under {
        format!(
            "(name: \"all\", shape: Below(level: {:?}, seed: (0.1, 0.05, 0.1)))",
            levels[0]
        )
    } else {
        let left = format!(
            "(name: \"left\", shape: Box(min: (0, 0, 0), max: ({x0:?}, 0.1, {:?}))),",
            levels[0]
        );
        let right = format!(
            "(name: \"right\", shape: Box(min: ({x1:?}, 0, 0), max: ({basin_length:?}, 0.1, {:?})))",
            levels[1]
        );
        if 0.0 < levels[1] { left + &right } else { left }
    };
    let layer = height / n_layers as f64;
    let layers: String = (0..n_layers)
        .map(|k| {
            let (bottom, top) = (layer * k as f64, layer * (k + 1) as f64);
            format!(
                "(name: \"body {k}\", material: \"m\", hold: (directions: [X, Y, Z], turning: Held), \
                 sealed: {sealed}, shape: Box(min: ({x0:?}, 0, {bottom:?}), max: ({x1:?}, 0.1, {top:?}))),\n"
            )
        })
        .collect();
    let text = format!(
        "(title: \"bed\", gravity: (0, 0, -9.81),\n\
         domain: (min: ({:?}, 0.0, {:?}), max: ({:?}, 0.1, 2.0), dimensions: Two),\n\
         materials: [(name: \"m\", density: 2000, friction_angle_deg: 30)],\n\
         blocks: [{layers} {}],\n\
         fluid: (resolution: Spacing({spacing:?}), regions: [{regions}]), time: (duration: 10.0))",
        -t,
        -t,
        basin_length + t,
        walls.concat(),
    );
    (text, [length * 0.1, layer])
}

#[test]
fn a_block_on_the_bed_feels_uplift_unless_it_is_sealed() {
    let depth = 1.0;
    for sealed in [false, true] {
        let (mut world, [area, height]) = block_on_the_bed([depth; 2], sealed);
        let force = mean_load(&mut world, [0.5, 1.0])[0].z;
        let of_depth = if sealed { height - depth } else { height };
        let expected = RHO * G * area * of_depth;
        let scale = RHO * G * area * depth;
        println!(
            "sealed {sealed}: {force:.1} of {expected:.1} N, off by {:+.2} % of rho g H A",
            100.0 * (force - expected) / scale
        );
        // walls of particles bear 1 % of the water over them wrongly at 8 spacings (C04), edges of the joint as much
        assert!(
            (force - expected).abs() < 0.02 * scale,
            "{sealed}: {force} {expected}"
        );
    }
}

/// The joint of two free blocks is seen from both sides, and counts once.
#[test]
fn a_block_on_a_free_block_feels_the_uplift_of_one_joint() {
    let depth = 1.0;
    let (mut world, [area, height]) = stack_on_the_bed([depth; 2], false, 2);
    let mut forces = ([0.0; 2], 0.0);
    advance(&mut world, 1.0, DURATION, |world| {
        if 0.5 < world.time() {
            for (k, sum) in forces.0.iter_mut().enumerate() {
                *sum += world.fluid_load(k).force.z;
            }
            forces.1 += 1.0;
        }
    });
    let scale = RHO * G * area * depth;
    for (k, force) in forces.0.map(|sum| sum / forces.1).iter().enumerate() {
        let expected = RHO * G * area * height;
        println!(
            "layer {k}: {force:.1} of {expected:.1} N, off by {:+.2} % of rho g H A",
            100.0 * (force - expected) / scale
        );
        // as under a block on the floor; twice the joint's pressure would be 80 %
        assert!(
            (force - expected).abs() < 0.03 * scale,
            "{force} {expected}"
        );
    }
}

/// Water in joints does no work on blocks that lie still on each other, though it pushes them in every kick and their contacts push
/// back: booked with the velocities before the kicks alone it seemed to do `F² dt/4m` a second.
#[test]
fn water_in_joints_does_no_work_on_blocks_at_rest() {
    let (text, [area, height]) = stack([1.0; 2], false, 2);
    let held = "hold: (directions: [X, Y, Z], turning: Held), ";
    assert!(text.contains(held));
    // waves that are left of the start do work: they are damped
    let calm = "numerics: (viscosity: Artificial(0.02), time_step_factor: 0.5), fluid: (";
    let text = text.replace(held, "").replace("fluid: (", calm);
    let mut world = world(&text);
    advance(&mut world, 1.0, DURATION, |_| {});
    let (before, steps) = (world.energy(), world.clock().steps);
    advance(&mut world, 2.0, DURATION, |_| {});
    let work = world.energy().joint_water - before.joint_water;
    let residual = world.energy().residual - before.residual;
    let dt = 1.0 / (world.clock().steps - steps) as f64;
    let force = RHO * G * area * (1.0 - height);
    let mistaken = force * force * dt / (4.0 * world.blocks.mass(0));
    println!(
        "{work:.2e} J in a second, residual {residual:.2e} J; with the velocities before kicks {mistaken:.2e} J"
    );
    // waves of what is left of the start
    assert!(work.abs() < 0.1 * mistaken && residual.abs() < 0.1 * mistaken);
}

/// Nine blocks in three layers without gaps, under water: the one amid them sees no water but that of its joints, which
/// comes to it round the corners of the others.
#[test]
fn a_block_amid_others_is_carried_by_the_water_of_their_joints() {
    let (spacing, side, depth) = (0.05, 0.3, 1.5);
    let body: String = (0..9)
        .map(|k| {
            let [x, z] = [0.8 + side * f64::from(k % 3), side * f64::from(k / 3)];
            format!(
                "(name: \"body {k}\", material: \"m\", hold: (directions: [X, Y, Z], turning: Held), \
                 shape: Box(min: ({x:?}, 0, {z:?}), max: ({:?}, 0.1, {:?}))),",
                x + side,
                z + side
            )
        })
        .collect();
    let text = basin(1.6 + 3.0 * side, 2.0, depth, spacing, &body, "");
    let mut world = world(&text);
    let (mut force, mut n) = (Vec3::zeros(), 0.0);
    advance(&mut world, 0.6, DURATION, |world| {
        if 0.3 < world.time() {
            force += world.fluid_load(3 + 4).force;
            n += 1.0;
        }
    });
    let (force, expected) = (force / n, RHO * G * side * side * 0.1);
    let scale = RHO * G * depth * side * 0.1;
    println!(
        "lift {:.2} of {expected:.2} N, across {:+.2} N; {:+.2} % of rho g H A",
        force.z,
        force.x,
        100.0 * (force.z - expected) / scale
    );
    // as on the bed; without a way round corners its joints would be dry
    assert!((force.z - expected).abs() < 0.02 * scale, "{force}");
    assert!(force.x.abs() < 0.02 * scale, "{force}");
}

#[test]
fn uplift_under_a_dam_falls_from_one_level_to_the_other() {
    uplift_under_a_dam([0.35, 0.15]);
}

#[test]
fn uplift_under_a_dam_falls_to_nothing_beside_air() {
    uplift_under_a_dam([0.35, 0.0]);
}

fn uplift_under_a_dam(levels: [f64; 2]) {
    let (mut world, [area, _]) = block_on_the_bed(levels, false);
    let [force, moment] = mean_load(&mut world, [0.5, 1.0]);
    let length = area / 0.1;
    let expected = 0.5 * RHO * G * (levels[0] + levels[1]) * area;
    // about the centroid, y turns from z to x: uplift at the high side, -x, and thrust
    let tilt = RHO * G * (levels[0] - levels[1]) * area * length / 12.0;
    let thrust = |level: f64| 0.5 * RHO * G * level * level * 0.1;
    let arm = |level: f64| level / 3.0 - 0.2;
    let turning = thrust(levels[0]) * arm(levels[0]) - thrust(levels[1]) * arm(levels[1]) + tilt;
    println!(
        "uplift {:.2} of {expected:.2} N, moment {:.3} of {turning:.3} N m, thrust {:.2} of {:.2} N",
        force.z,
        moment.y,
        force.x,
        thrust(levels[0]) - thrust(levels[1]),
    );
    assert!(
        (force.z / expected - 1.0).abs() < 0.05,
        "{} {expected}",
        force.z
    );
    // of the tilt of the uplift: 0.08 and 0.05 for the share of the lowest row's thrust that the floor takes, as much again
    // for where the joint begins, known to a quarter of a spacing
    assert!(
        (moment.y - turning).abs() < 0.16 * tilt,
        "{} {turning}",
        moment.y
    );
    assert_eq!(world.extremes().particles_pushed_back, 0);
}

/// Water that runs against a block fills the dry joint under it no faster than its head drives it in, and does fill it.
#[test]
fn a_dry_joint_fills_at_the_speed_that_its_head_gives() {
    let (width, from, length, spacing) = (0.1, 0.9, 0.6, 0.02);
    let text = format!(
        "(title: \"joint\", gravity: (0, 0, -9.81), domain: (min: (-0.1, 0, -0.1), max: (2.2, {width:?}, 1.0), dimensions: Two),\n\
         materials: [(name: \"m\", density: 3000, friction_angle_deg: 30)],\n\
         blocks: [(name: \"block\", material: \"m\", hold: (directions: [X, Y, Z], turning: Held),\n\
         shape: Box(min: ({from:?}, 0, 0), max: ({:?}, {width:?}, 0.5))),\n\
         (name: \"floor\", material: \"m\", motion: Fixed, shape: Box(min: (-0.1, -0.1, -0.1), max: (2.2, 0.2, 0))),\n\
         (name: \"left\", material: \"m\", motion: Fixed, shape: Box(min: (-0.1, -0.1, 0), max: (0, 0.2, 0.9)))],\n\
         fluid: (resolution: Spacing({spacing:?}), regions: [(name: \"water\", shape: Box(min: (0, 0, 0), max: (0.6, {width:?}, 0.3)))]),\n\
         time: (duration: 1.5))",
        from + length
    );
    let scene = resolved(&text).unwrap();
    let mut world = build(&scene).unwrap();
    let (mut way, mut lift, mut highest, mut full) = (0.0, 0.0_f64, 0.0_f64, None);
    let mut last = 0.0;
    advance(&mut world, 1.5, DURATION, |world| {
        let water = world.water.as_ref().unwrap();
        let particles = water.fluid.particles();
        let near = (0..particles.len()).filter(|&a| particles.position[a].x > from - 3.0 * spacing);
        let head = near.fold(0.0_f64, |head, a| head.max(particles.pressure[a]));
        let dt = world.time() - last;
        last = world.time();
        lift = water.joints.loads()[0].force.z;
        highest = highest.max(head);
        way += (2.0 * head / RHO).sqrt() * dt;
        // the rows at the face feel the water itself
        let reached = (way + 2.0 * spacing).min(length);
        assert!(
            lift <= highest * reached * width,
            "{lift} at {}",
            world.time()
        );
        if length < way && full.is_none() {
            full = Some(world.time());
        }
    });
    println!("joint: lift {lift:.2} N, full at {full:?} s");
    // of 0.1 m of water, half as seepage to the dry end has it
    assert!(0.5 * 0.5 * RHO * G * 0.1 * length * width < lift, "{lift}");
    assert!(full.is_some());
}
