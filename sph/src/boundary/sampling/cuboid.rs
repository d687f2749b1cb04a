//! The lattice of a box.

use super::{WallSample, cells_along};
use crate::Vec3;
use crate::boundary::integral::Face;

/// Largest cosine between faces that count as perpendicular.
const SQUARE: f64 = 1e-9;

/// A box along three perpendicular directions.
struct Cuboid {
    axes: [Vec3; 3],
    /// Lowest corner along the axes; m.
    low: [f64; 3],
    /// m.
    length: [f64; 3],
}

/// Points of the outer layers of a box; `None` when the faces are not those of a box.
///
/// The lattice has spacings `L_k / round(L_k/dp)`, its first rows half a spacing inside.
pub(super) fn samples(
    faces: &[Face],
    particle_spacing: f64,
    n_layers: usize,
) -> Option<Vec<WallSample>> {
    let Cuboid { axes, low, length } = cuboid(faces)?;
    let [(n_u, step_u), (n_v, step_v), (n_w, step_w)] =
        length.map(|length| cells_along(length, particle_spacing));
    let volume = step_u * step_v * step_w;
    let is_deep = |index: usize, n: usize| n_layers <= index && index + n_layers < n;
    let mut samples = Vec::new();
    for k in 0..n_w {
        for j in 0..n_v {
            for i in 0..n_u {
                if is_deep(i, n_u) && is_deep(j, n_v) && is_deep(k, n_w) {
                    continue;
                }
                let at = |axis: usize, index: usize, step: f64| {
                    axes[axis] * (low[axis] + (index as f64 + 0.5) * step)
                };
                samples.push(WallSample {
                    position: at(0, i, step_u) + at(1, j, step_v) + at(2, k, step_w),
                    volume,
                });
            }
        }
    }
    Some(samples)
}

/// The box whose faces these are.
fn cuboid(faces: &[Face]) -> Option<Cuboid> {
    if faces.len() != 6 || faces.iter().any(|face| face.vertices.len() != 4) {
        return None;
    }
    let first = faces[0].normal;
    let second = faces
        .iter()
        .map(|face| face.normal)
        .find(|normal| first.dot(normal).abs() < SQUARE)?;
    let axes = [first, second, first.cross(&second)];
    let is_along =
        |face: &Face, sense: f64, axis: &Vec3| 1.0 - SQUARE < sense * face.normal.dot(axis);
    let has_both = |axis| {
        [-1.0, 1.0]
            .iter()
            .all(|&sense| faces.iter().any(|face| is_along(face, sense, axis)))
    };
    if !axes.iter().all(has_both) {
        return None;
    }
    let corners = || faces.iter().flat_map(|face| face.vertices);
    let low = axes.map(|axis| corners().map(|p| axis.dot(p)).fold(f64::INFINITY, f64::min));
    let high = axes.map(|axis| {
        corners()
            .map(|p| axis.dot(p))
            .fold(-f64::INFINITY, f64::max)
    });
    Some(Cuboid {
        axes,
        low,
        length: std::array::from_fn(|axis| high[axis] - low[axis]),
    })
}
