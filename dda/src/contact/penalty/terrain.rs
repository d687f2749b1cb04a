//! Penalty contact with a surface of triangles.
//!
//! A polyhedron meets it all over its own surface, by a potential that depends on its place alone,
//!
//! ```text
//! U = ½ K Σ w d²,   d > 0: depth behind the nearest triangle                                           [J]
//! ```
//! with the points and weights of `detection::terrain`. Friction has one spring for each plane, and for each vertex
//! that a corner is nearest to. The ground is fixed.
//!
//! A sphere has a contact at each of its feet; feet whose normals differ by less than 5 degrees are one.

use super::friction::ShearSpring;
use super::history::PairLoads;
use super::impact;
use super::law::PairLaw;
use super::normal::Bearing;
use super::spheres::{SphereOnSurface, SurfaceLaw};
use super::work::{Acting, Losses};
use crate::contact::context::ContactContext;
use crate::contact::detection::manifold::Features;
use crate::contact::detection::terrain::{self, SurfacePatch};
use crate::contact::rates::Rates;
use crate::contact::report::{Contact, PointState};
use crate::contact::spring::Spring;
use crate::contact::tally::Tally;
use crate::geometry::parts::Part;
use crate::geometry::surface::NearTriangles;
use crate::material::{Joint, Scaling, SphereJoint};
use crate::{Polyhedron, Surface, Vec3};
use serde::{Deserialize, Serialize};

/// A part that may touch a surface: i is the body, j the surface, whatever their numbers.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SurfacePair {
    pub parts: (u32, u32),
    pub blocks: (u32, u32),
    /// Triangles near the body: all of those within a reach (m) of it.
    pub triangles: Vec<u32>,
    pub reach: f64,
    pub touch: SurfaceTouch,
    pub loads: PairLoads,
    /// Contribution of the pair to the step bound of the body.
    pub rates: Rates,
    pub is_touching: bool,
}

/// Kind of contact with a surface.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum SurfaceTouch {
    Polyhedron(Box<PolyhedronTouch>),
    /// The places where a sphere touches.
    Sphere(Vec<SphereOnSurface>),
}

/// Finder and memory of a polyhedron on a surface.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct PolyhedronTouch {
    patch: SurfacePatch,
    /// Contact points, those of one plane together.
    points: Vec<PointState>,
    /// Normals of the points, into the surface.
    normals: Vec<Vec3>,
    planes: Vec<PlaneHistory>,
    /// Energy of the normal springs; J.
    elastic: f64,
    /// Points of the step before, and their normals.
    #[serde(skip)]
    former: (Vec<PointState>, Vec<Vec3>),
    #[serde(skip)]
    former_planes: Vec<PlaneHistory>,
}

/// Memory of the contact with one plane of the surface, or one vertex.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct PlaneHistory {
    features: Option<Features>,
    shear: ShearSpring,
    has_slipped: bool,
    /// Of the shear spring; J.
    energy: f64,
    /// Shear dashpot; N s/m.
    dashpot: f64,
    n_points: usize,
}

impl SurfacePair {
    pub fn new(parts: (u32, u32), blocks: (u32, u32), body: &Part) -> Self {
        let touch = match body {
            Part::Polyhedron(body) => SurfaceTouch::Polyhedron(Box::new(PolyhedronTouch {
                patch: SurfacePatch::of(body),
                ..PolyhedronTouch::default()
            })),
            Part::Sphere { .. } | Part::Surface(_) => SurfaceTouch::Sphere(Vec::new()),
        };
        Self {
            parts,
            blocks,
            triangles: Vec::new(),
            reach: 0.0,
            touch,
            loads: PairLoads::default(),
            rates: Rates::default(),
            is_touching: false,
        }
    }

    /// Energy of the springs; J. A sphere's law and radius (m).
    pub fn energy(&self, law: &SphereJoint, radius: f64) -> f64 {
        match &self.touch {
            SurfaceTouch::Polyhedron(touch) => touch.elastic + touch.shear_energy(),
            SurfaceTouch::Sphere(feet) => feet.iter().map(|foot| foot.energy(law, radius)).sum(),
        }
    }

