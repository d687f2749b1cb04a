//! Checks of counters, reactions and barriers, as far as the file alone tells: their blocks may have to be made first.

use super::checks::Checks;
use crate::messages::Code;
use crate::scene::file::{BarrierFile, CounterFile, ReactionFile, SceneFile};

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

    pub(super) fn barrier(&mut self, index: usize, barrier: &BarrierFile) {
        let who = format!("barrier `{}`", barrier.name);
        let path = |field: &str| format!("barriers[{index}].{field}");
        let is_part_of_file_names = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
        if !barrier.name.chars().all(is_part_of_file_names) {
            let what = format!("{who}: its files have its name; use letters, digits, `_` and `-`");
            self.refuse(Code::UnusableName, path("name"), what);
        }
        if barrier.blocks.is_empty() {
            let what = format!("{who} has no blocks; name those that it consists of");
            self.refuse(Code::EmptyList, path("blocks"), what);
        }
        let what = format!("{who}: the direction of the flow");
        self.direction(path("flow"), &what, barrier.flow);
        self.positive(path("cell"), &format!("{who}: cell"), barrier.cell);
        let what = format!("{who}: upstream");
        self.positive(path("upstream"), &what, barrier.upstream);
        for (k, opening) in barrier.openings.iter().flatten().enumerate() {
            let path = path(&format!("openings[{k}]"));
            self.extent(&path, &who, (opening.min, opening.max));
        }
    }
}
