//! The contact law of a pair of parts: penalty springs, dashpots, Coulomb's limit, bonds.
//!
//! ```text
//! normal   F_n = w K δ − w c ġ ≥ 0,     c = 2 ξ √(K_e m_e)/Σw,  1/m_e = w_A + w_B (compliances along n)    [N]
//! shear    see `friction`
//! ```
//! `w` is the point's weight (see `patch`), `δ` its overlap, `ġ` its opening rate, `K_e = K Σ w` the
//! stiffness that the motion of the pair as a whole feels. Forces act on B; A gets the opposite at the
//! same point.
//! Source: Cundall (1988), Geraili Mikola & Sitar (2013); damping clamped after Schwager & Pöschel
//! (2007); shear history after Luding (2008).
//!
//! **Energy.** The springs of a patch have a potential while its two faces stay the same (see `patch`).
//! When another face or edge takes over, its springs go on with the energy of those before, see `takeover`;
//! bodies that meet or part within a step are pushed for the time they touched, see `meeting`.
//!
//! **Bonds.** Parts that lie against each other at the start with cohesion or tensile strength are
//! bonded: they also pull, up to a tension of `T` at the edge of the patch, and hold shear up to
//! `c A + F_n tan φ` (A the area of the patch at the start). Past either limit the bond breaks for good,
//! see `bond`; of its strength there stays `c_r A + F_n tan φ_r` (A the wet area). What its springs held
//! goes to damping.

mod bond;
mod meeting;
mod takeover;

pub(crate) use bond::Bond;
pub(crate) use meeting::PointForce;
use serde::{Deserialize, Serialize};
use takeover::{Features, Former};

use crate::Vec3;
use crate::contact::context::ContactContext;
use crate::contact::detection::common_plane::{Axis, AxisCache, AxisKind};
use crate::contact::detection::patch::Patch;
use crate::contact::penalty::friction::{ShearSpring, Shearing};
use crate::contact::rates::Rates;
use crate::contact::report::{ContactState, PointState};
use crate::geometry::parts::Part;
use crate::material::Scaling;
use crate::motion::kinematics::{Kinematics, Load};
use crate::motion::update::Update;

/// Two parts that may touch.
///
/// First what is read of a pair whose boxes are apart: one cache line, and most pairs are that.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[repr(C, align(64))]
pub(crate) struct Pair {
    pub parts: (u32, u32),
    pub blocks: (u32, u32),
    /// Contribution of the pair to the step bound of each block, since the last evaluation.
    pub rates: (Rates, Rates),
    /// Is there any force?
    pub is_touching: bool,
    /// Would another evaluation change nothing while the boxes stay apart?
    pub is_idle: bool,
    pub axis: AxisCache,
    pub bond: Option<Bond>,
    /// Points of the last force evaluation.
    pub points: Vec<PointState>,
    /// Normal from i to j at that time.
    pub normal: Vec3,
    /// Memory of the shear spring.
    pub shear: ShearSpring,
    /// Has the joint slipped or broken, so that its residual friction holds?
    pub has_slipped: bool,
    /// Has its bond broken, so that its residual cohesion holds?
    pub is_broken: bool,
    /// Features that formed the patch at that time, and the fraction of its stiffness, see `takeover`; –.
    pub features: Option<Features>,
    pub stiffness_share: f64,
    /// Energy of the normal and of the shear springs; J.
    pub elastic: (f64, f64),

    shear_energy: f64,
    /// Normal dashpot per unit of weight and shear dashpot of the whole; N s/m.
    dashpots: (f64, f64),
    /// On the blocks i and j, torque about their centroids.
    pub loads: (Load, Load),
    /// Energy lost in the last sub-step; J.
    pub friction: f64,
    pub damping: f64,
    /// Deepest overlap; m.
    pub deepest: f64,
    /// Did the bond break in the last evaluation?
    pub has_broken: bool,
    /// Correction to the next half kick, see `meeting`; empty between two steps.
    #[serde(skip)]
    pub excess: Vec<PointForce>,
}

/// Buffers of an evaluation, one for the pairs of a chunk: with buffers of their own, thousands of pairs would
/// not fit the caches.
#[derive(Clone, Debug, Default)]
pub(crate) struct Workspace {
    /// Points of the step before.
    before: Vec<PointState>,
    patch: Patch,
}

