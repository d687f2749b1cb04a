//! Candidate pairs of parts with their contact history.

use crate::contact::penalty::polyhedra::Pair;
use crate::contact::penalty::spheres::{
    PairRates, Rolling, SphereContact, SphereLoads, SphereMark, SpherePair,
};
use crate::contact::penalty::terrain::SurfacePair;
use serde::{Deserialize, Serialize};

/// Pairs whose fat boxes overlap, sorted by parts, with the history of their contact. Saved in a checkpoint.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Contacts {
    /// Pairs of polyhedra.
    pub pairs: Vec<Pair>,
    /// Pairs with at least one sphere, without surfaces.
    pub sphere_pairs: Vec<SpherePair>,
    /// Whether they touch; one per sphere pair, as the columns that follow.
    pub sphere_marks: Vec<SphereMark>,
    /// Overlap, shear and slip.
    pub sphere_contacts: Vec<SphereContact>,
    /// Force and its point; N, m.
    pub sphere_loads: Vec<SphereLoads>,
    /// Share in the step bound of either block.
    pub sphere_rates: Vec<PairRates>,
    /// Rolling resistance; empty if no joint resists rolling.
    pub sphere_rolling: Vec<Rolling>,
    /// Pairs of a body and a surface, the body first.
    pub surface_pairs: Vec<SurfacePair>,
}

impl Contacts {
    /// Drops all pairs of a block.
    pub fn remove_block(&mut self, block: u32) {
        let stays = |blocks: (u32, u32)| blocks.0 != block && blocks.1 != block;
        self.pairs.retain(|pair| stays(pair.blocks));
        self.surface_pairs.retain(|pair| stays(pair.blocks));
        fn keep<T>(column: &mut Vec<T>, stays: &[bool]) {
            let mut stays = stays.iter();
            column.retain(|_| stays.next().is_none_or(|&stays| stays));
        }
        let left: Vec<bool> = self.sphere_pairs.iter().map(|p| stays(p.blocks)).collect();
        keep(&mut self.sphere_pairs, &left);
        keep(&mut self.sphere_marks, &left);
        keep(&mut self.sphere_contacts, &left);
        keep(&mut self.sphere_loads, &left);
        keep(&mut self.sphere_rates, &left);
        keep(&mut self.sphere_rolling, &left);
    }

    /// Exchanges the columns of sphere pairs.
    pub fn swap_spheres(&mut self, other: &mut Self) {
        std::mem::swap(&mut self.sphere_pairs, &mut other.sphere_pairs);
        std::mem::swap(&mut self.sphere_marks, &mut other.sphere_marks);
        std::mem::swap(&mut self.sphere_contacts, &mut other.sphere_contacts);
        std::mem::swap(&mut self.sphere_loads, &mut other.sphere_loads);
        std::mem::swap(&mut self.sphere_rates, &mut other.sphere_rates);
        std::mem::swap(&mut self.sphere_rolling, &mut other.sphere_rolling);
    }

    /// Blocks and parts of every pair.
    pub fn all_pairs(&self) -> impl Iterator<Item = ((u32, u32), (u32, u32))> + '_ {
        let of_polyhedra = self.pairs.iter().map(|p| (p.blocks, p.parts));
        let of_spheres = self.sphere_pairs.iter().map(|p| (p.blocks, p.parts));
        let of_surfaces = self.surface_pairs.iter().map(|p| (p.blocks, p.parts));
        of_polyhedra.chain(of_spheres).chain(of_surfaces)
    }

    /// Whether all columns of the sphere pairs have one length.
    pub fn are_columns_equal(&self, has_rolling: bool) -> bool {
        let n = self.sphere_pairs.len();
        self.sphere_marks.len() == n
            && self.sphere_contacts.len() == n
            && self.sphere_loads.len() == n
            && self.sphere_rates.len() == n
            && self.sphere_rolling.len() == if has_rolling { n } else { 0 }
    }
}
