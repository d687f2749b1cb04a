//! Affine blocks in a step of contact dynamics: drift, what contacts move, kick. Their motion is that of `motion::deformation`.
//!
//! Overlap moves and turns them like rigid blocks, which leaves their strain and its energy as they are.

use crate::contact::dynamics::bodies::{Bodies, BodyVelocities, StrainingBody};
use crate::motion::deformation::{Affine12, MomentCompliance};
use crate::motion::kinematics::Moment;
use crate::{Blocks, Vec3};
use nalgebra::UnitQuaternion;

/// Half of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Half {
    ToMiddle,
    FromMiddle,
}

impl Blocks {
    /// Number of each affine block, and that among the deformable blocks, in their order.
    fn straining(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let n = match self.state.deformables.is_empty() {
            true => 0,
            false => self.n_blocks(),
        };
        (0..n).filter_map(|b| Some((b, self.constants.deformable_of[b]? as usize)))
    }

    /// Rotates and strains all affine blocks over a half of `h` (s).
    pub(super) fn drift_straining(&mut self, half: Half, h: f64) {
        for k in 0..self.derived.constrained.len() {
            let b = self.derived.constrained[k] as usize;
            let Some(affine) = self.affine_mut(b) else {
                continue;
            };
            match half {
                Half::ToMiddle => affine.body.drift_to_middle(h),
                Half::FromMiddle => affine.body.drift_from_middle(h),
            }
        }
    }

    fn affine(&self, k: usize) -> Option<&Affine12> {
        self.state.deformables[k].affine()
    }

    fn affine_mut(&mut self, b: usize) -> Option<&mut Affine12> {
        let k = self.constants.deformable_of[b]?;
        self.state.deformables[k as usize].affine_mut()
    }

    /// Affine blocks as impulses within `dt` (s) strain them.
    pub(super) fn straining_bodies(&self, dt: f64) -> Vec<StrainingBody> {
        let of = |(b, k): (usize, usize)| {
            let affine = self.affine(k).filter(|_| self.is_driven(b));
            StrainingBody {
                body: b as u32,
                compliance: affine.map_or_else(MomentCompliance::zeros, |affine| {
                    affine.moment_compliance(dt)
                }),
            }
        };
        self.straining().map(of).collect()
    }

    /// Adds what affine blocks get within `dt` (s) by outer forces, stress and rotation.
    pub(super) fn add_gains_of_straining(
        &self,
        bodies: &Bodies,
        gains: &mut BodyVelocities,
        dt: f64,
    ) {
        for (b, k) in self.straining().filter(|&(b, _)| self.is_driven(b)) {
            let Some(affine) = self.affine(k) else {
                continue;
            };
            let given = self.impulse_without_contacts(b, dt);
            let mut stretch = self.state.outside_stretch[k];
            if let Some(attached) = self.state.attachments.stretch.get(k) {
                stretch += attached * dt;
            }
            let torque = given.torque;
            let outer = Moment { torque, stretch }.matrix();
            let compliance = &bodies.straining()[k].compliance;
            let change = affine.free_change(compliance, (&torque, &outer), dt);
            let velocity = bodies.rigid()[b].of_centroid() * given.force;
            gains.add((b, k), (&velocity, &change));
        }
    }

    /// Kick of the affine block `b`, the `k`-th deformable one.
    pub(super) fn kick_straining(
        &mut self,
        (b, k): (usize, usize),
        gains: &BodyVelocities,
        given: &BodyVelocities,
        dt: f64,
    ) {
        let change = gains.gradient(b, k) + given.gradient(b, k);
        if let Some(affine) = self.affine_mut(b) {
            let lost = affine.kick_by(&change, dt);
            self.state.totals.strain_damping.book(lost);
        }
        if self.hold_of(b).is_none() {
            self.state.velocity[b] += gains.rigid[b][0] + given.rigid[b][0];
            return;
        }
        let mut impulse = self.impulse_without_contacts(b, dt);
        impulse += self.state.contact_load[b].times(dt);
        let before = self.accounted_momentum(b);
        self.state.velocity[b] += impulse.force / self.constants.mass[b];
        self.hold_velocities(b);
        // the hold has no torque
        impulse.torque = Vec3::zeros();
        self.account_restraint(b, before, &impulse);
    }

    /// Turns an affine block where it is; its angular momentum stays.
    pub(super) fn turn_straining(&mut self, b: usize, turn: &UnitQuaternion<f64>) {
        if let Some(affine) = self.affine_mut(b) {
            affine.body.turn(turn);
        }
    }
}
