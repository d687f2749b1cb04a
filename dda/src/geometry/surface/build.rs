//! Construction of a surface: checks, topology, and what follows from them.

use super::regions::{planes, ridges_beside};
use super::topology::{Around, edges_from_vertices, neighbors};
use super::{Divide, FLAT, NONE, Surface, aabb};
use crate::Vec3;
use crate::geometry::bounds::Bounds;
use parry3d_f64::{
    bounding_volume::Aabb,
    partitioning::{Bvh, BvhBuildStrategy},
};
use rayon::prelude::*;
use thiserror::Error;

/// Error of an invalid surface.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SurfaceError {
    /// Nothing to stand on.
    #[error("a surface needs at least one triangle")]
    Empty,
    /// A vertex is NaN or infinite.
    #[error("vertex {vertex} is not finite")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A triangle refers to a vertex that is not there.
    #[error("triangle {triangle} has vertex {vertex}, but there are only {n_vertices}")]
    NoSuchVertex {
        /// The triangle.
        triangle: usize,
        /// Its vertex.
        vertex: u32,
        /// Vertices given.
        n_vertices: usize,
    },
    /// A triangle has no area.
    #[error("triangle {triangle} has no area; its corners lie on a line")]
    Degenerate {
        /// The triangle.
        triangle: usize,
    },
    /// Two triangles run along an edge in the same direction.
    #[error(
        "triangles {first} and {second} run along the edge {from}-{to} in the same direction; turn one round, or part them where \
         three meet"
    )]
    Orientation {
        /// The lower triangle.
        first: usize,
        /// The higher triangle.
        second: usize,
        /// Ends of the edge.
        from: u32,
        /// Ends of the edge.
        to: u32,
    },
}

/// A triangle lower than this over its longest side has no area; –.
const SLIVER: f64 = 1e-9;

impl Surface {
    /// A surface of triangles, counter-clockwise seen from outside (m).
    ///
    /// # Errors
    ///
    /// [`SurfaceError`] names the first vertex or triangle that is unusable.
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, SurfaceError> {
        check_triangles(&vertices, &triangles)?;
        let around = Around::new(vertices.len(), &triangles);
        let neighbor = neighbors(&triangles, &around)?;
        Ok(Self::measured(vertices, (triangles, around), neighbor))
    }

    /// The surface of a topology: normals, regions behind the triangles, and the tree of boxes.
    pub(super) fn measured(
        vertices: Vec<Vec3>,
        (triangles, around): (Vec<[u32; 3]>, Around),
        neighbor: Vec<[u32; 3]>,
    ) -> Self {
        let corners = |triangle: &[u32; 3]| triangle.map(|v| vertices[v as usize]);
        let normal: Vec<Vec3> = triangles
            .par_iter()
            .map(|triangle| {
                let [a, b, c] = corners(triangle);
                (b - a).cross(&(c - a)).normalize()
            })
            .collect();
        let offset = triangles
            .iter()
            .zip(&normal)
            .map(|(triangle, n)| n.dot(&vertices[triangle[0] as usize]))
            .collect();
        let divide: Vec<[Divide; 3]> = (0..triangles.len())
            .into_par_iter()
            .map(|t| {
                [0, 1, 2].map(|k| {
                    let side = [triangles[t][k], triangles[t][(k + 1) % 3]];
                    let ends = side.map(|v| vertices[v as usize]);
                    bisecting_plane(ends, (t, neighbor[t][k]), &normal)
                })
            })
            .collect();
        let (ridges_start, ridges) = ridges_beside(
            (&vertices, &triangles, &normal),
            (&around, &neighbor, &divide),
        );
        let (spokes_start, spokes) = edges_from_vertices(&triangles, &around);
        let boxes: Vec<Bounds> = triangles
            .iter()
            .map(|triangle| {
                let [a, b, c] = corners(triangle);
                (a.inf(&b).inf(&c), a.sup(&b).sup(&c))
            })
            .collect();
        let leaves: Vec<Aabb> = boxes.iter().map(aabb).collect();
        Self {
            plane: planes(&normal, &neighbor),
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves),
            boxes,
            vertex_normal: vertex_normals(&vertices, (&triangles, &around), &normal),
            bounds: bounds(&vertices, &triangles),
            vertices,
            triangles,
            normal,
            offset,
            neighbor,
            divide,
            ridges_start,
            ridges,
            spokes_start,
            spokes,
        }
    }
}

fn check_triangles(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Result<(), SurfaceError> {
    if triangles.is_empty() {
        return Err(SurfaceError::Empty);
    }
    if let Some(vertex) = (0..vertices.len()).find(|&v| !vertices[v].iter().all(|c| c.is_finite()))
    {
        return Err(SurfaceError::NotFinite { vertex });
    }
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices.len()) {
            return Err(SurfaceError::NoSuchVertex {
                triangle,
                vertex,
                n_vertices: vertices.len(),
            });
        }
        let [a, b, c] = corners.map(|v| vertices[v as usize]);
        let longest = [b - a, c - b, a - c].map(|s| s.norm_squared());
        let longest = longest.into_iter().fold(0.0, f64::max);
        // NaN counts as no area
        if !((b - a).cross(&(c - a)).norm() > SLIVER * longest) {
            return Err(SurfaceError::Degenerate { triangle });
        }
    }
    Ok(())
}

/// Plane through a side of triangle `t` that bisects the angle with its neighbor `other`: outward unit normal and offset.
fn bisecting_plane([from, to]: [Vec3; 2], (t, other): (usize, u32), normal: &[Vec3]) -> Divide {
    // that of the lower triangle, reversed for the higher: both share it to the bit
    let (from, to, sign) = if (other as usize) < t {
        (to, from, -1.0)
    } else {
        (from, to, 1.0)
    };
    let along = to - from;
    let (lower, higher) = match other {
        NONE => (t, t),
        other => (t.min(other as usize), t.max(other as usize)),
    };
    let middle = normal[lower] + normal[higher];
    let outward = along.cross(&middle);
    let size = outward.norm();
    // folded flat on itself: no plane bisects the angle, the edge of the triangle itself bounds it
    let outward = if size > FLAT * along.norm() {
        outward * (sign / size)
    } else {
        along.cross(&normal[t]).normalize() * sign
    };
    (outward, outward.dot(&from))
}

/// Sum of the normals around each vertex, weighted with the angle of the triangle there.
fn vertex_normals(
    vertices: &[Vec3],
    (triangles, around): (&[[u32; 3]], &Around),
    normal: &[Vec3],
) -> Vec<Vec3> {
    let of = |vertex: usize| {
        let mut sum = Vec3::zeros();
        for (t, k) in around.of(vertex as u32) {
            let [next, last] = [k + 1, k + 2].map(|i| triangles[t][i % 3]);
            let x = vertices[vertex];
            let (forth, back) = (vertices[next as usize] - x, vertices[last as usize] - x);
            sum += normal[t] * forth.angle(&back);
        }
        sum
    };
    (0..vertices.len()).into_par_iter().map(of).collect()
}

/// Box around the triangles; m.
fn bounds(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Bounds {
    triangles
        .iter()
        .flatten()
        .map(|&v| vertices[v as usize])
        .fold(
            (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)),
            |all, x| (all.0.inf(&x), all.1.sup(&x)),
        )
}
