//! Shaded relief of the terrain: hypsometric tints, and light from the northwest.

use std::f64::consts::FRAC_1_SQRT_2;

use super::sheet;
use crate::picture::chart::axis::nice_up;
use crate::picture::color;
use crate::picture::overview::raster::CLEAR;
use crate::scene::terrain::grid::Grid;

/// Largest number of elevation layers of dry land, one tint each; the bed below still water is one more.
const MOST_LAYERS: usize = 10;
/// Shades of each tint; all tints and shades fit a palette.
const N_SHADES: usize = 23;
// indices of the picture are bytes
const _: () = assert!((1 + MOST_LAYERS) * N_SHADES < 256);
/// Direction to the sun, northwest at 45°, the cartographic convention; –.
const SUN: [f64; 3] = [-0.5, 0.5, FRAC_1_SQRT_2];
/// Brightness of ground without light over that of level ground; –.
const DARKEST: f64 = 0.58;
/// Lightening of ground that faces the sun; –.
const GLOSS: f64 = 0.55;

/// Ground prepared for drawing.
#[derive(Debug)]
pub(super) struct Relief<'a> {
    ground: &'a Grid,
    light: Grid,
    /// Elevation of the shore; m.
    shore: f64,
    /// Thickness of a layer; m.
    layer: f64,
    n_layers: usize,
    is_wet_below: bool,
}

impl<'a> Relief<'a> {
    /// Relief of ground with still water up to a level (m).
    pub fn new(ground: &'a Grid, still_level: Option<f64>) -> Self {
        let (lowest, highest) = ground.range();
        let shore = still_level.unwrap_or(lowest);
        // neither water nor ground
        let shore = if shore.is_finite() { shore } else { 0.0 };
        let land = (highest - shore).max(0.0);
        let (layer, n_layers) = match 0.0 < land && land.is_finite() {
            true => {
                let layer = nice_up(land / MOST_LAYERS as f64);
                // the highest point belongs to the uppermost layer
                (layer, (land / layer * (1.0 - 1e-9)).ceil() as usize)
            }
            false => (1.0, 1),
        };
        Self {
            ground,
            light: lit(ground),
            shore,
            layer,
            n_layers: n_layers.clamp(1, MOST_LAYERS),
            is_wet_below: still_level.is_some(),
        }
    }

    /// Palette index at a point in plan view.
    pub fn color_at(&self, place: [f64; 2]) -> u8 {
        let height = sheet::value(self.ground, place);
        let light = sheet::value(&self.light, place);
        let Some((height, light)) = height.zip(light) else {
            return CLEAR;
        };
        let shade = (light * N_SHADES as f64).clamp(0.0, (N_SHADES - 1) as f64) as usize;
        (1 + self.tint(height) * N_SHADES + shade) as u8
    }

    /// Bottom of the lowest and top of the highest layer (m), and the tints.
    pub fn land(&self) -> ((f64, f64), Vec<[u8; 3]>) {
        let top = self.shore + self.n_layers as f64 * self.layer;
        ((self.shore, top), color::land(self.n_layers))
    }

    /// Colors and opacities of the palette.
    pub fn palette(&self) -> (Vec<[u8; 3]>, Vec<u8>) {
        let mut colors = vec![[0xff; 3]];
        for tint in [color::BED].into_iter().chain(color::land(self.n_layers)) {
            colors.extend((0..N_SHADES).map(|shade| {
                let light = (shade as f64 + 0.5) / N_SHADES as f64 / SUN[2];
                match light < 1.0 {
                    true => color::over(tint, DARKEST + (1.0 - DARKEST) * light, [0; 3]),
                    false => color::over([0xff; 3], GLOSS * (light - 1.0), tint),
                }
            }));
        }
        let mut opacity = vec![0xff; colors.len()];
        opacity[usize::from(CLEAR)] = 0;
        (colors, opacity)
    }

    fn tint(&self, height: f64) -> usize {
        if self.is_wet_below && height < self.shore {
            return 0;
        }
        let layer = (height - self.shore) / self.layer;
        1 + layer.clamp(0.0, (self.n_layers - 1) as f64) as usize
    }
}

/// Light on ground of a slope ∂z/∂x, ∂z/∂y from a sun `s`.
///
/// ```text
/// I = max(0, n·s),      n = (−∂z/∂x, −∂z/∂y, 1) / √(1 + |∇z|²)                               [–]
/// ```
/// Source: Horn (1981), "Hill shading and the reflectance map", the cosine law of Lambert.
fn illumination([slope_x, slope_y]: [f64; 2]) -> f64 {
    let along = SUN[2] - slope_x * SUN[0] - slope_y * SUN[1];
    (along / (1.0 + slope_x * slope_x + slope_y * slope_y).sqrt()).max(0.0)
}

