//! The contact law: collisions, limits, damping, bonds.

use crate::setup::*;
use riprap_dda::{
    Blocks, Isometry, Material, Motion, Polyhedron, Settings, Shape, Vec3, separating_axes,
};

fn elastic() -> Material {
    Material {
        restitution: 1.0,
        contact_stiffness: 1e7,
        ..rock()
    }
}

/// D14: two equal blocks head-on exchange their velocities in π √(m_e/K).
#[test]
fn head_on_collision() {
    for is_ball in [false, true] {
        let side = 0.4;
        let make = |x: f64| {
            if is_ball {
                ball(Vec3::new(x, 0.0, 0.0), side / 2.0)
            } else {
                block(
                    cuboid([x - 0.2, -0.2, -0.2], [x + 0.2, 0.2, 0.2]),
                    Motion::Free,
                )
            }
        };
        let gap = 1e-3;
        let definitions = vec![moving(make(0.0), [1.0, 0.0, 0.0]), make(side + gap)];
        let mut blocks = blocks(definitions, elastic(), Vec3::zeros());
        let duration = std::f64::consts::PI * (blocks.mass(0) / 2.0 / 1e7).sqrt();
        let dt = duration / 2000.0;
        let mut touching = 0;
        for k in 0..4000 {
            blocks.advance(f64::from(k) * dt, dt, 1).unwrap();
            touching += u32::from(blocks.contact_force(0).force.x != 0.0);
        }
        assert_close("duration", f64::from(touching) * dt, duration, 5e-3);
        assert_below("left with the first", blocks.velocity(0).x.abs(), 5e-3);
        assert_close("gone to the second", blocks.velocity(1).x, 1.0, 5e-3);
    }
}

/// Restitution as asked, for a flat hit; the clamped formula.
#[test]
fn restitution() {
    for e in [0.2, 0.5, 0.8] {
        let material = Material {
            restitution: e,
            ..elastic()
        };
        let stone = moving(
            block(cuboid([0.0, 0.0, 1e-4], [0.4, 0.4, 0.4]), Motion::Free),
            [0.0, 0.0, -1.0],
        );
        let mut blocks = blocks(vec![floor(), stone], material, Vec3::zeros());
        run_steps(&mut blocks, 0.03, 20_000);
        assert_close(&format!("rebound {e}"), blocks.velocity(1).z, e, 2e-3);
    }
}

/// D18: collisions of free bodies keep P and L.
#[test]
fn collisions_keep_momentum() {
    let mut random = Random::new(5);
    for _ in 0..10 {
        let mut first = block(random.hull(), Motion::Free);
        let mut second = block(
            random
                .hull()
                .transformed(&Isometry::translation(1.6, 0.2, 0.1)),
            Motion::Free,
        );
        first.velocity = Vec3::new(4.0, 0.0, 0.0);
        first.angular_velocity = random.vector() * 3.0;
        second.angular_velocity = random.vector() * 3.0;
        let material = Material {
            restitution: 0.3,
            ..elastic()
        };
        let mut blocks = blocks(vec![first, second], material, Vec3::zeros());
        let angular = |b: &Blocks| -> Vec3 {
            (0..2)
                .map(|k| b.spin_momentum(k) + b.centroid(k).cross(&(b.velocity(k) * b.mass(k))))
                .sum()
        };
        let (p, l) = (blocks.momentum(), angular(&blocks));
        run_steps(&mut blocks, 0.5, 10_000);
        assert!(blocks.contact_updates() > 0, "they hit");
        assert_below("P", (blocks.momentum() - p).norm() / p.norm(), 1e-12);
        assert_below("L", (angular(&blocks) - l).norm() / p.norm(), 1e-12);
    }
}

/// Step limit of a spring with a lagged dashpot whose force is divided by `1 + c w dt/4 = 1 + ξωdt/2`: from
/// `(ωdt/2)² + ξωdt/(1 + ξωdt/2) = 1`, which lies above the (2/ω)(√(1 + ξ²) − ξ) of the whole dashpot.
fn step_limit(omega: f64, xi: f64) -> f64 {
    let (mut low, mut high) = (0.0, 2.0 / omega);
    for _ in 0..60 {
        let dt = 0.5 * (low + high);
        let y = omega * dt;
        if 0.25 * y * y + xi * y / (1.0 + 0.5 * xi * y) < 1.0 {
            low = dt;
        } else {
            high = dt;
        }
    }
    low
}

