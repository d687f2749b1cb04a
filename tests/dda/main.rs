//! Validation of the block solver: exact answers, conservation, determinism, twins.
//!
//! Every number has a derivation or a measured value beside it.
#![expect(clippy::unwrap_used, clippy::panic, reason = "a test may fail")]
#![expect(
    clippy::print_stdout,
    reason = "residuals are printed beside their limits"
)]

mod bonds;
mod conservation;
mod constraints;
mod contact;
mod contact_dynamics;
mod deformable;
mod determinism;
mod exact_joints;
mod geometry;
mod joint_springs;
mod joints;
mod mid_step;
mod mid_step_deformable;
mod mid_step_laws;
mod mid_step_spanning;
mod mid_step_surroundings;
mod motion;
mod paths;
mod rest;
mod rocking;
mod scenes;

mod setup;
mod shear_damping;
mod slopes;
mod spheres;
mod step_bound;
mod structures;
mod terrain;
