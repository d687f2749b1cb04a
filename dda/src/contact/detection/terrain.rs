//! Narrow phase of a body and a surface of triangles.
//!
//! A polyhedron is behind the surface with its corners and with its faces:
//!
//! ```text
//! points of   (1 − s)/A₀ ∫_S d² dA + s Σ_v w_v d_v²,   d > 0: depth behind the nearest triangle        [m²]
//! ```
//! `A₀ = V^2/3`; `w_v` is the share of the faces that meet in corner v, so that a cube which lies flat has the
//! weight 1; for a stiffness per area it is `∫ d² dA + 4 A_min Σ w_v d_v²`. The depth of a corner is its
//! distance from the surface, exact at valleys and ridges. For the faces, each triangle takes what lies
//! behind it between the planes that halve the angles at its sides, where the depth is continuous: no edge
//! of the mesh kicks, ridges are felt by the faces they press into, and triangles of one plane add up to
//! that plane to round-off. Only where many triangles meet in a point do their shares leave or overlap a
//! little, of the order of the overlap squared. Points of one plane are a manifold, and so are those whose nearest vertex is
//! the same; at the bottom of a valley a corner leans on both sides.
//!
//! The faces of a body heed a triangle while its centroid is in front of it or what is behind is no deeper
//! than the allowed overlap: what is farther behind belongs to the other side of something thin. At the rim
//! of an open surface there is nothing to fall against: bodies should not get there.
//!
//! A sphere touches at the feet where the surface is locally nearest.

mod near;

use super::manifold::{Features, Manifold, ManifoldPoint};
use super::patch::{CORNER_AREA, CORNER_SHARE};
use crate::geometry::clip::{OnPlane, clip};
use crate::geometry::quadrature::Fan;
use crate::geometry::surface::{Checked, NearTriangles};
use crate::material::Scaling;
use crate::{Polyhedron, Surface, Vec3};
pub(crate) use near::{NearFeatures, NearPoint, SurfacePoints};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Feet whose normals turn by less are one; cos 5°.
pub(crate) const ONE_FOOT: f64 = 0.996_195;
/// A foot goes on from one of the last step if its normal turned by less; cos 45°.
pub(crate) const SAME_FOOT: f64 = 0.707;

/// Normals into the surface and overlaps (m) of the feet of a sphere (center, radius; m) on some triangles.
pub(crate) fn feet<'a>(
    surface: &'a Surface,
    triangles: &'a [u32],
    (center, radius): (&'a Vec3, f64),
) -> impl Iterator<Item = (Vec3, f64)> + 'a {
    triangles.iter().filter_map(move |&triangle| {
        let (point, distance) = surface.local_foot(triangle, center)?;
        (distance < radius).then(|| ((point - center) / distance, radius - distance))
    })
}

/// Manifolds of a polyhedron and a surface, with columns for the points of all of them; i is the body, j the surface.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceManifolds {
    /// One for each plane, and one for each vertex that a corner is nearest to. The normal is that of the first of its
    /// points.
    pub planes: Vec<Manifold<Range<usize>>>,
    pub points: Vec<ManifoldPoint>,
    /// Unit, into the surface; one per point.
    pub normals: Vec<Vec3>,
    /// Squared depths, each counted once where a corner leans on two sides; one per point; m².
    pub squares: Vec<f64>,
}

/// Finder of the manifolds of a polyhedron on a surface, with its buffers.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct SurfacePatch {
    /// One per corner of the body, sums to about 1 over the corners of a face.
    corner_weight: Vec<f64>,
    /// `A₀`; m².
    face_area: f64,
    #[serde(skip)]
    pub manifolds: SurfaceManifolds,
    #[serde(skip)]
    found: Vec<Found>,
    /// Part of a face behind a plane, and its pieces.
    #[serde(skip)]
    wet: Vec<Vec3>,
    #[serde(skip)]
    polygon: Vec<Vec3>,
    #[serde(skip)]
    spare: Vec<Vec3>,
    #[serde(skip)]
    pieces: Pieces,
    /// Triangles that may be as near as a plane.
    #[serde(skip)]
    within: Vec<u32>,
}

