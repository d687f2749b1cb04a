//! Contact patch of two overlapping polyhedra, and its points.
//!
//! If the common plane is a face, the faces of the other body that look at it are clipped by its
//! sides (Sutherland & Hodgman 1974), and what lies above the plane is cut off, so that the patch
//! grows from nothing and never jumps. If it is made by two edges, their closest points are the
//! contact.
//!
//! **The springs have a potential**, so that a body that rocks or rolls gets back what it gave:
//!
//! ```text
//! U = ½ k_a ∫ δ² dA + ½ k_c Σ_v α_v/2π δ_v²        δ > 0: overlap below the plane of the face     [J]
//! ```
//! the integral over what is below the plane, the sum over the corners of the patch as it would be
//! if the faces lay flat on each other (area `A₀`), `α_v` the angle by which its outline turns there.
//! The corners keep a body that comes down on one of them from sinking in without resistance. The
//! stiffness of the whole is shared out: `k_a = (1 − s) K/A₀` and `k_c = s K` for a stiffness K in
//! N/m, so that flat faces meet with K; `k_a = k` and `k_c = 4 k A_min` for a stiffness k in Pa/m.
//!
//! Angles, because they add up: where two equal faces meet, a twist of round-off makes one corner two,
//! or puts another where two sides cross at 1e-7 rad. Corners counted alike, or by the length of their
//! sides, jump in weight there, and the torque that jumps with them shook an arch to pieces.
//!
//! A face that is made of facets, as terrain is on top of a block, is all of them: each has its plane, and they share the
//! stiffness by their areas. The deepest corner and the plane's own facet may be at opposite ends of such a face; by that facet
//! alone there was no force, and blocks of a slide sank into each other by a fifth of their size.
//!
//! A fan of triangles around the middle of the patch is integrated from its corners and centroids, faces beside it from midpoints,
//!
//! ```text
//! ∫ f dA = A/12 (f₁ + f₂ + f₃) + 3A/4 f_centroid
//! ```
//! exact for quadratics, so that energy, force and moment of a linear overlap are exact.

use crate::contact::detection::common_plane::{Axis, AxisKind};
use crate::contact::detection::manifold::{Features, Manifold, ManifoldPoint};
use crate::geometry::clip::{Crossing, OnPlane, clip};
use crate::geometry::quadrature::{self, Fan, FanPoint, Midpoint};
use crate::material::Scaling;
use crate::{Polyhedron, Vec3};

impl ManifoldPoint {
    /// Point halfway between `x` on a face of normal `n` and the other body.
    fn on_face(key: u32, (x, n): (Vec3, &Vec3), weight: f64, overlap: f64) -> Self {
        Self {
            key,
            position: x + n * (0.5 * overlap),
            weight,
            overlap,
        }
    }
}

/// Corner of a clipped polygon and the name of the side that leaves it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Corner {
    x: Vec3,
    side: u16,
}

/// Finder of patches: the manifold last found, and the polygon it was clipped from.
#[derive(Clone, Debug, Default)]
pub(crate) struct Patch {
    pub manifold: Manifold<Vec<ManifoldPoint>>,
    corners: Vec<Corner>,
    spare: Vec<Corner>,
}

/// Side that no edge makes: the line where the overlap ends.
const WATERLINE: u16 = u16::MAX;
/// Stands for a side in the name of the point in the middle.
const MIDDLE: u16 = u16::MAX - 1;
/// Marks sides that are edges of B.
const OF_B: u16 = 0x4000;
/// A patch keeps at most this many corners.
const MAX_CORNERS: usize = 8;
/// Share `s` of the stiffness that sits in the corners of the patch.
pub(crate) const CORNER_SHARE: f64 = 1.0 / 3.0;
/// Weight of a contact of two edges, or of a corner beside the face: what a pyramid's area and tip
/// come to on the way in, so that taking over from one costs little (a pile of hulls loses 0.6 % of
/// its energy with 1/3, 18 % with 1/12).
const POINT_WEIGHT: f64 = 1.0 / 3.0;
/// `A_min` of a corner; × L² of the smaller body.
pub(crate) const CORNER_AREA: f64 = 1e-3;
/// Corners that cost less area than this are dropped: where two equal faces meet, every one is two;
/// × L² of the smaller body.
const NEGLIGIBLE_AREA: f64 = 1e-9;
/// A patch never counts as smaller than this; × L² of the smaller body.
const LEAST_AREA: f64 = 1e-2;
/// Cosine of two degrees: faces that differ by less are facets of one.
const ALMOST_COPLANAR: f64 = 0.999_390_8;
/// Faces that look at the plane by less than this cosine do not touch it.
const LOOKS_AWAY: f64 = 1e-3;

