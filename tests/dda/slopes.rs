//! Blocks on planes against limit equilibrium and rigid-body mechanics: sliding, toppling, wedges.

use crate::setup::*;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use riprap_dda::{
    BlockDefinition, Blocks, ContactDetection, Integrator, Isometry, Material, Motion, Polyhedron,
    Settings, Vec3,
};

const STIFFNESS: f64 = 1e10;

fn joint(friction: f64) -> Material {
    Material {
        friction_angle: friction.atan(),
        contact_stiffness: STIFFNESS,
        ..rock()
    }
}

/// A block of length b along the slope, height h, 1 m wide, sunk into the floor by its weight.
fn standing(b: f64, h: f64, slope: f64) -> BlockDefinition {
    let sunk = 2500.0 * b * h * G * slope.cos() / STIFFNESS;
    block(
        cuboid([-b / 2.0, -0.5, -sunk], [b / 2.0, 0.5, h - sunk]),
        Motion::Free,
    )
}

/// Slopes of 10 to 60 degrees, friction of 0 to 60: a = g (sin θ − cos θ tan φ), or rest.
#[test]
fn inclines() {
    for integrator in both_ways() {
        inclines_by(integrator);
    }
}

fn inclines_by(integrator: Integrator) {
    let (mut worst_slide, mut worst_creep) = (0.0_f64, 0.0_f64);
    for slope_deg in (10..=60).step_by(10) {
        for friction_deg in (0..=60).step_by(10) {
            let slope = f64::from(slope_deg).to_radians();
            let friction = f64::from(friction_deg).to_radians().tan();
            // On the limit itself either is right.
            if slope_deg == friction_deg {
                continue;
            }
            // Flat: its base stays closed on every slope.
            let definitions = vec![floor(), standing(1.0, 0.1, slope)];
            let mut blocks = blocks_by(integrator, definitions, joint(friction), on_slope(slope));
            let start = blocks.centroid(1).x;
            if slope_deg > friction_deg {
                run(&mut blocks, 1.0, 1.0, 1e-3);
                let expected = 0.5 * G * (slope.sin() - slope.cos() * friction);
                let error = (blocks.centroid(1).x - start) / expected - 1.0;
                worst_slide = worst_slide.max(error.abs());
            } else {
                run(&mut blocks, 1.0, 1.0, 1e-2);
                let early = blocks.centroid(1);
                run(&mut blocks, 9.0, 1.0, 1e-2);
                worst_creep = worst_creep.max((blocks.centroid(1) - early).norm());
            }
        }
    }
    // Asked 0.1 %: the shear springs take m g sin θ/K_t, some 1e-7 m, to load.
    assert_below("sliding, relative error of the distance", worst_slide, 1e-3);
    // Asked 1e-6 of the size in 10 s.
    assert_below("creep below the friction angle, m", worst_creep, 1e-6);
}

/// A cube at mu 0.58 on 30 degrees (tan 30 = 0.577) carries its weight outside of the middle third of its base, which
/// gapes: it stops after the jolt of its release and then does not creep. Springs without a potential once kept it
/// rocking and sliding at 3 cm/s.
#[test]
fn gaping_base_does_not_creep() {
    let slope = 30.0_f64.to_radians();
    let mut blocks = blocks(
        vec![floor(), standing(1.0, 1.0, slope)],
        joint(0.58),
        on_slope(slope),
    );
    run(&mut blocks, 2.0, 1.0, 1e-2);
    let early = blocks.centroid(1);
    run(&mut blocks, 10.0, 1.0, 1e-2);
    assert_below(
        "creep in 10 s, m",
        (blocks.centroid(1) - early).norm(),
        1e-6,
    );
    assert_below("speed", blocks.velocity(1).norm(), 1e-9);
    let open = blocks
        .contacts()
        .iter()
        .map(|c| c.point.x)
        .fold(f64::INFINITY, f64::min);
    assert!(open - blocks.centroid(1).x > -0.4, "the uphill edge gapes");
}

