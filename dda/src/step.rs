//! A step of the blocks: the integrator, sums of forces, damping, sleep and accounts.

pub(crate) mod accounts;
pub(crate) mod attachments;
pub(crate) mod central_difference;
pub(crate) mod damping;
pub(crate) mod phase;
pub(crate) mod sleep;
pub(crate) mod stability;
pub(crate) mod step_bound;
pub(crate) mod sums;
