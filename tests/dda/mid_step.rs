//! Blocks by contact dynamics: N02 to N05, N07, N08, N10, N14 and N23 of contact dynamics.

use riprap_dda::{
    BlockDefinition, BlockError, Blocks, ContactDynamics, ContactState, Integrator, Isometry,
    Material, Motion, Polyhedron, PrescribedMotion, Resting, RollingLaw, Settings, Vec3,
};

use crate::setup::{
    Random, assert_below, assert_close, ball, block, cuboid, down, floor, moving, on_slope,
    on_threads, rock,
};
use crate::structures::arch;

pub fn joint(friction: f64, restitution: f64) -> Material {
    Material {
        friction_angle: friction.atan(),
        restitution,
        ..rock()
    }
}

pub fn settings(gravity: Vec3, tolerance: f64) -> Settings {
    Settings {
        gravity,
        integrator: Integrator::ContactDynamics(ContactDynamics {
            tolerance,
            n_iterations: 2000,
            ..ContactDynamics::default()
        }),
        ..Settings::default()
    }
}

pub fn blocks(definitions: Vec<BlockDefinition>, material: Material, gravity: Vec3) -> Blocks {
    Blocks::new(definitions, vec![material], settings(gravity, 1e-8)).unwrap()
}

/// Steps of `dt` to a time (s).
pub fn run(blocks: &mut Blocks, (from, to): (f64, f64), dt: f64) {
    let n = ((to - from) / dt).round() as u32;
    blocks
        .advance(from, to - from, n)
        .unwrap_or_else(|error| panic!("{error}"));
}

/// N02: a block that slides at 2 m/s with a friction of 0.3 stops after v²/(2 μ g), of first order in the step.
#[test]
fn a_sliding_block_stops_where_coulomb_has_it() {
    let slab = block(cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 0.2]), Motion::Free);
    let expected = 4.0 / (2.0 * 0.3 * 9.81);
    for dt in [0.02, 0.01, 0.005] {
        let definitions = vec![floor(), moving(slab.clone(), [2.0, 0.0, 0.0])];
        let mut blocks = blocks(definitions, joint(0.3, 0.0), down());
        run(&mut blocks, (0.0, 1.0), dt);
        let off = blocks.centroid(1).x - expected;
        // the speed falls by μ g dt a step, and the last one is cut
        let allowed = 0.3 * 9.81 * dt * dt;
        println!("stops {off:+.2e} m off, {allowed:.1e} allowed, at {dt} s");
        assert!(off.abs() < allowed, "{off}");
        assert_below("speed left", blocks.velocity(1).norm(), 1e-12);
        // solved to 1e-8 of what falls in a step
        assert_below("height", (blocks.centroid(1).z - 0.1).abs(), 1e-8);
    }
}

/// N03: a cube at μ 0.58 on 30° (tan 30° = 0.577) rests exactly.
#[test]
fn a_block_at_rest_on_a_slope_does_not_creep() {
    let cube = block(cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0]), Motion::Free);
    let slope = on_slope(30_f64.to_radians());
    let mut blocks = blocks(vec![floor(), cube], joint(0.58, 0.0), slope);
    run(&mut blocks, (0.0, 1.0), 0.01);
    let before = blocks.centroid(1);
    run(&mut blocks, (1.0, 1000.0), 0.01);
    assert_below(
        "drift in 1e5 steps",
        (blocks.centroid(1) - before).norm(),
        1e-12,
    );
}

/// N04: heights of a sphere that falls by 1 m follow the restitution, the better the shorter the step.
#[test]
fn spheres_bounce_by_their_restitution() {
    let highest = |restitution: f64, n_bounces: u32, dt: f64| {
        let definitions = vec![floor(), ball(Vec3::new(0.0, 0.0, 1.5), 0.5)];
        let mut blocks = blocks(definitions, joint(0.3, restitution), down());
        let (mut bounces, mut highest, mut time) = (0, 0.0_f64, 0.0);
        let mut falls = true;
        while bounces <= n_bounces {
            run(&mut blocks, (time, time + dt), dt);
            time += dt;
            let speed = blocks.velocity(1).z;
            if falls && 0.0 < speed {
                bounces += 1;
                highest = if bounces <= n_bounces { 0.0 } else { highest };
            }
            falls = speed < 0.0;
            if bounces == n_bounces {
                highest = highest.max(blocks.centroid(1).z - 0.5);
            }
        }
        highest
    };
    for (restitution, n) in [(0.5, 1), (0.5, 2), (1.0, 10)] {
        let expected = f64::powi(restitution, 2 * n as i32);
        let off = [0.002, 0.0005].map(|dt| (highest(restitution, n, dt) - expected).abs());
        println!(
            "e {restitution}, bounce {n}: {:.1e} and {:.1e} m off {expected} m",
            off[0], off[1]
        );
        // a bounce is off by up to v dt, 0.009 m at 2 ms
        assert!(
            off[0] < 0.01 * f64::from(n) && off[1] < 0.0025 * f64::from(n),
            "{off:?}"
        );
    }
}

