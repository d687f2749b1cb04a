//! Topology of a surface: triangles around each vertex, neighbors across sides, edges.

use super::NONE;
use super::build::SurfaceError;
use rayon::prelude::*;

/// Corners of triangles by vertex, packed.
pub(super) struct Around {
    start: Vec<u32>,
    /// Three times the triangle plus the number of its corner, in ascending order.
    corners: Vec<u32>,
}

impl Around {
    pub(super) fn new(n_vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let mut start = vec![0; n_vertices + 1];
        for &v in triangles.as_flattened() {
            start[v as usize + 1] += 1;
        }
        for v in 0..n_vertices {
            start[v + 1] += start[v];
        }
        let mut next = start.clone();
        let mut corners = vec![0; 3 * triangles.len()];
        for (corner, &v) in (0..).zip(triangles.as_flattened()) {
            corners[next[v as usize] as usize] = corner;
            next[v as usize] += 1;
        }
        Self { start, corners }
    }

    /// Triangles around a vertex, in ascending order, with the number of their corner there.
    pub(super) fn of(&self, vertex: u32) -> impl Iterator<Item = (usize, usize)> + '_ {
        let v = vertex as usize;
        self.corners[self.start[v] as usize..self.start[v + 1] as usize]
            .iter()
            .map(|&corner| (corner as usize / 3, corner as usize % 3))
    }

    fn n_vertices(&self) -> usize {
        self.start.len() - 1
    }
}

/// Neighbor of each triangle across each of its sides, [`NONE`] at the rim.
pub(super) fn neighbors(
    triangles: &[[u32; 3]],
    around: &Around,
) -> Result<Vec<[u32; 3]>, SurfaceError> {
    // sides that leave each vertex: far end and triangle, sorted
    let mut sides: Vec<(u32, u32)> = (around.corners.par_iter())
        .map(|&corner| {
            let (t, k) = (corner as usize / 3, corner as usize % 3);
            (triangles[t][(k + 1) % 3], t as u32)
        })
        .collect();
    let mut twice: Option<(u32, u32, u32, u32)> = None;
    for v in 0..around.n_vertices() {
        let from = &mut sides[around.start[v] as usize..around.start[v + 1] as usize];
        from.sort_unstable();
        for pair in from.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            let ((to, first), (_, second)) = (pair[0], pair[1]);
            let corners = &triangles[second as usize];
            let k = (0..3)
                .find(|&k| corners[k as usize] == v as u32)
                .unwrap_or(0);
            let is_earlier = twice.is_none_or(|(t, side, ..)| (second, k) < (t, side));
            if is_earlier {
                twice = Some((second, k, first, to));
            }
        }
    }
    if let Some((second, k, first, to)) = twice {
        return Err(SurfaceError::Orientation {
            first: first as usize,
            second: second as usize,
            from: triangles[second as usize][k as usize],
            to,
        });
    }
    let across = |from: u32, to: u32| {
        let v = from as usize;
        let sides = &sides[around.start[v] as usize..around.start[v + 1] as usize];
        let found = sides.binary_search_by_key(&to, |side| side.0);
        found.map_or(NONE, |side| sides[side].1)
    };
    let all = triangles.par_iter();
    Ok(all
        .map(|corners| [0, 1, 2].map(|k| across(corners[(k + 1) % 3], corners[k])))
        .collect())
}

/// Edges that leave each vertex: start of those of each vertex, and the far ends of all.
pub(super) fn edges_from_vertices(triangles: &[[u32; 3]], around: &Around) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0];
    // an edge within the surface is named by both of its triangles
    let mut all = Vec::with_capacity(3 * triangles.len() + around.n_vertices());
    let mut ends = Vec::new();
    for vertex in 0..around.n_vertices() as u32 {
        ends.clear();
        for (t, k) in around.of(vertex) {
            ends.extend([triangles[t][(k + 1) % 3], triangles[t][(k + 2) % 3]]);
        }
        ends.sort_unstable();
        ends.dedup();
        all.extend_from_slice(&ends);
        start.push(all.len() as u32);
    }
    (start, all)
}
