//! State of blocks at rest, which sleep until their load changes.

use crate::{Load, Vec3};
use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};

/// State of sleep of the blocks.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Rest {
    pub is_asleep: Vec<bool>,
    /// Position of a block at the start of its rest.
    pub since: Vec<(Vec3, UnitQuaternion<f64>)>,
    /// Time for which a block has been at rest; s.
    pub time_at_rest: Vec<f64>,
    /// Mean load.
    pub mean: Vec<Load>,
    /// Mean load when it was put to sleep.
    pub at_rest: Vec<Load>,
    /// Last external load.
    pub outside: Vec<Load>,
}

impl Rest {
    pub fn has(&self, block: usize) -> bool {
        self.is_asleep.get(block).copied().unwrap_or(false)
    }

    /// Ends the sleep of a removed block.
    pub fn leave(&mut self, block: usize) {
        if let Some(is_asleep) = self.is_asleep.get_mut(block) {
            *is_asleep = false;
        }
    }

    /// Notes the external load of a block, if sleep is enabled.
    pub fn note_outside(&mut self, block: usize, load: &Load) {
        if let Some(outside) = self.outside.get_mut(block) {
            *outside = *load;
        }
    }
}
