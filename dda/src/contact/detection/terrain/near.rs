//! Points at which a body touches a surface or is near it, for laws without springs.
//!
//! Pairs of features bound the way of two bodies: corners of the body and the surface under them, vertices of the surface that stick
//! out and faces over them, edges that cross ridges. Each has the normal of what is flat there, so that a body slides over a ridge and
//! over the inner edges of a mesh as if they were not there.

use super::{ONE_FOOT, feet};
use crate::geometry::bounds::{Bounds, grown, overlap};
use crate::geometry::surface::{NearTriangles, Ridge};
use crate::{Polyhedron, Surface, Vec3};

/// Sine up to which a face or an edge of a body that is about to lie on the surface already bounds its way. A step turns it by 0.1 rad
/// at most.
const ABOUT_TO_LIE: f64 = 0.02;
/// Sine below which an edge runs along a ridge.
const PARALLEL: f64 = 1e-6;
/// Gap, × size of the body, below which the way from a corner to its foot has no direction.
const TOUCHING: f64 = 1e-6;
/// Share of a length by which a point may lie outside of a feature.
const ROUND_OFF: f64 = 1e-9;

/// A point of a body and a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NearPoint {
    /// In the middle of the gap; world; m.
    pub position: Vec3,
    /// Unit, into the surface.
    pub normal: Vec3,
    /// Below 0 for overlap; m.
    pub gap: f64,
}

/// Finder of points, with its buffers.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfacePoints {
    pub points: Vec<NearPoint>,
    corners: Vec<u32>,
}

/// A surface, and how near features of a body must be.
#[derive(Clone, Copy)]
pub(crate) struct NearFeatures<'a> {
    pub surface: &'a Surface,
    pub near: NearTriangles<'a>,
    /// Widest gap; m.
    pub reach: f64,
}

impl SurfacePoints {
    /// Finds the points of a sphere of a center and a radius (m).
    pub fn find_sphere(&mut self, ground: &NearFeatures, (center, radius): (&Vec3, f64)) {
        self.points.clear();
        let sphere = (center, radius + ground.reach);
        for (normal, closer) in feet(ground.surface, ground.near.triangles, sphere) {
            let gap = ground.reach - closer;
            let position = center + normal * (radius + 0.5 * gap);
            self.push_nearest(
                0,
                NearPoint {
                    position,
                    normal,
                    gap,
                },
            );
        }
    }

    /// Finds the points of a polyhedron.
    pub fn find(&mut self, ground: &NearFeatures, body: &Polyhedron) {
        self.points.clear();
        for corner in 0..body.vertices().len() as u32 {
            self.push_corner(ground, body, corner);
        }
        let (low, high) = body.aabb();
        let bounds = grown(&(low, high), ground.reach.max(0.0));
        self.push_vertices(ground, body, &bounds);
        for ridge in ground.surface.ridges(ground.near.triangles) {
            let end = ridge.from + ridge.along;
            if overlap(&(ridge.from.inf(&end), ridge.from.sup(&end)), &bounds) {
                self.push_crossings(ground, body, &ridge);
            }
        }
    }

    /// Adds a point; of those from `first` on in one direction the nearest counts.
    fn push_nearest(&mut self, first: usize, point: NearPoint) {
        let mut own = self.points[first..].iter_mut();
        match own.find(|known| known.normal.dot(&point.normal) > ONE_FOOT) {
            Some(known) if point.gap < known.gap => *known = point,
            Some(_) => {}
            None => self.points.push(point),
        }
    }

    /// Adds what is under a corner of the body: one point, in a valley two.
    fn push_corner(&mut self, ground: &NearFeatures, body: &Polyhedron, corner: u32) {
        let NearFeatures { surface, near, .. } = ground;
        let x = body.vertices()[corner as usize];
        let first = self.points.len();
        let mut push = |normal: Vec3, gap: f64| {
            if gap <= ground.reach && body.is_corner(corner, &normal) {
                let position = x + normal * (0.5 * gap);
                self.push_nearest(
                    first,
                    NearPoint {
                        position,
                        normal,
                        gap,
                    },
                );
            }
        };
        // No corner is behind the surface that is in front of all its planes here.
        if near.triangles.iter().any(|&t| surface.height(t, &x) < 0.0)
            && let Some(behind) = surface.behind(near, &x)
        {
            for (_, outward, depth) in behind.leans_on {
                if 0.0 < depth {
                    push(-outward, -depth);
                }
            }
        }
        let tiny = TOUCHING * body.size();
        for &triangle in near.triangles {
            let height = surface.height(triangle, &x);
            if height < -tiny || ground.reach < height {
                continue;
            }
            if tiny < height {
                if let Some((foot, gap)) = surface.local_foot(triangle, &x) {
                    push((foot - x) / gap, gap);
                }
                continue;
            }
            // what is on the surface by round-off is looked for a little above it
            let n = surface.normal(triangle);
            let above = x + n * (tiny - height);
            if let Some((_, gap)) = surface.local_foot(triangle, &above)
                && gap < 2.0 * tiny
            {
                push(-n, height);
            }
        }
    }

