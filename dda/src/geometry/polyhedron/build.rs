//! From vertices and face loops to a checked [`Polyhedron`].

use super::{Polyhedron, integrals};
use crate::Vec3;
use thiserror::Error;

/// A face may leave its plane, and a vertex may stand out of a face's plane, by this much; × L,
/// the cube root of the volume.
pub(super) const PLANE_TOLERANCE: f64 = 1e-6;
/// Vertices closer than this are repeated; × L.
const REPEAT_TOLERANCE: f64 = 1e-9;

/// Error of an invalid polyhedron.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PolyhedronError {
    /// Fewer than four vertices or faces.
    #[error("a polyhedron needs at least 4 vertices and 4 faces, got {n_vertices} and {n_faces}")]
    TooFew {
        /// Vertices given.
        n_vertices: usize,
        /// Faces given.
        n_faces: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A face has fewer than three corners.
    #[error("face {face} has {n} corners, needs at least 3")]
    FaceTooSmall {
        /// The face.
        face: usize,
        /// Its corners.
        n: usize,
    },
    /// A face names a vertex that is not there.
    #[error("face {face} names vertex {vertex}, but there are only {n_vertices} (0 to {})", n_vertices - 1)]
    NoSuchVertex {
        /// The face.
        face: usize,
        /// The vertex it names.
        vertex: u32,
        /// Vertices given.
        n_vertices: usize,
    },
    /// A face passes a vertex twice.
    #[error("face {face} passes vertex {vertex} twice")]
    RepeatedCorner {
        /// The face.
        face: usize,
        /// The vertex.
        vertex: u32,
    },
    /// A vertex belongs to no face.
    #[error("vertex {vertex} belongs to no face; remove it")]
    UnusedVertex {
        /// The vertex.
        vertex: usize,
    },
    /// Two vertices coincide.
    #[error(
        "vertices {first} and {second} are {distance:e} m apart, less than {limit:e} m; merge them"
    )]
    RepeatedVertex {
        /// The lower one.
        first: usize,
        /// The higher one.
        second: usize,
        /// Their distance; m.
        distance: f64,
        /// The least distance; m.
        limit: f64,
    },
    /// An edge has a face on one side only.
    #[error("the surface is open: edge {from}-{to} of face {face} has no face on its other side")]
    OpenEdge {
        /// Start of the edge.
        from: u32,
        /// End of the edge.
        to: u32,
        /// The face that has it.
        face: usize,
    },
    /// Two faces run in the same direction along an edge.
    #[error(
        "faces {first} and {second} both run along edge {from}-{to} in the same sense; reverse one of \
         them, or split the body where more than two faces meet"
    )]
    EdgeUsedTwice {
        /// Start of the edge.
        from: u32,
        /// End of the edge.
        to: u32,
        /// One face.
        first: usize,
        /// The other.
        second: usize,
    },
    /// The surface is not one closed shell without handles.
    #[error(
        "V - E + F = {n_vertices} - {n_edges} + {n_faces} = {characteristic}, not 2: the surface has several \
         shells, a hole or a pinched vertex; split it into simple bodies"
    )]
    EulerCharacteristic {
        /// V.
        n_vertices: usize,
        /// E.
        n_edges: usize,
        /// F.
        n_faces: usize,
        /// V − E + F.
        characteristic: i64,
    },
    /// A face is not planar.
    #[error(
        "face {face}: vertex {vertex} leaves its plane by {distance:e} m, more than {limit:e} m; split it into triangles"
    )]
    NotPlanar {
        /// The face.
        face: usize,
        /// The vertex that leaves its plane most.
        vertex: u32,
        /// By how much; m.
        distance: f64,
        /// Allowed; m.
        limit: f64,
    },
    /// A face has no area.
    #[error("face {face} has no area")]
    FlatFace {
        /// The face.
        face: usize,
    },
    /// The body has no volume.
    #[error("the volume is {volume:e} m³, not above {limit:e} m³; give the body a thickness")]
    NoVolume {
        /// The volume found; m³.
        volume: f64,
        /// Smallest that rounding cannot explain; m³.
        limit: f64,
    },
    /// The body is not convex.
    #[error(
        "not convex: vertex {vertex} stands {distance:e} m in front of face {face}; split the body into convex parts \
         (an extrusion is split by itself)"
    )]
    NotConvex {
        /// The face.
        face: usize,
        /// The vertex in front of it.
        vertex: u32,
        /// By how much; m.
        distance: f64,
    },
    /// The hull routine failed or returned a hull that does not hold its points.
    #[error("no convex hull of {n_points} points found: {reason}")]
    Hull {
        /// Points given.
        n_points: usize,
        /// Fault.
        reason: String,
    },
    /// Two edges of a polygon to be extruded cross or touch.
    #[error("edges {first} and {second} of the polygon cross or touch")]
    SelfIntersection {
        /// The edge that starts at this corner.
        first: usize,
        /// And the one that starts at this.
        second: usize,
    },
    /// A polygon to be extruded is unusable.
    #[error("polygon of {n} corners cannot be extruded: {reason}")]
    Polygon {
        /// Corners given.
        n: usize,
        /// Fault.
        reason: &'static str,
    },
}

