//! Checks of counters and reactions, as far as the file alone tells: their blocks may have to be made first.

use super::checks::Checks;
use crate::scene::file::{CounterFile, ReactionFile, SceneFile};

impl Checks {
    pub(super) fn counter(&mut self, index: usize, counter: &CounterFile, scene: &SceneFile) {
        let who = format!("counter `{}`", counter.name());
        let path = format!("counters[{index}]");
        match counter {
            CounterFile::Plane { normal, .. } => {
                let what = format!("{who}: the normal");
                self.direction(format!("{path}.normal"), &what, *normal);
            }
            CounterFile::Box { min, max, .. } => self.extent(&path, &who, (*min, *max)),
        }
        let path = format!("{path}.blocks");
        self.free_blocks_begin_with(&path, &who, counter.blocks(), scene);
    }

    pub(super) fn reaction(&mut self, index: usize, reaction: &ReactionFile) {
        if let Some(direction) = reaction.direction {
            self.direction(
                format!("reactions[{index}].direction"),
                &format!("reaction `{}`: the direction", reaction.name),
                direction,
            );
        }
    }
}
