//! Hand-off of the water to solvers of the far field: columns on a raster, with their volume and momentum, numbers that say whether
//! the flow is ready for such a solver, and files that these read.
//!
//! ```text
//! World ─columns→ Columns: volume, momentum, surface, velocities, ground      ─formats→ NetCDF, ESRI, GeoTIFF, FUNWAVE, GeoClaw, SWASH
//!                     └─fitness→ share of kinetic energy, kd, pressure         └─propagator→ linear waves over constant depth
//! ```
//! Volume and momentum of the raster are those of the particles, to round-off.

pub mod columns;
pub mod fitness;
pub mod formats;
mod geoclaw;
pub mod lines;
pub mod netcdf;
pub mod observer;
pub mod package;
pub mod propagator;
pub mod readiness;
mod spectrum;
mod swash;
#[cfg(test)]
mod tests;
