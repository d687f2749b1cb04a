//! Pairs of a grain and a particle of water within its kernel.
//!
//! Lists by grain, each in order of the particles. Sums over the water of a grain run along its list; sums over the grains of a
//! particle are made for ranges of particles, each by one task that goes through the parts of all lists within its range. Both have
//! a fixed order, and need no second list.

use std::f64::consts::PI;
use std::ops::Range;

use rayon::prelude::*;
use riprap_dda::Blocks;
use riprap_sph::{CellGrid, Fluid, Vec3};

use super::Grain;
use super::sight::{Sight, View};

/// Grains per parallel task.
const GRAINS: usize = 32;
/// Particles per parallel task.
pub(super) const RANGE: usize = 4096;
/// Ranges of cells along an axis: one, or two where it is periodic.
const MOST_PIECES: usize = 2;

/// Lists of all grains.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    chunks: Vec<Chunk>,
}

/// Lists of some grains, one after the other.
#[derive(Clone, Debug, Default)]
struct Chunk {
    /// First pair of each grain, and the end.
    starts: Vec<u32>,
    water: Vec<u32>,
    /// Kernel of each pair; 1/m³.
    kernel: Vec<f32>,
    /// Sum of the kernel over the water of each grain; –.
    filled: Vec<f64>,
}

impl Pairs {
    /// Number of pairs.
    pub(super) fn len(&self) -> usize {
        self.chunks.iter().map(|chunk| chunk.water.len()).sum()
    }

    /// Lists the water that grains see within their kernels. Periods are at least two radii.
    pub(super) fn find(
        &mut self,
        fluid: &Fluid,
        grains: &[Grain],
        (sight, blocks): (&Sight, &Blocks),
    ) {
        let n_chunks = grains.len().div_ceil(GRAINS);
        self.chunks.resize_with(n_chunks, Chunk::default);
        self.chunks
            .par_iter_mut()
            .zip(grains.par_chunks(GRAINS))
            .for_each(|(chunk, grains)| {
                chunk.starts.clear();
                chunk.water.clear();
                chunk.kernel.clear();
                chunk.filled.clear();
                for grain in grains {
                    chunk.starts.push(chunk.water.len() as u32);
                    let filled = match blocks.is_removed(grain.block) {
                        true => 0.0,
                        false => chunk.list(fluid, grain, blocks, &sight.of(blocks, grain)),
                    };
                    chunk.filled.push(filled);
                }
                chunk.starts.push(chunk.water.len() as u32);
            });
    }

    /// Sum of the kernel over the water of each grain; –.
    pub(super) fn filled(&self) -> impl Iterator<Item = f64> + '_ {
        self.chunks
            .iter()
            .flat_map(|chunk| chunk.filled.iter().copied())
    }

    /// `Σ_i V_i W_ij` of a grain; –.
    pub(super) fn filled_of(&self, grain: usize) -> f64 {
        self.chunks[grain / GRAINS].filled[grain % GRAINS]
    }

    /// Calls `visit` with each particle of a grain's list and the kernel of the pair (1/m³).
    pub(super) fn for_each_of(&self, grain: usize, mut visit: impl FnMut(usize, f64)) {
        let chunk = &self.chunks[grain / GRAINS];
        for k in chunk.list_of(grain % GRAINS) {
            visit(chunk.water[k] as usize, f64::from(chunk.kernel[k]));
        }
    }

    /// Calls `visit` with all pairs of a range of particles, grain by grain: particle, kernel (1/m³), and what `of` makes of the
    /// grain, which has water.
    pub(super) fn for_each_in<T: Copy>(
        &self,
        range: Range<usize>,
        of: impl Fn(usize) -> T,
        mut visit: impl FnMut(usize, f64, T),
    ) {
        let (first, end) = (range.start as u32, range.end as u32);
        for (number, chunk) in self.chunks.iter().enumerate() {
            for local in 0..chunk.filled.len() {
                let list = chunk.list_of(local);
                let water = &chunk.water[list.clone()];
                let (Some(&lowest), Some(&highest)) = (water.first(), water.last()) else {
                    continue;
                };
                if end <= lowest || highest < first {
                    continue;
                }
                let from = water.partition_point(|&a| a < first);
                let to = water.partition_point(|&a| a < end);
                if from == to {
                    continue;
                }
                let value = of(number * GRAINS + local);
                let kernel = &chunk.kernel[list];
                for (&a, &w) in water[from..to].iter().zip(&kernel[from..to]) {
                    visit(a as usize, f64::from(w), value);
                }
            }
        }
    }
}

impl Chunk {
    fn list_of(&self, local: usize) -> Range<usize> {
        self.starts[local] as usize..self.starts[local + 1] as usize
    }

