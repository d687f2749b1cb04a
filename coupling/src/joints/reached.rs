//! Blocks in reach of water.

use riprap_dda::Blocks;
use riprap_sph::{Fluid, Vec3};

use super::Jointed;

/// Blocks in reach of water: those near its particles, and from joint to joint those near them.
#[derive(Clone, Debug, Default)]
pub(super) struct Reached {
    pub blocks: Vec<ReachedBlock>,
    queue: Vec<usize>,
}

/// Bounds of a block, and whether water reaches it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReachedBlock {
    /// Bounding box; m.
    pub bounds: (Vec3, Vec3),
    pub is_reached: bool,
}

impl Reached {
    /// Finds them; joints are at most `reach` (m) wide.
    pub fn find(&mut self, jointed: &[Jointed], reach: f64, fluid: &Fluid, blocks: &Blocks) {
        self.blocks.clear();
        self.queue.clear();
        for (n, jointed) in jointed.iter().enumerate() {
            let mut bounds = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
            for part in blocks.parts_of(jointed.block) {
                let (min, max) = blocks.part_aabb(part);
                bounds = (bounds.0.inf(&min), bounds.1.sup(&max));
            }
            let is_reached = !blocks.is_removed(jointed.block) && has_water(fluid, &bounds);
            self.blocks.push(ReachedBlock { bounds, is_reached });
            if is_reached {
                self.queue.push(n);
            }
        }
        while let Some(n) = self.queue.pop() {
            let (min, max) = self.blocks[n].bounds;
            for (m, other) in self.blocks.iter_mut().enumerate() {
                let (low, high) = other.bounds;
                let is_near = (0..3).all(|k| low[k] - reach < max[k] && min[k] < high[k] + reach);
                if !other.is_reached && is_near && !blocks.is_removed(jointed[m].block) {
                    other.is_reached = true;
                    self.queue.push(m);
                }
            }
        }
    }
}

/// Whether there is any water in the cells around a box (m).
fn has_water(fluid: &Fluid, (min, max): &(Vec3, Vec3)) -> bool {
    let grid = fluid.grid();
    let reach = fluid.settings().support_radius();
    let from = grid.coordinates_of(&min.add_scalar(-reach));
    let to = grid.coordinates_of(&max.add_scalar(reach));
    let cells = (from[2]..=to[2]).flat_map(|k| {
        (from[1]..=to[1]).flat_map(move |j| (from[0]..=to[0]).map(move |i| [i, j, k]))
    });
    cells
        .into_iter()
        .any(|cell| !grid.particles_in(grid.cell_at(cell)).is_empty())
}
