//! Balls: contact laws, friction, rolling, conservation (G01 to G07, G09, G10).

use crate::setup::{
    G, Random, assert_below, assert_close, ball, block, blocks, cuboid, down, floor, ledger,
    moving, on_slope, rock, run,
};
use nalgebra::UnitQuaternion;
use riprap_dda::{
    BlockError, Blocks, Elastic, Energies, JointOverride, Material, Motion, NormalLaw, Settings,
    Vec3,
};

/// Balls slip and roll: stiff, with springs of equal half-periods.
fn glass() -> Material {
    Material {
        contact_stiffness: 1e6,
        shear_stiffness_ratio: 2.0 / 7.0,
        ..rock()
    }
}

/// Ends of an impact on the floor at 1 m/s: rebound, duration, deepest overlap.
fn impact(material: &Material, law: NormalLaw, speed: f64, share: f64) -> (f64, f64, f64) {
    let radius = 0.5;
    let settings = Settings {
        gravity: Vec3::zeros(),
        normal_law: law,
        ..Settings::default()
    };
    let start = ball(Vec3::new(0.0, 0.0, radius + 1e-6), radius);
    let bodies = vec![floor(), moving(start, [0.0, 0.0, -speed])];
    let mut system = Blocks::new(bodies, vec![*material], settings).unwrap();
    let (mut time, mut touching, mut deepest) = (0.0, 0.0, 0.0_f64);
    let mut has_touched = false;
    loop {
        let dt = share * system.critical_time_step().dt;
        system.advance(time, dt, 1).unwrap();
        time += dt;
        let overlap = radius - system.centroid(1).z;
        deepest = deepest.max(overlap);
        if system.contacts().iter().any(|c| c.normal_force > 0.0) {
            has_touched = true;
            touching += dt;
        } else if has_touched {
            return (system.velocity(1).z / speed, touching, deepest);
        }
    }
}

#[test]
fn linear_impact() {
    let mass: f64 = 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.125;
    let period = std::f64::consts::PI * (mass / 1e6).sqrt();
    for (restitution, tolerance) in [(1.0, 1e-3), (0.8, 1e-3), (0.5, 1e-3), (0.2, 1e-3)] {
        let material = Material {
            restitution,
            ..glass()
        };
        let (rebound, duration, deepest) = impact(&material, NormalLaw::Linear, 1.0, 0.01);
        assert_close(
            &format!("e = {restitution}"),
            rebound,
            restitution,
            tolerance,
        );
        if restitution == 1.0 {
            // Seen in steps of a hundredth of the limit: about period/400.
            assert_close("duration", duration, period, 5e-3);
            assert_close("overlap", deepest, (mass / 1e6).sqrt(), 1e-3);
        }
    }
}

#[test]
fn hertz_impact_at_any_speed() {
    let elastic = Elastic {
        young_modulus: 2e7,
        poisson_ratio: 0.0,
        viscosity: 0.0,
    };
    for restitution in [0.2, 0.5, 0.9] {
        let material = Material {
            restitution,
            elastic: Some(elastic),
            ..glass()
        };
        for speed in [0.01, 1.0] {
            let (rebound, ..) = impact(&material, NormalLaw::Hertz, speed, 0.004);
            assert_close(
                &format!("e = {restitution} at {speed} m/s"),
                rebound,
                restitution,
                1e-3,
            );
        }
    }
    // m = 1 kg, R = 0.5 m, E* = 1e7 Pa: 1.774167e-3 m in 5.22166e-3 s.
    let material = Material {
        density: 1.0 / (4.0 / 3.0 * std::f64::consts::PI * 0.125),
        restitution: 1.0,
        elastic: Some(elastic),
        ..glass()
    };
    let (rebound, duration, deepest) = impact(&material, NormalLaw::Hertz, 1.0, 0.002);
    assert_close("elastic", rebound, 1.0, 1e-3);
    assert_close("overlap", deepest, 1.774_167e-3, 1e-3);
    assert_close("duration", duration, 5.221_66e-3, 1e-3);
}

