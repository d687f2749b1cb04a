//! Sweeps: one scene run many times with inputs from a design, and what the runs say together.
//!
//! ```text
//! SWEEP.ron ─load→ Sweep: rows, each its inputs and overrides ─plan→ scene, key, memory
//!                                  ─run→ RUNS/key/ ... ended.json   by this program, a cluster or anything that starts rows
//!                                  ─collect→ collected.csv, exceedance.csv, sensitivity.csv, sweep.svg, sweep.html
//! ```
//! A row is known by its number and its run by a key: a hash of the scene with every default written out, the files that it
//! names, and the program's commit. Whoever starts a row, its run is made once: a row that has ended is not repeated, one
//! that was stopped goes on from its checkpoint, and one that another process is at is waited for.

pub mod collected;
pub mod design;
pub mod emit;
pub mod file;
pub mod page;
pub mod plan;
pub mod plot;
pub mod row;
pub mod statistics;
