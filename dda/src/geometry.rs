//! Polyhedra and surfaces: topology, measures, cuts and distances.

pub(crate) mod block_quality;
pub(crate) mod bounds;
pub(crate) mod clip;
pub(crate) mod cut;
pub(crate) mod distance;
pub(crate) mod mass_properties;
pub(crate) mod parts;
pub(crate) mod passage;
pub(crate) mod polyhedron;
pub(crate) mod quadrature;
pub(crate) mod shape;
pub(crate) mod surface;
