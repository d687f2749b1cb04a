//! State that contact dynamics keeps from step to step.

use crate::contact::bond::Bond;
use crate::contact::report::{Contact, ContactState};
use crate::{BlockId, PartId, Vec3};
use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};

/// Impulse at a point of two parts, from which the next step starts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptImpulse {
    pub parts: (u32, u32),
    pub blocks: (u32, u32),
    /// World; m.
    pub position: Vec3,
    /// Unit, from the first to the second.
    pub normal: Vec3,
    /// Below 0 for overlap; m.
    pub gap: f64,
    /// On the second; N s.
    pub impulse: Vec3,
    /// Of rolling resistance, on the second; N m s.
    pub torque: Vec3,
    /// Of the step; s.
    pub dt: f64,
    pub state: ContactState,
    /// Whether the residual friction holds from now on; without a bond that broke false where it is not lower.
    pub has_slipped: bool,
}

impl KeptImpulse {
    /// The point as reported, with its mean force in the step; `key` names it among those of its parts.
    pub fn contact(&self, key: u32) -> Contact {
        let force = self.impulse / self.dt;
        let normal_force = force.dot(&self.normal);
        Contact {
            blocks: (BlockId::from(self.blocks.0), BlockId::from(self.blocks.1)),
            parts: (PartId::from(self.parts.0), PartId::from(self.parts.1)),
            key,
            point: self.position,
            normal: self.normal,
            normal_force,
            shear_force: force - self.normal * normal_force,
            overlap: -self.gap,
            state: self.state,
        }
    }
}

/// A bond that is rigid until it breaks. Lengths and directions are those of the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptBond {
    pub parts: (u32, u32),
    pub blocks: (u32, u32),
    pub bond: Bond,
    /// Middle of the patch from the centroid of each block, in its principal axes; m.
    pub anchors: [Vec3; 2],
    /// Principal axes of the second in those of the first.
    pub attitude: UnitQuaternion<f64>,
    /// Unit, from the first to the second, in the principal axes of the first.
    pub normal: Vec3,
    /// Corners of the patch from its middle, in the principal axes of the first; m.
    pub outline: Vec<Vec3>,
}

/// Contacts of the last step of contact dynamics, and how far their impulses are from the laws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactSolution {
    /// Points at which parts touched or were near.
    pub n_contacts: usize,
    /// Sweeps and iterations.
    pub n_iterations: usize,
    /// Residual of the laws; –.
    pub residual: f64,
}
