//! Joints with a stiffness per area, and joints that have slipped: rest, columns, slides.

use crate::setup::*;
use riprap_dda::{Blocks, Material, Motion, Vec3};

const STIFFNESS: f64 = 1e9;
/// Four corners of 1e-3 L² count beside the area of a square base; × L².
const CORNERS: f64 = 4e-3;

fn joint() -> Material {
    Material {
        joint_stiffness: Some(STIFFNESS),
        // Without meaning where the other is given.
        contact_stiffness: 1.0,
        ..rock()
    }
}

fn deepest(blocks: &Blocks, pair: (usize, usize)) -> f64 {
    blocks
        .contacts()
        .iter()
        .filter(|c| (c.blocks.0.index(), c.blocks.1.index()) == pair)
        .map(|c| c.overlap)
        .fold(0.0, f64::max)
}

/// A cube of any size at rest sinks in by m g/(k A) with the corners' area; without it within 0.5 %.
#[test]
fn cube_at_rest() {
    for side in [0.3, 1.0, 2.5] {
        let stone = block(cuboid([0.0; 3], [side; 3]), Motion::Free);
        let mut blocks = blocks(vec![floor(), stone], joint(), down());
        run(&mut blocks, 1.0, 1.0, 1e-3);
        let plain = blocks.mass(1) * G / (STIFFNESS * side * side);
        let found = deepest(&blocks, (0, 1));
        assert_close("overlap at rest", found, plain / (1.0 + CORNERS), 1e-9);
        assert_close("m g/(k A)", found, plain, 5e-3);
    }
}

/// D15 per area: contact j from the top of n cubes carries j m g; the top sinks by n (n + 1)/2 m g/(k A).
#[test]
fn column_sinks() {
    let n = 5;
    let cubes = (0..n).map(|k| {
        let z = f64::from(k);
        block(cuboid([0.0, 0.0, z], [1.0, 1.0, z + 1.0]), Motion::Free)
    });
    let definitions = std::iter::once(floor()).chain(cubes).collect();
    let mut blocks = blocks(definitions, joint(), down());
    let start = blocks.centroid(5).z;
    run(&mut blocks, 4.0, 1.0, 1e-3);
    let unit = 2500.0 * G / (STIFFNESS * (1.0 + CORNERS));
    for below in 0..5 {
        let carried = 5.0 - below as f64;
        let found = deepest(&blocks, (below, below + 1));
        assert_close("overlap in the column", found, carried * unit, 1e-6);
    }
    let sunk = start - blocks.centroid(5).z;
    assert_close("top sinks", sunk, 15.0 * unit, 1e-6);
}

/// Slides by g (sin θ − cos θ tan φ), rests below the friction angle.
#[test]
fn slide_per_area() {
    let slope = 0.6_f64;
    let stone = || block(cuboid([0.0; 3], [1.0, 1.0, 0.1]), Motion::Free);
    for (friction, slides) in [(0.0, true), (0.3, true), (0.7, false)] {
        let material = Material {
            friction_angle: friction,
            ..joint()
        };
        let mut blocks = blocks(vec![floor(), stone()], material, on_slope(slope));
        run(&mut blocks, 0.2, 1.0, 1e-3);
        let early = (blocks.velocity(1).x, blocks.centroid(1).x);
        run(&mut blocks, 0.8, 1.0, 1e-3);
        if slides {
            let expected = G * (slope.sin() - slope.cos() * f64::tan(friction));
            let found = (blocks.velocity(1).x - early.0) / 0.8;
            assert_close("acceleration per area", found, expected, 1e-6);
        } else {
            assert_below(
                "creep per area, m",
                (blocks.centroid(1).x - early.1).abs(),
                1e-9,
            );
            let carried = total_shear(&blocks) / (blocks.mass(1) * G * slope.sin());
            assert_close("shear of the rest", carried, 1.0, 1e-6);
        }
    }
}

fn total_shear(blocks: &Blocks) -> f64 {
    let shear: Vec3 = blocks.contacts().iter().map(|c| c.shear_force).sum();
    shear.norm()
}

/// On 40 degrees a block with a peak of 62 rests (its shear springs swing up to twice their load at first). One that has been pushed goes on with the residual angle of 20,
/// a = g (sin θ − cos θ tan φ_r), however slow it was.
#[test]
fn residual_friction() {
    let slope = 40.0_f64.to_radians();
    for joint_stiffness in [None, Some(STIFFNESS)] {
        let material = Material {
            friction_angle: 62.0_f64.to_radians(),
            residual_friction_angle: Some(20.0_f64.to_radians()),
            contact_stiffness: 1e9,
            joint_stiffness,
            ..rock()
        };
        for speed in [0.0, 0.05, 0.5] {
            // Pressed in as at rest.
            let sunk = 250.0 * G * slope.cos() / 1e9;
            let stone = block(
                cuboid([0.0, 0.0, -sunk], [1.0, 1.0, 0.1 - sunk]),
                Motion::Free,
            );
            let stone = moving(stone, [speed, 0.0, 0.0]);
            let mut blocks = blocks(vec![floor(), stone], material, on_slope(slope));
            run(&mut blocks, 0.1, 1.0, 1e-3);
            let early = blocks.velocity(1).x;
            run(&mut blocks, 0.5, 1.0, 1e-3);
            let found = (blocks.velocity(1).x - early) / 0.5;
            if speed == 0.0 {
                assert_below("rests at the peak, m/s²", found.abs(), 1e-6);
            } else {
                let residual = 20.0_f64.to_radians().tan();
                let expected = G * (slope.sin() - slope.cos() * residual);
                assert_close("goes on with the residual", found, expected, 1e-3);
            }
        }
    }
}
