//! Water that solids leave no way out: a tank whose walls are the ends of the domain.

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
