//! Vector registers: the choice of machine, records of particles, vectors of three registers.

pub(crate) mod lanes;
pub(crate) mod lanes3;
