//! Penalty contact of two polyhedra.
//!
//! The springs of a patch have a potential while its two faces stay the same (see `patch`).
//!
//! **Bonds.** Parts that lie against each other at the start with cohesion or tensile strength are
//! bonded: they also pull, up to a tension of `T` at the edge of the patch, and hold shear up to
//! `c A + F_n tan φ` (A the area of the patch at the start). Past either limit the bond breaks for good,
//! see `bond`; of its strength there stays `c_r A + F_n tan φ_r` (A the wet area). What its springs held
//! goes to damping.

mod step;

use super::friction::ShearSpring;
use super::history::PairLoads;
use super::law::PairLaw;
use crate::contact::bond::Bond;
use crate::contact::context::ContactContext;
use crate::contact::detection::common_plane::AxisCache;
use crate::contact::detection::manifold::Features;
use crate::contact::detection::patch::Patch;
use crate::contact::detection::polyhedra::NarrowPhase;
use crate::contact::rates::Rates;
use crate::contact::report::PointState;
use crate::contact::spread::Spread;
use crate::contact::spring::Spring;
use crate::geometry::parts::Part;
use crate::material::{Joint, Scaling};
use crate::motion::kinematics::Kinematics;
use crate::motion::update::Update;
use crate::{Motion, Vec3};
use serde::{Deserialize, Serialize};
use step::Step;

/// Share of a gap that two blocks surely travel before they touch, for round-off; –.
const TRUSTED_GAP: f64 = 0.999;

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
    /// Sum of the travels of the two blocks before which they cannot touch, nothing else of the pair changing; m.
    pub apart_until: f64,
    /// Memory of the narrow phase.
    pub axis: AxisCache,
    /// Memory of the law.
    pub history: History,
    pub loads: PairLoads,
    /// Places of the springs, if there is any force.
    pub spread: Spread,
}

/// Memory of the law of two polyhedra.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct History {
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
    /// Features that formed the patch at that time, and the fraction of its stiffness, see `feature_change`; –.
    pub features: Option<Features>,
    pub stiffness_share: f64,
    /// Energy of the normal and of the shear springs; J.
    pub elastic: (f64, f64),
}

/// Buffers of an evaluation, one for the pairs of a chunk: with buffers of their own, thousands of pairs would
/// not fit the caches.
#[derive(Clone, Debug, Default)]
pub(crate) struct Workspace {
    /// Points of the step before.
    before: Vec<PointState>,
    patch: Patch,
}

impl Pair {
    pub fn new(parts: (u32, u32), blocks: (u32, u32)) -> Self {
        Self {
            parts,
            blocks,
            rates: (Rates::default(), Rates::default()),
            is_touching: false,
            is_idle: false,
            apart_until: f64::NEG_INFINITY,
            axis: AxisCache::default(),
            history: History {
                bond: None,
                points: Vec::new(),
                normal: Vec3::z(),
                shear: ShearSpring::default(),
                has_slipped: false,
                is_broken: false,
                features: None,
                stiffness_share: 1.0,
                elastic: (0.0, 0.0),
            },
            loads: PairLoads::default(),
            spread: Spread::default(),
        }
    }

    /// Glues the pair if its parts lie face to face and the joint has strength.
    pub fn bond(&mut self, context: &ContactContext) {
        let joint = context.joint_of(self.parts);
        if joint.cohesion <= 0.0 && joint.tensile_strength <= 0.0 {
            return;
        }
        let narrow_phase = self.narrow_phase(context);
        let area = narrow_phase.and_then(|find| find.find_joint(&mut self.axis));
        if let Some(area) = area {
            self.history.bond = Some(Bond { area });
        }
    }

