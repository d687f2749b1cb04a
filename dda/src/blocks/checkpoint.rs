//! Checkpoint of the blocks: the state as bytes, read back into a system built from the same definitions.

use super::Blocks;
use crate::contact::penalty::polyhedra::Workspace;
use crate::contact::tally::PAIR_CHUNK;
use postcard::Error;

impl Blocks {
    /// Appends the state and the contact history to some bytes.
    ///
    /// # Errors
    ///
    /// None is expected: the format accepts any blocks.
    pub fn save(&self, out: Vec<u8>) -> Result<Vec<u8>, Error> {
        // no `..`: a new group cannot be forgotten
        let Self {
            state,
            contacts,
            derived: _,
            scratch: _,
            constants: _,
        } = self;
        postcard::to_extend(&(state, contacts), out)
    }

    /// Reads the state from the front of bytes that [`Self::save`] wrote for blocks of the same definitions; returns
    /// the remaining bytes. The steps that follow are the same to the bit as without.
    ///
    /// # Errors
    ///
    /// The bytes end early, are invalid, or belong to other blocks. The blocks can then not be continued.
    pub fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], Error> {
        let columns = self.lengths();
        let rest;
        ((self.state, self.contacts), rest) = postcard::take_from_bytes(bytes)?;
        let is_whole = self.contacts.are_columns_equal(self.constants.has_rolling);
        if self.lengths() != columns || !is_whole || !self.are_pairs_known() {
            return Err(Error::DeserializeBadEncoding);
        }
        self.derive_from_state();
        Ok(rest)
    }

    /// Rebuilds the data derived from the state.
    fn derive_from_state(&mut self) {
        // positions follow from the state, as in the step; boxes and velocities may be older
        let (kinematics, boxes) = (self.state.kinematics.clone(), self.state.boxes.clone());
        self.sort_by_update();
        self.mark_movable_parts();
        self.place_parts(true);
        (self.state.kinematics, self.state.boxes) = (kinematics, boxes);
        self.link_pairs();
        let n_chunks = self.contacts.pairs.len().div_ceil(PAIR_CHUNK);
        if self.scratch.workspaces.len() < n_chunks {
            self.scratch
                .workspaces
                .resize_with(n_chunks, Workspace::default);
        }
    }

    /// Lengths of the columns that never change theirs.
    fn lengths(&self) -> [usize; 19] {
        let state = &self.state;
        [
            state.centroid.len(),
            state.velocity.len(),
            state.attitude.len(),
            state.angular_momentum.len(),
            state.is_removed.len(),
            state.deformables.len(),
            state.outside_stretch.len(),
            state.attachments.joints.len(),
            state.attachments.loads.len(),
            state.attachments.stretch.len(),
            state.joints.len(),
            state.kinematics.len(),
            state.contact_load.len(),
            state.contact_load_before.len(),
            state.travel.len(),
            state.contact_stretch.len(),
            state.rates.len(),
            state.boxes.len(),
            state.fat_boxes.len(),
        ]
    }

    /// Whether all pairs are of parts of these blocks.
    fn are_pairs_known(&self) -> bool {
        let block_of = |part: u32| self.constants.block_of_part.get(part as usize);
        self.contacts.all_pairs().all(|(blocks, parts)| {
            block_of(parts.0) == Some(&blocks.0) && block_of(parts.1) == Some(&blocks.1)
        })
    }
}
