//! Points of all pairs that touch or are near.

use crate::contact::detection::manifold::ManifoldPoint;
use crate::contact::detection::patch::Patch;
use crate::contact::detection::polyhedra::NarrowPhase;
use crate::contact::detection::spheres::between;
use crate::contact::detection::terrain::{NearFeatures, NearPoint, SurfacePoints};
use crate::contact::penalty::polyhedra::Pair;
use crate::contact::penalty::terrain::SurfacePair;
use crate::geometry::parts::Part;
use crate::geometry::surface::NearTriangles;
use crate::motion::update::Update;
use crate::{Blocks, Polyhedron, Vec3};
use rayon::prelude::*;

/// Pairs that one thread takes at a time.
const CHUNK: usize = 16;

/// A point of two parts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    pub parts: (u32, u32),
    pub blocks: [u32; 2],
    /// Unit, from the first to the second.
    pub normal: Vec3,
    /// In the middle of the gap; m.
    pub position: Vec3,
    /// Below 0 for overlap; m.
    pub gap: f64,
    pub friction: f64,
    /// Whether the residual friction holds; without a bond that broke false where it is not lower.
    pub has_slipped: bool,
    pub restitution: f64,
    /// Rolling resistance of a sphere; –.
    pub rolling_friction: f64,
    /// Twisting resistance of a sphere; –.
    pub twisting_friction: f64,
}

impl Blocks {
    /// Points of all pairs that could close their gap within `dt` (s), in the order of the pairs; records the overlap.
    pub(super) fn touches(&mut self, dt: f64) -> Vec<Touch> {
        let mut found = self.touches_of_polyhedra(dt);
        self.add_touches_of_spheres(dt, &mut found);
        found.par_extend(self.touches_on_surfaces(dt));
        self.drop_touches_at_joints(&mut found);
        self.recall_slip(&mut found);
        let limits = self.constants.overlap_limits();
        let mut worst = (0.0, (0, 0));
        let mut deepest: f64 = 0.0;
        for touch in &found {
            let over_allowed = -touch.gap / limits.of(touch.parts);
            deepest = deepest.max(-touch.gap / limits.size_of(touch.parts));
            if worst.0 < over_allowed {
                worst = (over_allowed, touch.parts);
            }
        }
        let totals = &mut self.state.totals;
        totals.max_overlap_over_size = totals.max_overlap_over_size.max(deepest);
        self.state.worst_overlap = worst;
        found
    }

    /// Way of a block within `dt` (s) at most, weight included; m.
    pub(super) fn approach(&self, b: usize, dt: f64) -> f64 {
        let body = &self.state.kinematics[b];
        let strain_rate = body.strain_rate.map_or(0.0, |rate| rate.norm());
        let turning = body.spin.norm() + strain_rate;
        let speed = body.velocity.norm() + turning * self.constants.radius[b];
        match self.is_driven(b) {
            true => (speed + self.constants.settings.gravity.norm() * dt) * dt,
            false => speed * dt,
        }
    }

    /// Distance by which two blocks may come closer within `dt` (s); m.
    fn approach_of(&self, (a, b): (u32, u32), dt: f64) -> f64 {
        self.approach(a as usize, dt) + self.approach(b as usize, dt)
    }

    /// Whether the contacts of two blocks are solved in this step: one of the two moves. Those of blocks asleep keep their impulses.
    pub(super) fn is_solved(&self, (a, b): (u32, u32)) -> bool {
        let [a, b] = [a as usize, b as usize];
        self.is_driven(a) || self.is_driven(b) || self.is_led(a) || self.is_led(b)
    }

    /// Whether a block is moving on its path.
    fn is_led(&self, b: usize) -> bool {
        let body = &self.state.kinematics[b];
        self.derived.update[b] == Update::Fixed
            && (body.velocity != Vec3::zeros() || body.spin != Vec3::zeros())
    }

    /// Wakes blocks that one on a path runs into.
    pub(super) fn wake_pushed(&mut self, touches: &[Touch], dt: f64) {
        for touch in touches {
            let [a, b] = touch.blocks.map(|block| block as usize);
            if self.is_driven(a) || self.is_driven(b) {
                continue;
            }
            let [va, vb] =
                [a, b].map(|block| self.state.kinematics[block].velocity_at(&touch.position));
            if touch.gap + dt * touch.normal.dot(&(vb - va)) < 0.0 {
                self.wake_one(a);
                self.wake_one(b);
            }
        }
    }

    fn touches_of_polyhedra(&mut self, dt: f64) -> Vec<Touch> {
        let mut pairs = std::mem::take(&mut self.contacts.pairs);
        let this = &*self;
        let found = (pairs.par_iter_mut().with_min_len(CHUNK))
            .map_init(Patch::default, |patch, pair| {
                this.touches_of(pair, patch, dt)
            })
            .flatten_iter()
            .collect();
        self.contacts.pairs = pairs;
        found
    }

