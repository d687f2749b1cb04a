//! Gap between walls and the water along them.
//!
//! The first row of a lattice is half a spacing from the wall, so that its particles fill the room up to it. A wall that pushes too
//! early keeps the water away, as if it were drawn thicker than it is, by the gap
//!
//! ```text
//! g = median(s) − dp/2
//! ```
//! with the distance `s` of the nearest particle from each patch of wall, of a spacing by a spacing.

use std::collections::BTreeMap;

use riprap_dda::Blocks;
use riprap_sph::Fluid;

use crate::walls::penalty::{Interface, STANDOFF, WallSettings};

/// Distance up to which the nearest particle is looked for, in spacings: beyond a gap of one and a half the water is somewhere else.
const REACH: f64 = 2.0;

/// Gap at all walls in water over the spacing, below zero where particles stand closer; `None` where no water is at a wall. Sleeping
/// water, which is where it fell asleep, does not count.
pub fn gap_over_spacing(walls: &WallSettings, blocks: &Blocks, fluid: &Fluid) -> Option<f64> {
    let spacing = walls.particle_spacing;
    let settings = WallSettings {
        standoff: REACH * spacing,
        ..*walls
    };
    let mut interface = Interface::new(settings, (blocks, &[]), fluid);
    interface.find(fluid, blocks);
    let mut nearest = BTreeMap::new();
    for touch in interface.touches() {
        if interface.is_across_plane(&touch.normal) {
            continue;
        }
        let patch = touch.point.map(|x| (x / spacing).floor() as i64);
        let patch = (touch.block, patch.x, patch.y, patch.z);
        let distance = nearest.entry(patch).or_insert(f64::INFINITY);
        *distance = touch.distance.min(*distance);
    }
    let mut distances: Vec<f64> = nearest.into_values().collect();
    let middle = distances.len().checked_sub(1)? / 2;
    let (_, median, _) = distances.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median / spacing - STANDOFF)
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;
    use crate::run::world_of;
    use crate::world::World;

    const DP: f64 = 0.1;

    /// A tank, and a slab of water drawn off its floor by some spacings.
    fn tank(off: f64) -> World {
        let from = off * DP;
        world_of(&format!(
            "(title: \"tank\", domain: (min: (0, 0, -0.4), max: (1.2, 1.2, 1.2)),
             materials: [(name: \"m\", density: 2000, friction_angle_deg: 30)],
             blocks: [(name: \"floor\", material: \"m\", motion: Fixed,
                       shape: Box(min: (-0.4, -0.4, -0.4), max: (1.6, 1.6, 0)))],
             fluid: (resolution: Spacing({DP}), regions: [(name: \"slab\",
                     shape: Box(min: (0, 0, {from}), max: (1.2, 1.2, {})))]),
             time: (duration: 1))",
            from + 4.0 * DP
        ))
    }

    fn gap(world: &World) -> Option<f64> {
        let water = world.water.as_ref().unwrap();
        gap_over_spacing(water.interface.settings(), &world.blocks, &water.fluid)
    }

    #[test]
    fn a_lattice_off_its_floor_has_the_gap_that_it_was_drawn_with() {
        for off in [0.0, 0.3, 1.0] {
            let found = gap(&tank(off)).unwrap();
            assert!((found - off).abs() < 1e-9, "{found} for {off}");
        }
        assert_eq!(gap(&tank(3.0)), None);
    }
}
