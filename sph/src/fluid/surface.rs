//! Elevation of the free surface along a vertical.

use std::array;
use std::ops::Range;

use crate::kernel::{Kernel, PointKernel};
use crate::neighbors::cells::{MAX_RUNS, Run};
use crate::neighbors::mirror::{Image, MOST_IMAGES};
use crate::{Fluid, Vec3};

/// Share of the full kernel sum above which a point is under water: a half at a plane surface.
const WET_SHARE: f64 = 0.5;
/// Largest kernel sum of an isolated particle: less is not water.
const DROP_SHARE: f64 = 0.2;
/// A column is water where the kernel is filled to this share somewhere: at a wall it is half full.
const COLUMN_SHARE: f64 = 0.4;

impl Fluid {
    /// Elevation of the free surface at a point (x, y) in plan view; `None` when dry; m.
    ///
    /// The highest crossing of half the kernel sum, so that a drop in the air is not a surface; near a
    /// wall, which occupies a part of the kernel, half of the largest kernel sum within two supports
    /// below. Spray less than two supports thick with air below it is not a surface where there is water under both; a film
    /// on a bed is.
    pub fn surface_elevation(&self, x: f64, y: f64) -> Option<f64> {
        let mut vertical = Vertical::through(self, x, y);
        let mut surface = None;
        let mut below = f64::INFINITY;
        while let Some((top, bottom)) = vertical.highest_water(below) {
            surface = Some(top);
            let Some(bottom) = bottom else { break };
            below = bottom;
        }
        surface
    }
}

/// A particle, or its image in a plane of symmetry or across a period, seen from a vertical.
#[derive(Clone, Copy, Debug)]
struct Beside {
    /// Elevation; m.
    z: f64,
    /// Squared distance from the vertical; m².
    r2: f64,
}

/// Particles within the support of a vertical, one layer of cells after the other from the top, as far down as they were asked for.
///
/// A reading asks for the kernel sum at some forty points of its vertical: each particle is found once for all of them.
struct Vertical<'f> {
    fluid: &'f Fluid,
    kernel: PointKernel,
    support: f64,
    /// In plan view; its elevation has no meaning.
    place: Vec3,
    particles: Vec<Beside>,
    layers: Vec<Layer>,
    /// Layers of cells that were not looked at, from the bottom.
    n_left: usize,
    /// Whether a plane of symmetry or a period lies across it: particles are seen there at elevations that are not those of their cells.
    is_cut: bool,
}

/// Particles of a layer of cells.
struct Layer {
    particles: Range<usize>,
    /// Lowest and highest of them; m.
    extent: [f64; 2],
}

impl<'f> Vertical<'f> {
    fn through(fluid: &'f Fluid, x: f64, y: f64) -> Self {
        let settings = fluid.settings();
        let support = settings.support_radius();
        Self {
            kernel: PointKernel::new(settings.scheme.kernel, support, settings.dimensions),
            support,
            place: fluid.in_plane(Vec3::new(x, y, fluid.grid().min().z)),
            particles: Vec::new(),
            layers: Vec::new(),
            n_left: fluid.grid().counts()[2],
            is_cut: settings.mirrors().are_across(2) || fluid.grid().periodic()[2],
            fluid,
        }
    }

    /// Looks at the next layer down.
    fn descend(&mut self) {
        let Self { fluid, support, .. } = *self;
        self.n_left -= 1;
        let (grid, positions) = (fluid.grid(), &fluid.particles().position);
        let reach = support + fluid.moved();
        let first = self.particles.len();
        let mut extent = [f64::INFINITY, f64::NEG_INFINITY];
        let mut images = [Image::default(); MOST_IMAGES];
        let mirrors = fluid.settings().mirrors();
        let n_images = mirrors.images_within(&self.place, reach, &mut images);
        for image in &images[..n_images] {
            let mut runs = [Run::default(); MAX_RUNS];
            let n = grid.runs_beside(&image.position, self.n_left, reach, &mut runs);
            for run in &runs[..n] {
                let seen_from = image.position - grid.image_shift(run.image);
                for x in &positions[run.start as usize..run.end as usize] {
                    let r2 = (x.x - seen_from.x).powi(2) + (x.y - seen_from.y).powi(2);
                    if r2 < support * support {
                        self.particles.push(Beside { z: x.z, r2 });
                        extent = [extent[0].min(x.z), extent[1].max(x.z)];
                    }
                }
            }
        }
        if first < self.particles.len() {
            self.layers.push(Layer {
                particles: first..self.particles.len(),
                extent,
            });
        }
    }

    /// Elevation that particles in layers not looked at do not exceed; m.
    fn ceiling_of_rest(&self) -> f64 {
        let grid = self.fluid.grid();
        match self.n_left {
            0 => f64::NEG_INFINITY,
            // the uppermost cells have no end
            n if n == grid.counts()[2] => f64::INFINITY,
            n => grid.min().z + n as f64 * grid.cell_size().z * (1.0 + 1e-9) + self.fluid.moved(),
        }
    }