    /// Appends the list of a grain, in order of the particles; returns its kernel sum.
    fn list(&mut self, fluid: &Fluid, grain: &Grain, blocks: &Blocks, view: &View) -> f64 {
        let (grid, particles) = (fluid.grid(), fluid.particles());
        let kernel = Wendland::new(grain.reach);
        let x = grid.wrapped(blocks.centroid(grain.block));
        let reach = grain.reach + fluid.moved();
        let [along, across, up] = [0, 1, 2].map(|axis| pieces(grid, axis, x[axis], reach));
        let (first, mut filled) = (self.water.len(), 0.0);
        let gap = |axis: usize, cell: usize, shift: f64| {
            let low = grid.min()[axis] + cell as f64 * grid.cell_size()[axis] + shift;
            (low - x[axis])
                .max(x[axis] - low - grid.cell_size()[axis])
                .max(0.0)
        };
        for (k, z) in up.cells() {
            let left = reach * reach - gap(2, k, z).powi(2);
            for (j, y) in across.cells() {
                let chord2 = left - gap(1, j, y).powi(2);
                if chord2 <= 0.0 {
                    continue;
                }
                for piece in along.ranges() {
                    let Some((from, to)) = piece.within(grid, x.x, chord2.sqrt()) else {
                        continue;
                    };
                    let cells = [from, to].map(|i| grid.particles_in(grid.cell_at([i, j, k])));
                    let shift = Vec3::new(piece.shift, y, z);
                    for a in cells[0].start..cells[1].end {
                        let place = particles.position[a] + shift;
                        let value = kernel.value((place - x).norm_squared());
                        if value == 0.0 || !view.sees(blocks, &x, &place) {
                            continue;
                        }
                        let images = view.images()[1..].iter();
                        let of_images: f64 = images
                            .map(|image| kernel.value((place - image).norm_squared()))
                            .sum();
                        // of single precision, in all sums alike
                        let value = (value + of_images) as f32;
                        self.water.push(a as u32);
                        self.kernel.push(value);
                        filled += particles.volume_with_grains(a) * f64::from(value);
                    }
                }
            }
        }
        self.sort_from(first);
        filled
    }

    /// Puts the last list in order, from its first pair on; out of order is only what was found across the sides of a narrow period.
    fn sort_from(&mut self, first: usize) {
        if self.water[first..].is_sorted() {
            return;
        }
        let mut pairs: Vec<(u32, f32)> = (self.water[first..].iter().copied())
            .zip(self.kernel[first..].iter().copied())
            .collect();
        pairs.sort_by_key(|&(a, _)| a);
        for (k, (a, kernel)) in pairs.into_iter().enumerate() {
            (self.water[first + k], self.kernel[first + k]) = (a, kernel);
        }
    }
}

/// Cells along an axis, in order, with the shift (m) of their particles to the image that is near.
#[derive(Clone, Copy, Debug, Default)]
struct Pieces {
    pieces: [Piece; MOST_PIECES],
    n: usize,
}

#[derive(Clone, Copy, Debug, Default)]
struct Piece {
    first: usize,
    last: usize,
    shift: f64,
}

impl Pieces {
    fn ranges(&self) -> &[Piece] {
        &self.pieces[..self.n]
    }

    fn cells(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        (self.ranges().iter())
            .flat_map(|piece| (piece.first..=piece.last).map(|cell| (cell, piece.shift)))
    }
}

impl Piece {
    /// Those along x within a distance (m) of a coordinate (m).
    fn within(&self, grid: &CellGrid, x: f64, distance: f64) -> Option<(usize, usize)> {
        let (min, size) = (grid.min().x + self.shift, grid.cell_size().x);
        // positions out of the domain are in the outermost cells
        let cell = |x: f64| ((x - min) / size).floor().max(0.0) as usize;
        let from = self.first.max(cell(x - distance).min(self.last));
        let to = self.last.min(cell(x + distance).max(self.first));
        (from <= to).then_some((from, to))
    }
}

/// Wendland's kernel C2 in space.
///
/// ```text
/// W = 21/(2π R³) (1 − r/R)⁴ (1 + 4 r/R)
/// ```
struct Wendland {
    /// `1/R²`; 1/m².
    inverse_square: f64,
    /// 1/m³.
    factor: f64,
}

impl Wendland {
    fn new(reach: f64) -> Self {
        Self {
            inverse_square: 1.0 / (reach * reach),
            factor: 21.0 / (2.0 * PI * reach.powi(3)),
        }
    }

    /// At a squared distance (m²); 1/m³.
    fn value(&self, square: f64) -> f64 {
        let q2 = square * self.inverse_square;
        if 1.0 <= q2 {
            return 0.0;
        }
        let q = q2.sqrt();
        let w2 = (1.0 - q) * (1.0 - q);
        self.factor * w2 * w2 * (1.0 + 4.0 * q)
    }
}

/// Cells within `reach` (m) of a coordinate (m) along an axis.
fn pieces(grid: &CellGrid, axis: usize, x: f64, reach: f64) -> Pieces {
    let (count, min) = (grid.counts()[axis], grid.min()[axis]);
    let size = grid.cell_size()[axis];
    let cell = |x: f64| ((x - min) / size).floor();
    let (low, high) = (cell(x - reach), cell(x + reach));
    let last = count - 1;
    let within = |cell: f64| cell.clamp(0.0, last as f64) as usize;
    let whole = Piece {
        first: within(low),
        last: within(high),
        shift: 0.0,
    };
    let mut found = Pieces::default();
    let mut add = |piece: Piece| {
        found.pieces[found.n] = piece;
        found.n += 1;
    };
    let period = grid.extent()[axis];
    if !grid.periodic()[axis] || (0.0 <= low && high <= last as f64) {
        add(whole);
    } else if low < 0.0 {
        // those beyond the lower end are at the upper one
        add(Piece {
            first: 0,
            last: within(high),
            shift: 0.0,
        });
        add(Piece {
            first: within(low + count as f64),
            last,
            shift: -period,
        });
    } else {
        add(Piece {
            first: 0,
            last: within(high - count as f64),
            shift: period,
        });
        add(Piece {
            first: within(low),
            last,
            shift: 0.0,
        });
    }
    found
}
