//! Contact points: as reported, and as remembered from step to step.

use crate::contact::detection::manifold::ManifoldPoint;
use crate::{BlockId, PartId, Vec3};
use serde::{Deserialize, Serialize};

/// Is the contact open, held by friction, or slipping?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ContactState {
    /// No force.
    Open,
    /// The shear spring holds.
    Stick,
    /// The shear force is at Coulomb's limit.
    Slide,
}

/// One contact point, as reported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The two blocks, i and j.
    pub blocks: (BlockId, BlockId),
    /// The two parts, i and j.
    pub parts: (PartId, PartId),
    /// Names the point among those of its pair of parts.
    pub key: u32,
    /// World; m.
    pub point: Vec3,
    /// Unit, from i to j.
    pub normal: Vec3,
    /// Force on j along the normal, ≥ 0 unless bonded; N.
    pub normal_force: f64,
    /// Force on j across the normal; N.
    pub shear_force: Vec3,
    /// Overlap at the point; m.
    pub overlap: f64,
    /// State of the contact.
    pub state: ContactState,
}

/// History of a contact point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PointState {
    pub at: ManifoldPoint,
    /// Normal force on B, with its viscous part; N.
    pub normal_force: f64,
    pub normal_viscous: f64,
    /// Shear force on B, with its viscous part; N.
    pub shear_force: Vec3,
    pub shear_viscous: Vec3,
    pub state: ContactState,
}
