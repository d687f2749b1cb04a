//! Fields of the fluid at any point, for gauges.

use nalgebra::Matrix3;

use crate::kernel::{Dimensions, Kernel, PointKernel};
use crate::neighbors::cells::{MAX_RUNS, Run};
use crate::neighbors::mirror::{Image, MOST_IMAGES};
use crate::{Fluid, Vec3};

/// The fluid at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Pressure; Pa.
    pub pressure: f64,
    /// Velocity; m/s.
    pub velocity: Vec3,
}

/// Kernel sum below which there are too few particles for a value. It is one eighth for a point in the corner of three
/// walls.
const LEAST_SHARE: f64 = 0.1;
/// Kernel sum above which a point is certainly under water; between the two it is if its pressure is that
/// of a point below the surface. It is one half for a point on a plane wall in deep water.
const SURE_SHARE: f64 = 0.25;
/// Least spread of the particles about their mean, over the squared smoothing length, for which a linear
/// field is fitted. A full kernel has some 0.3, a half one along its normal 0.1, a single row nothing.
const LEAST_SPREAD: f64 = 0.02;

/// A particle, or its image in planes of symmetry, near a point.
struct Near {
    /// From the point to it; m.
    offset: Vec3,
    /// Pa.
    pressure: f64,
    /// m/s.
    velocity: Vec3,
    /// Kernel value.
    weight: f64,
}

/// Sums over the neighbors of a point, offsets `d = (x_b − x)/h`.
struct Moments {
    weight: f64,
    first: Vec3,
    second: Matrix3<f64>,
    /// Pressure, and velocity: `Σ f W`.
    fields: [f64; 4],
    /// `Σ f d W`.
    slopes: [Vec3; 4],
}

impl Moments {
    /// Mean position, mean of each field, and gradient of each about the mean, from the linear fit by
    /// least squares, weighted with the kernel. No gradient if the particles are not sufficiently spread.
    fn fit(&self, plane: bool) -> (Vec3, [f64; 4], Option<[Vec3; 4]>) {
        let mean = self.first / self.weight;
        let values = self.fields.map(|f| f / self.weight);
        let mut spread = self.second / self.weight - mean * mean.transpose();
        if plane {
            // nothing spreads across, and nothing varies
            spread[(1, 1)] = 1.0;
        }
        let eigen = spread.symmetric_eigenvalues();
        let slopes = (LEAST_SPREAD < eigen.min())
            .then(|| spread.cholesky())
            .flatten()
            .map(|factors| {
                [0, 1, 2, 3]
                    .map(|k| factors.solve(&(self.slopes[k] / self.weight - mean * values[k])))
            });
        (mean, values, slopes)
    }
}

impl Fluid {
    /// Share of the kernel that is filled with fluid, 0 to about 1.
    ///
    /// ```text
    /// s(x) = Σ_b V_b W(x − x_b),   V_b = m/ρ₀
    /// ```
    pub fn filled_share(&self, point: &Vec3) -> f64 {
        let volume = self.particle_volume();
        let mut share = 0.0;
        self.for_each_near(point, |near| share += volume * near.weight);
        share
    }

    /// Pressure and velocity at a point; `None` when it is dry.
    ///
    /// The linear field that fits the particles best, in the least squares of the kernel (moving least
    /// squares): exact for linear fields, also on a wall, where particles are on one side only.
    ///
    /// ```text
    /// f(x) = f̄ − ∇f·d̄ h,   d = (x_b − x)/h,   C ∇f h = cov(d, f),   C = cov(d, d)
    /// ```
    /// means and covariances weighted with `W`. If the particles are degenerate the mean is used,
    /// and pressure varies hydrostatically from the mean position to the point:
    ///
    /// ```text
    /// p(x) = p̄ − ρ₀ g·d̄ h
    /// ```
    pub fn sample(&self, point: &Vec3) -> Option<Sample> {
        let settings = self.settings();
        let h = settings.smoothing_length;
        let mut sums = Moments {
            weight: 0.0,
            first: Vec3::zeros(),
            second: Matrix3::zeros(),
            fields: [0.0; 4],
            slopes: [Vec3::zeros(); 4],
        };
        self.for_each_near(point, |near| {
            let (d, v, w) = (near.offset / h, near.velocity, near.weight);
            sums.weight += w;
            sums.first += d * w;
            sums.second += d * d.transpose() * w;
            for (k, f) in [near.pressure, v.x, v.y, v.z].into_iter().enumerate() {
                sums.fields[k] += f * w;
                sums.slopes[k] += d * (f * w);
            }
        });
        let share = self.particle_volume() * sums.weight;
        if share <= LEAST_SHARE {
            return None;
        }
        let plane = matches!(settings.dimensions, Dimensions::Two { .. });
        let (mean, values, slopes) = sums.fit(plane);
        let [pressure, vx, vy, vz] = match slopes {
            Some(slopes) => [0, 1, 2, 3].map(|k| values[k] - slopes[k].dot(&mean)),
            None => {
                let weight = settings.gravity * (settings.reference_density * h);
                [
                    values[0] - weight.dot(&mean),
                    values[1],
                    values[2],
                    values[3],
                ]
            }
        };
        (SURE_SHARE < share || 0.0 < pressure).then(|| Sample {
            pressure,
            velocity: Vec3::new(vx, vy, vz),
        })
    }

    /// Calls `visit` with each particle, and each image in planes of symmetry, within the support of a point.
    fn for_each_near(&self, point: &Vec3, mut visit: impl FnMut(&Near)) {
        let (grid, settings) = (self.grid(), self.settings());
        let support = settings.support_radius();
        let kernel = PointKernel::new(settings.scheme.kernel, support, settings.dimensions);
        let mut runs = [Run::default(); MAX_RUNS];
        let reach = support + self.moved();
        let particles = self.particles();
        let mut images = [Image::default(); MOST_IMAGES];
        let point = self.in_plane(*point);
        let n_images = settings.mirrors().images_within(&point, reach, &mut images);
        // the image of the point relates to the particles as the point to their images, see `mirror`
        for image in &images[..n_images] {
            let signs = Vec3::from(image.signs());
            let n = grid.runs_within(&image.position, reach, &mut runs);
            for run in &runs[..n] {
                let seen_from = image.position - grid.image_shift(run.image);
                for b in run.start as usize..run.end as usize {
                    let offset = particles.position[b] - seen_from;
                    let r2 = offset.norm_squared();
                    if r2 < support * support {
                        visit(&Near {
                            offset: offset.component_mul(&signs),
                            pressure: particles.pressure[b],
                            velocity: particles.velocity[b].component_mul(&signs),
                            weight: kernel.value(r2.sqrt()),
                        });
                    }
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
