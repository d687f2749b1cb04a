//! Columns, arches, bouncing, order of the scheme: closed forms.

use crate::setup::*;
use riprap_dda::{
    BlockDefinition, Blocks, Material, Motion, Polyhedron, Settings, Shape, StepBound, Surface,
    Vec3,
};
use std::sync::Arc;

/// Unit cubes on a floor, each sunk into the one below by what it carries.
fn column(n: usize, stiffness: f64) -> Vec<BlockDefinition> {
    let weight = 2500.0 * G;
    let mut definitions = vec![floor()];
    let mut sunk = 0.0;
    for k in 0..n {
        sunk += (n - k) as f64 * weight / stiffness;
        let base = k as f64 - sunk;
        definitions.push(block(
            cuboid([0.0, 0.0, base], [1.0, 1.0, base + 1.0]),
            Motion::Free,
        ));
    }
    definitions
}

/// Largest drift of a block over `time` (s) after `settling` (s), and how far the reaction is from the weight. Without
/// settling the column starts in its equilibrium; with it, from blocks that just touch.
fn stand(n: usize, settling: f64, time: f64) -> (f64, f64) {
    let material = Material {
        contact_stiffness: 2.5e9,
        ..rock()
    };
    let sunk = if settling > 0.0 { f64::INFINITY } else { 2.5e9 };
    let mut blocks = blocks(column(n, sunk), material, down());
    run(&mut blocks, settling, 1.0, 1e-2);
    let start: Vec<Vec3> = (1..=n).map(|b| blocks.centroid(b)).collect();
    run(&mut blocks, time, 1.0, 1e-2);
    let drift = (1..=n)
        .map(|b| (blocks.centroid(b) - start[b - 1]).norm())
        .fold(0.0, f64::max);
    let weight = n as f64 * 2500.0 * G;
    let reaction = -blocks.contact_force(0).force.z;
    (drift, (reaction / weight - 1.0).abs())
}

/// Thirty cubes, let go where they touch, swing in (the slowest mode, 51 rad/s, dies out with 2.6 1/s) and then stand
/// still for 3 s.
#[test]
fn column_stands() {
    let (drift, reaction) = stand(30, 6.0, 3.0);
    assert_below("drift of a column of 30 in 3 s, blocks", drift, 1e-5);
    assert_below("reaction over weight − 1", reaction, 1e-6);
}

/// A hundred cubes, started in equilibrium, stand still for 60 s.
#[test]
#[ignore = "slow: 2 min"]
fn column_of_a_hundred_stands() {
    let (drift, reaction) = stand(100, 0.0, 60.0);
    assert_below("drift of a column of 100 in 60 s, blocks", drift, 1e-5);
    assert_below("reaction over weight − 1", reaction, 1e-6);
}

/// Semicircular arch of n voussoirs about the y axis, mean radius 10 m, 1 m deep, thickness over radius given, on two
/// fixed abutments.
pub fn arch(n: usize, thickness: f64) -> Vec<BlockDefinition> {
    let (inner, outer) = (
        10.0 * (1.0 - thickness / 2.0),
        10.0 * (1.0 + thickness / 2.0),
    );
    let voussoir = |from: f64, to: f64| {
        let corners: Vec<Vec3> = [from, to]
            .iter()
            .flat_map(|angle| [(inner, angle), (outer, angle)])
            .flat_map(|(radius, angle)| {
                [0.0, 1.0].map(|y| Vec3::new(-radius * angle.cos(), y, radius * angle.sin()))
            })
            .collect();
        Polyhedron::convex_hull(&corners).unwrap()
    };
    let step = std::f64::consts::PI / n as f64;
    let mut definitions: Vec<BlockDefinition> = (0..n)
        .map(|k| {
            block(
                voussoir(k as f64 * step, (k + 1) as f64 * step),
                Motion::Free,
            )
        })
        .collect();
    for sign in [-1.0, 1.0] {
        let (a, b): (f64, f64) = (sign * 8.0, sign * 12.0);
        definitions.push(block(
            cuboid([a.min(b), -1.0, -1.0], [a.max(b), 2.0, 0.0]),
            Motion::Fixed,
        ));
    }
    definitions
}

/// Fall of the crown in the given time, at least 3 s, or until it has fallen by half a meter; m.
fn crown_falls(thickness: f64, time: f64) -> f64 {
    let material = Material {
        // No sliding: the arch fails by hinges.
        friction_angle: 1.2,
        // The thrust line keeps from the edge by a third of what its pressure wets: with 2e10 N/m the arch
        // needs 5 % more thickness.
        contact_stiffness: 2e11,
        restitution: 0.3,
        ..rock()
    };
    // a third of the steps
    let settings = Settings {
        gravity: down(),
        step_bound: StepBound::Eigenvalues,
        ..Settings::default()
    };
    let mut blocks = Blocks::new(arch(24, thickness), vec![material], settings).unwrap();
    let crown = |b: &Blocks| 0.5 * (b.centroid(11).z + b.centroid(12).z);
    let start = crown(&blocks);
    let (mut now, mut n) = (0.0, 0);
    while now < time {
        let dt = blocks.critical_time_step().dt.min(1e-2);
        blocks.advance(now, dt, 1).unwrap();
        now += dt;
        n += 1;
        if n % 100 == 0 && start - crown(&blocks) > 0.5 {
            break;
        }
    }
    start - crown(&blocks)
}

