//! Loads, supports, bolts, holds, base shaking, damping for statics. Closed forms beside each.

use crate::setup::*;
use riprap_dda::{
    Accelerogram, Attachment, Blocks, Hold, Material, Motion, PrescribedMotion, Settings,
    StaticDamping, Turning, Vec3,
};

fn cube_at(x: f64, z: f64) -> riprap_dda::BlockDefinition {
    block(cuboid([x, 0.0, z], [x + 1.0, 1.0, z + 1.0]), Motion::Free)
}

/// A force at a corner: v = F t/m, L = r × F t while the block has hardly turned; the work is in the ledger.
#[test]
fn point_load() {
    let mut blocks = blocks(vec![cube_at(0.0, 0.0)], rock(), Vec3::zeros());
    let force = Vec3::new(100.0, 0.0, 0.0);
    let attachment = Attachment::PointLoad {
        block: 0,
        point: Vec3::repeat(1.0),
        force,
    };
    blocks.attach(&[attachment]).unwrap();
    run_steps(&mut blocks, 1.0, 2000);
    assert_close("speed", blocks.velocity(0).x, 100.0 / 2500.0, 1e-12);
    let torque = Vec3::repeat(0.5).cross(&force);
    assert_below(
        "spin",
        (blocks.spin_momentum(0) - torque).norm() / torque.norm(),
        0.05,
    );
    let e = blocks.energies();
    assert_close("work", e.kinetic, e.external_work, 1e-6);
    assert_close("impulse", blocks.support_impulse().x, 100.0, 1e-12);
}

/// A block hung from a fixed point swings as a pendulum: T = 2π √((J + m l²)/(m g l)).
#[test]
fn pendulum_on_a_fixed_point() {
    let mut blocks = blocks(vec![cube_at(-0.5, -3.5)], rock(), down());
    let pivot = Vec3::new(0.0, 0.5, 0.0);
    let attachment = Attachment::FixedPoint {
        block: 0,
        point: pivot,
        stiffness: 1e9,
    };
    blocks.attach(&[attachment]).unwrap();
    let push = riprap_dda::Load {
        force: Vec3::new(25.0, 0.0, 0.0),
        torque: Vec3::zeros(),
    };
    blocks.apply_impulse(&[push], 1.0);
    let start = blocks.energies().balance();
    let mut crossings = Vec::new();
    let (mut time, mut before) = (0.0, 0.0);
    while crossings.len() < 3 {
        let dt = blocks.critical_time_step().dt.min(1e-3);
        blocks.advance(time, dt, 1).unwrap();
        let x = blocks.centroid(0).x;
        if before * x < 0.0 {
            crossings.push(time + dt * before / (before - x));
        }
        (before, time) = (x, time + dt);
    }
    let (m, l) = (2500.0, 3.0_f64);
    let expected = std::f64::consts::TAU * ((m / 6.0 + m * l * l) / (m * G * l)).sqrt();
    assert_close("period", crossings[2] - crossings[0], expected, 1e-3);
    assert_below(
        "ledger",
        (blocks.energies().balance() - start).abs() / (0.5 * m * 1e-4),
        2e-2,
    );
}

