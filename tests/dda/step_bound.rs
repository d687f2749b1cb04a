//! The reported step bound against the true limit of random systems.

use crate::setup::*;
use nalgebra::{DMatrix, DVector};
use riprap_dda::{BlockDefinition, Blocks, Isometry, Material, Motion, Settings, StepBound, Vec3};

/// The power iteration is good to 1 % where the stiffest motions are alike.
const LIMIT_ERROR: f64 = 0.01;

/// A pile of two to four boxes of random size on a floor, each sunk a little into the one below.
fn pile(random: &mut Random, settings: Settings) -> Option<Blocks> {
    let material = Material {
        restitution: 1.0,
        friction_angle: 1.5,
        contact_stiffness: 1e8,
        shear_stiffness_ratio: 0.3 + 0.7 * random.next(),
        shear_damping_ratio: 0.0,
        rolling_friction: 0.0,
        twisting_friction: 0.0,
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

/// D21: never above the true limit 2/ω; on average at least 0.4 of it, by the eigenvalues of the blocks at least 0.7. The
/// reported limit is that one.
#[test]
fn bounds_against_the_true_limit() {
    assert_bound_of(StepBound::Compliances, 0.4);
    assert_bound_of(StepBound::Eigenvalues, 0.7);
}

fn assert_bound_of(step_bound: StepBound, least_mean: f64) {
    let settings = Settings {
        step_bound,
        gravity: Vec3::zeros(),
        time_step_factor: 1.0,
        ..Settings::default()
    };
    let mut random = Random::new(9);
    let (mut n, mut sum, mut largest, mut error) = (0, 0.0, 0.0_f64, 0.0_f64);
    while n < 1000 {
        let Some(blocks) = pile(&mut random, settings) else {
            continue;
        };
        let limit = 2.0 / largest_frequency(&blocks);
        let share = blocks.critical_time_step().dt / limit;
        error = error.max((blocks.stability_limit() / limit - 1.0).abs());
        n += 1;
        sum += share;
        largest = largest.max(share);
    }
    println!(
        "{step_bound:?} over true limit: mean {:.4}, largest {largest:.4}; reported limit off by at most {error:.1e}",
        sum / f64::from(n)
    );
    assert!(largest <= 1.0 && sum / f64::from(n) >= least_mean);
    assert!(error < LIMIT_ERROR);
}

/// Bodies of shear stiffness 0.8 on a floor at the height 0, without shear damping.
fn resting(mut bodies: Vec<BlockDefinition>, restitution: f64) -> Blocks {
    let material = Material {
        restitution,
        shear_damping_ratio: 0.0,
        ..rock()
    };
    let settings = Settings {
        gravity: Vec3::zeros(),
        time_step_factor: 1.0,
        ..Settings::default()
    };
    bodies.insert(0, floor());
    Blocks::new(bodies, vec![material], settings).unwrap()
}

/// A sphere that rolls to and fro on its shear spring: `ω² = 0.8 K (1/m + r²/J) = 2.8 K/m`.
#[test]
fn limit_of_a_ball_is_that_of_its_rolling() {
    let blocks = resting(vec![ball(Vec3::z() * (0.5 - 1e-6), 0.5)], 1.0);
    let expected = 2.0 * (blocks.mass(1) / (2.8 * rock().contact_stiffness)).sqrt();
    // the point of contact is half of the overlap off
    assert_close("limit", blocks.stability_limit(), expected, 1e-5);
    assert!(blocks.critical_time_step().dt < blocks.stability_limit());
}

/// Cubes on each other, the floor under the lowest: the fastest of heave, `ω = 2 √(K/m) sin(π (n − ½)/(2n + 1))`,
/// is slower than what their corners do; no bound of a block may be above the limit.
#[test]
fn limit_of_a_column_lies_between_its_heave_and_the_bound() {
    let n = 5_u32;
    let cube = |k: u32| {
        let low = f64::from(k) - 1e-6 * f64::from(k + 1);
        block(cuboid([0.0, 0.0, low], [1.0, 1.0, low + 1.0]), Motion::Free)
    };
    let blocks = resting((0..n).map(cube).collect(), 1.0);
    let mode = std::f64::consts::PI * (f64::from(n) - 0.5) / f64::from(2 * n + 1);
    let heave = (blocks.mass(1) / rock().contact_stiffness).sqrt() / mode.sin();
    let (limit, bound) = (blocks.stability_limit(), blocks.critical_time_step().dt);
    println!("bound {bound:.4e} s, limit {limit:.4e} s, heave {heave:.4e} s");
    assert!(limit < heave * (1.0 + 1e-9));
    assert!(2.0 * bound < limit && limit < 3.0 * bound);
}

/// One mode with a critical dashpot bears `√2 − 1` of the step without; here the dashpot lies along the normal.
#[test]
fn dashpots_shorten_the_limit() {
    let with = |restitution: f64| {
        let blocks = resting(vec![ball(Vec3::z() * (0.5 - 1e-6), 0.5)], restitution);
        (blocks.stability_limit(), blocks.mass(1))
    };
    let ((free, mass), (damped, _)) = (with(1.0), with(0.0));
    let heave = 2.0 * (mass / rock().contact_stiffness).sqrt() * (2.0_f64.sqrt() - 1.0);
    assert!(damped < free);
    // the power iteration is good to 1 %
    assert_close("limit", damped, heave, 0.01);
}

/// X04: a needle of 100 : 1 : 1 above a floor may take the step that it may take on it. With a lever of half its length about
/// its own axis the step was a five-hundredth of that.
#[test]
fn a_needle_needs_no_smaller_step_before_it_touches() {
    let step = |height: f64, turn: Vec3| {
        let needle = cuboid([-0.5, -0.005, -0.005], [0.5, 0.005, 0.005]);
        let placed = needle.transformed(&Isometry::new(Vec3::zeros(), turn));
        let low = placed.aabb().0.z;
        let placed = placed.transformed(&Isometry::translation(0.0, 0.0, height - low));
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

/// A cube in flight may move half the margin of its box in a step, whatever its speed, and the step says that it is held by that; one on the
/// floor is held by its contact.
#[test]
fn a_step_says_whether_speed_or_a_contact_holds_it() {
    let step = |height: f64, speed: f64| {
        let mut cube = block(
            cuboid([0.0, 0.0, height], [1.0, 1.0, height + 1.0]),
            Motion::Free,
        );
        cube.velocity = Vec3::x() * speed;
        blocks(vec![floor(), cube], rock(), Vec3::zeros()).critical_time_step()
    };
    let (slow, fast) = (step(10.0, 1e3), step(10.0, 2e3));
    assert_close("way", fast.dt * 2e3, slow.dt * 1e3, 1e-12);
    assert!(slow.is_by_speed && fast.is_by_speed);
    assert_eq!((slow.block, slow.contact), (Some(1), None));
    let on_the_floor = step(-1e-4, 0.0);
    assert!(!on_the_floor.is_by_speed);
    assert_eq!(on_the_floor.contact, Some((0, 1)));
}

/// 27 bodies that fall into a bin, until a time (s): number of steps, and kinetic energy at the end over all that was lost. The step stays
/// below the limit of all contacts together, and the ledger closes.
fn fall(
    (step_bound, until, largest_error): (StepBound, f64, f64),
    material: Material,
    body: impl Fn(&mut Random, Vec3) -> BlockDefinition,
) -> (u32, f64) {
    let mut random = Random::new(3);
    let mut definitions = vec![
        floor(),
        block(cuboid([-3.0, -3.0, 0.0], [-2.0, 3.0, 9.0]), Motion::Fixed),
        block(cuboid([2.0, -3.0, 0.0], [3.0, 3.0, 9.0]), Motion::Fixed),
        block(cuboid([-3.0, -3.0, 0.0], [3.0, -2.0, 9.0]), Motion::Fixed),
        block(cuboid([-3.0, 2.0, 0.0], [3.0, 3.0, 9.0]), Motion::Fixed),
    ];
    for k in 0..27 {
        let (x, y, z) = (k % 3, k / 3 % 3, k / 9);
        let place = |n: i32| 1.3 * f64::from(n);
        let at = Vec3::new(place(x) - 1.3, place(y) - 1.3, place(z) + 1.0);
        definitions.push(body(&mut random, at));
    }
    let settings = Settings {
        step_bound,
        ..Settings::default()
    };
    let mut blocks = Blocks::new(definitions, vec![material], settings).unwrap();
    let (mut time, mut n_steps, mut largest) = (0.0, 0, 0.0_f64);
    let before = ledger(&blocks.energies());
    while time < until {
        let dt = blocks.critical_time_step().dt.min(2e-3);
        if n_steps % 100 == 0 {
            // the factor is 0.8
            largest = largest.max(dt / 0.8 / blocks.stability_limit());
        }
        blocks.advance(time, dt, 1).unwrap();
        time += dt;
        n_steps += 1;
    }
    let energies = blocks.energies();
    let dissipated = energies.friction + energies.damping;
    let error = (ledger(&energies) - before) / dissipated;
    let kinetic = energies.kinetic / dissipated;
    println!(
        "{step_bound:?}: {n_steps} steps, {largest:.2} of the limit, ledger {error:.1e} of what is lost, {kinetic:.1e} still in motion"
    );
    assert!(largest <= 1.0 + LIMIT_ERROR);
    assert_below("ledger", error.abs(), largest_error);
    (n_steps, kinetic)
}

/// Hulls with friction and restitution: by the eigenvalues more than twice the step that compliances allow.
#[test]
fn a_heap_of_hulls_needs_half_the_steps() {
    let material = Material {
        restitution: 0.5,
        ..rock()
    };
    let hull = |random: &mut Random, at: Vec3| {
        let there = Isometry::translation(at.x, at.y, at.z);
        block(random.hull().transformed(&there), Motion::Free)
    };
    let [compliances, eigenvalues] = [StepBound::Compliances, StepBound::Eigenvalues]
        .map(|bound| fall((bound, 1.5, 0.003), material, hull).0);
    assert!(2 * eigenvalues < compliances);
}

/// Spheres that resist rolling as much as angular rock does: by the eigenvalues half the steps, and they come to rest but for a spin about
/// single contacts, which nothing resists.
#[test]
fn a_heap_of_spheres_that_hardly_roll_needs_half_the_steps() {
    let material = Material {
        restitution: 0.3,
        rolling_friction: 1.0,
        ..rock()
    };
    let sphere = |random: &mut Random, at: Vec3| {
        let center = at + random.vector() * 0.1;
        ball(center, 0.4 + 0.1 * random.next())
    };
    let [compliances, eigenvalues] =
        [StepBound::Compliances, StepBound::Eigenvalues].map(|bound| {
            // 0.12 % of what is lost by the shorter steps: where springs against rolling break, the error is that of the step
            let (n_steps, kinetic) = fall((bound, 4.0, 0.015), material, sphere);
            assert_below("kinetic energy", kinetic, 2e-3);
            n_steps
        });
    assert!(2 * eigenvalues < compliances);
}

/// A lattice of spheres that do not quite touch, let go above a floor: with nothing to bound the step at the start, it may not grow so much
/// that they meet deep inside each other.
#[test]
fn a_lattice_that_nothing_touches_meets_in_short_steps() {
    let mut definitions = vec![floor()];
    for k in 0..64 {
        let place = Vec3::new(f64::from(k % 4), f64::from(k / 4 % 4), f64::from(k / 16));
        definitions.push(ball(place * 1.003 + Vec3::z() * 0.503, 0.5));
    }
    let settings = Settings {
        gravity: on_slope(0.6),
        step_bound: StepBound::Eigenvalues,
        ..Settings::default()
    };
    let mut blocks = Blocks::new(definitions, vec![rock()], settings).unwrap();
    let before = ledger(&blocks.energies());
    let mut time = 0.0;
    while time < 0.5 {
        let dt = blocks.critical_time_step().dt.min(0.02);
        blocks.advance(time, dt, 1).unwrap();
        time += dt;
    }
    let energies = blocks.energies();
    let moved = energies.friction + energies.damping + energies.kinetic;
    // of second order in a step of a twentieth of a contact
    let error = (ledger(&energies) - before).abs() / moved;
    assert_below("ledger", error, 0.01);
}

/// Sixteen spheres at rest on a floor, and two that roll away from them at a speed (m/s).
fn spheres_at_rest_beside_rolling_ones(speed: f64, step_bound: StepBound) -> Blocks {
    let mut definitions = vec![floor()];
    for k in 0..16 {
        let place = Vec3::new(f64::from(k % 4), f64::from(k / 4), 0.0);
        definitions.push(ball(place * 0.1 + Vec3::z() * 0.05, 0.05));
    }
    for y in [-1.0, 1.0] {
        let mut rolling = ball(Vec3::new(1.0, y, 0.05), 0.05);
        rolling.velocity = Vec3::x() * speed;
        rolling.angular_velocity = Vec3::y() * (speed / 0.05);
        definitions.push(rolling);
    }
    let material = Material {
        contact_stiffness: 1e6,
        ..rock()
    };
    let settings = Settings {
        step_bound,
        ..Settings::default()
    };
    Blocks::new(definitions, vec![material], settings).unwrap()
}

/// Spheres that race away from a heap, as grains do that have passed a barrier, do not hold its step.
#[test]
fn a_few_fast_spheres_do_not_hold_the_step() {
    for step_bound in [StepBound::Compliances, StepBound::Eigenvalues] {
        let mean_step = |speed: f64| {
            let mut blocks = spheres_at_rest_beside_rolling_ones(speed, step_bound);
            let mut time = 0.0;
            for _ in 0..200 {
                let dt = blocks.critical_time_step().dt;
                blocks.advance(time, dt, 1).unwrap();
                time += dt;
            }
            assert!(blocks.n_contacts() > 16, "{}", blocks.n_contacts());
            time / 200.0
        };
        let (slow, fast) = (mean_step(0.0), mean_step(20.0));
        println!("{step_bound:?}: steps of {slow:.3e} and {fast:.3e} s");
        // 20 m/s times such a step are less than a quarter of the largest margin; a share of the margin at rest was 0.1 ms
        assert!(slow * 20.0 < 0.0085, "{slow}");
        // a dozen steps go by until margins have grown
        assert_close("step", fast, slow, 0.02);
    }
}

/// A gas of spheres that bounce without loss in a box, with the margins of fast spheres at work: what is not listed in time, or not
/// counted in the step, would make energy.
#[test]
fn a_gas_of_fast_spheres_keeps_its_energy() {
    let wall = |from: [f64; 3], to: [f64; 3]| block(cuboid(from, to), Motion::Fixed);
    let mut definitions = vec![
        wall([-1.2, -1.2, -1.2], [1.2, 1.2, -1.0]),
        wall([-1.2, -1.2, 1.0], [1.2, 1.2, 1.2]),
        wall([-1.2, -1.2, -1.0], [1.2, -1.0, 1.0]),
        wall([-1.2, 1.0, -1.0], [1.2, 1.2, 1.0]),
        wall([-1.2, -1.0, -1.0], [-1.0, 1.0, 1.0]),
        wall([1.0, -1.0, -1.0], [1.2, 1.0, 1.0]),
    ];
    let mut random = Random::new(7);
    for k in 0..125 {
        let place = Vec3::new(f64::from(k % 5), f64::from(k / 5 % 5), f64::from(k / 25));
        let center = (place - Vec3::repeat(2.0)) * 0.4 + random.vector() * 0.05;
        let mut sphere = ball(center, 0.05 + 0.03 * random.next());
        // most are slow, every fifth is fast
        sphere.velocity = random.vector() * if k % 5 == 0 { 40.0 } else { 0.5 };
        definitions.push(sphere);
    }
    let material = Material {
        restitution: 1.0,
        friction_angle: 0.0,
        contact_stiffness: 1e8,
        shear_damping_ratio: 0.0,
        ..rock()
    };
    for step_bound in [StepBound::Compliances, StepBound::Eigenvalues] {
        let settings = Settings {
            gravity: Vec3::zeros(),
            step_bound,
            ..Settings::default()
        };
        let mut blocks = Blocks::new(definitions.clone(), vec![material], settings).unwrap();
        let before = ledger(&blocks.energies());
        let (mut time, mut steps, mut worst) = (0.0, 0, 0.0_f64);
        while time < 0.5 {
            let dt = blocks.critical_time_step().dt.min(0.5e-3);
            blocks.advance(time, dt, 1).unwrap();
            (time, steps) = (time + dt, steps + 1);
            worst = worst.max((ledger(&blocks.energies()) - before).abs() / before);
        }
        println!(
            "{step_bound:?}: {steps} steps, {} contact updates, {:.2e} of the energy at the end",
            blocks.contact_updates(),
            (ledger(&blocks.energies()) - before) / before
        );
        assert!(blocks.contact_updates() > 1000);
        assert_below(&format!("energy, {step_bound:?}"), worst, 0.01);
    }
}
