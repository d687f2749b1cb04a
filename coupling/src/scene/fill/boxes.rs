//! A box of water, which must be clear of blocks.

use riprap_dda::{Shape, Vec3};

use super::obstacles::{Part, parts};
use super::{FillError, Room, rows};

/// Fewest spacings that a box is thick: rows are rounded.
const THINNEST: f64 = 0.5;
/// Change of a spacing that is tried to give particles the volume of those of other regions; –.
const STRETCH: f64 = 0.06;
/// Rows tried on either side of the nearest number of them.
const MOST_ROWS: f64 = 20.0;
/// Accepted deviation of the volume of a particle from that of other regions; –.
const GOOD: f64 = 2e-4;
/// Cost of a further deviation in relation to stretch.
const COST_OF_VOLUME: f64 = 1e3;

/// Rows of a box and their spacings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rows {
    /// Whole numbers, of any size.
    pub(super) counts: [f64; 3],
    /// m.
    pub(super) spacing: [f64; 3],
}

impl Rows {
    /// Rows that fill a box exactly, with spacings near those of the lattice, and where other regions set the volume of a
    /// particle with that volume. Across a flow in a plane the spacing stays.
    pub(super) fn of(
        extent: Vec3,
        spacing: [f64; 3],
        (volume, is_plane): (Option<f64>, bool),
    ) -> Self {
        let ratio = [0, 1, 2].map(|axis| extent[axis] / spacing[axis]);
        let counts = [0, 1, 2].map(|axis| match ratio[axis] {
            _ if is_plane && axis == 1 => vec![rows(extent.y, spacing[1])],
            ratio if !(THINNEST <= ratio) => vec![0.0],
            ratio if volume.is_none() || !ratio.is_finite() => vec![ratio.round()],
            ratio => {
                let first = (ratio * (1.0 - STRETCH)).max(ratio - MOST_ROWS).floor();
                let last = (ratio * (1.0 + STRETCH)).min(ratio + MOST_ROWS).ceil();
                let n = (last - first) as u32;
                (0..=n).map(|k| (first + f64::from(k)).max(1.0)).collect()
            }
        });
        let rows = |counts: [f64; 3]| Self {
            counts,
            spacing: [0, 1, 2].map(|axis| {
                if (is_plane && axis == 1) || counts[axis] == 0.0 {
                    spacing[axis]
                } else {
                    extent[axis] / counts[axis]
                }
            }),
        };
        let cost = |rows: &Self| {
            let stretch = (0..3)
                .map(|axis| (rows.spacing[axis] / spacing[axis]).ln().abs())
                .fold(0.0, f64::max);
            let own: f64 = rows.spacing.iter().product();
            let off = volume.map_or(0.0, |volume| (own / volume - 1.0).abs());
            stretch + COST_OF_VOLUME * (off - GOOD).max(0.0)
        };
        let mut best = rows(counts.each_ref().map(|counts| counts[0]));
        for &nz in &counts[2] {
            for &ny in &counts[1] {
                for &nx in &counts[0] {
                    let found = rows([nx, ny, nz]);
                    if cost(&found) < cost(&best) {
                        best = found;
                    }
                }
            }
        }
        best
    }
}

/// Tolerated overlap of a box of water with a block, for round-off and rough drawing; × spacing.
const SLACK: f64 = 0.05;

/// Centers of the cells of a box.
pub(super) fn fill(
    min: Vec3,
    Rows { counts, spacing }: Rows,
    solids: &[(String, Shape)],
    room: Room,
) -> Result<Vec<Vec3>, FillError> {
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