    /// Share of the kernel at an elevation that is filled with water, as [`Fluid::filled_share`].
    fn share(&mut self, z: f64) -> f64 {
        if self.is_cut {
            let [x, y] = [self.place.x, self.place.y];
            return self.fluid.filled_share(&Vec3::new(x, y, z));
        }
        while z - self.support < self.ceiling_of_rest() {
            self.descend();
        }
        let support2 = self.support * self.support;
        let mut sum = 0.0;
        for layer in &self.layers {
            let [low, high] = layer.extent;
            if z < low - self.support || high + self.support < z {
                continue;
            }
            for particle in &self.particles[layer.particles.clone()] {
                let r2 = particle.r2 + (particle.z - z).powi(2);
                if r2 < support2 {
                    sum += self.kernel.value(r2.sqrt());
                }
            }
        }
        self.fluid.particle_volume() * sum
    }

    /// Elevation of the highest particle below an elevation; m.
    fn highest_particle(&mut self, below: f64) -> Option<f64> {
        let mut highest = f64::NEG_INFINITY;
        let mut n_seen = 0;
        loop {
            let seen = self.particles[n_seen..].iter().map(|particle| particle.z);
            highest = seen.filter(|z| *z < below).fold(highest, f64::max);
            n_seen = self.particles.len();
            if self.ceiling_of_rest() <= highest || self.n_left == 0 {
                return highest.is_finite().then_some(highest);
            }
            self.descend();
        }
    }

    /// Top of the highest water below an elevation, and its bottom unless that is more than two supports down; m.
    fn highest_water(&mut self, below: f64) -> Option<(f64, Option<f64>)> {
        let step = 0.25 * self.fluid.settings().smoothing_length;
        let lowest = self.fluid.grid().min().z;
        let mut upper = (self.highest_particle(below)? + self.support).min(below);
        loop {
            let lower = upper - step;
            if lower < lowest {
                return None;
            }
            if DROP_SHARE <= self.share(lower) {
                let shares: [f64; 17] = array::from_fn(|k| self.share(lower - k as f64 * step));
                let fullest = shares.into_iter().fold(0.0, f64::max);
                if COLUMN_SHARE <= fullest {
                    let threshold = WET_SHARE * fullest.min(1.0);
                    while self.share(upper - step) < threshold {
                        upper -= step;
                    }
                    let top = bisect(upper - step, upper, |z| threshold <= self.share(z));
                    let bottom = shares.iter().position(|share| *share < DROP_SHARE);
                    return Some((top, bottom.map(|k| lower - k as f64 * step)));
                }
            }
            upper = lower;
        }
    }
}

/// Bisection of a condition that holds at `lower` but not at `upper`.
fn bisect(mut lower: f64, mut upper: f64, mut holds: impl FnMut(f64) -> bool) -> f64 {
    // twelve halvings: a four-thousandth of the first interval
    for _ in 0..12 {
        let middle = 0.5 * (lower + upper);
        if holds(middle) {
            lower = middle;
        } else {
            upper = middle;
        }
    }
    0.5 * (lower + upper)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop")]

    use super::*;
    use crate::{Dimensions, NoBoundary, Scheme, Settings, Start};

    /// A kernel sum by the vertical's particles is that by all cells near the point, also at planes of symmetry and across
    /// periods, and after particles have moved within the skin.
    #[test]
    fn shares_along_a_vertical_are_those_of_its_points() {
        let dp = 0.05;
        for (periodic, symmetry) in [
            ([false, false, false], [[false; 2]; 3]),
            ([true, false, false], [[false; 2], [true, true], [false; 2]]),
            (
                [false, true, false],
                [[true, false], [false; 2], [false; 2]],
            ),
            (
                [false, false, false],
                [[false; 2], [false; 2], [true, false]],
            ),
        ] {
            let mut positions = Vec::new();
            for k in 0..14 {
                for j in 0..10 {
                    for i in 0..10 {
                        let [x, y, z] = [i, j, k].map(|n| (f64::from(n) + 0.5) * dp);
                        let stir = 0.4 * dp * (31.0 * x + 17.0 * y + 47.0 * z).sin();
                        positions.push(Vec3::new(x + 0.3 * stir, y - 0.2 * stir, z + stir));
                    }
                }
            }
            let n = positions.len();
            let start = Start {
                positions,
                velocities: vec![Vec3::new(0.3, 0.2, -0.1); n],
                pressures: Vec::new(),
            };
            let settings = Settings {
                particle_spacing: [dp; 3],
                smoothing_length: 1.3 * dp,
                reference_density: 1000.0,
                sound_speed: 20.0,
                scheme: Scheme::artificial(),
                dimensions: Dimensions::Three,
                gravity: Vec3::zeros(),
                time_step_factor: 0.5,
                domain: (Vec3::zeros(), Vec3::new(0.5, 0.5, 1.2)),
                periodic,
                symmetry,
            };
            let mut fluid = Fluid::new(start, settings).unwrap();
            fluid.evaluate(&mut NoBoundary, 0.0).unwrap();
            fluid.step(&mut NoBoundary, 5e-4).unwrap();
            assert!(0.0 < fluid.moved());
            for (x, y) in [(0.01, 0.02), (0.49, 0.25), (0.25, 0.49), (0.26, 0.24)] {
                // once from the top down, and once with all layers at hand
                let mut vertical = Vertical::through(&fluid, x, y);
                for z in (0..60).rev().chain(0..60).map(|k| 0.02 * f64::from(k)) {
                    let (along, at) = (vertical.share(z), fluid.filled_share(&Vec3::new(x, y, z)));
                    // another order of a hundred terms
                    assert!((along - at).abs() < 1e-13, "{x} {y} {z}: {along} {at}");
                }
            }
        }
    }
}
