//! Terrain and other fixed surfaces: triangles, solid on the side away from their normals.

use std::collections::HashMap;

use crate::geometry::bounds::Bounds;
use crate::{Isometry, SurfacePoint, Vec3};
use parry3d_f64::{
    bounding_volume::{Aabb, BoundingVolume},
    math::Vector,
    partitioning::{Bvh, BvhBuildStrategy},
};
use thiserror::Error;

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
    /// Plane through the side that halves the angle, outward unit normal and offset.
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
    bounds: Bounds,
}

impl PartialEq for Surface {
    fn eq(&self, other: &Self) -> bool {
        self.vertices == other.vertices && self.triangles == other.triangles
    }
}

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

/// No triangle.
const NONE: u32 = u32::MAX;
/// Largest angle between coplanar neighbors and the first triangle of their plane; rad.
const FLAT: f64 = 1e-7;
/// Cosine of the least angle between the sides of a sharp ridge.
const RIDGE: f64 = 0.9;
/// Cosine of the largest angle between triangles considered almost coplanar.
const GOES_ON: f64 = 0.99;
/// A triangle lower than this over its longest side has no area; –.
const SLIVER: f64 = 1e-9;

impl Surface {
    /// A surface of triangles, counter-clockwise seen from outside (m).
    ///
    /// # Errors
    ///
    /// [`SurfaceError`] names the first vertex or triangle that is unusable.
    pub fn new(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, SurfaceError> {
        if triangles.is_empty() {
            return Err(SurfaceError::Empty);
        }
        if let Some(vertex) =
            (0..vertices.len()).find(|&v| !vertices[v].iter().all(|c| c.is_finite()))
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
            // NaN counts as no area.
            if !((b - a).cross(&(c - a)).norm() > SLIVER * longest) {
                return Err(SurfaceError::Degenerate { triangle });
            }
        }
        let mut sides: HashMap<(u32, u32), usize> = HashMap::with_capacity(3 * triangles.len());
        for (second, corners) in triangles.iter().enumerate() {
            for k in 0..3 {
                let (from, to) = (corners[k], corners[(k + 1) % 3]);
                if let Some(first) = sides.insert((from, to), second) {
                    return Err(SurfaceError::Orientation {
                        first,
                        second,
                        from,
                        to,
                    });
                }
            }
        }
        let neighbor = triangles
            .iter()
            .map(|corners| {
                [0, 1, 2].map(|k| {
                    let side = (corners[(k + 1) % 3], corners[k]);
                    sides.get(&side).map_or(NONE, |&triangle| triangle as u32)
                })
            })
            .collect();
        Ok(Self::measured(vertices, triangles, neighbor))
    }

