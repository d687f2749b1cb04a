//! Two bodies that may touch, and the law between them.

use super::friction::Shearing;
use super::normal::Pressing;
use super::step_bound::Springs;
use crate::contact::context::ContactContext;
use crate::contact::detection::manifold::Manifold;
use crate::contact::report::PointState;
use crate::material::Joint;
use crate::motion::kinematics::Kinematics;

/// Two bodies, the joint between them, and the step.
#[derive(Clone, Copy)]
pub(super) struct PairLaw<'a> {
    /// i and j.
    pub bodies: (&'a Kinematics, &'a Kinematics),
    pub joint: &'a Joint,
    /// s.
    pub dt: f64,
}

impl<'a> PairLaw<'a> {
    pub fn of(
        context: &ContactContext<'a>,
        parts: (u32, u32),
        blocks: (u32, u32),
        dt: f64,
    ) -> Self {
        let body = |block: u32| &context.kinematics[block as usize];
        Self {
            bodies: (body(blocks.0), body(blocks.1)),
            joint: context.joint_of(parts),
            dt,
        }
    }

    pub fn pressing(&self) -> Pressing<'a> {
        Pressing {
            bodies: self.bodies,
            stiffness: self.joint.normal_stiffness,
            damping_ratio: self.joint.damping_ratio,
        }
    }

    /// Friction of a patch, the residual one once it has slipped; without cohesion or bond.
    pub fn shearing<P>(&self, patch: &Manifold<P>, has_slipped: bool) -> Shearing<'a> {
        Shearing {
            bodies: self.bodies,
            normal: patch.normal,
            weight: patch.flat_weight,
            stiffness: self.joint.shear_stiffness,
            damping_ratio: self.joint.shear_damping_ratio,
            friction: if has_slipped {
                self.joint.residual_friction
            } else {
                self.joint.friction
            },
            cohesion: 0.0,
            is_bonded: false,
            dt: self.dt,
        }
    }

    /// Springs of a contact of some weight, between bodies of a sum of inverse masses (1/kg).
    pub fn springs(&self, weight: f64, mobility: f64) -> Springs {
        Springs {
            stiffness: (
                self.joint.normal_stiffness * weight,
                self.joint.shear_stiffness * weight,
            ),
            damping_ratio: (self.joint.damping_ratio, self.joint.shear_damping_ratio),
            mobility,
        }
    }

    /// Energy of the normal springs of some points; J.
    pub fn held(&self, points: &[PointState]) -> f64 {
        let squares: f64 = points
            .iter()
            .map(|p| p.at.weight * p.at.overlap * p.at.overlap)
            .sum();
        0.5 * self.joint.normal_stiffness * squares
    }
}
