//! Contact with a surface of triangles.
//!
//! A polyhedron meets it all over its own surface `S`, by a potential that depends on its place alone:
//!
//! ```text
//! U = ½ K ( (1 − s)/A₀ ∫_S d² dA + s Σ_v w_v d_v² ),   d > 0: depth behind the nearest triangle      [J]
//! ```
//! `A₀ = V^2/3`; `w_v` is the share of the faces that meet in corner v, so that a cube which lies flat feels
//! K; with a stiffness k per area it is `½ k (∫ d² dA + 4 A_min Σ w_v d_v²)`. The depth of a corner is its
//! distance from the surface, exact at valleys and ridges. For the faces, each triangle takes what lies
//! behind it between the planes that halve the angles at its sides, where the depth is continuous: no edge
//! of the mesh kicks, ridges are felt by the faces they press into, and triangles of one plane add up to
//! that plane to round-off. Only where many triangles meet in a point do their shares leave or overlap a
//! little, of the order of the overlap squared. Friction has one spring for each plane, and for each vertex
//! that a corner is nearest to; at the bottom of a valley a corner leans on both sides.
//!
//! The faces of a body heed a triangle while its centroid is in front of it or what is behind is no deeper
//! than the allowed overlap: what is farther behind belongs to the other side of something thin. At the rim
//! of an open surface there is nothing to fall against: bodies should not get there.
//!
//! A sphere touches at the feet where the surface is locally nearest; feet whose normals differ by less than
//! 5 degrees are one.

use crate::contact::context::ContactContext;
use crate::contact::detection::patch::{CORNER_AREA, CORNER_SHARE, PatchPoint};
use crate::contact::penalty::friction::{ShearSpring, Shearing};
use crate::contact::penalty::polyhedra::PointForce;
use crate::contact::penalty::spheres::BallOnSurface;
use crate::contact::rates::Rates;
use crate::contact::report::{Contact, ContactState, PointState};
use crate::contact::tally::Tally;
use crate::geometry::clip::{OnPlane, clip};
use crate::geometry::parts::Part;
use crate::geometry::quadrature::Fan;
use crate::material::Scaling;
use crate::material::SphereJoint;
use crate::motion::kinematics::{Kinematics, Load};
use crate::{Polyhedron, Surface, Vec3};
use serde::{Deserialize, Serialize};

/// A part that may touch a surface: i is the body, j the surface, whatever their numbers.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SurfacePair {
    pub parts: (u32, u32),
    pub blocks: (u32, u32),
    /// Triangles near the body.
    pub triangles: Vec<u32>,
    pub touch: SurfaceTouch,
    /// On the body and on the surface, torque about their centroids.
    pub loads: (Load, Load),
    /// Contribution of the pair to the step bound of the body.
    pub rates: Rates,
    pub is_touching: bool,
    /// Energy lost in the last sub-step; J.
    pub friction: f64,
    pub damping: f64,
    /// See [`Tally::rolling_impulse`]; N m s.
    pub rolling_impulse: Vec3,
    /// Deepest overlap; m.
    pub deepest: f64,
    /// Correction to the next half kick, on the surface; empty between two steps. As between polyhedra, and for
    /// polyhedra only.
    #[serde(skip)]
    pub excess: Vec<PointForce>,
}

/// Kind of contact with a surface.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum SurfaceTouch {
    Polyhedron(Box<PolyhedronTouch>),
    /// The places where a sphere touches.
    Ball(Vec<BallOnSurface>),
}