    /// Finds what touches at the current position, and the forces at the present velocities; books what was
    /// lost during the last `dt` (s).
    pub fn evaluate(&mut self, context: &ContactContext, dt: f64) {
        let Part::Surface(surface) = &context.parts[self.parts.1 as usize] else {
            return;
        };
        self.loads.clear();
        let law = PairLaw::of(context, self.parts, self.blocks, dt);
        let near = NearTriangles {
            triangles: &self.triangles,
            reach: self.reach,
        };
        match (&mut self.touch, &context.parts[self.parts.0 as usize]) {
            (SurfaceTouch::Polyhedron(touch), Part::Polyhedron(body)) => {
                let allowed = context.overlap_limits.of(self.parts);
                let rates = touch.evaluate(&law, (body, allowed), (surface, near), &mut self.loads);
                self.is_touching = rates.is_some();
                self.rates = rates.unwrap_or_default();
            }
            (SurfaceTouch::Sphere(_), Part::Sphere { center, radius }) => {
                self.evaluate_sphere(surface, (center, *radius), context, &law);
            }
            _ => {}
        }
        if !self.is_touching {
            self.rates = self.rates_before_touch(context, &law);
        }
    }

    pub fn is_of_sphere(&self) -> bool {
        matches!(self.touch, SurfaceTouch::Sphere(_))
    }

    pub fn n_contacts(&self) -> usize {
        match &self.touch {
            SurfaceTouch::Polyhedron(touch) => touch.points.len(),
            SurfaceTouch::Sphere(feet) => feet.len(),
        }
    }

