//! Quantities in plan view as raster images.

use crate::picture::color;
use crate::picture::overview::bar::{Bar, round_range, round_top};
use crate::picture::overview::raster::{CLEAR, Window};
use crate::scene::terrain::grid::Grid;

/// Opacity of the colors; –.
const OPACITY: f64 = 0.8;
/// Number of colors on each side of water at rest, and of a one-sided scale.
const N_SIDE: usize = 40;
pub(super) const N_SHADES: usize = 64;

/// Colors of a quantity.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    shades: Vec<[u8; 3]>,
    range: (f64, f64),
    /// Whether there are values below and above it.
    is_exceeded: (bool, bool),
}

impl Scale {
    /// For heights of the surface over that at rest; m.
    pub fn of_elevations(elevations: &[f64]) -> Self {
        let sizes = elevations.iter().map(|value| value.abs()).collect();
        let top = round_top(sizes);
        Self::of(color::elevation(N_SIDE), (-top, top), elevations)
    }

    /// For the highest water; m.
    pub fn of_highest(heights: &[f64]) -> Self {
        let range = round_range(heights.to_vec());
        Self::of(color::highest(N_SHADES), range, heights)
    }

    /// For times of arrival; s.
    pub fn of_arrivals(times: &[f64]) -> Self {
        let range = round_range(times.to_vec());
        Self::of(color::arrival(N_SHADES), range, times)
    }

    /// For depths of water on land; m.
    pub fn of_depths(depths: &[f64]) -> Self {
        let range = (0.0, round_top(depths.to_vec()));
        Self::of(color::highest(N_SHADES), range, depths)
    }

    /// The scale in other colors, from low to high.
    pub fn with(self, shades: Vec<[u8; 3]>) -> Self {
        Self { shades, ..self }
    }

    /// Ends of its range, and whether there are values below and above it.
    pub fn ends(&self) -> ((f64, f64), (bool, bool)) {
        (self.range, self.is_exceeded)
    }

    fn of(shades: Vec<[u8; 3]>, range: (f64, f64), values: &[f64]) -> Self {
        // bounds of the range are rounded to tenths of its steps
        let tolerance = 1e-6 * (range.1 - range.0);
        Self {
            shades,
            range,
            is_exceeded: (
                values.iter().any(|&value| value < range.0 - tolerance),
                values.iter().any(|&value| range.1 + tolerance < value),
            ),
        }
    }

    /// Place in the palette.
    fn color_of(&self, value: f64) -> u8 {
        let (low, high) = self.range;
        let last = (self.shades.len() - 1) as f64;
        1 + ((value - low) / (high - low) * last)
            .round()
            .clamp(0.0, last) as u8
    }

    /// Colors and opacities of the palette.
    pub fn palette(&self) -> (Vec<[u8; 3]>, Vec<u8>) {
        let mut colors = vec![[0xff; 3]];
        colors.extend(&self.shades);
        let mut opacity = vec![(255.0 * OPACITY).round() as u8; colors.len()];
        opacity[usize::from(CLEAR)] = 0;
        (colors, opacity)
    }

    /// The colors composited over level ground, the most frequent background.
    pub fn shown(&self) -> Vec<[u8; 3]> {
        let shown = |&shade| color::over(shade, OPACITY, color::BED);
        self.shades.iter().map(shown).collect()
    }

    /// Color bar of the quantity.
    pub fn bar<'a>(&self, label: &'a str, shown: &'a [[u8; 3]]) -> Bar<'a> {
        Bar {
            label,
            shades: shown,
            range: self.range,
            is_exceeded: self.is_exceeded,
        }
    }
}

/// A quantity of the water, drawn where the water is above the ground.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    /// NaN where there is none.
    pub values: Grid,
    /// Elevation of the water, NaN where dry; m.
    pub surface: Grid,
    pub scale: Scale,
}

impl Sheet {
    /// Palette index at a point in plan view.
    pub fn color_at(&self, place: [f64; 2], ground: &Grid) -> u8 {
        let surface = value(&self.surface, place);
        let is_wet = surface.is_some_and(|surface| {
            // beyond the survey the ground is unknown
            value(ground, place).is_none_or(|ground| ground < surface)
        });
        match value(&self.values, place).filter(|_| is_wet) {
            Some(value) => self.scale.color_of(value),
            None => CLEAR,
        }
    }
}