/// N07: a body that spins freely keeps its angular momentum, and its energy within bounds.
#[test]
fn a_free_body_keeps_its_spin() {
    let mut body = block(cuboid([0.0; 3], [1.0, 2.0, 0.5]), Motion::Free);
    body.angular_velocity = Vec3::new(1.0, 2.0, 0.3);
    let mut blocks = blocks(vec![body], rock(), Vec3::zeros());
    let (momentum, energy) = (blocks.spin_momentum(0), blocks.energies().kinetic);
    run(&mut blocks, (0.0, 1000.0), 0.01);
    let off = (blocks.spin_momentum(0) - momentum).norm() / momentum.norm();
    assert_below("angular momentum after 1e5 steps", off, 1e-10);
    // of second order in ω dt
    assert_below(
        "energy",
        (blocks.energies().kinetic / energy - 1.0).abs(),
        1e-3,
    );
}

/// N08, and the account of energy: hulls and spheres that hit each other keep momentum and angular momentum, and every joule is in its
/// place.
#[test]
fn a_swarm_keeps_its_momentum_and_its_account() {
    let mut random = Random::new(5);
    let mut definitions = Vec::new();
    for k in 0..30 {
        let place = Vec3::from([k % 3, k / 3 % 3, k / 9].map(f64::from)) * 1.3;
        let mut body = match k % 3 {
            0 => ball(place, 0.45),
            _ => {
                let hull = random.hull();
                let turned = hull.transformed(&Isometry::new(place, random.vector()));
                block(turned, Motion::Free)
            }
        };
        body.velocity = random.vector() - (place - Vec3::repeat(1.3)) * 1.5;
        body.angular_velocity = random.vector();
        definitions.push(body);
    }
    let mut blocks = blocks(definitions, joint(0.4, 0.3), Vec3::zeros());
    let n = blocks.n_blocks();
    let sums = |blocks: &Blocks| {
        let momentum: Vec3 = (0..n).map(|b| blocks.velocity(b) * blocks.mass(b)).sum();
        let turning: Vec3 = (0..n)
            .map(|b| {
                blocks.spin_momentum(b)
                    + blocks
                        .centroid(b)
                        .cross(&(blocks.velocity(b) * blocks.mass(b)))
            })
            .sum();
        (momentum, turning)
    };
    let size: f64 = (0..n)
        .map(|b| blocks.velocity(b).norm() * blocks.mass(b))
        .sum();
    let (momentum, turning) = sums(&blocks);
    let before = blocks.energies();
    run(&mut blocks, (0.0, 1.0), 0.002);
    let after = blocks.energies();
    let (now, turning_now) = sums(&blocks);
    assert_below("momentum", (now - momentum).norm() / size, 1e-12);
    // overlap is removed along the normal, at the points where it is
    assert_below(
        "angular momentum",
        (turning_now - turning).norm() / size,
        1e-4,
    );
    println!(
        "kinetic {:.1} -> {:.1} J, friction {:.1}, damping {:.1}, removal of overlap {:.2e}; deepest {:.1e} sizes",
        before.kinetic,
        after.kinetic,
        after.friction,
        after.damping,
        after.overlap_removal,
        blocks.max_overlap_over_size()
    );
    let lost = before.kinetic - after.kinetic;
    assert!(0.3 * before.kinetic < lost, "they hit each other");
    // free rotation keeps energy to second order in ω dt
    assert_below(
        "account",
        (after.balance() - before.balance()).abs() / lost,
        1e-3,
    );
    assert!(0.0 < after.friction && 0.0 < after.damping);
}

