//! How well shaped blocks are: slivers and short edges cost time steps and stability.

use crate::{Polyhedron, Vec3, volume};

/// Shape of one convex block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockQuality {
    /// Volume; m³.
    pub volume: f64,
    /// Largest distance of two corners over the smallest thickness across a face.
    pub aspect: f64,
    /// m.
    pub shortest_edge: f64,
}

impl BlockQuality {
    /// Of a convex block.
    pub fn of(body: &Polyhedron) -> Self {
        let corners = body.vertices();
        let longest = corners
            .iter()
            .enumerate()
            .flat_map(|(k, a)| corners[k + 1..].iter().map(move |b| (b - a).norm()))
            .fold(0.0, f64::max);
        let thickness = (0..body.n_faces())
            .map(|face| {
                let depth = |x: &Vec3| -body.plane_distance(face, x);
                corners.iter().map(depth).fold(0.0, f64::max)
            })
            .fold(f64::INFINITY, f64::min);
        let edge =
            |e: u32| (corners[body.target(e) as usize] - corners[body.origin(e) as usize]).norm();
        Self {
            volume: volume(body),
            aspect: longest / thickness,
            shortest_edge: body.edges().map(edge).fold(f64::INFINITY, f64::min),
        }
    }
}
