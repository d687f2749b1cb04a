//! Layers along the faces of a convex body.

use nalgebra::Vector2;

use super::polygon::{Cells, Polygon};
use super::{Axes, WallSample, cells_along};
use crate::Vec3;
use crate::boundary::integral::Face;

/// A piece of a cell below this share of `dp²` joins a neighbor.
pub(super) const LEAST_SHARE: f64 = 0.3;
/// Slices of a layer over which its volume is summed: 1/(24 · 64) of the curvature is left.
const SLICES: usize = 8;
/// Cosine of normals above which two faces are parts of one plane: an angle of 1e-6.
const COPLANAR: f64 = 1.0 - 5e-13;

/// Points of the layers at depths `(k + ½) dp` below every face.
///
/// The volume of a point is the area of its piece of a cell times the volume of the layer over its area, `dp`
/// except where a layer ends within itself. The volume of layers too small for a point is shared by all. `None` for a body too
/// small for a layer.
pub(super) fn samples(faces: &[Face], spacing: f64, n_layers: usize) -> Vec<WallSample> {
    let mut samples: Vec<WallSample> = Vec::new();
    let mut shell = 0.0;
    for (index, face) in faces.iter().enumerate() {
        let axes = Axes::along_longest_edge(face);
        let outline = Polygon::new(face.vertices.iter().map(|p| axes.plane(p)).collect());
        let at_depth = |depth: f64| layer(faces, index, &axes, &outline, depth);
        let cells = cells_of(&outline, spacing);
        let Some(corner) = face.vertices.first() else {
            continue;
        };
        let height = face.normal.dot(corner);
        for k in 0..n_layers {
            let top = k as f64 * spacing;
            let slice = spacing / SLICES as f64;
            let volume: f64 = (0..SLICES)
                .map(|s| slice * at_depth(top + (s as f64 + 0.5) * slice).area())
                .sum();
            shell += volume;
            let depth = top + 0.5 * spacing;
            let polygon = at_depth(depth);
            let area = polygon.area();
            let pieces = polygon.pieces(&cells, LEAST_SHARE * spacing * spacing);
            samples.extend(pieces.iter().map(|piece| WallSample {
                position: axes.u * piece.centroid.x
                    + axes.v * piece.centroid.y
                    + face.normal * (height - depth),
                volume: piece.area * volume / area,
            }));
        }
    }
    let filled: f64 = samples.iter().map(|sample| sample.volume).sum();
    for sample in &mut samples {
        sample.volume *= shell / filled;
    }
    samples
}

/// The part of the plane at `depth` below a face that is nearer to it than to any other face.
fn layer(faces: &[Face], index: usize, axes: &Axes, outline: &Polygon, depth: f64) -> Polygon {
    let mut polygon = outline.clone();
    let Some(corner) = faces[index].vertices.first() else {
        return polygon;
    };
    let normal = faces[index].normal;
    let height = normal.dot(corner) - depth;
    for (other_index, other) in faces.iter().enumerate() {
        // parts of one plane share it along their common edge, which the outline has
        let is_same_plane = COPLANAR < normal.dot(&other.normal);
        let Some(other_corner) = other.vertices.first() else {
            continue;
        };
        if other_index == index || is_same_plane {
            continue;
        }
        // depth_g(a, b) = n_g·(v_g − n_f height) − (n_g·u) a − (n_g·v) b ≥ depth
        let depth_at_origin = other.normal.dot(&(other_corner - normal * height));
        polygon = polygon.clipped(axes.plane(&other.normal), depth_at_origin - depth);
    }
    polygon
}

pub(super) fn cells_of(outline: &Polygon, spacing: f64) -> Cells {
    let (low, high) = outline.extent();
    let (n_u, size_u) = cells_along(high.x - low.x, spacing);
    let (n_v, size_v) = cells_along(high.y - low.y, spacing);
    Cells {
        origin: low,
        size: Vector2::new(size_u, size_v),
        n: [n_u, n_v],
    }
}

/// One point for a body too small for a layer.
pub(super) fn whole(faces: &[Face]) -> Vec<WallSample> {
    let (mut volume, mut moment) = (0.0, Vec3::zeros());
    let Some(&apex) = faces.first().and_then(|face| face.vertices.first()) else {
        return Vec::new();
    };
    for face in faces {
        for pair in face.vertices.windows(2) {
            let [a, b, c] = [face.vertices[0], pair[0], pair[1]].map(|p| p - apex);
            let part = a.dot(&b.cross(&c)) / 6.0;
            volume += part;
            moment += (a + b + c) * (0.25 * part);
        }
    }
    if !(0.0 < volume) {
        return Vec::new();
    }
    vec![WallSample {
        position: apex + moment / volume,
        volume,
    }]
}