/// N05: a column of cubes stands for a minute; its reaction is its weight.
#[test]
fn a_column_of_fifty_stands() {
    let n = 50;
    let cubes = (0..n).map(|k| {
        let z = f64::from(k);
        block(cuboid([-0.5, -0.5, z], [0.5, 0.5, z + 1.0]), Motion::Free)
    });
    let definitions = std::iter::once(floor()).chain(cubes).collect();
    let settings = Settings {
        resting: Some(Resting {
            displacement: 1e-3,
            time: 0.5,
            load: 0.2,
        }),
        ..settings(down(), 1e-10)
    };
    let mut blocks = Blocks::new(definitions, vec![joint(0.5, 0.0)], settings).unwrap();
    run(&mut blocks, (0.0, 1.0), 0.01);
    let before: Vec<Vec3> = (0..blocks.n_blocks()).map(|b| blocks.centroid(b)).collect();
    run(&mut blocks, (1.0, 61.0), 0.01);
    let drift = (before.iter().enumerate())
        .map(|(b, x)| (blocks.centroid(b) - x).norm())
        .fold(0.0, f64::max);
    let weight: f64 = (1..blocks.n_blocks()).map(|b| blocks.mass(b) * 9.81).sum();
    let reaction = -blocks.contact_force(0).force.z;
    println!("{:?}", blocks.contact_solution());
    // the blocks sleep, so that what a residual leaves moves none of them
    assert_below("drift in 60 s", drift, 1e-10);
    assert_eq!(blocks.n_asleep(), 50);
    assert_close("reaction", reaction, weight, 1e-6);
    assert_eq!(blocks.solved_steps().n_unsolved, 0);
    let contacts = blocks.contacts();
    let at_foot = contacts.iter().filter(|c| c.blocks.0.index() == 0);
    let sum: f64 = at_foot.map(|c| c.normal_force).sum();
    assert_close("points at the foot", sum, weight, 1e-6);
    assert_eq!(contacts.len(), blocks.n_contacts());
    assert!(contacts.iter().all(|c| c.state == ContactState::Stick));
}

/// N10: an arch of 27 voussoirs stands for thicknesses above 0.10711 of its radius (Milankovitch 1907, Heyman 1969).
#[test]
fn the_thinnest_arch() {
    let fall = |thickness: f64, time: f64| {
        let mut blocks = Blocks::new(
            arch(27, thickness),
            vec![joint(2.0, 0.0)],
            settings(down(), 1e-6),
        )
        .unwrap();
        let crown = blocks.centroid(13).z;
        run(&mut blocks, (0.0, time), 0.01);
        let weight: f64 = (0..27).map(|b| blocks.mass(b) * 9.81).sum();
        let reaction = -(blocks.contact_force(27).force.z + blocks.contact_force(28).force.z);
        (crown - blocks.centroid(13).z, reaction / weight)
    };
    let (stands, reaction) = fall(0.10711 * 1.01, 3.0);
    println!("arch 1 % above: crown {stands:.2e} m lower, reaction {reaction:.8} weights");
    assert!(stands < 1e-3 && (reaction - 1.0).abs() < 1e-4);
    let (falls, _) = fall(0.10711 * 0.985, 4.0);
    println!("arch 1.5 % below: crown {falls:.2e} m lower");
    assert!(0.1 < falls);
}

/// N14: one sphere on three falls at a friction of 0.31, and stands at 0.325.
#[test]
fn three_spheres_carry_a_fourth_by_friction() {
    let sinks = |friction: f64| {
        let radius = 0.5;
        let around = |k: u32| {
            let angle = f64::from(k) * std::f64::consts::TAU / 3.0;
            let far = 2.0 * radius / 3.0_f64.sqrt();
            Vec3::new(far * angle.cos(), far * angle.sin(), radius)
        };
        let height = radius + 2.0 * radius * (2.0_f64 / 3.0).sqrt();
        let mut definitions = vec![floor()];
        definitions.extend((0..3).map(|k| ball(around(k), radius)));
        definitions.push(ball(Vec3::new(0.0, 0.0, height), radius));
        let mut blocks = blocks(definitions, joint(friction, 0.0), down());
        run(&mut blocks, (0.0, 3.0), 0.005);
        height - blocks.centroid(4).z
    };
    let (stands, falls) = (sinks(0.325), sinks(0.31));
    println!("a sphere on three: sinks by {stands:.1e} m at 0.325, {falls:.2} m at 0.31");
    assert!(stands < 1e-3 && 0.2 < falls);
}

