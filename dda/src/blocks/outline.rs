//! Geometry of blocks and parts in their present place: polygons for output, distances, planes.

use crate::geometry::distance::SurfacePoint;
use crate::geometry::parts::Part;
use crate::geometry::passage::Passage;
use crate::{Blocks, Vec3};

impl Blocks {
    /// Corners and faces at the current position, for output; faces counter-clockwise from outside. A
    /// sphere becomes a grid of 16 × 8 facets.
    pub fn world_polygons(&self, b: usize) -> (Vec<Vec3>, Vec<Vec<u32>>) {
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for part in self.parts_of(b) {
            match &self.derived.parts[part] {
                Part::Polyhedron(body) => {
                    let first = vertices.len() as u32;
                    vertices.extend_from_slice(body.vertices());
                    faces.extend(
                        (0..body.n_faces())
                            .map(|f| body.face_vertices(f).map(|v| first + v).collect::<Vec<_>>()),
                    );
                }
                Part::Sphere { center, radius } => {
                    let turn = self.orientation(b);
                    push_ball(&mut vertices, &mut faces, |unit| {
                        center + turn * unit * *radius
                    });
                }
                Part::Surface(surface) => {
                    let first = vertices.len() as u32;
                    vertices.extend_from_slice(surface.vertices());
                    let corners = |t: &[u32; 3]| t.iter().map(|v| first + v).collect::<Vec<_>>();
                    faces.extend(surface.triangles().iter().map(corners));
                }
            }
        }
        (vertices, faces)
    }

    // One part.

    /// Whether a part is a surface of triangles, whose interior is defined to a given depth only.
    pub fn is_surface(&self, part: usize) -> bool {
        matches!(self.derived.parts[part], Part::Surface(_))
    }

    /// Corners of a part at its current position, for output; of a sphere, points all over it.
    pub fn part_points(&self, part: usize) -> Vec<Vec3> {
        match &self.derived.parts[part] {
            Part::Polyhedron(body) => body.vertices().to_vec(),
            Part::Surface(surface) => surface.vertices().to_vec(),
            Part::Sphere { center, radius } => {
                let (mut vertices, mut faces) = (Vec::new(), Vec::new());
                push_ball(&mut vertices, &mut faces, |unit| center + unit * *radius);
                vertices
            }
        }
    }

    /// Box around a part, world; m. Lower above upper if its block was removed.
    pub fn part_aabb(&self, part: usize) -> (Vec3, Vec3) {
        self.state.boxes[part]
    }

    /// Closest point of a part's surface at its current position, or `None` if it is farther outside
    /// than `cutoff` (m) or its block was removed. See [`Polyhedron::surface_point_within`].
    ///
    /// [`Polyhedron::surface_point_within`]: crate::Polyhedron::surface_point_within
    pub fn surface_point_within(&self, part: usize, x: &Vec3, cutoff: f64) -> Option<SurfacePoint> {
        if self.state.is_removed[self.constants.block_of_part[part] as usize] {
            return None;
        }
        self.derived.parts[part].surface_point_within(x, cutoff)
    }

    /// Smallest thickness of a part, measured across faces, infinite for a surface of triangles; m.
    pub fn part_thickness(&self, part: usize) -> f64 {
        self.derived.parts[part].thickness()
    }

    /// Passage of the path between two points (m) through a part at its current position; `None` if it begins inside or
    /// misses it, for a surface of triangles, and if its block was removed.
    pub fn passage(&self, part: usize, from: &Vec3, to: &Vec3) -> Option<Passage> {
        if self.state.is_removed[self.constants.block_of_part[part] as usize] {
            return None;
        }
        self.derived.parts[part].passage(from, to)
    }

    /// Exits from a part for a point inside: the foot on the plane of each face, nearest first. The first is
    /// [`Self::surface_point_within`]; a sphere or a surface has no other, and a point outside has none.
    pub fn ways_out(&self, part: usize, x: &Vec3) -> Vec<SurfacePoint> {
        // behind triangles the search is limited in distance, in a polyhedron it is not
        let farthest = if self.is_surface(part) {
            f64::INFINITY
        } else {
            0.0
        };
        let Some(nearest) = self
            .surface_point_within(part, x, farthest)
            .filter(|surface| surface.distance < 0.0)
        else {
            return Vec::new();
        };
        let Part::Polyhedron(body) = &self.derived.parts[part] else {
            return vec![nearest];
        };
        let mut ways: Vec<SurfacePoint> = (0..body.n_faces())
            .map(|face| {
                let (normal, distance) = (body.face_normal(face), body.plane_distance(face, x));
                SurfacePoint {
                    distance,
                    normal,
                    point: x - normal * distance,
                }
            })
            .collect();
        ways.sort_by(|a, b| b.distance.total_cmp(&a.distance));
        ways
    }

    /// Outward normals of the faces of a part whose planes are within a distance (m) of a point, with its height above
    /// each (m), negative inside. For a sphere or a surface of triangles the one at the nearest point.
    pub fn planes_within(&self, part: usize, x: &Vec3, distance: f64) -> Vec<(Vec3, f64)> {
        match &self.derived.parts[part] {
            Part::Polyhedron(body) => (0..body.n_faces())
                .map(|face| (body.face_normal(face), body.plane_distance(face, x)))
                .filter(|(_, height)| height.abs() < distance)
                .collect(),
            Part::Sphere { .. } | Part::Surface(_) => {
                let nearest = self.surface_point_within(part, x, distance);
                nearest
                    .map(|at| (at.normal, at.distance))
                    .into_iter()
                    .collect()
            }
        }
    }
}

/// Corners and facets of a sphere, `place` takes unit vectors to the surface.
fn push_ball(vertices: &mut Vec<Vec3>, faces: &mut Vec<Vec<u32>>, place: impl Fn(Vec3) -> Vec3) {
    const AROUND: u32 = 16;
    const ALONG: u32 = 8;
    let south = vertices.len() as u32;
    vertices.push(place(-Vec3::z()));
    for ring in 1..ALONG {
        let (sin, cos) = (std::f64::consts::PI * f64::from(ring) / f64::from(ALONG)).sin_cos();
        for k in 0..AROUND {
            let (y, x) = (std::f64::consts::TAU * f64::from(k) / f64::from(AROUND)).sin_cos();
            vertices.push(place(Vec3::new(sin * x, sin * y, -cos)));
        }
    }
    let north = vertices.len() as u32;
    vertices.push(place(Vec3::z()));
    let at = |ring: u32, k: u32| south + 1 + (ring - 1) * AROUND + k % AROUND;
    for k in 0..AROUND {
        faces.push(vec![south, at(1, k + 1), at(1, k)]);
        faces.push(vec![north, at(ALONG - 1, k), at(ALONG - 1, k + 1)]);
        for ring in 1..ALONG - 1 {
            faces.push(vec![
                at(ring, k),
                at(ring, k + 1),
                at(ring + 1, k + 1),
                at(ring + 1, k),
            ]);
        }
    }
}
