//! Surfaces of triangles: no kicks at inner edges, ridges and valleys, rims, conservation (G08).

use std::sync::Arc;

use crate::setup::{
    G, Random, assert_below, assert_close, ball, block, blocks, cuboid, down, ledger, moving, rock,
    run,
};
use riprap_dda::{
    BlockDefinition, BlockError, Blocks, Isometry, Material, Motion, Shape, Surface, SurfaceError,
    Vec3,
};

/// A surface over a grid of points, each moved in its cell, at the heights of a function.
pub fn raster(n: usize, width: f64, shake: f64, height: impl Fn(f64, f64) -> f64) -> Surface {
    let mut random = Random::new(3);
    let at = |i: usize, j: usize| (j * (n + 1) + i) as u32;
    let mut vertices = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let inner = |k: usize| if k == 0 || k == n { 0.0 } else { shake };
            let cell = width / n as f64;
            let move_by = random.vector() * cell;
            let x = -0.5 * width + i as f64 * cell + inner(i) * move_by.x;
            let y = -0.5 * width + j as f64 * cell + inner(j) * move_by.y;
            vertices.push(Vec3::new(x, y, height(x, y)));
        }
    }
    let mut triangles = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if (i + j) % 2 == 0 {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    Surface::new(vertices, triangles).unwrap()
}

pub fn ground(surface: Surface) -> BlockDefinition {
    BlockDefinition {
        shape: Shape::Surface(Arc::new(surface)),
        ..block(cuboid([0.0; 3], [1.0; 3]), Motion::Fixed)
    }
}

fn smooth() -> Material {
    Material {
        friction_angle: 0.0,
        restitution: 1.0,
        ..rock()
    }
}

#[test]
fn ball_crosses_a_diagonal_without_a_kick() {
    let material = Material {
        shear_stiffness_ratio: 2.0 / 7.0,
        ..rock()
    };
    let mass = material.density * 4.0 / 3.0 * std::f64::consts::PI * 0.125;
    let height = 0.5 - mass * G / material.contact_stiffness;
    for n in [1, 7] {
        let mut start = moving(ball(Vec3::new(-1.0, -0.6, height), 0.5), [2.0, 1.1, 0.0]);
        start.angular_velocity = Vec3::new(-2.2, 4.0, 0.0);
        let flat = ground(raster(n, 6.0, 0.3, |_, _| 0.0));
        let mut system = blocks(vec![flat, start], material, down());
        let (mut time, mut kick) = (0.0, 0.0_f64);
        while time < 1.0 {
            let dt = 0.8 * system.critical_time_step().dt;
            system.advance(time, dt, 1).unwrap();
            time += dt;
            kick = kick.max(system.velocity(1).z.abs());
            assert_eq!((system.contacts().len(), system.n_contacts()), (1, 1));
        }
        assert!(system.centroid(1).x > 0.9);
        assert_below("kick", kick, 1e-10);
    }
}

/// The plane's frame, where gravity is `on_slope(30°)`, turned so that no coordinate is round.
fn tilt() -> Isometry {
    let steep = Isometry::rotation(Vec3::y() * 30.0_f64.to_radians());
    Isometry::rotation(Vec3::new(0.0, 0.0, 0.7)) * steep
}

/// Place and velocity of a block after two seconds on a plane of `n` by `n` squares, in the plane's frame.
fn slide(
    n: usize,
    shape: riprap_dda::Polyhedron,
    friction: f64,
    start: Vec3,
) -> (Vec3, Vec3, Blocks) {
    let material = Material {
        friction_angle: friction.to_radians(),
        ..rock()
    };
    let place = tilt() * Isometry::translation(start.x, start.y, start.z);
    let body = block(shape.transformed(&place), Motion::Free);
    let plane = ground(raster(n, 40.0, 0.3, |_, _| 0.0).transformed(&tilt()));
    let mut system = blocks(vec![plane, body], material, down());
    // Not the critical step: it differs in the last digits.
    system.advance(0.0, 2.0, 8000).unwrap();
    let back = tilt().inverse();
    (
        back.rotation * system.centroid(1),
        back.rotation * system.velocity(1),
        system,
    )
}