/// A slender double pyramid that slides on its tip, tilted by tan θ = 2: `J = m a²/10` about its middle, so that `W_nn` is 1 + 10 cos² θ = 3 and
/// `W_nt` 10 sin θ cos θ = 4 over its mass. Friction above 3/4 is told, friction below it is not.
#[test]
fn friction_above_painleves_limit_is_told() {
    let most = |friction: f64| {
        let tilt = 2.0_f64.atan();
        let across = [[0.01, 0.0], [0.0, 0.01], [-0.01, 0.0], [0.0, -0.01]];
        let mut corners = vec![Vec3::x(), -Vec3::x()];
        corners.extend(across.map(|[y, z]| Vec3::new(0.0, y, z)));
        let spindle = Polyhedron::convex_hull(&corners).unwrap();
        let place = Isometry::new(Vec3::z() * tilt.sin(), Vec3::y() * tilt);
        let spindle = block(spindle.transformed(&place), Motion::Free);
        let definitions = vec![floor(), moving(spindle, [1.0, 0.0, 0.0])];
        let mut blocks = blocks(definitions, joint(friction, 0.0), down());
        run(&mut blocks, (0.0, 0.01), 0.001);
        blocks.solved_steps().most_above_painleve
    };
    assert_eq!(most(0.7), 0);
    assert!(0 < most(0.8));
}

/// The same bits with one thread and several, and through a checkpoint.
#[test]
fn heaps_have_the_same_bits_for_any_threads_and_through_a_checkpoint() {
    let heap = || {
        let mut random = Random::new(9);
        let mut definitions = vec![floor()];
        for k in 0..60 {
            let place =
                Vec3::from([k % 4, k / 4 % 4, k / 16].map(f64::from)) * 1.5 + Vec3::z() * 0.8;
            let hull = random
                .hull()
                .transformed(&Isometry::new(place, random.vector()));
            definitions.push(block(hull, Motion::Free));
        }
        Blocks::new(definitions, vec![joint(0.5, 0.2)], settings(down(), 1e-4)).unwrap()
    };
    let state = |blocks: &Blocks| -> Vec<Vec3> {
        (0..blocks.n_blocks())
            .flat_map(|b| [blocks.centroid(b), blocks.velocity(b)])
            .collect()
    };
    let ran = |threads: usize| {
        on_threads(threads, || {
            let mut blocks = heap();
            run(&mut blocks, (0.0, 0.8), 0.005);
            blocks
        })
    };
    assert!(state(&ran(1)) == state(&ran(4)));
    let mut first = heap();
    run(&mut first, (0.0, 0.4), 0.005);
    let bytes = first.save(Vec::new()).unwrap();
    let mut resumed = heap();
    assert!(resumed.read(&bytes).unwrap().is_empty());
    run(&mut resumed, (0.4, 0.8), 0.005);
    run(&mut first, (0.4, 0.8), 0.005);
    assert!(state(&first) == state(&resumed));
}

/// What contact dynamics does not model is refused.
#[test]
fn what_contact_dynamics_does_not_model_is_refused() {
    let refused = |material: Material, settings: Settings| {
        let made = Blocks::new(vec![floor()], vec![material], settings);
        matches!(made, Err(BlockError::Setting { .. }))
    };
    let right = settings(down(), 1e-4);
    assert!(!refused(rock(), right));
    let residual = Material {
        cohesion: 1.0,
        residual_cohesion: 1.0,
        ..rock()
    };
    let rolling = Material {
        rolling_friction: 0.1,
        ..rock()
    };
    assert!(refused(residual, right));
    let own = Settings {
        rolling_law: RollingLaw::OwnSpin,
        ..right
    };
    assert!(!refused(rolling, right) && refused(rolling, own));
    assert!(refused(rock(), settings(down(), 0.0)));
    let twisting = Material {
        twisting_friction: 0.1,
        ..rock()
    };
    let springs = Settings {
        integrator: Integrator::CentralDifference,
        ..right
    };
    assert!(!refused(rock(), springs) && !refused(twisting, right) && refused(twisting, springs));
}

