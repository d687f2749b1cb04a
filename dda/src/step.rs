//! A step of the blocks: integrators, a file each, and the sums of forces, damping, sleep and accounts that they share.

pub(crate) mod accounts;
pub(crate) mod advance;
pub(crate) mod attachments;
pub(crate) mod central_difference;
pub(crate) mod damping;
mod eigenvalues;
pub(crate) mod guards;
pub(crate) mod impulses;
pub(crate) mod mid_step;
pub(crate) mod phase;
pub(crate) mod sleep;
mod springs;
pub(crate) mod stability;
pub(crate) mod step_bound;
pub(crate) mod sums;
