//! Steps of contact dynamics over several steps of the caller, as water has them.

use riprap_dda::{BlockDefinition, Blocks, Load, Motion, PrescribedMotion, Random, Vec3};

use crate::mid_step::{blocks, joint, run};
use crate::setup::{G, assert_below, assert_close, block, cuboid, down, floor, moving, on_threads};

/// Steps of `dt` to a time (s), with a kick in each period (s); returns the kicks.
fn span(blocks: &mut Blocks, (from, to): (f64, f64), dt: f64, period: f64) -> u32 {
    let n = ((to - from) / dt).round() as u32;
    let step = |k: u32| {
        let time = from + (to - from) * f64::from(k) / f64::from(n);
        let kicks = blocks.advance_spanning(time, dt, period, &mut |_| {});
        kicks.unwrap_or_else(|error| panic!("{error}")).count
    };
    (0..n).map(step).sum()
}

/// Five tilted cubes above each other, one of them thrown, on a floor.
fn tumbling() -> Vec<BlockDefinition> {
    let mut definitions = vec![floor()];
    for k in 0..5 {
        let x = Vec3::new(0.1 * f64::from(k % 2), 0.0, 0.1 + 1.1 * f64::from(k));
        let cube = cuboid(
            [x.x - 0.5, x.y - 0.5, x.z],
            [x.x + 0.5, x.y + 0.5, x.z + 1.0],
        );
        definitions.push(moving(
            block(cube, Motion::Free),
            [0.2 * f64::from(k), 0.0, 0.0],
        ));
    }
    definitions
}

/// Kicks in the middle of each period are those of whole steps of that length: the same motion, whatever the steps of the caller.
#[test]
fn spanned_steps_are_whole_steps() {
    let period = 0.008;
    let mut whole = blocks(tumbling(), joint(0.5, 0.3), down());
    run(&mut whole, (0.0, 0.4), period);
    for n_in_period in [2, 5, 8] {
        let mut spanned = blocks(tumbling(), joint(0.5, 0.3), down());
        let dt = period / f64::from(n_in_period);
        let kicks = span(&mut spanned, (0.0, 0.4), dt, period);
        assert_eq!(kicks, 50);
        let off = (1..6).map(|b| (spanned.centroid(b) - whole.centroid(b)).norm());
        // round-off of the pieces of a drift, through impacts and to the tolerance of the solver, 1e-8 of a kick
        assert_below("way off", off.fold(0.0, f64::max), 1e-6);
    }
}

/// Free fall with steps and periods that change at random: all time is covered, none twice.
#[test]
fn no_time_is_lost_where_the_period_changes() {
    let cube = block(cuboid([-0.5; 3], [0.5; 3]), Motion::Free);
    let thrown = vec![moving(cube, [0.0, 0.0, 5.0])];
    let mut blocks = blocks(thrown, joint(0.5, 0.0), down());
    let mut random = Random::new(3);
    let longest = 4.4e-3;
    let (mut time, mut covered) = (0.0, 0.0);
    for _ in 0..500 {
        let dt = 1e-3 * (0.2 + random.uniform());
        let period = longest * (0.1 + 0.9 * random.uniform());
        let kicks = blocks.advance_spanning(time, dt, period, &mut |_| {});
        covered += kicks.unwrap().over;
        time += dt;
        let fallen = (5.0 - blocks.velocity(0).z) / G;
        // round-off of some hundred sums
        assert_below("time by the velocity", (fallen - covered).abs(), 1e-12);
        assert_below(
            "time ahead",
            (covered - time).abs(),
            0.5 * longest * (1.0 + 1e-9),
        );
    }
    // sub-steps inside a step go on from there
    for _ in 0..100 {
        blocks.advance(time, 1e-3, 2).unwrap();
        time += 1e-3;
    }
    let fallen = (5.0 - blocks.velocity(0).z) / G;
    assert_below(
        "time ahead by sub-steps",
        (fallen - time).abs(),
        0.25e-3 * (1.0 + 1e-9),
    );
    let height = blocks.centroid(0).z - (5.0 - 0.5 * G * time) * time;
    // the velocity is off by half a period at any time, to both sides
    assert_below("height", height.abs(), 0.1 * (0.5 * G * longest * time));
}

