//! Blocks that water moves: on a column of it, released in it, floating on it, hit by it.

use crate::support;
use std::path::Path;

use riprap::observe::Observer;
use riprap::observe::frames::Frames;
use riprap::run::build;
use riprap::scene::parse;
use riprap::scene::resolve::Scene;
use riprap::scene::resolved::recording::Output;
use riprap::time_step::TimeStep;
use riprap::vtk::{self, Values};
use riprap::world::World;
use riprap_sph::Vec3;

const RHO: f64 = 1000.0;
const G: f64 = 9.81;
/// No step is limited by it; s.
const DURATION: f64 = 10.0;

fn world(text: &str) -> World {
    let scene = Scene::resolve(parse::read(text).unwrap(), Path::new("."));
    build(&scene.unwrap()).unwrap()
}

/// Steps until a time (s), and looks after each.
fn advance(world: &mut World, until: f64, mut look: impl FnMut(&World)) {
    while world.time() < until {
        let step = world.next_step(DURATION).unwrap();
        world.step(step).unwrap();
        look(world);
    }
}

fn cuboid(name: &str, rest: &str, [x0, z0, x1, z1]: [f64; 4]) -> String {
    format!(
        "(name: \"{name}\", {rest}, shape: Box(min: ({x0:?}, -1.0, {z0:?}), max: ({x1:?}, 1.0, {z1:?}))),"
    )
}

/// A basin in a plane, `length` (m) long, with a block of which all but the name is given.
fn basin(length: f64, height: f64, level: f64, spacing: f64, body: &str, more: &str) -> String {
    let t = 4.0 * spacing;
    let walls = [
        ("floor", [-t, -t, length + t, 0.0]),
        ("left", [-t, 0.0, 0.0, height]),
        ("right", [length, 0.0, length + t, height]),
    ]
    .map(|(name, corners)| cuboid(name, "material: \"m\", motion: Fixed", corners));
    format!(
        "(title: \"floating\", gravity: (0, 0, -9.81),\n\
         domain: (min: ({:?}, 0.0, {:?}), max: ({:?}, 0.1, {height:?}), dimensions: Two),\n\
         materials: [(name: \"m\", density: 2000, friction_angle_deg: 0)],\n\
         blocks: [{} {body}],\n\
         fluid: (resolution: Spacing({spacing:?}),\n\
         regions: [(name: \"water\", shape: Below(level: {level:?}, seed: ({spacing:?}, 0.05, {spacing:?})))]),\n\
         {more} time: (duration: 10.0))",
        -t,
        -t,
        length + t,
        walls.concat(),
    )
}

/// Smallest and largest of some values, and the times at which they cross their mean upward.
fn crossings(samples: &[(f64, f64)]) -> (f64, Vec<f64>) {
    let mean = samples.iter().map(|s| s.1).sum::<f64>() / samples.len() as f64;
    let rising = samples
        .windows(2)
        .filter(|p| p[0].1 < mean && mean <= p[1].1);
    let times = rising.map(|p| p[0].0 + (p[1].0 - p[0].0) * (mean - p[0].1) / (p[1].1 - p[0].1));
    (mean, times.collect())
}

