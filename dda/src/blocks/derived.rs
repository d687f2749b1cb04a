//! Quantities that follow from the state of the blocks.

use super::Update;
use super::links::Links;
use crate::geometry::parts::Part;

/// Data derived from state and constants, rebuilt when a checkpoint is read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Derived {
    /// Geometry in the world; one per part.
    pub parts: Vec<Part>,
    /// Equation of motion in the next step; one per block.
    pub update: Vec<Update>,
    /// Blocks of [`Update::Constrained`], in ascending order.
    pub constrained: Vec<u32>,
    /// False of parts of fixed and removed blocks; one per part.
    pub can_move: Vec<bool>,
    /// Polyhedron pairs of each block.
    pub links: Links,
    /// Sphere pairs of each block.
    pub sphere_links: Links,
    /// Surface pairs of each block.
    pub surface_links: Links,
    /// True until the step bound has been summed over the present links.
    pub has_new_links: bool,
    /// True if a contact began or ended in this step.
    pub has_half_kick_corrections: bool,
}
