//! Pairs of a grain and a particle of water within its kernel.
//!
//! Lists by grain, each in order of the particles. Sums over the water of a grain run along its list; sums over the grains of a
//! particle are made for ranges of particles, each by one task that goes through the parts of all lists within its range. Both have
//! a fixed order, and need no second list.

use std::f64::consts::PI;
use std::ops::Range;

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;
use riprap_dda::Blocks;
use riprap_sph::{CellGrid, Fluid, Vec3};

use super::Grain;
use super::sight::{Sight, View};

/// Grains per parallel task.
const GRAINS: usize = 32;
/// Particles per parallel task.
pub(super) const RANGE: usize = 4096;
/// Error of a place from a grain in single precision, with margin; × the radius of its kernel.
const OFFSET_ERROR: f64 = 1e-5;
/// Ranges of cells along an axis: one, or two where it is periodic.
const MOST_PIECES: usize = 2;

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
    water: Vec<u32>,
    /// Kernel of each pair; 1/m³.
    kernel: Vec<f32>,
    /// Sum of the kernel over the water of each grain; –.
    filled: Vec<f64>,
    /// Of each grain, the first of the ranges of particles that its list goes through, and where in `cuts` their first pairs are.
    first_range: Vec<u32>,
    cut_starts: Vec<u32>,
    /// First pair of each of these ranges, and the end, grain by grain.
    cuts: Vec<u32>,
    row: Row,
}

/// The water as lists are made of it.
struct Water<'a> {
    grid: &'a CellGrid,
    /// Way of the particles since they were sorted into cells; m.
    moved: f64,
    /// Positions, an axis a column; m.
    places: [&'a [f64]; 3],
    /// Of each particle; m³.
    volume: &'a [f64],
}

impl Water<'_> {
    fn place(&self, a: u32) -> Vec3 {
        Vec3::from(self.places.map(|column| column[a as usize]))
    }
}

/// Particles of a row of cells within the kernel of a grain.
#[derive(Clone, Debug, Default)]
struct Row {
    water: Vec<u32>,
    /// 1/m³.
    kernel: Vec<f32>,
    /// Squared distances of all in the cells; m².
    squares: Vec<f32>,
    /// Places from the grain, an axis a column; m.
    offsets: [Vec<f32>; 3],
}

impl Pairs {
    /// Number of pairs.
    pub(super) fn len(&self) -> usize {
        self.chunks.iter().map(|chunk| chunk.water.len()).sum()
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
                    let first = chunk.water.len();
                    chunk.starts.push(first as u32);
                    let filled = match blocks.is_removed(grain.block) {
                        true => 0.0,
                        false => chunk.list(&water, grain, blocks, &sight.of(blocks, grain)),
                    };
                    chunk.filled.push(filled);
                    chunk.cut_from(first);
                }
                chunk.starts.push(chunk.water.len() as u32);
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

    /// Calls `visit` with each particle of a grain's list and the kernel of the pair (1/m³).
    pub(super) fn for_each_of(&self, grain: usize, mut visit: impl FnMut(usize, f64)) {
        let chunk = &self.chunks[grain / GRAINS];
        let list = chunk.list_of(grain % GRAINS);
        for (&a, &w) in chunk.water[list.clone()].iter().zip(&chunk.kernel[list]) {
            visit(a as usize, f64::from(w));
        }
    }

    /// Calls `visit` with all pairs of a range of [`RANGE`] particles, grain by grain: particle, kernel (1/m³), and what `of` makes of
    /// the grain, which has water.
    pub(super) fn for_each_in<T: Copy>(
        &self,
        range: usize,
        of: impl Fn(usize) -> T,
        mut visit: impl FnMut(usize, f64, T),
    ) {
        for (number, chunk) in self.chunks.iter().enumerate() {
            for local in 0..chunk.filled.len() {
                let pairs = chunk.list_within(local, range);
                if pairs.is_empty() {
                    continue;
                }
                let value = of(number * GRAINS + local);
                for (&a, &w) in chunk.water[pairs.clone()].iter().zip(&chunk.kernel[pairs]) {
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
            &mut self.water,
            &mut self.first_range,
            &mut self.cut_starts,
            &mut self.cuts,
        ] {
            column.clear();
        }
        self.kernel.clear();
        self.filled.clear();
    }

    /// Notes where the last list, from its first pair on, goes from one range of particles to the next: to look for it in every sum
    /// took longer than the sums.
    fn cut_from(&mut self, first: usize) {
        self.cut_starts.push(self.cuts.len() as u32);
        let range_of = |a: u32| a / RANGE as u32;
        let list = &self.water[first..];
        let (Some(&lowest), Some(&highest)) = (list.first(), list.last()) else {
            self.first_range.push(0);
            return;
        };
        self.first_range.push(range_of(lowest));
        self.cuts.push(first as u32);
        for range in range_of(lowest)..range_of(highest) {
            let n = list.partition_point(|&a| range_of(a) <= range);
            self.cuts.push((first + n) as u32);
        }
        self.cuts.push(self.water.len() as u32);
    }

    /// Appends the list of a grain, in order of the particles; returns its kernel sum.
    fn list(&mut self, water: &Water, grain: &Grain, blocks: &Blocks, view: &View) -> f64 {
        let grid = water.grid;
        let kernel = Wendland::new(grain.reach);
        let centroid = blocks.centroid(grain.block);
        let x = grid.wrapped(centroid);
        // walls are where the grain is, the water where its image in the domain is
        let to_walls = centroid - x;
        let reach = grain.reach + water.moved;
        let [along, across, up] = [0, 1, 2].map(|axis| pieces(grid, axis, x[axis], reach));
        let first = self.water.len();
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
                    let to_grain = shift - x;
                    let row = cells[0].start..cells[1].end;
                    self.row.keep(water, row, &to_grain, &kernel);
                    if view.has_walls() {
                        self.row.find_offsets(water, &to_grain);
                        if view.may_hide(&centroid, &self.row.offsets, OFFSET_ERROR * reach) {
                            let sees = |a: u32| {
                                let place = water.place(a) + shift + to_walls;
                                view.sees(blocks, &centroid, &place)
                            };
                            self.row.retain(sees);
                        }
                        for image in &view.images()[1..] {
                            self.row.add_image(&(image - centroid), &kernel);
                        }
                    }
                    self.water.extend_from_slice(&self.row.water);
                    self.kernel.extend_from_slice(&self.row.kernel);
                }
            }
        }
        self.sort_from(first);
        let pairs = self.water[first..].iter().zip(&self.kernel[first..]);
        pairs
            .map(|(&a, &kernel)| water.volume[a as usize] * f64::from(kernel))
            .sum()
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

impl Row {
    /// Keeps those of some particles that are within the kernel of a grain at `-to_grain` (m).
    fn keep(&mut self, water: &Water, range: Range<usize>, to_grain: &Vec3, kernel: &Wendland) {
        let n = range.len();
        self.water.resize(n, 0);
        self.kernel.resize(n, 0.0);
        self.squares.resize(n, 0.0);
        let places = water.places.map(|column| &column[range.clone()]);
        let kept = Arch::new().dispatch(Keep {
            row: self,
            places,
            first: range.start as u32,
            to_grain,
            kernel,
        });
        self.water.truncate(kept);
        self.kernel.truncate(kept);
    }