/// Light at each point; NaN without ground.
fn lit(ground: &Grid) -> Grid {
    let light = ground.points().map(|point| {
        let known = ground.heights[ground.index(point)].is_finite();
        match known {
            true => illumination([0, 1].map(|axis| slope(ground, point, axis))),
            false => f64::NAN,
        }
    });
    Grid {
        heights: light.collect(),
        ..ground.clone()
    }
}

/// Slope along an axis: central difference, one-sided at edges; –.
fn slope(ground: &Grid, point: [usize; 2], axis: usize) -> f64 {
    let height = |along: usize| {
        let mut at = point;
        at[axis] = along;
        ground.heights[ground.index(at)]
    };
    let here = point[axis];
    let is_known = |&along: &usize| along < ground.n[axis] && height(along).is_finite();
    let before = here.checked_sub(1).filter(is_known).unwrap_or(here);
    let after = Some(here + 1).filter(is_known).unwrap_or(here);
    if before == after {
        return 0.0;
    }
    (height(after) - height(before)) / ((after - before) as f64 * ground.spacing)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(slope_x: f64, slope_y: f64) -> Grid {
        let mut grid = Grid {
            n: [7, 5],
            corner: [100.0, -30.0],
            spacing: 2.0,
            heights: Vec::new(),
        };
        let height = |[x, y]: [f64; 2]| 4.0 + slope_x * x + slope_y * y;
        grid.heights = grid.points().map(|p| height(grid.place(p))).collect();
        grid
    }

    #[test]
    fn light_on_a_plane_follows_the_cosine_law() {
        // dips along the horizontal direction of the sun: the angle between normal and sun is 45° less the dip
        for dip_deg in [-30.0f64, 0.0, 20.0, 45.0, 70.0] {
            let steepness = dip_deg.to_radians().tan();
            let along = steepness * FRAC_1_SQRT_2;
            let expected = (45.0 - dip_deg).to_radians().cos();
            for light in lit(&plane(along, -along)).heights {
                // round-off
                assert!((light - expected).abs() < 1e-12, "{dip_deg}: {light}");
            }
        }
        // across it, the horizontal part of the sun does not count: cos 45° cos dip
        let along = 30f64.to_radians().tan() * FRAC_1_SQRT_2;
        let expected = FRAC_1_SQRT_2 * 30f64.to_radians().cos();
        for light in lit(&plane(along, along)).heights {
            assert!((light - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn what_faces_away_lies_in_the_shade() {
        // dips by 60° to the south-east, and the sun is at 45°
        let along = 60f64.to_radians().tan() * FRAC_1_SQRT_2;
        assert!(
            lit(&plane(-along, along))
                .heights
                .iter()
                .all(|&light| light == 0.0)
        );
    }

    #[test]
    fn beside_a_gap_the_other_side_tells_the_slope() {
        let mut grid = plane(0.5, 0.25);
        let gap = grid.index([3, 2]);
        grid.heights[gap] = f64::NAN;
        let light = lit(&grid);
        assert!(light.heights[gap].is_nan());
        let expected = illumination([0.5, 0.25]);
        let others = light.heights.iter().enumerate().filter(|(k, _)| *k != gap);
        for (k, light) in others {
            assert!((light - expected).abs() < 1e-12, "{k}");
        }
    }

    #[test]
    fn colors_are_in_the_palette_and_change_at_the_shore() {
        let grid = plane(1.0, 0.0);
        let relief = Relief::new(&grid, Some(110.0));
        let (colors, opacity) = relief.palette();
        assert!(colors.len() <= 256 && colors.len() == opacity.len());
        // z = 4 + x: the shore is at x = 106, and layers up to x = 112 are 1 m thick
        let tint = |x: f64| (usize::from(relief.color_at([x, -26.0])) - 1) / N_SHADES;
        assert_eq!([105.9, 106.1, 107.1, 112.0].map(tint), [0, 1, 2, 6]);
        assert_eq!(relief.land(), ((110.0, 116.0), color::land(6)));
        // dry ground has no bed
        let dry = Relief::new(&grid, None);
        assert_eq!(
            (usize::from(dry.color_at([100.0, -26.0])) - 1) / N_SHADES,
            1
        );
        // level ground keeps its tint
        let level = plane(0.0, 0.0);
        let relief = Relief::new(&level, None);
        let found = relief.palette().0[usize::from(relief.color_at([104.0, -26.0]))];
        for (found, tint) in found.into_iter().zip(color::land(1)[0]) {
            // half a shade
            assert!(found.abs_diff(tint) < 8, "{found} {tint}");
        }
    }
}
