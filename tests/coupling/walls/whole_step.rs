//! Walls at the longest stable step: nothing passes them, however fast it comes or however long it tries.

use super::plates::{between_two_levels, column_beside};
use super::*;
use crate::support::scene::whole_step;

fn at_the_whole_step(mut case: Case, draw: u32) -> Case {
    case.more[2] = whole_step(draw);
    case
}

/// Particles that a floor with a crack lets through until a time (s). Its middle is `off` spacings off that between two rows.
fn through_a_crack(walls: &'static str, off: f64, draw: u32, until: f64) -> usize {
    let case = at_the_whole_step(column_beside(off, walls, 4.0, 50), draw);
    let mut world = case.world();
    while world.time() < until {
        let step = world.next_step(until).unwrap();
        world.step(step).unwrap();
    }
    let fluid = &world.water.as_ref().unwrap().fluid;
    let positions = &fluid.particles().position;
    let is_below = |x: &&Vec3| x.z < -0.5 * case.spacing;
    let below = positions.iter().filter(is_below).count();
    let count = below + fluid.removed().count as usize;
    println!(
        "crack of 0.2 dp {off} dp off, {walls:9}, draw {draw:3}: {count} through, put back {} in {} steps",
        world.extremes().particles_pushed_back,
        world.clock().steps
    );
    count
}

/// Under a row of particles: without a stop at the mouth of the crack two of 1800 went through in every draw, at half the step
/// up to six.
#[test]
fn nothing_passes_a_crack_under_a_row_at_the_whole_step() {
    for draw in [0, 100, 199] {
        assert_eq!(through_a_crack("Particles", 0.5, draw, 0.3), 0, "{draw}");
    }
    assert_eq!(through_a_crack("Integral", 0.5, 0, 0.3), 0);
}

/// Long enough for draws to differ: without the stop two to six went through in each of seven draws.
#[test]
#[ignore = "slow: 10 min"]
fn nothing_passes_a_crack_in_200_draws() {
    for draw in 0..200 {
        assert_eq!(through_a_crack("Particles", 0.0, draw, 1.5), 0, "{draw}");
    }
}

/// Particles that change the side of a plate, or leave the basin, until a time (s).
fn past(what: &str, case: Case, side: impl Fn(&Vec3) -> bool, draw: u32, until: f64) -> usize {
    let mut world = at_the_whole_step(case, draw).world();
    let count = |world: &World| {
        let positions = &world.water.as_ref().unwrap().fluid.particles().position;
        positions.iter().filter(|x| side(x)).count()
    };
    let before = count(&world);
    while world.time() < until {
        let step = world.next_step(until).unwrap();
        world.step(step).unwrap();
    }
    let removed = world.water.as_ref().unwrap().fluid.removed().count as usize;
    let passed = count(&world).abs_diff(before) + removed;
    println!(
        "{what}, draw {draw:3}: {passed} past, put back {} in {} steps",
        world.extremes().particles_pushed_back,
        world.clock().steps
    );
    passed
}

/// Of water between two levels past a plate of 0.3 spacings.
fn past_a_plate(draw: u32, until: f64) -> usize {
    let (case, _) = between_two_levels("Particles", 0.3, 0.02, "dimensions: Two");
    let middle = 20.15 * case.spacing;
    past("C16 in a plane", case, |x| middle < x.x, draw, until)
}

/// Of still water past the walls of a basin whose rows lie half a spacing off them.
fn out_of_a_basin(draw: u32, until: f64) -> usize {
    let mut more = plain();
    more[0] = "dimensions: Two".into();
    let size = [20, 1, 16];
    let (case, spacing) = still("Particles", size, None, more);
    let length = size[0] as f64 * spacing;
    let is_out = |x: &Vec3| x.z < 0.0 || x.x < 0.0 || length < x.x;
    past("still water", case, is_out, draw, until)
}

#[test]
fn nothing_passes_a_thin_plate_nor_a_basin_at_the_whole_step() {
    for draw in [0, 199] {
        assert_eq!(past_a_plate(draw, 0.3), 0, "{draw}");
        assert_eq!(out_of_a_basin(draw, 0.5), 0, "{draw}");
    }
}

#[test]
#[ignore = "slow: 4 min"]
fn nothing_passes_a_thin_plate_in_200_draws() {
    for draw in 0..200 {
        assert_eq!(past_a_plate(draw, 1.5), 0, "{draw}");
    }
}

#[test]
#[ignore = "slow: 2 min"]
fn nothing_leaves_a_basin_in_200_draws() {
    for draw in 0..200 {
        assert_eq!(out_of_a_basin(draw, 2.0), 0, "{draw}");
    }
}
