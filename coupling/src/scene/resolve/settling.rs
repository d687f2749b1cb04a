//! Settling of free blocks before t = 0: its gates by number, and scenes in which blocks cannot settle.

use super::barriers::fits;
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{BlockFile, MotionFile, SceneFile, vec3};
use crate::scene::parse::suggestion;
use crate::scene::resolved::Settling;

const PATH: &str = "time.settle_blocks";

/// Settling with its gates by number; the file has the blocks of its rock masses, slides and grains.
pub(super) fn settling(file: &SceneFile) -> Option<Settling> {
    let asked = file.time.settle_blocks.as_ref()?;
    let is_gate = |block: &BlockFile| asked.gates.iter().any(|name| fits(block, name));
    let blocks = file.blocks.iter().enumerate();
    Some(Settling {
        speed: asked.speed,
        time: asked.time,
        at_most: asked.at_most,
        gates: (blocks.filter(|(_, block)| is_gate(block)))
            .map(|(number, _)| number)
            .collect(),
    })
}

/// Gates that do not exist, move or are needed later, and scenes whose blocks cannot settle; the first `n_listed` blocks are those that
/// the scene lists.
pub(super) fn problems(file: &SceneFile, n_listed: usize) -> Vec<Problem> {
    let Some(asked) = &file.time.settle_blocks else {
        return Vec::new();
    };
    let mut problems = Vec::new();
    let mut refuse = |code, path: String, message: String| {
        problems.push(Problem::error(code, path, message));
    };
    if file.fluid.is_some() {
        let what = "water is filled in around blocks where they are drawn, so that they cannot settle first; leave `settle_blocks` out and let \
                    the water come to rest by `settle`, or leave `fluid` out";
        refuse(Code::IncompatibleOptions, PATH.to_owned(), what.to_owned());
    }
    if file.blocks.iter().all(|b| b.motion != MotionFile::Free) {
        let what = "no block is free to move and could settle; leave `settle_blocks` out";
        refuse(Code::NeedsFreeBlock, PATH.to_owned(), what.to_owned());
    }
    if let Some((path, what)) = moving_start(file, n_listed) {
        refuse(Code::IncompatibleOptions, path, what);
    }
    for (k, name) in asked.gates.iter().enumerate() {
        let path = format!("{PATH}.gates[{k}]");
        let members = || file.blocks.iter().filter(|block| fits(block, name));
        if members().next().is_none() {
            let all: Vec<&str> = file.blocks.iter().map(|b| b.name.as_str()).collect();
            let bare = name.trim_end_matches('*');
            let what = format!("no block is called `{name}`{}", suggestion(bare, &all));
            refuse(Code::UnknownName, path, what);
        } else if let Some(block) = members().find(|b| b.motion != MotionFile::Fixed) {
            let what = format!(
                "gate `{}` is not fixed; give it `motion: Fixed`, it is removed at t = 0",
                block.name
            );
            refuse(Code::IncompatibleOptions, path, what);
        } else if let Some((block, user)) = members().find_map(|b| Some((b, later_user(file, b)?)))
        {
            let what = format!(
                "gate `{}` is removed at t = 0 and belongs to {user}; take it out of one of them",
                block.name
            );
            refuse(Code::IncompatibleOptions, path, what);
        }
    }
    problems
}

/// Path and message of the first free block with a velocity.
fn moving_start(file: &SceneFile, n_listed: usize) -> Option<(String, String)> {
    let blocks = file.blocks.iter().enumerate();
    let mut free = blocks.filter(|(_, block)| block.motion == MotionFile::Free);
    free.find_map(|(index, block)| {
        let velocities = [
            ("velocity", block.velocity),
            ("angular_velocity", block.angular_velocity),
        ];
        let moving = velocities.iter().find(|(_, v)| vec3(*v).norm() != 0.0);
        let (field, _) = moving?;
        let path = match index < n_listed {
            true => format!("blocks[{index}].{field}"),
            false => PATH.to_owned(),
        };
        let what = format!(
            "block `{}` has a {} at the start, and settling ends at rest; leave one of them out",
            block.name,
            field.replace('_', " ")
        );
        Some((path, what))
    })
}

/// Where a block is needed after t = 0.
fn later_user(file: &SceneFile, block: &BlockFile) -> Option<String> {
    let of_barrier = (file.barriers.iter())
        .find(|barrier| barrier.blocks.iter().any(|name| fits(block, name)))
        .map(|barrier| format!("barrier `{}`", barrier.name));
    let is_attached = || {
        let attachments = file.attachments.iter();
        let mut names = attachments.flat_map(|attachment| attachment.blocks());
        names.any(|name| name == block.name)
    };
    of_barrier.or_else(|| is_attached().then(|| "an attachment".to_owned()))
}