/// Memory and buffers of a polyhedron on a surface.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct PolyhedronTouch {
    /// One per corner of the body, sums to about 1 over the corners of a face.
    corner_weight: Vec<f64>,
    /// `A₀`; m².
    face_area: f64,
    /// Contact points, those of one plane together.
    pub points: Vec<PointState>,
    /// Normals of the points, out of the surface.
    normals: Vec<Vec3>,
    /// Squared depths of the points, as they count for the energy; m².
    squares: Vec<f64>,
    pub planes: Vec<PlaneTouch>,
    before: Vec<PlaneTouch>,
    /// Energy of the normal springs; J.
    elastic: f64,
    /// Points of the step before, and their normals.
    #[serde(skip)]
    former: (Vec<PointState>, Vec<Vec3>),
    #[serde(skip)]
    found: Vec<Found>,
    /// Part of a face behind a plane, and its pieces.
    #[serde(skip)]
    wet: Vec<Vec3>,
    #[serde(skip)]
    polygon: Vec<Vec3>,
    #[serde(skip)]
    spare: Vec<Vec3>,
}

/// A point behind the surface.
#[derive(Clone, Copy, Debug)]
struct Found {
    place: u32,
    normal: Vec3,
    x: Vec3,
    weight: f64,
    depth: f64,
    /// Weight in the energy, counted once for a corner that touches two sides; m².
    square: f64,
}

/// Contact with one plane of the surface, or one vertex.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct PlaneTouch {
    place: u32,
    /// From the body into the surface.
    pub normal: Vec3,
    /// Past the last of its points.
    end: usize,
    pub shear: ShearSpring,
    has_slipped: bool,
    pub energy: f64,
}

/// Faces that look at a plane by less than this cosine do not touch it.
const LOOKS_AWAY: f64 = 1e-3;
/// Areas that differ by less are equal; –.
const ROUND_OFF: f64 = 1e-9;

impl SurfacePair {
    pub fn new(parts: (u32, u32), blocks: (u32, u32), body: &Part) -> Self {
        let touch = match body {
            Part::Polyhedron(body) => SurfaceTouch::Polyhedron(Box::new(PolyhedronTouch::of(body))),
            Part::Sphere { .. } | Part::Surface(_) => SurfaceTouch::Ball(Vec::new()),
        };
        Self {
            parts,
            blocks,
            triangles: Vec::new(),
            touch,
            loads: (Load::default(), Load::default()),
            rates: Rates::default(),
            is_touching: false,
            friction: 0.0,
            rolling_impulse: Vec3::zeros(),
            damping: 0.0,
            deepest: 0.0,
            excess: Vec::new(),
        }
    }

    /// Energy of the springs; J. A sphere's law and radius (m).
    pub fn energy(&self, law: &SphereJoint, radius: f64) -> f64 {
        match &self.touch {
            SurfaceTouch::Polyhedron(touch) => touch.energy(),
            SurfaceTouch::Ball(feet) => feet.iter().map(|foot| foot.energy(law, radius)).sum(),
        }
    }

    /// Finds what touches at the current position, and the forces at the present velocities; books what was
    /// lost during the last `dt` (s).
    pub fn evaluate(&mut self, context: &ContactContext, dt: f64) {
        let Part::Surface(surface) = &context.parts[self.parts.1 as usize] else {
            return;
        };
        self.friction = 0.0;
        self.damping = 0.0;
        self.rolling_impulse = Vec3::zeros();
        self.deepest = 0.0;
        self.loads = (Load::default(), Load::default());
        match (&mut self.touch, &context.parts[self.parts.0 as usize]) {
            (SurfaceTouch::Polyhedron(_), Part::Polyhedron(body)) => {
                let allowed = context.deepest_allowed[self.parts.0 as usize];
                self.evaluate_polyhedron(surface, body, context, allowed, dt);
            }
            (SurfaceTouch::Ball(_), Part::Sphere { center, radius }) => {
                self.evaluate_ball(surface, (center, *radius), context, dt);
            }
            _ => {}
        }
        if !self.is_touching {
            self.rates = self.rates_before_touch(context);
        }
    }

    pub fn n_contacts(&self) -> usize {
        match &self.touch {
            SurfaceTouch::Polyhedron(touch) => touch.points.len(),
            SurfaceTouch::Ball(feet) => feet.len(),
        }
    }

