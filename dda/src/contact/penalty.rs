//! Penalty contact: springs with Mohr-Coulomb strength, for polyhedra, spheres and terrain.

pub(crate) mod friction;
pub(crate) mod polyhedra;
pub(crate) mod spheres;
pub(crate) mod terrain;
