//! A box of water, which must be clear of blocks.

use riprap_dda::{Shape, Vec3};

use super::obstacles::{Part, parts};
use super::{FillError, Room, rows};

/// Tolerated overlap of a box of water with a block, for round-off and rough drawing; × spacing.
const SLACK: f64 = 0.05;

/// Cell centers of a box; a remainder of less than a spacing stays empty at the upper ends.
pub(super) fn fill(
    (min, max): (Vec3, Vec3),
    spacing: [f64; 3],
    solids: &[(String, Shape)],
    room: Room,
) -> Result<Vec<Vec3>, FillError> {
    let counts = [0, 1, 2].map(|k| rows(max[k] - min[k], spacing[k]));
    // a box without a row one way may be endless another way
    if counts.contains(&0.0) {
        return Ok(Vec::new());
    }
    room.look_at(counts.iter().product())?;
    room.holds(counts.iter().product())?;
    let counts = counts.map(|n| n as usize);
    let position = |steps: [usize; 3]| {
        min + Vec3::from_fn(|axis, _| (steps[axis] as f64 + 0.5) * spacing[axis])
    };
    check_blocks(solids, spacing, |part| {
        // only the nodes in the part's own box
        let (low, high) = part.aabb();
        let range = |axis: usize| {
            let step = |x: f64| (x - min[axis]) / spacing[axis] - 0.5;
            let first = step(low[axis]).ceil().max(0.0) as usize;
            let end = (step(high[axis]).floor() + 1.0).max(0.0) as usize;
            first..end.min(counts[axis])
        };
        let mut deepest: f64 = 0.0;
        for k in range(2) {
            for j in range(1) {
                for i in range(0) {
                    deepest = deepest.max(part.depth(&position([i, j, k])));
                }
            }
        }
        deepest
    })?;
    let mut positions = Vec::with_capacity(counts.iter().product());
    for k in 0..counts[2] {
        for j in 0..counts[1] {
            positions.extend((0..counts[0]).map(|i| position([i, j, k])));
        }
    }
    Ok(positions)
}

/// Error with the block of deepest overlap.
fn check_blocks(
    solids: &[(String, Shape)],
    spacing: [f64; 3],
    depth_of: impl Fn(&Part) -> f64,
) -> Result<(), FillError> {
    let limit = SLACK * spacing.iter().copied().fold(f64::INFINITY, f64::min);
    let mut worst = (0.0, 0);
    for (block, part) in parts(solids) {
        let depth = depth_of(&part);
        if depth > worst.0 {
            worst = (depth, block);
        }
    }
    if worst.0 > limit {
        return Err(FillError::InBlock {
            block: solids[worst.1].0.clone(),
            depth: worst.0,
        });
    }
    Ok(())
}
