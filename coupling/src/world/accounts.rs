//! Accounts of chosen blocks: impulses of the fluid by source.

use riprap_dda::{Blocks, Load, Vec3};
use riprap_sph::Fluid;
use serde::{Deserialize, Serialize};

use crate::joints::JointWater;
use crate::walls::Walls;
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
    /// Sum of all sources.
    pub fn total(&self) -> Load {
        let mut total = self.pressure;
        total += self.shear;
        total += self.joint_water;
        total += self.pushed_back;
        total
    }
}

/// The account of a block.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Account {
    pub block: usize,
    pub impulses: FluidImpulses,
    /// Pressure and viscosity of the fluid on a block that never moves, in walls of particles, at the last evaluation of
    /// forces; N. Those on all others are in the interface.
    pub on_fixed: [Load; 2],
}

impl Account {
    pub(super) fn new(block: usize) -> Self {
        Self {
            block,
            impulses: FluidImpulses::default(),
            on_fixed: [Load::default(); 2],
        }
    }

    /// Books the present forces over `dt` (s).
    pub(super) fn book(&mut self, interface: &Interface, joints: &JointWater, dt: f64) {
        let block = self.block;
        let (all, shear) = (interface.loads()[block], interface.shears()[block]);
        let joint = interface.in_plane(joints.loads()[block]);
        let pressure = Load {
            force: all.force - shear.force - joint.force,
            torque: all.torque - shear.torque - joint.torque,
        };
        let [pressure_on_fixed, shear_on_fixed] =
            self.on_fixed.map(|load| interface.in_plane(load).times(dt));
        let impulses = &mut self.impulses;
        impulses.pressure += pressure.times(dt);
        impulses.pressure += pressure_on_fixed;
        impulses.shear += shear.times(dt);
        impulses.shear += shear_on_fixed;
        impulses.joint_water += joint.times(dt);
    }
}

/// Sets the loads on accounted blocks that never move to those of the last evaluation; NaN where these are unknown.
pub(super) fn look_at_fixed(
    accounts: &mut [Account],
    walls: &mut Walls,
    (fluid, blocks): (&Fluid, &Blocks),
) {
    let mut has_fixed = false;
    for account in accounts.iter_mut() {
        if blocks.is_fixed(account.block) {
            account.on_fixed = [Load::default(); 2];
            has_fixed = true;
        }
    }
    if !has_fixed {
        return;
    }
    let are_known = walls.visit_fixed(fluid, |block, x, forces| {
        if let Ok(k) = accounts.binary_search_by_key(&block, |account| account.block) {
            let arm = x - blocks.centroid(block);
            for (load, force) in accounts[k].on_fixed.iter_mut().zip(&forces) {
                load.add(force, &arm);
            }
        }
    });
    if are_known {
        return;
    }
    for account in accounts {
        if blocks.is_fixed(account.block) {
            account.on_fixed[0] = Load {
                force: Vec3::repeat(f64::NAN),
                torque: Vec3::repeat(f64::NAN),
            };
        }
    }
}
