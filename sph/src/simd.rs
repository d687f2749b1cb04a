//! Vector registers and what they hold: the choice of machine, records of particles, packed points.

pub(crate) mod lanes;
pub(crate) mod points;