    /// Visits the contact points.
    pub fn for_each_contact(&self, visit: &mut dyn FnMut(Contact)) {
        let pair = |of: (u32, u32)| (of.0 as usize, of.1 as usize);
        let (blocks, parts) = (pair(self.blocks), pair(self.parts));
        match &self.touch {
            SurfaceTouch::Polyhedron(touch) => {
                for (point, n) in touch.points.iter().zip(&touch.normals) {
                    visit(Contact {
                        blocks,
                        parts,
                        key: point.patch.key,
                        point: point.patch.position,
                        normal: -n,
                        normal_force: point.normal_force,
                        shear_force: point.shear_force,
                        overlap: point.patch.overlap,
                        state: point.state,
                    });
                }
            }
            SurfaceTouch::Ball(feet) => {
                for (key, foot) in (0..).zip(feet) {
                    let contact = &foot.contact;
                    visit(Contact {
                        blocks,
                        parts,
                        key,
                        point: foot.loads.point,
                        normal: contact.normal,
                        normal_force: contact.normal_force,
                        shear_force: foot.loads.force - contact.normal * contact.normal_force,
                        overlap: contact.overlap,
                        state: contact.state(),
                    });
                }
            }
        }
    }

    /// Visits every number of the state.
    pub fn for_each_state_f64(&self, f: &mut dyn FnMut(f64)) {
        match &self.touch {
            SurfaceTouch::Polyhedron(touch) => {
                for plane in &touch.planes {
                    f(f64::from(plane.place));
                    plane.shear.shift.iter().for_each(|&c| f(c));
                    plane.shear.center.iter().for_each(|&c| f(c));
                    f(plane.shear.twist);
                    f(plane.shear.weight);
                    f(plane.energy);
                    f(f64::from(u8::from(plane.has_slipped)));
                }
                for point in &touch.points {
                    f(point.normal_force);
                    f(point.normal_viscous);
                    point.shear_force.iter().for_each(|&c| f(c));
                    point.shear_viscous.iter().for_each(|&c| f(c));
                }
            }
            SurfaceTouch::Ball(feet) => {
                for foot in feet {
                    foot.contact.normal.iter().for_each(|&c| f(c));
                    foot.contact.shear.iter().for_each(|&c| f(c));
                    foot.loads.force.iter().for_each(|&c| f(c));
                    f(f64::from(u8::from(foot.contact.is_slipping)));
                    foot.rolling.for_each_state_f64(f);
                }
            }
        }
    }

    fn rates_before_touch(&self, context: &ContactContext) -> Rates {
        let joint = context.joint_of(self.parts);
        let body = &context.kinematics[self.blocks.0 as usize];
        let radius = context.radius[self.blocks.0 as usize];
        let weight = match (&self.touch, joint.scaling) {
            (SurfaceTouch::Polyhedron(_), Scaling::Area) => std::f64::consts::PI * radius * radius,
            _ => 1.0,
        };
        let (along, sum) = body.worst_compliance(context.lever[self.blocks.0 as usize]);
        let dashpot = |k: f64, ratio: f64| 2.0 * ratio * (k / body.inverse_mass).sqrt();
        let (k_n, k_t) = (
            joint.normal_stiffness * weight,
            joint.shear_stiffness * weight,
        );
        Rates {
            stiffness: k_n * along + k_t * (sum - along),
            damping: dashpot(k_n, joint.damping_ratio) * along
                + dashpot(k_t, context.shear_damping_ratio) * (sum - along),
        }
    }