/// Ball of 0.5 m at rest on the floor, sunk in by its weight.
fn resting(material: Material, gravity: Vec3, velocity: [f64; 3], spin: [f64; 3]) -> Blocks {
    let mass = material.density * 4.0 / 3.0 * std::f64::consts::PI * 0.125;
    let sunk = mass * -gravity.z / material.contact_stiffness;
    let mut start = moving(ball(Vec3::new(0.0, 0.0, 0.5 - sunk), 0.5), velocity);
    start.angular_velocity = spin.into();
    blocks(vec![floor(), start], material, gravity)
}

#[test]
fn sliding_ball_begins_to_roll() {
    let material = Material {
        friction_angle: 0.3_f64.atan(),
        contact_stiffness: 1e8,
        ..glass()
    };
    let mut system = resting(material, down(), [2.0, 0.0, 0.0], [0.0; 3]);
    let mut time = 0.0;
    let dt = 0.1 * system.critical_time_step().dt;
    // It rolls when its lowest point stands still.
    while system.velocity(1).x - 0.5 * system.angular_velocity(1).y > 1e-3 {
        system.advance(time, dt, 1).unwrap();
        time += dt;
    }
    assert_close("time", time, 2.0 / 7.0 * 2.0 / (0.3 * G), 5e-3);
    assert_close("way", system.centroid(1).x, 0.332_855, 5e-3);
    run(&mut system, 0.5, 0.5, 1.0);
    assert_close("speed", system.velocity(1).x, 10.0 / 7.0, 5e-3);
}

/// A joint between materials 0 and 1.
fn joint(change: impl Fn(&mut JointOverride)) -> JointOverride {
    let mut joint = JointOverride {
        materials: (1, 0),
        ..JointOverride::default()
    };
    change(&mut joint);
    joint
}

/// A ball of material 1 on a floor of material 0, both as given, and what they make of each other.
fn on_floor(
    material: Material,
    law: NormalLaw,
    velocity: [f64; 3],
    joints: &[JointOverride],
) -> Result<Blocks, BlockError> {
    let mass = material.density * 4.0 / 3.0 * std::f64::consts::PI * 0.125;
    let sunk = mass * G / material.contact_stiffness;
    let mut start = moving(ball(Vec3::new(0.0, 0.0, 0.5 - sunk), 0.5), velocity);
    start.material = 1;
    let settings = Settings {
        normal_law: law,
        ..Settings::default()
    };
    Blocks::with_joints(
        vec![floor(), start],
        vec![material, material],
        joints,
        settings,
    )
}

#[test]
fn a_joint_of_two_materials_overrides_theirs() {
    let material = Material {
        friction_angle: 0.3_f64.atan(),
        contact_stiffness: 1e8,
        ..glass()
    };
    // Sliding: dv/dt = −μ g, while the ball turns faster and faster.
    for (joints, friction) in [
        (vec![], 0.3),
        (
            vec![joint(|j| j.friction_angle = Some(0.6_f64.atan()))],
            0.6,
        ),
        (
            vec![joint(|j| j.residual_friction_angle = Some(0.1_f64.atan()))],
            0.1,
        ),
    ] {
        let mut system = on_floor(material, NormalLaw::Linear, [9.0, 0.0, 0.0], &joints).unwrap();
        run(&mut system, 0.2, 0.5, 1.0);
        let slowed = (9.0 - system.velocity(1).x) / 0.2;
        assert_close("deceleration", slowed, friction * G, 1e-3);
    }
    // Rolling, where no material resists it.
    let joints = [joint(|j| j.rolling_friction = Some(0.0678))];
    let mut system = on_floor(material, NormalLaw::Linear, [1.0, 0.0, 0.0], &joints).unwrap();
    run(&mut system, 0.5, 0.5, 1.0);
    let rolling = 5.0 / 7.0 * 0.0678 * G;
    let before = system.velocity(1).x;
    run(&mut system, 0.5, 0.5, 1.0);
    let slowed = (before - system.velocity(1).x) / 0.5;
    assert_close("rolling deceleration", slowed, rolling, 1e-2);
}