/// A floor that moves at 1 m/s takes a block along that lies on it at rest: by friction to v/(μ g), then as one. Half of its work becomes heat.
#[test]
fn a_floor_that_moves_takes_a_block_along() {
    let path = PrescribedMotion::Table {
        // on its way before and after
        time: (-2..=2).map(|k| 10.0 * f64::from(k)).collect(),
        displacement: (-2..=2)
            .map(|k| Vec3::x() * (10.0 * f64::from(k)))
            .collect(),
        turning: Vec::new(),
    };
    let mut ground = floor();
    ground.motion = Motion::Prescribed(path);
    let slab = block(cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 0.2]), Motion::Free);
    let mut blocks = blocks(vec![ground, slab], joint(0.3, 0.0), down());
    run(&mut blocks, (0.0, 0.2), 0.005);
    assert_close(
        "speed on the way",
        blocks.velocity(1).x,
        0.3 * 9.81 * 0.2,
        1e-6,
    );
    run(&mut blocks, (0.2, 1.0), 0.005);
    assert_close("speed at last", blocks.velocity(1).x, 1.0, 1e-9);
    let slip = 1.0 / (2.0 * 0.3 * 9.81);
    // first order: half a step of slip
    assert_close("way", blocks.centroid(1).x, 1.0 - slip, 5e-3);
    let energies = blocks.energies();
    assert_close("work", energies.external_work, blocks.mass(1), 1e-6);
    assert_close("heat", energies.friction, 0.5 * blocks.mass(1), 1e-6);
    assert_below("account", energies.balance().abs() / blocks.mass(1), 1.0);
}

/// N21: cubes that have fallen into a bin lie as high by contact dynamics as by springs.
#[test]
fn a_pile_is_as_high_as_by_springs() {
    let side = 4;
    let pile = |integrator: Integrator| {
        let mut random = Random::new(1);
        let width = 1.45 * f64::from(side);
        let wall = |from: [f64; 3], to: [f64; 3]| block(cuboid(from, to), Motion::Fixed);
        let far = width + 1.0;
        let mut definitions = vec![
            wall([-1.0, -1.0, -1.0], [far, far, 0.0]),
            wall([-1.0, -1.0, 0.0], [0.0, far, 9.0]),
            wall([width, -1.0, 0.0], [far, far, 9.0]),
            wall([0.0, -1.0, 0.0], [width, 0.0, 9.0]),
            wall([0.0, width, 0.0], [width, far, 9.0]),
        ];
        for k in 0..side * side * side {
            let place = Vec3::from([k % side, k / side % side, k / side / side].map(f64::from));
            let center = (place + Vec3::repeat(0.5)) * 1.45 + Vec3::z() * 0.2;
            let cube = cuboid([-0.5; 3], [0.5; 3]);
            let turned = cube.transformed(&Isometry::new(center, random.vector() * 0.3));
            definitions.push(block(turned, Motion::Free));
        }
        let settings = Settings {
            integrator,
            ..Settings::default()
        };
        Blocks::new(definitions, vec![joint(0.5, 0.3)], settings).unwrap()
    };
    let height = |blocks: &Blocks| {
        let n = blocks.n_blocks();
        (5..n).map(|b| blocks.centroid(b).z).sum::<f64>() / (n - 5) as f64
    };
    let mut by_springs = pile(Integrator::CentralDifference);
    crate::setup::run(&mut by_springs, 3.0, 1.0, 1e-2);
    let dynamics = Integrator::ContactDynamics(ContactDynamics::default());
    let mut together = pile(dynamics);
    run(&mut together, (0.0, 3.0), 0.005);
    let energies = together.energies();
    let lost = energies.friction + energies.damping;
    println!(
        "overlap {:.1e} sizes, removal of overlap {:+.1e} of what is lost, {:?}, {} unsolved",
        together.max_overlap_over_size(),
        energies.overlap_removal / lost,
        together.contact_solution(),
        together.solved_steps().n_unsolved
    );
    // asked 2 %
    assert_close("height", height(&together), height(&by_springs), 0.02);
    assert!(together.solved_steps().n_unsolved == 0 && energies.kinetic < 1e-3 * lost);
}
