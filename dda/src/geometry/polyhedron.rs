//! Convex polyhedra: half-edge topology in flat arrays, constructors that check, walks as iterators.
//!
//! A [`Polyhedron`] is closed, oriented (faces counter-clockwise seen from outside), has planar
//! faces, positive volume, and is convex. A non-convex body is a rigid union of several: see
//! [`Polyhedron::extrusion`] and [`Shape::Polyhedra`](crate::Shape::Polyhedra).
//!
//! The half-edges of one face lie next to each other, in the order of its loop. Half-edge `e` runs
//! from `origin(e)` to `origin(next(e))`, and `twin(e)` runs back along it in the neighboring face.

mod build;
mod extrusion;
mod hull;
pub(crate) mod integrals;
#[cfg(test)]
mod tests;

use crate::{Isometry, Vec3};
pub use build::PolyhedronError;
use nalgebra::{Matrix3, UnitQuaternion};

/// A closed convex polyhedron, in body or world coordinates; m.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyhedron {
    /// Corners; m.
    vertices: Vec<Vec3>,
    /// Vertex that a half-edge leaves; one per half-edge.
    origin: Vec<u32>,
    /// The half-edge that runs back along the same edge; one per half-edge.
    twin: Vec<u32>,
    /// Face to the left of a half-edge, seen from outside; one per half-edge.
    face: Vec<u32>,
    /// First half-edge of each face, and at the end the number of half-edges; n_faces + 1.
    face_start: Vec<u32>,
    /// Outward unit normals; one per face.
    face_normal: Vec<Vec3>,
    /// `normal · x` of the points of a face; one per face; m.
    face_offset: Vec<f64>,
    /// One half-edge that leaves the vertex; one per vertex.
    outgoing: Vec<u32>,
    /// Is the face covered by other bodies that move with this one? One per face; written by `parts`.
    is_hidden: Vec<bool>,
    /// Corners of such bodies that hold a vertex of this one, or the middle of an edge, from there;
    /// packed; m.
    beyond: Vec<Vec3>,
    /// Start of those of each vertex, then of each half-edge; n_vertices + n_half_edges + 1.
    beyond_start: Vec<u32>,
    /// Cube root of the volume, the length that tolerances refer to; m.
    size: f64,
}

/// A neighbor that rises by less than this sine above a vertex continues its surface.
const SEAM_SINE: f64 = 1e-3;
/// Cosine of two degrees, by which a ridge may bend where it crosses a seam.
const BEND_COSINE: f64 = 0.999_390_8;

impl Polyhedron {
    /// The polyhedron, rotated and translated.
    pub fn transformed(&self, placement: &Isometry) -> Self {
        let mut moved = self.clone();
        moved.set_transformed(self, placement);
        moved
    }

    /// Becomes `reference` rotated and translated; both have the same topology. Allocates nothing.
    pub(crate) fn set_transformed(&mut self, reference: &Self, placement: &Isometry) {
        let rotation = placement.rotation.to_rotation_matrix();
        let shift = placement.translation.vector;
        for (x, x_ref) in self.vertices.iter_mut().zip(&reference.vertices) {
            *x = rotation * x_ref + shift;
        }
        for (n, n_ref) in self.face_normal.iter_mut().zip(&reference.face_normal) {
            *n = rotation * n_ref;
        }
        for (to, to_ref) in self.beyond.iter_mut().zip(&reference.beyond) {
            *to = rotation * to_ref;
        }
        for ((offset, offset_ref), n) in self
            .face_offset
            .iter_mut()
            .zip(&reference.face_offset)
            .zip(&self.face_normal)
        {
            *offset = offset_ref + n.dot(&shift);
        }
    }

