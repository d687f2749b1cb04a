//! Points sorted by cell, as pair loops read them.
//!
//! Coordinates of the loops are integers of a small quantum: differences are exact in 32 bits
//! wherever in the domain two points are, and an `f32` holds a difference within the support to one
//! part in 10⁷. Periodic directions have a quantum that divides their period, so that an image is an
//! integer shift.

use rayon::prelude::*;

use crate::neighbors::cells::CellGrid;
use crate::neighbors::rest::Still;
use crate::simd::lanes::{FILTER_WIDTH, Place, RECORD, Record};
use crate::{CHUNK, Vec3};

/// Quanta per support radius, at least, in domains that are not too long for them; `f32` keeps differences up to twice as
/// many exactly.
const QUANTA_PER_RADIUS: f64 = (1 << 22) as f64;
/// Quanta of a periodic direction, at most: a place in it is its quanta, not only the difference of two.
const QUANTA_PER_PERIOD: f64 = (1_u64 << 31) as f64;
/// The same where nothing is periodic, less a margin for points outside; 508 support radii are as fine as shorter domains.
const QUANTA_PER_EXTENT: f64 = QUANTA_PER_PERIOD - 4.0 * QUANTA_PER_RADIUS;

/// Turns positions into quanta.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    origin: [f64; 3],
    /// m.
    quantum: [f64; 3],
    inverse: [f64; 3],
}

impl Frame {
    /// The frame of a grid whose pairs are closer than `support_radius`.
    pub(crate) fn new(grid: &CellGrid, support_radius: f64) -> Self {
        let extent = grid.extent();
        let quantum: [f64; 3] = std::array::from_fn(|axis| {
            if grid.periodic()[axis] {
                // a power of two of quanta in a period, at least as fine as elsewhere
                let whole = extent[axis] / support_radius * QUANTA_PER_RADIUS;
                extent[axis] / whole.log2().ceil().exp2().min(QUANTA_PER_PERIOD)
            } else {
                (support_radius / QUANTA_PER_RADIUS).max(extent[axis] / QUANTA_PER_EXTENT)
            }
        });
        Self {
            origin: grid.min().into(),
            quantum,
            inverse: quantum.map(f64::recip),
        }
    }

    /// Meters per quantum along each axis.
    pub(crate) fn quantum(&self) -> [f64; 3] {
        self.quantum
    }

    /// A position with these quanta; m.
    #[inline(always)]
    pub(crate) fn position(&self, quanta: [i32; 3]) -> Vec3 {
        Vec3::from_fn(|axis, _| {
            // the middle of what is rounded to them, towards zero
            let middle = f64::from(quanta[axis]) + 0.5 * f64::from(quanta[axis].signum());
            self.origin[axis] + middle * self.quantum[axis]
        })
    }

    /// A position in both forms.
    #[inline(always)]
    pub(crate) fn place(&self, x: &Vec3) -> Place {
        Place {
            meters: [x.x, x.y, x.z],
            quanta: std::array::from_fn(|axis| {
                // the cast to 64 bits saturates, that to 32 wraps, as differences do
                ((x[axis] - self.origin[axis]) * self.inverse[axis]) as i64 as i32
            }),
        }
    }
}

/// Places of points sorted by cell, from which lists are made.
#[derive(Clone, Debug, Default)]
pub(crate) struct Places {
    /// Quanta along each axis, padded so that a whole register may be read at the end.
    columns: [Vec<i32>; 3],
}

impl Places {
    /// Writes the places of all points.
    pub(crate) fn pack(&mut self, frame: &Frame, positions: &[Vec3]) {
        let n = positions.len();
        for column in &mut self.columns {
            column.resize(n + FILTER_WIDTH, 0);
        }
        let [x, y, z] = &mut self.columns;
        x[..n]
            .par_chunks_mut(CHUNK)
            .zip(y[..n].par_chunks_mut(CHUNK))
            .zip(z[..n].par_chunks_mut(CHUNK))
            .zip(positions.par_chunks(CHUNK))
            .for_each(|(((x, y), z), positions)| {
                for (k, position) in positions.iter().enumerate() {
                    [x[k], y[k], z[k]] = frame.place(position).quanta;
                }
            });
    }

