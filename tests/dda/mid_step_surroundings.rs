//! Contact dynamics with all that acts on blocks beside contacts: holds, loads, supports, impulses from outside, sleep, and the guards of its
//! step.

use riprap_dda::{
    Attachment, BlockDefinition, Blocks, ContactDynamics, Hold, Integrator, Load, Material, Motion,
    PrescribedMotion, Resting, Settings, StepError, Turning, Vec3,
};

use crate::setup::{
    G, assert_below, assert_close, ball, block, cuboid, down, floor, moving, on_slope, rock,
};

const DT: f64 = 5e-3;

fn with_friction(friction: f64) -> Material {
    Material {
        friction_angle: friction.atan(),
        ..rock()
    }
}

fn settings(gravity: Vec3, dynamics: ContactDynamics) -> Settings {
    Settings {
        gravity,
        integrator: Integrator::ContactDynamics(dynamics),
        ..Settings::default()
    }
}

fn exact() -> ContactDynamics {
    ContactDynamics {
        time_step: DT,
        tolerance: 1e-12,
        n_iterations: 5000,
        ..ContactDynamics::default()
    }
}

fn blocks(definitions: Vec<BlockDefinition>, friction: f64, gravity: Vec3) -> Blocks {
    let materials = vec![with_friction(friction)];
    Blocks::new(definitions, materials, settings(gravity, exact())).unwrap()
}

/// Runs from 0 to `end` (s) in steps of [`DT`].
fn run(blocks: &mut Blocks, end: f64) {
    let n = (end / DT).round() as u32;
    blocks
        .advance(0.0, end, n)
        .unwrap_or_else(|error| panic!("{error}"));
}

fn cube_on_the_floor() -> BlockDefinition {
    block(cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0]), Motion::Free)
}

/// A cube without friction on a slope, held along the dip, bears m g cos φ on the slope and m g sin φ on its hold, and does not creep.
#[test]
fn a_hold_takes_what_friction_does_not() {
    let angle = 0.5;
    let mut blocks = blocks(vec![floor(), cube_on_the_floor()], 0.0, on_slope(angle));
    let hold = Hold {
        directions: vec![Vec3::x()],
        turning: Turning::Free,
    };
    blocks.hold(1, hold).unwrap();
    blocks.keep_accounts(&[1]);
    run(&mut blocks, 1.0);
    let weight = blocks.mass(1) * G;
    let account = *blocks.account(1).unwrap();
    // solved to 1e-12 of what falls in a step
    let normal = blocks.contact_force(1).force.z;
    assert_close("slope", normal, weight * angle.cos(), 1e-10);
    let held = -account.restrained.force.x;
    assert_close("hold", held, weight * angle.sin(), 1e-10);
    assert_below(
        "creep",
        (blocks.centroid(1) - Vec3::z() * 0.5).norm(),
        1e-12,
    );
    let momentum = blocks.momentum() - blocks.support_impulse();
    assert_below("momentum", momentum.norm() / weight, 1e-12);
}

/// A cube hinged at its centroid and struck at its side by a sphere turns as angular momentum has it: with the lever r and e = 0,
/// J = v/(1/m + r²/I) and ω = r J/I.
#[test]
fn a_hinge_turns_by_a_blow() {
    let hinged = block(cuboid([-0.5; 3], [0.5; 3]), Motion::Free);
    let sphere = moving(ball(Vec3::new(0.4, 0.0, 1.0), 0.25), [0.0, 0.0, -2.0]);
    let mut blocks = blocks(vec![hinged, sphere], 0.0, Vec3::zeros());
    let hold = Hold {
        directions: vec![Vec3::x(), Vec3::y(), Vec3::z()],
        turning: Turning::About(Vec3::y()),
    };
    blocks.hold(0, hold).unwrap();
    run(&mut blocks, 0.15);
    let (mass, inertia) = (blocks.mass(1), blocks.mass(0) / 6.0);
    let blow = 2.0 / (1.0 / mass + 0.4 * 0.4 / inertia);
    // the lever is that of the middle of the step of the blow, in which the sphere is a step's way off at most
    assert_close(
        "spin",
        blocks.angular_velocity(0).y,
        0.4 * blow / inertia,
        1e-3,
    );
    assert_below("centroid", blocks.centroid(0).norm(), 1e-15);
    let other = blocks.angular_velocity(0);
    assert_below("other axes", other.x.hypot(other.z), 1e-12);
}

