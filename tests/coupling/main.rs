//! Tests of the coupled engine: scenes, files, the program, and both media together.
//!
//! One program, so that everything is linked once: `cargo test --release --test coupling landslide::` runs one module.
#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test stops at the first fault, and prints measured values beside their bounds"
)]

#[path = "../support/mod.rs"]
mod support;

mod absorbing_pistons;
mod amounts;
mod barriers;
mod block_forces;
mod block_scenes;
mod block_table;
mod boundaries;
mod budget;
mod check_json;
mod checkpoints;
mod compare;
mod contact_dynamics;
mod evidence;
mod extremes;
mod files;
mod floating;
mod frame_kinds;
mod geometry;
mod grains_in_water;
mod guide;
mod handoff;
mod hostile;
mod in_memory;
mod inspect;
mod landslide;
mod languages;
mod mach;
mod messages;
mod mistakes;
mod names;
mod new;
mod overview;
mod paraview;
mod paths;
mod program;
mod random_scenes;
mod records;
mod render;
mod report;
mod rest;
mod rockfall;
mod run_json;
mod scene_docs;
mod schema;
mod serve;
mod settling;
mod sleep;
mod starts;
mod stepping;
mod sweep;
mod symmetry;
mod trade;
mod viscous_step;
mod wall_limit;
mod walls;
mod wave_makers;
mod wings;
