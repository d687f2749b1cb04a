//! Sorting of the blocks by their equation of motion.

use super::{Blocks, Update};
use crate::{Motion, StaticDamping};

impl Blocks {
    /// Sorts the blocks by their update.
    pub(crate) fn sort_by_update(&mut self) {
        self.derived.update = (0..self.n_blocks()).map(|b| self.update_of(b)).collect();
        let constrained = |&b: &usize| self.derived.update[b] == Update::Constrained;
        self.derived.constrained = (0..self.n_blocks())
            .filter(constrained)
            .map(|b| b as u32)
            .collect();
    }

    /// Marks the parts of blocks that are neither fixed nor removed.
    pub(super) fn mark_movable_parts(&mut self) {
        let can_move = |&block: &u32| {
            let b = block as usize;
            !matches!(self.constants.motion[b], Motion::Fixed) && !self.state.is_removed[b]
        };
        self.derived.can_move = self.constants.block_of_part.iter().map(can_move).collect();
    }

    fn update_of(&self, b: usize) -> Update {
        let is_damped = matches!(
            self.constants.settings.static_damping,
            Some(StaticDamping::Local(_))
        );
        if !self.is_free(b) {
            Update::Fixed
        } else if is_damped || self.is_deformable(b) || self.hold_of(b).is_some() {
            Update::Constrained
        } else if self.state.rest.has(b) {
            Update::Asleep
        } else {
            Update::Rigid
        }
    }
}
