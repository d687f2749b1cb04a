//! Elevations at the points of a square grid.

use super::outline::Outline;
use crate::scene::geometry::crs::Crs;

/// Elevations over a rectangle in plan view. Points are the centers of the cells of a raster.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Number of points along x and y, at least two each.
    pub n: [usize; 2],
    /// Point of smallest x and y; m.
    pub corner: [f64; 2],
    /// Spacing of the points; m.
    pub spacing: f64,
    /// Elevations row by row from the south, each from the west; NaN where missing; m.
    pub heights: Vec<f64>,
}

/// A grid in map coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct MapGrid {
    /// Elevations.
    pub grid: Grid,
    /// Reference system of the map, if known.
    pub crs: Option<Crs>,
}

impl Grid {
    /// Translation in plan view; m.
    pub fn shift(&mut self, by: [f64; 2]) {
        for (corner, by) in self.corner.iter_mut().zip(by) {
            *corner += by;
        }
    }

    /// Index of a point in the list of elevations.
    pub fn index(&self, [i, j]: [usize; 2]) -> usize {
        j * self.n[0] + i
    }

    /// Position of a point in plan view; m.
    pub fn place(&self, point: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|axis| self.corner[axis] + point[axis] as f64 * self.spacing)
    }

    /// Point of largest x and y; m.
    pub fn far_corner(&self) -> [f64; 2] {
        self.place([self.n[0] - 1, self.n[1] - 1])
    }

    /// Center of the extent; m.
    pub fn middle(&self) -> [f64; 2] {
        let far = self.far_corner();
        [0, 1].map(|axis| 0.5 * (self.corner[axis] + far[axis]))
    }

    /// Slopes along x and y of the plane of least squares through heights (m) at the points within an outline; `None` where these
    /// lie on a line, or are none.
    pub fn mean_slope(
        &self,
        outline: &Outline,
        height: impl Fn([usize; 2]) -> Option<f64>,
    ) -> Option<[f64; 2]> {
        let points: Vec<[f64; 3]> = self
            .points()
            .filter(|point| outline.holds(self.place(*point)))
            .filter_map(|point| {
                let [x, y] = self.place(point);
                Some([x, y, height(point)?])
            })
            .collect();
        let n = points.len() as f64;
        let mean = [0, 1, 2].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / n);
        let sum = |a: usize, b: usize| -> f64 {
            points
                .iter()
                .map(|p| (p[a] - mean[a]) * (p[b] - mean[b]))
                .sum()
        };
        let (xx, xy, yy, xz, yz) = (sum(0, 0), sum(0, 1), sum(1, 1), sum(0, 2), sum(1, 2));
        let determinant = xx * yy - xy * xy;
        (determinant > 0.0).then(|| {
            [
                (xz * yy - yz * xy) / determinant,
                (yz * xx - xz * xy) / determinant,
            ]
        })
    }

    /// All points, row by row from the south.
    pub fn points(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [columns, rows] = self.n;
        (0..rows).flat_map(move |j| (0..columns).map(move |i| [i, j]))
    }

    /// Elevation at a position in plan view, bilinear between the four points around it; `None` outside of the grid and
    /// where a contributing point is missing; m.
    ///
    /// ```text
    /// z = (1 − s) (1 − t) z₀₀ + s (1 − t) z₁₀ + (1 − s) t z₀₁ + s t z₁₁                        [m]
    /// ```
    pub fn height(&self, [x, y]: [f64; 2]) -> Option<f64> {
        let at = [x, y];
        let mut square = [0; 2];
        let mut share = [0.0; 2];
        for axis in 0..2 {
            let along = (at[axis] - self.corner[axis]) / self.spacing;
            let last = (self.n[axis] - 1) as f64;
            // a place on the rim that round-off took out is on the rim
            if !(-ON_RIM <= along && along <= last + ON_RIM) {
                return None;
            }
            let along = along.clamp(0.0, last);
            square[axis] = (along as usize).min(self.n[axis] - 2);
            share[axis] = along - square[axis] as f64;
        }
        let [s, t] = share;
        let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t];
        let mut height = 0.0;
        for (k, weight) in weights.into_iter().enumerate() {
            if weight > 0.0 {
                height += weight * self.heights[self.index([square[0] + k % 2, square[1] + k / 2])];
            }
        }
        height.is_finite().then_some(height)
    }

    /// Lowest and highest elevation; m.
    pub fn range(&self) -> (f64, f64) {
        let known = self.heights.iter().filter(|z| z.is_finite());
        known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| {
            (low.min(*z), high.max(*z))
        })
    }
}

/// Tolerance of a position beyond the rim; × spacing.
const ON_RIM: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        Grid {
            n: [3, 2],
            corner: [100.0, 200.0],
            spacing: 10.0,
            heights: vec![1.0, 2.0, 3.0, 5.0, f64::NAN, 7.0],
        }
    }

    #[test]
    fn between_points_it_is_bilinear() {
        let mut grid = grid();
        grid.heights[4] = 6.0;
        // z = 1 + (x − 100)/10 + 4 (y − 200)/10
        for [x, y] in [
            [100.0, 200.0],
            [113.0, 207.0],
            [120.0, 210.0],
            [120.0, 203.0],
        ] {
            let expected = 1.0 + (x - 100.0) / 10.0 + 4.0 * (y - 200.0) / 10.0;
            let found = grid.height([x, y]);
            assert!(
                found.is_some_and(|z| (z - expected).abs() < 1e-13),
                "{x} {y}"
            );
        }
    }

    #[test]
    fn beyond_the_rim_and_beside_a_gap_there_is_none() {
        let grid = grid();
        for place in [
            [99.0, 205.0],
            [121.0, 205.0],
            [105.0, 211.0],
            [105.0, 205.0],
        ] {
            assert_eq!(grid.height(place), None, "{place:?}");
        }
        // the gap has no share on the southern row, nor in the column of the point itself
        assert_eq!(grid.height([105.0, 200.0]), Some(1.5));
        assert_eq!(grid.height([100.0, 205.0]), Some(3.0));
        assert_eq!(grid.range(), (1.0, 7.0));
    }
}
