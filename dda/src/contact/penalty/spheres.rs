//! Contact of spheres, with each other and with polyhedra: one point, linear or Hertz's spring, shear
//! spring with history, rolling resistance.
//!
//! ```text
//! linear   F_n = k δ − 2 ξ √(k m̃) u_n ≥ 0
//! Hertz    F_n = K δ^3/2 − β √(m̃ K) δ^1/4 u_n ≥ 0,    K = 4/3 E* √R̃                                [N]
//! shear    F_t = −k_t ξ − 2 ξ_t √(k_t m̃) u_t,   |F_t| ≤ μ_s F_n, once it slips μ_d F_n, until it holds again
//! rolling  M = −k_r θ − c_r ω_r,   k_r = 9/4 k_n μ_r² R̃²,   |M| ≤ μ_r R̃ F_n,el                      [N m]
//! ```
//! `1/m̃` is the sum of both sides' compliances along the normal, `R̃ = r_i r_j/(r_i + r_j)`, or `r` against
//! a polyhedron; ξ and β are those that give the restitution with a force that never pulls (Schwager &
//! Pöschel 2007). Sources: Cundall & Strack (1979), Tsuji, Tanaka & Ishida (1992), Luding (2008); rolling:
//! Ai, Chen, Rotter & Ooi (2011), whose spring lets a sphere come to rest. What `ω_r` and `θ`, its integral, turn
//! against: see [`RollingLaw`].
//!
//! The force acts in the middle of the overlap, so that angular momentum is kept, but for
//! [`RollingLaw::OwnSpin`], whose sink is booked.

mod feet;
mod law;
mod rolling;
mod sides;

use crate::StepBound;
use crate::contact::context::ContactContext;
use crate::contact::detection::manifold::PointManifold;
use crate::contact::detection::spheres::{effective_radius, of_two, with_body};
use crate::contact::penalty::step_bound::Springs;
use crate::contact::rates::Rates;
use crate::contact::tally::Tally;
use crate::geometry::parts::Part;
use crate::material::{RollingLaw, SphereJoint};
use crate::motion::kinematics::Kinematics;
pub(crate) use feet::{SphereOnSurface, SurfaceLaw};
use law::book_first_half;
pub(crate) use law::{SphereContact, SphereLoads};
pub(crate) use rolling::Rolling;
use serde::{Deserialize, Serialize};
use sides::{Ball, Body, Side};

/// Two parts that may touch, a sphere at least one of them: what is read of a pair that stays apart, as half of
/// them do. The rest lies in columns of its own, which only those that touch bring into the caches.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct SpherePair {
    pub parts: (u32, u32),
    pub blocks: (u32, u32),
}

/// Index of a pair.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct SphereMark {
    pub is_touching: bool,
    /// Are its rates others than after the last evaluation?
    pub has_new_rates: bool,
    /// Was it ever looked at?
    is_known: bool,
}

/// One row of all columns of a pair.
pub(crate) struct SphereRow<'a> {
    pub pair: &'a SpherePair,
    pub mark: &'a mut SphereMark,
    pub contact: &'a mut SphereContact,
    pub loads: &'a mut SphereLoads,
    pub rates: &'a mut PairRates,
    /// Only where a joint resists rolling.
    pub rolling: Option<&'a mut Rolling>,
}

/// Contribution of a pair to the step bound of each of its blocks.
pub(crate) type PairRates = (Rates, Rates);

/// Lengths of a pair; m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Scales {
    /// `R̃`.
    pub effective_radius: f64,
    /// One over the deepest overlap allowed, and over the size of the smaller part; 1/m.
    per_allowed: f64,
    per_size: f64,
}

impl Scales {
    /// Of two parts, a sphere at least one of them; the lesser of what is allowed and of their sizes.
    pub fn of(parts: (&Part, &Part), allowed_overlap: f64, size: f64) -> Self {
        Self {
            effective_radius: effective_radius(parts),
            per_allowed: 1.0 / allowed_overlap,
            per_size: 1.0 / size,
        }
    }
}

/// Joint of a pair and the step.
struct Law<'a> {
    joint: &'a SphereJoint,
    /// m.
    effective_radius: f64,
    rolling_law: RollingLaw,
    /// s.
    dt: f64,
    /// True in the step in which the bodies meet.
    is_meeting: bool,
}

