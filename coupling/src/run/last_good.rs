//! Last good state of a run: in memory to fall back to, and now and then on disk to resume from.

use std::path::Path;

use super::Place;
use crate::output::checkpoint_file::{self as checkpoint, Header};
use crate::output::observe::ObserveError;
use crate::world::World;

/// Steps between two states that are kept, with water: keeping one takes less than a hundredth of the time.
const INTERVAL_WITH_WATER: u64 = 100;
/// Steps between two states for blocks alone, where a step takes little longer than keeping a state.
const INTERVAL_OF_BLOCKS: u64 = 1000;

/// State of a run at the end of a step.
#[derive(Debug)]
pub(super) struct LastGoodState {
    /// Saved run.
    pub state: Vec<u8>,
    /// Stage, time and steps.
    pub place: Place,
    is_on_disk: bool,
}

impl LastGoodState {
    /// State that is not on disk yet.
    pub fn new(state: Vec<u8>, place: Place) -> Self {
        Self {
            state,
            place,
            is_on_disk: false,
        }
    }

    /// Whether a state is kept after so many steps: by their number, so that a resumed run keeps the same ones.
    pub fn is_due(steps: u64, world: &World) -> bool {
        steps.is_multiple_of(match world.water {
            Some(_) => INTERVAL_WITH_WATER,
            None => INTERVAL_OF_BLOCKS,
        })
    }

    /// Whether it still has to be written to disk.
    pub fn is_unwritten(&self) -> bool {
        !self.is_on_disk
    }

    /// Writes the checkpoint of a run folder; returns its size in bytes.
    pub fn write(&mut self, folder: &Path, scene_hash: [u8; 32]) -> Result<u64, ObserveError> {
        let size = checkpoint::write(folder, &self.header(scene_hash), &self.state)?;
        self.is_on_disk = true;
        Ok(size)
    }

    /// Writes a checkpoint file of its own; returns its size in bytes.
    pub fn write_to(&self, path: &Path, scene_hash: [u8; 32]) -> Result<u64, ObserveError> {
        Ok(checkpoint::write_to(
            path,
            &self.header(scene_hash),
            &self.state,
        )?)
    }

    fn header(&self, scene: [u8; 32]) -> Header {
        let Place {
            is_settling,
            time,
            steps,
        } = self.place;
        Header {
            build: checkpoint::build(),
            scene,
            is_settling,
            time,
            steps,
        }
    }
}