/// A face of one of the bodies, and the mark of that body's edges.
#[derive(Clone, Copy)]
struct Side<'a> {
    body: &'a Polyhedron,
    mark: u16,
}

/// Face that makes the plane, and the face of the other body that looks at it.
#[derive(Clone, Copy)]
struct Facing<'a> {
    reference: Side<'a>,
    face: usize,
    /// Of the reference face.
    normal: Vec3,
    other: Side<'a>,
    incident: usize,
}

impl<'a> Facing<'a> {
    fn of(reference: Side<'a>, face: u32, other: Side<'a>) -> Self {
        let face = face as usize;
        let normal = reference.body.face_normal(face);
        Self {
            reference,
            face,
            normal,
            other,
            incident: facing(other.body, &normal),
        }
    }

    /// Length of the smaller body; m.
    fn size(&self) -> f64 {
        self.reference.body.size().min(self.other.body.size())
    }

    /// Facets of the reference face, each with every facet of the incident one that looks at the plane.
    fn pieces(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let looks = |i: usize| self.other.body.face_normal(i).dot(&self.normal) <= -LOOKS_AWAY;
        facets(self.reference.body, self.face).flat_map(move |f| {
            let incidents = facets(self.other.body, self.incident);
            incidents
                .filter(move |&i| i == self.incident || looks(i))
                .map(move |i| (f, i))
        })
    }

    /// Faces of the other body beside the incident one that reach below a facet of the reference face and look at it.
    fn beside(&self, facet: usize) -> impl Iterator<Item = usize> + '_ {
        let (normal, offset) = self.plane(facet);
        let body = self.other.body;
        (0..body.n_faces()).filter(move |&side| {
            !is_facet(body, self.incident, side)
                && body.face_normal(side).dot(&normal) <= -LOOKS_AWAY
                && body
                    .face_vertices(side)
                    .any(|v| normal.dot(&body.vertices()[v as usize]) < offset)
        })
    }

    /// Plane of a facet of the reference face.
    fn plane(&self, facet: usize) -> (Vec3, f64) {
        let body = self.reference.body;
        (body.face_normal(facet), body.face_offset(facet))
    }

    /// Offset of the point keys of a pair of facets from those of the main faces.
    fn key_offset(&self, facet: usize, incident: usize) -> u32 {
        facet_key_offset(facet, self.face, 0x85eb_ca6b).wrapping_add(facet_key_offset(
            incident,
            self.incident,
            0x9e37_79b1,
        ))
    }
}

impl Patch {
    /// Patch of two bodies with the common plane `axis`. A bonded patch keeps the parts that have
    /// opened; their overlap is negative.
    pub fn find(
        &mut self,
        a: &Polyhedron,
        b: &Polyhedron,
        axis: &Axis,
        scaling: Scaling,
        is_bonded: bool,
    ) {
        let found = &mut self.manifold;
        found.points.clear();
        found.area = 0.0;
        found.flat_weight = 0.0;
        found.normal = axis.normal;
        found.depth = (-axis.gap).max(0.0);
        let size = a.size().min(b.size());
        let (side_a, side_b) = (
            Side { body: a, mark: 0 },
            Side {
                body: b,
                mark: OF_B,
            },
        );
        let point_weight = match scaling {
            Scaling::Point => POINT_WEIGHT,
            Scaling::Area => CORNER_AREA * size * size,
        };
        let facing = match axis.kind {
            AxisKind::FaceA(face) => Some(Facing::of(side_a, face, side_b)),
            AxisKind::FaceB(face) => Some(Facing::of(side_b, face, side_a)),
            _ => None,
        };
        let incident = facing.map(|facing| facing.incident as u32);
        found.features = Some(Features::CommonPlane(axis.kind, incident));
        match axis.kind {
            AxisKind::Edges(edge_a, edge_b) => {
                let key = (edge_a & 0x3fff) << 16 | (edge_b & 0x3fff) | u32::from(OF_B);
                let position = edge_contact(a, edge_a, b, edge_b);
                self.manifold.flat_weight = point_weight;
                self.push_single(key, position, point_weight, -axis.gap);
            }
            _ => {
                if let Some(facing) = &facing {
                    self.clip_faces(facing, scaling, is_bonded);
                }
            }
        }
        // A patch of no width has corners that turn by nothing.
        self.manifold.points.retain(|point| point.weight > 0.0);
        // A bond whose faces have slid past each other holds nothing.
        if self.manifold.points.is_empty() && !is_bonded {
            self.manifold.flat_weight = point_weight;
            self.manifold.features = Some(Features::CommonPlane(axis.kind, None));
            // The face that looks at the plane misses it: a corner beside it is deepest.
            let key = u32::from(WATERLINE);
            self.push_single(key, deepest_corners(a, b, axis), point_weight, -axis.gap);
        }
    }

