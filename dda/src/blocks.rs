//! The state of all blocks, struct of arrays; `build` constructs it, `query` reads it.

pub(crate) mod accounts;
pub(crate) mod attachments;
mod balance;
mod body;
mod bonds;
mod build;
mod checkpoint;
mod constants;
mod contacts;
mod definition;
mod derived;
pub(crate) mod energy;
pub(crate) mod links;
mod outline;
mod overlap;
mod pairing;
mod placement;
mod query;
mod rest;
mod scratch;
mod settling;
mod spanned;
mod state;
mod state_numbers;
pub(crate) mod steered;
mod strength;
mod totals;
mod update;

use crate::contact::dynamics::kept::KeptBond;
use crate::contact::rates::KeptBound;
use crate::geometry::bounds::Bounds;
use crate::material::Joint;
pub(crate) use crate::motion::update::Update;
use crate::{Attachment, BlockError, Hold, Load, Turning, Vec3};
use attachments::Bodies;
pub(crate) use constants::Constants;
pub(crate) use contacts::Contacts;
pub use definition::{
    BlockDefinition, ContactDynamics, Integrator, Resting, Settings, StaticDamping,
};
pub(crate) use derived::Derived;
pub(crate) use rest::Rest;
use scratch::Scratch;
pub(crate) use spanned::Spanned;
pub(crate) use state::State;

/// A system of blocks.
///
/// Columns are one per block unless noted.
#[derive(Clone, Debug)]
pub struct Blocks {
    pub(crate) state: State,
    pub(crate) contacts: Contacts,
    pub(crate) derived: Derived,
    pub(crate) scratch: Scratch,
    pub(crate) constants: Constants,
}

/// Number of blocks, or pairs of spheres, of a unit of parallel work.
pub(crate) const CHUNK: usize = 512;

impl Blocks {
    fn empty(joints: Vec<Joint>, n_materials: usize, settings: Settings) -> Self {
        Self {
            state: State {
                joints: joints.clone(),
                ..State::default()
            },
            contacts: Contacts::default(),
            derived: Derived {
                has_new_links: true,
                ..Derived::default()
            },
            scratch: Scratch::default(),
            constants: Constants {
                part_start: vec![0],
                has_rolling: joints.iter().any(|j| j.spheres.rolling_friction > 0.0),
                initial_joints: joints,
                n_materials,
                settings,
                ..Constants::default()
            },
        }
    }

    pub(crate) fn hold_of(&self, block: usize) -> Option<&Hold> {
        self.constants.holds.get(block).and_then(Option::as_ref)
    }

    /// Holds a free, rigid block in some directions, or its rotation, from now on.
    ///
    /// # Errors
    ///
    /// [`BlockError::Hold`] if the block does not exist, is not free and rigid, or the hold is unusable.
    pub fn hold(&mut self, block: usize, hold: Hold) -> Result<(), BlockError> {
        if block >= self.n_blocks() || !self.is_free(block) {
            return Err(BlockError::Hold {
                block,
                reason: "it is not a free block",
            });
        }
        if self.constants.deformable_of[block].is_some() && hold.turning != Turning::Free {
            return Err(BlockError::Hold {
                block,
                reason: "the turning of a deformable block cannot be held",
            });
        }
        hold.check(block)?;
        let n = self.n_blocks();
        self.constants.holds.resize(n, None);
        let held = hold.held_part(&self.state.velocity[block]);
        self.state.velocity[block] -= held;
        let (attitude, inertia) = (self.state.attitude[block], self.constants.inertia[block]);
        hold.hold_turning(&attitude, &inertia, &mut self.state.angular_momentum[block]);
        self.constants.holds[block] = Some(hold);
        self.sort_by_update();
        self.set_kinematics(block);
        Ok(())
    }

    /// Attaches loads, supports, bolts and joints, at t = 0.
    ///
    /// # Errors
    ///
    /// [`BlockError::Attachment`] names the first that is unusable.
    pub fn attach(&mut self, attachments: &[Attachment]) -> Result<(), BlockError> {
        let bodies = Bodies {
            centroid: &self.state.centroid,
            mass: &self.constants.mass,
            part_start: &self.constants.part_start,
            parts: &self.derived.parts,
            motion: &self.constants.motion,
            integrator: &self.constants.settings.integrator,
        };
        for (number, attachment) in attachments.iter().enumerate() {
            self.state.attachments.push(attachment, number, &bodies)?;
        }
        self.evaluate_attachments(true);
        self.state.bound = KeptBound::default();
        Ok(())
    }

    /// Removes a block: it no longer moves, collides or counts in sums.
    pub fn remove(&mut self, b: usize) {
        if self.state.is_removed[b] {
            return;
        }
        self.state.is_removed[b] = true;
        self.state.rest.leave(b);
        for part in self.parts_of(b) {
            self.state.boxes[part] = NOWHERE;
            self.state.fat_boxes[part] = NOWHERE;
        }
        self.sort_by_update();
        self.mark_movable_parts();
        self.contacts.remove_block(b as u32);
        let is_left = |(first, second): (u32, u32)| first as usize != b && second as usize != b;
        self.state.impulses.retain(|kept| is_left(kept.blocks));
        let stays = |bond: &KeptBond| bond.blocks.0 != b as u32 && bond.blocks.1 != b as u32;
        self.state.bonds.retain(stays);
        self.link_pairs();
        self.state.contact_load[b] = Load::default();
        self.state.velocity[b] = Vec3::zeros();
        self.state.angular_momentum[b] = Vec3::zeros();
        self.set_kinematics(b);
        self.sum_loads();
        self.state.bound = KeptBound::default();
    }
}

/// A box that overlaps nothing.
const NOWHERE: Bounds = (
    Vec3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
    Vec3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
);
