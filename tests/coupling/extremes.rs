//! Extremes of realistic scenes: thin and soft blocks, overlaps, light bodies, scale, particles in unusual positions. The
//! full sweep is `benches/rust/extremes.rs`.

use crate::support::scene::{advance, resolved, world};
use riprap::walls::Walls;
use riprap_sph::Vec3;

const G: f64 = 9.81;
/// A particle in the corner of floor and wall, of springs.
const SEAM: &str = "in the seam of floor and wall";
/// No step is limited by it; s.
const DURATION: f64 = 100.0;

/// A block above a floor, and more of its material.
fn on_floor(block: &str, material: &str) -> String {
    format!(
        "(title: \"stone\", domain: (min: (-9, -9, -9), max: (9, 9, 9)),\n\
         materials: [(name: \"rock\", density: 2500, friction_angle_deg: 30, {material})],\n\
         blocks: [(name: \"floor\", material: \"rock\", motion: Fixed, shape: Box(min: (-5, -5, -1), max: (5, 5, 0))),\n\
         (name: \"stone\", material: \"rock\", {block})],\n\
         time: (duration: {DURATION:?}))"
    )
}

/// X04: the stiffness that is chosen is that of a plate as thin as a millimeter: a share of its size alone would be four times
/// the overlap at which a step is refused.
#[test]
fn a_thin_plate_lands_with_the_stiffness_that_is_chosen() {
    let plate = "shape: Box(min: (-0.5, -0.5, 0.3), max: (0.5, 0.5, 0.301)),\n\
         placement: (rotate: (axis: (1, 0.3, 0), angle_deg: 10))";
    let mut world = world(&on_floor(plate, ""));
    let end = 0.6;
    advance(&mut world, end, DURATION, |world| {
        assert!(world.blocks.centroid(1).z > 0.0);
    });
    let height = world.blocks.centroid(1).z;
    println!("X04: the middle of the plate is {height:.2e} m high after {end} s");
    assert!(height < 0.2, "it has not fallen");
}

/// X02: a block that sinks in by a tenth of its size is said to, one by a thousandth is not.
#[test]
fn soft_contacts_are_said_to_be() {
    let cube = "shape: Box(min: (0, 0, 0), max: (1, 1, 1))";
    let said = |share: f64| -> Vec<String> {
        let stiffness = 2500.0 * G / share;
        let text = on_floor(cube, &format!("contact_stiffness: {stiffness:?}"));
        let warnings = resolved(&text).unwrap().warnings;
        warnings.into_iter().map(|w| w.message).collect()
    };
    assert!(said(1e-3).is_empty());
    let words = said(0.1);
    assert_eq!(words.len(), 1);
    assert!(words[0].contains("overlaps another of its kind by 10.0 % of its size"));
}

/// Blocks that overlap by 10 % at the start are refused, by 1e-9 pushed apart without a jump.
#[test]
fn overlap_at_the_start() {
    let cube = |depth: f64| {
        on_floor(
            &format!(
                "shape: Box(min: (0, 0, {:?}), max: (1, 1, {:?}))",
                -depth,
                1.0 - depth
            ),
            "",
        )
    };
    let problems = resolved(&cube(0.1)).unwrap_err();
    assert!(
        problems
            .iter()
            .any(|p| p.message.contains("overlaps block `floor`"))
    );
    let mut world = world(&cube(1e-9));
    let mut fastest = 0.0_f64;
    advance(&mut world, 0.2, DURATION, |world| {
        fastest = fastest.max(world.blocks.velocity(1).norm());
    });
    // it sinks in by m g/K, a thousandth of its size, at √(g · 1e-3 m)
    assert!(fastest < (G * 1e-3).sqrt(), "{fastest}");
}