#[test]
fn block_follows_the_plane_whatever_its_triangles() {
    let angle = 30.0_f64.to_radians();
    let sink = 2500.0 * G * angle.cos() / 1e8;
    let cube = || cuboid([-0.5, -0.5, 0.0], [0.5, 0.5, 1.0]);
    let start = Vec3::new(-8.0, 0.2, -sink);
    let (place, velocity, mut one) = slide(1, cube(), 20.0, start);
    for n in [9, 40] {
        let (other, _, system) = slide(n, cube(), 20.0, start);
        let apart = (other - place).norm() / (place - start).norm();
        assert_below("apart, of the way", apart, 1e-6);
        assert_below("turning", system.angular_velocity(1).norm(), 1e-6);
    }
    // While its shear spring takes up the load, the block gains 0.02 m/s; from then on it is Coulomb's.
    let friction = 20.0_f64.to_radians().tan();
    let expected = G * (angle.sin() - friction * angle.cos()) * 2.0;
    let gain = 2.0 * friction * G * angle.cos() * (2500.0 / 0.8e8_f64).sqrt();
    assert!((velocity.x - expected).abs() < gain, "{velocity}");
    one.advance(2.0, 1.0, 4000).unwrap();
    let later = tilt().rotation.inverse() * one.velocity(1);
    assert_close("acceleration", later.x - velocity.x, 0.5 * expected, 1e-6);
    // Below its friction angle it stays.
    let (stays, ..) = slide(9, cube(), 35.0, start);
    // The shear spring gives way by m g sin 30/(0.8 K) and swings about that, 3e-4 at most; the block leans.
    assert_below("crept", (stays - start - Vec3::z() * 0.5).norm(), 4e-4);
    // A hull meets the edges and corners of the mesh at all angles.
    let hull = Random::new(5).hull();
    let start = Vec3::new(-8.0, 0.2, 0.9);
    let (one, ..) = slide(1, hull.clone(), 25.0, start);
    let (many, ..) = slide(40, hull, 25.0, start);
    let way = (one - start).norm();
    assert!(way > 0.3, "{way}");
    assert_below("hull", (many - one).norm() / way, 1e-6);
}

#[test]
fn hulls_and_balls_bounce_on_rough_ground_and_keep_their_energy() {
    let rough =
        |x: f64, y: f64| 0.35 * (2.1 * x).sin() * (1.7 * y + 0.4).cos() + 0.05 * (x * x + y * y);
    let mut random = Random::new(11);
    for k in 0..4 {
        let body = if k < 2 {
            let place = Isometry::new(Vec3::new(0.3, -0.2, 2.0), random.vector());
            block(random.hull().transformed(&place), Motion::Free)
        } else {
            ball(Vec3::new(0.3, -0.2, 2.0), 0.5)
        };
        let body = moving(body, [1.0, 0.5, 0.0]);
        let stiff = Material {
            contact_stiffness: 1e9,
            ..smooth()
        };
        let mut system = blocks(
            vec![ground(raster(40, 30.0, 0.2, rough)), body],
            stiff,
            down(),
        );
        let start = ledger(&system.energies());
        let scale = system.mass(1) * G * 2.0;
        let (mut time, mut worst, mut touched) = (0.0, 0.0_f64, 0);
        while time < 3.0 {
            let dt = 0.1 * system.critical_time_step().dt;
            system.advance(time, dt, 1).unwrap();
            time += dt;
            touched += usize::from(!system.contacts().is_empty());
            worst = worst.max((ledger(&system.energies()) - start).abs() / scale);
        }
        assert!(touched > 100);
        // The potential is one of place alone, but for regions that meet at a vertex: see the module.
        assert_below(&format!("ledger {k}"), worst, 1e-3);
    }
}