/// A bolt between two blocks apart: elastic period 2π √(m_e/k); pulled beyond its strength it yields, and what it
/// took is the work of the pull beyond the elastic part.
#[test]
fn rock_bolt() {
    let definitions = || vec![cube_at(0.0, 0.0), cube_at(3.0, 0.0)];
    let bolt = |pretension, yield_force| Attachment::RockBolt {
        blocks: (0, 1),
        points: (Vec3::new(0.5, 0.5, 0.5), Vec3::new(3.5, 0.5, 0.5)),
        stiffness: 1e6,
        pretension,
        yield_force,
    };
    // Pretension 10 kN swings between 10 and −10 kN with ω = √(k/m_e), m_e = m/2.
    let mut swinging = blocks(definitions(), rock(), Vec3::zeros());
    swinging.attach(&[bolt(1e4, 1e9)]).unwrap();
    let omega = (1e6_f64 / 1250.0).sqrt();
    run_steps(&mut swinging, std::f64::consts::PI / omega, 2000);
    assert_close(
        "tension after half a period",
        swinging.bolts().next().unwrap().0,
        1e4,
        1e-5,
    );
    assert_close(
        "come closer",
        3.0 - (swinging.centroid(1) - swinging.centroid(0)).x,
        0.02,
        1e-5,
    );
    // Blocks that part at 1 m/s each are stopped by the yielding bolt: 2 · m v²/2 = N_y (u_p + N_y/k) − N_y²/(2k).
    let mut parting = definitions();
    parting[0] = moving(parting[0].clone(), [-1.0, 0.0, 0.0]);
    parting[1] = moving(parting[1].clone(), [1.0, 0.0, 0.0]);
    let mut parting = blocks(parting, rock(), Vec3::zeros());
    parting.attach(&[bolt(0.0, 5e4)]).unwrap();
    let (mut time, start) = (0.0, parting.energies().balance());
    while parting.velocity(1).x > 0.0 {
        let dt = 0.05 * parting.critical_time_step().dt;
        parting.advance(time, dt, 1).unwrap();
        time += dt;
    }
    let (force, yielded) = parting.bolts().next().unwrap();
    assert_close("tension", force, 5e4, 1e-3);
    assert_close("yielded", yielded, 2500.0 / 5e4 - 0.5 * 5e4 / 1e6, 2e-3);
    let e = parting.energies();
    assert_close("plastic work", e.plastic, 5e4 * yielded, 1e-9);
    assert_below("ledger", (e.balance() / start - 1.0).abs(), 1e-3);
    assert_below("momentum", parting.momentum().norm(), 1e-9);
}

/// Held across the slope, a block slides straight down whatever pushes sideways; held about one axis it keeps its spin.
#[test]
fn holds() {
    let mut blocks = blocks(vec![cube_at(0.0, 5.0), cube_at(3.0, 5.0)], rock(), down());
    let hold = Hold {
        directions: vec![Vec3::y()],
        turning: Turning::About(Vec3::y()),
    };
    blocks.hold(0, hold).unwrap();
    blocks
        .hold(
            1,
            Hold {
                directions: vec![Vec3::x(), Vec3::z()],
                turning: Turning::Held,
            },
        )
        .unwrap();
    let load = riprap_dda::Load {
        force: Vec3::new(250.0, 500.0, 0.0),
        torque: Vec3::new(10.0, 20.0, 30.0),
    };
    blocks.apply_impulse(&[load, load], 1.0);
    let inertia = 2500.0 / 6.0;
    run_steps(&mut blocks, 0.5, 100);
    let close = |found: Vec3, expected: Vec3| (found - expected).norm() < 1e-12;
    assert!(
        close(blocks.velocity(0), Vec3::new(0.1, 0.0, -0.5 * G)),
        "{}",
        blocks.velocity(0)
    );
    assert!(close(
        blocks.angular_velocity(0),
        Vec3::new(0.0, 20.0 / inertia, 0.0)
    ));
    assert!(
        close(blocks.velocity(1), Vec3::new(0.0, 0.2, 0.0)),
        "{}",
        blocks.velocity(1)
    );
    assert!(close(blocks.angular_velocity(1), Vec3::zeros()));
    // All momentum is accounted for: the impulses given, and the supports'.
    let given = Vec3::new(500.0, 1000.0, 0.0);
    let missing = blocks.momentum() - given - blocks.support_impulse();
    assert_below("momentum", missing.norm() / blocks.momentum().norm(), 1e-12);
}