/// Parts nearer than this at the start are bonded; × size of the smaller part.
const BOND_REACH: f64 = 1e-4;

impl Pair {
    pub fn new(parts: (u32, u32), blocks: (u32, u32)) -> Self {
        Self {
            parts,
            blocks,
            rates: (Rates::default(), Rates::default()),
            is_touching: false,
            is_idle: false,
            axis: AxisCache::default(),
            bond: None,
            points: Vec::new(),
            normal: Vec3::z(),
            shear: ShearSpring::default(),
            has_slipped: false,
            is_broken: false,
            features: None,
            stiffness_share: 1.0,
            elastic: (0.0, 0.0),
            shear_energy: 0.0,
            dashpots: (0.0, 0.0),
            loads: (Load::default(), Load::default()),
            friction: 0.0,
            damping: 0.0,
            deepest: 0.0,
            has_broken: false,
            excess: Vec::new(),
        }
    }

    /// Glues the pair if its parts lie face to face and the joint has strength.
    pub fn bond(&mut self, context: &ContactContext) {
        let joint = context.joint_of(self.parts);
        let (Part::Polyhedron(a), Part::Polyhedron(b)) = (
            &context.parts[self.parts.0 as usize],
            &context.parts[self.parts.1 as usize],
        ) else {
            return;
        };
        if joint.cohesion <= 0.0 && joint.tensile_strength <= 0.0 {
            return;
        }
        let axes = crate::separating_axes(a, b);
        let axis = axes.preferred_face(a, b, &context.gravity);
        let reach = BOND_REACH * a.size().min(b.size());
        if axes.best().gap > reach || axis.gap.abs() > reach {
            return;
        }
        let mut patch = Patch::default();
        patch.find(a, b, &axis, joint.scaling, true);
        let is_flat = patch.points.iter().all(|p| p.overlap.abs() <= reach);
        if patch.area > 0.0 && is_flat {
            self.axis.axis = Some(axis);
            self.bond = Some(Bond { area: patch.area });
        }
    }

    /// Finds the patch at the current position and the forces at the present velocities; books what
    /// friction and dashpots took during the last `dt` (s).
    ///
    /// Parts whose boxes are apart (`is_near` false) are not looked at, unless they are bonded.
    pub fn evaluate(
        &mut self,
        context: &ContactContext,
        dt: f64,
        is_near: bool,
        work: &mut Workspace,
    ) {
        self.friction = 0.0;
        self.damping = 0.0;
        self.excess.clear();
        self.book_work(context, dt, dt);
        let Workspace { before, patch } = work;
        before.clear();
        before.append(&mut self.points);
        let former = Former {
            normal: self.normal,
            features: self.features.take(),
            points: before,
        };
        patch.points.clear();
        self.loads = (Load::default(), Load::default());
        self.deepest = 0.0;
        self.has_broken = false;
        // The shear spring moves once in a step, whether the bond breaks in it or not.
        let shear = self.shear;
        if is_near || self.bond.is_some() {
            self.press(context, dt, &former, patch);
        }
        if self
            .bond
            .is_some_and(|bond| self.is_overloaded(&bond, context, patch))
        {
            self.shear = shear;
            self.break_bond(context, dt, &former, patch);
        }
        self.book_work(context, dt, 0.0);
        if former.points.is_empty() && self.bond.is_none() {
            self.meet(context, dt);
        }
        self.settle_energy(context, dt, &former);
        self.stiffen();
        self.rates = self.rate_bounds(context, patch.flat_weight);
        self.is_touching = !self.points.is_empty();
        // The compliances of blocks that deform or are held change as they turn.
        let is_steady = |block: u32| context.update[block as usize] != Update::Constrained;
        self.is_idle = !(is_near || self.is_touching || self.bond.is_some() || self.has_broken)
            && is_steady(self.blocks.0)
            && is_steady(self.blocks.1);
    }