#[test]
fn block_in_a_valley_presses_on_both_sides() {
    // A prism of a right angle, point down, in a valley of a right angle.
    let valley = raster(4, 8.0, 0.0, |x, _| x.abs());
    let wedge =
        riprap_dda::Polyhedron::extrusion(&[[0.0, 0.0], [1.0, 1.0], [-1.0, 1.0]], 1, -0.5, 0.5)
            .unwrap()
            .remove(0);
    let mass = 2500.0;
    let mut system = blocks(
        vec![ground(valley), block(wedge, Motion::Free)],
        smooth_and_dull(),
        down(),
    );
    run(&mut system, 1.0, 0.8, 1.0);
    let contacts = system.contacts();
    let on = |sign: f64| -> f64 {
        contacts
            .iter()
            .filter(|c| c.normal.x * sign > 0.5)
            .map(|c| c.normal_force)
            .sum()
    };
    let expected = mass * G / 2.0_f64.sqrt();
    assert_close("left", on(-1.0), expected, 1e-6);
    assert_close("right", on(1.0), expected, 1e-6);
    assert_below("sideways", system.centroid(1).x.abs(), 1e-9);
}

fn smooth_and_dull() -> Material {
    Material {
        restitution: 0.0,
        ..smooth()
    }
}

#[test]
fn ridge_holds_a_block_that_lies_across_it() {
    // Only edges of the mesh carry it: a roof of 20 degrees under the middle of a plate.
    let roof = raster(2, 8.0, 0.0, |x, _| -0.36 * x.abs());
    let plate = cuboid([-1.0, -0.5, -0.002], [1.0, 0.5, 0.4]);
    let mut system = blocks(
        vec![ground(roof), block(plate, Motion::Free)],
        smooth_and_dull(),
        down(),
    );
    run(&mut system, 1.0, 0.5, 1.0);
    let up: f64 = system
        .contacts()
        .iter()
        .map(|c| -c.normal.z * c.normal_force)
        .sum();
    assert_close("weight", up, 2500.0 * 0.804 * G, 1e-3);
    assert!(system.centroid(1).z > 0.18, "{}", system.centroid(1));
}

#[test]
fn other_side_of_a_thin_wall_does_not_push() {
    // A wall 0.05 m thick, 3 m high: a body beside it is behind the far side's plane.
    let wall = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
    let vertices = vec![
        wall(-0.025, -2.0, 0.0),
        wall(-0.025, 2.0, 0.0),
        wall(-0.025, -2.0, 3.0),
        wall(-0.025, 2.0, 3.0),
        wall(0.025, -2.0, 0.0),
        wall(0.025, 2.0, 0.0),
        wall(0.025, -2.0, 3.0),
        wall(0.025, 2.0, 3.0),
    ];
    let triangles = vec![
        [0, 2, 1],
        [1, 2, 3],
        [2, 6, 3],
        [3, 6, 7],
        [4, 5, 6],
        [5, 7, 6],
    ];
    let surface = Surface::new(vertices, triangles).unwrap();
    let body = cuboid([-1.03, -0.5, 1.0], [-0.03, 0.5, 2.0]);
    let system = blocks(
        vec![
            ground(surface),
            moving(block(body, Motion::Free), [0.5, 0.0, 0.0]),
        ],
        smooth(),
        Vec3::zeros(),
    );
    assert!(system.contacts().is_empty());
    let mut system = system;
    run(&mut system, 0.1, 0.1, 1.0);
    assert_close("bounced", system.velocity(1).x, -0.5, 1e-3);
}

#[test]
fn distance_to_a_surface() {
    let rough = raster(9, 6.0, 0.3, |x, y| 0.5 * (1.3 * x).sin() * y.cos());
    let mut random = Random::new(2);
    let brute = |x: &Vec3| {
        rough
            .triangles()
            .iter()
            .flat_map(|t| {
                let [a, b, c] = t.map(|v| rough.vertices()[v as usize]);
                // Dense samples bound the distance from above.
                (0..=40).flat_map(move |i| {
                    (0..=40 - i).map(move |j| {
                        a + (b - a) * (f64::from(i) / 40.0) + (c - a) * (f64::from(j) / 40.0)
                    })
                })
            })
            .map(|y| (y - x).norm())
            .fold(f64::INFINITY, f64::min)
    };
    for _ in 0..60 {
        let x = random.vector().component_mul(&Vec3::new(2.5, 2.5, 1.5));
        let found = rough.surface_point_within(&x, f64::INFINITY).unwrap();
        let sampled = brute(&x);
        // Samples lie 0.02 m apart: the foot is nearer by that squared over the distance at most.
        assert!(found.distance.abs() <= sampled + 1e-12 && found.distance.abs() > sampled - 0.02);
        assert!((found.point + found.normal * found.distance - x).norm() < 1e-12);
        // A height field: above is outside, unless the foot lies on the rim.
        let inside = x.z < 0.5 * (1.3 * x.x).sin() * x.y.cos() - 0.1;
        let outside = x.z > 0.5 * (1.3 * x.x).sin() * x.y.cos() + 0.1;
        assert!(if inside {
            found.distance < 0.0
        } else {
            !outside || found.distance > 0.0
        });
        assert!(
            rough
                .surface_point_within(&x, 0.5 * found.distance.abs())
                .is_none()
        );
    }
}

