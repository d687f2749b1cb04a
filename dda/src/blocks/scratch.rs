//! Buffers of the blocks' step, kept between steps for their memory.

use super::Contacts;
use crate::contact::penalty::polyhedra::{Pair, Workspace};
use crate::contact::penalty::terrain::SurfacePair;

/// Buffers that are never read before they are written.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    /// Pairs of parts whose fat boxes overlap.
    pub candidates: Vec<(u32, u32)>,
    /// Pairs before the list was rebuilt.
    pub pairs_before: Vec<Pair>,
    /// Sphere pairs before the list was rebuilt, and the places that the present ones had in it.
    pub spheres_before: Contacts,
    pub former: Vec<u32>,
    /// Surface pairs of the previous step.
    pub surface_pairs_before: Vec<SurfacePair>,
    /// Margin of the fat box of each part when pairs were last listed; m.
    pub margin: Vec<f64>,
    /// Distance by which each part may come closer to others in this step of contact dynamics, empty of central differences; m.
    pub reach: Vec<f64>,
    /// One per chunk of `pairs`, or more.
    pub workspaces: Vec<Workspace>,
}

impl Scratch {
    /// Reach of a part in this step; m.
    pub fn reach_of(&self, part: usize) -> f64 {
        self.reach.get(part).copied().unwrap_or(0.0)
    }
}
