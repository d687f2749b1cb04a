//! Chords that a sphere leaves in the nine rows of cells round its center, in a table.
//!
//! A square root for each row and receiver takes as long as the filter of the candidates that it saves. The chord depends on where
//! in its cell, across the rows, the center is: for one of `CLASSES²` parts of the cell it is the longest of all centers in it.

use crate::Vec3;

/// Parts of a cell along y, and along z.
pub(crate) const CLASSES: usize = 16;

/// Parts of a cell along a row, in which chords are measured.
pub(crate) const PARTS: f64 = 16.0;

/// Rows round a row, itself among them.
const ROWS: usize = 9;

/// Lanes of a class: its rows, and what fills up registers.
const LANES: usize = 16;

/// Half chords of a radius in the rows round a center, by its part of the cell.
pub(crate) struct Chords {
    halves: [[u8; LANES]; CLASSES * CLASSES],
}

impl Chords {
    /// Those of a radius in cells of a size, which are no smaller than it across rows; m.
    pub(crate) fn new(size: &Vec3, radius: f64) -> Self {
        let squares = [size.y, size.z].map(|size| -> [[f64; 3]; CLASSES] {
            std::array::from_fn(|class| squared_distances(size, class))
        });
        let halves = std::array::from_fn(|part| {
            let (y, z) = (squares[0][part / CLASSES], squares[1][part % CLASSES]);
            let mut halves = [0; LANES];
            for (row, half) in halves[..ROWS].iter_mut().enumerate() {
                let square = radius * radius - y[row / 3] - z[row % 3];
                if 0.0 <= square {
                    // slightly more for round-off, and one part as places along the row are cut to whole ones
                    let parts = 1.000_001 * PARTS * square.sqrt() / size.x;
                    *half = (parts.ceil() as u8).saturating_add(1);
                }
            }
            halves
        });
        Self { halves }
    }

    /// Half chords in the nine rows, for a center in a part of its cell along y and z; parts of a cell, 0 for none.
    #[inline(always)]
    pub(crate) fn of(&self, [class_y, class_z]: [usize; 2]) -> &[u8; LANES] {
        &self.halves[class_y * CLASSES + class_z]
    }
}

/// Least squared distances from a part of a cell to the cells before, at and after it; m².
fn squared_distances(size: f64, class: usize) -> [f64; 3] {
    // a boundary of a cell computed here and in the sort may differ by round-off
    let distance = |parts: usize| (parts as f64 / CLASSES as f64 - 1e-6).max(0.0) * size;
    [distance(class), 0.0, distance(CLASSES - 1 - class)].map(|d| d * d)
}

/// A row round a row.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Row {
    /// First cell.
    pub first: usize,
    /// Its image along y and z.
    pub image: u8,
    /// Its place among the nine.
    pub place: usize,
}

/// The rows that there are round a row, kept from point to point.
#[derive(Debug, Default)]
pub(crate) struct Rows {
    around: Option<[usize; 2]>,
    rows: [Row; ROWS],
    n: usize,
}

impl Rows {
    /// Takes the rows round a row at coordinates along y and z, by a step along each, unless these are they.
    #[inline(always)]
    pub(crate) fn surround(
        &mut self,
        around: [usize; 2],
        step: impl Fn(i32, i32) -> Option<(usize, u8)>,
    ) {
        if self.around == Some(around) {
            return;
        }
        self.around = Some(around);
        self.n = 0;
        for place in 0..ROWS {
            if let Some((first, image)) = step(place as i32 / 3 - 1, place as i32 % 3 - 1) {
                self.rows[self.n] = Row {
                    first,
                    image,
                    place,
                };
                self.n += 1;
            }
        }
    }

    /// In a fixed order.
    #[inline(always)]
    pub(crate) fn iter(&self) -> impl Iterator<Item = &Row> {
        self.rows[..self.n].iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::FluidError;
    use crate::neighbors::cells::{CellGrid, MAX_RUNS, Run};

    /// Points all over a domain, on the boundaries of cells, and beside it.
    fn places(extent: f64) -> impl Iterator<Item = Vec3> {
        let mut state = 0x2545_f491_4f6c_dd1d_u64;
        (0..4000).map(move |a| {
            Vec3::from_fn(|_, _| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                let share = (state >> 11) as f64 / (1_u64 << 53) as f64;
                match a % 4 {
                    0 => (share * 20.0).round() / 20.0 * extent,
                    _ => (1.2 * share - 0.1) * extent,
                }
            })
        })
    }

    /// All of the runs by chords hold those of single chords, in the same order, and hardly more.
    #[test]
    fn runs_by_chords_hold_those_of_each_point() -> Result<(), FluidError> {
        let (support, skin, extent) = (0.2, 0.03, 1.5);
        for periodic in [[false; 3], [true, true, false], [true; 3]] {
            let domain = (Vec3::zeros(), Vec3::repeat(extent));
            let mut grid = CellGrid::new(domain, periodic, (support, skin), 1 << 20)?;
            let positions: Vec<Vec3> = places(extent).collect();
            let (mut cells, mut order) = (Vec::new(), Vec::new());
            grid.sort(&positions, &mut cells, &mut order);
            let radius = support + skin;
            let chords = Chords::new(&grid.cell_size(), radius);
            let mut rows = Rows::default();
            let (mut exact, mut by_chords) =
                ([Run::default(); MAX_RUNS], [Run::default(); MAX_RUNS]);
            let (mut n_exact, mut n_by_chords) = (0, 0);
            for x in positions.iter().map(|x| grid.wrapped(*x)) {
                let n = grid.runs_within(&x, radius, &mut exact);
                let m = grid.runs_by_chords(&x, &chords, &mut rows, &mut by_chords);
                let mut rest = by_chords[..m].iter();
                for run in &exact[..n] {
                    let holds = |held: &&Run| {
                        held.image == run.image && held.start <= run.start && run.end <= held.end
                    };
                    assert!(rest.any(|held| holds(&held)), "{x:?} {run:?}");
                }
                let len = |runs: &[Run]| runs.iter().map(|run| run.end - run.start).sum::<u32>();
                n_exact += len(&exact[..n]);
                n_by_chords += len(&by_chords[..m]);
            }
            // chords end in cells of a quarter of the support, so that parts of a sixteenth of a cell add little
            assert!(
                n_by_chords < n_exact + n_exact / 10,
                "{n_by_chords} {n_exact}"
            );
        }
        Ok(())
    }
}
