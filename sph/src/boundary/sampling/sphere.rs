//! Layers of a sphere.

use std::f64::consts::PI;

use super::{WallSample, n_layers};
use crate::Vec3;

/// Points of the shell of a sphere, to the depth of the support radius: layers `(k + ½) dp` deep, of
/// points distributed by the golden angle, about `dp` apart; the core of a small sphere is one point.
/// Lengths in m, above zero. Volumes add up to that of the shell.
pub fn sample_sphere(
    center: Vec3,
    radius: f64,
    particle_spacing: f64,
    support_radius: f64,
) -> Vec<WallSample> {
    let sphere_volume = |r: f64| 4.0 / 3.0 * PI * r.powi(3);
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    let mut samples = Vec::new();
    for k in 0..n_layers(particle_spacing, support_radius) {
        let outer = radius - k as f64 * particle_spacing;
        if outer <= 0.0 {
            break;
        }
        let inner = outer - particle_spacing;
        if inner <= 0.0 {
            let volume = sphere_volume(outer);
            samples.push(WallSample {
                position: center,
                volume,
            });
            break;
        }
        let middle = outer - 0.5 * particle_spacing;
        let n = (4.0 * PI * (middle / particle_spacing).powi(2))
            .round()
            .max(1.0) as usize;
        let volume = (sphere_volume(outer) - sphere_volume(inner)) / n as f64;
        samples.extend((0..n).map(|i| {
            let height = 1.0 - (2 * i + 1) as f64 / n as f64;
            let across = (1.0 - height * height).sqrt();
            // each layer starts elsewhere, so that points do not stand in rows
            let (sin, cos) = (golden_angle * i as f64 + k as f64).sin_cos();
            WallSample {
                position: center + Vec3::new(across * cos, across * sin, height) * middle,
                volume,
            }
        }));
    }
    samples
}