#[test]
fn bad_surfaces_are_refused() {
    let corners = || vec![Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()];
    let refused = |vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>| {
        Surface::new(vertices, triangles).unwrap_err()
    };
    assert_eq!(refused(corners(), vec![]), SurfaceError::Empty);
    assert_eq!(
        refused(corners(), vec![[0, 1, 2], [0, 1, 7]]),
        SurfaceError::NoSuchVertex {
            triangle: 1,
            vertex: 7,
            n_vertices: 4
        }
    );
    assert_eq!(
        refused(corners(), vec![[0, 1, 1]]),
        SurfaceError::Degenerate { triangle: 0 }
    );
    assert_eq!(
        refused(corners(), vec![[0, 1, 2], [0, 1, 3]]),
        SurfaceError::Orientation {
            first: 0,
            second: 1,
            from: 0,
            to: 1
        }
    );
    let mut broken = corners();
    broken[3].x = f64::NAN;
    assert_eq!(
        refused(broken, vec![[0, 1, 2]]),
        SurfaceError::NotFinite { vertex: 3 }
    );
    let free = BlockDefinition {
        motion: Motion::Free,
        ..ground(raster(1, 1.0, 0.0, |_, _| 0.0))
    };
    let error = Blocks::new(vec![free], vec![rock()], riprap_dda::Settings::default()).unwrap_err();
    assert_eq!(error, BlockError::Surface { block: 0 });
}

/// The top of a cliff bears a body that juts out over its edge, turned a little so that its sides look at the wall of the cliff. How
/// the wall is cut into triangles does not matter: behind a sliver along the edge the top is nearer than the rest of the wall, which
/// once pushed the body as far as it reached over the top.
#[test]
fn slivers_along_a_ridge_do_not_matter() {
    let cliff = |heights: &[f64]| {
        let mut vertices = vec![Vec3::new(-5.0, 5.0, 0.0), Vec3::new(5.0, 5.0, 0.0)];
        vertices.extend(
            heights
                .iter()
                .flat_map(|&z| [Vec3::new(-5.0, 0.0, z), Vec3::new(5.0, 0.0, z)]),
        );
        let mut triangles = vec![[0, 2, 3], [0, 3, 1]];
        for row in (2..).step_by(2).take(heights.len() - 1) {
            triangles.extend([[row, row + 2, row + 3], [row, row + 3, row + 1]]);
        }
        Surface::new(vertices, triangles).unwrap()
    };
    let sunk = 0.02;
    let place = Isometry::new(Vec3::new(0.3, 0.4, 0.5 - sunk), Vec3::new(0.01, 0.0, 0.1));
    let body = cuboid([-1.0, -1.0, -0.5], [1.0, 1.0, 0.5]).transformed(&place);
    let loads = [
        &[0.0, -4.0][..],
        &[0.0, -0.005, -4.0],
        &[0.0, -0.005, -0.012, -4.0],
    ]
    .map(|heights| {
        let definitions = vec![ground(cliff(heights)), block(body.clone(), Motion::Free)];
        let mut system = blocks(definitions, smooth(), Vec3::zeros());
        system.advance(0.0, 1e-7, 1).unwrap();
        let contacts = system.contacts();
        let deepest = contacts.iter().map(|c| c.overlap).fold(0.0, f64::max);
        // of the corner that is lowered by the tilt
        assert!(deepest < sunk + 0.015, "{heights:?}: {deepest}");
        system.contact_force(1)
    });
    let [whole, rest @ ..] = loads;
    for (load, name) in rest.iter().zip(["one sliver", "two"]) {
        // round-off of cuts, and of a step
        let off = (load.force - whole.force).norm() / whole.force.norm();
        assert_below(name, off, 1e-6);
    }
}