    /// Adds the vertices of the surface under faces of the body.
    fn push_vertices(&mut self, ground: &NearFeatures, body: &Polyhedron, bounds: &Bounds) {
        let surface = ground.surface;
        let mut corners = std::mem::take(&mut self.corners);
        surface.corners_of(ground.near.triangles, &mut corners);
        for &vertex in &corners {
            let x = surface.vertices()[vertex as usize];
            if !overlap(&(x, x), bounds) {
                continue;
            }
            let height = |face: usize| body.plane_distance(face, &x);
            let over = (0..body.n_faces()).filter(|&face| {
                height(face) <= ground.reach
                    && !body.is_hidden(face)
                    && surface.sticks_out(vertex, &body.face_normal(face), ABOUT_TO_LIE)
                    && covers(body, face, &x)
            });
            // of two faces that it is behind it comes out at the nearer one
            if let Some(face) = over.max_by(|&a, &b| height(a).total_cmp(&height(b))) {
                let (normal, gap) = (body.face_normal(face), height(face));
                let position = x - normal * (0.5 * gap);
                self.points.push(NearPoint {
                    position,
                    normal,
                    gap,
                });
            }
        }
        self.corners = corners;
    }

    /// Adds the places where edges of the body cross a ridge.
    fn push_crossings(&mut self, ground: &NearFeatures, body: &Polyhedron, ridge: &Ridge) {
        for edge in body.edges() {
            let from = body.vertices()[body.origin(edge) as usize];
            let along = body.vertices()[body.target(edge) as usize] - from;
            let across = along.cross(&ridge.along);
            let sine = across.norm();
            if sine <= PARALLEL * along.norm() * ridge.along.norm() {
                continue;
            }
            let normal = across * (-across.dot(&ridge.outward).signum() / sine);
            let twin = body.twin(edge);
            let inward = [(edge, along), (twin, -along)]
                .map(|(e, along)| body.face_normal(body.face_of(e)).cross(&along).normalize());
            let is_out = inward.iter().all(|side| side.dot(&normal) <= ABOUT_TO_LIE);
            if !(is_out && ridge.is_farthest(&normal) && body.is_ridge(edge, &normal)) {
                continue;
            }
            let offset = ridge.from - from;
            let gap = offset.dot(&normal);
            let on_edge = offset.cross(&ridge.along).dot(&across) / (sine * sine);
            let on_ridge = offset.cross(&along).dot(&across) / (sine * sine);
            let is_within = |share: f64| (-ROUND_OFF..=1.0 + ROUND_OFF).contains(&share);
            let is_crossing = gap <= ground.reach && is_within(on_edge) && is_within(on_ridge);
            // the far side of something thin is behind the body, not in it
            let at = ridge.from + ridge.along * on_ridge;
            if is_crossing && (0.0 <= gap || is_in(body, &at)) {
                let position = from + along * on_edge + normal * (0.5 * gap);
                self.points.push(NearPoint {
                    position,
                    normal,
                    gap,
                });
            }
        }
    }
}

/// Is a point in a body, or on it?
fn is_in(body: &Polyhedron, x: &Vec3) -> bool {
    let allowed = ROUND_OFF * body.size();
    (0..body.n_faces()).all(|face| body.plane_distance(face, x) <= allowed)
}

/// Does a point lie over a face, along its normal, or behind it in the body?
fn covers(body: &Polyhedron, face: usize, x: &Vec3) -> bool {
    if body.plane_distance(face, x) < 0.0 {
        return is_in(body, x);
    }
    let n = body.face_normal(face);
    body.face_loop(face).all(|e| {
        let from = body.vertices()[body.origin(e) as usize];
        let along = body.vertices()[body.target(e) as usize] - from;
        let outward = along.cross(&n);
        (x - from).dot(&outward) <= ROUND_OFF * outward.norm() * body.size()
    })
}
