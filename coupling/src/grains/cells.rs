//! Cells of the water along an axis near a coordinate, with those across a period.

use riprap_sph::CellGrid;

/// Ranges of cells along an axis: one, or two where it is periodic.
const MOST_PIECES: usize = 2;

/// Cells along an axis, in order, with the shift (m) of their particles to the image that is near.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pieces {
    pieces: [Piece; MOST_PIECES],
    n: usize,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Piece {
    first: usize,
    last: usize,
    /// m.
    pub(super) shift: f64,
}

impl Pieces {
    pub(super) fn ranges(&self) -> &[Piece] {
        &self.pieces[..self.n]
    }

    pub(super) fn cells(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        (self.ranges().iter())
            .flat_map(|piece| (piece.first..=piece.last).map(|cell| (cell, piece.shift)))
    }
}

impl Piece {
    /// Those along x within a distance (m) of a coordinate (m).
    pub(super) fn within(&self, grid: &CellGrid, x: f64, distance: f64) -> Option<(usize, usize)> {
        let (min, size) = (grid.min().x + self.shift, grid.cell_size().x);
        // positions out of the domain are in the outermost cells
        let cell = |x: f64| ((x - min) / size).floor().max(0.0) as usize;
        let from = self.first.max(cell(x - distance).min(self.last));
        let to = self.last.min(cell(x + distance).max(self.first));
        (from <= to).then_some((from, to))
    }
}

/// Cells within `reach` (m) of a coordinate (m) along an axis.
pub(super) fn pieces(grid: &CellGrid, axis: usize, x: f64, reach: f64) -> Pieces {
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