/// A force F on a cube of friction μ: rest below μ m g, acceleration (F − μ m g)/m above; its work is heat and motion.
#[test]
fn a_load_pulls_against_friction() {
    let friction = 0.4;
    for (share, moves) in [(0.99, false), (1.5, true)] {
        let mut blocks = blocks(vec![floor(), cube_on_the_floor()], friction, down());
        let bound = friction * blocks.mass(1) * G;
        let load = Attachment::PointLoad {
            block: 1,
            point: Vec3::zeros(),
            force: Vec3::x() * (share * bound),
        };
        blocks.attach(&[load]).unwrap();
        let start = blocks.energies().balance();
        run(&mut blocks, 1.0);
        let speed = blocks.velocity(1).x;
        if !moves {
            assert_below("creep", blocks.centroid(1).x.abs(), 1e-12);
            continue;
        }
        assert_close("speed", speed, 0.5 * friction * G, 1e-9);
        let energies = blocks.energies();
        let work = energies.external_work;
        // the load is evaluated at middles of steps: half a step of work is not in it yet
        assert_close("heat", energies.friction, work / 1.5, 2.0 * DT);
        assert_below(
            "account",
            (energies.balance() - start).abs() / work,
            2.0 * DT,
        );
    }
}

/// A cube on an elastic support oscillates with T = 2π √(m/k); the step is within the support's bound, and the energy of it stays.
#[test]
fn a_support_remains_a_spring() {
    let cube = moving(
        block(cuboid([-0.5; 3], [0.5; 3]), Motion::Free),
        [0.1, 0.0, 0.0],
    );
    let mut blocks = blocks(vec![cube], 0.0, Vec3::zeros());
    let stiffness = 2500.0 * (0.2 * std::f64::consts::PI).powi(2) * 1e4;
    let support = Attachment::FixedPoint {
        block: 0,
        point: Vec3::zeros(),
        stiffness,
    };
    blocks.attach(&[support]).unwrap();
    let dt = blocks.critical_time_step().dt;
    // three directions and their rotations count together
    let limit = 0.8 * 2.0 / (3.0 * stiffness / blocks.mass(0)).sqrt();
    assert_close("step", dt, limit.min(DT), 1e-12);
    let period = 0.1;
    let n = 400;
    blocks.advance(0.0, 10.0 * period, 10 * n).unwrap();
    // phase error of the leap frog, (ω dt)²/24, over ten periods
    let phase =
        10.0 * std::f64::consts::TAU * (std::f64::consts::TAU / f64::from(n)).powi(2) / 24.0;
    assert_below(
        "way after ten periods",
        blocks.centroid(0).x.abs() / 0.1 * 62.8,
        2.0 * phase,
    );
    assert_close("speed after ten periods", blocks.velocity(0).x, 0.1, 1e-6);
}

/// An impulse from outside acts with the contacts at the middle of the next step: pressed on the floor it moves nothing.
#[test]
fn impulses_from_outside_meet_contacts() {
    let mut blocks = blocks(vec![floor(), cube_on_the_floor()], 0.5, down());
    let weight = blocks.mass(1) * G;
    let load = |force: Vec3| Load {
        force,
        torque: Vec3::zeros(),
    };
    // lifted by half of its weight, pushed by a fifth of the rest
    let from_water = load(Vec3::new(0.1 * weight, 0.0, 0.5 * weight));
    for k in 0..400 {
        blocks.apply_impulse(&[Load::default(), from_water], 0.5 * DT);
        blocks.advance(f64::from(k) * DT, DT, 1).unwrap();
        blocks.apply_impulse(&[Load::default(), from_water], 0.5 * DT);
    }
    assert_below(
        "creep",
        (blocks.centroid(1) - Vec3::z() * 0.5).norm(),
        1e-12,
    );
    // half an impulse of the last step is still to come
    assert_close(
        "floor",
        blocks.contact_force(1).force.z,
        0.5 * weight,
        1e-10,
    );
    for k in 400..600 {
        blocks.apply_impulse(&[Load::default(), from_water.times(3.0)], DT);
        blocks.advance(f64::from(k) * DT, DT, 1).unwrap();
    }
    // lifted by half of its weight more than it has
    assert_close("rise", blocks.velocity(1).z, 0.5 * G, 0.02);
}

fn asleep() -> Settings {
    Settings {
        resting: Some(Resting {
            displacement: 1e-3,
            time: 0.2,
            load: 0.2,
        }),
        ..settings(down(), exact())
    }
}

fn stack() -> Vec<BlockDefinition> {
    let cube = |k: i32| {
        let z = f64::from(k);
        block(cuboid([-0.5, -0.5, z], [0.5, 0.5, z + 1.0]), Motion::Free)
    };
    std::iter::once(floor()).chain((0..3).map(cube)).collect()
}

