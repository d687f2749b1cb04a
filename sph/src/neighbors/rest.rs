//! Particles and chunks at rest, as searches and sums treat them.

use serde::{Deserialize, Serialize};

/// Treatment of a particle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Rest {
    /// Everything.
    #[default]
    Awake,
    /// It sleeps in a tile beside others that may be awake: its density is advanced if awake particles are in its support.
    Beside,
    /// Nothing.
    Asleep,
}

/// Chunks of particles that sleep entirely, without any change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Still<'a>(&'a [bool]);

impl<'a> Still<'a> {
    /// No chunk.
    pub(crate) const NONE: Still<'static> = Still(&[]);

    /// Chunks by their flags.
    pub(crate) fn new(flags: &'a [bool]) -> Self {
        Self(flags)
    }

    #[inline(always)]
    pub(crate) fn has(self, chunk: usize) -> bool {
        self.0.get(chunk).copied().unwrap_or(false)
    }
}