impl Polyhedron {
    /// Builds and checks a polyhedron from its corners (m) and its face loops, counter-clockwise
    /// seen from outside. If all faces are clockwise they are reversed, all of them.
    ///
    /// # Errors
    ///
    /// Everything in [`PolyhedronError`] but the hull and polygon variants: the surface must be
    /// closed, manifold, consistently oriented, with V − E + F = 2, planar faces (1e-6 L, L the
    /// cube root of the volume), vertices at least 1e-9 L apart, positive volume, convex.
    pub fn from_faces(vertices: &[Vec3], faces: &[Vec<u32>]) -> Result<Self, PolyhedronError> {
        check_indices(vertices, faces)?;
        let mut this = topology(vertices.to_vec(), faces)?;
        this.check_euler()?;
        let extent = {
            let (lower, upper) = this.aabb();
            (upper - lower).norm()
        };
        let mut volume = integrals::volume(&this);
        if volume < 0.0 {
            let reversed: Vec<Vec<u32>> = faces
                .iter()
                .map(|face| face.iter().rev().copied().collect())
                .collect();
            this = topology(vertices.to_vec(), &reversed)?;
            volume = integrals::volume(&this);
        }
        // Rounding of the sums is some 1e-16 of the cube of the extent.
        let limit = 1e-14 * extent.powi(3);
        if volume.is_nan() || volume <= limit {
            return Err(PolyhedronError::NoVolume { volume, limit });
        }
        this.size = volume.cbrt();
        this.check_repeated()?;
        this.set_planes()?;
        this.check_convex()?;
        Ok(this)
    }

    /// The box between two corners; m. The corners may come in any order.
    ///
    /// # Errors
    ///
    /// [`PolyhedronError::NoVolume`] and [`PolyhedronError::NotFinite`].
    pub fn cuboid(min: Vec3, max: Vec3) -> Result<Self, PolyhedronError> {
        let (a, b) = (min.inf(&max), min.sup(&max));
        let vertices: Vec<Vec3> = (0..8)
            .map(|k| {
                Vec3::new(
                    if k & 1 == 0 { a.x } else { b.x },
                    if k & 2 == 0 { a.y } else { b.y },
                    if k & 4 == 0 { a.z } else { b.z },
                )
            })
            .collect();
        let faces = [
            [0, 2, 3, 1], // −z
            [4, 5, 7, 6], // +z
            [0, 1, 5, 4], // −y
            [2, 6, 7, 3], // +y
            [0, 4, 6, 2], // −x
            [1, 3, 7, 5], // +x
        ]
        .map(|face| face.to_vec());
        Self::from_faces(&vertices, &faces)
    }

    fn check_euler(&self) -> Result<(), PolyhedronError> {
        let (n_vertices, n_edges, n_faces) = (
            self.vertices.len(),
            self.n_edges(),
            self.face_start.len() - 1,
        );
        let characteristic = n_vertices as i64 - n_edges as i64 + n_faces as i64;
        if characteristic == 2 {
            Ok(())
        } else {
            Err(PolyhedronError::EulerCharacteristic {
                n_vertices,
                n_edges,
                n_faces,
                characteristic,
            })
        }
    }

    fn check_repeated(&self) -> Result<(), PolyhedronError> {
        let limit = REPEAT_TOLERANCE * self.size;
        // Neighbors along x are enough to look at: sort, then compare while x is near.
        let mut order: Vec<usize> = (0..self.vertices.len()).collect();
        order.sort_by(|&a, &b| self.vertices[a].x.total_cmp(&self.vertices[b].x));
        for (k, &a) in order.iter().enumerate() {
            for &b in &order[k + 1..] {
                if self.vertices[b].x - self.vertices[a].x > limit {
                    break;
                }
                let distance = (self.vertices[b] - self.vertices[a]).norm();
                if distance <= limit {
                    return Err(PolyhedronError::RepeatedVertex {
                        first: a.min(b),
                        second: a.max(b),
                        distance,
                        limit,
                    });
                }
            }
        }
        Ok(())
    }