/// C07: a block lets itself down on a column of water, and the compressible column is its spring. The shaft has no
/// walls but repeats: along a wall the water's density does not feel all of its strain, and in a shaft eight
/// spacings wide the block would be a fifth too slow.
///
/// `ω H/c₀ = θ`, `θ tan θ = ρ A H/M`; under the block `p = M g/A`. Returns what period and mean force are off.
fn block_on_a_column(mass_ratio: f64, theta: f64, spacing: f64) -> [f64; 2] {
    let (width, height) = (8.0 * spacing, 1.0);
    let thickness = 0.4;
    let density = RHO * height / (mass_ratio * thickness);
    let t = 4.0 * spacing;
    let sound_speed = 60.0;
    let floor = cuboid(
        "floor",
        "material: \"m\", motion: Fixed",
        [0.0, -t, width, 0.0],
    );
    let text = format!(
        "(title: \"shaft\", gravity: (0, 0, -9.81),\n\
         domain: (min: (0.0, 0.0, {:?}), max: ({width:?}, 0.1, 2.0), dimensions: Two, periodic: [X]),\n\
         materials: [(name: \"m\", density: {density:?}, friction_angle_deg: 0)],\n\
         blocks: [{floor} (name: \"body\", material: \"m\", hold: (directions: [X, Y], turning: Held),\n\
         shape: Box(min: (0, 0, {height:?}), max: ({width:?}, 0.1, {:?})))],\n\
         fluid: (resolution: Spacing({spacing:?}),\n\
         regions: [(name: \"water\", shape: Box(min: (0, 0, 0), max: ({width:?}, 0.1, {height:?})))]),\n\
         numerics: (sound_speed: {sound_speed:?}, precision: Double, viscosity: Artificial(0.0)), time: (duration: 10.0))",
        -t,
        height + thickness,
    );
    let mut world = world(&text);
    let body = 1;
    let period = std::f64::consts::TAU * height / (theta * sound_speed);
    let weight = world.blocks.mass(body) * G;
    let mut heights = Vec::new();
    let mut forces = Vec::new();
    advance(&mut world, 6.2 * period, |world| {
        heights.push((world.time(), world.blocks.centroid(body).z));
        forces.push(world.fluid_load(body).force.z);
    });
    let (_, rising) = crossings(&heights);
    let n = rising.len() - 1;
    let measured = (rising[n] - rising[0]) / n as f64;
    // whole periods
    let whole: Vec<f64> = (heights.iter().zip(&forces))
        .filter(|((t, _), _)| rising[0] <= *t && *t < rising[n])
        .map(|(_, f)| *f)
        .collect();
    let force = whole.iter().sum::<f64>() / whole.len() as f64;
    [measured / period - 1.0, force / weight - 1.0]
}

#[test]
fn c07_a_block_on_a_column_of_water() {
    for (mass_ratio, theta) in [(0.2, 0.4328407), (1.0, 0.8603336), (5.0, 1.3138377)] {
        let [coarse, fine] = [0.05, 0.025].map(|dp| block_on_a_column(mass_ratio, theta, dp));
        println!(
            "mass ratio {mass_ratio}: period {:+.2} %, {:+.2} % with half the spacing; mean force {:+.2}, {:+.2} %",
            100.0 * coarse[0],
            100.0 * fine[0],
            100.0 * coarse[1],
            100.0 * fine[1],
        );
        assert!(coarse[1].abs() < 0.01 && fine[1].abs() < 0.01);
        // asked is 1 %: water within a spacing of floor and block is too soft, which goes with the spacing
        assert!(fine[0].abs() < 0.025, "{}", fine[0]);
        assert!(fine[0].abs() < 0.6 * coarse[0].abs(), "{fine:?} {coarse:?}");
    }
}

/// A regular polygon of many corners for a cylinder across the plane.
fn cylinder(x: f64, z: f64, radius: f64, density_name: &str, rest: &str) -> String {
    let n = 48;
    let corners: Vec<String> = (0..n)
        .map(|k| {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(n);
            // of the circle's area
            let r = radius
                * (std::f64::consts::TAU
                    / (f64::from(n) * (std::f64::consts::TAU / f64::from(n)).sin()))
                .sqrt();
            format!("({:?}, {:?})", x + r * angle.cos(), z + r * angle.sin())
        })
        .collect();
    format!(
        "(name: \"body\", material: \"{density_name}\", {rest} shape: Extrusion(polygon: [{}], axis: Y, from: 0, to: 0.1)),",
        corners.join(", ")
    )
}