    fn touches_of(&self, pair: &mut Pair, patch: &mut Patch, dt: f64) -> Vec<Touch> {
        if pair.history.bond.is_some() || !self.is_solved(pair.blocks) {
            return Vec::new();
        }
        let bodies = self.polyhedra(pair.parts);
        let joint = self.joint_between(pair.parts);
        let reach = self.approach_of(pair.blocks, dt);
        let is_near = |(a, b): &(&Polyhedron, &Polyhedron)| {
            let narrow = NarrowPhase {
                bodies: (a, b),
                detection: self.constants.settings.contact_detection,
                gravity: self.constants.settings.gravity,
                scaling: joint.scaling,
            };
            narrow.find_near(&mut pair.axis, patch, reach)
        };
        if !bodies.as_ref().is_some_and(is_near) {
            return Vec::new();
        }
        let friction = match pair.history.is_broken {
            true => joint.residual_friction,
            false => joint.friction,
        };
        let of = |point: &ManifoldPoint| Touch {
            parts: pair.parts,
            blocks: [pair.blocks.0, pair.blocks.1],
            normal: patch.manifold.normal,
            position: point.position,
            gap: -point.overlap,
            friction,
            has_slipped: pair.history.is_broken,
            restitution: joint.restitution,
            rolling_friction: 0.0,
            twisting_friction: 0.0,
        };
        patch.manifold.points.iter().map(of).collect()
    }

    fn polyhedra(&self, parts: (u32, u32)) -> Option<(&Polyhedron, &Polyhedron)> {
        let part = |part: u32| &self.derived.parts[part as usize];
        match (part(parts.0), part(parts.1)) {
            (Part::Polyhedron(a), Part::Polyhedron(b)) => Some((a, b)),
            _ => None,
        }
    }

    fn add_touches_of_spheres(&self, dt: f64, found: &mut Vec<Touch>) {
        for pair in &self.contacts.sphere_pairs {
            if !self.is_solved(pair.blocks) {
                continue;
            }
            let reach = self.approach_of(pair.blocks, dt);
            let part = |part: u32| &self.derived.parts[part as usize];
            let at_body = |body: &Polyhedron, center: &Vec3, radius: f64| {
                let at = body.touch_point_within(center, radius + reach)?;
                let gap = at.distance - radius;
                Some((at.point + at.normal * (0.5 * gap), at.normal, gap))
            };
            let near = match (part(pair.parts.0), part(pair.parts.1)) {
                (
                    Part::Sphere {
                        center: x,
                        radius: r,
                    },
                    Part::Sphere {
                        center: y,
                        radius: s,
                    },
                ) => Some(between((x, *r), (y, *s))),
                (Part::Sphere { center, radius }, Part::Polyhedron(body)) => {
                    at_body(body, center, *radius).map(|(x, normal, gap)| (x, -normal, gap))
                }
                (Part::Polyhedron(body), Part::Sphere { center, radius }) => {
                    at_body(body, center, *radius)
                }
                _ => None,
            };
            let Some((position, normal, gap)) = near.filter(|(.., gap)| *gap <= reach) else {
                continue;
            };
            let joint = self.joint_between(pair.parts);
            found.push(Touch {
                parts: pair.parts,
                blocks: [pair.blocks.0, pair.blocks.1],
                normal,
                position,
                gap,
                friction: joint.spheres.static_friction,
                has_slipped: false,
                restitution: joint.restitution,
                rolling_friction: joint.spheres.rolling_friction,
                twisting_friction: joint.spheres.twisting_friction,
            });
        }
    }

    fn touches_on_surfaces(&self, dt: f64) -> impl ParallelIterator<Item = Touch> + '_ {
        (self.contacts.surface_pairs.par_iter().with_min_len(CHUNK))
            .map_init(SurfacePoints::default, move |points, pair| {
                self.touches_on_surface(pair, points, dt)
            })
            .flatten_iter()
    }

    /// The body first, the surface second.
    fn touches_on_surface(
        &self,
        pair: &SurfacePair,
        found: &mut SurfacePoints,
        dt: f64,
    ) -> Vec<Touch> {
        let part = |part: u32| &self.derived.parts[part as usize];
        let Part::Surface(surface) = part(pair.parts.1) else {
            return Vec::new();
        };
        if !self.is_solved(pair.blocks) {
            return Vec::new();
        }
        let ground = NearFeatures {
            surface,
            near: NearTriangles {
                triangles: &pair.triangles,
                reach: pair.reach,
            },
            reach: self.approach_of(pair.blocks, dt),
        };
        let joint = self.joint_between(pair.parts);
        let (friction, rolling_friction, twisting_friction) = match part(pair.parts.0) {
            Part::Polyhedron(body) => {
                found.find(&ground, body);
                (joint.friction, 0.0, 0.0)
            }
            Part::Sphere { center, radius } => {
                found.find_sphere(&ground, (center, *radius));
                let law = &joint.spheres;
                (
                    law.static_friction,
                    law.rolling_friction,
                    law.twisting_friction,
                )
            }
            Part::Surface(_) => return Vec::new(),
        };
        let of = |point: &NearPoint| Touch {
            parts: pair.parts,
            blocks: pair.blocks.into(),
            normal: point.normal,
            position: point.position,
            gap: point.gap,
            friction,
            has_slipped: false,
            restitution: joint.restitution,
            rolling_friction,
            twisting_friction,
        };
        found.points.iter().map(of).collect()
    }
}