/// D22: the limit of a lagged dashpot, and that the bound of the whole one is on the safe side of it.
#[test]
fn step_limit_with_damping() {
    for e in [1.0, 0.5, 0.1] {
        let material = Material {
            restitution: e,
            shear_stiffness_ratio: 0.0,
            rolling_friction: 0.0,
            twisting_friction: 0.0,
            ..elastic()
        };
        let weight = 2500.0 * G;
        let xi: f64 = riprap_dda::damping_ratio(e);
        let omega = (1e7_f64 / 2500.0).sqrt();
        let limit = step_limit(omega, xi);
        assert!(limit * (1.0 + 1e-12) >= 2.0 / omega * ((1.0 + xi * xi).sqrt() - xi));
        for (share, grows) in [(0.98, false), (1.02, true)] {
            let sunk = weight / 1e7;
            // A push that is small against the static overlap: no contact opens at first.
            let stone = moving(
                block(
                    cuboid([0.0, 0.0, -sunk], [1.0, 1.0, 1.0 - sunk]),
                    Motion::Free,
                ),
                [0.0, 0.0, 1e-6],
            );
            let mut blocks = blocks(vec![floor(), stone], material, down());
            let mut largest = 0.0_f64;
            for _ in 0..200 {
                blocks.advance(0.0, share * limit, 1).unwrap();
                largest = largest.max(blocks.velocity(1).z.abs());
            }
            println!("e {e}, xi {xi:.3}, step {share} of the limit: largest speed {largest:.2e}");
            assert_eq!(largest > 1e-4, grows, "e {e}, share {share}: {largest:e}");
        }
    }
}

/// The bound never exceeds the true limit of a resting block.
#[test]
fn critical_step_is_safe_and_not_timid() {
    let material = Material {
        shear_stiffness_ratio: 0.8,
        shear_damping_ratio: 0.0,
        rolling_friction: 0.0,
        twisting_friction: 0.0,
        ..elastic()
    };
    let stone = block(cuboid([0.0, 0.0, -1e-3], [1.0, 1.0, 0.999]), Motion::Free);
    let settings = Settings {
        gravity: down(),
        time_step_factor: 1.0,
        ..Settings::default()
    };
    let blocks = Blocks::new(vec![floor(), stone], vec![material], settings).unwrap();
    let bound = blocks.critical_time_step();
    // Coupled sway and rock of a cube on springs: eigenvalues of K/m [k_t, −k_t/2; .., ..].
    let (k_n, k_t) = (1.0_f64, 0.8_f64);
    let (a, b, c) = (
        k_t,
        -k_t * 0.5 * 6.0_f64.sqrt(),
        6.0 * (k_t / 4.0 + k_n / 12.0),
    );
    let largest = 0.5 * (a + c) + (0.25 * (a - c).powi(2) + b * b).sqrt();
    let limit = 2.0 / (largest.max(k_n) * 1e7 / 2500.0).sqrt();
    println!(
        "bound {:.3e}, true limit {limit:.3e}, ratio {:.2}",
        bound.dt,
        bound.dt / limit
    );
    assert!(bound.dt <= limit && bound.dt >= 0.3 * limit);
    assert_eq!((bound.block, bound.contact), (Some(1), Some((0, 1))));
}

/// An impact is never integrated with an unbounded step: the bound falls before the parts touch.
#[test]
fn critical_step_before_an_impact() {
    let stone = moving(
        block(cuboid([0.0, 0.0, 0.01], [0.4, 0.4, 0.41]), Motion::Free),
        [0.0, 0.0, -3.0],
    );
    let before = blocks(vec![floor(), stone.clone()], rock(), down());
    assert!(before.contacts().is_empty());
    let stone = block(cuboid([0.0, 0.0, -1e-4], [0.4, 0.4, 0.4]), Motion::Free);
    let after = blocks(vec![floor(), stone], rock(), down());
    let (before, after) = (
        before.critical_time_step().dt,
        after.critical_time_step().dt,
    );
    println!("before {before:.2e}, after {after:.2e}");
    assert!(before <= after);
}

