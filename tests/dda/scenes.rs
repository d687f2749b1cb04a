//! The motions that the first water scenes need, without the water.

use crate::setup::*;
use riprap_dda::{Isometry, Material, Motion, Polyhedron, Shape, Vec3};

fn slope_and_bed(angle: f64, adjoining: bool) -> Vec<riprap_dda::BlockDefinition> {
    // The slope's surface ends at the origin; the bed runs on at z = 0.
    let run = 5.0;
    let rise = run * angle.tan();
    let slope = Polyhedron::extrusion(
        &[[-run, -1.0], [0.0, -1.0], [0.0, 0.0], [-run, rise]],
        1,
        -2.0,
        2.0,
    )
    .unwrap();
    let bed_start = if adjoining { 0.0 } else { -1.0 };
    vec![
        riprap_dda::BlockDefinition {
            shape: Shape::Polyhedra(slope),
            ..floor()
        },
        block(
            cuboid([bed_start, -2.0, -1.0], [8.0, 2.0, 0.0]),
            Motion::Fixed,
        ),
    ]
}

/// A box whose base lies on the slope, its lower edge `distance` up from the corner.
fn on_the_slope(shape: &Polyhedron, angle: f64, distance: f64) -> Polyhedron {
    let foot = Vec3::new(-distance * angle.cos(), 0.0, distance * angle.sin());
    shape.transformed(&Isometry::new(foot, Vec3::y() * angle))
}

/// A box slides down 30 degrees, passes the concave corner, and comes to rest on the bed.
#[test]
fn box_passes_the_concave_corner() {
    let angle = 30.0_f64.to_radians();
    for adjoining in [false, true] {
        let stone = on_the_slope(&cuboid([-0.3, -0.2, 0.0], [0.0, 0.2, 0.2]), angle, 1.0);
        let mut definitions = slope_and_bed(angle, adjoining);
        definitions.push(block(stone, Motion::Free));
        let material = Material {
            friction_angle: 0.25_f64.atan(),
            contact_stiffness: 1e7,
            ..rock()
        };
        let mut blocks = blocks(definitions, material, down());
        let start = ledger(&blocks.energies());
        let steps = run(&mut blocks, 3.0, 1.0, 1e-3);
        let (e, x) = (blocks.energies(), blocks.centroid(2));
        println!(
            "adjoining {adjoining}: {steps} steps, rests at {:.4} {:.1e} {:.5}, speed {:.1e}, overlap {:.1e}, ledger {:.1e} of {:.1} J",
            x.x,
            x.y,
            x.z,
            blocks.velocity(2).norm(),
            blocks.max_overlap_over_size(),
            ledger(&e) - start,
            e.friction + e.damping
        );
        assert!(x.x > 0.3, "it reached the bed: {x}");
        assert!((x.z - 0.1).abs() < 1e-3, "flat on the bed: {x}");
        assert!(x.y.abs() < 1e-6, "straight: {x}");
        assert!(blocks.velocity(2).norm() < 1e-4, "at rest");
        assert_below(
            "ledger",
            (ledger(&e) - start).abs() / (e.friction + e.damping),
            5e-2,
        );
    }
}

/// A wedge slides far down a huge plane: constant acceleration, no chatter, no turn.
#[test]
fn wedge_slides_without_chatter() {
    let angle = 25.0_f64.to_radians();
    let wedge =
        Polyhedron::extrusion(&[[-0.5, 0.0], [0.0, 0.0], [-0.5, 0.25]], 1, -0.15, 0.15).unwrap();
    let mut definitions = slope_and_bed(angle, true);
    definitions.truncate(1);
    definitions.push(block(on_the_slope(&wedge[0], angle, 4.5), Motion::Free));
    let friction = 0.2;
    let material = Material {
        friction_angle: f64::atan(friction),
        ..rock()
    };
    let mut blocks = blocks(definitions, material, down());
    run(&mut blocks, 0.3, 1.0, 1e-3);
    let weight = blocks.mass(1) * G;
    let (mut time, mut worst) = (0.3, 0.0_f64);
    let mut n = 0;
    while time < 1.2 {
        let dt = blocks.critical_time_step().dt;
        blocks.advance(time, dt, 1).unwrap();
        time += dt;
        n += 1;
        let normal: f64 = blocks.contacts().iter().map(|c| c.normal_force).sum();
        worst = worst.max((normal / (weight * angle.cos()) - 1.0).abs());
    }
    let x = blocks.centroid(1);
    let traveled = blocks.velocity(1).norm();
    println!("{n} steps, at {x}, speed {traveled}");
    assert_below("chatter of the normal force", worst, 1e-6);
    assert_close(
        "speed",
        traveled,
        1.2 * G * (angle.sin() - friction * angle.cos()),
        5e-3,
    );
    assert_below("turn", blocks.orientation(1).angle(), 1e-4);
}

/// A seam between two coplanar adjoining floors hardly slows a sliding box.
#[test]
fn box_slides_over_a_seam() {
    let floors = [
        block(cuboid([-5.0, -1.0, -1.0], [0.0, 1.0, 0.0]), Motion::Fixed),
        block(cuboid([0.0, -1.0, -1.0], [5.0, 1.0, 0.0]), Motion::Fixed),
    ];
    let mut definitions = floors.to_vec();
    definitions.push(moving(
        block(cuboid([-1.0, -0.2, 0.0], [-0.6, 0.2, 0.2]), Motion::Free),
        [1.5, 0.0, 0.0],
    ));
    let material = Material {
        friction_angle: 0.0,
        ..rock()
    };
    let mut blocks = blocks(definitions, material, down());
    run(&mut blocks, 2.0, 1.0, 1e-3);
    let (x, v) = (blocks.centroid(2), blocks.velocity(2));
    println!(
        "at {x}, velocity {v}, turned {:.1e}",
        blocks.orientation(2).angle()
    );
    assert_close("speed after the seam", v.x, 1.5, 1e-2);
    assert!((x.z - 0.1).abs() < 1e-3);
}
