//! Blocks of counters and reactions: by name, by the beginning of names, by material.

use super::recording::free_blocks;
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{BlockFile, CounterFile, MotionFile, ReactionFile, SceneFile, vec3};
use crate::scene::parse::suggestion;
use crate::scene::resolved::recording::{CountedRegion, Counter, Reaction};

/// Counters with their blocks by number.
pub(super) fn counters(file: &SceneFile) -> Vec<Counter> {
    let region = |counter: &CounterFile| match counter {
        CounterFile::Plane { point, normal, .. } => CountedRegion::Beyond {
            point: vec3(*point),
            normal: vec3(*normal),
        },
        CounterFile::Box { min, max, .. } => CountedRegion::Box {
            min: vec3(*min),
            max: vec3(*max),
        },
    };
    let counter = |counter: &CounterFile| Counter {
        name: counter.name().to_owned(),
        region: region(counter),
        blocks: free_blocks(file, |block| block.starts_with(counter.blocks())),
    };
    file.counters.iter().map(counter).collect()
}

/// Reactions with their blocks by number.
pub(super) fn reactions(file: &SceneFile) -> Vec<Reaction> {
    let reaction = |reaction: &ReactionFile| Reaction {
        name: reaction.name.clone(),
        between: sides(reaction).map(|side| members(file, side)),
        direction: reaction.direction.map(|along| vec3(along).normalize()),
    };
    file.reactions.iter().map(reaction).collect()
}

/// Counters and reactions without blocks, or of blocks that cannot be told; the file has the blocks of its rock masses, slides
/// and grains.
pub(super) fn problems(file: &SceneFile) -> Vec<Problem> {
    let counters = file.counters.iter().enumerate();
    let counters = counters.filter_map(|(k, counter)| {
        let prefix = counter.blocks();
        let is_empty = free_blocks(file, |block| block.starts_with(prefix)).is_empty();
        is_empty.then(|| {
            let who = format!("counter `{}`", counter.name());
            let free = file.blocks.iter().filter(|block| is_free(block));
            let what = no_beginning(&who, "free block", prefix, free);
            Problem::error(Code::UnknownName, format!("counters[{k}].blocks"), what)
        })
    });
    let reactions = file.reactions.iter().enumerate();
    let reactions = reactions.flat_map(|(k, reaction)| of_reaction(file, k, reaction));
    counters.chain(reactions).collect()
}

fn of_reaction(file: &SceneFile, index: usize, reaction: &ReactionFile) -> Vec<Problem> {
    let who = format!("reaction `{}`", reaction.name);
    let path = format!("reactions[{index}].between");
    let unclear = sides(reaction).into_iter().enumerate();
    let unclear = unclear.filter_map(|(k, side)| {
        let (code, what) = unclear_side(file, &who, side)?;
        Some(Problem::error(code, format!("{path}[{k}]"), what))
    });
    let mut problems: Vec<Problem> = unclear.collect();
    let mut all = sides(reaction)
        .into_iter()
        .flat_map(|side| members(file, side));
    if problems.is_empty() && !all.any(|b| is_free(&file.blocks[b])) {
        let what = format!(
            "{who}: no block of `{}` and `{}` is free to move, and blocks that are not do not push each other",
            reaction.between.0, reaction.between.1
        );
        problems.push(Problem::error(Code::NeedsFreeBlock, path, what));
    }
    problems
}

/// Error of a side that names no block, or a block and a material at once.
fn unclear_side(file: &SceneFile, who: &str, side: &str) -> Option<(Code, String)> {
    let of_name = file.blocks.iter().position(|block| block.name == side);
    let of_material = members_of_material(file, side);
    if let Some(block) = of_name {
        let is_unclear = !(of_material.is_empty() || of_material == [block]);
        return is_unclear.then(|| {
            let what = format!(
                "{who}: `{side}` is the name of a block and of a material with {} blocks; rename one of them",
                of_material.len()
            );
            (Code::UnusableName, what)
        });
    }
    if !members(file, side).is_empty() {
        return None;
    }
    let what = if let Some(prefix) = side.strip_suffix('*') {
        no_beginning(who, "block", prefix, file.blocks.iter())
    } else if file.materials.iter().any(|material| material.name == side) {
        format!("{who}: no block is of material `{side}`")
    } else {
        let blocks = file.blocks.iter().map(|block| block.name.as_str());
        let materials = file.materials.iter().map(|material| material.name.as_str());
        let names: Vec<&str> = blocks.chain(materials).collect();
        format!(
            "{who}: no block and no material is called `{side}`{}",
            suggestion(side, &names)
        )
    };
    Some((Code::UnknownName, what))
}

/// Message of a beginning that no name has.
fn no_beginning<'a>(
    who: &str,
    kind: &str,
    prefix: &str,
    blocks: impl Iterator<Item = &'a BlockFile>,
) -> String {
    let names: Vec<&str> = blocks.map(|block| block.name.as_str()).collect();
    format!(
        "{who}: no {kind} has a name that begins with `{prefix}`{}",
        suggestion(prefix, &names)
    )
}

fn sides(reaction: &ReactionFile) -> [&str; 2] {
    [&reaction.between.0, &reaction.between.1]
}

/// Numbers of the blocks of a side, ascending.
fn members(file: &SceneFile, side: &str) -> Vec<usize> {
    if let Some(prefix) = side.strip_suffix('*') {
        return numbers(file, |block| block.name.starts_with(prefix));
    }
    let of_name = numbers(file, |block| block.name == side);
    match of_name.is_empty() {
        true => members_of_material(file, side),
        false => of_name,
    }
}

fn members_of_material(file: &SceneFile, material: &str) -> Vec<usize> {
    numbers(file, |block| block.material == material)
}

fn numbers(file: &SceneFile, fits: impl Fn(&BlockFile) -> bool) -> Vec<usize> {
    let blocks = file.blocks.iter().enumerate();
    let fitting = blocks.filter(|(_, block)| fits(block));
    fitting.map(|(number, _)| number).collect()
}

fn is_free(block: &BlockFile) -> bool {
    matches!(block.motion, MotionFile::Free)
}