/// A bond holds a block under a ceiling up to T A, then breaks for good and is counted.
#[test]
fn bond_in_tension() {
    let weight = 2500.0 * G;
    for (strength, holds) in [(1.05 * weight, true), (0.95 * weight, false)] {
        let material = Material {
            tensile_strength: 2.0 * strength,
            // Without any, the least shear would break it.
            cohesion: strength,
            ..rock()
        };
        let ceiling = block(cuboid([-1.0, -1.0, 1.0], [2.0, 2.0, 2.0]), Motion::Fixed);
        let hung = block(cuboid([0.0; 3], [1.0; 3]), Motion::Free);
        // Let go from rest, the bond feels twice the weight.
        let material = Material {
            restitution: 1.0,
            ..material
        };
        let mut blocks = blocks(vec![ceiling, hung], material, down());
        run(&mut blocks, 0.2, 1.0, 1e-4);
        assert_eq!(blocks.broken_bonds() == 0, holds);
        assert_eq!(
            blocks.centroid(1).z > 0.49,
            holds,
            "{}",
            blocks.centroid(1).z
        );
    }
}

/// A bond holds on a slope steeper than the friction angle by its cohesion.
#[test]
fn bond_in_shear() {
    let shear = 2500.0 * G * 40.0_f64.to_radians().sin()
        - 2500.0 * G * 40.0_f64.to_radians().cos() * 0.5_f64.tan();
    for (share, holds) in [(2.5, true), (0.9, false)] {
        let material = Material {
            cohesion: share * shear,
            // The weight acts outside of the middle third of the base: its uphill edge pulls with
            // 6 M/(b h²) − N/A = 28 kPa, and with some more as the block is let go.
            tensile_strength: 1e5,
            restitution: 0.2,
            ..rock()
        };
        let stone = block(cuboid([0.0; 3], [1.0; 3]), Motion::Free);
        let mut blocks = blocks(
            vec![floor(), stone],
            material,
            on_slope(40.0_f64.to_radians()),
        );
        run(&mut blocks, 0.5, 1.0, 1e-4);
        assert_eq!(blocks.broken_bonds() == 0, holds);
        assert_eq!(
            blocks.centroid(1).x < 0.51,
            holds,
            "{}",
            blocks.centroid(1).x
        );
    }
}

/// A sphere that slides at 2 m/s rolls at 10/7 m/s after 2 v/(7 μ g).
#[test]
fn ball_starts_to_roll() {
    let material = Material {
        friction_angle: 0.3_f64.atan(),
        ..rock()
    };
    let weight = 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.001 * G;
    let thrown = moving(
        ball(Vec3::new(0.0, 0.0, 0.1 - weight / 1e8), 0.1),
        [2.0, 0.0, 0.0],
    );
    let mut blocks = blocks(vec![floor(), thrown], material, down());
    run(&mut blocks, 0.5, 1.0, 1e-4);
    assert_close("rolling speed", blocks.velocity(1).x, 10.0 / 7.0, 5e-3);
    assert_close("spin", blocks.angular_velocity(1).y, 100.0 / 7.0, 5e-3);
}