    /// Normals by Newell's sum, offsets through the mean of the corners.
    fn set_planes(&mut self) -> Result<(), PolyhedronError> {
        let limit = PLANE_TOLERANCE * self.size;
        self.face_normal.clear();
        self.face_offset.clear();
        for face in 0..self.face_start.len() - 1 {
            let corners = self.loop_origins(face);
            let center = corners
                .iter()
                .map(|&v| self.vertices[v as usize])
                .sum::<Vec3>()
                / corners.len() as f64;
            let area: Vec3 = (0..corners.len())
                .map(|k| {
                    let a = self.vertices[corners[k] as usize] - center;
                    let b = self.vertices[corners[(k + 1) % corners.len()] as usize] - center;
                    a.cross(&b)
                })
                .sum();
            let norm = area.norm();
            if norm.is_nan() || norm <= 1e-20 * self.size * self.size {
                return Err(PolyhedronError::FlatFace { face });
            }
            let normal = area / norm;
            let offset = normal.dot(&center);
            let (vertex, distance) = corners
                .iter()
                .map(|&v| (v, (normal.dot(&self.vertices[v as usize]) - offset).abs()))
                .fold(
                    (0, 0.0),
                    |worst, this| if this.1 > worst.1 { this } else { worst },
                );
            if distance > limit {
                return Err(PolyhedronError::NotPlanar {
                    face,
                    vertex,
                    distance,
                    limit,
                });
            }
            self.face_normal.push(normal);
            self.face_offset.push(offset);
        }
        Ok(())
    }

    fn check_convex(&self) -> Result<(), PolyhedronError> {
        let limit = PLANE_TOLERANCE * self.size;
        for face in 0..self.n_faces() {
            for (vertex, x) in self.vertices.iter().enumerate() {
                let distance = self.plane_distance(face, x);
                if distance > limit {
                    return Err(PolyhedronError::NotConvex {
                        face,
                        vertex: vertex as u32,
                        distance,
                    });
                }
            }
        }
        Ok(())
    }
}

fn check_indices(vertices: &[Vec3], faces: &[Vec<u32>]) -> Result<(), PolyhedronError> {
    if vertices.len() < 4 || faces.len() < 4 {
        return Err(PolyhedronError::TooFew {
            n_vertices: vertices.len(),
            n_faces: faces.len(),
        });
    }
    if let Some(vertex) = vertices
        .iter()
        .position(|x| !x.iter().all(|c| c.is_finite()))
    {
        return Err(PolyhedronError::NotFinite { vertex });
    }
    let mut is_used = vec![false; vertices.len()];
    for (face, corners) in faces.iter().enumerate() {
        if corners.len() < 3 {
            return Err(PolyhedronError::FaceTooSmall {
                face,
                n: corners.len(),
            });
        }
        for (k, &vertex) in corners.iter().enumerate() {
            match is_used.get_mut(vertex as usize) {
                Some(flag) => *flag = true,
                None => {
                    return Err(PolyhedronError::NoSuchVertex {
                        face,
                        vertex,
                        n_vertices: vertices.len(),
                    });
                }
            }
            if corners[..k].contains(&vertex) {
                return Err(PolyhedronError::RepeatedCorner { face, vertex });
            }
        }
    }
    match is_used.iter().position(|&used| !used) {
        Some(vertex) => Err(PolyhedronError::UnusedVertex { vertex }),
        None => Ok(()),
    }
}

/// Half-edges and their twins; planes and size are left open.
fn topology(vertices: Vec<Vec3>, faces: &[Vec<u32>]) -> Result<Polyhedron, PolyhedronError> {
    let n_vertices = vertices.len();
    let n_half_edges: usize = faces.iter().map(Vec::len).sum();
    let mut this = Polyhedron {
        vertices,
        origin: Vec::new(),
        twin: Vec::new(),
        face: Vec::new(),
        face_start: vec![0],
        face_normal: Vec::new(),
        face_offset: Vec::new(),
        outgoing: vec![0; n_vertices],
        is_hidden: vec![false; faces.len()],
        beyond: Vec::new(),
        beyond_start: vec![0; n_vertices + n_half_edges + 1],
        size: 0.0,
    };
    // (from, to, half-edge), sorted: a twin is found by bisection.
    let mut ends: Vec<(u32, u32, u32)> = Vec::new();
    for (face, corners) in faces.iter().enumerate() {
        for (k, &from) in corners.iter().enumerate() {
            let half_edge = this.origin.len() as u32;
            ends.push((from, corners[(k + 1) % corners.len()], half_edge));
            this.outgoing[from as usize] = half_edge;
            this.origin.push(from);
            this.face.push(face as u32);
        }
        this.face_start.push(this.origin.len() as u32);
    }
    ends.sort_unstable();
    for pair in ends.windows(2) {
        if (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1) {
            return Err(PolyhedronError::EdgeUsedTwice {
                from: pair[0].0,
                to: pair[0].1,
                first: this.face[pair[0].2 as usize] as usize,
                second: this.face[pair[1].2 as usize] as usize,
            });
        }
    }
    this.twin = vec![0; this.origin.len()];
    for &(from, to, half_edge) in &ends {
        match ends.binary_search_by(|e| (e.0, e.1).cmp(&(to, from))) {
            Ok(found) => this.twin[half_edge as usize] = ends[found].2,
            Err(_) => {
                return Err(PolyhedronError::OpenEdge {
                    from,
                    to,
                    face: this.face[half_edge as usize] as usize,
                });
            }
        }
    }
    Ok(this)
}