    /// Number of points.
    pub(crate) fn len(&self) -> usize {
        self.columns[0].len().saturating_sub(FILTER_WIDTH)
    }

    /// Quanta of a point.
    #[inline(always)]
    pub(crate) fn of(&self, point: usize) -> [i32; 3] {
        let [x, y, z] = &self.columns;
        [x[point], y[point], z[point]]
    }

    /// Columns of quanta.
    pub(crate) fn columns(&self) -> [&[i32]; 3] {
        let [x, y, z] = &self.columns;
        [x, y, z]
    }

    /// Memory held; bytes.
    pub(crate) fn memory(&self) -> usize {
        self.columns
            .iter()
            .map(|x| size_of::<i32>() * x.capacity())
            .sum()
    }

    /// Quanta of all points.
    pub(crate) fn iter(&self) -> impl ExactSizeIterator<Item = [i32; 3]> + Clone + '_ {
        (0..self.len()).map(|point| self.of(point))
    }

    /// Places from quanta.
    pub(crate) fn from_quanta(quanta: &[[i32; 3]]) -> Self {
        let padding = [0; FILTER_WIDTH];
        Self {
            columns: std::array::from_fn(|axis| {
                quanta.iter().map(|q| q[axis]).chain(padding).collect()
            }),
        }
    }
}

/// Points sorted by cell, as sums read them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Points<R> {
    /// One per point, and one that adds nothing to any sum.
    records: Vec<R>,
}

impl<R: Record + Default> Points<R> {
    /// Writes places and values of all points but those of still chunks, which keep theirs; `values` gives five numbers
    /// for each.
    pub(crate) fn pack(
        &mut self,
        frame: &Frame,
        positions: &[Vec3],
        still: Still,
        values: impl Fn(usize) -> [f64; 5] + Sync,
    ) {
        let n = positions.len();
        self.records.resize(n + 1, R::default());
        self.records[n] = R::default();
        self.records[..n]
            .par_chunks_mut(CHUNK)
            .zip(positions.par_chunks(CHUNK))
            .enumerate()
            .filter(|(chunk, _)| !still.has(*chunk))
            .for_each(|(chunk, (records, positions))| {
                for (k, position) in positions.iter().enumerate() {
                    let place = frame.place(position);
                    records[k] = R::pack(&place, values(chunk * CHUNK + k));
                }
            });
    }

    /// Writes values of all points in the place of coordinates and values.
    pub(crate) fn pack_values(&mut self, n: usize, values: impl Fn(usize) -> [f64; RECORD] + Sync) {
        self.records.resize(n + 1, R::default());
        self.records[n] = R::default();
        self.records[..n]
            .par_chunks_mut(CHUNK)
            .enumerate()
            .for_each(|(chunk, records)| {
                for (k, record) in records.iter_mut().enumerate() {
                    *record = R::of_values(values(chunk * CHUNK + k));
                }
            });
    }

    /// Records; the last belongs to no point.
    pub(crate) fn records(&self) -> &[R] {
        &self.records
    }

    /// Index of the record that adds nothing.
    pub(crate) fn nothing(&self) -> u32 {
        self.records.len() as u32 - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FluidError;

    #[test]
    fn quanta_are_places_in_domains_of_any_length() -> Result<(), FluidError> {
        let support = 0.04;
        for radii in [500.0, 600.0, 1100.0, 5000.0] {
            for periodic in [false, true] {
                let max = Vec3::new(radii * support, 0.2, 0.2);
                let domain = (Vec3::zeros(), max);
                let grid =
                    CellGrid::new(domain, [periodic, false, false], (support, 0.0), 1 << 20)?;
                let frame = Frame::new(&grid, support);
                for share in [0.0, 0.3, 0.505, 0.6, 0.99, 1.0 - 1e-9] {
                    let x = share * max;
                    let off = frame.position(frame.place(&x).quanta) - x;
                    // a place is rounded to its quantum, which is below a hundred-thousandth of the support
                    let quantum = frame.quantum()[0];
                    assert!(quantum < 1e-5 * support, "{radii}: {quantum}");
                    assert!(
                        off.x.abs() <= quantum,
                        "{radii} radii, periodic {periodic}: {} m is taken for {} m",
                        x.x,
                        x.x + off.x
                    );
                }
            }
        }
        Ok(())
    }
}