impl SphereRow<'_> {
    /// Finds the contact at the current position and its force at the present velocities; books what was
    /// lost during the last `dt` (s).
    pub fn evaluate(self, context: &ContactContext, dt: f64, tally: &mut Tally) {
        let parts = self.pair.parts;
        let (first, second) = (
            &context.parts[parts.0 as usize],
            &context.parts[parts.1 as usize],
        );
        let (a, b) = (
            &context.kinematics[self.pair.blocks.0 as usize],
            &context.kinematics[self.pair.blocks.1 as usize],
        );
        match (first, second) {
            (
                Part::Sphere {
                    center: x,
                    radius: r,
                },
                Part::Sphere {
                    center: y,
                    radius: s,
                },
            ) => {
                let found = of_two((x, *r), (y, *s));
                self.update(found, &(Ball(a, *r), Ball(b, *s)), context, dt, tally);
            }
            (Part::Sphere { center, radius }, Part::Polyhedron(body)) => {
                let surface = body.touch_point_within(center, *radius);
                let found = surface.map(|at| with_body(&at, -at.normal, *radius));
                self.update(found, &(Ball(a, *radius), Body(b)), context, dt, tally);
            }
            (Part::Polyhedron(body), Part::Sphere { center, radius }) => {
                let surface = body.touch_point_within(center, *radius);
                let found = surface.map(|at| with_body(&at, at.normal, *radius));
                self.update(found, &(Body(a), Ball(b, *radius)), context, dt, tally);
            }
            _ => {}
        }
    }

    fn update<A: Side, B: Side>(
        mut self,
        found: Option<PointManifold>,
        sides: &(A, B),
        context: &ContactContext,
        dt: f64,
        tally: &mut Tally,
    ) {
        let was_touching = self.mark.is_touching;
        self.mark.has_new_rates = false;
        if found.is_none() && !was_touching && self.mark.is_known && !context.is_hertz {
            return;
        }
        let joint = &context.joint_of(self.pair.parts).spheres;
        let scales = self.contact.scales;
        let law = Law {
            joint,
            effective_radius: scales.effective_radius,
            rolling_law: context.rolling_law,
            dt,
            is_meeting: !was_touching,
        };
        if was_touching {
            let rolling = self.rolling.as_deref();
            book_first_half(self.contact, self.loads, rolling, dt, sides, tally);
        }
        self.mark.is_known = true;
        self.mark.is_touching = found.is_some();
        let Some(found) = found else {
            if was_touching && self.contact.normal_force == 0.0 {
                // No force acted any more: what the spring still held is lost.
                tally.damping += joint.energy(self.contact.overlap, law.effective_radius);
            }
            // What shear and rolling springs held was booked with the first half.
            *self.contact = SphereContact::apart(scales);
            *self.loads = SphereLoads::default();
            *self.rates = self.pair.rates_before_touch(&law, sides, context);
            self.mark.has_new_rates = true;
            if let Some(rolling) = self.rolling {
                *rolling = Rolling::default();
            }
            return;
        };
        tally.note_overlap(
            self.pair.parts,
            found.depth * scales.per_allowed,
            found.depth * scales.per_size,
        );
        let rolling = self.rolling.as_deref_mut();
        let pressed = self
            .contact
            .apply(&found, &law, sides, self.loads, rolling, tally);
        let is_steady = was_touching
            && joint.is_linear()
            && sides.0.has_steady_rates()
            && sides.1.has_steady_rates();
        if !is_steady {
            *self.rates =
                self.contact
                    .rates(&found, &law, sides, &pressed, self.rolling.as_deref());
            self.mark.has_new_rates = true;
        }
    }
}

impl SpherePair {
    /// Rates of a pair that may touch in the next step. With [`StepBound::Eigenvalues`] those of the two alone,
    ///
    /// ```text
    /// Λ_K = max(k_n (1/m_i + 1/m_j), k_t (w_i + w_j)) + k_r (1/J_i + 1/J_j),   w = 1/m + r²/J                [1/s²]
    /// ```
    /// as a force along the normal does not turn a sphere; of a body that is none `w` stands for `1/m`, too.
    fn rates_before_touch<A: Side, B: Side>(
        &self,
        law: &Law,
        sides: &(A, B),
        context: &ContactContext,
    ) -> (Rates, Rates) {
        let (a, b) = (sides.0.kinematics(), sides.1.kinematics());
        let joint = law.joint;
        let mobility = a.inverse_mass + b.inverse_mass;
        let approach = (b.velocity - a.velocity).norm();
        let stiffness = joint.tangent_bound(0.0, law.effective_radius, approach, mobility);
        let springs = Springs {
            stiffness: (stiffness, joint.shear_ratio * stiffness),
            damping_ratio: (joint.damping_ratio_bound(), joint.shear_damping_ratio),
            mobility,
        };
        let lever_arm = |block: u32| &context.lever_arm[block as usize];
        let arms = (lever_arm(self.blocks.0), lever_arm(self.blocks.1));
        if context.step_bound == StepBound::Compliances {
            return springs.before_touch(((a, arms.0), (b, arms.1)), context.step_bound);
        }
        let (first, second) = (
            sides.0.largest_compliances(arms.0),
            sides.1.largest_compliances(arms.1),
        );
        let mut rates = springs.of_two(first.0 + second.0, first.1 + second.1);
        rates.add(&Rolling::rates_before_touch(law, stiffness, sides));
        let of = |body: &Kinematics| match body.inverse_mass > 0.0 {
            true => rates,
            false => Rates::default(),
        };
        (of(a), of(b))
    }
}
