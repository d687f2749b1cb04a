//! Fields of the fluid at any point, as gauges see them.

use crate::cells::{MAX_RUNS, Run};
use crate::kernel::{Dimensions, Kernel, PointKernel};
use crate::{Fluid, Vec3};

/// The fluid at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Pressure; Pa.
    pub pressure: f64,
    /// Velocity; m/s.
    pub velocity: Vec3,
}

/// Share of the full kernel sum above which a point is under water: a half at a plane surface.
const WET_SHARE: f64 = 0.5;
/// Share below which too few particles are near to speak of a value. A point on a plane wall in
/// deep water sees a half.
const LEAST_SHARE: f64 = 0.25;

impl Fluid {
    /// Share of the kernel that is filled with fluid, 0 to about 1.
    ///
    /// ```text
    /// s(x) = Σ_b V_b W(x − x_b),   V_b = m/ρ₀
    /// ```
    pub fn filled_share(&self, point: &Vec3) -> f64 {
        let volume = self.particle_volume();
        let mut share = 0.0;
        self.for_each_near(point, |_, w| share += volume * w);
        share
    }

    /// Pressure and velocity at a point by normalised interpolation; `None` when it is dry.
    ///
    /// ```text
    /// f(x) = Σ_b V_b f_b W / Σ_b V_b W
    /// ```
    pub fn sample(&self, point: &Vec3) -> Option<Sample> {
        let (mut sum, mut pressure, mut velocity) = (0.0, 0.0, Vec3::zeros());
        let particles = self.particles();
        self.for_each_near(point, |b, w| {
            sum += w;
            pressure += w * particles.pressure[b];
            velocity += particles.velocity[b] * w;
        });
        let volume = self.particle_volume();
        (LEAST_SHARE < volume * sum).then(|| Sample {
            pressure: pressure / sum,
            velocity: velocity / sum,
        })
    }

    /// Height of the free surface above the point (x, y) of the plan; `None` when it is dry; m.
    ///
    /// The highest crossing of half the kernel sum, so that a drop in the air is not a surface.
    pub fn surface_elevation(&self, x: f64, y: f64) -> Option<f64> {
        let step = 0.25 * self.settings().smoothing_length;
        let mut upper = self.highest_near(x, y)? + self.settings().support_radius();
        let lowest = self.grid().min().z;
        let share = |z: f64| self.filled_share(&Vec3::new(x, y, z));
        loop {
            let lower = upper - step;
            if lower < lowest {
                return None;
            }
            if WET_SHARE <= share(lower) {
                return Some(bisect(lower, upper, |z| WET_SHARE <= share(z)));
            }
            upper = lower;
        }
    }

    /// Height of the highest particle within the support of a vertical line; m.
    fn highest_near(&self, x: f64, y: f64) -> Option<f64> {
        let grid = self.grid();
        let support = self.settings().support_radius();
        let mut runs = [Run::default(); MAX_RUNS];
        for k in (0..grid.counts()[2]).rev() {
            let point = self.in_plane(Vec3::new(x, y, grid.cell_center([0, 0, k]).z));
            let n = grid.runs_within(&point, support + self.moved(), &mut runs);
            let highest = runs[..n]
                .iter()
                .flat_map(|run| {
                    let shift = grid.image_shift(run.image);
                    (run.start..run.end).map(move |b| self.particles().position[b as usize] + shift)
                })
                .filter(|p| (p.x - x).powi(2) + (p.y - point.y).powi(2) < support * support)
                .map(|p| p.z)
                .fold(f64::NEG_INFINITY, f64::max);
            if highest.is_finite() {
                return Some(highest);
            }
        }
        None
    }

    /// Calls `visit` with each particle within the support of a point and its kernel value.
    fn for_each_near(&self, point: &Vec3, mut visit: impl FnMut(usize, f64)) {
        let (grid, settings) = (self.grid(), self.settings());
        let support = settings.support_radius();
        let kernel = PointKernel::new(settings.scheme.kernel, support, settings.dimensions);
        let mut runs = [Run::default(); MAX_RUNS];
        let point = self.in_plane(*point);
        let n = grid.runs_within(&point, support + self.moved(), &mut runs);
        for run in &runs[..n] {
            let seen_from = point - grid.image_shift(run.image);
            for b in run.start as usize..run.end as usize {
                let r2 = (seen_from - self.particles().position[b]).norm_squared();
                if r2 < support * support {
                    visit(b, kernel.value(r2.sqrt()));
                }
            }
        }
    }

    /// In two dimensions the point of the plane of the flow abreast of a point.
    pub fn in_plane(&self, mut point: Vec3) -> Vec3 {
        let settings = self.settings();
        if let Dimensions::Two { .. } = settings.dimensions {
            point.y = 0.5 * (settings.domain.0.y + settings.domain.1.y);
        }
        point
    }
}

/// Where a condition that holds at `lower` and not at `upper` changes.
fn bisect(mut lower: f64, mut upper: f64, holds: impl Fn(f64) -> bool) -> f64 {
    // twenty halvings: a millionth of the first interval
    for _ in 0..20 {
        let middle = 0.5 * (lower + upper);
        if holds(middle) {
            lower = middle;
        } else {
            upper = middle;
        }
    }
    0.5 * (lower + upper)
}
