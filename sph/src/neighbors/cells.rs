//! A grid of cells over the domain: which particles may be neighbors.
//!
//! Across x cells are no smaller than the support radius, so the neighbors of a particle lie in its
//! own row of cells and the eight around it. Particles are kept sorted by cell, x fastest, so that
//! the part of a row within reach is one contiguous run of particles: nine runs (a few more at a
//! periodic edge) hold all candidates. The grid is fixed: data of a cell (the walls nearby) remain valid.

use crate::Vec3;
use crate::error::FluidError;
use crate::neighbors::chords::{CLASSES, Chords, PARTS, Rows};

/// Periodic directions.
pub type Periodicity = [bool; 3];

/// Cells per support radius along x: rows are cut into chords of this fineness.
pub(crate) const ROW_SPLIT: f64 = 4.0;

/// Most runs of candidates: nine rows, cut in three at a periodic edge in x.
pub const MAX_RUNS: usize = 27;

/// A contiguous run of sorted particles in a periodic image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Run {
    /// First particle.
    pub start: u32,
    /// One past the last particle.
    pub end: u32,
    /// Image of the run: 13 is the domain itself, see [`CellGrid::image_shift`].
    pub image: u8,
}

/// Ranges of cells that are sorted at once, at most: each looks through all particles.
const MOST_RANGES: usize = 16;

/// The image that is the domain itself.
pub const OWN_IMAGE: u8 = 13;

/// A uniform grid over the domain with the particles of each cell.
#[derive(Clone, Debug)]
pub struct CellGrid {
    min: Vec3,
    max: Vec3,
    periodic: Periodicity,
    counts: [usize; 3],
    cell_size: Vec3,
    inverse_cell_size: Vec3,
    /// Cells along x within which all neighbors of a cell lie.
    reach_x: usize,
    /// First particle of each cell, and one more; valid since the last sort.
    starts: Vec<u32>,
}

impl CellGrid {
    /// First particle of each cell, and one more, as of the last sort.
    pub(crate) fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// Takes these over; `n` particles in cells one after the other, or `false`.
    pub(crate) fn set_starts(&mut self, starts: Vec<u32>, n: usize) -> bool {
        let fits = starts.len() == self.starts.len()
            && starts.first() == Some(&0)
            && starts.is_sorted()
            && starts.last().is_some_and(|&last| last as usize == n);
        if fits {
            self.starts = starts;
        }
        fits
    }

