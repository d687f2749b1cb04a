//! The reported step bound against the true limit of random systems.

use crate::setup::*;
use nalgebra::{DMatrix, DVector};
use riprap_dda::{Blocks, Material, Motion, Settings, Vec3};

/// A pile of two to four boxes of random size on a floor, each sunk a little into the one below.
fn pile(random: &mut Random, settings: Settings) -> Option<Blocks> {
    let material = Material {
        restitution: 1.0,
        friction_angle: 1.5,
        contact_stiffness: 1e8,
        shear_stiffness_ratio: 0.3 + 0.7 * random.next(),
        rolling_friction: 0.0,
        ..rock()
    };
    let n = 2 + (random.next() * 3.0) as usize;
    let mut definitions = vec![floor()];
    let mut top = 0.0;
    for _ in 0..n {
        let half = Vec3::new(
            0.2 + random.next(),
            0.2 + random.next(),
            0.2 + random.next(),
        );
        let (x, y) = (0.2 * random.vector().x, 0.2 * random.vector().y);
        let base = top - 1e-3;
        let (from, to) = (
            [x - half.x, y - half.y, base],
            [x + half.x, y + half.y, base + half.z],
        );
        top = base + half.z;
        definitions.push(block(cuboid(from, to), Motion::Free));
    }
    Blocks::new(definitions, vec![material], settings).ok()
}

/// Largest eigenvalue of `M⁻¹K`, by power iteration on the velocities that one small undamped step gives: for
/// displacements `q`, one drift and kick changes velocities by `−dt M⁻¹K q`.
fn largest_frequency(blocks: &Blocks) -> f64 {
    let n = blocks.n_blocks() - 1;
    let dt = 1e-9;
    // Acceleration after moving by `q` from rest: drift q/dt for dt, and look at the change of velocity.
    let response = |q: &DVector<f64>| -> DVector<f64> {
        let moved = |sign: f64| {
            let mut probe = blocks.clone();
            let push: Vec<riprap_dda::Load> = (0..=n)
                .map(|b| {
                    if b == 0 {
                        return riprap_dda::Load::default();
                    }
                    let q = q.rows(6 * (b - 1), 6);
                    let (v, w) = (Vec3::new(q[0], q[1], q[2]), Vec3::new(q[3], q[4], q[5]));
                    riprap_dda::Load {
                        force: v * (sign * probe.mass(b)),
                        torque: probe.inertia(b) * w * sign,
                    }
                })
                .collect();
            probe.apply_impulse(&push, 1.0);
            let before = probe.clone();
            probe.advance(0.0, dt, 1).unwrap();
            DVector::from_iterator(
                6 * n,
                (1..=n).flat_map(|b| {
                    let dv = probe.velocity(b) - before.velocity(b);
                    let dw = probe.angular_velocity(b) - before.angular_velocity(b);
                    [dv.x, dv.y, dv.z, dw.x, dw.y, dw.z]
                }),
            )
        };
        // The step holds half a kick of the old place and half of the new; the old one cancels.
        (moved(-1.0) - moved(1.0)) / (dt * dt)
    };
    let columns: Vec<DVector<f64>> = (0..6 * n)
        .map(|k| {
            let mut q = DVector::zeros(6 * n);
            q[k] = 1.0;
            response(&q)
        })
        .collect();
    let matrix = DMatrix::from_columns(&columns);
    let eigenvalues = matrix.complex_eigenvalues();
    eigenvalues
        .iter()
        .map(|value| value.re)
        .fold(0.0, f64::max)
        .sqrt()
}

/// D21: never above the true limit 2/ω; on average at least 0.4 of it.
#[test]
fn bound_against_eigenvalues() {
    let settings = Settings {
        gravity: Vec3::zeros(),
        time_step_factor: 1.0,
        shear_damping_ratio: 0.0,
        ..Settings::default()
    };
    let mut random = Random(9);
    let (mut n, mut sum, mut largest) = (0, 0.0, 0.0_f64);
    while n < 1000 {
        let Some(blocks) = pile(&mut random, settings) else {
            continue;
        };
        let share = blocks.critical_time_step().dt / (2.0 / largest_frequency(&blocks));
        n += 1;
        sum += share;
        largest = largest.max(share);
    }
    println!(
        "bound over true limit: mean {:.4}, largest {largest:.4}",
        sum / f64::from(n)
    );
    assert!(largest <= 1.0 && sum / f64::from(n) >= 0.4);
}

/// X04: a needle of 100 : 1 : 1 above a floor may take the step that it may take on it. With a lever of half its length about
/// its own axis the step was a five-hundredth of that.
#[test]
fn a_needle_needs_no_smaller_step_before_it_touches() {
    let step = |height: f64, turn: Vec3| {
        let needle = cuboid([-0.5, -0.005, -0.005], [0.5, 0.005, 0.005]);
        let placed = needle.transformed(&riprap_dda::Isometry::new(Vec3::zeros(), turn));
        let low = placed.aabb().0.z;
        let placed = placed.transformed(&riprap_dda::Isometry::translation(0.0, 0.0, height - low));
        let needle = block(placed, Motion::Free);
        let bound = blocks(vec![floor(), needle], rock(), Vec3::zeros()).critical_time_step();
        bound.dt
    };
    for turn in [Vec3::zeros(), Vec3::y() * 0.3, Vec3::new(0.2, 0.3, 0.1)] {
        let (before, on_it) = (step(1e-4, turn), step(-1e-4, turn));
        println!("turned {turn:?}: {before:.2e} s before, {on_it:.2e} s after it touches");
        // an impact may never come as a surprise, nor be feared without need: the sum over three directions at the worst corner is
        // 3 to 9 times what one contact has
        assert!(before <= on_it && on_it < 30.0 * before);
    }
}