/// Base shaking (Newmark): on the flat, a(t) = A sin ωt with A > μ g. The block slides from t₁ = asin(μg/A)/ω until the
/// velocities meet again; relative slip by integration of the same closed form.
#[test]
fn newmark_sliding_block() {
    let (amplitude, omega, mu) = (6.0_f64, 5.0_f64, 0.3_f64);
    let dt_record = 1e-3;
    let samples = (0..=2000)
        .map(|k| amplitude * (omega * f64::from(k) * dt_record).sin())
        .collect();
    let material = Material {
        friction_angle: mu.atan(),
        contact_stiffness: 1e9,
        ..rock()
    };
    let sunk = 2500.0 * 0.16 * 0.4 * G / 1e9;
    let definitions = vec![
        block(
            cuboid([-5.0, -5.0, -1.0], [5.0, 5.0, 0.0]),
            Motion::Prescribed(PrescribedMotion::Shaking(Accelerogram::new(
                Vec3::x(),
                dt_record,
                samples,
            ))),
        ),
        // Low and wide, so that it does not rock.
        block(
            cuboid([-1.0, -1.0, -sunk], [1.0, 1.0, 0.1 - sunk]),
            Motion::Free,
        ),
    ];
    let mut blocks = blocks(definitions, material, down());
    // The base starts to move with A/ω (1 − cos ωt): one half cycle of slip ends at t₂, where
    // A/ω (cos ωt₁ − cos ωt₂) = μ g (t₂ − t₁).
    let t1 = (mu * G / amplitude).asin() / omega;
    let relative =
        |t: f64| amplitude / omega * ((omega * t1).cos() - (omega * t).cos()) - mu * G * (t - t1);
    let (mut low, mut high) = (t1 + 0.1, t1 + 1.2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if relative(middle) > 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    let t2 = 0.5 * (low + high);
    let slip = amplitude / omega * (omega * t1).cos() * (t2 - t1)
        - amplitude / (omega * omega) * ((omega * t2).sin() - (omega * t1).sin())
        - 0.5 * mu * G * (t2 - t1).powi(2);
    run(&mut blocks, t2, 1.0, 1e-3);
    let found = blocks.centroid(0).x - blocks.centroid(1).x;
    // Contact shear springs lag by m μ g/K_t, some 1e-5 of the slip; the restitution-free damper of the normal none.
    assert_close("slip of the first pulse", found, slip, 1e-3);
}

/// Each damping for statics brings a column to rest, and its loss is in the ledger.
#[test]
fn static_damping() {
    for damping in [
        StaticDamping::MassProportional(20.0),
        StaticDamping::Local(0.7),
        StaticDamping::Kinetic(0.97),
    ] {
        let settings = Settings {
            static_damping: Some(damping),
            ..Settings::default()
        };
        let material = Material {
            restitution: 1.0,
            contact_stiffness: 1e7,
            ..rock()
        };
        let definitions = vec![floor(), cube_at(0.0, 0.0), cube_at(0.0, 1.0)];
        let mut blocks = Blocks::new(definitions, vec![material], settings).unwrap();
        let start = blocks.energies().balance();
        run(&mut blocks, 4.0, 0.5, 1.0);
        let name = format!("{damping:?}");
        let weight = 2500.0 * G;
        let settled = 1.5 - blocks.centroid(2).z;
        assert_close(
            &format!("{name} settlement"),
            settled,
            3.0 * weight / 1e7,
            1e-4,
        );
        let e = blocks.energies();
        assert!(e.static_damping > 0.0 && e.damping.abs() < 1e-6 * e.static_damping);
        // Lost: half the work of the weights over their settlements.
        assert_close(
            &format!("{name} loss"),
            e.static_damping,
            0.5 * weight * weight / 1e7 * 5.0,
            1e-2,
        );
        assert_below(
            "ledger",
            ((e.balance() - start) / e.static_damping).abs(),
            1e-2,
        );
    }
}

#[test]
fn unusable_attachments_and_holds_are_named() {
    let mut blocks = blocks(vec![floor(), cube_at(0.0, 0.0)], rock(), down());
    let bolt = Attachment::RockBolt {
        blocks: (0, 1),
        points: (Vec3::zeros(), Vec3::repeat(0.5)),
        stiffness: 1e6,
        pretension: 2e4,
        yield_force: 1e4,
    };
    assert_eq!(
        blocks.attach(&[bolt]).unwrap_err().to_string(),
        "attachment 0 is unusable: the pretension of a bolt must not exceed its yield force"
    );
    assert_eq!(
        blocks.hold(0, Hold::default()).unwrap_err().to_string(),
        "block 0 cannot be held: it is not a free block"
    );
}