    /// A grid over the box `min..max` with cells no smaller than the support radius and a skin.
    ///
    /// A domain much larger than its water gets coarser cells, never more than `max_cells` of them:
    /// correct all the same, only with more candidates per particle.
    ///
    /// # Errors
    ///
    /// [`FluidError::NarrowPeriod`] when a periodic extent is less than the support radius.
    pub fn new(
        (min, max): (Vec3, Vec3),
        periodic: Periodicity,
        (support_radius, skin): (f64, f64),
        max_cells: usize,
    ) -> Result<Self, FluidError> {
        let extent = max - min;
        for axis in 0..3 {
            // a slab of whole spacings may miss the support by round-off only
            if periodic[axis] && extent[axis] < support_radius * (1.0 - 1e-12) {
                return Err(FluidError::NarrowPeriod {
                    axis,
                    extent: extent[axis],
                    support_radius,
                });
            }
        }
        let mut edge = support_radius + skin;
        let counts = loop {
            let split = [ROW_SPLIT, 1.0, 1.0];
            let counts = [0, 1, 2].map(|axis| {
                (split[axis] * extent[axis] / edge * (1.0 + 1e-12))
                    .floor()
                    .max(1.0)
            });
            // as numbers of cells they may be too many to count
            if counts.iter().product::<f64>() <= max_cells.max(1) as f64 {
                break counts.map(|n| n as usize);
            }
            edge *= 1.25;
        };
        let cell_size = Vec3::from_fn(|axis, _| extent[axis] / counts[axis] as f64);
        Ok(Self {
            min,
            max,
            periodic,
            counts,
            cell_size,
            inverse_cell_size: cell_size.map(f64::recip),
            reach_x: ((support_radius + skin) / cell_size.x).ceil() as usize,
            starts: vec![0; counts.iter().product::<usize>() + 1],
        })
    }

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.counts.iter().product()
    }

    /// The same cells, which must be sorted into, or counted, before anything asks for particles.
    pub(crate) fn without_particles(&self) -> Self {
        Self {
            starts: Vec::new(),
            ..*self
        }
    }

    /// Makes room for particles of given cells and their numbers, one after the other; the others are empty.
    pub(crate) fn count(&mut self, cells: impl Iterator<Item = (u32, u32)>) {
        self.clear();
        for (cell, n) in cells {
            self.starts[cell as usize + 1] = n;
        }
        for c in 1..self.starts.len() {
            self.starts[c] += self.starts[c - 1];
        }
    }

    fn clear(&mut self) {
        self.starts.clear();
        self.starts.resize(self.n_cells() + 1, 0);
    }

    /// Cells along x, y, z.
    pub fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// Size of a cell; m.
    pub fn cell_size(&self) -> Vec3 {
        self.cell_size
    }

    /// Lower corner of the domain; m.
    pub fn min(&self) -> Vec3 {
        self.min
    }

    /// Periodic directions.
    pub fn periodic(&self) -> Periodicity {
        self.periodic
    }

    /// Period of each direction; m.
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// Cell of a position; positions outside count to the nearest cell.
    #[inline(always)]
    pub fn cell_of(&self, position: &Vec3) -> usize {
        let [i, j, k] = self.coordinates_of(position);
        self.cell_at([i, j, k])
    }

    /// Coordinates of the cell of a position.
    #[inline(always)]
    pub fn coordinates_of(&self, position: &Vec3) -> [usize; 3] {
        // without a closure, which is a call where code is made for registers that others lack
        [
            self.coordinate(position, 0),
            self.coordinate(position, 1),
            self.coordinate(position, 2),
        ]
    }

    #[inline(always)]
    fn coordinate(&self, position: &Vec3, axis: usize) -> usize {
        let place = (position[axis] - self.min[axis]) * self.inverse_cell_size[axis];
        // the cast saturates: NaN and negatives go to 0, overshoot is cut
        (place as usize).min(self.counts[axis] - 1)
    }

    /// Number of the cell at coordinates within the grid.
    #[inline(always)]
    pub fn cell_at(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.counts[1] + j) * self.counts[0] + i
    }

    /// Center of the cell at coordinates within the grid; m.
    pub fn cell_center(&self, coordinates: [usize; 3]) -> Vec3 {
        self.min + Vec3::from_fn(|axis, _| (coordinates[axis] as f64 + 0.5) * self.cell_size[axis])
    }

    /// Particles of a cell, a range of sorted indices.
    pub fn particles_in(&self, cell: usize) -> std::ops::Range<usize> {
        self.starts[cell] as usize..self.starts[cell + 1] as usize
    }

    /// Particles of a row's cells, a range of sorted indices.
    pub(crate) fn particles_in_row(&self, row: std::ops::Range<usize>) -> std::ops::Range<usize> {
        self.starts[row.start] as usize..self.starts[row.end] as usize
    }

    /// Whether any of a row's cells holds a particle.
    pub(crate) fn has_particles(&self, row: std::ops::Range<usize>) -> bool {
        self.starts[row.start] < self.starts[row.end]
    }

    /// Calls `visit` with the cells, row by row, that may contain points within the support, and the skin,
    /// of a point in `cell`.
    pub(crate) fn rows_round(&self, cell: usize, mut visit: impl FnMut(std::ops::Range<usize>)) {
        let [nx, ny, _] = self.counts;
        let (i, j, k) = (cell % nx, cell / nx % ny, cell / (nx * ny));
        let n = nx as i64;
        let reach = self.reach_x as i64;
        let (low, high) = (i as i64 - reach, i as i64 + reach);
        for dz in -1..=1 {
            let Some((layer, _)) = self.step(2, k, dz) else {
                continue;
            };
            for dy in -1..=1 {
                let Some((row, _)) = self.step(1, j, dy) else {
                    continue;
                };
                let first = self.cell_at([0, row, layer]);
                let mut piece = |from: i64, to: i64| {
                    let (from, to) = (from.max(0), to.min(n - 1));
                    if from <= to {
                        visit(first + from as usize..first + to as usize + 1);
                    }
                };
                piece(low, high);
                if self.periodic[0] {
                    piece(low + n, n - 1);
                    piece(0, high - n);
                }
            }
        }
    }

    /// Whether a position is inside the domain or at most `margin` (m) outside; periodic directions have no outside.
    pub fn contains(&self, position: &Vec3, margin: f64) -> bool {
        (0..3).all(|axis| {
            self.periodic[axis]
                || (self.min[axis] - margin <= position[axis]
                    && position[axis] <= self.max[axis] + margin)
        })
    }

    /// The position moved into the domain along the periodic directions; m.
    pub fn wrapped(&self, position: Vec3) -> Vec3 {
        let mut wrapped = position;
        for axis in 0..3 {
            if self.periodic[axis] {
                let period = self.max[axis] - self.min[axis];
                let offset = (position[axis] - self.min[axis]).rem_euclid(period);
                // rem_euclid of a tiny negative number may round up to the period itself
                wrapped[axis] = self.min[axis] + if offset < period { offset } else { 0.0 };
            }
        }
        wrapped
    }

    /// Shift of a particle's position to its image; m.
    ///
    /// ```text
    /// image = (s_x + 1) + 3 (s_y + 1) + 9 (s_z + 1),   shift = s · period,   s = −1, 0, 1
    /// ```
    #[inline(always)]
    pub fn image_shift(&self, image: u8) -> Vec3 {
        let extent = self.max - self.min;
        let steps = [image % 3, image / 3 % 3, image / 9].map(|s| f64::from(s) - 1.0);
        Vec3::new(
            steps[0] * extent.x,
            steps[1] * extent.y,
            steps[2] * extent.z,
        )
    }

    /// Counting sort: the order that sorts particles by cell, equal cells in the old order.
    ///
    /// `cell` and `order` are scratch of the caller, filled here; afterward particle `order[s]`
    /// belongs at index `s`.
    pub fn sort(&mut self, positions: &[Vec3], cell: &mut Vec<u32>, order: &mut Vec<u32>) {
        use rayon::prelude::*;
        cell.resize(positions.len(), 0);
        order.resize(positions.len(), 0);
        cell.par_iter_mut()
            .zip(positions.par_iter())
            .with_min_len(4096)
            .for_each(|(c, x)| *c = self.cell_of(x) as u32);
        self.clear();
        // each thread takes a range of cells and looks through all particles for its own: nothing is shared
        let n_ranges = rayon::current_num_threads().min(MOST_RANGES);
        let n_cells = self.n_cells();
        let (counts, cell) = (&mut self.starts[1..], &*cell);
        let width = n_cells.div_ceil(n_ranges);
        counts
            .par_chunks_mut(width)
            .enumerate()
            .for_each(|(range, counts)| {
                let first = (range * width) as u32;
                for &c in cell {
                    if let Some(count) = counts.get_mut(c.wrapping_sub(first) as usize) {
                        *count += 1;
                    }
                }
            });
        for c in 1..self.starts.len() {
            self.starts[c] += self.starts[c - 1];
        }
        // ranges of about equal numbers of particles, each with its part of the order
        let mut parts = Vec::with_capacity(n_ranges);
        let (mut rest, mut first) = (order.as_mut_slice(), 0);
        for range in 1..=n_ranges {
            let share = (positions.len() * range / n_ranges) as u32;
            let end = match range == n_ranges {
                true => n_cells,
                false => self
                    .starts
                    .partition_point(|&start| start < share)
                    .min(n_cells),
            };
            let end = end.max(first);
            let n = (self.starts[end] - self.starts[first]) as usize;
            let (part, others) = rest.split_at_mut(n);
            parts.push((first..end, part));
            (rest, first) = (others, end);
        }
        let starts = &self.starts;
        parts.into_par_iter().for_each(|(range, part)| {
            let before = starts[range.start];
            // where the next particle of each cell goes
            let mut places: Vec<u32> = starts[range.clone()].iter().map(|s| s - before).collect();
            let first = range.start as u32;
            for (a, &c) in cell.iter().enumerate() {
                if let Some(place) = places.get_mut(c.wrapping_sub(first) as usize) {
                    part[*place as usize] = a as u32;
                    *place += 1;
                }
            }
        });
    }

    /// The runs of particles that may be within `radius` of a position, in a fixed order, those of one
    /// image together where rows allow; returns their number. The radius must not
    /// exceed that of the grid.
    ///
    /// Each of the nine rows round the position is cut to the chord that a sphere of the radius
    /// leaves in it, so that most candidates of the corners are never looked at.
    #[inline(always)]
    pub fn runs_within(&self, position: &Vec3, radius: f64, runs: &mut [Run; MAX_RUNS]) -> usize {
        let [_, j, k] = self.coordinates_of(position);
        let squares_y = self.squared_distances(1, position.y, j);
        let squares_z = self.squared_distances(2, position.z, k);
        let mut n = 0;
        for (dy, square_y) in (-1..).zip(squares_y) {
            let Some((row, sy)) = self.step(1, j, dy) else {
                continue;
            };
            for (dz, square_z) in (-1..).zip(squares_z) {
                let chord2 = radius * radius - square_y - square_z;
                if chord2 < 0.0 {
                    continue;
                }
                let Some((layer, sz)) = self.step(2, k, dz) else {
                    continue;
                };
                let first = self.cell_at([0, row, layer]);
                self.push_row(
                    first,
                    3 * sy + 9 * sz,
                    position.x,
                    chord2.sqrt(),
                    runs,
                    &mut n,
                );
            }
        }
        n
    }

    /// The same runs, and a few particles more, of points one after the other: by the chords of that radius, and by the rows round
    /// the point before where they are the same.
    #[inline(always)]
    pub(crate) fn runs_by_chords(
        &self,
        position: &Vec3,
        chords: &Chords,
        rows: &mut Rows,
        runs: &mut [Run; MAX_RUNS],
    ) -> usize {
        let (j, class_y) = self.class(position, 1);
        let (k, class_z) = self.class(position, 2);
        rows.surround([j, k], |dy, dz| {
            let (row, sy) = self.step(1, j, dy)?;
            let (layer, sz) = self.step(2, k, dz)?;
            let first = self.cell_at([0, row, layer]);
            // most rows round a wall hold no water, and most round water no points of walls
            (self.has_particles(first..first + self.counts[0])).then_some((first, 3 * sy + 9 * sz))
        });
        // farther off, points count to the outermost cells all the same
        const FAR: f64 = 1e15;
        let along = PARTS * (position.x - self.min.x) * self.inverse_cell_size.x;
        let (along, count) = (along.clamp(-FAR, FAR) as i64, self.counts[0] as i64);
        let chords = chords.of([class_y, class_z]);
        let mut n = 0;
        for row in rows.iter() {
            let chord = i64::from(chords[row.place]);
            let cell = |part: i64| part.div_euclid(PARTS as i64);
            let (low, high) = (cell(along - chord), cell(along + chord));
            // without a look whether there are any, which is hard to foresee
            let mut push = |from: i64, to: i64, sx: u8| {
                let start = self.starts[row.first + from as usize];
                let end = self.starts[row.first + to as usize + 1];
                runs[n] = Run {
                    start,
                    end,
                    image: row.image + sx,
                };
                n += usize::from(start < end && 0 < chord);
            };
            let last = count - 1;
            if self.periodic[0] && low < 0 {
                push((low + count).max(0), last, 0);
            }
            push(low.clamp(0, last), high.clamp(0, last), 1);
            if self.periodic[0] && count <= high {
                push(0, (high - count).min(last), 2);
            }
        }
        n
    }

    /// Cell of a position along an axis, and the part of the cell that it is in.
    #[inline(always)]
    fn class(&self, position: &Vec3, axis: usize) -> (usize, usize) {
        let place = (position[axis] - self.min[axis]) * self.inverse_cell_size[axis];
        // as a coordinate of a cell
        let part = (CLASSES as f64 * place) as usize;
        let part = part.min(CLASSES * self.counts[axis] - 1);
        (part / CLASSES, part % CLASSES)
    }

    /// The runs of particles of one layer of cells that may be within `radius` of the vertical through a position, in a fixed
    /// order; returns their number. The radius must not exceed that of the grid.
    pub(crate) fn runs_beside(
        &self,
        position: &Vec3,
        layer: usize,
        radius: f64,
        runs: &mut [Run; MAX_RUNS],
    ) -> usize {
        let [_, j, _] = self.coordinates_of(position);
        let mut n = 0;
        for (dy, square) in (-1..).zip(self.squared_distances(1, position.y, j)) {
            let chord2 = radius * radius - square;
            if let (true, Some((row, sy))) = (0.0 <= chord2, self.step(1, j, dy)) {
                let first = self.cell_at([0, row, layer]);
                let reach = chord2.sqrt();
                self.push_row(first, 3 * sy + 9, position.x, reach, runs, &mut n);
            }
        }
        n
    }

    /// Squared distances along an axis from a coordinate to the cells before, at and after `cell`; m².
    ///
    /// Points outside of the grid belong to the outermost cells, which extend to infinity, so that
    /// only the near side of a neighbor matters.
    #[inline(always)]
    fn squared_distances(&self, axis: usize, x: f64, cell: usize) -> [f64; 3] {
        let size = self.cell_size[axis];
        // a cell boundary computed here and in the sort may differ by round-off
        let slack = 1e-6 * size;
        let before = x - (self.min[axis] + cell as f64 * size) - slack;
        let after = size - slack - slack - before;
        [before, 0.0, after].map(|d| d.max(0.0) * d.max(0.0))
    }

    /// Adds the runs of a row, which starts at cell `first`, within `reach` of `x`.
    #[inline(always)]
    fn push_row(
        &self,
        first: usize,
        image_yz: u8,
        x: f64,
        reach: f64,
        runs: &mut [Run; MAX_RUNS],
        n: &mut usize,
    ) {
        let count = self.counts[0] as i64;
        // slightly more than the radius, for round-off; truncation is the floor from -BEFORE on, and points
        // farther before the grid are clamped to its first cell anyway
        const BEFORE: f64 = 16.0;
        let cell =
            |x: f64| ((x - self.min.x) * self.inverse_cell_size.x + BEFORE) as i64 - BEFORE as i64;
        let (low, high) = (cell(x - 1.000_001 * reach), cell(x + 1.000_001 * reach));
        let mut push = |from: i64, to: i64, sx: u8| {
            let (from, to) = (from.max(0), to.min(count - 1));
            if from <= to {
                let start = self.starts[first + from as usize];
                let end = self.starts[first + to as usize + 1];
                if start < end {
                    runs[*n] = Run {
                        start,
                        end,
                        image: image_yz + sx,
                    };
                    *n += 1;
                }
            }
        };
        if self.periodic[0] && low < 0 {
            push(low + count, count - 1, 0);
        }
        // particles outside of the domain count to its outermost cells
        push(low.min(count - 1), high.max(0), 1);
        if self.periodic[0] && count <= high {
            push(0, high - count, 2);
        }
    }

    /// One step along an axis: the coordinate reached and the image digit (0, 1, 2).
    #[inline(always)]
    fn step(&self, axis: usize, from: usize, by: i32) -> Option<(usize, u8)> {
        let n = self.counts[axis] as i64;
        let to = from as i64 + i64::from(by);
        if (0..n).contains(&to) {
            Some((to as usize, 1))
        } else if !self.periodic[axis] {
            None
        } else if to < 0 {
            Some(((to + n) as usize, 0))
        } else {
            Some(((to - n) as usize, 2))
        }
    }
}