/// A semicircular arch stands down to a thickness of 0.1075 of its radius (Milankovitch 1907, Heyman 1969), within 3 %.
#[test]
fn thinnest_arch() {
    let (stands, falls) = (
        crown_falls(1.03 * 0.1075, 12.0),
        crown_falls(0.97 * 0.1075, 12.0),
    );
    println!("crown sinks {stands:.4} m at 1.03 of the least thickness, {falls:.4} m at 0.97");
    assert!(stands < 0.05 && falls > 0.5, "{stands} {falls}");
}

/// Energy after a thousand frictionless bounces with restitution 1, a flat cube and a sphere, over that at the start.
#[test]
fn thousand_bounces() {
    for is_ball in [false, true] {
        let material = Material {
            friction_angle: 0.0,
            restitution: 1.0,
            contact_stiffness: 1e8,
            shear_damping_ratio: 0.0,
            ..rock()
        };
        let dropped = if is_ball {
            ball(Vec3::new(0.0, 0.0, 0.55), 0.5)
        } else {
            block(cuboid([-0.5, -0.5, 0.05], [0.5, 0.5, 1.05]), Motion::Free)
        };
        let settings = Settings::default();
        let mut blocks = Blocks::new(vec![floor(), dropped], vec![material], settings).unwrap();
        let energy = |b: &Blocks| {
            let e = b.energies();
            e.kinetic + e.potential - b.mass(1) * G * 0.5
        };
        let start = energy(&blocks);
        let (mut bounces, mut before, mut worst) = (0, 0.0, 0.0_f64);
        while bounces < 1000 {
            // A hundred steps to a contact of π √(m/K).
            let dt = std::f64::consts::PI * (blocks.mass(1) / 1e8).sqrt() / 100.0;
            let dt = dt.min(blocks.critical_time_step().dt);
            blocks.advance(0.0, dt, 1).unwrap();
            let v = blocks.velocity(1).z;
            // In free flight, at the top.
            if before > 0.0 && v <= 0.0 {
                bounces += 1;
                worst = worst.max((energy(&blocks) / start - 1.0).abs());
            }
            before = v;
        }
        assert_below(
            &format!("energy after 1000 bounces, ball {is_ball}"),
            worst,
            1e-3,
        );
    }
}

/// The same by the solver's own steps, which differ from before a hit to within it: a flat cube that lost or gained by where
/// in a step it met and left the floor gained 0.6 % a bounce, and the ledger missed 2.6 %. On a slab, and on a surface of
/// triangles. What is left, of both, is a loss of 5e-4 a bounce, (ω dt)²/250 with the ω dt = 0.37 of these steps.
#[test]
fn hits_at_any_step_keep_energy() {
    let ground = || {
        let corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]];
        let corners = corners.map(|[x, y]| Vec3::new(x, y, 0.0));
        let surface = Surface::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        BlockDefinition {
            shape: Shape::Surface(Arc::new(surface)),
            ..floor()
        }
    };
    for (name, ground) in [("slab", floor()), ("surface", ground())] {
        let material = Material {
            friction_angle: 0.0,
            restitution: 1.0,
            contact_stiffness: 1e8,
            ..rock()
        };
        let cube = block(cuboid([-0.2, -0.2, 0.1], [0.2, 0.2, 0.5]), Motion::Free);
        let mut blocks = blocks(vec![ground, cube], material, down());
        let brought = blocks.mass(1) * G * 0.1;
        let start = blocks.energies();
        let (mut bounces, mut before, mut worst) = (0, 0.0, 0.0_f64);
        while bounces < 100 {
            let dt = blocks.critical_time_step().dt.min(1e-3);
            blocks.advance(0.0, dt, 1).unwrap();
            let v = blocks.velocity(1).z;
            if before > 0.0 && v <= 0.0 {
                bounces += 1;
                let now = blocks.energies();
                let stored = now.kinetic + now.potential - start.kinetic - start.potential;
                worst = worst.max((stored / brought).abs());
                worst = worst.max(((now.balance() - start.balance()) / brought).abs());
            }
            before = v;
        }
        assert_below(&format!("energy after 100 bounces, {name}"), worst, 0.06);
    }
}

/// Second order in the step: a block that rocks, sways and heaves on its closed base, undamped; error of the state
/// against a step sixteen times smaller.
#[test]
fn second_order_in_the_step() {
    let state = |n: u32| {
        let material = Material {
            restitution: 1.0,
            friction_angle: 1.5,
            contact_stiffness: 1e8,
            shear_damping_ratio: 0.0,
            ..rock()
        };
        let settings = Settings::default();
        let weight = 2500.0 * 0.3 * G;
        let sunk = weight / 1e8;
        let mut stone = block(
            cuboid([-0.5, -0.5, -sunk], [0.5, 0.5, 0.3 - sunk]),
            Motion::Free,
        );
        // Small against the static overlap: no corner opens.
        stone.velocity = Vec3::new(2e-4, 1e-4, 2e-4);
        stone.angular_velocity = Vec3::new(2e-4, -3e-4, 1e-4);
        let mut blocks = Blocks::new(vec![floor(), stone], vec![material], settings).unwrap();
        run_steps(&mut blocks, 0.05, n);
        let spin = blocks.angular_velocity(1);
        (blocks.centroid(1), blocks.velocity(1), spin)
    };
    let exact = state(12_800);
    let errors: Vec<f64> = [200, 400, 800]
        .map(|n| {
            let found = state(n);
            (found.1 - exact.1).norm() + (found.2 - exact.2).norm()
        })
        .to_vec();
    for (k, pair) in errors.windows(2).enumerate() {
        let order = (pair[0] / pair[1]).log2();
        println!(
            "steps {}: error {:.3e} -> {:.3e} m/s, order {order:.3}",
            200 << k,
            pair[0],
            pair[1]
        );
        assert!((1.9..2.15).contains(&order), "{order}");
    }
}