    fn evaluate_polyhedron(
        &mut self,
        surface: &Surface,
        body: &Polyhedron,
        context: &ContactContext,
        allowed: f64,
        dt: f64,
    ) {
        let SurfaceTouch::Polyhedron(touch) = &mut self.touch else {
            return;
        };
        let joint = context.joint_of(self.parts);
        let kinematics = &context.kinematics[self.blocks.0 as usize];
        let ground = &context.kinematics[self.blocks.1 as usize];
        let held_before: f64 = touch.planes.iter().map(|plane| plane.energy).sum();
        let elastic_before = touch.elastic;
        let was_touching = self.is_touching;
        self.excess.clear();
        let (friction, damping) = touch.work(kinematics, dt, dt);
        self.friction = friction + held_before;
        self.damping = damping;

        touch.find(
            surface,
            body,
            &self.triangles,
            &kinematics.centroid,
            (joint.scaling, allowed),
        );
        self.deepest = touch
            .points
            .iter()
            .map(|p| p.patch.overlap)
            .fold(0.0, f64::max);
        self.is_touching = !touch.points.is_empty();
        if !self.is_touching {
            touch.planes.clear();
            touch.elastic = 0.0;
            if was_touching {
                let (points, normals) = (&touch.former.0, &touch.former.1);
                // What the springs still held is lost.
                let given = work_of_normal_springs(points, normals, kinematics, (dt, dt));
                self.damping += elastic_before - given;
                self.spare(elastic_before / given, context, (dt, dt));
            }
            return;
        }
        let total: f64 = touch.points.iter().map(|p| p.patch.weight).sum();
        let dashpot = touch.apply_normal(kinematics, joint.normal_stiffness, joint.damping_ratio);
        let mut rates = Rates::default();
        for (point, n) in touch.points.iter().zip(&touch.normals) {
            let along = point.patch.weight * kinematics.compliance(&point.patch.position, n);
            rates.stiffness += joint.normal_stiffness * along;
            rates.damping += dashpot * along;
        }
        let weight = match joint.scaling {
            Scaling::Point => 1.0,
            Scaling::Area => touch.face_area,
        };
        let mut first = 0;
        for plane in &mut touch.planes {
            let points = &mut touch.points[first..plane.end];
            let friction = if plane.has_slipped {
                joint.residual_friction
            } else {
                joint.friction
            };
            let sheared = Shearing {
                bodies: (kinematics, ground),
                normal: plane.normal,
                weight,
                stiffness: joint.shear_stiffness,
                damping_ratio: context.shear_damping_ratio,
                friction,
                cohesion: 0.0,
                is_bonded: false,
                dt,
            }
            .apply(points, &plane.shear);
            // On j, the ground; the body gets the opposite.
            plane.shear = sheared.spring;
            plane.energy = sheared.energy;
            plane.has_slipped |= sheared.has_slipped;
            let pressed: f64 = points.iter().map(|p| p.normal_force).sum();
            for point in points {
                let share = if pressed > 0.0 {
                    point.normal_force / pressed
                } else {
                    point.patch.weight / total
                };
                let x = &point.patch.position;
                let across = share
                    * (kinematics.compliance_trace(x) - kinematics.compliance(x, &plane.normal));
                rates.stiffness += joint.shear_stiffness * weight * across;
                rates.damping += sheared.damping * across;
            }
            first = plane.end;
        }
        for (point, n) in touch.points.iter().zip(&touch.normals) {
            let x = &point.patch.position;
            let force = n * point.normal_force - point.shear_force;
            self.loads.0.add(&force, &(x - kinematics.centroid));
            self.loads.1.add(&-force, &(x - ground.centroid));
        }
        self.rates = rates;
        let (friction, damping) = touch.work(kinematics, dt, 0.0);
        self.friction += friction - touch.planes.iter().map(|plane| plane.energy).sum::<f64>();
        self.damping += damping;
        if !was_touching {
            let (points, normals) = (&touch.points, &touch.normals);
            let taken = -work_of_normal_springs(points, normals, kinematics, (dt, 0.0));
            let share = touch.elastic / taken;
            self.spare(share, context, (dt, 0.0));
        }
    }