    /// Points of two bodies that are near each other, with the common plane `axis`: the corners of the faces that look at each other,
    /// clipped to what both cover, whatever their overlap; at most four of a face. All have the weight 1.
    pub fn find_outline(&mut self, a: &Polyhedron, b: &Polyhedron, axis: &Axis) {
        self.manifold.points.clear();
        self.manifold.normal = axis.normal;
        let (of_a, of_b) = (
            Side { body: a, mark: 0 },
            Side {
                body: b,
                mark: OF_B,
            },
        );
        let facing = match axis.kind {
            AxisKind::FaceA(face) => Facing::of(of_a, face, of_b),
            AxisKind::FaceB(face) => Facing::of(of_b, face, of_a),
            AxisKind::Edges(edge_a, edge_b) => {
                let key = (edge_a & 0x3fff) << 16 | (edge_b & 0x3fff) | u32::from(OF_B);
                self.push_single(key, edge_contact(a, edge_a, b, edge_b), 1.0, -axis.gap);
                return;
            }
            AxisKind::Other => return,
        };
        for (facet, incident) in facing.pieces() {
            self.clip_by_sides(&facing, facet, incident);
            self.keep_widest(&facing.normal);
            let plane = facing.plane(facet);
            self.push_outline(&plane, facing.key_offset(facet, incident));
        }
        if self.manifold.points.is_empty() && axis.gap <= 0.0 {
            let key = u32::from(WATERLINE);
            self.push_single(key, deepest_corners(a, b, axis), 1.0, -axis.gap);
        }
    }

    /// Keeps the four corners of the polygon in the buffer that lose least of its area.
    fn keep_widest(&mut self, normal: &Vec3) {
        while self.corners.len() > 4
            && let Some((k, _)) = self.least_corner(normal)
        {
            self.corners.remove(k);
        }
    }

    fn push_outline(&mut self, (n, offset): &(Vec3, f64), key_offset: u32) {
        let count = self.corners.len();
        if count < 3 {
            return;
        }
        for k in 0..count {
            let (before, here) = (self.corners[(k + count - 1) % count], self.corners[k]);
            let key = corner_key(before, here).wrapping_add(key_offset);
            let point = ManifoldPoint::on_face(key, (here.x, n), 1.0, offset - n.dot(&here.x));
            self.manifold.points.push(point);
        }
    }