#[test]
fn restitution_of_a_joint_holds_for_balls_and_boxes() {
    let material = Material {
        restitution: 0.2,
        elastic: Some(Elastic {
            young_modulus: 2e8,
            poisson_ratio: 0.0,
            viscosity: 0.0,
        }),
        ..glass()
    };
    let joints = [joint(|j| j.restitution = Some(0.7))];
    let settings = |law| Settings {
        gravity: Vec3::zeros(),
        normal_law: law,
        ..Settings::default()
    };
    let body = cuboid([-0.5, -0.5, 1e-6], [0.5, 0.5, 1.0]);
    for (what, law, start) in [
        (
            "linear ball",
            NormalLaw::Linear,
            ball(Vec3::new(0.0, 0.0, 0.5 + 1e-6), 0.5),
        ),
        (
            "Hertz ball",
            NormalLaw::Hertz,
            ball(Vec3::new(0.0, 0.0, 0.5 + 1e-6), 0.5),
        ),
        ("box", NormalLaw::Linear, block(body, Motion::Free)),
    ] {
        let mut start = moving(start, [0.0, 0.0, -1.0]);
        start.material = 1;
        let bodies = vec![floor(), start];
        let materials = vec![material, material];
        let mut system = Blocks::with_joints(bodies, materials, &joints, settings(law)).unwrap();
        run(&mut system, 1.0, 0.01, 1e-3);
        assert_close(what, system.velocity(1).z, 0.7, 3e-3);
    }
}

/// One ball on three. A ball of the base turns about its foot unless the push from above goes through it, at half the
/// angle θ = asin(1/√3) of the upper contact to the vertical: μ ≥ tan(θ/2) = 0.3178 between the balls. The floor is
/// rougher, as it needs less.
#[test]
fn four_balls_stand_by_friction_alone() {
    for (friction, stands) in [(0.31, false), (0.325, true)] {
        let material = Material {
            friction_angle: f64::atan(friction),
            restitution: 0.3,
            ..glass()
        };
        let joints = [joint(|j| j.friction_angle = Some(0.6_f64.atan()))];
        let radius = 0.1;
        let off = 2.0 * radius / 3.0_f64.sqrt();
        let height = radius + (4.0 * radius * radius - off * off).sqrt();
        let mut bodies = vec![floor(), ball(Vec3::new(0.0, 0.0, height), radius)];
        for k in 0..3 {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 3.0).sin_cos();
            bodies.push(ball(Vec3::new(off * cos, off * sin, radius), radius));
        }
        for body in &mut bodies[1..] {
            body.material = 1;
        }
        let materials = vec![material, material];
        let mut system =
            Blocks::with_joints(bodies, materials, &joints, Settings::default()).unwrap();
        run(&mut system, 3.0, 1.0, 1.0);
        let sunk = (height - system.centroid(1).z) / radius;
        println!("friction {friction}: the top has sunk by {sunk:.2e} radii");
        if stands {
            // measured 3.0e-3: springs, m g/K = 1.0e-3 radii
            assert_below("sunk", sunk, 5e-3);
        } else {
            assert!(sunk > 1.0);
        }
    }
}

#[test]
fn unusable_joints_are_refused() {
    let refused = |joints: &[JointOverride]| {
        let error = on_floor(glass(), NormalLaw::Linear, [0.0; 3], joints).unwrap_err();
        error.to_string()
    };
    let good = joint(|j| j.cohesion = Some(1.0));
    let swapped = JointOverride {
        materials: (0, 1),
        ..good
    };
    for (joints, expected) in [
        (
            vec![joint(|j| j.materials = (0, 2))],
            "joint override 0 is unusable: there is no such material",
        ),
        (
            vec![good, swapped],
            "joint override 1 is unusable: its two materials have one already",
        ),
        (
            vec![joint(|j| j.restitution = Some(1.5))],
            "joint override 0: restitution is 1.5, must be in [0, 1]",
        ),
        (
            vec![joint(|j| j.rolling_friction = Some(f64::NAN))],
            "joint override 0: rolling_friction is NaN, must be >= 0",
        ),
        // The materials' 0.5 rad holds.
        (
            vec![joint(|j| j.residual_friction_angle = Some(0.6))],
            "joint override 0: residual_friction_angle is 0.6, must be in [0, friction_angle] rad",
        ),
    ] {
        assert_eq!(refused(&joints), expected);
    }
}