    /// Everything that follows from vertices and topology.
    fn measured(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>, neighbor: Vec<[u32; 3]>) -> Self {
        let corners = |triangle: &[u32; 3]| triangle.map(|v| vertices[v as usize]);
        let normal: Vec<Vec3> = triangles
            .iter()
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
            .map(|t| {
                [0, 1, 2].map(|k| {
                    let other = neighbor[t][k];
                    let (from, to) = (triangles[t][k], triangles[t][(k + 1) % 3]);
                    // The lower triangle's plane, reversed for the higher: both share it to the bit.
                    let (from, to, sign) = if (other as usize) < t {
                        (to, from, -1.0)
                    } else {
                        (from, to, 1.0)
                    };
                    let a = vertices[from as usize];
                    let along = vertices[to as usize] - a;
                    let (lower, higher) = match other {
                        NONE => (t, t),
                        other => (t.min(other as usize), t.max(other as usize)),
                    };
                    let middle = normal[lower] + normal[higher];
                    let outward = along.cross(&middle);
                    let size = outward.norm();
                    // Folded flat on itself: no plane halves the angle, the triangle's own edge does.
                    let outward = if size > FLAT * along.norm() {
                        outward * (sign / size)
                    } else {
                        along.cross(&normal[t]).normalize() * sign
                    };
                    (outward, outward.dot(&a))
                })
            })
            .collect();
        let (ridges_start, ridges) =
            ridges_beside((&vertices, &triangles, &normal), (&neighbor, &divide));
        let mut vertex_normal = vec![Vec3::zeros(); vertices.len()];
        let mut spokes = vec![Vec::new(); vertices.len()];
        for (t, triangle) in triangles.iter().enumerate() {
            for k in 0..3 {
                let [v, next, last] = [k, k + 1, k + 2].map(|i| triangle[i % 3]);
                let x = vertices[v as usize];
                let (forth, back) = (vertices[next as usize] - x, vertices[last as usize] - x);
                vertex_normal[v as usize] += normal[t] * forth.angle(&back);
                spokes[v as usize].extend([next, last]);
            }
        }
        let mut spokes_start = vec![0];
        let mut all_spokes = Vec::new();
        for ends in &mut spokes {
            ends.sort_unstable();
            ends.dedup();
            all_spokes.extend_from_slice(ends);
            spokes_start.push(all_spokes.len() as u32);
        }
        let leaves: Vec<Aabb> = triangles
            .iter()
            .map(|triangle| {
                let [a, b, c] = corners(triangle);
                aabb(&(a.inf(&b).inf(&c), a.sup(&b).sup(&c)))
            })
            .collect();
        let bounds = triangles
            .iter()
            .flatten()
            .map(|&v| vertices[v as usize])
            .fold(
                (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)),
                |all, x| (all.0.inf(&x), all.1.sup(&x)),
            );
        Self {
            plane: planes(&normal, &neighbor),
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves),
            vertices,
            triangles,
            normal,
            offset,
            neighbor,
            divide,
            ridges_start,
            ridges,
            vertex_normal,
            spokes_start,
            spokes: all_spokes,
            bounds,
        }
    }

    /// The surface, rotated and translated.
    pub fn transformed(&self, placement: &Isometry) -> Self {
        let vertices = self
            .vertices
            .iter()
            .map(|x| placement.transform_point(&(*x).into()).coords)
            .collect();
        Self::measured(vertices, self.triangles.clone(), self.neighbor.clone())
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

    /// Closest point of some triangles to a point behind the surface, `None` for one in front.
    pub(crate) fn behind(&self, triangles: &[u32], x: &Vec3) -> Option<Behind> {
        let mut best: Option<(u32, f64, Vec3, Feature)> = None;
        for &triangle in triangles {
            let height = self.height(triangle, x);
            if best.is_some_and(|(_, square, ..)| height * height >= square) {
                continue;
            }
            let (square, foot, feature) = self.closest(triangle, x);
            if best.is_none_or(|(_, least, ..)| square < least) {
                best = Some((triangle, square, foot, feature));
            }
        }
        let (triangle, square, foot, feature) = best?;
        let found = self.signed(triangle, x, square.sqrt(), foot, feature);
        let t = triangle as usize;
        let (normal, depth) = (found.normal, -found.distance);
        let whole = |place| [(place, normal, depth), (place, normal, 0.0)];
        let leans_on = match feature {
            Feature::Face => whole(self.plane[t]),
            Feature::Side(k) => match self.neighbor[t][k] {
                NONE => whole(self.plane[t]),
                other => {
                    // At the bottom of a valley: d m = a n_A + b n_B.
                    let (n, m) = (self.normal[t], self.normal[other as usize]);
                    let cos = n.dot(&m);
                    let (along_n, along_m) = (depth * normal.dot(&n), depth * normal.dot(&m));
                    let square = 1.0 - cos * cos;
                    if square > FLAT * FLAT {
                        let a = (along_n - cos * along_m) / square;
                        let b = (along_m - cos * along_n) / square;
                        [(self.plane[t], n, a), (self.plane[other as usize], m, b)]
                    } else {
                        whole(self.plane[t])
                    }
                }
            },
            Feature::Vertex(k) => whole(OF_VERTEX | self.triangles[t][k]),
        };
        (depth > 0.0).then_some(Behind { depth, leans_on })
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

    /// The triangles whose boxes meet a box, in rising order.
    pub(crate) fn near(&self, bounds: &Bounds, triangles: &mut Vec<u32>) {
        let wanted = aabb(bounds);
        triangles.clear();
        triangles.extend(self.tree.leaves(|node| node.aabb().intersects(&wanted)));
        triangles.sort_unstable();
    }

    /// Closest point, with the distance negative behind the surface, or `None` if it is farther than `cutoff`
    /// (m). At the rim of an open surface the side is that of the plane that ends there.
    pub fn surface_point_within(&self, x: &Vec3, cutoff: f64) -> Option<SurfacePoint> {
        let extent = (self.bounds.1 - self.bounds.0).norm();
        let outside = (self.bounds.0 - x)
            .sup(&(x - self.bounds.1))
            .sup(&Vec3::zeros());
        let farthest = outside.norm() + extent;
        let mut reach = f64::max(
            outside.norm(),
            extent / (self.triangles.len() as f64).sqrt(),
        );
        loop {
            reach = reach.min(cutoff);
            let wanted = aabb(&(x.add_scalar(-reach), x.add_scalar(reach)));
            // Ties between neighbors go to the lowest triangle, whatever the tree.
            let nearest = self
                .tree
                .leaves(|node| node.aabb().intersects(&wanted))
                .map(|triangle| (triangle, self.closest(triangle, x)))
                .min_by(|a, b| a.1.0.total_cmp(&b.1.0).then(a.0.cmp(&b.0)));
            match nearest {
                Some((triangle, (square, foot, feature))) if square <= reach * reach => {
                    return Some(self.signed(triangle, x, square.sqrt(), foot, feature));
                }
                _ if reach >= cutoff || reach > farthest => return None,
                _ => reach *= 2.0,
            }
        }
    }

    fn signed(
        &self,
        triangle: u32,
        x: &Vec3,
        distance: f64,
        foot: Vec3,
        feature: Feature,
    ) -> SurfacePoint {
        let t = triangle as usize;
        let outward = match feature {
            Feature::Face => self.normal[t],
            Feature::Side(k) => match self.neighbor[t][k] {
                NONE => self.normal[t],
                other => self.normal[t] + self.normal[other as usize],
            },
            Feature::Vertex(k) => self.vertex_normal[self.triangles[t][k] as usize],
        };
        let sign = if outward.dot(&(x - foot)) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let normal = if matches!(feature, Feature::Face) || distance == 0.0 {
            outward.normalize()
        } else {
            (x - foot) * (sign / distance)
        };
        SurfacePoint {
            distance: sign * distance,
            normal,
            point: foot,
        }
    }

    /// Squared distance, foot, and its feature. Source: Ericson, Real-Time Collision Detection (2004), 5.1.5.
    fn closest(&self, triangle: u32, x: &Vec3) -> (f64, Vec3, Feature) {
        let corners = self.triangles[triangle as usize].map(|v| self.vertices[v as usize]);
        let n = &self.normal[triangle as usize];
        let is_inside = (0..3).all(|k| {
            let along = corners[(k + 1) % 3] - corners[k];
            along.cross(&(x - corners[k])).dot(n) >= 0.0
        });
        if is_inside {
            let height = self.height(triangle, x);
            return (height * height, x - n * height, Feature::Face);
        }
        let mut best = (f64::INFINITY, *x, Feature::Face);
        for k in 0..3 {
            let (a, along) = (corners[k], corners[(k + 1) % 3] - corners[k]);
            let share = (x - a).dot(&along) / along.norm_squared();
            let (foot, feature) = if share <= 0.0 {
                (a, Feature::Vertex(k))
            } else if share >= 1.0 {
                (corners[(k + 1) % 3], Feature::Vertex((k + 1) % 3))
            } else {
                (a + along * share, Feature::Side(k))
            };
            let square = (x - foot).norm_squared();
            if square < best.0 {
                best = (square, foot, feature);
            }
        }
        best
    }

    /// Foot on a triangle and distance of a point in front of the surface, where no neighbor comes nearer to
    /// it: a sphere on a flat mesh touches it once, in a valley twice.
    pub(crate) fn local_foot(&self, triangle: u32, x: &Vec3) -> Option<(Vec3, f64)> {
        let (square, foot, feature) = self.closest(triangle, x);
        let t = triangle as usize;
        let away = x - foot;
        let is_nearest = match feature {
            Feature::Face => away.dot(&self.normal[t]) > 0.0,
            Feature::Side(k) => match self.neighbor[t][k] {
                NONE => away.dot(&self.normal[t]) > 0.0,
                other => {
                    let (a, b) = (self.triangles[t][k], self.triangles[t][(k + 1) % 3]);
                    let along = self.vertices[b as usize] - self.vertices[a as usize];
                    // Into the neighbor, in its plane; its side has the opposite direction.
                    let inward = self.normal[other as usize].cross(&-along);
                    let outward = self.normal[t] + self.normal[other as usize];
                    away.dot(&outward) > 0.0 && away.dot(&inward) <= 0.0
                }
            },
            Feature::Vertex(k) => {
                let v = self.triangles[t][k] as usize;
                let row = self.spokes_start[v] as usize..self.spokes_start[v + 1] as usize;
                away.dot(&self.vertex_normal[v]) > 0.0
                    && self.spokes[row].iter().all(|&end| {
                        away.dot(&(self.vertices[end as usize] - self.vertices[v])) <= 0.0
                    })
            }
        };
        is_nearest.then(|| (foot, square.sqrt()))
    }
}

/// A point behind the surface.
pub(crate) struct Behind {
    /// Distance; m.
    pub depth: f64,
    /// Number of the plane or vertex, unit normal out of the surface, and the part of the exit path along it
    /// (m): one plane, or the two of a valley.
    pub leans_on: [(u32, Vec3, f64); 2],
}

/// Mark of the numbers of vertices among those of planes.
const OF_VERTEX: u32 = 1 << 31;

/// Feature of a triangle on which a point lies.
#[derive(Clone, Copy, Debug)]
enum Feature {
    Face,
    Side(usize),
    Vertex(usize),
}

fn aabb(bounds: &Bounds) -> Aabb {
    let vector = |x: &Vec3| Vector::new(x.x, x.y, x.z);
    Aabb::new(vector(&bounds.0), vector(&bounds.1))
}

/// Planes at sharp ridges of the triangles beside a triangle, or beside these, that are almost coplanar with it, if it lies entirely
/// on the inner side: start of those of each triangle, and all. Triangles that share a vertex are beside each other.
fn ridges_beside(
    (vertices, triangles, normal): (&[Vec3], &[[u32; 3]], &[Vec3]),
    (neighbor, divide): (&[[u32; 3]], &[[Divide; 3]]),
) -> (Vec<u32>, Vec<Divide>) {
    let mut around = vec![Vec::new(); vertices.len()];
    for (t, corners) in triangles.iter().enumerate() {
        for &v in corners {
            around[v as usize].push(t);
        }
    }
    let is_ridge = |t: usize, k: usize| {
        let other = neighbor[t][k];
        other != NONE && {
            let other = other as usize;
            let beyond = triangles[other].map(|v| vertices[v as usize]);
            let on_the_side = vertices[triangles[t][k] as usize];
            normal[t].dot(&normal[other]) < RIDGE
                && beyond
                    .iter()
                    .map(|x| normal[t].dot(&(x - on_the_side)))
                    .sum::<f64>()
                    < 0.0
        }
    };
    let mut start = vec![0];
    let mut ridges = Vec::new();
    let mut beside: Vec<usize> = Vec::new();
    for (t, corners) in triangles.iter().enumerate() {
        beside.clear();
        beside.push(t);
        for _ring in 0..2 {
            let inner = beside.len();
            for k in 0..inner {
                let corners = triangles[beside[k]];
                beside.extend(corners.iter().flat_map(|&v| &around[v as usize]));
            }
            beside.sort_unstable();
            beside.dedup();
            beside.retain(|&u| normal[u].dot(&normal[t]) > GOES_ON);
        }
        beside.retain(|&u| u != t);
        let [a, b, c] = corners.map(|v| vertices[v as usize]);
        let slack = FLAT * ((b - a).norm() + (c - b).norm());
        for &u in &beside {
            for k in (0..3).filter(|&k| is_ridge(u, k)) {
                let (outward, offset) = divide[u][k];
                if [a, b, c].iter().all(|x| outward.dot(x) <= offset + slack) {
                    ridges.push((outward, offset));
                }
            }
        }
        start.push(ridges.len() as u32);
    }
    (start, ridges)
}

/// Numbers of planes: neighbors that lie flat with the first of theirs.
fn planes(normal: &[Vec3], neighbor: &[[u32; 3]]) -> Vec<u32> {
    let mut plane = vec![NONE; normal.len()];
    let mut open = Vec::new();
    for first in 0..normal.len() {
        if plane[first] != NONE {
            continue;
        }
        plane[first] = first as u32;
        open.push(first);
        while let Some(triangle) = open.pop() {
            for &other in &neighbor[triangle] {
                if other != NONE
                    && plane[other as usize] == NONE
                    && normal[other as usize].cross(&normal[first]).norm() < FLAT
                    && normal[other as usize].dot(&normal[first]) > 0.0
                {
                    plane[other as usize] = first as u32;
                    open.push(other as usize);
                }
            }
        }
    }
    plane
}