    /// Cuts the half kick of the step in which a body has met the ground or left it to the share in which it touched,
    /// see `contact::meeting`: of the points found `ago` (s).
    fn spare(&mut self, share: f64, context: &ContactContext, (dt, ago): (f64, f64)) {
        let SurfaceTouch::Polyhedron(touch) = &self.touch else {
            return;
        };
        // A body that is in the ground at the start has not met it, and one that slides off it leaves springs.
        if !(0.0..1.0).contains(&share) {
            return;
        }
        let apart = 1.0 - share;
        let has_parted = ago > 0.0;
        let (points, normals) = if has_parted {
            (&touch.former.0, &touch.former.1)
        } else {
            (&touch.points, &touch.normals)
        };
        let body = &context.kinematics[self.blocks.0 as usize];
        for (point, n) in points.iter().zip(normals) {
            let x = &point.patch.position;
            let rate = body.velocity_from(x, ago);
            let half = 0.5 * dt * apart;
            // The dashpot of a meeting has had its share already, see `apply_normal`.
            let normal = if has_parted {
                point.normal_force
            } else {
                point.normal_force - point.normal_viscous
            };
            let viscous = if has_parted {
                n * normal
            } else {
                Vec3::zeros()
            };
            self.friction -= half * (point.shear_force - point.shear_viscous).dot(&rate);
            self.damping += half * (viscous - point.shear_viscous).dot(&rate);
            self.excess.push(PointForce {
                point: x + body.velocity_at(x) * (0.5 * ago),
                force: (n * -normal + point.shear_force) * -apart,
            });
        }
    }

    fn evaluate_ball(
        &mut self,
        surface: &Surface,
        (center, radius): (&Vec3, f64),
        context: &ContactContext,
        dt: f64,
    ) {
        let SurfaceTouch::Ball(feet) = &mut self.touch else {
            return;
        };
        let blocks = (
            &context.kinematics[self.blocks.0 as usize],
            &context.kinematics[self.blocks.1 as usize],
        );
        BallOnSurface::forget(feet);
        for &triangle in &self.triangles {
            let Some((point, distance)) = surface.local_foot(triangle, center) else {
                continue;
            };
            if distance >= radius {
                continue;
            }
            // From the sphere into the surface.
            let normal = (point - center) / distance;
            BallOnSurface::note(feet, normal, radius - distance);
        }
        let law = (
            &context.joint_of(self.parts).spheres,
            context.rolling_law,
            context.shear_damping_ratio,
        );
        self.is_touching = false;
        self.rates = Rates::default();
        let mut tally = Tally::default();
        for foot in &mut *feet {
            foot.evaluate(blocks, law, radius, dt, &mut tally);
            if foot.is_found() {
                self.is_touching = true;
                self.deepest = self.deepest.max(foot.contact.overlap);
                let (on_ball, on_surface) = foot.forces(blocks.0, blocks.1);
                self.loads.0 += on_ball;
                self.loads.1 += on_surface;
                self.rates.stiffness += foot.rates.0.stiffness;
                self.rates.damping += foot.rates.0.damping;
            }
        }
        self.friction = tally.friction;
        self.damping = tally.damping;
        self.rolling_impulse = tally.rolling_impulse;
        feet.retain(|foot| foot.is_found());
    }
}

