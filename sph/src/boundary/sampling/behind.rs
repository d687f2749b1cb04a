//! Points behind one face of a thin solid, or behind several curved ones.

use nalgebra::Vector2;

use super::{Axes, WallSample, cells_along, layers, n_layers};
use crate::Vec3;
use crate::boundary::integral::Face;

/// Rows of points along an axis in which a solid has no end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rows {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Start of the first row; m.
    pub from: f64,
    /// Width of a row; m.
    pub width: f64,
    /// Number of rows.
    pub count: usize,
}

impl Rows {
    /// Across the rows of a face, and along them.
    fn axes(&self, face: &Face) -> Axes {
        let mut v = Vec3::zeros();
        v[self.axis] = 1.0;
        Axes {
            u: v.cross(&face.normal).normalize(),
            v,
        }
    }
}

/// Points behind a face to the depth of the support, as if the solid were equally deep everywhere, and beyond
/// the edges as far as oblique lines of sight through the face reach; with `rows` along the axis in which the face has no end.
///
/// Layers `dp` thick, the first half a spacing deep, of cells that divide the face evenly. Lengths in m, above
/// zero.
pub fn sample_behind(
    face: &Face,
    rows: Option<Rows>,
    particle_spacing: f64,
    support_radius: f64,
) -> Vec<WallSample> {
    let axes = rows.map_or_else(|| Axes::along_longest_edge(face), |rows| rows.axes(face));
    let corners: Vec<Vector2<f64>> = face.vertices.iter().map(|x| axes.plane(x)).collect();
    let Some(depth) = face.vertices.first().map(|x| face.normal.dot(x)) else {
        return Vec::new();
    };
    let beyond = (support_radius / particle_spacing).ceil() as usize + 1;
    let along = |axis: usize| {
        let places = corners.iter().map(|p| p[axis]);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        });
        let (n, step) = cells_along(high - low, particle_spacing);
        (low - beyond as f64 * step, n + 2 * beyond, step)
    };
    let (from_u, n_u, step_u) = along(0);
    let (from_v, n_v, step_v) = rows.map_or_else(|| along(1), |r| (r.from, r.count, r.width));
    let mut samples = Vec::new();
    for layer in 0..n_layers(particle_spacing, support_radius) {
        let below = (layer as f64 + 0.5) * particle_spacing;
        let sideways = (support_radius * support_radius - below * below).max(0.0);
        for j in 0..n_v {
            for i in 0..n_u {
                let u = from_u + (i as f64 + 0.5) * step_u;
                let v = from_v + (j as f64 + 0.5) * step_v;
                let away = match rows {
                    None => squared_distance(&corners, Vector2::new(u, v)),
                    Some(_) => interval_distance(&corners, u).powi(2),
                };
                if away < sideways {
                    samples.push(WallSample {
                        position: axes.u * u + axes.v * v + face.normal * (depth - below),
                        volume: step_u * step_v * particle_spacing,
                    });
                }
            }
        }
    }
    samples
}

/// As [`sample_behind`], behind a side of several faces, that curves out: layers along them bounded by the planes that
/// bisect their angles, and beyond the edges at which the side ends.
pub fn sample_behind_side(
    side: &[Face],
    rows: Option<Rows>,
    particle_spacing: f64,
    support_radius: f64,
) -> Vec<WallSample> {
    let n_layers = n_layers(particle_spacing, support_radius);
    let mut samples = layers::samples(side, particle_spacing, n_layers);
    for (index, face) in side.iter().enumerate() {
        let mut beyond = sample_behind(face, rows, particle_spacing, support_radius);
        let slack = COPLANAR * particle_spacing;
        beyond.retain(|sample| {
            let nearest = nearest(side, rows, &sample.position, slack);
            nearest.is_some_and(|(nearest, beside)| nearest == index && 0.0 < beside)
        });
        samples.append(&mut beyond);
    }
    samples
}

/// Depths whose difference is round-off: of parts of one plane; spacings.
const COPLANAR: f64 = 1e-6;

/// The face with the smallest depth of a point behind it, and the lateral distance (m): among coplanar faces the closest one.
fn nearest(side: &[Face], rows: Option<Rows>, x: &Vec3, slack: f64) -> Option<(usize, f64)> {
    let depth = |face: &Face| {
        let origin = face.vertices.first();
        origin.map_or(f64::INFINITY, |origin| face.normal.dot(&(origin - x)))
    };
    let least = side.iter().map(depth).fold(f64::INFINITY, f64::min);
    let faces = side.iter().enumerate();
    faces
        .filter(|(_, face)| depth(face) <= least + slack)
        .map(|(index, face)| (index, distance_beside(face, rows, x)))
        .min_by(|(_, a), (_, b)| a.total_cmp(b))
}

/// Lateral distance of a point from a face, in projection along its normal; m.
fn distance_beside(face: &Face, rows: Option<Rows>, x: &Vec3) -> f64 {
    let axes = rows.map_or_else(|| Axes::along_longest_edge(face), |rows| rows.axes(face));
    let corners: Vec<Vector2<f64>> = face.vertices.iter().map(|x| axes.plane(x)).collect();
    let place = axes.plane(x);
    match rows {
        None => squared_distance(&corners, place).sqrt(),
        Some(_) => interval_distance(&corners, place.x),
    }
}

/// Whether a point in a solid may be within the support (m) of fluid on one of its faces.
pub fn is_behind(face: &Face, x: &Vec3, support_radius: f64) -> bool {
    let axes = Axes::along_longest_edge(face);
    let corners: Vec<Vector2<f64>> = face.vertices.iter().map(|x| axes.plane(x)).collect();
    let origin = face.vertices.first();
    let depth = origin.map_or(f64::INFINITY, |origin| face.normal.dot(&(origin - x)));
    squared_distance(&corners, axes.plane(x)) + depth * depth < support_radius * support_radius
}

/// Distance of a point from the interval spanned by the corners along `u`; m.
fn interval_distance(corners: &[Vector2<f64>], u: f64) -> f64 {
    let (below, above) = corners.iter().fold((true, true), |(below, above), p| {
        (below && u < p.x, above && p.x < u)
    });
    if !below && !above {
        return 0.0;
    }
    let nearest = corners.iter().map(|p| (p.x - u).abs());
    nearest.fold(f64::INFINITY, f64::min)
}

/// Square of the distance of a point from a convex polygon of either orientation; m².
fn squared_distance(corners: &[Vector2<f64>], point: Vector2<f64>) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let (mut left, mut right, mut least) = (false, false, f64::INFINITY);
    for (p, q) in corners.iter().zip(next) {
        let (edge, offset) = (q - p, point - p);
        let side = edge.x * offset.y - edge.y * offset.x;
        left |= 0.0 < side;
        right |= side < 0.0;
        let share = (edge.dot(&offset) / edge.norm_squared()).clamp(0.0, 1.0);
        least = least.min((offset - edge * share).norm_squared());
    }
    if left && right { least } else { 0.0 }
}