    /// Finds the patch and its forces, if there is one.
    fn press(&mut self, context: &ContactContext, dt: f64, former: &Former, patch: &mut Patch) {
        if let Some((normal, deepest)) = self.find_patch(context, patch) {
            self.normal = normal;
            self.deepest = deepest;
            self.keep_energy(context, dt, former, patch);
            self.apply_law(context, dt, former, patch);
        }
    }

    /// Half a step's work of dashpots and shear springs: the forces act at both ends of the step, the
    /// rates are those of its middle. What the shear springs were given and do not hold has slipped. The
    /// points were found `ago` (s).
    fn book_work(&mut self, context: &ContactContext, dt: f64, ago: f64) {
        let (a, b) = (
            &context.kinematics[self.blocks.0 as usize],
            &context.kinematics[self.blocks.1 as usize],
        );
        for point in &self.points {
            let x = &point.patch.position;
            let rate = b.velocity_from(x, ago) - a.velocity_from(x, ago);
            let viscous = self.normal * point.normal_viscous + point.shear_viscous;
            self.damping -= 0.5 * dt * viscous.dot(&rate);
            self.friction -= 0.5 * dt * (point.shear_force - point.shear_viscous).dot(&rate);
        }
    }

    /// Normal from i to j and deepest overlap, with the patch in place; `None` when apart.
    fn find_patch(&mut self, context: &ContactContext, patch: &mut Patch) -> Option<(Vec3, f64)> {
        let (first, second) = (
            &context.parts[self.parts.0 as usize],
            &context.parts[self.parts.1 as usize],
        );
        match (first, second) {
            (Part::Polyhedron(a), Part::Polyhedron(b)) => {
                let axis = if self.bond.is_some() {
                    self.axis.axis.map(|axis| glued(a, b, &axis))?
                } else {
                    self.axis
                        .overlapping(a, b, context.contact_detection, &context.gravity)?
                };
                let scaling = context.joint_of(self.parts).scaling;
                patch.find(a, b, &axis, scaling, self.bond.is_some());
                if patch.points.is_empty() {
                    return None;
                }
                self.features = Some((axis.kind, patch.incident));
                Some((axis.normal, (-axis.gap).max(0.0)))
            }
            _ => None,
        }
    }

    fn apply_law(&mut self, context: &ContactContext, dt: f64, former: &Former, patch: &Patch) {
        self.apply_normal(context, dt, former, patch);
        self.apply_friction(context, dt, patch);
        let (a, b) = self.bodies(context);
        for point in &self.points {
            let force = self.normal * point.normal_force + point.shear_force;
            let x = &point.patch.position;
            self.loads.0.add(&-force, &(x - a.centroid));
            self.loads.1.add(&force, &(x - b.centroid));
        }
    }

    /// Normal dashpot per unit of weight and shear dashpot of the whole; N s/m.
    pub fn dashpots(&self) -> (f64, f64) {
        self.dashpots
    }

