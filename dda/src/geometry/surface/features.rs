//! Features of a surface that stick out: vertices and ridges.

use super::{NONE, Surface};
use crate::Vec3;

/// Sine by which a side must bend to be a ridge, and a spoke must fall for its vertex to stick out.
const BEND: f64 = 1e-6;

/// A convex edge between two triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ridge {
    pub from: Vec3,
    /// From one end to the other; m.
    pub along: Vec3,
    /// Sum of the normals of both triangles.
    pub outward: Vec3,
    /// From the ridge into both triangles, unit.
    pub falls: [Vec3; 2],
}

impl Ridge {
    /// Does the surface fall on both sides, seen along a unit direction into it?
    pub fn is_farthest(&self, into: &Vec3) -> bool {
        self.falls.iter().all(|fall| -BEND <= fall.dot(into))
    }
}

impl Surface {
    /// Ridges of some triangles, each once if both of its triangles are among them.
    pub(crate) fn ridges<'a>(&'a self, triangles: &'a [u32]) -> impl Iterator<Item = Ridge> + 'a {
        let sides = triangles.iter().flat_map(|&t| [(t, 0), (t, 1), (t, 2)]);
        sides.filter_map(|(triangle, side)| self.ridge(triangle, side, triangles))
    }

    /// Ridge of a side, unless that is the side of a lower triangle, too.
    fn ridge(&self, triangle: u32, side: usize, triangles: &[u32]) -> Option<Ridge> {
        let t = triangle as usize;
        let other = self.neighbor[t][side];
        if other == NONE || (other < triangle && triangles.binary_search(&other).is_ok()) {
            return None;
        }
        let corners = self.triangles[t];
        let [from, to] =
            [corners[side], corners[(side + 1) % 3]].map(|v| self.vertices[v as usize]);
        let along = to - from;
        let (n, m) = (self.normal[t], self.normal[other as usize]);
        let falls = [n.cross(&along), -m.cross(&along)].map(|fall| fall.normalize());
        let is_convex = falls[1].dot(&n) < -BEND;
        is_convex.then_some(Ridge {
            from,
            along,
            outward: n + m,
            falls,
        })
    }

    /// Numbers of the corners of some triangles, ascending, each once.
    pub(crate) fn corners_of(&self, triangles: &[u32], corners: &mut Vec<u32>) {
        corners.clear();
        corners.extend(triangles.iter().flat_map(|&t| self.triangles[t as usize]));
        corners.sort_unstable();
        corners.dedup();
    }

    /// Does a vertex stick out, seen along a unit direction into the surface: no edge rises from it by more than a sine, and one falls?
    pub(crate) fn sticks_out(&self, vertex: u32, into: &Vec3, sine: f64) -> bool {
        let v = vertex as usize;
        let spokes = self.spokes_start[v] as usize..self.spokes_start[v + 1] as usize;
        let mut falls = false;
        for &end in &self.spokes[spokes] {
            let spoke = self.vertices[end as usize] - self.vertices[v];
            let (fall, length) = (spoke.dot(into), spoke.norm());
            if fall < -sine * length {
                return false;
            }
            falls |= BEND * length < fall;
        }
        falls && 0.0 < -self.vertex_normal[v].dot(into)
    }
}
