//! Rock blocks and water in one explicit engine: scene, world, run, observers, files.
//!
//! ```text
//!  cases/x.ron ─parse→ SceneFile ─resolve→ Scene ─build→ World + observers
//!    as written          checked       SI, frozen          │
//!                                                          ▼
//!     ┌────────────────────────────► World { blocks, water, clock }
//!     │  step: the only &mut World        │ observe(&World), each when due
//!     │   1 kick      fluid, blocks       ▼
//!     │   2 drift     fluid; blocks take   runs/x/  case.ron, summary.json, *.csv,
//!     │               sub-steps inside              *.pvd + *.vtp, overview.svg
//!     │   3 walls, neighbors, densities,
//!     │     forces
//!     └── 4 kick, tick
//! ```
//!
//! Invariants: what is read ([`scene::file::SceneFile`]) is never what is computed with
//! ([`scene::resolve::Scene`], [`world::World`]); the solver crates touch no file and no clock;
//! observers look and never change the world; steps never bend to output times; every pair force
//! acts twice with opposite sign; results are the same bits for any number of threads.

mod build_info;
pub mod cli;
pub mod files;
pub mod joints;
pub mod openings;
pub mod output;
pub mod picture;
pub mod run;
mod saved;
pub mod scene;
pub mod series;
pub mod study;
pub mod walls;
pub mod world;

// the paths of 0.1, for one release
pub use files::{table, vtk};
pub use output::{checkpoint_file as checkpoint, observe, summary};
pub use picture::{overview, render};
pub use run::ineffective as notice;
pub use scene::estimate as memory;
pub use study::{compare, trade};
pub use walls::penalty as interface;
pub use world::{ground, ledger, time_step};
