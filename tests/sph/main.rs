//! The fluid solver against closed forms and conservation laws.
#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test may stop and tell where a library may not"
)]

mod bulk;
mod conservation;
mod crowding;
mod drops;
mod flow;
mod invariants;
mod mud;
mod parts;
mod stepping;
mod support;
mod surface;
mod symmetry;
mod twin;
mod viscous_step;
mod wall_law;
mod walls;
mod water;
mod waves;
