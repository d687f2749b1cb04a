//! Energy continuity when the contact features change.
//!
//! A patch under each of the faces, a pair of edges, and a corner beside a face have potentials of their
//! own (see `patch`). Where one ends and another begins, the stiffness of the new one is scaled so that it
//! holds what the old one left,
//!
//! ```text
//! s (U + W) = U_before − W_before,     s ≤ 1                                                    [J]
//! ```
//! W the works of the springs in the two halves of the step. Without it a step between the two came from
//! nothing: a pile of fifty hulls missed 2.4 % of the energy that it lost, most of it where two edges took
//! over from a face. Of a larger energy than the new springs take (s = 1) the rest is lost and is booked
//! with the dashpots, 1 % of what that pile loses. A contact that has become softer stiffens with what its
//! own dashpots and friction take from then on, and starts again when the bodies part. A contact that begins
//! deep, without one before, still comes from nothing.

use super::Pair;
use crate::Vec3;
use crate::contact::context::ContactContext;
use crate::contact::detection::common_plane::AxisKind;
use crate::contact::detection::patch::{Patch, PatchPoint};
use crate::contact::report::PointState;

/// No contact becomes softer than this share; –.
const SOFTEST: f64 = 1e-3;

/// Features that form the patch: the common plane, and the facing face of the other body; `None` if
/// the contact is a point.
pub(crate) type Features = (AxisKind, Option<u32>);

/// The contact as it was in the step before.
pub(super) struct Former<'a> {
    pub normal: Vec3,
    pub features: Option<Features>,
    pub points: &'a [PointState],
}

impl Pair {
    /// Scales the weights of the patch just found.
    pub(super) fn keep_energy(
        &mut self,
        context: &ContactContext,
        dt: f64,
        former: &Former,
        patch: &mut Patch,
    ) {
        if former.points.is_empty() || self.has_broken {
            self.stiffness_share = 1.0;
            return;
        }
        if self.features != former.features {
            let left = self.energy_left(context, dt, former);
            let asked = self.energy_asked(context, dt, patch);
            self.stiffness_share = if asked > 0.0 {
                (left / asked).clamp(SOFTEST, 1.0)
            } else {
                1.0
            };
            self.damping += (left - self.stiffness_share * asked).max(0.0);
        }
        if self.stiffness_share < 1.0 {
            for point in &mut patch.points {
                point.weight *= self.stiffness_share;
            }
        }
    }

    /// Energy of the normal springs of the previous step after its first half, in which they did work; J.
    pub(super) fn energy_left(&self, context: &ContactContext, dt: f64, former: &Former) -> f64 {
        self.elastic.0
            - self.work_of_normal_springs(former.points, &former.normal, context, (dt, dt))
    }

    /// Energy that the springs of the current patch store and release in the second half of the step; J.
    fn energy_asked(&self, context: &ContactContext, dt: f64, patch: &Patch) -> f64 {
        let stiffness = context.joint_of(self.parts).normal_stiffness;
        let (a, b) = self.bodies(context);
        let of = |point: &PatchPoint| {
            let x = &point.position;
            let opening = (b.velocity_at(x) - a.velocity_at(x)).dot(&self.normal);
            0.5 * stiffness * point.weight * point.overlap * (point.overlap + dt * opening)
        };
        patch.points.iter().map(of).sum()
    }

    /// A softer contact takes up what it lost in this step.
    pub(super) fn stiffen(&mut self) {
        let lost = self.damping + self.friction;
        if self.stiffness_share >= 1.0 || lost <= 0.0 || self.elastic.0 <= 0.0 {
            return;
        }
        let whole = self.elastic.0 / self.stiffness_share;
        let stiffness_share = (self.stiffness_share + lost / whole).min(1.0);
        let taken = (stiffness_share - self.stiffness_share) * whole;
        self.elastic.0 += taken;
        self.damping -= taken;
        self.stiffness_share = stiffness_share;
    }

    /// Half a step's work of the normal springs on the blocks, as in `book_work`; J. The step and how long
    /// ago the points were found; s.
    pub(super) fn work_of_normal_springs(
        &self,
        points: &[PointState],
        normal: &Vec3,
        context: &ContactContext,
        (dt, ago): (f64, f64),
    ) -> f64 {
        let (a, b) = self.bodies(context);
        let work = |point: &PointState| {
            let x = &point.patch.position;
            let opening = (b.velocity_from(x, ago) - a.velocity_from(x, ago)).dot(normal);
            0.5 * dt * (point.normal_force - point.normal_viscous) * opening
        };
        points.iter().map(work).sum()
    }
}
