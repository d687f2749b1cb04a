//! Which solids are near each cell of the fluid's grid, so that water far from all of them pays nothing.

use riprap_sph::{CellGrid, Vec3};

/// A solid with the box round it: number, lower and upper corner, m.
pub(crate) type Boxed = (u32, (Vec3, Vec3));

/// Solids near each cell: packed lists.
#[derive(Clone, Debug, Default)]
pub(crate) struct PartTable {
    starts: Vec<u32>,
    parts: Vec<u32>,
    pairs: Vec<(u32, u32)>,
}

impl PartTable {
    /// Solids near a cell, in order.
    pub(crate) fn near(&self, cell: usize) -> &[u32] {
        match self.starts.get(cell..cell + 2) {
            Some(range) => &self.parts[range[0] as usize..range[1] as usize],
            None => &[],
        }
    }

    /// Lists anew the solids within `reach` (m) of anything in a cell. `is_within` tells whether a solid
    /// may be within a distance (m) of a point.
    pub(crate) fn rebuild(
        &mut self,
        solids: impl Iterator<Item = Boxed>,
        grid: &CellGrid,
        reach: f64,
        is_within: impl Fn(u32, &Vec3, f64) -> bool,
    ) {
        self.pairs.clear();
        let half_diagonal = 0.5 * grid.cell_size().norm();
        for (solid, (min, max)) in solids {
            let first = grid.coordinates_of(&min.add_scalar(-reach));
            let last = grid.coordinates_of(&max.add_scalar(reach));
            for k in first[2]..=last[2] {
                for j in first[1]..=last[1] {
                    for i in first[0]..=last[0] {
                        // a box far along an axis clamps to the outermost cells; the distance test
                        // drops those, and the empty corners of a slanted body's box
                        let center = grid.cell_center([i, j, k]);
                        if is_within(solid, &center, reach + half_diagonal) {
                            self.pairs.push((grid.cell_at([i, j, k]) as u32, solid));
                        }
                    }
                }
            }
        }
        if self.pairs.is_empty() {
            self.starts.clear();
            self.parts.clear();
            return;
        }
        self.pairs.sort_unstable();
        self.starts.clear();
        self.starts.resize(grid.n_cells() + 1, 0);
        for &(cell, _) in &self.pairs {
            self.starts[cell as usize + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        self.parts.clear();
        self.parts
            .extend(self.pairs.iter().map(|&(_, solid)| solid));
    }
}