    fn narrow_phase<'a>(&self, context: &ContactContext<'a>) -> Option<NarrowPhase<'a>> {
        let part = |part: u32| &context.parts[part as usize];
        match (part(self.parts.0), part(self.parts.1)) {
            (Part::Polyhedron(a), Part::Polyhedron(b)) => Some(NarrowPhase {
                bodies: (a, b),
                detection: context.contact_detection,
                gravity: context.gravity,
                scaling: context.joint_of(self.parts).scaling,
            }),
            _ => None,
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
        let Some(narrow_phase) = self.narrow_phase(context) else {
            return;
        };
        let Workspace { before, patch } = work;
        let law = PairLaw::of(context, self.parts, self.blocks, dt);
        let is_bonded = self.history.bond.is_some();
        let mut step = Step::begin(law, &mut self.history, &mut self.loads, before);
        let is_found = if is_bonded {
            narrow_phase.find_bonded(&self.axis, patch)
        } else {
            is_near && narrow_phase.find(&mut self.axis, patch)
        };
        if is_found {
            step.press(&mut patch.manifold);
        }
        if is_bonded && step.is_overloaded(patch) {
            step.break_bond();
            if narrow_phase.find(&mut self.axis, patch) {
                step.press(&mut patch.manifold);
            }
        }
        step.finish();
        if !self.history.points.is_empty() {
            let is_bonded = self.history.bond.is_some();
            self.spread = Spread::of(&self.history.points, &self.history.normal, is_bonded);
        }
        self.rates = self.rate_bounds(context, &law, patch.manifold.flat_weight);
        self.is_touching = !self.history.points.is_empty();
        // The compliances of blocks that deform or are held change as they turn.
        let is_steady = |block: u32| context.update[block as usize] != Update::Constrained;
        let is_active =
            is_near || self.is_touching || self.history.bond.is_some() || self.loads.has_broken;
        self.is_idle = !is_active && is_steady(self.blocks.0) && is_steady(self.blocks.1);
        self.apart_until = if is_near {
            self.last_travel_apart(context)
        } else {
            f64::NEG_INFINITY
        };
    }

    /// Sum of the travels before which two rigid blocks that were just found apart cannot touch; −∞ for all others.
    fn last_travel_apart(&self, context: &ContactContext) -> f64 {
        let is_tracked = |block: u32| {
            context.update[block as usize] != Update::Constrained
                && !matches!(context.motion[block as usize], Motion::Prescribed(_))
        };
        let is_active = self.is_touching || self.history.bond.is_some() || self.loads.has_broken;
        match self.axis.axis {
            Some(axis)
                if axis.gap > 0.0
                    && !is_active
                    && is_tracked(self.blocks.0)
                    && is_tracked(self.blocks.1) =>
            {
                context.travel_of(self.blocks) + TRUSTED_GAP * axis.gap
            }
            _ => f64::NEG_INFINITY,
        }
    }

    /// Springs of its points. Shear stiffness lies where the pressure is, that of a bond where its patch is.
    pub fn springs<'a>(&'a self, joint: &'a Joint) -> impl Iterator<Item = Spring> + 'a {
        let History {
            bond,
            points,
            normal,
            shear,
            ..
        } = &self.history;
        let total: f64 = points.iter().map(|p| p.at.weight).sum();
        let pressed: f64 = points.iter().map(|p| p.normal_force.max(0.0)).sum();
        let (along, across) = self.loads.dashpots;
        points.iter().map(move |point| {
            let share = if bond.is_some() || pressed <= 0.0 {
                point.at.weight / total
            } else {
                point.normal_force.max(0.0) / pressed
            };
            Spring {
                blocks: [self.blocks.0 as usize, self.blocks.1 as usize],
                point: point.at.position,
                normal: *normal,
                stiffness: [
                    joint.normal_stiffness * point.at.weight,
                    joint.shear_stiffness * shear.weight * share,
                ],
                dashpot: [along * point.at.weight, across * share],
            }
        })
    }

    /// Stiffness (N/m) of its springs, of a unit of weight along the normal and of the whole across it, and of the dashpots (N s/m).
    pub fn coefficients(&self, joint: &Joint) -> [[f64; 2]; 2] {
        let across = joint.shear_stiffness * self.history.shear.weight;
        [[joint.normal_stiffness, across], self.loads.dashpots.into()]
    }

    /// Rate bounds of the pair for its two blocks, twice as much against a partner that is free. Before the parts
    /// touch, for their worst points. `weight` is the flat weight of the patch.
    fn rate_bounds(&self, context: &ContactContext, law: &PairLaw, weight: f64) -> (Rates, Rates) {
        let (a, b) = law.bodies;
        let joint = law.joint;
        if self.history.points.is_empty() {
            let weight = match joint.scaling {
                Scaling::Point => 1.0,
                // No face is larger than the great circle of the smaller bounding sphere.
                Scaling::Area => {
                    let radius = |block: u32| context.radius[block as usize];
                    let least = radius(self.blocks.0).min(radius(self.blocks.1));
                    std::f64::consts::PI * least.powi(2)
                }
            };
            let lever_arm = |block: u32| &context.lever_arm[block as usize];
            return law
                .springs(weight, a.inverse_mass + b.inverse_mass)
                .before_touch(
                    ((a, lever_arm(self.blocks.0)), (b, lever_arm(self.blocks.1))),
                    context.step_bound,
                );
        }
        let of = |body: &Kinematics, partner: &Kinematics| {
            if body.inverse_mass == 0.0 {
                return Rates::default();
            }
            let twice = if partner.inverse_mass > 0.0 { 2.0 } else { 1.0 };
            let [along, across] = self.spread.compliances(body);
            let stiffness = joint.shear_stiffness * weight;
            let (dashpot, shear_dashpot) = self.loads.dashpots;
            Rates {
                stiffness: joint.normal_stiffness * along + stiffness * across,
                damping: dashpot * along + shear_dashpot * across,
            }
            .times(twice)
        };
        (of(a, b), of(b, a))
    }
}