/// Polygons in the regions of triangles, one after the other.
#[derive(Clone, Debug, Default)]
struct Pieces {
    /// Of each, its triangle and the end of its corners.
    ends: Vec<(u32, usize)>,
    corners: Vec<Vec3>,
}

impl Pieces {
    fn clear(&mut self) {
        self.ends.clear();
        self.corners.clear();
    }

    /// Adds a polygon, if it has an area.
    fn push(&mut self, triangle: u32, polygon: &[Vec3]) {
        if polygon.len() > 2 {
            self.corners.extend_from_slice(polygon);
            self.ends.push((triangle, self.corners.len()));
        }
    }

    fn iter(&self) -> impl Iterator<Item = (u32, &[Vec3])> {
        let starts = std::iter::once(0).chain(self.ends.iter().map(|&(_, end)| end));
        starts
            .zip(&self.ends)
            .map(|(start, &(triangle, end))| (triangle, &self.corners[start..end]))
    }
}

/// A point behind the surface.
#[derive(Clone, Copy, Debug)]
struct Found {
    place: u32,
    /// Out of the surface.
    normal: Vec3,
    x: Vec3,
    weight: f64,
    /// Area that it stands for, none of a corner; m².
    area: f64,
    depth: f64,
    /// Weight in the energy, counted once for a corner that touches two sides; m².
    square: f64,
}

/// Faces that look at a plane by less than this cosine do not touch it.
const LOOKS_AWAY: f64 = 1e-3;
/// Areas that differ by less are equal; –.
const ROUND_OFF: f64 = 1e-9;

/// Triangles near a body, and where the body is.
struct Ground<'a> {
    surface: &'a Surface,
    near: NearTriangles<'a>,
    centroid: &'a Vec3,
    /// Depths below this are those of faces that lie on each other; m.
    flush: f64,
}

impl Ground<'_> {
    /// Adds the points of a polygon behind the plane of a triangle, unless all of it is in front of the surface; returns its depth
    /// (m). `check`: a triangle of that plane and those that may be as near, unless the depth needs no check against them.
    fn push_polygon(
        &self,
        polygon: &[Vec3],
        triangle: u32,
        per_area: f64,
        check: Option<(u32, &[u32])>,
        found: &mut Vec<Found>,
    ) -> f64 {
        let (place, normal) = (self.surface.plane(triangle), *self.surface.normal(triangle));
        let (from, mut deepest) = (found.len(), 0.0_f64);
        let (mut is_flush, mut has_force) = (true, false);
        integrate(polygon, |x, area| {
            if area <= 0.0 {
                return;
            }
            // Points on the waterline count, for the dashpots' sake: whether round-off puts them
            // above or below must not matter.
            let depth = f64::max(-self.surface.height(triangle, &x), 0.0);
            let point = Found {
                place,
                normal,
                x,
                weight: per_area * area,
                area,
                depth,
                square: depth * depth,
            };
            is_flush &= depth <= self.flush;
            let true_depth = match check {
                Some(around) if self.flush < depth => self.push(point, around, found),
                _ => {
                    found.push(point);
                    depth
                }
            };
            has_force |= true_depth > self.flush;
            deepest = deepest.max(true_depth);
        });
        if !(is_flush || has_force) {
            found.truncate(from);
        }
        deepest
    }

    /// Finds the triangles that may be as near to points of a polygon as that of the region, once for all of them; true if none of
    /// the points needs a check against them.
    fn look_around(&self, polygon: &[Vec3], triangle: u32, within: &mut Vec<u32>) -> bool {
        let Some((first, rest)) = polygon.split_first() else {
            return true;
        };
        let (mut low, mut high) = (*first, *first);
        let mut deepest = -self.surface.height(triangle, first);
        for x in rest {
            (low, high) = (low.inf(x), high.sup(x));
            deepest = deepest.max(-self.surface.height(triangle, x));
        }
        if deepest <= self.flush {
            return true;
        }
        let bounds = (low, high);
        self.surface.within(&self.near, &bounds, deepest, within);
        deepest <= self.near.reach && self.surface.is_plain(triangle, within, polygon, self.flush)
    }

    /// Adds a point behind the plane in whose region it lies, with the depth that it has behind the surface; returns that.
    /// A triangle of its plane, and those that may be as near.
    fn push(&self, point: Found, around: (u32, &[u32]), found: &mut Vec<Found>) -> f64 {
        match self
            .surface
            .checked(&self.near, around, &point.x, point.depth)
        {
            Checked::InFront => 0.0,
            // Through something thin, the body goes back to the side it came from.
            Checked::Nearer(behind) if !behind.faces(self.centroid, &point.x) => {
                found.push(point);
                point.depth
            }
            Checked::Nearer(behind) => {
                let mut square = behind.depth * behind.depth;
                for (place, normal, depth) in behind.leans_on {
                    if depth > 0.0 {
                        found.push(Found {
                            place,
                            normal,
                            depth,
                            square,
                            ..point
                        });
                        square = 0.0;
                    }
                }
                behind.depth
            }
            Checked::True => {
                found.push(point);
                point.depth
            }
        }
    }
}

