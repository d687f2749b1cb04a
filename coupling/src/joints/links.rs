//! Neighbors of a point in other faces: water continues around an edge, or along another block.

use riprap_sph::Vec3;

/// Largest distance, in spacings: points half a spacing from a right-angled edge are neighbors around it.
const REACH: f64 = 0.8;
/// Smallest distance in the weights, in spacings.
const NEAREST: f64 = 0.5;

/// Neighbors of points in other faces: packed lists.
#[derive(Clone, Debug, Default)]
pub(super) struct Links {
    /// Start of each list; one more than there are points.
    starts: Vec<u32>,
    /// Point, and the square of the spacing over its distance.
    found: Vec<(u32, f64)>,
    /// Cell and number of every point, in order.
    sorted: Vec<([i32; 3], u32)>,
}

impl Links {
    /// Neighbors of the `n`th point of the last search.
    pub(super) fn of(&self, n: usize) -> &[(u32, f64)] {
        match self.starts.get(n..n + 2) {
            Some(range) => &self.found[range[0] as usize..range[1] as usize],
            None => &[],
        }
    }

    /// Finds the neighbors of some points among all present ones, of admissible pairs.
    pub(super) fn find(
        &mut self,
        of: &[u32],
        all: &[u32],
        places: &[Vec3],
        spacing: f64,
        is_admissible: impl Fn(u32, u32) -> bool,
    ) {
        let reach = REACH * spacing;
        // by z, y, x: a row of cells along x is one piece
        let cell = |x: &Vec3| [2, 1, 0].map(|axis| (x[axis] / reach).floor() as i32);
        self.sorted.clear();
        if !of.is_empty() {
            let placed = all.iter().map(|&k| (cell(&places[k as usize]), k));
            self.sorted.extend(placed);
        }
        self.sorted.sort_unstable();
        self.found.clear();
        self.starts.clear();
        self.starts.push(0);
        for &k in of {
            let x = places[k as usize];
            let [z, y, column] = cell(&x);
            for (row, line) in (z - 1..=z + 1).flat_map(|z| (y - 1..=y + 1).map(move |y| (z, y))) {
                let from =
                    (self.sorted).partition_point(|(cell, _)| *cell < [row, line, column - 1]);
                let near = self.sorted[from..]
                    .iter()
                    .take_while(|(cell, _)| *cell <= [row, line, column + 1]);
                for &(_, other) in near {
                    let d2 = (places[other as usize] - x).norm_squared();
                    if d2 < reach * reach && is_admissible(k, other) {
                        let d2 = d2.max((NEAREST * spacing).powi(2));
                        self.found.push((other, spacing * spacing / d2));
                    }
                }
            }
            self.starts.push(self.found.len() as u32);
        }
    }
}