    /// Becomes `reference` under `x = shift + gradient X`: corners by the map, normals by its
    /// inverse transpose. Allocates nothing.
    pub(crate) fn set_deformed(&mut self, reference: &Self, gradient: &Matrix3<f64>, shift: &Vec3) {
        let normals = gradient
            .try_inverse()
            .unwrap_or_else(Matrix3::identity)
            .transpose();
        for (x, x_ref) in self.vertices.iter_mut().zip(&reference.vertices) {
            *x = gradient * x_ref + shift;
        }
        for (to, to_ref) in self.beyond.iter_mut().zip(&reference.beyond) {
            *to = gradient * to_ref;
        }
        for face in 0..self.face_normal.len() {
            let normal = normals * reference.face_normal[face];
            let length = normal.norm();
            self.face_normal[face] = normal / length;
            self.face_offset[face] =
                reference.face_offset[face] / length + self.face_normal[face].dot(shift);
        }
    }

    /// Corners; m.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Number of faces.
    pub fn n_faces(&self) -> usize {
        self.face_normal.len()
    }

    /// Number of edges, half the number of half-edges.
    pub fn n_edges(&self) -> usize {
        self.origin.len() / 2
    }

    /// Cube root of the volume; m.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Smallest thickness, measured across faces; m.
    pub fn thickness(&self) -> f64 {
        (0..self.n_faces())
            .map(|face| {
                let depth = |x: &Vec3| -self.plane_distance(face, x);
                self.vertices().iter().map(depth).fold(0.0, f64::max)
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Vertex that the half-edge leaves.
    pub fn origin(&self, half_edge: u32) -> u32 {
        self.origin[half_edge as usize]
    }

    /// Vertex that the half-edge reaches.
    pub fn target(&self, half_edge: u32) -> u32 {
        self.origin(self.twin(half_edge))
    }

    /// The half-edge that runs back along the same edge.
    pub fn twin(&self, half_edge: u32) -> u32 {
        self.twin[half_edge as usize]
    }

    /// The half-edge that follows in the loop of the same face.
    pub fn next(&self, half_edge: u32) -> u32 {
        let face = self.face[half_edge as usize] as usize;
        let after = half_edge + 1;
        if after < self.face_start[face + 1] {
            after
        } else {
            self.face_start[face]
        }
    }

    /// Face to the left of the half-edge, seen from outside.
    pub fn face_of(&self, half_edge: u32) -> usize {
        self.face[half_edge as usize] as usize
    }

    /// Half-edges of a face, counter-clockwise seen from outside.
    pub fn face_loop(&self, face: usize) -> impl Iterator<Item = u32> + '_ {
        self.face_start[face]..self.face_start[face + 1]
    }

    /// Corners of a face, counter-clockwise seen from outside.
    pub fn face_vertices(&self, face: usize) -> impl Iterator<Item = u32> + '_ {
        self.loop_origins(face).iter().copied()
    }

    /// Corners of a face as a slice.
    pub(crate) fn loop_origins(&self, face: usize) -> &[u32] {
        &self.origin[self.face_start[face] as usize..self.face_start[face + 1] as usize]
    }

    /// Number of face loops; right even before the planes are known.
    pub(crate) fn loop_count(&self) -> usize {
        self.face_start.len() - 1
    }

    /// Half-edges that leave a vertex, one per edge that meets there.
    pub fn edges_around_vertex(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.outgoing[vertex as usize];
        std::iter::successors(Some(first), move |&e| {
            Some(self.next(self.twin(e))).filter(|&after| after != first)
        })
    }

    /// Faces that meet at a vertex.
    pub fn faces_around_vertex(&self, vertex: u32) -> impl Iterator<Item = usize> + '_ {
        self.edges_around_vertex(vertex).map(|e| self.face_of(e))
    }

