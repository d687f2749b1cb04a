//! Wall particles: points with volumes that fill solids to the depth of the kernel support.
//!
//! The support of fluid at the surface of a solid extends to the depth `R`. That shell is
//! filled with `⌈R/dp⌉` layers of points, the first half a spacing `dp` deep; the interior of a
//! solid stays empty.
//!
//! - a box has its own lattice ([`sample_convex`]);
//! - any other convex body has layers parallel to each face, bounded by the planes that bisect the
//!   angles to the other faces ([`sample_convex`]), an endless prism along its sides only
//!   ([`sample_prism`]);
//! - a sphere has layers of evenly distributed points ([`sample_sphere`]);
//! - fixed bodies that touch or overlap are one solid ([`sample_union`]);
//! - each face of a [thin solid](crate::neighbors::thin_solids) has its own layers ([`sample_behind`]), or the nearby ones ([`is_behind`])
//!   of the points of the shell, or of its side ([`sample_behind_side`]).

use nalgebra::Vector2;

use crate::Vec3;
use crate::boundary::integral::Face;
use polygon::{Piece, Polygon};

mod behind;
mod behind_surface;
mod cuboid;
mod layers;
mod polygon;
mod sphere;
mod union;

pub use behind::{Rows, is_behind, sample_behind, sample_behind_side};
pub use behind_surface::sample_behind_surface;
pub use sphere::sample_sphere;
pub use union::{Region, UnionLattice, UnionSample, sample_union};

/// A point of a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSample {
    /// In the frame of the faces; m.
    pub position: Vec3,
    /// m³.
    pub volume: f64,
}

/// A point of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceSample {
    /// In the frame of the face; m.
    pub position: Vec3,
    /// m².
    pub area: f64,
    /// Of its cell; m.
    pub size: Vector2<f64>,
}

/// Points of a convex face, one for its part of each of a grid of cells about `spacing` (m) wide; slivers of cells
/// belong to a neighbor. Areas add up to that of the face.
pub fn sample_face(face: &Face, spacing: f64) -> Vec<FaceSample> {
    let axes = Axes::along_longest_edge(face);
    let Some(corner) = face.vertices.first() else {
        return Vec::new();
    };
    let height = face.normal.dot(corner);
    let outline = Polygon::new(face.vertices.iter().map(|p| axes.plane(p)).collect());
    let cells = layers::cells_of(&outline, spacing);
    let pieces = outline.pieces(&cells, layers::LEAST_SHARE * spacing * spacing);
    let sample = |piece: &Piece| FaceSample {
        position: axes.u * piece.centroid.x + axes.v * piece.centroid.y + face.normal * height,
        area: piece.area,
        size: cells.size,
    };
    pieces.iter().map(sample).collect()
}

/// A convex face cut by a grid of cells about `spacing` (m) wide: the polygons, each with its centroid.
pub fn tiles(face: &Face, spacing: f64) -> Vec<(Vec<Vec3>, Vec3)> {
    let axes = Axes::along_longest_edge(face);
    let Some(corner) = face.vertices.first() else {
        return Vec::new();
    };
    let height = face.normal.dot(corner);
    let outline = Polygon::new(face.vertices.iter().map(|p| axes.plane(p)).collect());
    let place = |p: &Vector2<f64>| axes.u * p.x + axes.v * p.y + face.normal * height;
    let tiles = outline.in_cells(layers::cells_of(&outline, spacing));
    let tiles = tiles.filter_map(|tile| {
        let centroid = tile.piece()?.centroid;
        Some((tile.corners().iter().map(place).collect(), place(&centroid)))
    });
    tiles.collect()
}

/// Points of the shell of a convex body, in the frame of its faces.
///
/// A body with rectangular faces at right angles, in any orientation, gets the lattice of a box;
/// any other gets layers along its faces. Both lengths in m, above zero. Volumes add up to that of
/// the shell.
pub fn sample_convex(
    faces: &[Face],
    particle_spacing: f64,
    support_radius: f64,
) -> Vec<WallSample> {
    let n_layers = n_layers(particle_spacing, support_radius);
    cuboid::samples(faces, particle_spacing, n_layers)
        .or_else(|| layers_of(faces, particle_spacing, n_layers))
        .unwrap_or_else(|| layers::whole(faces))
}

/// As [`sample_convex`], for a prism along an axis that continues beyond its ends: layers are along its sides only. `None` for a
/// body whose other faces are not along the axis.
pub fn sample_prism(
    faces: &[Face],
    axis: usize,
    particle_spacing: f64,
    support_radius: f64,
) -> Option<Vec<WallSample>> {
    let n_layers = n_layers(particle_spacing, support_radius);
    let (ends, sides): (Vec<Face>, Vec<Face>) =
        faces.iter().partition(|face| 0.5 < face.normal[axis].abs());
    let is_along = |face: &Face| face.normal[axis].abs() < UPRIGHT;
    let is_across = |face: &Face| 1.0 - UPRIGHT < face.normal[axis].abs();
    if !(ends.iter().all(is_across) && sides.iter().all(is_along)) {
        return None;
    }
    let samples = cuboid::samples(faces, particle_spacing, n_layers)
        .or_else(|| layers_of(&sides, particle_spacing, n_layers))
        .unwrap_or_else(|| layers::whole(faces));
    Some(samples)
}

fn layers_of(faces: &[Face], particle_spacing: f64, n_layers: usize) -> Option<Vec<WallSample>> {
    let samples = layers::samples(faces, particle_spacing, n_layers);
    (!samples.is_empty()).then_some(samples)
}

/// Cosine below which a face is along an axis.
const UPRIGHT: f64 = 1e-9;

/// `⌈R/dp⌉`, tolerant to round-off of a whole ratio.
fn n_layers(particle_spacing: f64, support_radius: f64) -> usize {
    (support_radius / particle_spacing - 1e-9).ceil().max(1.0) as usize
}

/// Whole cells of about `spacing` along a length: their number and size.
fn cells_along(length: f64, spacing: f64) -> (usize, f64) {
    let n = (length / spacing).round().max(1.0);
    (n as usize, length / n)
}

/// Two directions in the plane of a face.
#[derive(Clone, Copy, Debug)]
struct Axes {
    u: Vec3,
    v: Vec3,
}

impl Axes {
    /// With `u` along the longest edge.
    fn along_longest_edge(face: &Face) -> Self {
        let next = face.vertices.iter().cycle().skip(1);
        let longest = face
            .vertices
            .iter()
            .zip(next)
            .map(|(p, q)| q - p)
            .max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
        let u = longest.unwrap_or_default().normalize();
        Self {
            u,
            v: face.normal.cross(&u),
        }
    }

    /// With `u` along the axis of coordinates nearest to the plane, so that faces parallel to an
    /// axis share it.
    fn along_coordinates(normal: &Vec3) -> Self {
        let axis = normal.iamin();
        let mut unit = Vec3::zeros();
        unit[axis] = 1.0;
        let u = (unit - normal * normal[axis]).normalize();
        let mut v = normal.cross(&u);
        if v[v.iamax()] < 0.0 {
            // the other way along v, so that faces of either sense have one lattice
            v = -v;
        }
        Self { u, v }
    }

    fn plane(&self, x: &Vec3) -> Vector2<f64> {
        Vector2::new(self.u.dot(x), self.v.dot(x))
    }
}

#[cfg(test)]
#[expect(
    clippy::print_stdout,
    reason = "measured figures stand beside their bounds"
)]
mod tests;
