//! A box of water, which must be clear of blocks.

use riprap_dda::{Shape, Vec3};

use super::obstacles::{Part, parts};
use super::{FillError, Room, rows};

/// Tolerated overlap of a box of water with a block, for round-off and rough drawing; × spacing.
const SLACK: f64 = 0.05;
/// Fewest spacings that a box is thick: rows are rounded.
const THINNEST: f64 = 0.5;
/// Change of a spacing that is tried to give particles one volume in several boxes; –.
const STRETCH: f64 = 0.06;
/// Rows tried on either side of the nearest number of them, in a plane and in space.
const MOST_ROWS: [f64; 2] = [20.0, 4.0];
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

/// Lattice that boxes are filled with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// m.
    pub(super) spacing: [f64; 3],
    /// A flow in a plane, across which the spacing stays.
    pub(super) is_plane: bool,
}

impl Grid {
    /// Rows that fill a box exactly, with spacings near those of the lattice, and where other regions set the volume of a
    /// particle (m³) with that volume.
    pub(super) fn rows(&self, extent: Vec3, volume: Option<f64>) -> Rows {
        match volume {
            None => self.counted(extent, self.nearest(extent)),
            Some(volume) => self.best(&self.options(extent), volume).1,
        }
    }

    /// Volume of a particle with which the rows of all boxes are stretched least; m³.
    pub(super) fn common_volume(&self, extents: &[Vec3]) -> Option<f64> {
        let by_size = |a: &&Vec3, b: &&Vec3| a.product().total_cmp(&b.product());
        let largest = extents.iter().max_by(by_size)?;
        if extents.len() == 1 {
            return Some(self.rows(*largest, None).volume());
        }
        let options: Vec<Vec<Rows>> = extents.iter().map(|x| self.options(*x)).collect();
        let cost = |volume: f64| -> f64 {
            let all = options.iter();
            all.map(|options| self.best(options, volume).0).sum()
        };
        let volumes = self.options(*largest).into_iter().map(|rows| rows.volume());
        volumes
            .map(|volume| (cost(volume), volume))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, volume)| volume)
    }

    /// Nearest numbers of rows; none where a box is too thin for one.
    fn nearest(&self, extent: Vec3) -> [f64; 3] {
        [0, 1, 2].map(|axis| match extent[axis] / self.spacing[axis] {
            _ if self.is_plane && axis == 1 => rows(extent.y, self.spacing[1]),
            ratio if THINNEST <= ratio => ratio.round(),
            _ => 0.0,
        })
    }

    fn counted(&self, extent: Vec3, counts: [f64; 3]) -> Rows {
        let spacing = [0, 1, 2].map(|axis| {
            if (self.is_plane && axis == 1) || counts[axis] == 0.0 {
                self.spacing[axis]
            } else {
                extent[axis] / counts[axis]
            }
        });
        Rows { counts, spacing }
    }

    /// Rows of a box that are stretched a little more than the nearest, which come first.
    fn options(&self, extent: Vec3) -> Vec<Rows> {
        let nearest = self.nearest(extent);
        let most = MOST_ROWS[usize::from(!self.is_plane)];
        let counts = [0, 1, 2].map(|axis| {
            let n = nearest[axis];
            let is_fixed = n == 0.0 || !n.is_finite() || (self.is_plane && axis == 1);
            let by = if is_fixed {
                0.0
            } else {
                (STRETCH * n).clamp(1.0, most)
            };
            let first = (n - by).ceil();
            let others = (0..=(2.0 * by) as u32).map(move |k| first + f64::from(k));
            std::iter::once(n).chain(others.filter(move |other| 1.0 <= *other && *other != n))
        });
        let [x, y, z] = counts;
        let mut options = Vec::new();
        for nz in z {
            for ny in y.clone() {
                options.extend(x.clone().map(|nx| self.counted(extent, [nx, ny, nz])));
            }
        }
        options
    }

    /// Cost and rows of the best of some options for a volume of a particle.
    fn best(&self, options: &[Rows], volume: f64) -> (f64, Rows) {
        let cost = |rows: &Rows| {
            let stretch = (0..3)
                .map(|axis| (rows.spacing[axis] / self.spacing[axis]).ln().abs())
                .fold(0.0, f64::max);
            let off = (rows.volume() / volume - 1.0).abs();
            stretch + COST_OF_VOLUME * (off - GOOD).max(0.0)
        };
        let mut best = (cost(&options[0]), options[0]);
        for rows in &options[1..] {
            let cost = cost(rows);
            if cost < best.0 {
                best = (cost, *rows);
            }
        }
        best
    }
}

impl Rows {
    /// Volume of a particle; m³.
    pub(super) fn volume(&self) -> f64 {
        self.spacing.iter().product()
    }
}

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