    /// Corners of the patch last found, if it was a bonded one.
    pub fn bonded_outline(&self) -> impl Iterator<Item = Vec3> + Clone + '_ {
        self.corners.iter().map(|corner| corner.x)
    }

    fn push_single(&mut self, key: u32, position: Vec3, weight: f64, overlap: f64) {
        self.manifold.points.push(ManifoldPoint {
            key,
            position,
            weight,
            overlap,
        });
    }

    /// Points of the incident face below the facets of the reference face, and of the faces beside it.
    fn clip_faces(&mut self, faces: &Facing, scaling: Scaling, is_bonded: bool) {
        let n_kept = if is_bonded { 1 } else { usize::MAX };
        let (mut flat_area, mut n_pieces) = (0.0, 0);
        for (facet, incident) in faces.pieces().take(n_kept) {
            self.clip_by_sides(faces, facet, incident);
            flat_area += self.fan_area(&faces.plane(facet).0);
            n_pieces += 1;
        }
        if flat_area.is_nan() || flat_area <= 0.0 {
            return;
        }
        let size = faces.size();
        let (per_area, per_angle) = match scaling {
            Scaling::Point => (
                (1.0 - CORNER_SHARE) / flat_area.max(LEAST_AREA * size * size),
                CORNER_SHARE / std::f64::consts::TAU,
            ),
            Scaling::Area => (1.0, 4.0 * CORNER_AREA * size * size / std::f64::consts::TAU),
        };
        self.manifold.flat_weight = match scaling {
            Scaling::Point => 1.0,
            Scaling::Area => flat_area + 4.0 * CORNER_AREA * size * size,
        };
        for (facet, incident) in faces.pieces().take(n_kept) {
            if n_pieces > 1 {
                self.clip_by_sides(faces, facet, incident);
            }
            let plane = faces.plane(facet);
            let area = self.fan_area(&plane.0);
            let key_offset = faces.key_offset(facet, incident);
            let own = self.manifold.points.len();
            self.push_corners(plane, per_angle * (area / flat_area), key_offset, is_bonded);
            if !is_bonded {
                self.clip(&plane.0, plane.1, WATERLINE);
            }
            self.push_fan(&plane, per_area, key_offset, own);
        }
        if !is_bonded {
            self.push_sides(faces, per_area);
        }
    }

    /// Points of the faces beside the incident one that reach below the plane.
    fn push_sides(&mut self, faces: &Facing, per_area: f64) {
        for facet in facets(faces.reference.body, faces.face) {
            let plane = faces.plane(facet);
            for side in faces.beside(facet) {
                self.clip_by_sides(faces, facet, side);
                self.clip(&plane.0, plane.1, WATERLINE);
                self.push_midpoints(&plane, per_area, faces.key_offset(facet, side));
            }
        }
    }

    /// Points of the area of the polygon in the buffer: what lies beside the patch is narrow, and few points resist its twist as many.
    fn push_midpoints(&mut self, plane: &(Vec3, f64), per_area: f64, key_offset: u32) {
        let (n, offset) = plane;
        let Self {
            manifold, corners, ..
        } = self;
        let twice_area = |cross: &Vec3| cross.dot(n).abs();
        quadrature::for_each_midpoint(corners, twice_area, |at, x, area| {
            manifold.area += area;
            let name = match at {
                // On the waterline there is no overlap and no force.
                Midpoint::Side(k) if corners[k].side == WATERLINE => return,
                Midpoint::Side(k) => corner_key(corners[k], corners[k]),
                Midpoint::Diagonal(k) => corner_key(corners[0], corners[k]),
            };
            let weight = area * per_area;
            if weight > 0.0 {
                let key = name.wrapping_add(key_offset);
                let overlap = offset - n.dot(&x);
                let point = ManifoldPoint::on_face(key, (x, n), weight, overlap);
                manifold.points.push(point);
            }
        });
    }

    /// Points of the corners of the polygon in the buffer, `per_angle` the weight of a radian by which its outline turns.
    fn push_corners(
        &mut self,
        (n, offset): (Vec3, f64),
        per_angle: f64,
        key_offset: u32,
        is_bonded: bool,
    ) {
        let count = self.corners.len();
        if count < 3 {
            return;
        }
        for k in 0..count {
            let [before, here, next] = [k + count - 1, k, k + 1].map(|i| self.corners[i % count]);
            let overlap = offset - n.dot(&here.x);
            if overlap > 0.0 || is_bonded {
                let (back, forth) = (here.x - before.x, next.x - here.x);
                let turn = back.cross(&forth).norm().atan2(back.dot(&forth));
                let key = corner_key(before, here).wrapping_add(key_offset);
                let weight = per_angle * turn;
                self.manifold.points.push(ManifoldPoint::on_face(
                    key,
                    (here.x, &n),
                    weight,
                    overlap,
                ));
            }
        }
    }

    /// A face of the other body inside of the prism over a facet along the normal of the reference face.
    fn clip_by_sides(&mut self, faces: &Facing, facet: usize, incident: usize) {
        let Facing {
            reference, other, ..
        } = faces;
        let (body, n) = (reference.body, &faces.normal);
        self.corners.clear();
        for e in other.body.face_loop(incident) {
            self.corners.push(Corner {
                x: other.body.vertices()[other.body.origin(e) as usize],
                side: side_name(e, other.mark),
            });
        }
        for e in body.face_loop(facet) {
            let a = body.vertices()[body.origin(e) as usize];
            let outward = (body.vertices()[body.origin(body.next(e)) as usize] - a).cross(n);
            self.clip(&outward, outward.dot(&a), side_name(e, reference.mark));
        }
        let size = faces.size();
        let negligible = NEGLIGIBLE_AREA * size * size;
        while let Some((k, area)) = self.least_corner(n)
            && self.corners.len() > 3
            && (area <= negligible || self.corners.len() > MAX_CORNERS)
        {
            self.corners.remove(k);
        }
    }

    /// Keeps the side `normal · x ≤ offset`, `side` the name of the side that the plane makes.
    fn clip(&mut self, normal: &Vec3, offset: f64, side: u16) {
        clip(
            (&mut self.corners, &mut self.spare),
            OnPlane::Twice,
            |corner| normal.dot(&corner.x) - offset,
            |Crossing {
                 from,
                 to,
                 share,
                 is_leaving,
             }| Corner {
                x: from.x + (to.x - from.x) * share,
                side: if is_leaving { side } else { from.side },
            },
        );
    }

    /// The corner that costs least area if it is dropped, and twice that area.
    fn least_corner(&self, n: &Vec3) -> Option<(usize, f64)> {
        let count = self.corners.len();
        let lost = |k: usize| {
            let [a, b, c] = [k + count - 1, k, k + 1].map(|i| self.corners[i % count].x);
            (b - a).cross(&(c - a)).dot(n).abs()
        };
        (0..count)
            .map(|k| (k, lost(k)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Area of the polygon in the buffer, projected along `n`; m².
    fn fan_area(&self, n: &Vec3) -> f64 {
        fan(&self.corners, n).map_or(0.0, |fan| fan.area())
    }

    /// Points of the polygon in the buffer, `per_area` the weight of a unit of area. The keys of different
    /// facets differ by `key_offset`; corners of the polygon that are among the points already, from `own`
    /// on, are shared.
    fn push_fan(&mut self, plane: &(Vec3, f64), per_area: f64, key_offset: u32, own: usize) {
        let (n, offset) = plane;
        let Self {
            manifold, corners, ..
        } = self;
        let Some(fan) = fan(corners, n) else { return };
        let total = fan.area();
        if total.is_nan() || total <= 0.0 {
            return;
        }
        manifold.area += total;
        let points = &mut manifold.points;
        let count = corners.len();
        fan.for_each_point(|at, x, area| {
            let weight = area * per_area;
            let name = match at {
                FanPoint::Corner(k) => {
                    let (previous, here) = (corners[(k + count - 1) % count], corners[k]);
                    // On the waterline there is no overlap and no force.
                    if here.side == WATERLINE || previous.side == WATERLINE {
                        return;
                    }
                    corner_key(previous, here)
                }
                FanPoint::Triangle(k) => corner_key(corners[k], corners[k]),
                FanPoint::Middle => u32::from(MIDDLE),
            };
            let key = name.wrapping_add(key_offset);
            let is_shared = |point: &&mut ManifoldPoint| point.key == key;
            if matches!(at, FanPoint::Corner(_))
                && let Some(corner) = points[own..].iter_mut().find(is_shared)
            {
                corner.weight += weight;
                return;
            }
            let overlap = offset - n.dot(&x);
            points.push(ManifoldPoint::on_face(key, (x, n), weight, overlap));
        });
    }
}

impl quadrature::Corner for Corner {
    fn position(&self) -> Vec3 {
        self.x
    }
}

/// Fan of a polygon with the areas projected along `n`; seen along −n the loop of the other body's face runs
/// clockwise.
fn fan<'a>(corners: &'a [Corner], n: &Vec3) -> Option<Fan<'a, Corner, impl Fn(&Vec3) -> f64>> {
    Fan::new(corners, |cross: &Vec3| cross.dot(n).abs())
}

