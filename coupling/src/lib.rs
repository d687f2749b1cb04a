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
//!     │   3 walls, neighbours, densities,
//!     │     forces
//!     └── 4 kick, tick
//! ```
//!
//! Invariants: what is read ([`scene::file::SceneFile`]) is never what is computed with
//! ([`scene::resolve::Scene`], [`world::World`]); the solver crates touch no file and no clock;
//! observers look and never change the world; steps never bend to output times; every pair force
//! acts twice with opposite sign; results are the same bits for any number of threads.

pub mod checkpoint;
pub mod cli;
pub mod compare;
pub mod ground;
pub mod interface;
pub mod joints;
pub mod ledger;
pub mod memory;
pub mod notice;
pub mod observe;
pub mod openings;
pub mod overview;
pub mod packing;
mod part_table;
pub mod render;
pub mod run;
pub mod scene;
pub mod summary;
pub mod table;
pub mod time_step;
pub mod trade;
pub mod vtk;
pub mod walls;
pub mod world;