/// C08 in a plane: a cylinder let go in water takes as much of it along as it displaces, `a = g (1 − s)/(s + 1)`.
#[test]
fn c08_a_cylinder_released_in_deep_water() {
    for density in [100.0, 500.0, 900.0] {
        let (radius, spacing) = (0.5, 0.05);
        let body = cylinder(4.0, 4.0, radius, "body", "");
        let text = basin(8.0, 9.0, 8.0, spacing, &body, "").replace(
            "materials: [",
            &format!("materials: [(name: \"body\", density: {density:?}, friction_angle_deg: 0),"),
        );
        let mut world = world(&text);
        let sound_speed = world.water.as_ref().unwrap().fluid.settings().sound_speed;
        let start = 5.0 * radius / sound_speed;
        let mut velocities = Vec::new();
        advance(&mut world, 3.0 * start, |world| {
            velocities.push((world.time(), world.blocks.velocity(3).z));
        });
        let s = density / RHO;
        let expected = G * (1.0 - s) / (s + 1.0);
        let (first, last) = (
            velocities.iter().find(|v| start <= v.0).unwrap(),
            velocities.last().unwrap(),
        );
        let measured = (last.1 - first.1) / (last.0 - first.0);
        println!(
            "density ratio {s}: {measured:.3} of {expected:.3} m/s², {:+.1} %",
            100.0 * (measured / expected - 1.0)
        );
        // the asked 10 %: walls eight radii away alone take 3 %
        assert!(
            (measured / expected - 1.0).abs() < 0.1,
            "{measured} {expected}"
        );
    }
}

/// C08: a sphere let go in water takes half of what it displaces along, `a = g (1 − s)/(s + 1/2)`. Returns the measured
/// acceleration over that, in a basin of `half` its width.
fn ball_let_go(density: f64, spacing: f64, half: f64) -> f64 {
    let (radius, t) = (0.5, 4.0 * spacing);
    let (low, high, level, seed) = (-half - t, half + t, half, -0.8 * half);
    let wall = |name: &str, [a, b, c, d, e, f]: [f64; 6]| {
        format!(
            "(name: \"{name}\", material: \"m\", motion: Fixed, \
             shape: Box(min: ({a:?}, {b:?}, {c:?}), max: ({d:?}, {e:?}, {f:?}))),"
        )
    };
    let walls = [
        wall("floor", [low, low, low, high, high, -half]),
        wall("left", [low, low, -half, -half, high, high]),
        wall("right", [half, low, -half, high, high, high]),
        wall("front", [-half, low, -half, half, -half, high]),
        wall("back", [-half, half, -half, half, high, high]),
    ];
    let text = format!(
        "(title: \"ball\", gravity: (0, 0, -9.81),\n\
         domain: (min: ({low:?}, {low:?}, {low:?}), max: ({high:?}, {high:?}, {high:?})),\n\
         materials: [(name: \"m\", density: {density:?}, friction_angle_deg: 0)],\n\
         blocks: [{} (name: \"ball\", material: \"m\", shape: Sphere(center: (0, 0, 0), radius: {radius}))],\n\
         fluid: (resolution: Spacing({spacing:?}),\n\
         regions: [(name: \"water\", shape: Below(level: {level:?}, seed: ({seed:?}, {seed:?}, {seed:?})))]), time: (duration: 10.0))",
        walls.concat()
    );
    let mut world = world(&text);
    let sound_speed = world.water.as_ref().unwrap().fluid.settings().sound_speed;
    let start = 5.0 * radius / sound_speed;
    let mut velocities = Vec::new();
    advance(&mut world, 3.0 * start, |world| {
        velocities.push((world.time(), world.blocks.velocity(5).z));
    });
    let (first, last) = (
        velocities.iter().find(|v| start <= v.0).unwrap(),
        velocities.last().unwrap(),
    );
    let s = density / RHO;
    let ratio = (last.1 - first.1) / (last.0 - first.0) / (G * (1.0 - s) / (s + 0.5));
    println!("density ratio {s}: {:+.1} %", 100.0 * (ratio - 1.0));
    ratio
}

#[test]
fn c08_a_light_ball_released_in_deep_water() {
    // 10 % is asked of ten spacings a radius: this is half as many, and walls five radii away take up to 2 %
    let ratio = ball_let_go(100.0, 0.1, 2.5);
    assert!((ratio - 1.0).abs() < 0.15, "{ratio}");
}

#[test]
#[ignore = "slow: 6 min"]
fn c08_balls_of_ten_spacings_released_in_deep_water() {
    for density in [100.0, 500.0, 900.0] {
        let ratio = ball_let_go(density, 0.05, 2.5);
        assert!((ratio - 1.0).abs() < 0.1, "{density}: {ratio}");
    }
}