/// A face and those that are nearly coplanar with it, the face first.
fn facets(body: &Polyhedron, face: usize) -> impl Iterator<Item = usize> + '_ {
    let others = (0..body.n_faces())
        .filter(move |&f| f != face && !body.is_hidden(f) && is_facet(body, face, f));
    std::iter::once(face).chain(others)
}

fn is_facet(body: &Polyhedron, face: usize, other: usize) -> bool {
    face == other || body.face_normal(face).dot(&body.face_normal(other)) >= ALMOST_COPLANAR
}

/// Offset of the point keys of a facet from those of the main face.
fn facet_key_offset(face: usize, main: usize, factor: u32) -> u32 {
    if face == main {
        0
    } else {
        (face as u32 + 1).wrapping_mul(factor)
    }
}

/// Name of the corner where one side ends and another begins.
fn corner_key(before: Corner, here: Corner) -> u32 {
    u32::from(before.side) << 16 | u32::from(here.side)
}

fn side_name(half_edge: u32, mark: u16) -> u16 {
    (half_edge & 0x3fff) as u16 | mark
}

/// Of the faces at the corner that lies lowest in a direction, the one that looks most against it. Another
/// face may look more against it, but it lies higher: a spike is met before the flat beside it.
fn facing(body: &Polyhedron, n: &Vec3) -> usize {
    let mut lowest = (f64::INFINITY, 0);
    for (vertex, x) in body.vertices().iter().enumerate() {
        let height = n.dot(x);
        if height < lowest.0 {
            lowest = (height, vertex as u32);
        }
    }
    let mut best = (f64::INFINITY, 0);
    for face in body.faces_around_vertex(lowest.1) {
        let cos = body.face_normal(face).dot(n);
        if cos < best.0 {
            best = (cos, face);
        }
    }
    best.1
}