impl SurfacePatch {
    pub fn of(body: &Polyhedron) -> Self {
        let face_area = body.size() * body.size();
        let mut corner_weight = vec![0.0; body.vertices().len()];
        for face in 0..body.n_faces() {
            let corners: Vec<u32> = body.face_vertices(face).collect();
            let n = corners.len();
            let at = |k: usize| body.vertices()[corners[k % n] as usize];
            let area = crate::face_area(body, face);
            for k in 0..n {
                let (back, forth) = (at(k) - at(k + n - 1), at(k + 1) - at(k));
                let share = back.angle(&forth) / std::f64::consts::TAU;
                corner_weight[corners[k] as usize] += area / face_area * share / 3.0;
            }
        }
        Self {
            corner_weight,
            face_area,
            ..Self::default()
        }
    }

    /// Finds the manifolds of the body, whose centroid is given, on some triangles. `allowed`: the deepest overlap (m).
    pub fn find(
        &mut self,
        (body, centroid): (&Polyhedron, &Vec3),
        (surface, near): (&Surface, NearTriangles),
        scaling: Scaling,
        allowed: f64,
    ) {
        let triangles = near.triangles;
        let (per_area, per_corner) = match scaling {
            Scaling::Point => ((1.0 - CORNER_SHARE) / self.face_area, CORNER_SHARE),
            Scaling::Area => (1.0, 4.0 * CORNER_AREA * self.face_area),
        };
        self.found.clear();
        self.press_corners(body, (surface, near), per_corner);
        let ground = Ground {
            surface,
            near,
            centroid,
            flush: ROUND_OFF * body.size(),
        };
        for k in 0..triangles.len() {
            let plane = surface.plane(triangles[k]);
            if triangles[..k].iter().all(|&t| surface.plane(t) != plane) {
                self.press_faces(body, &ground, k, (per_area, allowed));
            }
        }
        let flat_weight = match scaling {
            Scaling::Point => 1.0,
            Scaling::Area => self.face_area,
        };
        self.sort_points(flat_weight);
    }

    /// Adds the corners of the body that lie behind the surface.
    fn press_corners(
        &mut self,
        body: &Polyhedron,
        (surface, near): (&Surface, NearTriangles),
        per_corner: f64,
    ) {
        let triangles = near.triangles;
        for (x, &weight) in body.vertices().iter().zip(&self.corner_weight) {
            // No corner is behind the surface that is in front of all its planes here.
            if triangles.iter().all(|&t| surface.height(t, x) >= 0.0) {
                continue;
            }
            if let Some(behind) = surface.behind(&near, x) {
                let mut square = behind.depth * behind.depth;
                for (place, normal, depth) in behind.leans_on {
                    if depth > 0.0 {
                        self.found.push(Found {
                            place,
                            normal,
                            x: *x,
                            weight: per_corner * weight,
                            area: 0.0,
                            depth,
                            square,
                        });
                        square = 0.0;
                    }
                }
            }
        }
    }

