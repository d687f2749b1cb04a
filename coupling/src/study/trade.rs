//! Studies of error against cost.
//!
//! ```text
//! STUDY.ron ─load→ Study: runs, each a scene and a key ─execute→ RUNS/key/ ... ended.json
//!                                                      ─collect→ value, error and cost of each
//!                                                               trade.csv, front.csv, trade.svg, trade.png
//! trade.csv ─choose→ the cheapest settings within a budget       where there is no study: refinement, three coarse runs
//! ```
//! A study names a case, a quantity with its reference value, and parameters (knobs) with their values. Runs are
//! single-threaded processes, as many at once as cores and memory allow; completed runs are never repeated, so that an
//! interrupted study continues. A run is identified by its scene with every default written out, the files it names, and
//! the program's commit.

pub mod budget;
pub mod execute;
pub mod file;
pub mod front;
pub mod outcome;
pub mod picture;
pub mod plan;
pub mod plot;
pub mod quantity;
pub mod reading;
pub mod refinement;
pub mod results;
pub mod search;
