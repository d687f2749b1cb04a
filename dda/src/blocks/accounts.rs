//! Impulses on chosen blocks by source, summed over the steps.

use crate::{Load, Vec3};
use serde::{Deserialize, Serialize};

/// Impulses on a block since it was chosen, by source, with moments about its centroid; N s, N m s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Impulses {
    /// Of contacts.
    pub contact: Load,
    /// Of loads, supports, bolts and joints.
    pub attached: Load,
    /// Of constraints and static damping.
    pub restrained: Load,
    /// Of gravity.
    pub gravity: Vec3,
}

/// Chosen blocks and the impulses on them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Accounts {
    /// The blocks, ascending.
    pub blocks: Vec<u32>,
    /// Impulses on each of them.
    pub rows: Vec<Impulses>,
}
