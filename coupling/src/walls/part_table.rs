//! Solids near each cell of the fluid's grid, so that water far from all of them has no cost.
//!
//! A solid's cells are listed with a skin and stay so while nothing of it can have come farther than that:
//!
//! ```text
//! |c − c₀| + ‖F F₀⁻¹ − 1‖ R ≤ skin        c center, F gradient of its placement, R radius round c₀; ₀ when listed
//! ```

use nalgebra::Matrix3;
use riprap_sph::{CellGrid, Vec3};

/// Skin in sizes of a cell.
const SKIN: f64 = 0.25;

/// A solid where it is at present.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// Its number.
    pub(crate) number: u32,
    /// A point that its block carries; m.
    pub(crate) center: Vec3,
    /// Gradient of its block's placement.
    pub(crate) gradient: Matrix3<f64>,
}

/// A solid whose cells are listed.
pub(crate) trait Solids {
    /// The box round one; m.
    fn aabb(&self, solid: u32) -> (Vec3, Vec3);
    /// Whether one may be within a distance (m) of a point.
    fn is_within(&self, solid: u32, x: &Vec3, distance: f64) -> bool;
}

/// Solids near each cell: packed lists.
#[derive(Clone, Debug, Default)]
pub(crate) struct PartTable {
    starts: Vec<u32>,
    parts: Vec<u32>,
    /// By number of the solid.
    listed: Vec<Listed>,
}

/// The cells of a solid.
#[derive(Clone, Debug, Default)]
struct Listed {
    /// Its placement then.
    at: Option<Placed>,
    /// From there to its farthest corner; m.
    radius: f64,
    cells: Vec<u32>,
    is_present: bool,
}

impl Listed {
    /// Whether nothing of the solid can have left the skin (m).
    fn holds(&self, now: &Placed, skin: f64) -> bool {
        let Some(at) = &self.at else { return false };
        let Some(back) = at.gradient.try_inverse() else {
            return false;
        };
        let strained = (now.gradient * back - Matrix3::identity()).norm() * self.radius;
        (now.center - at.center).norm() + strained <= skin
    }

    /// Lists the cells of a solid where it is.
    fn find(&mut self, now: &Placed, solids: &impl Solids, grid: &CellGrid, reach: f64) {
        let (min, max) = solids.aabb(now.number);
        let half_diagonal = 0.5 * grid.cell_size().norm();
        self.at = Some(*now);
        self.radius = (max - now.center)
            .abs()
            .sup(&(now.center - min).abs())
            .norm();
        self.cells.clear();
        let first = grid.coordinates_of(&min.add_scalar(-reach));
        let last = grid.coordinates_of(&max.add_scalar(reach));
        for k in first[2]..=last[2] {
            for j in first[1]..=last[1] {
                for i in first[0]..=last[0] {
                    // a box far along an axis clamps to the outermost cells; the distance test
                    // drops those, and the empty corners of a slanted body's box
                    let center = grid.cell_center([i, j, k]);
                    if solids.is_within(now.number, &center, reach + half_diagonal) {
                        self.cells.push(grid.cell_at([i, j, k]) as u32);
                    }
                }
            }
        }
    }
}

impl PartTable {
    /// Solids near a cell, in order.
    pub(crate) fn near(&self, cell: usize) -> &[u32] {
        match self.starts.get(cell..cell + 2) {
            Some(range) => &self.parts[range[0] as usize..range[1] as usize],
            None => &[],
        }
    }

    /// Brings up to date which of the solids that there are may be within `reach` (m) of anything in a cell.
    pub(crate) fn update(
        &mut self,
        present: impl Iterator<Item = Placed>,
        solids: &impl Solids,
        grid: &CellGrid,
        reach: f64,
    ) {
        let skin = SKIN * grid.cell_size().min();
        let mut has_changed = false;
        for now in present {
            let number = now.number as usize;
            if self.listed.len() <= number {
                self.listed.resize_with(number + 1, Listed::default);
            }
            let listed = &mut self.listed[number];
            listed.is_present = true;
            if !listed.holds(&now, skin) {
                listed.find(&now, solids, grid, reach + skin);
                has_changed = true;
            }
        }
        for listed in &mut self.listed {
            if !std::mem::take(&mut listed.is_present) && listed.at.take().is_some() {
                listed.cells.clear();
                has_changed = true;
            }
        }
        if has_changed {
            self.pack(grid.n_cells());
        }
    }

    /// Inverts cells of solids to solids of cells.
    fn pack(&mut self, n_cells: usize) {
        self.starts.clear();
        self.starts.resize(n_cells + 1, 0);
        let cells = || self.listed.iter().flat_map(|listed| &listed.cells);
        for &cell in cells() {
            self.starts[cell as usize + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        self.parts.clear();
        self.parts.resize(cells().count(), 0);
        // each start is moved on to the end of its cell, which is the start of the next
        for (number, listed) in self.listed.iter().enumerate() {
            for &cell in &listed.cells {
                let place = &mut self.starts[cell as usize];
                self.parts[*place as usize] = number as u32;
                *place += 1;
            }
        }
        self.starts.rotate_right(1);
        if let Some(first) = self.starts.first_mut() {
            *first = 0;
        }
    }
}