impl PolyhedronTouch {
    fn of(body: &Polyhedron) -> Self {
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

    pub fn energy(&self) -> f64 {
        self.elastic + self.planes.iter().map(|plane| plane.energy).sum::<f64>()
    }

    /// Half a step's work on shear springs and on dashpots; the points were found `ago` (s).
    fn work(&self, body: &Kinematics, dt: f64, ago: f64) -> (f64, f64) {
        let (mut friction, mut damping) = (0.0, 0.0);
        for (point, n) in self.points.iter().zip(&self.normals) {
            // Of the body against the ground, which stands still.
            let rate = body.velocity_from(&point.patch.position, ago);
            let viscous = n * point.normal_viscous - point.shear_viscous;
            damping -= 0.5 * dt * viscous.dot(&rate);
            friction += 0.5 * dt * (point.shear_force - point.shear_viscous).dot(&rate);
        }
        (friction, damping)
    }

    /// Contact points at the current position, sorted by the planes and vertices that they are behind.
    fn find(
        &mut self,
        surface: &Surface,
        body: &Polyhedron,
        triangles: &[u32],
        centroid: &Vec3,
        (scaling, allowed): (Scaling, f64),
    ) {
        let (per_area, per_corner) = match scaling {
            Scaling::Point => ((1.0 - CORNER_SHARE) / self.face_area, CORNER_SHARE),
            Scaling::Area => (1.0, 4.0 * CORNER_AREA * self.face_area),
        };
        self.found.clear();
        for (x, &weight) in body.vertices().iter().zip(&self.corner_weight) {
            // No corner is behind the surface that is in front of all its planes here.
            if triangles.iter().all(|&t| surface.height(t, x) >= 0.0) {
                continue;
            }
            if let Some(behind) = surface.behind(triangles, x) {
                let mut square = behind.depth * behind.depth;
                for (place, normal, depth) in behind.leans_on {
                    if depth > 0.0 {
                        self.found.push(Found {
                            place,
                            normal,
                            x: *x,
                            weight: per_corner * weight,
                            depth,
                            square,
                        });
                        square = 0.0;
                    }
                }
            }
        }
        for k in 0..triangles.len() {
            let plane = surface.plane(triangles[k]);
            if triangles[..k].iter().all(|&t| surface.plane(t) != plane) {
                self.press(
                    surface,
                    body,
                    &triangles[k..],
                    centroid,
                    (per_area, allowed),
                );
            }
        }
        self.sort_points();
    }

    /// Adds what of the body's faces lies behind the plane of the first of some triangles.
    fn press(
        &mut self,
        surface: &Surface,
        body: &Polyhedron,
        triangles: &[u32],
        centroid: &Vec3,
        (per_area, allowed): (f64, f64),
    ) {
        let Some(&first) = triangles.first() else {
            return;
        };
        let height = |x: &Vec3| surface.height(first, x);
        if body.vertices().iter().all(|x| height(x) >= 0.0) {
            return;
        }
        let (n, place) = (*surface.normal(first), surface.plane(first));
        let (from, mut deepest) = (self.found.len(), 0.0_f64);
        let Self {
            found,
            wet,
            polygon,
            spare,
            ..
        } = self;
        for face in 0..body.n_faces() {
            if body.face_normal(face).dot(&n) > -LOOKS_AWAY {
                continue;
            }
            wet.clear();
            wet.extend(
                body.face_vertices(face)
                    .map(|v| body.vertices()[v as usize]),
            );
            cut(wet, spare, &n, surface.offset(first));
            let mut add = |polygon: &[Vec3], found: &mut Vec<Found>| {
                let mut covered = 0.0;
                integrate(polygon, |x, area| {
                    covered += area;
                    // Points on the waterline count, for the dashpots' sake: whether round-off puts them
                    // above or below must not matter.
                    let depth = f64::max(-height(&x), 0.0);
                    deepest = deepest.max(depth);
                    if area > 0.0 {
                        found.push(Found {
                            place,
                            normal: n,
                            x,
                            weight: per_area * area,
                            depth,
                            square: depth * depth,
                        });
                    }
                });
                covered
            };
            let pieces = found.len();
            let mut covered = 0.0;
            for &triangle in triangles.iter().filter(|&&t| surface.plane(t) == place) {
                polygon.clone_from(wet);
                for (outward, offset) in surface.divides(triangle) {
                    cut(polygon, spare, outward, *offset);
                }
                covered += add(polygon, found);
            }
            let mut whole = 0.0;
            integrate(wet, |_, area| whole += area);
            if covered >= (1.0 - ROUND_OFF) * whole {
                // Wholly over the plane: friction, which is no polynomial, should not feel the triangles.
                found.truncate(pieces);
                add(wet, found);
            }
        }
        if height(centroid) < 0.0 && deepest > allowed {
            // The other side of something thin.
            self.found.truncate(from);
        }
    }

    /// Takes over what was found, place by place.
    fn sort_points(&mut self) {
        std::mem::swap(&mut self.points, &mut self.former.0);
        std::mem::swap(&mut self.normals, &mut self.former.1);
        self.points.clear();
        self.normals.clear();
        self.squares.clear();
        std::mem::swap(&mut self.planes, &mut self.before);
        self.planes.clear();
        for first in 0..self.found.len() {
            let place = self.found[first].place;
            if self.planes.iter().any(|known| known.place == place) {
                continue;
            }
            for found in self.found[first..]
                .iter()
                .filter(|found| found.place == place)
            {
                self.points.push(PointState {
                    patch: PatchPoint {
                        key: self.points.len() as u32,
                        position: found.x,
                        weight: found.weight,
                        overlap: found.depth,
                    },
                    normal_force: 0.0,
                    normal_viscous: 0.0,
                    shear_force: Vec3::zeros(),
                    shear_viscous: Vec3::zeros(),
                    state: ContactState::Open,
                });
                self.normals.push(found.normal);
                self.squares.push(found.square);
            }
            let memory = self.before.iter().find(|old| old.place == place);
            self.planes.push(PlaneTouch {
                place,
                normal: -self.found[first].normal,
                end: self.points.len(),
                shear: memory.map_or(ShearSpring::default(), |old| old.shear),
                has_slipped: memory.is_some_and(|old| old.has_slipped),
                energy: 0.0,
            });
        }
    }

    /// Normal forces, out of the surface. Returns the dashpot per unit of weight; N s/m.
    fn apply_normal(&mut self, body: &Kinematics, stiffness: f64, damping_ratio: f64) -> f64 {
        let total: f64 = self.points.iter().map(|p| p.patch.weight).sum();
        let mut pressed = Vec3::zeros();
        let mut middle = Vec3::zeros();
        for (point, n) in self.points.iter().zip(&self.normals) {
            pressed += n * (point.patch.weight * point.patch.overlap);
            middle += point.patch.position * (point.patch.weight / total);
        }
        let along = pressed.try_normalize(0.0).unwrap_or(Vec3::z());
        let mobility = body.compliance(&middle, &along);
        let dashpot = 2.0 * damping_ratio * (stiffness * total / mobility).sqrt() / total;
        self.elastic = 0.0;
        let rows = self.points.iter_mut().zip(&self.normals).zip(&self.squares);
        for ((point, n), square) in rows {
            let PatchPoint {
                position,
                weight,
                overlap,
                ..
            } = point.patch;
            let opening = body.velocity_at(&position).dot(n);
            let spring = weight * stiffness * overlap;
            point.normal_force = (spring - weight * dashpot * opening).max(0.0);
            point.normal_viscous = point.normal_force - spring;
            self.elastic += 0.5 * weight * stiffness * square;
        }
        dashpot
    }
}

/// Half a step's work of the normal springs on the body; J. The points were found `ago` (s).
fn work_of_normal_springs(
    points: &[PointState],
    normals: &[Vec3],
    body: &Kinematics,
    (dt, ago): (f64, f64),
) -> f64 {
    let work = |(point, n): (&PointState, &Vec3)| {
        let opening = body.velocity_from(&point.patch.position, ago).dot(n);
        0.5 * dt * (point.normal_force - point.normal_viscous) * opening
    };
    points.iter().zip(normals).map(work).sum()
}

/// Visits points and areas (m²) that integrate quadratics over a convex polygon exactly.
fn integrate(polygon: &[Vec3], mut visit: impl FnMut(Vec3, f64)) {
    if let Some(fan) = Fan::new(polygon, Vec3::norm) {
        fan.for_each_point(|_, x, area| visit(x, area));
    }
}

/// Keeps the side `normal · x ≤ offset`; corners on the plane once, as a point of no area would still be a contact.
fn cut(polygon: &mut Vec<Vec3>, spare: &mut Vec<Vec3>, normal: &Vec3, offset: f64) {
    let height = |x: &Vec3| normal.dot(x) - offset;
    clip((polygon, spare), OnPlane::Once, height, |at| at.point());
}
