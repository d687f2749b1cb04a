//! Neighbor search: cells, packed points, lists, sweeps over cells, and mirror images across planes of symmetry.

pub mod cells;
pub(crate) mod chords;
pub(crate) mod lists;
pub mod mirror;
pub(crate) mod points;
pub(crate) mod rest;
pub(crate) mod sweep;
pub mod thin_solids;
