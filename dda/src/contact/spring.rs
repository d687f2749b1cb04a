//! Springs and dashpots of a contact at a point, as the stability of the step sees them.

use crate::Vec3;

/// Interaction of two blocks at a point.
pub(crate) struct Spring {
    pub blocks: [usize; 2],
    /// World; m.
    pub point: Vec3,
    /// Unit.
    pub normal: Vec3,
    /// Along the normal and across it; N/m.
    pub stiffness: [f64; 2],
    /// Dashpot coefficients; N s/m.
    pub dashpot: [f64; 2],
}