    /// Adds what of the body's faces lies behind the plane of the k-th of the triangles, the first of its plane.
    fn press_faces(
        &mut self,
        body: &Polyhedron,
        ground: &Ground,
        k: usize,
        (per_area, allowed): (f64, f64),
    ) {
        let surface = ground.surface;
        let triangles = &ground.near.triangles[k..];
        let first = triangles[0];
        let height = |x: &Vec3| surface.height(first, x);
        if body.vertices().iter().all(|x| height(x) >= 0.0) {
            return;
        }
        let (n, place) = (surface.normal(first), surface.plane(first));
        let (from, mut deepest) = (self.found.len(), 0.0_f64);
        let Self {
            found,
            wet,
            polygon,
            spare,
            pieces,
            within,
            ..
        } = self;
        for face in 0..body.n_faces() {
            if body.face_normal(face).dot(n) > -LOOKS_AWAY {
                continue;
            }
            wet.clear();
            wet.extend(
                body.face_vertices(face)
                    .map(|v| body.vertices()[v as usize]),
            );
            cut(wet, spare, n, surface.offset(first));
            pieces.clear();
            for &triangle in triangles.iter().filter(|&&t| surface.plane(t) == place) {
                polygon.clone_from(wet);
                for (outward, offset) in surface.divides(triangle) {
                    cut(polygon, spare, outward, *offset);
                }
                pieces.push(triangle, polygon);
            }
            let covered: f64 = pieces.iter().map(|(_, piece)| area(piece)).sum();
            let mut add = |polygon: &[Vec3], check: Option<(u32, &[u32])>| {
                let depth = ground.push_polygon(polygon, first, per_area, check, found);
                deepest = deepest.max(depth);
            };
            if covered >= (1.0 - ROUND_OFF) * area(wet) {
                // Wholly over the plane: friction, which is no polynomial, should not feel the triangles.
                let is_plain = pieces
                    .iter()
                    .all(|(triangle, piece)| ground.look_around(piece, triangle, within))
                    || ground.look_around(wet, first, within);
                add(wet, (!is_plain).then_some((first, within)));
            } else {
                for (triangle, piece) in pieces.iter() {
                    let is_plain = ground.look_around(piece, triangle, within);
                    add(piece, (!is_plain).then_some((triangle, within)));
                }
            }
        }
        if height(ground.centroid) < 0.0 && deepest > allowed {
            // The other side of something thin.
            self.found.truncate(from);
        }
    }

    /// Makes manifolds of what was found, place by place.
    fn sort_points(&mut self, flat_weight: f64) {
        let Self {
            manifolds, found, ..
        } = self;
        let SurfaceManifolds {
            planes,
            points,
            normals,
            squares,
        } = manifolds;
        planes.clear();
        points.clear();
        normals.clear();
        squares.clear();
        for first in 0..found.len() {
            let place = found[first].place;
            let features = Some(Features::SurfacePlane(place));
            if planes.iter().any(|known| known.features == features) {
                continue;
            }
            let (from, mut area, mut depth) = (points.len(), 0.0, 0.0_f64);
            for found in found[first..].iter().filter(|found| found.place == place) {
                area += found.area;
                depth = depth.max(found.depth);
                points.push(ManifoldPoint {
                    key: points.len() as u32,
                    position: found.x,
                    weight: found.weight,
                    overlap: found.depth,
                });
                normals.push(-found.normal);
                squares.push(found.square);
            }
            planes.push(Manifold {
                normal: -found[first].normal,
                features,
                area,
                flat_weight,
                depth,
                points: from..points.len(),
            });
        }
    }
}

/// Visits points and areas (m²) that integrate quadratics over a convex polygon exactly.
fn integrate(polygon: &[Vec3], mut visit: impl FnMut(Vec3, f64)) {
    if let Some(fan) = Fan::new(polygon, Vec3::norm) {
        fan.for_each_point(|_, x, area| visit(x, area));
    }
}

/// Area of a convex polygon; m².
fn area(polygon: &[Vec3]) -> f64 {
    let mut sum = 0.0;
    integrate(polygon, |_, area| sum += area);
    sum
}

/// Keeps the side `normal · x ≤ offset`; corners on the plane once, as a point of no area would still be a contact.
fn cut(polygon: &mut Vec<Vec3>, spare: &mut Vec<Vec3>, normal: &Vec3, offset: f64) {
    let height = |x: &Vec3| normal.dot(x) - offset;
    clip((polygon, spare), OnPlane::Once, height, |at| at.point());
}
