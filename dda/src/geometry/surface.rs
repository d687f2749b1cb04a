//! Terrain and other fixed surfaces: triangles, solid on the side away from their normals.

mod build;
mod closest;
mod features;
mod regions;
mod topology;

use crate::geometry::bounds::Bounds;
use crate::{Isometry, Vec3};
pub use build::SurfaceError;
pub(crate) use closest::{Checked, NearTriangles};
pub(crate) use features::Ridge;
use parry3d_f64::{
    bounding_volume::{Aabb, BoundingVolume},
    math::Vector,
    partitioning::Bvh,
};
use topology::Around;

/// A plane by its unit normal and offset; m.
type Divide = (Vec3, f64);

/// Triangles that meet edge to edge, open or closed. Bodies are kept on the side of the normals.
///
/// The space behind the surface is divided among the triangles by the planes that bisect the angles at
/// their edges: a point belongs to the triangle whose plane is nearest there, and its depth is continuous
/// from one to the next. The plane at a sharp ridge bounds the region of the triangles next to it, and of those beyond that
/// continue almost in their plane: behind a sliver along a ridge the other side is soon nearer than the region after the sliver.
#[derive(Clone, Debug)]
pub struct Surface {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Unit, outward; one per triangle.
    normal: Vec<Vec3>,
    /// `n · x` on the triangle; m.
    offset: Vec<f64>,
    /// Across the side from vertex k to the next; `NONE` at the rim.
    neighbor: Vec<[u32; 3]>,
    /// Plane through the side that bisects the angle, outward unit normal and offset.
    divide: Vec<[Divide; 3]>,
    /// Such planes at ridges of triangles beside each.
    ridges_start: Vec<u32>,
    ridges: Vec<Divide>,
    /// Triangles of one plane have one number.
    plane: Vec<u32>,
    /// Sum of the normals around a vertex, by angle.
    vertex_normal: Vec<Vec3>,
    /// Ends of the edges that leave a vertex.
    spokes_start: Vec<u32>,
    spokes: Vec<u32>,
    tree: Bvh,
    /// Of each triangle; m.
    boxes: Vec<Bounds>,
    bounds: Bounds,
}

impl PartialEq for Surface {
    fn eq(&self, other: &Self) -> bool {
        self.vertices == other.vertices && self.triangles == other.triangles
    }
}

/// No triangle.
const NONE: u32 = u32::MAX;
/// Largest angle between coplanar neighbors and the first triangle of their plane; rad.
const FLAT: f64 = 1e-7;

impl Surface {
    /// The surface, rotated and translated.
    pub fn transformed(&self, placement: &Isometry) -> Self {
        let vertices: Vec<Vec3> = self
            .vertices
            .iter()
            .map(|x| placement.transform_point(&(*x).into()).coords)
            .collect();
        let around = Around::new(self.vertices.len(), &self.triangles);
        let triangles = (self.triangles.clone(), around);
        Self::measured(vertices, triangles, self.neighbor.clone())
    }

    /// Corners; m.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Corners of each triangle, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Lower and upper corner of the box around it; m.
    pub fn aabb(&self) -> (Vec3, Vec3) {
        self.bounds
    }

    pub(crate) fn normal(&self, triangle: u32) -> &Vec3 {
        &self.normal[triangle as usize]
    }

    /// Height of a point over the plane of a triangle, negative behind it; m.
    pub(crate) fn height(&self, triangle: u32, x: &Vec3) -> f64 {
        self.normal[triangle as usize].dot(x) - self.offset[triangle as usize]
    }

    pub(crate) fn offset(&self, triangle: u32) -> f64 {
        self.offset[triangle as usize]
    }

    /// The planes that bound the region of a triangle.
    pub(crate) fn divides(&self, triangle: u32) -> impl Iterator<Item = &Divide> {
        let t = triangle as usize;
        let (from, to) = (self.ridges_start[t], self.ridges_start[t + 1]);
        self.divide[t]
            .iter()
            .chain(&self.ridges[from as usize..to as usize])
    }

    /// Number of the plane that a triangle lies in.
    pub(crate) fn plane(&self, triangle: u32) -> u32 {
        self.plane[triangle as usize]
    }

    /// Triangles whose boxes overlap a box, in ascending order.
    pub(crate) fn near(&self, bounds: &Bounds, triangles: &mut Vec<u32>) {
        let wanted = aabb(bounds);
        triangles.clear();
        triangles.extend(self.tree.leaves(|node| node.aabb().intersects(&wanted)));
        triangles.sort_unstable();
    }
}

fn aabb(bounds: &Bounds) -> Aabb {
    let vector = |x: &Vec3| Vector::new(x.x, x.y, x.z);
    Aabb::new(vector(&bounds.0), vector(&bounds.1))
}