/// A keel that runs from a tip to a flatter face: the tip is met first, and the overlap is its. The face,
/// which looks more against the floor, once took the contact over and made energy from nothing. The force is the
/// slope of the springs' energy, whatever part of the keel has come in.
#[test]
fn force_of_a_keel_is_the_slope_of_its_energy() {
    let points = [
        [0.0, 0.0, 0.0], // tip
        [0.0, 0.1, 0.1], // end of the keel, where the flatter face starts
        [0.02, 0.5, 0.7],
        [-0.02, 0.5, 0.7],
        [0.08, 0.0, 0.8],
        [-0.08, 0.0, 0.8],
        [0.05, 0.3, 0.8],
        [-0.05, 0.3, 0.8],
        [0.0, -0.08, 0.8],
    ]
    .map(Vec3::from);
    let hull = Polyhedron::convex_hull(&points).unwrap();
    let pressed = |depth: f64| {
        let sunk = hull.transformed(&Isometry::translation(0.0, 0.0, -depth));
        let blocks = blocks(vec![floor(), block(sunk, Motion::Free)], elastic(), down());
        let force: f64 = blocks.contacts().iter().map(|c| c.normal_force).sum();
        (force, blocks.energies().elastic)
    };
    for depth in [1e-3, 0.05, 0.11, 0.15] {
        let force = pressed(depth).0;
        let step = 1e-6;
        let slope = (pressed(depth + step).1 - pressed(depth - step).1) / (2.0 * step);
        println!("depth {depth}: force {:.3} K depth", force / (1e7 * depth));
        // Differences of energies of 1 to 1e5 J over 1e-6 m: 1e-7 of them.
        assert_close("force over slope", force / slope, 1.0, 1e-6);
        assert!(
            force > 1e7 * depth / 30.0 && force <= 1e7 * depth,
            "{force}"
        );
    }
}

/// Thin plates at 10 to 300 m/s against a thin wall: stopped, or the run is, but never through.
#[test]
fn thin_plates_do_not_pass() {
    for stiffness in [1e7, 1e9, 1e11] {
        for speed in [10.0, 100.0, 300.0] {
            let material = Material {
                restitution: 0.5,
                contact_stiffness: stiffness,
                ..rock()
            };
            let wall = block(cuboid([-2.0, -2.0, -0.01], [2.0, 2.0, 0.0]), Motion::Fixed);
            let plate = block(cuboid([-0.5, -0.5, 0.5], [0.5, 0.5, 0.51]), Motion::Free);
            let plate = moving(plate, [0.0, 0.0, -speed]);
            let mut blocks = blocks(vec![wall, plate], material, Vec3::zeros());
            let (mut time, mut outcome) = (0.0, "bounced");
            while time < 1.2 / speed {
                let dt = blocks.critical_time_step().dt;
                if let Err(error) = blocks.advance(time, dt, 1) {
                    assert!(
                        error.to_string().contains("raise the contact stiffness"),
                        "{error}"
                    );
                    outcome = "refused";
                    break;
                }
                time += dt;
            }
            println!("K {stiffness:.0e}, {speed} m/s: {outcome}");
            // v √(m/K) against half the thickness: what must be refused is, what must bounce does.
            let deep = speed * (25.0 / stiffness).sqrt();
            // Past the wall's middle it would be pushed out below.
            assert!(
                blocks.centroid(1).z > -0.005,
                "through: {}",
                blocks.centroid(1).z
            );
            if deep < 0.3 * 0.005 {
                assert!(outcome == "bounced" && blocks.velocity(1).z > 0.4 * speed);
            }
            if deep > 2.0 * 0.005 {
                assert_eq!(outcome, "refused");
            }
        }
    }
}

/// A plate dips into a thick block by 0.7 of its own thickness and comes back: the mid-planes that must not pass each other are
/// more than half a meter apart. Face on, without loss, as fast as it came.
#[test]
fn thin_plate_may_dip_into_something_thick() {
    let (speed, depth) = (10.0_f64, 0.07_f64);
    let mass = rock().density * 0.1;
    let material = Material {
        contact_stiffness: mass * (speed / depth).powi(2),
        restitution: 1.0,
        ..rock()
    };
    let thick = block(cuboid([-2.0, -2.0, -1.0], [2.0, 2.0, 0.0]), Motion::Fixed);
    let plate = block(cuboid([-0.5, -0.5, 0.01], [0.5, 0.5, 0.11]), Motion::Free);
    let plate = moving(plate, [0.0, 0.0, -speed]);
    let mut blocks = blocks(vec![thick, plate], material, Vec3::zeros());
    let (mut time, mut deepest) = (0.0, 0.0_f64);
    while time < 0.05 {
        let dt = 0.1 * blocks.critical_time_step().dt;
        blocks.advance(time, dt, 1).unwrap();
        deepest = deepest.max(0.05 - blocks.centroid(1).z);
        time += dt;
    }
    // v √(m/K), a spring of second order in ω dt = 0.2 at most
    assert!((deepest - depth).abs() < 0.01 * depth, "{deepest}");
    assert!((blocks.velocity(1).z - speed).abs() < 0.01 * speed);
}