/// X14: a stone at 10,000 rad/s keeps its energy in free flight, and does not leave the floor it drops on.
#[test]
fn a_stone_at_ten_thousand_radians_a_second() {
    let stone = "angular_velocity: (2000, 3000, 10000), shape: Box(min: (-0.5, -0.3, 0.6), max: (0.5, 0.3, 0.9))";
    let mut world = world(&on_floor(stone, "contact_stiffness: 1e12"));
    let start = world.blocks.energies();
    advance(&mut world, 0.03, DURATION, |_| {});
    let spin = world.blocks.energies().kinetic / start.kinetic - 1.0;
    let ledger = (world.blocks.energies().balance() - start.balance()) / start.kinetic;
    println!("X14: energy {spin:+.1e}, ledger {ledger:+.1e}");
    assert!(spin.abs() < 1e-3 && ledger.abs() < 1e-3);
}

/// A tank in a plane, 40 by 20 spacings, and a block in it.
fn tank(spacing: f64, water: &str, block: &str, more: &str) -> String {
    let t = 4.0 * spacing;
    let (length, height) = (40.0 * spacing, 40.0 * spacing);
    let cuboid = |name: &str, rest: &str, [a, b, c, d]: [f64; 4]| {
        format!(
            "(name: \"{name}\", {rest}, shape: Box(min: ({a:?}, 0, {b:?}), max: ({c:?}, 0.1, {d:?}))),"
        )
    };
    let fixed = "material: \"m\", motion: Fixed";
    let walls = cuboid("floor", fixed, [-t, -t, length + t, 0.0])
        + &cuboid("left", fixed, [-t, 0.0, 0.0, height])
        + &cuboid("right", fixed, [length, 0.0, length + t, height]);
    format!(
        "(title: \"tank\", domain: (min: ({:?}, 0, {:?}), max: ({:?}, 0.1, {:?}), dimensions: Two),\n\
         materials: [(name: \"m\", density: 2000, friction_angle_deg: 20), (name: \"light\", density: 50, friction_angle_deg: 20)],\n\
         blocks: [{walls} {block}],\n\
         fluid: (resolution: Spacing({spacing:?}), regions: [(name: \"water\", shape: {water})]),\n\
         {more} time: (duration: {DURATION:?}))",
        -t,
        -t,
        length + t,
        2.0 * height,
    )
}

fn below(spacing: f64) -> String {
    let (level, seed) = (20.0 * spacing, 0.5 * spacing);
    format!("Below(level: {level:?}, seed: ({seed:?}, 0.05, {seed:?}))")
}

/// X19: a body a twentieth as dense as water, whose water that moves with it is ten times its mass, floats.
#[test]
fn a_body_a_twentieth_as_dense_as_water_floats() {
    let dp = 0.025;
    let body = "(name: \"body\", material: \"light\", shape: Box(min: (0.4, 0, 0.4), max: (0.6, 0.1, 0.6)))";
    let mut world = world(&tank(dp, &below(dp), body, ""));
    let body = world.blocks.n_blocks() - 1;
    let mut fastest = 0.0_f64;
    advance(&mut world, 1.0, DURATION, |world| {
        fastest = fastest.max(world.blocks.velocity(body).norm());
    });
    let bottom = world.blocks.centroid(body).z - 0.1;
    println!("X19: fastest {fastest:.2} m/s, bottom at {bottom:.3} m of 0.49");
    // half a side of lift gives √(g a) = 1.4 m/s
    assert!(fastest < (G * 0.2).sqrt());
    // its draught is a centimeter, 0.4 spacings: within a spacing and a half
    assert!((bottom - 0.49).abs() < 1.5 * dp);
}

