//! Checks of counters, reactions and barriers, as far as the file alone tells: their blocks may have to be made first.

use super::checks::Checks;
use crate::messages::Code;
use crate::scene::file::{
    BarrierFile, CounterFile, HandoffFile, HandoffTimesFile, ReactionFile, SceneFile,
};

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

    pub(super) fn handoff(&mut self, handoff: &HandoffFile, scene: &SceneFile) {
        self.positive("handoff.cell", "handoff: cell", handoff.cell);
        if scene.fluid.is_none() {
            let what = "a hand-off is of water, but the scene has none".to_owned();
            self.refuse(Code::NeedsWater, "handoff", what);
        }
        if let HandoffTimesFile::At(times) = &handoff.times {
            for &time in times {
                let end = scene.time.duration;
                if !(0.0 <= time && time.is_finite()) {
                    let what = format!(
                        "handoff: {time} s is before the start of the run; take a time from 0 on"
                    );
                    self.refuse(Code::ValueOutOfRange, "handoff.times", what);
                } else if end < time {
                    let what = format!(
                        "handoff: the run ends at {end} s, before {time} s, of which there will be nothing"
                    );
                    self.warn(Code::OptionWithoutEffect, "handoff.times", what);
                }
            }
        }
        for (k, line) in handoff.lines.iter().enumerate() {
            if line.from == line.to {
                let what = format!(
                    "line `{}` of the hand-off begins and ends at the same place; give it a length",
                    line.name
                );
                self.refuse(
                    Code::ValueOutOfRange,
                    format!("handoff.lines[{k}].to"),
                    what,
                );
            }
            let is_part_of_file_names = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
            if !line.name.chars().all(is_part_of_file_names) {
                let what = format!(
                    "line `{}` of the hand-off: its files have its name; use letters, digits, `_` and `-`",
                    line.name
                );
                self.refuse(Code::UnusableName, format!("handoff.lines[{k}].name"), what);
            }
        }
        let names = handoff.lines.iter().map(|line| line.name.as_str());
        self.unique("handoff.lines", names);
    }
}