/// Plates that spin as they meet a thin wall, and two free plates that meet: they bounce or the run is refused, never do
/// they pass.
#[test]
fn spinning_and_free_plates_do_not_pass() {
    let plate = || cuboid([-0.5, -0.5, -0.005], [0.5, 0.5, 0.005]);
    let at = |z: f64, turn: Vec3| plate().transformed(&Isometry::new(Vec3::new(0.0, 0.0, z), turn));
    let mut counts = (0, 0);
    for per_area in [false, true] {
        for stiffness in [1e7, 1e9, 1e11] {
            let material = Material {
                restitution: 0.5,
                contact_stiffness: stiffness,
                joint_stiffness: per_area.then_some(stiffness),
                ..rock()
            };
            for speed in [3.0, 10.0, 30.0, 100.0, 300.0] {
                for spin in [
                    Vec3::zeros(),
                    Vec3::new(0.0, 0.0, 1.0),
                    Vec3::new(1.0, 0.3, 0.0),
                    Vec3::new(0.7, -0.8, 2.0),
                ] {
                    for is_free in [false, true] {
                        let spin = spin * speed;
                        let turn = Vec3::new(0.1, 0.05, 0.3);
                        let first = block(at(0.6, turn), Motion::Free);
                        let mut first = moving(first, [0.0, 0.0, -speed]);
                        first.angular_velocity = spin;
                        let other = if is_free {
                            moving(
                                block(at(-0.6, -turn), Motion::Free),
                                [0.0, 0.0, 0.3 * speed],
                            )
                        } else {
                            let wall = cuboid([-3.0, -3.0, -0.01], [3.0, 3.0, 0.0]);
                            block(wall, Motion::Fixed)
                        };
                        let definitions = vec![other, first];
                        let mut blocks = blocks(definitions, material, Vec3::zeros());
                        let bounced = meet(&mut blocks, 2.4 / speed);
                        if bounced {
                            counts.0 += 1;
                        } else {
                            counts.1 += 1;
                        }
                        // Both plates face each other over their whole width: what passed would be below.
                        let case = format!(
                            "K {stiffness:.0e}, per area {per_area}, {speed} m/s, {spin:?}, free {is_free}"
                        );
                        let gap = blocks.centroid(1).z - blocks.centroid(0).z;
                        assert!(gap > -0.005, "passed, {case}: {gap}");
                    }
                }
            }
        }
    }
    println!("{} bounced, {} refused", counts.0, counts.1);
    assert!(counts.0 > 0 && counts.1 > 0);
}

/// Runs for a time (s); false if the overlap was refused.
fn meet(blocks: &mut Blocks, end: f64) -> bool {
    let mut time = 0.0;
    while time < end {
        let dt = blocks.critical_time_step().dt;
        if let Err(error) = blocks.advance(time, dt, 1) {
            let text = error.to_string();
            assert!(text.contains("raise the contact stiffness"), "{text}");
            return false;
        }
        time += dt;
    }
    true
}