/// A block that lies on the ground under pushes from outside in each step of the caller does not move, and its support bears all of them.
#[test]
fn impulses_wait_for_the_kick() {
    let cube = block(cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0]), Motion::Free);
    let mut blocks = blocks(vec![floor(), cube], joint(0.5, 0.0), down());
    let (dt, n) = (1e-3, 600);
    let start = blocks.centroid(1);
    let weight = blocks.mass(1) * G;
    let before = blocks.support_impulse();
    let mut given = Vec3::zeros();
    for k in 0..n {
        let time = dt * f64::from(k);
        let force = Vec3::new(0.3 * weight, 0.0, 0.2 * weight * (40.0 * time).sin());
        let push = Load {
            force,
            torque: Vec3::zeros(),
        };
        blocks.apply_impulse(&[Load::default(), push], dt);
        given += force * dt;
        blocks
            .advance_spanning(time, dt, 6e-3, &mut |_| {})
            .unwrap();
        let unexplained = blocks.momentum() - (blocks.support_impulse() - before) - given;
        // round-off of some hundred sums
        assert_below("momentum", unexplained.norm(), 1e-10 * weight);
    }
    // solved to 1e-8 of the velocity that a period of weight gives
    assert_below("way", (blocks.centroid(1) - start).norm(), 1e-8);
    let contacts = blocks.contacts();
    let bears = contacts.iter().map(|c| c.normal_force).sum::<f64>() / weight;
    // less the push up, at most
    assert!((0.79..1.21).contains(&bears), "{bears}");
}

/// A free block under a force that oscillates, in steps of about a tenth of a period: off by the square of the period, and without a lag.
#[test]
fn forces_from_outside_act_to_second_order() {
    let way_off = |period: f64| {
        let cube = block(cuboid([-0.5; 3], [0.5; 3]), Motion::Free);
        let mut blocks = blocks(vec![cube], joint(0.5, 0.0), Vec3::zeros());
        // kicks anywhere in a step
        let (dt, rate, mass) = (period / 10.37, 10.0, blocks.mass(0));
        let mut worst: f64 = 0.0;
        let push = |time: f64| Load {
            force: Vec3::x() * (mass * (rate * time).cos()),
            torque: Vec3::zeros(),
        };
        for k in 0..(2.0 / dt).round() as u32 {
            let time = dt * f64::from(k);
            // half kicks, as of the water
            blocks.apply_impulse(&[push(time)], 0.5 * dt);
            blocks
                .advance_spanning(time, dt, period, &mut |_| {})
                .unwrap();
            blocks.apply_impulse(&[push(time + dt)], 0.5 * dt);
            let expected = (1.0 - (rate * (time + dt)).cos()) / (rate * rate);
            worst = worst.max((blocks.centroid(0).x - expected).abs());
        }
        worst
    };
    let off = [0.02, 0.01, 0.005].map(way_off);
    let order = [off[0] / off[1], off[1] / off[2]].map(f64::log2);
    println!("{off:?} m off, orders {order:.2?}");
    assert!(order.iter().all(|order| (1.8..2.2).contains(order)));
}

/// A plate that is driven into a block pushes it along with its own velocity, between kicks, too.
#[test]
fn driven_blocks_push_between_kicks() {
    let speed = 0.5;
    let cube = block(cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0]), Motion::Free);
    let time: Vec<f64> = (-2..=2).map(|k| 10.0 * f64::from(k)).collect();
    let path = PrescribedMotion::Table {
        // on its way before and after
        displacement: time.iter().map(|t| Vec3::x() * (speed * t)).collect(),
        time,
        turning: Vec::new(),
    };
    let plate = block(
        cuboid([-0.8, -0.5, 0.1], [-0.6, 0.5, 0.9]),
        Motion::Prescribed(path),
    );
    let mut blocks = blocks(vec![floor(), cube, plate], joint(0.3, 0.0), down());
    span(&mut blocks, (0.0, 1.0), 1e-3, 7e-3);
    assert_close("velocity", blocks.velocity(1).x, speed, 1e-6);
    let gap = blocks.centroid(1).x - 0.5 - (blocks.centroid(2).x + 0.1);
    assert_below("gap", gap.abs(), 1e-3);
}

/// The same bits with one thread and several, and through a checkpoint between two kicks.
#[test]
fn spanned_steps_have_the_same_bits_through_a_checkpoint() {
    let bits = |blocks: &Blocks| {
        let mut bits = Vec::new();
        blocks.for_each_state_f64(&mut |x| bits.push(x.to_bits()));
        bits
    };
    let whole = |n_threads: usize| {
        on_threads(n_threads, || {
            let mut blocks = blocks(tumbling(), joint(0.5, 0.3), down());
            span(&mut blocks, (0.0, 0.4), 1e-3, 7.3e-3);
            bits(&blocks)
        })
    };
    let mut first = blocks(tumbling(), joint(0.5, 0.3), down());
    span(&mut first, (0.0, 0.201), 1e-3, 7.3e-3);
    let bytes = first.save(Vec::new()).unwrap();
    let mut second = blocks(tumbling(), joint(0.5, 0.3), down());
    second.read(&bytes).unwrap();
    span(&mut second, (0.201, 0.4), 1e-3, 7.3e-3);
    let expected = whole(1);
    assert_eq!(whole(2), expected);
    let mut again = blocks(tumbling(), joint(0.5, 0.3), down());
    span(&mut again, (0.0, 0.201), 1e-3, 7.3e-3);
    span(&mut again, (0.201, 0.4), 1e-3, 7.3e-3);
    assert_eq!(bits(&second), bits(&again));
}
