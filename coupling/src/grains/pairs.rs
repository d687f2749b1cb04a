//! Pairs of a grain and a particle of water within its kernel.
//!
//! Lists by grain, each in order of the particles. Sums over the water of a grain run along its list; sums over the grains of a
//! particle are made for ranges of particles, each by one task that goes through the parts of all lists within its range. Both have
//! a fixed order, and need no second list.

use std::ops::Range;

use rayon::prelude::*;
use riprap_dda::Blocks;
use riprap_sph::{Fluid, Vec3};

use super::Grain;
use super::cells::pieces;
use super::nearby::{Cells, Nearby, Water, Wendland};
use super::sight::{Sight, View};
use super::sums::{Gather, Pair, Spread};

/// Grains per parallel task.
const GRAINS: usize = 32;
/// Particles per parallel task.
pub(super) const RANGE: usize = 8192;
/// Error of a place from a grain in single precision, with margin; × the radius of its kernel.
const OFFSET_ERROR: f64 = 1e-5;

/// Lists of all grains.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    chunks: Vec<Chunk>,
    /// Positions of the particles, an axis a column; m.
    places: [Vec<f64>; 3],
}

/// Lists of some grains, one after the other.
#[derive(Clone, Debug, Default)]
struct Chunk {
    /// First pair of each grain, and the end.
    starts: Vec<u32>,
    pairs: Vec<Pair>,
    /// Sum of the kernel over the water of each grain; –.
    filled: Vec<f64>,
    /// Of each grain, the first of the ranges of particles that its list goes through, and where in `cuts` their first pairs are.
    first_range: Vec<u32>,
    cut_starts: Vec<u32>,
    /// First pair of each of these ranges, and the end, grain by grain.
    cuts: Vec<u32>,
    nearby: Nearby,
}

impl Pairs {
    /// Number of pairs.
    pub(super) fn len(&self) -> usize {
        self.chunks.iter().map(|chunk| chunk.pairs.len()).sum()
    }