/// C10: a light block hit by a cube of water, nothing else in the world: momentum and its moment stay.
#[test]
fn c10_water_that_hits_a_block_keeps_its_momentum() {
    for (walls, numerics, tolerance) in [
        ("Penalty", "precision: Double", 1e-12),
        ("Particles", "precision: Double", 1e-12),
        ("Integral", "precision: Double", 1e-12),
        ("Particles", "precision: Single", 1e-5),
    ] {
        let text = format!(
            "(title: \"impact\", gravity: (0, 0, 0), domain: (min: (-1, -1, -1), max: (2, 2, 2)),\n\
             materials: [(name: \"m\", density: 300, friction_angle_deg: 0)],\n\
             blocks: [(name: \"body\", material: \"m\", shape: Box(min: (0.45, -0.1, 0.1), max: (0.7, 0.35, 0.5)),\n\
             placement: (rotate: (axis: (0, 1, 0), angle_deg: 10, about: (0.45, 0, 0.3))))],\n\
             fluid: (resolution: Spacing(0.05), regions: [(name: \"water\", velocity: (2, 0, 0),\n\
             shape: Box(min: (0, 0, 0), max: (0.4, 0.4, 0.4)))]),\n\
             interface: (walls: {walls}), numerics: ({numerics}), time: (duration: 10.0))"
        );
        let mut world = world(&text);
        let start = moments(&world);
        advance(&mut world, 0.25, |_| {});
        let end = moments(&world);
        let size = 2.0 * RHO * 0.4_f64.powi(3);
        let (linear, angular) = (
            (end[0] - start[0]).norm() / size,
            // an arm of a meter stands for the moment
            (end[1] - start[1]).norm() / size,
        );
        let given = world.blocks.velocity(0).x * world.blocks.mass(0) / size;
        println!(
            "{walls:9} {numerics}: linear {linear:.1e}, angular {angular:.1e}, share of the momentum that the block has {given:.2}, turning {:.2} rad/s",
            world.blocks.angular_velocity(0).norm()
        );
        assert!(0.05 < given, "{walls}: the water missed the block");
        assert!(linear < tolerance, "{walls}: {linear}");
        assert!(angular < tolerance, "{walls}: {angular}");
    }
}

/// Momentum of water and blocks, and its moment about the origin; kg m/s, kg m²/s.
fn moments(world: &World) -> [Vec3; 2] {
    let fluid = &world.water.as_ref().unwrap().fluid;
    let particles = fluid.particles();
    let mut sums = [Vec3::zeros(); 2];
    for a in 0..particles.len() {
        let momentum = particles.velocity[a] * particles.mass[a];
        sums[0] += momentum;
        sums[1] += particles.position[a].cross(&momentum);
    }
    for b in (0..world.blocks.n_blocks()).filter(|&b| world.blocks.is_free(b)) {
        let momentum = world.blocks.velocity(b) * world.blocks.mass(b);
        sums[0] += momentum;
        sums[1] += world.blocks.centroid(b).cross(&momentum) + world.blocks.spin_momentum(b);
    }
    sums
}

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

/// Mean force (N) and moment about y (N m) of the water on the first block, over the second half of a second.
fn mean_load(world: &mut World) -> [Vec3; 2] {
    let (mut sums, mut n) = ([Vec3::zeros(); 2], 0.0);
    advance(world, 1.0, |world| {
        if 0.5 < world.time() {
            let load = world.fluid_load(0);
            sums[0] += load.force;
            sums[1] += load.torque;
            n += 1.0;
        }
    });
    sums.map(|sum| sum / n)
}

