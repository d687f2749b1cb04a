//! Tolerance of the triangles of terrain: what neither water nor blocks feel.

use super::grid::Grid;
use crate::scene::file::{ResolutionFile, SceneFile};

/// Tolerance without water or joints; × distance of the points.
const OF_POINTS: f64 = 0.01;
/// Distance of the triangles from the terrain that water and blocks do not feel; × particle spacing and × the closest joints.
const NOT_FELT: f64 = 0.03;
/// Such a distance where the ground is as rough from one point to the next: the water fills dents narrower than its particles by
/// their mean, and a block rests on the highest of many bumps.
const NOT_FELT_IN_NOISE: f64 = 0.1;
/// Standard deviations of noise that hold nearly all of it.
const ALL_OF_NOISE: f64 = 3.0;
/// Quantile of the differences that measures noise: a survey of land may be smooth over the half that is water.
const QUANTILE: f64 = 0.75;
/// That quantile of the magnitude of a normal distribution; × standard deviation.
const OF_NORMAL: f64 = 1.150_349_380_376_008;

/// Size of the finest feature of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finest {
    /// Distance of particles; m.
    Particles(f64),
    /// Distance of joints; m.
    Joints(f64),
}

/// Tolerance of triangles and its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToleranceOf {
    /// The scene states it; m.
    Scene(f64),
    /// A fraction of the finest feature.
    Feature(Finest),
    /// The noise of the points, up to a larger fraction of the finest feature.
    Noise {
        /// Standard deviation; m.
        noise: f64,
        /// Of what feels it.
        finest: Finest,
    },
    /// A fraction of the distance of the points; m.
    Points(f64),
}

impl Finest {
    /// m.
    fn size(self) -> f64 {
        match self {
            Self::Particles(size) | Self::Joints(size) => size,
        }
    }
}

impl std::fmt::Display for Finest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Particles(spacing) => write!(f, "the {spacing:.1} m between particles"),
            Self::Joints(spacing) => write!(f, "the {spacing:.1} m between joints"),
        }
    }
}

impl ToleranceOf {
    /// That of a scene on a grid.
    pub(super) fn of(file: &SceneFile, grid: &Grid) -> Self {
        if let Some(stated) = file.terrain.as_ref().and_then(|terrain| terrain.tolerance) {
            return Self::Scene(stated);
        }
        let of_points = Self::Points(grid.spacing);
        let Some(finest) = finest(file) else {
            return of_points;
        };
        let noise = Self::Noise {
            noise: noise(grid),
            finest,
        };
        let all = [Self::Feature(finest), of_points, noise];
        let larger = |a: Self, b: Self| if a.tolerance() < b.tolerance() { b } else { a };
        all.into_iter().fold(of_points, larger)
    }

    /// Largest distance of the triangles from the points; m.
    pub fn tolerance(self) -> f64 {
        match self {
            Self::Scene(tolerance) => tolerance,
            Self::Feature(finest) => NOT_FELT * finest.size(),
            Self::Noise { noise, finest } => {
                (ALL_OF_NOISE * noise).min(NOT_FELT_IN_NOISE * finest.size())
            }
            Self::Points(spacing) => OF_POINTS * spacing,
        }
    }
}

impl std::fmt::Display for ToleranceOf {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Scene(_) => write!(f, "as the scene states"),
            Self::Feature(finest) => write!(f, "{NOT_FELT} of {finest}"),
            Self::Noise { noise, finest } => write!(
                f,
                "{ALL_OF_NOISE} times the noise of the points, {noise:.2} m, up to {NOT_FELT_IN_NOISE} of {finest}"
            ),
            Self::Points(spacing) => write!(f, "{OF_POINTS} of the {spacing} m between points"),
        }
    }
}

/// The closest particles or joints of a scene.
fn finest(file: &SceneFile) -> Option<Finest> {
    let of_water = match file.fluid.as_ref().map(|fluid| fluid.resolution) {
        Some(ResolutionFile::Spacing(particles)) => Some(Finest::Particles(particles)),
        Some(ResolutionFile::Count(_)) | None => None,
    };
    let joints = file.slides.iter().flat_map(|slide| &slide.joint_sets);
    let all = joints
        .map(|set| Finest::Joints(set.spacing))
        .chain(of_water);
    all.min_by(|a, b| a.size().total_cmp(&b.size()))
}

/// Standard deviation of the noise of a grid, from fourth differences along rows and columns, in which smooth ground of more than
/// some points in length vanishes; m.
///
/// ```text
/// d = z₋₂ − 4 z₋₁ + 6 z₀ − 4 z₁ + z₂,    σ_d² = 70 σ²                                      [m]
/// ```
fn noise(grid: &Grid) -> f64 {
    let [columns, rows] = grid.n;
    let z = &grid.heights;
    let difference = |k: usize, step: usize| {
        let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|n| z[k + n * step]);
        (a - 4.0 * b + 6.0 * c - 4.0 * d + e).abs()
    };
    let along = (0..rows)
        .flat_map(|j| (0..columns.saturating_sub(4)).map(move |i| difference(j * columns + i, 1)));
    let across = (0..rows.saturating_sub(4))
        .flat_map(|j| (0..columns).map(move |i| difference(j * columns + i, columns)));
    let mut all: Vec<f64> = along.chain(across).collect();
    if all.is_empty() {
        return 0.0;
    }
    let k = (QUANTILE * (all.len() - 1) as f64) as usize;
    let (_, value, _) = all.select_nth_unstable_by(k, f64::total_cmp);
    *value / (OF_NORMAL * 70.0_f64.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use riprap_dda::Random;

    /// Noise is found on a slope and on hills, to the scatter of ten thousand points, and none where there is none.
    #[test]
    fn noise_is_told_from_ground() {
        let mut random = Random::new(3);
        for sigma in [0.0, 0.5] {
            let mut grid = Grid {
                n: [120, 100],
                corner: [0.0; 2],
                spacing: 2.0,
                heights: vec![0.0; 12_000],
            };
            for point in grid.points() {
                let [x, y] = grid.place(point);
                // twelve uniform numbers are normal with a standard deviation of one
                let normal = (0..12).map(|_| random.uniform()).sum::<f64>() - 6.0;
                let k = grid.index(point);
                grid.heights[k] =
                    0.6 * x + 8.0 * (x / 20.0).sin() * (y / 20.0).cos() + sigma * normal;
            }
            let found = noise(&grid);
            // of hills 0.1 to the fourth of 8 m in fourth differences
            assert!((found - sigma).abs() < 0.02, "{found}");
        }
    }
}
