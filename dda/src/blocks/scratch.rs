//! Buffers of the blocks' step, kept between steps for their memory.

use super::pairing::SpherePairBefore;
use crate::contact::penalty::polyhedra::{Pair, Workspace};
use crate::contact::penalty::terrain::SurfacePair;

/// Buffers that are never read before they are written.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    /// Pairs of parts whose fat boxes overlap.
    pub candidates: Vec<(u32, u32)>,
    /// Pairs before the list was rebuilt.
    pub pairs_before: Vec<Pair>,
    /// Sphere pairs of the previous step.
    pub sphere_pairs_before: Vec<SpherePairBefore>,
    /// Surface pairs of the previous step.
    pub surface_pairs_before: Vec<SurfacePair>,
    /// One per chunk of `pairs`, or more.
    pub workspaces: Vec<Workspace>,
}