#[test]
fn a_block_on_the_bed_feels_uplift_unless_it_is_sealed() {
    let depth = 1.0;
    for sealed in [false, true] {
        let (mut world, [area, height]) = block_on_the_bed([depth; 2], sealed);
        let force = mean_load(&mut world)[0].z;
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
    advance(&mut world, 1.0, |world| {
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
    let mut world = world(&text.replace(held, ""));
    advance(&mut world, 1.0, |_| {});
    let (before, steps) = (world.energy(), world.clock().steps);
    advance(&mut world, 2.0, |_| {});
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
    advance(&mut world, 0.6, |world| {
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
    let [force, moment] = mean_load(&mut world);
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
    let scene = Scene::resolve(parse::read(&text).unwrap(), Path::new(".")).unwrap();
    let mut world = build(&scene).unwrap();
    let (mut way, mut lift, mut highest, mut full) = (0.0, 0.0_f64, 0.0_f64, None);
    let mut last = 0.0;
    advance(&mut world, 1.5, |world| {
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
    let [force, _] = mean_load(&mut world);
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

/// C11: a plate rests on four particles on a floor, by the springs of penalty walls. Its limit is that of the chain
///
/// `M X'' = −4 K (X − x),  m x'' = −K x − K (x − X)`,
///
/// below which it stays, and beyond which round-off grows into a jump. The limit reported is on the safe side.
#[test]
fn c11_a_plate_on_particles_is_stable_up_to_the_limit_of_their_springs() {
    let (spacing, sunk, n, mass, particle_mass) = (0.1, 0.02, 4.0, 200.0, 1.0);
    let gap = spacing - 2.0 * sunk;
    let stiffness = mass * G / (n * sunk);
    let particles: String = [(-0.4, -0.4), (0.3, -0.4), (-0.4, 0.3), (0.3, 0.3)]
        .iter()
        .map(|(x, y)| {
            format!(
                "(name: \"p{x}{y}\", shape: Box(min: ({x:?}, {y:?}, 0), max: ({:?}, {:?}, {spacing}))),",
                x + spacing,
                y + spacing
            )
        })
        .collect();
    // the plate is put in its place when the particles are in theirs
    let text = format!(
        "(title: \"c11\", gravity: (0, 0, -9.81), domain: (min: (-2, -2, -0.5), max: (2, 2, 2)),\n\
         materials: [(name: \"m\", density: 500, friction_angle_deg: 0)],\n\
         blocks: [(name: \"floor\", material: \"m\", motion: Fixed, shape: Box(min: (-1, -1, -0.4), max: (1, 1, 0))),\n\
         (name: \"plate\", material: \"m\", sealed: true, hold: (directions: [X, Y], turning: Held), shape: Box(min: (-0.5, -0.5, {gap:?}), max: (0.5, 0.5, {:?})))],\n\
         fluid: (resolution: Spacing({spacing}), regions: [{particles}]),\n\
         interface: (walls: Penalty, penalty_stiffness: {stiffness:?}, penalty_damping: 0.0),\n\
         numerics: (sound_speed: 30.0), time: (duration: 10.0))",
        gap + 0.4,
    );
    let springs = [n * stiffness / mass, stiffness / particle_mass];
    // trace and determinant of the chain
    let (trace, product) = (springs[0] + 2.0 * springs[1], springs[0] * springs[1]);
    let limit = 2.0 / (0.5 * (trace + (trace * trace - 4.0 * product).sqrt())).sqrt();
    let jump = |share: f64| {
        let mut world = world(&text);
        for _ in 0..2000 {
            world.settle_step(0.2 * limit, 0.1 / limit).unwrap();
        }
        world.release().unwrap();
        let water = world.water.as_ref().unwrap();
        let reported = water.interface.critical_time_step(particle_mass);
        let rest = world.blocks.centroid(1).z;
        let mut farthest = 0.0_f64;
        for _ in 0..1000 {
            let step = world.next_step(DURATION).unwrap();
            world
                .step(TimeStep {
                    dt: share * limit,
                    ..step
                })
                .unwrap();
            farthest = farthest.max((world.blocks.centroid(1).z - rest).abs());
        }
        (farthest / sunk, reported / limit)
    };
    let [(below, reported), (beyond, _)] = [jump(0.95), jump(1.05)];
    println!(
        "limit {limit:.3e} s, reported {reported:.3} of it; moves {below:.1e} and {beyond:.1e} of its depth"
    );
    // the particles' own weight sets the plate going by 1 %, against a plate that is thrown off its springs
    assert!(below < 0.05 && 1.0 < beyond, "{below}, {beyond}");
    assert!((0.6..1.0).contains(&reported), "{reported}");
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
    let output = "output: (face_pressures: true),";
    let world = world(&basin(1.0, 0.9, level, spacing, &body, output));
    let folder = tempfile::tempdir().unwrap();
    let output = Output {
        frame_interval: f64::INFINITY,
        gauge_interval: f64::INFINITY,
        ledger_interval: f64::INFINITY,
        water_fields: Vec::new(),
        block_fields: Vec::new(),
        contacts: false,
        face_pressures: true,
    };
    let mut frames = Frames::new(folder.path(), &output, &world).unwrap();
    frames.observe(&world).unwrap();
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

/// A flow in a plane does not leave it: under pressure, rounding across it would grow by itself.
#[test]
fn a_flow_in_a_plane_stays_in_it() {
    let body = "(name: \"body\", material: \"m\",\n\
                shape: Box(min: (0.3, 0, 0.55), max: (0.7, 0.1, 0.61)),\n\
                placement: (rotate: (axis: (0, 1, 0), angle_deg: 20, about: (0.5, 0, 0.58))))";
    let mut world = world(&basin(1.0, 1.2, 0.8, 0.025, body, ""));
    let (body, middle) = (3, 0.05);
    advance(&mut world, 0.25, |_| ());
    let water = world.water.as_ref().unwrap();
    let particles = water.fluid.particles();
    let off = particles.position.iter().map(|x| (x.y - middle).abs());
    let off = off.fold(0.0, f64::max);
    let velocity = world.blocks.velocity(body).y;
    println!("particles {off:.1e} m off the plane, the block at {velocity:.1e} m/s");
    assert!(off == 0.0 && velocity == 0.0);
}

/// C05: a box of half the water's density floats with half of it under, 12 spacings by 6.
#[test]
fn c05_a_floating_box_sinks_in_by_its_density() {
    let (spacing, level) = (0.02, 0.3);
    // let go a spacing too high: it has to find its draft
    let body = "(name: \"body\", material: \"body\", shape: Box(min: (0.36, 0, 0.26), max: (0.6, 0.1, 0.38)))";
    let text = basin(0.96, 0.6, level, spacing, body, "").replace(
        "materials: [",
        "materials: [(name: \"body\", density: 500, friction_angle_deg: 0),",
    );
    let mut world = world(&text);
    let (mut sum, mut n) = (0.0, 0.0);
    let mut largest_tilt: f64 = 0.0;
    advance(&mut world, 6.0, |world| {
        if 2.0 < world.time() {
            sum += world.blocks.centroid(3).z;
            n += 1.0;
        }
        largest_tilt = largest_tilt.max(world.blocks.orientation(3).angle());
    });
    // the basin is narrow: water that the box does not fill stands higher; it displaces 6 spacings by 6 less than it did
    let displaced_at_start = 0.24 * (level - 0.26);
    let still_level = level + (0.24 * 0.06 - displaced_at_start) / 0.96;
    let off = sum / n - still_level;
    println!(
        "centroid {:+.3} spacings off the level, tilt at most {:.2} degrees",
        off / spacing,
        largest_tilt.to_degrees()
    );
    assert!(off.abs() < 0.1 * spacing, "{off}");
    assert!(largest_tilt < 0.1, "{largest_tilt}");
}

/// C06: held higher and lower, a floating box is pulled back by the weight of the water between.
#[test]
fn c06_a_floating_box_is_pulled_back_by_what_it_displaces() {
    let (spacing, level, width) = (0.02, 0.3, 0.24);
    let force = |bottom: f64| {
        let body = format!(
            "(name: \"body\", material: \"m\", hold: (directions: [X, Y, Z], turning: Held),\n\
             shape: Box(min: (0.48, 0, {bottom:?}), max: (0.72, 0.1, {:?})))",
            bottom + 0.2
        );
        let mut world = world(&basin(1.2, 0.6, level, spacing, &body, ""));
        let (mut sum, mut n) = (0.0, 0.0);
        advance(&mut world, 2.0, |world| {
            if 1.0 < world.time() {
                sum += world.fluid_load(3).force.z;
                n += 1.0;
            }
        });
        sum / n
    };
    // whole rows, so that both start with the same level
    let (high, low) = (0.24, 0.16);
    let found = (force(low) - force(high)) / (high - low);
    let expected = RHO * G * width * 0.1;
    println!(
        "stiffness {found:.1} of {expected:.1} N/m, {:+.2} %",
        100.0 * (found / expected - 1.0)
    );
    // asked 2 %; of 4 rows
    assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
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
    advance(&mut world, 3.0, |_| ());
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

/// A box that tumbles in a closed tank: no particle gets into it or out of the tank, whatever holds them.
#[test]
fn no_particle_gets_through_a_tumbling_box() {
    for walls in ["Penalty", "Particles", "Integral"] {
        tumble(walls, 10.0);
    }
}

#[test]
#[ignore = "the same for 1e5 steps: 10 min"]
fn no_particle_gets_through_a_box_that_tumbles_for_long() {
    for walls in ["Penalty", "Particles", "Integral"] {
        assert!(100_000 <= tumble(walls, 190.0));
    }
}

/// Steps taken in a time (s) under one kind of walls.
fn tumble(walls: &str, duration: f64) -> u64 {
    let spacing = 0.05;
    let t = 4.0 * spacing;
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..=2000)
        .map(|k| {
            let time = 0.1 * f64::from(k);
            let turn = 100.0 * time;
            format!(
                "{time:?}, {:?}, 0, {:?}, 0, {turn:?}, 0\n",
                0.15 * (1.7 * time).sin(),
                0.1 * (2.3 * time).sin()
            )
        })
        .collect();
    std::fs::write(folder.path().join("tumbling.csv"), rows).unwrap();
    let tank = [
        ("floor", [-t, -t, 1.0 + t, 0.0]),
        ("lid", [-t, 1.0, 1.0 + t, 1.0 + t]),
        ("left", [-t, 0.0, 0.0, 1.0]),
        ("right", [1.0, 0.0, 1.0 + t, 1.0]),
    ]
    .map(|(name, corners)| cuboid(name, "material: \"m\", motion: Fixed", corners));
    let text = format!(
        "(title: \"tumbling\", domain: (min: ({:?}, 0.0, {:?}), max: ({:?}, 0.1, {:?}), dimensions: Two),\n\
         materials: [(name: \"m\", density: 2000, friction_angle_deg: 0)],\n\
         blocks: [{} (name: \"box\", material: \"m\", motion: Table(file: \"tumbling.csv\"),\n\
         shape: Box(min: (0.3, 0, 0.4), max: (0.7, 0.1, 0.6)))],\n\
         fluid: (resolution: Spacing({spacing:?}), regions: [(name: \"water\", shape: Below(level: 0.7, seed: (0.05, 0.05, 0.05)))]),\n\
         interface: (walls: {walls}), time: (duration: 200.0))",
        -t,
        -t,
        1.0 + t,
        1.0 + t,
        tank.concat(),
    );
    let scene = Scene::resolve(parse::read(&text).unwrap(), folder.path());
    let mut world = build(&scene.unwrap()).unwrap();
    let n_particles = world.water.as_ref().unwrap().fluid.particles().len();
    let mut deepest: f64 = 0.0;
    while world.time() < duration {
        let next = world.next_step(duration).unwrap();
        world.step(next).unwrap();
        if world.clock().steps.is_multiple_of(100) {
            let water = world.water.as_ref().unwrap();
            assert_eq!(water.fluid.particles().len(), n_particles);
            let depths = water
                .interface
                .touches()
                .iter()
                .map(|touch| -touch.distance);
            deepest = depths.fold(deepest, f64::max);
        }
    }
    println!(
        "{walls}: {} steps to {:.1} s, deepest {:.2} spacings, {} put back",
        world.clock().steps,
        world.time(),
        deepest / spacing,
        world.extremes().particles_pushed_back
    );
    assert!(deepest < spacing, "{deepest}");
    world.clock().steps
}