#[test]
fn rolling_down_and_resting_on_a_slope() {
    let material = Material {
        friction_angle: 0.6_f64.atan(),
        rolling_friction: 0.0678,
        contact_stiffness: 1e8,
        ..glass()
    };
    let angle = 20.0_f64.to_radians();
    let mut system = resting(material, on_slope(angle), [0.0; 3], [0.0; 3]);
    run(&mut system, 1.0, 0.5, 1.0);
    let expected = 5.0 / 7.0 * G * (angle.sin() - 0.0678 * angle.cos());
    assert_close("way", system.centroid(1).x, 0.5 * expected, 5e-3);
    assert_close("speed", system.velocity(1).x, expected, 5e-3);
    // Below atan(μ_r) it rests.
    let mut system = resting(material, on_slope(3.5_f64.to_radians()), [0.0; 3], [0.0; 3]);
    run(&mut system, 2.0, 0.8, 1.0);
    let before = system.centroid(1).x;
    run(&mut system, 2.0, 0.8, 1.0);
    assert_below(
        "drift in 2 s",
        (system.centroid(1).x - before).abs(),
        2.0 * 0.5e-4 * 0.5,
    );
}

#[test]
fn rolling_ball_stops() {
    let material = Material {
        friction_angle: 0.6_f64.atan(),
        rolling_friction: 0.0678,
        contact_stiffness: 1e8,
        ..glass()
    };
    let mut system = resting(material, down(), [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
    // 2.1 s of rolling, then the rolling spring rings out.
    run(&mut system, 6.0, 0.8, 1.0);
    let expected = 1.0 / (2.0 * 5.0 / 7.0 * 0.0678 * G);
    assert_close("way", system.centroid(1).x, expected, 1e-2);
    assert_below("speed", system.velocity(1).norm(), 1e-4);
}

#[test]
fn full_stick_turns_the_tangential_speed_round() {
    // Equal half-periods of heave and shear: k_t = 2/7 k_n. The bed has no weight to move.
    let material = Material {
        friction_angle: 1.55,
        restitution: 1.0,
        // Soft springs turn the ball about the middle of the overlap, not about its surface.
        contact_stiffness: 1e10,
        ..glass()
    };
    let settings = Settings {
        gravity: Vec3::zeros(),
        shear_damping_ratio: 0.0,
        ..Settings::default()
    };
    let start = ball(Vec3::new(0.0, 0.0, 0.5 + 1e-6), 0.5);
    let bodies = vec![floor(), moving(start, [0.3, 0.0, -1.0])];
    let mut system = Blocks::new(bodies, vec![material], settings).unwrap();
    run(&mut system, 0.01, 0.02, 1.0);
    let at_surface = system.velocity(1).x - 0.5 * system.angular_velocity(1).y;
    assert_close("tangential", at_surface, -0.3, 1e-2);
    assert_close("normal", system.velocity(1).z, 1.0, 1e-3);
}

/// Three balls that collide, slide and roll on each other.
fn collision(turn: &UnitQuaternion<f64>) -> Blocks {
    let material = Material {
        restitution: 0.5,
        rolling_friction: 0.05,
        ..glass()
    };
    let mut bodies = vec![
        moving(ball(Vec3::new(-0.55, 0.1, 0.0), 0.5), [3.0, 0.0, 0.2]),
        moving(ball(Vec3::new(0.4, 0.0, 0.05), 0.4), [-1.0, 0.5, 0.0]),
        moving(ball(Vec3::new(0.0, 0.85, 0.1), 0.3), [0.0, -2.0, 0.0]),
    ];
    for (k, body) in bodies.iter_mut().enumerate() {
        body.angular_velocity = turn * Vec3::new(3.0, -2.0, 5.0 - k as f64);
        body.velocity = turn * body.velocity;
        if let riprap_dda::Shape::Sphere { center, .. } = &mut body.shape {
            *center = turn * *center;
        }
    }
    let settings = Settings {
        gravity: Vec3::zeros(),
        ..Settings::default()
    };
    Blocks::new(bodies, vec![material], settings).unwrap()
}

fn angular_momentum(system: &Blocks) -> Vec3 {
    (0..system.n_blocks())
        .map(|b| {
            system.spin_momentum(b) + system.centroid(b).cross(&system.velocity(b)) * system.mass(b)
        })
        .sum()
}

#[test]
fn collisions_conserve_momentum_and_close_the_ledger() {
    let mut system = collision(&UnitQuaternion::identity());
    let scale = (0..3).map(|b| system.mass(b) * 3.0).sum::<f64>();
    let (momentum, angular) = (system.momentum(), angular_momentum(&system));
    let energies = system.energies();
    let start = ledger(&energies);
    run(&mut system, 0.5, 0.2, 1.0);
    assert!(system.contact_updates() > 100, "they never met");
    assert_below(
        "momentum",
        (system.momentum() - momentum).norm() / scale,
        1e-12,
    );
    assert_below(
        "angular",
        (angular_momentum(&system) - angular).norm() / scale,
        1e-12,
    );
    let Energies {
        friction, damping, ..
    } = system.energies();
    assert!(
        friction > 0.01 * start && damping > 0.01 * start,
        "{friction} {damping} of {start}"
    );
    // Second order in the step: 1e-3 of the energy at a fifth of the limit.
    assert_below(
        "ledger",
        ((ledger(&system.energies()) - start) / start).abs(),
        1e-3,
    );
}

#[test]
fn turned_collision_is_the_same_collision() {
    let turn = UnitQuaternion::from_scaled_axis(Vec3::new(1.0, -0.4, 0.7));
    let mut pair = [collision(&UnitQuaternion::identity()), collision(&turn)];
    for system in &mut pair {
        system.advance(0.0, 0.3, 3000).unwrap();
    }
    for b in 0..3 {
        let (place, turned) = (turn * pair[0].centroid(b), pair[1].centroid(b));
        assert_below("place", (place - turned).norm(), 1e-10);
        let spin = turn * pair[0].angular_velocity(b) - pair[1].angular_velocity(b);
        assert_below("spin", spin.norm(), 1e-9);
    }
}

#[test]
fn stack_of_ten() {
    let material = glass();
    let mass = 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.125;
    let sink = |above: usize| above as f64 * mass * G / 1e6;
    let mut bodies = vec![floor()];
    let mut z = 0.0;
    for k in 0..10 {
        z += if k == 0 { 0.5 } else { 1.0 };
        bodies.push(ball(Vec3::new(0.0, 0.0, z - 0.9 * sink(10 - k)), 0.5));
        z -= 0.9 * sink(10 - k);
    }
    let mut system = blocks(bodies, material, down());
    // The slowest mode of ten, damped by the contacts, dies away with 0.6 /s.
    run(&mut system, 40.0, 1.0, 1.0);
    for contact in system.contacts() {
        let above = 11 - contact.blocks.1;
        assert_close(
            &format!("{above} above"),
            contact.overlap,
            sink(above),
            1e-6,
        );
    }
    assert_eq!((system.contacts().len(), system.n_contacts()), (10, 10));
}

#[test]
fn ball_rolls_over_a_seam_without_a_kick() {
    // Two fixed boxes side by side, and a ball that rolls from one to the other.
    let half =
        |from: f64, to: f64| block(cuboid([from, -2.0, -1.0], [to, 2.0, 0.0]), Motion::Fixed);
    let material = Material {
        contact_stiffness: 1e8,
        ..glass()
    };
    let mass = 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.125;
    let height = 0.5 - mass * G / 1e8;
    let mut start = moving(ball(Vec3::new(-1.0, 0.1, height), 0.5), [2.0, 0.3, 0.0]);
    start.angular_velocity = Vec3::new(-0.6, 4.0, 0.0);
    let mut system = blocks(
        vec![half(-3.0, 0.0), half(0.0, 3.0), start],
        material,
        down(),
    );
    let (mut time, mut kick) = (0.0, 0.0_f64);
    while time < 1.0 {
        let dt = 0.8 * system.critical_time_step().dt;
        system.advance(time, dt, 1).unwrap();
        time += dt;
        kick = kick.max(system.velocity(2).z.abs());
    }
    assert!(system.centroid(2).x > 0.9, "{}", system.centroid(2));
    assert_below("kick", kick, 1e-10);
}

#[test]
fn balls_of_many_sizes_come_to_rest() {
    let mut random = Random(7);
    let material = Material {
        restitution: 0.3,
        rolling_friction: 0.1,
        contact_stiffness: 1e7,
        ..glass()
    };
    let wall = |from: [f64; 3], to: [f64; 3]| block(cuboid(from, to), Motion::Fixed);
    let mut bodies = vec![
        floor(),
        wall([-1.0, -1.0, 0.0], [0.0, 8.0, 9.0]),
        wall([7.0, -1.0, 0.0], [8.0, 8.0, 9.0]),
        wall([0.0, -1.0, 0.0], [7.0, 0.0, 9.0]),
        wall([0.0, 7.0, 0.0], [7.0, 8.0, 9.0]),
    ];
    for k in 0..343 {
        let place = Vec3::new((k % 7) as f64, (k / 7 % 7) as f64, (k / 49) as f64).add_scalar(0.5);
        bodies.push(ball(
            place * 1.0 + random.vector() * 0.05,
            0.35 + 0.1 * random.next(),
        ));
    }
    let mut system = blocks(bodies, material, down());
    let start = ledger(&system.energies());
    let fall = -system.energies().potential;
    // Long enough for the last ball on top: in one fall it rolled between two others until 6.2 s.
    run(&mut system, 7.0, 1.0, 1.0);
    let energies = system.energies();
    let lost = energies.friction + energies.damping;
    println!("{lost} J lost of {fall}; kinetic {:e}", energies.kinetic);
    // What is left spins on the spot: a point contact resists rolling, not twisting.
    let moving: f64 = (0..system.n_blocks())
        .filter(|&b| system.is_free(b))
        .map(|b| 0.5 * system.mass(b) * system.velocity(b).norm_squared())
        .sum();
    assert_below("kinetic, of the centres, over lost", moving / lost, 1e-6);
    // First order at impacts that a step cuts in two; 5e-4 measured.
    assert_below("ledger", ((ledger(&energies) - start) / lost).abs(), 2e-3);
}

#[test]
fn edge_between_walls_holds_a_ball() {
    // A plate that ends inside walls on both sides: its free edge is no seam.
    let part = |from, to| block(cuboid(from, to), Motion::Fixed);
    let plate = part([-2.0, -1.0, -0.5], [0.0, 1.0, 0.0]);
    let walls = [
        part([-2.0, -2.0, -1.0], [2.0, -1.0, 2.0]),
        part([-2.0, 1.0, -1.0], [2.0, 2.0, 2.0]),
    ];
    let start = ball(Vec3::new(0.2, 0.0, 0.45), 0.5);
    let [left, right] = walls;
    let system = blocks(vec![plate, left, right, start], glass(), down());
    let contacts = system.contacts();
    assert_eq!(contacts.len(), 1, "{contacts:?}");
    assert!((contacts[0].normal - Vec3::new(0.2, 0.0, 0.45).normalize()).norm() < 1e-12);
}