/// Palette indices, row by row from the top.
pub(super) fn pixels(window: Window, color_at: impl Fn([f64; 2]) -> u8) -> Vec<u8> {
    let Window {
        min,
        max,
        width,
        height,
    } = window;
    let x = |column: usize| min[0] + (column as f64 + 0.5) / width as f64 * (max[0] - min[0]);
    let y = |row: usize| max[1] - (row as f64 + 0.5) / height as f64 * (max[1] - min[1]);
    (0..height)
        .flat_map(|row| (0..width).map(move |column| (column, row)))
        .map(|(column, row)| color_at([x(column), y(row)]))
        .collect()
}

/// Value at a point in plan view: bilinear mean of the surrounding grid points with a value, if these have at least half
/// of the weight; constant beyond the rim.
pub(super) fn value(grid: &Grid, place: [f64; 2]) -> Option<f64> {
    let mut square = [0; 2];
    let mut share = [0.0; 2];
    for axis in 0..2 {
        let along = (place[axis] - grid.corner[axis]) / grid.spacing;
        let along = along.clamp(0.0, (grid.n[axis] - 1) as f64);
        square[axis] = (along as usize).min(grid.n[axis] - 2);
        share[axis] = along - square[axis] as f64;
    }
    let [s, t] = share;
    let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t];
    let (mut sum, mut whole) = (0.0, 0.0);
    for (k, weight) in weights.into_iter().enumerate() {
        let value = grid.heights[grid.index([square[0] + k % 2, square[1] + k / 2])];
        if value.is_finite() {
            sum += weight * value;
            whole += weight;
        }
    }
    (0.5 <= whole).then(|| sum / whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(heights: Vec<f64>) -> Grid {
        Grid {
            n: [3, 2],
            corner: [0.0, 0.0],
            spacing: 10.0,
            heights,
        }
    }

    #[test]
    fn values_reach_half_way_to_points_without_one() {
        let grid = grid(vec![1.0, 2.0, f64::NAN, 5.0, 6.0, f64::NAN]);
        assert_eq!(value(&grid, [5.0, 5.0]), Some(3.5));
        assert_eq!(value(&grid, [15.0, 0.0]), Some(2.0));
        assert_eq!(value(&grid, [15.1, 0.0]), None);
        // values beyond the rim are those at the rim
        assert_eq!(value(&grid, [-4.0, 12.0]), Some(5.0));
    }

    #[test]
    fn water_shows_where_it_stands_above_the_ground() {
        let ground = grid(vec![-10.0, 0.0, 10.0, -10.0, 0.0, 10.0]);
        let surface = grid(vec![2.0; 6]);
        let sheet = Sheet {
            values: surface.clone(),
            surface,
            scale: Scale::of_elevations(&[-2.0, 2.0]),
        };
        // the ground is z = x − 10, the water 2 m high
        let is_wet = |x: f64| sheet.color_at([x, 5.0], &ground) != CLEAR;
        assert!(is_wet(0.0) && is_wet(11.9) && !is_wet(12.1) && !is_wet(20.0));
        assert_eq!(
            usize::from(sheet.color_at([0.0, 5.0], &ground)),
            2 * N_SIDE + 1
        );
    }

    #[test]
    fn water_at_rest_has_the_middle_of_the_colors() {
        let scale = Scale::of_elevations(&[-3.0, 0.0, 1.0]);
        assert_eq!(scale.range, (-3.0, 3.0));
        assert_eq!(usize::from(scale.color_of(0.0)), 1 + N_SIDE);
        assert_eq!(usize::from(scale.color_of(-9.0)), 1);
        assert_eq!(
            scale.palette().0[1 + N_SIDE],
            color::elevation(N_SIDE)[N_SIDE]
        );
    }

    #[test]
    fn rows_go_down_from_the_north() {
        let window = Window {
            min: [0.0, 0.0],
            max: [4.0, 2.0],
            width: 4,
            height: 2,
        };
        let found = pixels(window, |[x, y]| (10.0 * y + x) as u8);
        assert_eq!(found, [15, 16, 17, 18, 5, 6, 7, 8]);
    }
}