/// Two plates of three wedges each meet face on: the middle wedges touch only by edges between covered faces, and have no contact of
/// their own. Hit centrally they exchange their velocities, as whole plates do.
#[test]
fn wedges_that_touch_between_their_siblings_have_no_contact() {
    let plate = |side: f64, y: f64| {
        let wedge = |corners: [[f64; 2]; 3]| {
            let points: Vec<Vec3> = corners
                .iter()
                .flat_map(|&[x, depth]| [0.0, 0.5].map(|z| Vec3::new(x, y + side * depth, z)))
                .collect();
            Polyhedron::convex_hull(&points).unwrap()
        };
        let parts = vec![
            wedge([[0.0, 0.0], [0.0, 2.0], [1.0, 0.0]]),
            wedge([[1.0, 0.0], [0.0, 2.0], [2.0, 2.0]]),
            wedge([[1.0, 0.0], [2.0, 2.0], [2.0, 0.0]]),
        ];
        riprap_dda::BlockDefinition {
            shape: Shape::Polyhedra(parts),
            ..block(cuboid([0.0; 3], [1.0; 3]), Motion::Free)
        }
    };
    let definitions = vec![moving(plate(-1.0, 0.0), [0.0, 0.5, 0.0]), plate(1.0, 1e-4)];
    let mut blocks = blocks(definitions, elastic(), Vec3::zeros());
    let dt = 2e-5;
    for k in 0..5000 {
        blocks.advance(f64::from(k) * dt, dt, 1).unwrap();
    }
    let (first, second) = (blocks.velocity(0), blocks.velocity(1));
    // half a step of one contact of some hundred steps
    assert_below("left with the first", first.norm(), 5e-3);
    assert_close("given to the second", second.y, 0.5, 5e-3);
    assert_below("turned", blocks.angular_velocity(1).norm(), 1e-3);
}

/// Boxes of two halves each press side by side, tilted a little: the halves see no deeper than the boxes do. Corners on the seams are
/// none of the boxes'; once the halves then took hold of each other behind their backs, as deep as they are thick. Cut from a rounded
/// surface halves do not quite fit: with dents and bulges of milliradians at the seams they are boxes still.
#[test]
fn halves_see_no_deeper_than_the_whole() {
    let whole = cuboid([-0.35, -0.5, -0.5], [0.35, 0.5, 0.5]);
    let across = Vec3::new(-0.65, -0.33, 0.69).normalize();
    let seam = riprap_dda::Plane::through(&Vec3::zeros(), &across);
    let (below, above) = whole.cut(&seam).unwrap().unwrap();
    let mut random = Random::new(8);
    for bend in [0.0, 0.002] {
        let mut n_touching = 0;
        for trial in 0..2000 {
            // side by side, or in any attitude
            let (tilt, shift) = match trial % 2 {
                0 => (0.1, 0.2),
                _ => (3.0, 0.5),
            };
            let tilt = Isometry::rotation(random.vector() * tilt);
            let shift = random.vector() * shift;
            let near = Isometry::translation(shift.x, 1.0, shift.z) * tilt;
            let apart = separating_axes(&whole, &whole.transformed(&near)).best();
            let by = if trial % 4 < 2 { 0.005 } else { 0.05 };
            let pressed = apart.normal * (-by - apart.gap);
            let place = Isometry::translation(pressed.x, pressed.y, pressed.z) * near;
            let depth = -separating_axes(&whole, &whole.transformed(&place))
                .best()
                .gap;
            let mut halves = |placement: Isometry| {
                let lean = random.vector() * bend;
                let bent: Vec<Vec3> = above
                    .vertices()
                    .iter()
                    .map(|x| x + lean * across.dot(x))
                    .collect();
                let bent = Polyhedron::convex_hull(&bent).unwrap();
                riprap_dda::BlockDefinition {
                    shape: Shape::Polyhedra(vec![
                        below.transformed(&placement),
                        bent.transformed(&placement),
                    ]),
                    ..block(whole.clone(), Motion::Free)
                }
            };
            let definitions = vec![halves(Isometry::identity()), halves(place)];
            let mut blocks = blocks(definitions, elastic(), Vec3::zeros());
            blocks.advance(0.0, 1e-6, 1).unwrap();
            let contacts = blocks.contacts();
            let deepest = contacts.iter().map(|c| c.overlap).fold(0.0, f64::max);
            n_touching += usize::from(deepest > 0.0);
            // corners of both move by the lean times their distance from the seam, at most 0.8 m
            let moved = 2.0 * 0.8 * bend;
            // in a hundredth of a thickness everything is as good as a face, and what is less than twice as deep as could be
            let most = 2.0 * (depth + moved) + 0.007;
            assert!(deepest < most, "{bend}: {deepest} of {depth}");
            let least = 0.9 * (depth - moved);
            assert!(deepest > least, "{bend}: {deepest} of {depth}");
        }
        // no contact is lost
        assert_eq!(n_touching, 2000);
    }
}
