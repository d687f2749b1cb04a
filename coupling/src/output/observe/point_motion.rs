//! Motion of a point that moves with a block.

use riprap_dda::{Blocks, Vec3};

/// A point of a block, by its place at the start.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointMotion {
    block: usize,
    /// At the start; m.
    start: Vec3,
    /// From the centroid to the point, in the axes of the start; m.
    offset: Vec3,
}

impl PointMotion {
    /// The point of a block at its initial position.
    pub(super) fn new(block: usize, start: Vec3, blocks: &Blocks) -> Self {
        Self {
            block,
            start,
            offset: start - blocks.centroid(block),
        }
    }

    /// The point of a block at a position as drawn, of one that may have moved since.
    pub(super) fn of_drawn(block: usize, drawn: Vec3, blocks: &Blocks) -> Self {
        let centroid = blocks.centroid(block);
        let from = blocks.pose(block).inverse() * nalgebra::Point3::from(centroid);
        let offset = drawn - from.coords;
        Self {
            block,
            start: centroid + blocks.gradient(block) * offset,
            offset,
        }
    }

    /// Position, displacement since the start and velocity; NaN once the block is gone; m, m, m/s.
    ///
    /// ```text
    /// x = c + F (X − C)                                     F = R of a rigid block      [m]
    /// ```
    pub(super) fn read(&self, blocks: &Blocks) -> [Vec3; 3] {
        if blocks.is_removed(self.block) {
            return [Vec3::repeat(f64::NAN); 3];
        }
        let x = blocks.centroid(self.block) + blocks.gradient(self.block) * self.offset;
        [x, x - self.start, blocks.velocity_at(self.block, &x)]
    }
}
