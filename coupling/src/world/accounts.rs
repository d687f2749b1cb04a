//! Accounts of chosen blocks: impulses of the fluid by source.

use riprap_dda::Load;
use serde::{Deserialize, Serialize};

use crate::joints::JointWater;
use crate::walls::penalty::Interface;

/// Impulses of the fluid on a block since accounts of it are kept, moments about its centroid; N s, N m s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FluidImpulses {
    /// Of pressure.
    pub pressure: Load,
    /// Of viscosity.
    pub shear: Load,
    /// Of water in joints too narrow for particles.
    pub joint_water: Load,
    /// By particles that were pushed back.
    pub pushed_back: Load,
}

impl FluidImpulses {
    /// Books the present forces on a block over `dt` (s).
    pub(super) fn book(
        &mut self,
        block: usize,
        interface: &Interface,
        joints: &JointWater,
        dt: f64,
    ) {
        let (all, shear) = (interface.loads()[block], interface.shears()[block]);
        let joint = interface.in_plane(joints.loads()[block]);
        let pressure = Load {
            force: all.force - shear.force - joint.force,
            torque: all.torque - shear.torque - joint.torque,
        };
        self.pressure += pressure.times(dt);
        self.shear += shear.times(dt);
        self.joint_water += joint.times(dt);
    }
}