    /// Faces across the edges of a face, in the order of its loop.
    pub fn faces_around_face(&self, face: usize) -> impl Iterator<Item = usize> + '_ {
        self.face_loop(face).map(|e| self.face_of(self.twin(e)))
    }

    /// One half-edge of every edge.
    pub fn edges(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.origin.len() as u32).filter(|&e| e < self.twin(e))
    }

    /// All half-edges.
    pub(crate) fn half_edges(&self) -> std::ops::Range<u32> {
        0..self.origin.len() as u32
    }

    /// Outward unit normal of a face.
    pub fn face_normal(&self, face: usize) -> Vec3 {
        self.face_normal[face]
    }

    /// `normal · x` of the points of a face; m.
    pub fn face_offset(&self, face: usize) -> f64 {
        self.face_offset[face]
    }

    /// Marks a face as covered: nothing can touch it.
    pub(crate) fn hide_face(&mut self, face: usize) {
        self.is_hidden[face] = true;
    }

    pub(crate) fn is_hidden(&self, face: usize) -> bool {
        self.is_hidden[face]
    }

    /// Extent of neighbors from each vertex, then from the middle of each half-edge (the lower of two
    /// twins); m.
    pub(crate) fn set_beyond(&mut self, beyond: &[Vec<Vec3>]) {
        self.beyond.clear();
        self.beyond_start.clear();
        self.beyond_start.push(0);
        for offsets in beyond {
            self.beyond.extend_from_slice(offsets);
            self.beyond_start.push(self.beyond.len() as u32);
        }
    }

    /// Copies the neighbor data of the same body in another orientation.
    pub(crate) fn copy_neighbors(&mut self, other: &Self, turn: &UnitQuaternion<f64>) {
        self.is_hidden.clone_from(&other.is_hidden);
        self.beyond_start.clone_from(&other.beyond_start);
        self.beyond = other.beyond.iter().map(|offset| turn * offset).collect();
    }

    /// Whether other surfaces continue from any of its corners.
    pub(crate) fn has_seams(&self) -> bool {
        !self.beyond.is_empty()
    }

    /// Is the vertex, which is this body's farthest in a direction, also the farthest of the bodies
    /// that hold it? If not, it lies on a seam inside a larger surface.
    pub(crate) fn is_corner(&self, vertex: u32, direction: &Vec3) -> bool {
        self.is_farthest(vertex, direction, SEAM_SINE)
    }

    /// Is an edge, which is this body's farthest in a direction, a ridge of the bodies that hold its ends, too? Where another body
    /// carries it on it may be bent: cut and rounded, a ridge that crosses a seam has a dent there as often as a bulge.
    pub(crate) fn is_ridge(&self, half_edge: u32, direction: &Vec3) -> bool {
        [half_edge, self.twin(half_edge)].into_iter().all(|e| {
            let end = self.target(e);
            let along = self.vertices[end as usize] - self.vertices[self.origin(e) as usize];
            let length = along.norm();
            self.offsets(end as usize).iter().all(|offset| {
                let reach = offset.norm();
                offset.dot(direction) <= SEAM_SINE * reach
                    || offset.dot(&along) >= BEND_COSINE * reach * length
            })
        })
    }

    /// Does no body that holds the vertex rise above it in a direction by more than a sine?
    pub(crate) fn is_farthest(&self, vertex: u32, direction: &Vec3, sine: f64) -> bool {
        self.rises_above_none(vertex as usize, direction, sine)
    }

    /// Does no body that holds the middle of the edge rise above it in a direction by more than a sine?
    pub(crate) fn is_farthest_edge(&self, half_edge: u32, direction: &Vec3, sine: f64) -> bool {
        let edge = half_edge.min(self.twin(half_edge));
        self.rises_above_none(self.vertices.len() + edge as usize, direction, sine)
    }

    fn rises_above_none(&self, row: usize, direction: &Vec3, sine: f64) -> bool {
        self.offsets(row)
            .iter()
            .all(|offset| offset.dot(direction) <= sine * offset.norm())
    }

    /// Extent of neighbors from a vertex, or from the middle of a half-edge after all vertices; m.
    fn offsets(&self, row: usize) -> &[Vec3] {
        &self.beyond[self.beyond_start[row] as usize..self.beyond_start[row + 1] as usize]
    }

    /// Distance of a point from the plane of a face, positive outside; m.
    pub fn plane_distance(&self, face: usize, x: &Vec3) -> f64 {
        self.face_normal[face].dot(x) - self.face_offset[face]
    }

    /// Lower and upper corner of the axis-aligned box around it; m.
    pub fn aabb(&self) -> (Vec3, Vec3) {
        let mut lower = self.vertices[0];
        let mut upper = lower;
        for x in &self.vertices {
            lower = lower.inf(x);
            upper = upper.sup(x);
        }
        (lower, upper)
    }
}