    /// Lists the water that grains see within their kernels, of a volume a particle (m³). Periods are at least two radii.
    pub(super) fn find(
        &mut self,
        water: (&Fluid, &[f64]),
        grains: &[Grain],
        (sight, blocks): (&Sight, &Blocks),
    ) {
        let (fluid, volume) = water;
        let position = fluid.particles().position.as_slice();
        for (axis, column) in self.places.iter_mut().enumerate() {
            column.clear();
            column.extend(position.iter().map(|x| x[axis]));
        }
        let places = self.places.each_ref().map(Vec::as_slice);
        let water = Water {
            grid: fluid.grid(),
            moved: fluid.moved(),
            places,
            volume,
        };
        let n_chunks = grains.len().div_ceil(GRAINS);
        self.chunks.resize_with(n_chunks, Chunk::default);
        self.chunks
            .par_iter_mut()
            .zip(grains.par_chunks(GRAINS))
            .for_each(|(chunk, grains)| {
                chunk.clear();
                for grain in grains {
                    let first = chunk.pairs.len();
                    chunk.starts.push(first as u32);
                    let filled = match blocks.is_removed(grain.block) {
                        true => 0.0,
                        false => chunk.list(&water, grain, blocks, &sight.of(blocks, grain)),
                    };
                    chunk.filled.push(filled);
                    chunk.cut_from(first);
                }
                chunk.starts.push(chunk.pairs.len() as u32);
                chunk.cut_starts.push(chunk.cuts.len() as u32);
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

    /// Sums of values of the particles of a grain's list times the kernel (1/m³), and of the last of them times its square.
    pub(super) fn sums_of_water<const N: usize>(
        &self,
        grain: usize,
        values: &[[f64; N]],
    ) -> ([f64; N], f64) {
        let chunk = &self.chunks[grain / GRAINS];
        let list = &chunk.pairs[chunk.list_of(grain % GRAINS)];
        Gather { list, values }.run()
    }

    /// Finds the sums of what `of` makes of the grains that have water, times the kernel (1/m³), of each particle of a range of [`RANGE`].
    pub(super) fn sums_of_grains<const N: usize>(
        &self,
        range: usize,
        of: impl Fn(usize) -> [f64; N],
        sums: &mut [[f64; N]],
    ) {
        sums.fill([0.0; N]);
        for (number, chunk) in self.chunks.iter().enumerate() {
            for local in 0..chunk.filled.len() {
                let pairs = chunk.list_within(local, range);
                if pairs.is_empty() {
                    continue;
                }
                let spread = Spread {
                    list: &chunk.pairs[pairs],
                    of_grain: of(number * GRAINS + local),
                    first: range * RANGE,
                    sums,
                };
                spread.run();
            }
        }
    }
}

impl Chunk {
    fn list_of(&self, local: usize) -> Range<usize> {
        self.starts[local] as usize..self.starts[local + 1] as usize
    }

    /// Pairs of a grain and a range of particles.
    fn list_within(&self, local: usize, range: usize) -> Range<usize> {
        let cuts = self.cut_starts[local] as usize..self.cut_starts[local + 1] as usize;
        let Some(place) = range.checked_sub(self.first_range[local] as usize) else {
            return 0..0;
        };
        match self.cuts[cuts].get(place..place + 2) {
            Some(&[from, to]) => from as usize..to as usize,
            _ => 0..0,
        }
    }

    fn clear(&mut self) {
        for column in [
            &mut self.starts,
            &mut self.first_range,
            &mut self.cut_starts,
            &mut self.cuts,
        ] {
            column.clear();
        }
        self.pairs.clear();
        self.filled.clear();
    }

    /// Notes where the last list, from its first pair on, goes from one range of particles to the next: to look for it in every sum
    /// took longer than the sums.
    fn cut_from(&mut self, first: usize) {
        self.cut_starts.push(self.cuts.len() as u32);
        let range_of = |pair: &Pair| pair.water / RANGE as u32;
        let list = &self.pairs[first..];
        let (Some(lowest), Some(highest)) = (list.first(), list.last()) else {
            self.first_range.push(0);
            return;
        };
        self.first_range.push(range_of(lowest));
        self.cuts.push(first as u32);
        for range in range_of(lowest)..range_of(highest) {
            let n = list.partition_point(|pair| range_of(pair) <= range);
            self.cuts.push((first + n) as u32);
        }
        self.cuts.push(self.pairs.len() as u32);
    }

    /// Appends the list of a grain, in order of the particles; returns its kernel sum.
    fn list(&mut self, water: &Water, grain: &Grain, blocks: &Blocks, view: &View) -> f64 {
        let grid = water.grid;
        let kernel = Wendland::new(grain.reach);
        let centroid = blocks.centroid(grain.block);
        let x = grid.wrapped(centroid);
        let reach = grain.reach + water.moved;
        let [along, across, up] = [0, 1, 2].map(|axis| pieces(grid, axis, x[axis], reach));
        let first = self.pairs.len();
        let gap = |axis: usize, cell: usize, shift: f64| {
            let low = grid.min()[axis] + cell as f64 * grid.cell_size()[axis] + shift;
            (low - x[axis])
                .max(x[axis] - low - grid.cell_size()[axis])
                .max(0.0)
        };
        let nearby = &mut self.nearby;
        nearby.cells.clear();
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
                    let ends = [from, to].map(|i| grid.particles_in(grid.cell_at([i, j, k])));
                    nearby.cells.push(Cells {
                        particles: ends[0].start..ends[1].end,
                        shift: Vec3::new(piece.shift, y, z),
                    });
                }
            }
        }
        nearby.keep(water, &x, &kernel);
        // walls are where the grain is, the water where its image in the domain is
        if view.may_hide(&centroid, nearby.offsets(), OFFSET_ERROR * reach) {
            nearby.retain(|offset| view.sees(blocks, &centroid, &(centroid + offset)));
        }
        nearby.find_kernel(&centroid, &view.images()[1..], &kernel);
        self.pairs.extend(nearby.pairs());
        let list = &mut self.pairs[first..];
        // out of order is only what was found across the sides of a narrow period
        if !list.is_sorted_by_key(|pair| pair.water) {
            list.sort_by_key(|pair| pair.water);
        }
        (list.iter())
            .map(|pair| water.volume[pair.water as usize] * f64::from(pair.kernel))
            .sum()
    }
}