/// The published detection alone, warm from the last step, slides as the closed form says.
#[test]
fn fast_common_plane_alone() {
    let slope = 30.0_f64.to_radians();
    let settings = Settings {
        gravity: on_slope(slope),
        contact_detection: ContactDetection::FastCommonPlane,
        ..Settings::default()
    };
    let definitions = vec![floor(), standing(1.0, 0.3, slope)];
    let mut blocks = Blocks::new(definitions, vec![joint(0.3)], settings).unwrap();
    run(&mut blocks, 1.0, 1.0, 1e-3);
    let expected = 0.5 * G * (slope.sin() - 0.3 * slope.cos());
    assert_close("distance", blocks.centroid(1).x, expected, 1e-3);
}

/// The same slide on a plane that really dips, turned by a random amount about the vertical.
#[test]
fn truly_inclined_plane() {
    let mut random = Random::new(11);
    for _ in 0..5 {
        let slope = 0.3 + 0.6 * random.next();
        let friction = 0.7 * slope.tan() * random.next();
        let turn = UnitQuaternion::from_euler_angles(0.0, slope, 0.0);
        let turn = UnitQuaternion::from_axis_angle(&Vec3::z_axis(), 6.0 * random.next()) * turn;
        let place = |definition: BlockDefinition| BlockDefinition {
            shape: definition
                .shape
                .transformed(&Isometry::from_parts(Vec3::repeat(0.3).into(), turn)),
            ..definition
        };
        let definitions = vec![place(floor()), place(standing(1.0, 0.1, slope))];
        let mut blocks = blocks(definitions, joint(friction), down());
        let start = blocks.centroid(1);
        run(&mut blocks, 1.0, 1.0, 1e-3);
        let expected = turn * Vec3::x() * (0.5 * G * (slope.sin() - slope.cos() * friction));
        let error = (blocks.centroid(1) - start - expected).norm() / expected.norm();
        assert_below("inclined plane", error, 1e-3);
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Stable,
    Slide,
    Topple,
    SlideAndTopple,
}

/// Mode of a block of slenderness b/h = tan δ on a slope α, friction φ, released from rest:
///
/// ```text
/// φ_dyn = atan [sin α − 3/4 sin(α − δ) cos δ]/[cos α + 3/4 sin(α − δ) sin δ]
/// ```
/// the friction that turning about the toe without slip needs (moment of inertia 4/3 m R² about it). The first number
/// tells how near the closest boundary is, relative.
fn chart(alpha: f64, delta: f64, phi: f64) -> (f64, Mode) {
    let lean = 0.75 * (alpha - delta).sin();
    let dynamic = ((alpha.sin() - lean * delta.cos()) / (alpha.cos() + lean * delta.sin())).atan();
    let near = |a: f64, b: f64| (a / b - 1.0).abs();
    if delta >= alpha {
        let mode = if phi >= alpha {
            Mode::Stable
        } else {
            Mode::Slide
        };
        return (near(phi, alpha).min(near(delta, alpha)), mode);
    }
    let mode = if phi >= dynamic {
        Mode::Topple
    } else if phi > delta {
        Mode::SlideAndTopple
    } else {
        Mode::Slide
    };
    (
        near(phi, dynamic)
            .min(near(phi, delta))
            .min(near(delta, alpha)),
        mode,
    )
}

fn observed(integrator: Integrator, (alpha, delta, phi): (f64, f64, f64)) -> Mode {
    let h = 1.0;
    let b = delta.tan();
    let mut blocks = blocks_by(
        integrator,
        vec![floor(), standing(b, h, alpha)],
        joint(phi.tan()),
        on_slope(alpha),
    );
    let toe = |b: &Blocks, rel: Vec3| b.pose(1).transform_point(&rel.into()).x;
    let corner = Vec3::new(b / 2.0, 0.0, 0.0);
    let start = toe(&blocks, corner);
    // A turn of a degree asks for more friction than the first instant: no further than that.
    for _ in 0..80 {
        run(&mut blocks, 0.005, 1.0, 1e-3);
        if blocks.orientation(1).angle() > 0.01 {
            break;
        }
    }
    let slid = toe(&blocks, corner) - start;
    let turned = blocks.orientation(1).angle();
    // Near a boundary, within 1 %, an acceleration of 0.01 g moves by 8 mm in 0.4 s, turns by 4 mrad; the springs
    // alone by 1e-5.
    match (slid > 2e-4, turned > 5e-4) {
        (false, false) => Mode::Stable,
        (true, false) => Mode::Slide,
        (false, true) => Mode::Topple,
        (true, true) => Mode::SlideAndTopple,
    }
}

/// Two hundred random blocks: all in the mode of the kinetic chart outside of a band of 1 % around its boundaries.
#[test]
fn modes_of_a_block_on_a_slope() {
    for integrator in both_ways() {
        modes_by(integrator);
    }
}

fn modes_by(integrator: Integrator) {
    let mut random = Random::new(3);
    let (mut n, mut wrong) = (0, Vec::new());
    while n < 200 {
        let alpha = (10.0 + 50.0 * random.next()).to_radians();
        let delta = (0.1 + 1.4 * random.next()).atan();
        let phi = (2.0 + 63.0 * random.next()).to_radians();
        let (distance, expected) = chart(alpha, delta, phi);
        if distance < 0.01 {
            continue;
        }
        n += 1;
        let found = observed(integrator, (alpha, delta, phi));
        if found != expected {
            wrong.push(format!(
                "slope {:.2}, b/h {:.3}, friction {:.2}: expected {expected:?}, found {found:?}, boundary at {distance:.3}",
                alpha.to_degrees(),
                delta.tan(),
                phi.to_degrees()
            ));
        }
    }
    println!("modes: {} of {n} right", n - wrong.len());
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Upward unit normal of a plane; dip direction clockwise from north (+y); degrees.
fn plane_normal(dip: f64, dip_direction: f64) -> Vec3 {
    let (dip, direction) = (dip.to_radians(), dip_direction.to_radians());
    Vec3::new(
        dip.sin() * direction.sin(),
        dip.sin() * direction.cos(),
        dip.cos(),
    )
}

/// Wedge on two planes, by vectors: W + N₁ n₁ + N₂ n₂ = T l with l down the line of intersection. Returns l, N₁/W, N₂/W,
/// T/W. Source: Hoek & Bray, Goodman & Shi, for friction only.
fn wedge_forces(n1: &Vec3, n2: &Vec3) -> (Vec3, f64, f64, f64) {
    let mut line = n1.cross(n2).normalize();
    if line.z > 0.0 {
        line = -line;
    }
    let solved = Matrix3::from_columns(&[*n1, *n2, -line])
        .try_inverse()
        .unwrap()
        * Vec3::z();
    (line, solved.x, solved.y, solved.z)
}

/// Two fixed slabs and between them a prism along their line, sunk in by its weight.
fn wedge(n1: &Vec3, n2: &Vec3) -> Vec<BlockDefinition> {
    let (line, f1, f2, _) = wedge_forces(n1, n2);
    let up = |n: &Vec3, other: &Vec3| {
        let along = n.cross(&line);
        along * along.dot(other).signum()
    };
    let (d1, d2) = (up(n1, n2), up(n2, n1));
    // Long, so that friction on its sides does not lift its back.
    let ends = [line * -2.0, line * 2.0];
    let corners: Vec<Vec3> = ends
        .iter()
        .flat_map(|&end| [end, end + d1, end + d2])
        .collect();
    let body = Polyhedron::convex_hull(&corners).unwrap();
    let weight = 2500.0 * G * riprap_dda::volume(&body) / STIFFNESS;
    let sunk = Matrix3::from_rows(&[n1.transpose(), n2.transpose(), line.transpose()])
        .try_inverse()
        .unwrap()
        * Vec3::new(-f1 * weight, -f2 * weight, 0.0);
    let slab = |n: &Vec3| {
        let turn = Rotation3::rotation_between(&Vec3::z(), n).unwrap();
        let place = Isometry::from_parts(Vec3::zeros().into(), turn.into());
        block(
            cuboid([-20.0, -20.0, -3.0], [20.0, 20.0, 0.0]).transformed(&place),
            Motion::Fixed,
        )
    };
    vec![
        slab(n1),
        slab(n2),
        block(
            body.transformed(&Isometry::from_parts(
                sunk.into(),
                UnitQuaternion::identity(),
            )),
            Motion::Free,
        ),
    ]
}

/// Acceleration along the line, from the speeds after 0.1 and 0.5 s (the springs have to load first), and the last speed.
fn wedge_motion(integrator: Integrator, (n1, n2): (&Vec3, &Vec3), friction: f64) -> (f64, f64) {
    let line = wedge_forces(n1, n2).0;
    let mut blocks = blocks_by(integrator, wedge(n1, n2), joint(friction), down());
    run(&mut blocks, 0.1, 1.0, 1e-3);
    let early = blocks.velocity(2).dot(&line);
    run(&mut blocks, 0.4, 1.0, 1e-3);
    let late = blocks.velocity(2).dot(&line);
    ((late - early) / 0.4, late)
}

fn check_wedge(
    integrator: Integrator,
    name: &str,
    (n1, n2): (&Vec3, &Vec3),
    frictions: &[f64],
) -> f64 {
    let (_, f1, f2, drive) = wedge_forces(n1, n2);
    assert!(f1 > 0.0 && f2 > 0.0, "{name}: rests on one plane only");
    // Strength reduction: the factor of safety is tan φ over the friction at which it just slides; that is met within 1 %
    // if 0.99 of it slides and 1.01 does not.
    let critical = drive / (f1 + f2);
    let slides = wedge_motion(integrator, (n1, n2), 0.99 * critical).1;
    let rests = wedge_motion(integrator, (n1, n2), 1.01 * critical).1;
    println!(
        "{name}: critical friction {critical:.4}; speed {slides:.2e} below, {rests:.2e} above"
    );
    assert!(
        slides > 0.5 * 0.01 * drive * G * 0.5 && rests.abs() < 1e-6,
        "{name}: {slides:e} {rests:e}"
    );
    let mut worst = 0.0_f64;
    for &friction in frictions
        .iter()
        .filter(|&&friction| friction < 0.98 * critical)
    {
        let expected = G * (drive - friction * (f1 + f2));
        let error = wedge_motion(integrator, (n1, n2), friction).0 / expected - 1.0;
        worst = worst.max(error.abs());
    }
    worst
}

/// Five wedges (dip and dip direction of both planes, degrees) at five friction angles, with N₁/W, N₂/W and T/W of the
/// vector solution to five digits.
#[test]
fn wedges_on_two_planes() {
    let wedges = [
        ((50.0, 60.0), (50.0, 300.0), [0.57404, 0.57404, 0.51189]),
        ((45.0, 45.0), (45.0, 315.0), [0.4714, 0.4714, 0.57735]),
        ((60.0, 90.0), (60.0, 330.0), [0.57143, 0.57143, 0.65465]),
        ((70.0, 100.0), (35.0, 350.0), [0.26597, 0.79367, 0.50882]),
        ((40.0, 30.0), (65.0, 310.0), [0.71568, 0.11852, 0.63377]),
    ];
    let frictions = [0.0, 20.0, 30.0, 35.0, 40.0].map(|phi: f64| phi.to_radians().tan());
    for (k, (first, second, forces)) in wedges.into_iter().enumerate() {
        let n1 = plane_normal(first.0, first.1);
        let n2 = plane_normal(second.0, second.1);
        let (_, f1, f2, drive) = wedge_forces(&n1, &n2);
        for (found, expected) in [f1, f2, drive].into_iter().zip(forces) {
            assert!((found - expected).abs() < 5.1e-6, "{found} {expected}");
        }
        for integrator in both_ways() {
            let worst = check_wedge(integrator, &format!("wedge {k}"), (&n1, &n2), &frictions);
            assert_below("acceleration", worst, 1e-2);
        }
    }
}

/// Twenty random wedges that rest on both planes.
#[test]
fn random_wedges() {
    let mut random = Random::new(21);
    let mut n = 0;
    while n < 20 {
        let n1 = plane_normal(35.0 + 35.0 * random.next(), 20.0 + 60.0 * random.next());
        let n2 = plane_normal(35.0 + 35.0 * random.next(), 280.0 + 60.0 * random.next());
        let (line, f1, f2, drive) = wedge_forces(&n1, &n2);
        // Neither flat nor upright, and neither plane nearly idle.
        if f1.min(f2) < 0.2 || !(0.2..0.85).contains(&drive) || line.z > -0.2 {
            continue;
        }
        n += 1;
        let frictions = [0.0, 0.5 * drive / (f1 + f2)];
        for integrator in both_ways() {
            let name = format!("random wedge {n}");
            let worst = check_wedge(integrator, &name, (&n1, &n2), &frictions);
            assert_below("acceleration", worst, 1e-2);
        }
    }
}