    /// Finds the places of those kept from a grain at `-to_grain`; m.
    fn find_offsets(&mut self, water: &Water, to_grain: &Vec3) {
        let of_axes = self.offsets.iter_mut().zip(water.places).zip(to_grain);
        for ((offsets, places), to_grain) in of_axes {
            offsets.clear();
            offsets.extend((self.water.iter()).map(|&a| (places[a as usize] + to_grain) as f32));
        }
    }

    /// Keeps what is wanted.
    fn retain(&mut self, is_wanted: impl Fn(u32) -> bool) {
        let [x, y, z] = &mut self.offsets;
        let mut n = 0;
        for k in 0..self.water.len() {
            (self.water[n], self.kernel[n]) = (self.water[k], self.kernel[k]);
            (x[n], y[n], z[n]) = (x[k], y[k], z[k]);
            n += usize::from(is_wanted(self.water[k]));
        }
        self.water.truncate(n);
        self.kernel.truncate(n);
        for offsets in &mut self.offsets {
            offsets.truncate(n);
        }
    }

    /// Adds the kernel of an image at a place from the grain; m.
    fn add_image(&mut self, image: &Vec3, kernel: &Wendland) {
        Arch::new().dispatch(AddImage {
            row: self,
            image: [image.x, image.y, image.z].map(|x| x as f32),
            kernel,
        });
    }
}

/// Task of [`Row::keep`]; the number that it kept.
struct Keep<'a> {
    row: &'a mut Row,
    places: [&'a [f64]; 3],
    first: u32,
    to_grain: &'a Vec3,
    kernel: &'a Wendland,
}

impl NullaryFnOnce for Keep<'_> {
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        let Self {
            row,
            places: [x, y, z],
            first,
            to_grain,
            kernel,
        } = self;
        let Row {
            water,
            kernel: values,
            squares,
            ..
        } = row;
        let (water, values) = (water.as_mut_slice(), values.as_mut_slice());
        for (((square, x), y), z) in squares.iter_mut().zip(x).zip(y).zip(z) {
            let [dx, dy, dz] = [x + to_grain.x, y + to_grain.y, z + to_grain.z];
            *square = (dx * dx + dy * dy + dz * dz) as f32;
        }
        let mut kept = 0;
        // half of them are beyond it: to write first and count then leaves the processor nothing to guess
        for (a, &square) in (first..).zip(squares.as_slice()) {
            (water[kept], values[kept]) = (a, square);
            kept += usize::from(kernel.reaches(square));
        }
        for value in &mut values[..kept] {
            *value = kernel.value(*value);
        }
        kept
    }
}

/// Task of [`Row::add_image`].
struct AddImage<'a> {
    row: &'a mut Row,
    /// m.
    image: [f32; 3],
    kernel: &'a Wendland,
}

impl NullaryFnOnce for AddImage<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let [x, y, z] = &self.row.offsets;
        let offsets = x.iter().zip(y).zip(z);
        for (value, ((x, y), z)) in self.row.kernel.iter_mut().zip(offsets) {
            let [dx, dy, dz] = [x - self.image[0], y - self.image[1], z - self.image[2]];
            *value += self.kernel.value(dx * dx + dy * dy + dz * dz);
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

/// Wendland's kernel C2 in space, in single precision: all sums use the same values.
///
/// ```text
/// W = 21/(2π R³) (1 − r/R)⁴ (1 + 4 r/R)
/// ```
struct Wendland {
    /// `1/R²`; 1/m².
    inverse_square: f32,
    /// 1/m³.
    factor: f32,
}

impl Wendland {
    fn new(reach: f64) -> Self {
        Self {
            inverse_square: (1.0 / (reach * reach)) as f32,
            factor: (21.0 / (2.0 * PI * reach.powi(3))) as f32,
        }
    }

    #[inline(always)]
    fn reaches(&self, square: f32) -> bool {
        square * self.inverse_square < 1.0
    }

    /// At a squared distance (m²), 0 beyond the radius; 1/m³.
    #[inline(always)]
    fn value(&self, square: f32) -> f32 {
        let q = (square * self.inverse_square).sqrt().min(1.0);
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
