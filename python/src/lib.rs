//! The Python module `riprap._riprap`: scenes, worlds and tables of riprap.
//!
//! ```text
//!  Scene ─world→ World ─ask→ Engine, in a thread of its own, which holds the run of riprap
//!          run↗          ←─ copies: columns as numpy arrays, gauges, loads, accounts
//! ```
//!
//! The thread of Python waits without holding its global lock and looks for signals while it does. What it takes from
//! the engine is a copy: particles are sorted by place as they move.

mod blocks;
mod command;
mod engine;
mod errors;
mod gauges;
mod scene;
mod tables;
mod value;
mod wait;
mod water;
mod world;

use pyo3::prelude::*;

/// Scenes, worlds and tables of riprap.
#[pymodule]
mod _riprap {
    #[pymodule_export]
    use crate::blocks::{Block, Blocks};
    #[pymodule_export]
    use crate::command::command;
    #[pymodule_export]
    use crate::gauges::Gauges;
    #[pymodule_export]
    use crate::scene::Scene;
    #[pymodule_export]
    use crate::tables::{check_study, compare_files, read_table};
    #[pymodule_export]
    use crate::water::Water;
    #[pymodule_export]
    use crate::world::World;

    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