    fn bodies<'a>(&self, context: &ContactContext<'a>) -> (&'a Kinematics, &'a Kinematics) {
        (
            &context.kinematics[self.blocks.0 as usize],
            &context.kinematics[self.blocks.1 as usize],
        )
    }

    fn apply_normal(&mut self, context: &ContactContext, dt: f64, former: &Former, patch: &Patch) {
        let joint = context.joint_of(self.parts);
        let (a, b) = self.bodies(context);
        let points = &patch.points;
        let total: f64 = points.iter().map(|p| p.weight).sum();
        let middle: Vec3 = points.iter().map(|p| p.position * (p.weight / total)).sum();
        let stiffness = joint.normal_stiffness * total;
        let mobility = a.compliance(&middle, &self.normal) + b.compliance(&middle, &self.normal);
        // 2 ξ √(K_e m_e), N s/m.
        let damping = if mobility > 0.0 {
            2.0 * joint.damping_ratio * (stiffness / mobility).sqrt() / total
        } else {
            0.0
        };
        self.dashpots.0 = damping;
        let meeting = (former.points.is_empty() && self.bond.is_none()).then(|| {
            let closing = (a.velocity_at(&middle) - b.velocity_at(&middle)).dot(&self.normal);
            (self.deepest, closing)
        });
        let damping = damping * dashpot_share(damping * total * mobility, dt, meeting);
        for &patch in points {
            let x = &patch.position;
            let opening = (b.velocity_at(x) - a.velocity_at(x)).dot(&self.normal);
            let spring = patch.weight * joint.normal_stiffness * patch.overlap;
            let mut normal_force = spring - patch.weight * damping * opening;
            if self.bond.is_none() {
                normal_force = normal_force.max(0.0);
            }
            self.points.push(PointState {
                patch,
                normal_force,
                normal_viscous: normal_force - spring,
                shear_force: Vec3::zeros(),
                shear_viscous: Vec3::zeros(),
                state: ContactState::Open,
            });
        }
    }

    fn apply_friction(&mut self, context: &ContactContext, dt: f64, patch: &Patch) {
        let joint = context.joint_of(self.parts);
        let friction = if self.has_slipped {
            joint.residual_friction
        } else {
            joint.friction
        };
        let cohesion = if self.is_broken {
            joint.residual_cohesion * patch.area
        } else {
            0.0
        };
        let held = Shearing {
            bodies: self.bodies(context),
            normal: self.normal,
            weight: patch.flat_weight,
            stiffness: joint.shear_stiffness,
            damping_ratio: context.shear_damping_ratio,
            friction,
            cohesion,
            is_bonded: self.bond.is_some(),
            dt,
        }
        .apply(&mut self.points, &self.shear);
        self.shear = held.spring;
        self.shear_energy = held.energy;
        self.dashpots.1 = held.damping;
        self.has_slipped |= held.has_slipped;
    }

    /// Does the bond hold no longer, or has it slid off its patch?
    fn is_overloaded(&self, bond: &Bond, context: &ContactContext, patch: &Patch) -> bool {
        let outline = patch.bonded_outline();
        self.points.is_empty()
            || bond.is_overloaded(
                context.joint_of(self.parts),
                &self.points,
                &self.normal,
                outline,
            )
    }

    /// The bond is gone: the forces are found again without it.
    fn break_bond(
        &mut self,
        context: &ContactContext,
        dt: f64,
        former: &Former,
        patch: &mut Patch,
    ) {
        self.bond = None;
        self.has_broken = true;
        self.is_broken = true;
        self.has_slipped = true;
        self.loads = (Load::default(), Load::default());
        self.points.clear();
        self.deepest = 0.0;
        self.features = None;
        self.press(context, dt, former, patch);
    }

    /// Energy of the springs now, and what was lost with a bond or with points that are gone.
    fn settle_energy(&mut self, context: &ContactContext, dt: f64, former: &Former) {
        let joint = context.joint_of(self.parts);
        let before = self.elastic;
        let squares: f64 = self
            .points
            .iter()
            .map(|p| p.patch.weight * p.patch.overlap * p.patch.overlap)
            .sum();
        if self.points.is_empty() {
            self.shear = ShearSpring::default();
            self.shear_energy = 0.0;
        }
        let held = 0.5 * joint.normal_stiffness * squares;
        self.friction += before.1 - self.shear_energy;
        if self.has_broken {
            // All that the springs of the bond held and did not give to the blocks is lost with it.
            let given = self.work_of_normal_springs(&self.points, &self.normal, context, (dt, 0.0));
            self.damping += self.energy_left(context, dt, former) - held - given;
            self.damping += std::mem::take(&mut self.friction);
        } else if self.points.is_empty() && !former.points.is_empty() {
            // The bodies have parted: what the springs still held is lost.
            self.damping += self.energy_left(context, dt, former);
            self.part(context, dt, former);
        }
        self.elastic = (held, self.shear_energy);
    }

    /// Rate bounds of the pair for its two blocks, twice as much against a partner that is free. Before the parts
    /// touch, for the worst point of their bounding spheres. `weight` is the flat weight of the patch.
    fn rate_bounds(&self, context: &ContactContext, weight: f64) -> (Rates, Rates) {
        let (a, b) = self.bodies(context);
        let radii = (
            context.radius[self.blocks.0 as usize],
            context.radius[self.blocks.1 as usize],
        );
        let levers = (
            context.lever[self.blocks.0 as usize],
            context.lever[self.blocks.1 as usize],
        );
        let twice = |partner: &Kinematics| if partner.inverse_mass > 0.0 { 2.0 } else { 1.0 };
        (
            self.rates_of(context, a, levers.0, (radii, weight))
                .times(twice(b)),
            self.rates_of(context, b, levers.1, (radii, weight))
                .times(twice(a)),
        )
    }

    fn rates_of(
        &self,
        context: &ContactContext,
        body: &Kinematics,
        lever: f64,
        (radii, weight): ((f64, f64), f64),
    ) -> Rates {
        if body.inverse_mass == 0.0 {
            return Rates::default();
        }
        let joint = context.joint_of(self.parts);
        if self.points.is_empty() {
            let (along, sum) = body.worst_compliance(lever);
            let across = sum - along;
            let weight = match joint.scaling {
                Scaling::Point => 1.0,
                // No face is larger than the great circle of the smaller bounding sphere.
                Scaling::Area => std::f64::consts::PI * radii.0.min(radii.1).powi(2),
            };
            let (a, b) = self.bodies(context);
            let mobility = a.inverse_mass + b.inverse_mass;
            let dashpot = |stiffness: f64, ratio: f64| 2.0 * ratio * (stiffness / mobility).sqrt();
            let (k_n, k_t) = (
                joint.normal_stiffness * weight,
                joint.shear_stiffness * weight,
            );
            return Rates {
                stiffness: k_n * along + k_t * across,
                damping: dashpot(k_n, joint.damping_ratio) * along
                    + dashpot(k_t, context.shear_damping_ratio) * across,
            };
        }
        let total: f64 = self.points.iter().map(|p| p.patch.weight).sum();
        let normal: f64 = self.points.iter().map(|p| p.normal_force.max(0.0)).sum();
        let (mut along, mut across) = (0.0, 0.0);
        for point in &self.points {
            let x = &point.patch.position;
            let compliance = body.compliance(x, &self.normal);
            along += point.patch.weight * compliance;
            // Shear stiffness lies where the pressure is.
            let share = if self.bond.is_some() || normal <= 0.0 {
                point.patch.weight / total
            } else {
                point.normal_force.max(0.0) / normal
            };
            across += share * (body.compliance_trace(x) - compliance);
        }
        Rates {
            stiffness: joint.normal_stiffness * along + joint.shear_stiffness * weight * across,
            damping: self.dashpots.0 * along + self.dashpots.1 * across,
        }
    }
}