/// Middle between the closest points of two edges' lines, kept on the edges.
fn edge_contact(a: &Polyhedron, edge_a: u32, b: &Polyhedron, edge_b: u32) -> Vec3 {
    let ends = |body: &Polyhedron, e: u32| {
        let from = body.vertices()[body.origin(e) as usize];
        (from, body.vertices()[body.target(e) as usize] - from)
    };
    let ((p, u), (q, v)) = (ends(a, edge_a), ends(b, edge_b));
    let (uu, uv, vv) = (u.norm_squared(), u.dot(&v), v.norm_squared());
    let w = q - p;
    let determinant = uu * vv - uv * uv;
    let on_a = if determinant > 0.0 {
        ((w.dot(&u) * vv - w.dot(&v) * uv) / determinant).clamp(0.0, 1.0)
    } else {
        0.5
    };
    let on_b = (((p + u * on_a) - q).dot(&v) / vv).clamp(0.0, 1.0);
    0.5 * (p + u * on_a + q + v * on_b)
}

/// Mean, by depth, of the corners that overlap of the body without the plane's face, lifted to the middle
/// of the overlap. A mean, so that an edge that comes in level is not held at one end.
fn deepest_corners(a: &Polyhedron, b: &Polyhedron, axis: &Axis) -> Vec3 {
    let (body, toward) = match axis.kind {
        AxisKind::FaceB(_) => (a, axis.normal),
        _ => (b, -axis.normal),
    };
    let height = |x: &Vec3| x.dot(&toward);
    let highest = body
        .vertices()
        .iter()
        .map(height)
        .fold(f64::NEG_INFINITY, f64::max);
    let plane = highest + axis.gap;
    let (mut sum, mut total) = (Vec3::zeros(), 0.0);
    for x in body.vertices().iter().filter(|x| height(x) >= plane) {
        // Touching only, all count alike; so do corners whose depth is lost in round-off.
        let depth = (height(x) - plane).max(f64::MIN_POSITIVE);
        sum += x * depth;
        total += depth;
    }
    sum / total + toward * (0.5 * axis.gap)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::Isometry;
    use crate::contact::detection::common_plane::separating_axes;

    fn touching(offset: Vec3, turn: f64) -> Patch {
        let a = Polyhedron::cuboid(Vec3::repeat(-0.5), Vec3::repeat(0.5)).unwrap();
        let b = a.transformed(&Isometry::new(offset, Vec3::z() * turn));
        let mut patch = Patch::default();
        patch.find(
            &a,
            &b,
            &separating_axes(&a, &b).best(),
            Scaling::Point,
            false,
        );
        patch
    }

    #[test]
    fn area_of_two_unit_squares() {
        // D16
        let shifted = touching(Vec3::new(0.3, 0.2, 1.0 - 1e-4), 0.0);
        assert!(
            (shifted.manifold.area - 0.56).abs() < 1e-12,
            "{}",
            shifted.manifold.area
        );
        let turned = touching(Vec3::new(0.0, 0.0, 1.0 - 1e-4), std::f64::consts::FRAC_PI_4);
        assert!(
            (turned.manifold.area - 2.0 * (2.0_f64.sqrt() - 1.0)).abs() < 1e-12,
            "{}",
            turned.manifold.area
        );
    }

    #[test]
    fn weights_integrate_quadratics() {
        let patch = touching(Vec3::new(0.3, 0.2, 1.0 - 1e-4), 0.0);
        let middle = Vec3::new(0.15, 0.1, 0.5);
        let sum =
            |f: &dyn Fn(&ManifoldPoint) -> f64| patch.manifold.points.iter().map(f).sum::<f64>();
        assert!((sum(&|p| p.weight) - 1.0).abs() < 1e-15);
        assert!(sum(&|p| p.weight * (p.position - middle).x).abs() < 1e-15);
        // Mean square distance from the middle of a side of 0.7 m.
        // A rectangle turns by a quarter at each corner.
        let corners = CORNER_SHARE * 0.49 / 4.0 + (1.0 - CORNER_SHARE) * 0.49 / 12.0;
        assert!((sum(&|p| p.weight * (p.position - middle).x.powi(2)) - corners).abs() < 1e-15);
        assert!(
            patch
                .manifold
                .points
                .iter()
                .all(|p| (p.overlap - 1e-4).abs() < 1e-15)
        );
    }

    /// A face broken along a ridge of 1e-5 m presses like a flat one, whichever of its facets makes the plane, and which body has it. By
    /// the narrow facet alone all of the force was at its end; against it a face was up to ten times as stiff.
    #[test]
    fn facets_press_like_the_face_they_make() {
        let corners = [-0.5, 0.5].map(|x| [-0.5, 0.5].map(|y| Vec3::new(x, y, -1.0)));
        let top = [(-0.5, 0.0), (0.4, 1e-5), (0.5, 0.0)]
            .map(|(x, z)| [-0.5, 0.5].map(|y| Vec3::new(x, y, z)));
        let points: Vec<Vec3> = corners.into_iter().chain(top).flatten().collect();
        let broken = Polyhedron::convex_hull(&points).unwrap();
        let depth = 0.01;
        let upper = Polyhedron::cuboid(
            Vec3::new(-0.3, -0.4, -depth),
            Vec3::new(0.45, 0.3, 1.0 - depth),
        )
        .unwrap();
        let level = |body: &Polyhedron, up: f64| -> Vec<usize> {
            let faces = 0..body.n_faces();
            faces
                .filter(|&f| up * body.face_normal(f).z > 0.99)
                .collect()
        };
        let press = |kind: AxisKind, normal: Vec3| {
            let axis = Axis {
                normal,
                gap: crate::gap_along(&broken, &upper, &normal),
                kind,
            };
            let mut patch = Patch::default();
            patch.find(&broken, &upper, &axis, Scaling::Point, false);
            let force: f64 = patch
                .manifold
                .points
                .iter()
                .map(|p| p.weight * p.overlap)
                .sum();
            let moment: Vec3 = patch
                .manifold
                .points
                .iter()
                .map(|p| p.position * (p.weight * p.overlap))
                .sum();
            let case = format!("{kind:?}: {force}, {:?}", moment / force);
            // the ridge is a thousandth of the depth, and corners of a facet of 5 cm are a tenth of all
            assert!((force / depth - 1.0).abs() < 2e-3, "{case}");
            assert!(
                (moment / force - Vec3::new(0.075, -0.05, -0.005)).norm() < 0.02,
                "{case}"
            );
        };
        let facets = level(&broken, 1.0);
        assert_eq!(facets.len(), 2);
        for face in facets {
            press(AxisKind::FaceA(face as u32), broken.face_normal(face));
        }
        for face in level(&upper, -1.0) {
            press(AxisKind::FaceB(face as u32), -upper.face_normal(face));
        }
    }

    #[test]
    fn keys_are_unique() {
        let patch = touching(Vec3::new(0.0, 0.0, 1.0 - 1e-4), 0.7);
        let mut keys: Vec<u32> = patch.manifold.points.iter().map(|p| p.key).collect();
        keys.sort_unstable();
        keys.dedup();
        // Eight corners, eight triangles, the middle.
        assert_eq!(keys.len(), 17);
    }
}