    /// Visits the contact points.
    pub fn for_each_contact(&self, visit: &mut dyn FnMut(Contact)) {
        let blocks = (self.blocks.0.into(), self.blocks.1.into());
        let parts = (self.parts.0.into(), self.parts.1.into());
        match &self.touch {
            SurfaceTouch::Polyhedron(touch) => {
                for (point, n) in touch.points.iter().zip(&touch.normals) {
                    visit(Contact {
                        blocks,
                        parts,
                        key: point.at.key,
                        point: point.at.position,
                        normal: *n,
                        normal_force: point.normal_force,
                        shear_force: point.shear_force,
                        overlap: point.at.overlap,
                        state: point.state,
                    });
                }
            }
            SurfaceTouch::Sphere(feet) => {
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

    /// Springs of the points of a polyhedron; of a sphere there are none.
    pub fn springs<'a>(&'a self, joint: &'a Joint) -> impl Iterator<Item = Spring> + 'a {
        let touch = match &self.touch {
            SurfaceTouch::Polyhedron(touch) => Some(touch.as_ref()),
            SurfaceTouch::Sphere(_) => None,
        };
        let blocks = [self.blocks.0 as usize, self.blocks.1 as usize];
        let along = self.loads.dashpots.0;
        touch.into_iter().flat_map(move |touch| {
            touch
                .shared()
                .map(move |(point, normal, plane, share)| Spring {
                    blocks,
                    point: point.at.position,
                    normal: *normal,
                    stiffness: [
                        joint.normal_stiffness * point.at.weight,
                        joint.shear_stiffness * plane.shear.weight * share,
                    ],
                    dashpot: [along * point.at.weight, plane.dashpot * share],
                })
        })
    }

    /// Visits every number of the state.
    pub fn for_each_state_f64(&self, f: &mut dyn FnMut(f64)) {
        match &self.touch {
            SurfaceTouch::Polyhedron(touch) => {
                for plane in &touch.planes {
                    f(f64::from(plane.place()));
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
            SurfaceTouch::Sphere(feet) => {
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

    /// Of a polyhedron stiff per area, no face is larger than the great circle of its bounding sphere.
    fn rates_before_touch(&self, context: &ContactContext, law: &PairLaw) -> Rates {
        let (body, ground) = law.bodies;
        let radius = context.radius[self.blocks.0 as usize];
        let weight = match (&self.touch, law.joint.scaling) {
            (SurfaceTouch::Polyhedron(_), Scaling::Area) => std::f64::consts::PI * radius * radius,
            _ => 1.0,
        };
        let lever_arm = |block: u32| &context.lever_arm[block as usize];
        let bodies = (
            (body, lever_arm(self.blocks.0)),
            (ground, lever_arm(self.blocks.1)),
        );
        let springs = law.springs(weight, body.inverse_mass);
        springs.before_touch(bodies, context.step_bound).0
    }

    fn evaluate_sphere(
        &mut self,
        surface: &Surface,
        sphere: (&Vec3, f64),
        context: &ContactContext,
        law: &PairLaw,
    ) {
        let SurfaceTouch::Sphere(feet) = &mut self.touch else {
            return;
        };
        SphereOnSurface::forget(feet);
        for (normal, overlap) in terrain::feet(surface, &self.triangles, sphere) {
            SphereOnSurface::note(feet, normal, overlap);
        }
        let (_, radius) = sphere;
        let surface_law = SurfaceLaw {
            joint: &law.joint.spheres,
            rolling_law: context.rolling_law,
            dt: law.dt,
        };
        self.is_touching = false;
        self.rates = Rates::default();
        let mut tally = Tally::default();
        for foot in &mut *feet {
            foot.evaluate(law.bodies, &surface_law, radius, &mut tally);
            if foot.is_found() {
                self.is_touching = true;
                self.loads.deepest = self.loads.deepest.max(foot.contact.overlap);
                let (on_sphere, on_surface) = foot.forces(law.bodies.0, law.bodies.1);
                self.loads.on_blocks.0 += on_sphere;
                self.loads.on_blocks.1 += on_surface;
                self.rates.stiffness += foot.rates.0.stiffness;
                self.rates.damping += foot.rates.0.damping;
            }
        }
        self.loads.losses = Losses {
            friction: tally.friction,
            damping: tally.damping,
        };
        self.loads.rolling_impulse = tally.rolling_impulse;
        feet.retain(|foot| foot.is_found());
    }
}

impl PlaneHistory {
    fn place(&self) -> u32 {
        match self.features {
            Some(Features::SurfacePlane(place)) => place,
            _ => u32::MAX,
        }
    }
}

impl PolyhedronTouch {
    /// Points with their normals, their planes, and their shares of the shear of those.
    fn shared(&self) -> impl Iterator<Item = (&PointState, &Vec3, &PlaneHistory, f64)> {
        let total: f64 = self.points.iter().map(|p| p.at.weight).sum();
        let starts = self.planes.iter().scan(0, |end, plane| {
            let start = *end;
            *end += plane.n_points;
            Some((plane, start..*end))
        });
        starts.flat_map(move |(plane, range)| {
            let points = &self.points[range.clone()];
            let pressed: f64 = points.iter().map(|p| p.normal_force).sum();
            let normals = &self.normals[range];
            points.iter().zip(normals).map(move |(point, normal)| {
                let share = share_of_shear(point, pressed, total);
                (point, normal, plane, share)
            })
        })
    }

    fn shear_energy(&self) -> f64 {
        self.planes.iter().map(|plane| plane.energy).sum::<f64>()
    }

    /// Forces of the body, whose deepest allowed overlap is given (m), on the ground:
    ///
    /// 1. work of the first half of the step;
    /// 2. manifolds, with the memory of those of the step before;
    /// 3. normal springs and dashpots;
    /// 4. a shear spring for each plane;
    /// 5. work of the second half; a body that met or left the ground touched it for a part of the step only.
    ///
    /// Returns the share in the step bound of the body; `None` if it does not touch.
    fn evaluate(
        &mut self,
        law: &PairLaw,
        (body, allowed): (&Polyhedron, f64),
        ground: (&Surface, NearTriangles),
        loads: &mut PairLoads,
    ) -> Option<Rates> {
        let dt = law.dt;
        let was_touching = !self.points.is_empty();
        let held_before = self.shear_energy();
        let elastic_before = self.elastic;
        let mut first_half = Losses::default();
        acting(law, &self.points, &self.normals, dt).book_half(dt, &mut first_half);
        loads.losses = Losses {
            friction: first_half.friction + held_before,
            damping: first_half.damping,
        };

        let centroid = &law.bodies.0.centroid;
        self.patch
            .find((body, centroid), ground, law.joint.scaling, allowed);
        self.take_over();
        let PairLoads {
            losses,
            half_kick_corrections,
            deepest,
            ..
        } = &mut *loads;
        let planes = &self.patch.manifolds.planes;
        *deepest = planes.iter().map(|plane| plane.depth).fold(0.0, f64::max);
        if planes.is_empty() {
            self.elastic = 0.0;
            if was_touching {
                let former = acting(law, &self.former.0, &self.former.1, dt);
                impact::end_contact(&former, dt, elastic_before, losses, half_kick_corrections);
            }
            return None;
        }
        let (dashpot, mut rates) = self.press(law);
        loads.dashpots.0 = dashpot;
        self.shear(law, &mut rates);
        let (body, ground) = law.bodies;
        for (point, n) in self.points.iter().zip(&self.normals) {
            loads.add(point, n, (&body.centroid, &ground.centroid));
        }
        let PairLoads {
            losses,
            half_kick_corrections,
            ..
        } = loads;
        let now = acting(law, &self.points, &self.normals, 0.0);
        let mut second_half = Losses::default();
        now.book_half(dt, &mut second_half);
        losses.friction += second_half.friction - self.shear_energy();
        losses.damping += second_half.damping;
        if !was_touching {
            impact::begin_contact(&now, dt, self.elastic, losses, half_kick_corrections);
        }
        Some(rates)
    }

    /// Lays the former points aside; each plane goes on with its memory.
    fn take_over(&mut self) {
        std::mem::swap(&mut self.points, &mut self.former.0);
        std::mem::swap(&mut self.normals, &mut self.former.1);
        std::mem::swap(&mut self.planes, &mut self.former_planes);
        self.points.clear();
        self.normals.clear();
        self.planes.clear();
        self.normals
            .extend_from_slice(&self.patch.manifolds.normals);
        for plane in &self.patch.manifolds.planes {
            let mut known = self.former_planes.iter();
            let memory = known.find(|old| old.features == plane.features);
            self.planes.push(PlaneHistory {
                features: plane.features,
                shear: memory.map_or(ShearSpring::default(), |old| old.shear),
                has_slipped: memory.is_some_and(|old| old.has_slipped),
                energy: 0.0,
                dashpot: 0.0,
                n_points: plane.points.len(),
            });
        }
    }

    /// Normal forces; returns their dashpot per unit of weight (N s/m) and their share in the step bound.
    fn press(&mut self, law: &PairLaw) -> (f64, Rates) {
        let (found, springs) = (&self.patch.manifolds, law.pressing());
        let mut pressed = Vec3::zeros();
        for (point, n) in found.points.iter().zip(&found.normals) {
            pressed += n * (point.weight * point.overlap);
        }
        let along = pressed.try_normalize(0.0).unwrap_or(Vec3::z());
        let dashpot = springs.dashpot(&found.points, &along).per_weight;
        let normals = found.normals.as_slice();
        springs.press(
            &found.points,
            normals,
            dashpot,
            Bearing::Pressure,
            &mut self.points,
        );
        let stiffness = springs.stiffness;
        self.elastic = 0.0;
        for (point, square) in found.points.iter().zip(&found.squares) {
            self.elastic += 0.5 * point.weight * stiffness * square;
        }
        let mut rates = Rates::default();
        for (point, n) in found.points.iter().zip(&found.normals) {
            let along = point.weight * law.bodies.0.compliance(&point.position, n);
            rates.stiffness += stiffness * along;
            rates.damping += dashpot * along;
        }
        (dashpot, rates)
    }

    /// Shear forces plane by plane, with their share in the step bound.
    fn shear(&mut self, law: &PairLaw, rates: &mut Rates) {
        let (joint, body) = (law.joint, law.bodies.0);
        let total: f64 = self.points.iter().map(|p| p.at.weight).sum();
        for (plane, memory) in self.patch.manifolds.planes.iter().zip(&mut self.planes) {
            let points = &mut self.points[plane.points.clone()];
            let sheared = law
                .shearing(plane, memory.has_slipped)
                .apply(points, &memory.shear);
            memory.shear = sheared.spring;
            memory.energy = sheared.energy;
            memory.dashpot = sheared.damping;
            memory.has_slipped |= sheared.has_slipped;
            let pressed: f64 = points.iter().map(|p| p.normal_force).sum();
            for point in points {
                let share = share_of_shear(point, pressed, total);
                let x = &point.at.position;
                let across = share * (body.compliance_trace(x) - body.compliance(x, &plane.normal));
                rates.stiffness += joint.shear_stiffness * plane.flat_weight * across;
                rates.damping += sheared.damping * across;
            }
        }
    }
}

/// Share of a point in the shear of its plane: that of its pressure, if any is pressed.
fn share_of_shear(point: &PointState, pressed: f64, total_weight: f64) -> f64 {
    if pressed > 0.0 {
        point.normal_force / pressed
    } else {
        point.at.weight / total_weight
    }
}

/// Forces on the points of a body and the ground, found `ago` (s).
fn acting<'a>(
    law: &PairLaw<'a>,
    points: &'a [PointState],
    normals: &'a [Vec3],
    ago: f64,
) -> Acting<'a, &'a [Vec3]> {
    Acting {
        bodies: law.bodies,
        points,
        normals,
        ago,
    }
}
