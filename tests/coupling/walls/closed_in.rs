//! Water that solids leave no way out: a tank whose walls are the ends of the domain, and a cell that a lid closes.

use crate::support::scene::{advance, world};

/// A dam breaks in a tank whose walls begin where the domain ends: a particle that passes a face by a little is put back and does
/// not count as gone. One in eight was lost before.
#[test]
fn water_stays_in_a_tank_whose_walls_begin_where_the_domain_ends() {
    let wall = |name: &str, shape: &str| {
        format!("(name: \"{name}\", material: \"rock\", motion: Fixed, shape: Box({shape})),")
    };
    let mut world = world(&format!(
        "(title: \"tank\", domain: (min: (0, 0, -0.2), max: (1, 0.4, 1.5)),
          materials: [(name: \"rock\", density: 2600, friction_angle_deg: 30)],
          blocks: [{}{}{}{}{}],
          fluid: (resolution: Spacing(0.05), regions: [
              (name: \"dam\", shape: Box(min: (0, 0, 0), max: (0.4, 0.4, 0.6)))]),
          time: (duration: 1.2))",
        wall("floor", "min: (-0.2, -0.2, -0.2), max: (1.2, 0.6, 0)"),
        wall("left", "min: (-0.2, -0.2, 0), max: (0, 0.6, 1.5)"),
        wall("right", "min: (1, -0.2, 0), max: (1.2, 0.6, 1.5)"),
        wall("front", "min: (-0.2, -0.2, 0), max: (1.2, 0, 1.5)"),
        wall("back", "min: (-0.2, 0.4, 0), max: (1.2, 0.6, 1.5)"),
    ));
    let n = world.water.as_ref().unwrap().fluid.particles().len();
    advance(&mut world, 1.2, 1.2, |_| {});
    let fluid = &world.water.as_ref().unwrap().fluid;
    assert_eq!(fluid.removed().count, 0);
    assert_eq!(fluid.particles().len(), n);
}

/// A lid presses three rows of water in a closed cell to a fifth of their height. What has no room leaks: after every step the
/// water at the walls is at most a fifth denser than at rest, and the run goes on, where it ended when that was a third. What
/// leaked has taken off energy, but no more than the lid put in, and no mass is lost.
#[test]
fn water_without_a_way_out_leaks_through_joints() {
    let mut world = world(
        "(title: \"cell\", domain: (min: (-0.5, 0, -0.5), max: (1, 0.4, 1.5), dimensions: Two),
          materials: [(name: \"rock\", density: 2600, friction_angle_deg: 30)],
          blocks: [
              (name: \"floor\", material: \"rock\", motion: Fixed, shape: Box(min: (-0.4, -0.2, -0.4), max: (0.8, 0.6, 0))),
              (name: \"left\", material: \"rock\", motion: Fixed, shape: Box(min: (-0.4, -0.2, 0), max: (0, 0.6, 1))),
              (name: \"right\", material: \"rock\", motion: Fixed, shape: Box(min: (0.4, -0.2, 0), max: (0.8, 0.6, 1))),
              (name: \"lid\", material: \"rock\", shape: Box(min: (0, -0.2, 0.15), max: (0.4, 0.6, 0.5)),
               motion: Sinusoid(direction: (0, 0, -1), amplitude: 0.12, period: 4)),
          ],
          fluid: (resolution: Spacing(0.05), regions: [
              (name: \"cell\", shape: Box(min: (0, 0, 0), max: (0.4, 0.4, 0.15)))]),
          numerics: (sound_speed: 10),
          time: (duration: 1))",
    );
    let reference = 1000.0;
    let mut densest = 0.0_f64;
    advance(&mut world, 1.0, 1.0, |world| {
        let water = world.water.as_ref().unwrap();
        let density = &water.fluid.particles().density;
        let touches = water.interface.touches().iter();
        densest = touches
            .filter(|touch| touch.distance < 0.5 * 0.05)
            .map(|touch| density[touch.particle as usize] / reference)
            .fold(densest, f64::max);
    });
    let energy = world.energy();
    println!(
        "{} reliefs, {:.1} J leaked or put back of {:.1} J",
        world.extremes().reliefs,
        energy.pushed_back,
        energy.external_work
    );
    assert!(0 < world.extremes().reliefs);
    assert!((densest - 1.2).abs() < 1e-12, "{densest}");
    assert!(0.0 < energy.pushed_back && energy.pushed_back < energy.external_work);
    assert_eq!(world.water.as_ref().unwrap().fluid.removed().count, 0);
}