/// Share of the dashpot that acts in a step, so that the rebound is in the mean the one asked, to second order
/// in it.
///
/// ```text
/// s = 1/(1 + c w dt/4)                                    later on                                [–]
/// s = (1/2 + δ/(u dt))/(1 + c w dt/4),   s c w dt ≤ 1     in the step in which the bodies meet
/// ```
/// The velocity is that of half a step ago, which was faster by `(k δ + c u) w dt/2`: damping and stiffness
/// seem larger, and the damping ratio by `1 + c w dt/4`. The force at the end of a step stands for half a step
/// on either side, but they met only `δ/u` ago: with a whole force the rebound of one spring was 0.40 to 0.58
/// for 0.5, depending on where in a step they met, with five steps in a contact. It then takes no more than all of the
/// speed. Rate of damping `c w` (1/s); `meeting`: overlap δ (m) and closing rate u (m/s).
pub(crate) fn dashpot_share(rate: f64, dt: f64, meeting: Option<(f64, f64)>) -> f64 {
    let later = 1.0 / (1.0 + 0.25 * rate * dt);
    match meeting {
        Some((overlap, closing)) if closing * dt > 0.0 => {
            let first = (0.5 + overlap / (closing * dt)).clamp(0.5, 1.5) * later;
            first.min(f64::max(1.0 / (rate * dt), later))
        }
        _ => later,
    }
}

/// The bonded faces at their current position.
fn glued(a: &crate::Polyhedron, b: &crate::Polyhedron, axis: &Axis) -> Axis {
    let normal = match axis.kind {
        AxisKind::FaceA(face) => a.face_normal(face as usize),
        AxisKind::FaceB(face) => -b.face_normal(face as usize),
        _ => axis.normal,
    };
    Axis {
        normal,
        gap: crate::gap_along(a, b, &normal),
        kind: axis.kind,
    }
}
