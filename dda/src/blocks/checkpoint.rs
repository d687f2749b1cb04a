//! The state as bytes: saved in a run, read back into the same system of blocks built anew.

use super::Blocks;
use crate::contact::penalty::polyhedra::Workspace;
use crate::step::sums::PAIR_CHUNK;
use postcard::Error;

/// Writes and reads the bytes of some columns. All are named, so that a new one cannot be forgotten: those that change
/// in a run, and those that never do or follow from them.
macro_rules! saved {
    ({ $($kept:ident),* $(,)? } not { $($other:ident),* $(,)? }) => {
        impl Blocks {
            fn save_columns(&self, out: Vec<u8>) -> Result<Vec<u8>, Error> {
                let Self { $($kept,)* $($other: _,)* } = self;
                $(let out = postcard::to_extend($kept, out)?;)*
                Ok(out)
            }

            fn read_columns<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], Error> {
                $(let (column, bytes) = postcard::take_from_bytes(bytes)?;
                self.$kept = column;)*
                Ok(bytes)
            }
        }
    };
}

saved!({
    centroid,
    velocity,
    attitude,
    angular_momentum,
    is_removed,
    deformables,
    attachments,
    pairs,
    sphere_pairs,
    sphere_marks,
    sphere_contacts,
    sphere_loads,
    sphere_rates,
    sphere_rolling,
    surface_pairs,
    friction,
    damping,
    strain_damping,
    static_damping,
    laid_to_rest,
    rest,
    external_work,
    support_impulse,
    impulse_exchanged,
    rolling_impulse,
    n_contact_updates,
    n_broken_bonds,
    n_axis_searches,
    max_overlap_over_size,
    kinematics,
    contact_load,
    contact_load_before,
    accounts,
    rates,
    worst_overlap,
    contact_stretch,
    boxes,
    fat_boxes,
    can_move,
} not {
    parts,
    candidates,
    pairs_before,
    workspaces,
    surface_pairs_before,
    sphere_pairs_before,
    links,
    sphere_links,
    surface_links,
    has_new_links,
    has_excess,
    motion,
    role,
    special,
    deformable_of,
    holds,
    mass,
    volume,
    inertia,
    principal,
    initial_centroid,
    radius,
    part_start,
    block_of_part,
    material_of_part,
    reference,
    margin,
    deepest_allowed,
    size,
    has_rolling,
    least_margin,
    lever,
    joints,
    joints_at_start,
    n_materials,
    settings,
});

impl Blocks {
    /// Appends the state to some bytes.
    ///
    /// # Errors
    ///
    /// None that is known: the format takes whatever blocks are made of.
    pub fn save(&self, out: Vec<u8>) -> Result<Vec<u8>, Error> {
        self.save_columns(out)
    }

    /// Takes the state over from the front of bytes that [`Self::save`] wrote for blocks of the same definitions; returns
    /// the rest. What follows is the same to the bit as without.
    ///
    /// # Errors
    ///
    /// The bytes end early, mean nothing, or are of other blocks. The blocks are then in no state to go on.
    pub fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], Error> {
        let columns = self.lengths();
        let rest = self.read_columns(bytes)?;
        if self.lengths() != columns || !self.are_pairs_whole() {
            return Err(Error::DeserializeBadEncoding);
        }
        // places follow from the state, as they did in the step; boxes and velocities may be older than they
        let (kinematics, boxes) = (self.kinematics.clone(), self.boxes.clone());
        self.note_roles();
        self.place_parts(true);
        (self.kinematics, self.boxes) = (kinematics, boxes);
        self.link_pairs();
        let n_chunks = self.pairs.len().div_ceil(PAIR_CHUNK);
        if self.workspaces.len() < n_chunks {
            self.workspaces.resize_with(n_chunks, Workspace::default);
        }
        Ok(rest)
    }

    /// Lengths of the columns that never change theirs.
    fn lengths(&self) -> [usize; 16] {
        [
            self.centroid.len(),
            self.velocity.len(),
            self.attitude.len(),
            self.angular_momentum.len(),
            self.is_removed.len(),
            self.deformables.len(),
            self.attachments.loads.len(),
            self.attachments.stretch.len(),
            self.kinematics.len(),
            self.contact_load.len(),
            self.contact_load_before.len(),
            self.rates.len(),
            self.contact_stretch.len(),
            self.boxes.len(),
            self.fat_boxes.len(),
            self.can_move.len(),
        ]
    }

    /// Whether all pairs are of parts that there are, and the columns of those with a ball are of one length.
    fn are_pairs_whole(&self) -> bool {
        let is_known = |parts: (u32, u32), blocks: (u32, u32)| {
            let of = |part: u32| self.block_of_part.get(part as usize);
            of(parts.0) == Some(&blocks.0) && of(parts.1) == Some(&blocks.1)
        };
        let n = self.sphere_pairs.len();
        self.pairs.iter().all(|p| is_known(p.parts, p.blocks))
            && self
                .sphere_pairs
                .iter()
                .all(|p| is_known(p.parts, p.blocks))
            && self
                .surface_pairs
                .iter()
                .all(|p| is_known(p.parts, p.blocks))
            && [
                self.sphere_marks.len(),
                self.sphere_contacts.len(),
                self.sphere_loads.len(),
                self.sphere_rates.len(),
            ]
            .iter()
            .all(|&length| length == n)
            && self.sphere_rolling.len() == if self.has_rolling { n } else { 0 }
    }
}
