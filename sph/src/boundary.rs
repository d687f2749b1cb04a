//! Walls: particles inside them, where these stand, and exact kernel integrals over polyhedra.

pub mod integral;
pub mod sampling;
pub mod screens;
pub mod wall_integrals;
pub mod wall_particles;

#[cfg(test)]
mod solids;
