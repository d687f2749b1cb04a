//! Numbers of particles as types of their own, so that they cannot be mixed with others.

use std::fmt::{self, Display, Formatter};

use serde::{Deserialize, Serialize};

/// Number of a particle, which it keeps when particles are sorted.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct ParticleId(u32);

impl ParticleId {
    /// Index into what is listed in the order of the numbers.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl From<u32> for ParticleId {
    fn from(number: u32) -> Self {
        Self(number)
    }
}

impl From<ParticleId> for u32 {
    fn from(id: ParticleId) -> Self {
        id.0
    }
}

impl Display for ParticleId {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        self.0.fmt(f)
    }
}
