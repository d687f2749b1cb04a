//! Rock blocks and water in one explicit engine: scene, world, run, observers, files.
//!
//! ```text
//!  cases/x.ron ─parse→ SceneFile ─resolve→ Scene ─build→ World + observers
//!    as written          checked       SI, frozen          │
//!                                                          ▼
//!     ┌────────────────────────────► World { blocks, water, clock }
//!     │  step: the only &mut World        │ observe(&World), each when due
//!     │   1 joints weaken, water sleeps   ▼
//!     │   2 step of the fluid; the         runs/x/  case.ron, summary.json, *.csv,
//!     │     coupler is its boundary:                *.pvd + *.vtp, overview.svg
//!     │     blocks, walls, joints, openings
//!     └── 3 absorbing layers, clock, guards
//! ```
//!
//! Invariants: input ([`scene::file::SceneFile`]) is separate from the data of the computation
//! ([`scene::resolve::Scene`], [`world::World`]); the solver crates access no files and no clock;
//! observers never change the world; steps are never adjusted to output times; every pair force
//! acts twice with opposite sign; results are bitwise identical for any number of threads.

mod build_info;
pub mod cli;
pub mod files;
pub mod grains;
pub mod handoff;
pub mod joints;
pub mod messages;
pub mod openings;
pub mod output;
pub mod picture;
pub mod run;
mod saved;
pub mod scene;
pub mod series;
pub mod study;
pub mod walls;
pub mod waves;
pub mod world;

// the paths of 0.1, for one release
pub use files::{table, vtk};
pub use output::{checkpoint_file as checkpoint, observe, summary};
pub use picture::{overview, render, report};
pub use run::ineffective as notice;
pub use scene::estimate as memory;
pub use study::{compare, trade};
pub use walls::penalty as interface;
pub use world::{ground, ledger, time_step};