/// Blocks asleep keep their reactions and cost no sweeps; a blow on the upmost wakes them, and so does the loss of the lowest.
#[test]
fn blocks_asleep_wake_by_a_blow() {
    let mut definitions = stack();
    definitions.push(moving(
        ball(Vec3::new(0.0, 0.0, 8.0), 0.5),
        [0.0, 0.0, -1.0],
    ));
    let mut blocks = Blocks::new(definitions, vec![with_friction(0.5)], asleep()).unwrap();
    run(&mut blocks, 0.6);
    assert_eq!(blocks.n_asleep(), 3);
    let weight = blocks.mass(1) * G;
    assert_close("floor", blocks.contact_force(1).force.z, weight, 1e-9);
    assert_eq!(blocks.contact_solution().n_contacts, 0);
    let mut least = 3;
    for k in 120..320 {
        blocks.advance(f64::from(k) * DT, DT, 1).unwrap();
        least = least.min(blocks.n_asleep());
    }
    assert!(least < 3, "the blow wakes the stack");
    blocks.remove(1);
    let high = blocks.centroid(2).z;
    for k in 320..420 {
        blocks.advance(f64::from(k) * DT, DT, 1).unwrap();
    }
    assert!(
        blocks.centroid(2).z < high - 0.9,
        "the second falls where the first was"
    );
}

/// A wall on a path runs into a stack that sleeps: it is awake before they overlap.
#[test]
fn a_moving_wall_wakes_what_it_meets() {
    let path = PrescribedMotion::Table {
        time: (0..=4).map(f64::from).collect(),
        displacement: [0.0, 0.0, 1.0, 2.0, 3.0].map(|x| Vec3::x() * x).to_vec(),
        turning: Vec::new(),
    };
    let mut definitions = stack();
    definitions.push(block(
        cuboid([-1.5, -1.0, 0.01], [-1.0, 1.0, 3.0]),
        Motion::Prescribed(path),
    ));
    let mut blocks = Blocks::new(definitions, vec![with_friction(0.5)], asleep()).unwrap();
    run(&mut blocks, 1.0);
    assert_eq!(blocks.n_asleep(), 3);
    for k in 200..600 {
        blocks.advance(f64::from(k) * DT, DT, 1).unwrap();
    }
    for b in 1..4 {
        let gap = blocks.centroid(b).x - 0.5 - (blocks.centroid(4).x + 0.25);
        assert!(-1e-3 < gap, "block {b} overlaps the wall by {gap} m");
    }
    assert_below("overlap", blocks.max_overlap_over_size(), 1e-2);
}

/// The step is shorter where a block moves far in it, and a fast block does not pass a thin plate in any step.
#[test]
fn a_fast_block_takes_shorter_steps_and_stops_at_a_plate() {
    let plate = block(cuboid([-5.0, -5.0, -0.01], [5.0, 5.0, 0.0]), Motion::Fixed);
    let cube = block(cuboid([-0.5, -0.5, 1.0], [0.5, 0.5, 2.0]), Motion::Free);
    for speed in [1.0, 30.0, 600.0] {
        let definitions = vec![plate.clone(), moving(cube.clone(), [0.0, 0.0, -speed])];
        let mut blocks = blocks(definitions, 0.5, down());
        let step = blocks.critical_time_step();
        assert_close("step", step.dt, DT.min(0.2 / speed), 1e-12);
        assert_eq!(step.block, (0.2 / speed < DT).then_some(1));
        let mut time = 0.0;
        while time < 2.0 / speed {
            let dt = blocks.critical_time_step().dt;
            blocks.advance(time, dt, 1).unwrap();
            time += dt;
        }
        assert!(-1e-9 < blocks.centroid(1).z - 0.5, "at {speed} m/s");
        assert_below("overlap", blocks.max_overlap_over_size(), 1e-9);
    }
}

/// Contacts that are not solved three steps running end the run with a message that says so.
#[test]
fn unsolved_contacts_are_an_error() {
    let hasty = ContactDynamics {
        time_step: DT,
        tolerance: 1e-12,
        n_iterations: 1,
        ..ContactDynamics::default()
    };
    let cubes = (0..30).map(|k| {
        let z = f64::from(k);
        block(cuboid([-0.5, -0.5, z], [0.5, 0.5, z + 1.0]), Motion::Free)
    });
    let definitions = std::iter::once(floor()).chain(cubes).collect();
    let materials = vec![with_friction(0.5)];
    let mut blocks = Blocks::new(definitions, materials, settings(down(), hasty)).unwrap();
    let error = blocks.advance(0.0, 10.0 * DT, 10).unwrap_err();
    println!("{error}");
    assert!(matches!(error, StepError::Unsolved { n_steps: 3, .. }));
    assert_eq!(blocks.solved_steps().n_unsolved, 3);
}
