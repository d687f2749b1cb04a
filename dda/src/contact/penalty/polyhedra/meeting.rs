//! Bodies that meet or part within a step.
//!
//! A force found at the end of a step stands for half a step on either side, but bodies that have just met were
//! apart for a part of the first half, and bodies that have just parted touched only for a part of the second.
//! Their springs would give or take too much by up to `(ω dt)²/4` of the energy of the hit, less or more as the
//! phase falls: a cube that bounces without loss gained 0.6 % each time where it met in short steps and parted in
//! long ones. So the half kick at the end of such a step is cut to the time of touch,
//!
//! ```text
//! τ/dt = U/W,   U = ½ K Σ w δ²,   W = ½ dt K Σ w δ |ġ|                                               [–]
//! ```
//! which is `δ/(|ġ| dt)` of a single point: the bodies give and get what the springs hold. Source: none; the
//! dashpot's share in a meeting, `dashpot_share`, has the same reason.

use super::{Former, Pair};
use crate::Vec3;
use crate::contact::context::ContactContext;

/// A force on the block j at a point, and its opposite on i; world; N, m.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointForce {
    pub point: Vec3,
    pub force: Vec3,
}

impl Pair {
    /// The bodies were apart a step ago.
    pub(super) fn meet(&mut self, context: &ContactContext, dt: f64) {
        let taken = -self.work_of_normal_springs(&self.points, &self.normal, context, (dt, 0.0));
        let squares: f64 = self
            .points
            .iter()
            .map(|p| p.patch.weight * p.patch.overlap * p.patch.overlap)
            .sum();
        let held = 0.5 * context.joint_of(self.parts).normal_stiffness * squares;
        // Bodies that overlap at the start were never apart.
        if !(held < taken) {
            return;
        }
        let apart = 1.0 - held / taken;
        let (a, b) = self.bodies(context);
        for point in &self.points {
            let x = point.patch.position;
            let rate = b.velocity_at(&x) - a.velocity_at(&x);
            let half = 0.5 * dt * apart;
            self.friction += half * (point.shear_force - point.shear_viscous).dot(&rate);
            self.damping += half * point.shear_viscous.dot(&rate);
            let spring = self.normal * (point.normal_force - point.normal_viscous);
            self.excess.push(PointForce {
                point: x,
                force: (spring + point.shear_force) * -apart,
            });
        }
    }

    /// The bodies touched a step ago.
    pub(super) fn part(&mut self, context: &ContactContext, dt: f64, former: &Former) {
        let held = self.elastic.0;
        let given = self.work_of_normal_springs(former.points, &former.normal, context, (dt, dt));
        // Where a body slides off an edge, springs are left over.
        if !(held < given) {
            return;
        }
        let apart = 1.0 - held / given;
        let (a, b) = self.bodies(context);
        for point in former.points {
            let x = point.patch.position;
            let rate = b.velocity_from(&x, dt) - a.velocity_from(&x, dt);
            let half = 0.5 * dt * apart;
            self.friction += half * (point.shear_force - point.shear_viscous).dot(&rate);
            let normal = former.normal * point.normal_force;
            self.damping += half * (normal + point.shear_viscous).dot(&rate);
            self.excess.push(PointForce {
                point: x + (a.velocity_at(&x) + b.velocity_at(&x)) * (0.5 * dt),
                force: (normal + point.shear_force) * -apart,
            });
        }
    }
}