/// Ground of random heights, slivers among its triangles, and a hull somewhere over it, part of them dipping in.
fn hull_over_rough_ground(random: &mut Random) -> (Surface, riprap_dda::Polyhedron) {
    let heights: Vec<f64> = (0..64).map(|_| 0.6 * random.vector().x).collect();
    let cell = |x: f64| ((x + 4.0) * 1.0).round().rem_euclid(8.0) as usize;
    let steep = 1.0 + 2.0 * random.vector().y.abs();
    let surface = raster(8, 8.0, 0.45, |x, y| steep * heights[8 * cell(x) + cell(y)]);
    let place = random.vector() * 2.0;
    let at = Vec3::new(place.x, place.y, 1.2 * steep * random.vector().z.abs());
    let hull = random
        .hull()
        .transformed(&Isometry::new(at, random.vector() * 3.0));
    (surface, hull)
}

/// Deepest of many points of the surface of a hull behind the ground; 0 if it is wholly above; m.
fn sampled_depth(surface: &Surface, hull: &riprap_dda::Polyhedron, n: usize) -> f64 {
    let mut deepest = 0.0_f64;
    let mut sample = |x: Vec3| {
        let found = surface.surface_point_within(&x, 4.0).unwrap();
        deepest = deepest.max(-found.distance);
    };
    for face in 0..hull.n_faces() {
        let corners: Vec<Vec3> = hull
            .face_vertices(face)
            .map(|v| hull.vertices()[v as usize])
            .collect();
        for k in 1..corners.len() - 1 {
            for i in 0..=n {
                for j in 0..=n - i {
                    let (u, v) = (i as f64 / n as f64, j as f64 / n as f64);
                    sample(corners[0] * (1.0 - u - v) + corners[k] * u + corners[k + 1] * v);
                }
            }
        }
    }
    deepest
}

/// False overlap against dense sampling: a hull above the ground has none, and no overlap is missed.
fn overlaps_are_exact_in_sign(n: usize, seed: u64) {
    let mut random = Random::new(seed);
    let settings = riprap_dda::Settings {
        gravity: Vec3::zeros(),
        overlap_limit: 1.0,
        ..riprap_dda::Settings::default()
    };
    let (mut n_touching, mut worst) = (0, (0.0_f64, 0.0_f64));
    for k in 0..n {
        let (surface, hull) = hull_over_rough_ground(&mut random);
        let copy = surface.clone();
        let bodies = vec![ground(surface), block(hull.clone(), Motion::Free)];
        let system = Blocks::new(bodies, vec![smooth()], settings).unwrap();
        // A spike as long as the body is half thick has its centroid on the other side of something thin.
        let centroid = copy.surface_point_within(&system.centroid(1), 4.0);
        if centroid.is_some_and(|found| found.distance < 0.0) {
            continue;
        }
        let found = system
            .contacts()
            .iter()
            .map(|c| c.overlap)
            .fold(0.0, f64::max);
        // the finer sampling where the coarse one misses the tip of a ridge
        let mut sampled = [12, 60, 400]
            .into_iter()
            .map(|fine| sampled_depth(&copy, &hull, fine));
        // of less than a millimeter the finest samples miss the tip
        let depth =
            sampled.find(|&depth| (depth > 0.0) == (found > 0.0) || (depth - found).abs() < 1e-3);
        let Some(depth) = depth else {
            panic!("{k}: overlap {found} m, which no sample has");
        };
        n_touching += usize::from(found > 0.0);
        worst.0 = worst.0.max(found - depth);
        worst.1 = worst.1.max(depth - found);
    }
    println!(
        "{n_touching} of {n} touch; deeper by {:.3} m, less deep by {:.3} m",
        worst.0, worst.1
    );
    assert!(n_touching > n / 5);
}

#[test]
fn hulls_above_rough_ground_do_not_touch_it() {
    overlaps_are_exact_in_sign(400, 5);
}

/// The same of many more.
#[test]
#[ignore = "20,000 pairs"]
fn twenty_thousand_hulls_above_rough_ground_do_not_touch_it() {
    overlaps_are_exact_in_sign(20_000, 6);
}
