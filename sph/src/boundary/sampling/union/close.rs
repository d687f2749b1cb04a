//! The sample closest to a point.

use super::Region;
use crate::Vec3;

/// Size of a cell, of the reach: few enough cells for a large tank, few points to a cell.
const CELL: f64 = 4.0;
/// Cells at most; beyond, cells grow.
const MOST_CELLS: f64 = (1 << 24) as f64;
/// End of a list.
const NONE: u32 = u32::MAX;

/// Points to be found within a reach.
///
/// Each cell of a grid has a linked list of its points.
pub(super) struct ClosePoints {
    reach: f64,
    min: Vec3,
    inverse_size: f64,
    n: [usize; 3],
    /// Last point of each cell.
    head: Vec<u32>,
    /// The point before each point in its cell.
    before: Vec<u32>,
    points: Vec<Vec3>,
}

impl ClosePoints {
    /// No points yet; they will be within a region, and are looked for within `reach` meters.
    pub(super) fn new(region: &Region, reach: f64) -> Self {
        let extent = (region.max - region.min).map(|length| length.max(reach));
        let smallest = (extent.product() / MOST_CELLS).cbrt();
        let size = (CELL * reach).max(smallest);
        let n = std::array::from_fn(|axis| (extent[axis] / size).ceil() as usize);
        Self {
            reach,
            min: region.min,
            inverse_size: size.recip(),
            n,
            head: vec![NONE; n.iter().product()],
            before: Vec::new(),
            points: Vec::new(),
        }
    }

    /// The nearest point within reach and its distance.
    pub(super) fn nearest(&self, x: &Vec3) -> Option<(usize, f64)> {
        // a point that was moved is still listed where it was
        let low = self.place(&x.add_scalar(-2.0 * self.reach));
        let high = self.place(&x.add_scalar(2.0 * self.reach));
        let mut nearest = None;
        let mut least = self.reach * self.reach;
        for k in low[2]..=high[2] {
            for j in low[1]..=high[1] {
                for i in low[0]..=high[0] {
                    let mut point = self.head[self.cell([i, j, k])];
                    while point != NONE {
                        let distance2 = (self.points[point as usize] - x).norm_squared();
                        if distance2 < least {
                            least = distance2;
                            nearest = Some(point as usize);
                        }
                        point = self.before[point as usize];
                    }
                }
            }
        }
        nearest.map(|point| (point, least.sqrt()))
    }

    /// Adds a point.
    pub(super) fn push(&mut self, x: &Vec3) {
        let cell = self.cell(self.place(x));
        self.before.push(self.head[cell]);
        self.head[cell] = self.points.len() as u32;
        self.points.push(*x);
    }

    /// Moves a point, by no more than the reach from where it was added.
    pub(super) fn move_to(&mut self, point: usize, x: &Vec3) {
        self.points[point] = *x;
    }

    fn place(&self, x: &Vec3) -> [usize; 3] {
        // the cast saturates at zero
        std::array::from_fn(|axis| {
            let cell = (x[axis] - self.min[axis]) * self.inverse_size;
            (cell as usize).min(self.n[axis] - 1)
        })
    }

    fn cell(&self, place: [usize; 3]) -> usize {
        (place[2] * self.n[1] + place[1]) * self.n[0] + place[0]
    }
}