/// Everything scaled by a power of four, times by its root, is the same motion to the last bit of f32 and of places. The viscosity
/// of water does not scale; artificial viscosity does.
#[test]
fn water_follows_froude() {
    let places = |spacing: f64| -> Vec<f64> {
        let side = 15.0 * spacing;
        let water = format!("Box(min: (0, 0, 0), max: ({side:?}, 0.1, {side:?}))");
        let mut world = world(&tank(
            spacing,
            &water,
            "",
            "numerics: (viscosity: Artificial(0.02)),",
        ));
        advance(&mut world, 1.5 * (side / G).sqrt(), DURATION, |_| {});
        let p = world.water.as_ref().unwrap().fluid.particles();
        let mut places: Vec<_> = p.id.iter().zip(&p.position).collect();
        places.sort_by_key(|(id, _)| **id);
        places
            .iter()
            .flat_map(|(_, x)| [x.x / spacing, x.z / spacing])
            .collect()
    };
    let apart = |a: &[f64], b: &[f64]| {
        assert_eq!(a.len(), b.len());
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    };
    let reference = places(0.01);
    let (four, other) = (
        apart(&reference, &places(0.04)),
        apart(&reference, &places(1.0)),
    );
    println!(
        "places apart by {four:.1e} dp at four times the size, by {other:.1e} dp at a hundred times"
    );
    assert!(four < 1e-9, "{four}");
    // round-off of f32 sums, 1e-7, grown by the splash; measured 2e-5
    assert!(other < 1e-3, "{other}");
}

/// The walls of a slice are those of its plane, however thin it is: of a spacing of a kilometer and a slice of a tenth of a
/// meter there were none.
#[test]
fn a_slice_has_walls_however_thin() {
    let walls = |spacing: f64| {
        let world = world(&tank(spacing, &below(spacing), "", ""));
        let walls = world.water.as_ref().and_then(|water| water.walls.as_ref());
        walls.map_or(0, Walls::n_points)
    };
    let usual = walls(0.025);
    assert!(usual > 100, "{usual}");
    for spacing in [25.0, 1000.0, 1e6] {
        assert_eq!(walls(spacing), usual, "spacing {spacing} m");
    }
}

/// Particles on a face, on an edge and inside of a block are held off, wherever they are put.
#[test]
fn particles_in_odd_places() {
    let dp = 0.025;
    let rock = "(name: \"rock\", material: \"m\", motion: Fixed, shape: Box(min: (0.4, 0, 0.2), max: (0.6, 0.1, 0.4)))";
    for (name, x, z) in [
        ("on a face", 0.4, 0.3),
        ("on an edge", 0.4, 0.4),
        ("a spacing inside", 0.425, 0.3),
        ("in the middle", 0.5, 0.3),
        ("in the corner of floor and wall", 0.0, 0.0),
        (SEAM, 0.0, 0.0),
    ] {
        // springs held it between floor and wall, and it went off through their seam
        let (more, end) = if name == SEAM {
            ("interface: (walls: Penalty),", 0.4)
        } else {
            ("", 0.05)
        };
        let mut world = world(&tank(dp, &below(dp), rock, more));
        let fluid = &mut world.water.as_mut().unwrap().fluid;
        let n = fluid.particles().len();
        let at = Vec3::new(x, 0.05, z);
        let places = &fluid.particles().position;
        let nearest = (0..n)
            .min_by(|&a, &b| (places[a] - at).norm().total_cmp(&(places[b] - at).norm()))
            .unwrap();
        let at = Vec3::new(x, places[nearest].y, z);
        fluid.relocate(nearest, at, Vec3::zeros());
        let mut fastest = 0.0_f64;
        advance(&mut world, end, DURATION, |world| {
            fastest = fastest.max(world.water.as_ref().unwrap().fluid.max_speed());
        });
        let places = &world.water.as_ref().unwrap().fluid.particles().position;
        let inside = |x: &&Vec3| 0.405 < x.x && x.x < 0.595 && 0.205 < x.z && x.z < 0.395;
        println!(
            "{name}: fastest {fastest:.2} m/s, {} put back",
            world.extremes().particles_pushed_back
        );
        assert_eq!(places.iter().filter(inside).count(), 0, "{name}");
        assert_eq!(places.len(), n, "{name}: one is lost");
        // what the water above can do, √(2 p/ρ)
        let depth = if name == SEAM { 0.5 } else { 0.2 };
        assert!(fastest < (2.0 * G * depth).sqrt(), "{name}: {fastest}");
    }
}
