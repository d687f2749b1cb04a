//! Overlaps of blocks in words: their names, their place in the scene and on the map, their depth.

use std::collections::BTreeMap;

use riprap_dda::{BlockId, Blocks, DeepOverlap, Vec3};

use super::error::Problem;
use super::file::Triple;
use super::resolved::Scene;
use crate::messages::Code;

/// Pairs of blocks of which a report gives the names.
const LISTED: usize = 5;

/// Overlaps at the start that the first step would refuse, found by the contacts of the blocks in their places.
///
/// Blocks that cannot be built have none: building the world says why.
pub(super) fn refused_by_first_step(scene: &Scene) -> Vec<Problem> {
    let blocks = Blocks::with_joints(
        scene.blocks.clone(),
        scene.materials.clone(),
        &scene.joints,
        scene.block_settings,
    );
    let Ok(blocks) = blocks else {
        return Vec::new();
    };
    let problem = |overlap: &DeepOverlap| {
        let (a, b) = (overlap.blocks.0.index(), overlap.blocks.1.index());
        let mover = if blocks.is_free(a) { a } else { b };
        let message = format!("{}; move them apart", in_words(overlap, scene));
        Problem::error(
            Code::OverlappingBlocks,
            format!("blocks[{mover}].placement"),
            message,
        )
    };
    let found = deepest_of_blocks(blocks.deep_overlaps());
    listed(found.iter().map(problem).collect(), "than a step allows")
}

/// The deepest overlap of each two blocks, × the allowed one, the deepest first.
fn deepest_of_blocks(overlaps: Vec<DeepOverlap>) -> Vec<DeepOverlap> {
    let share = |overlap: &DeepOverlap| overlap.depth / overlap.allowed;
    let mut deepest = BTreeMap::<(BlockId, BlockId), DeepOverlap>::new();
    for overlap in overlaps {
        let entry = deepest.entry(overlap.blocks).or_insert(overlap);
        if share(entry) < share(&overlap) {
            *entry = overlap;
        }
    }
    let mut deepest: Vec<_> = deepest.into_values().collect();
    deepest.sort_by(|a, b| share(b).total_cmp(&share(a)));
    deepest
}

/// The first problems, and one more with the number of the others, which overlap deeper than a `limit`.
pub(super) fn listed(mut problems: Vec<Problem>, limit: &str) -> Vec<Problem> {
    let n_more = problems.len().saturating_sub(LISTED);
    problems.truncate(LISTED);
    if let Some(last) = problems.last().filter(|_| 0 < n_more) {
        let pairs = if n_more == 1 { "pair" } else { "pairs" };
        let message = format!("{n_more} more {pairs} of blocks overlap deeper {limit}");
        problems.push(Problem::error(last.code, last.path.clone(), message));
    }
    problems
}

/// An overlap with the names of its blocks and its place on the map.
pub fn in_words(overlap: &DeepOverlap, scene: &Scene) -> String {
    let name = |block: BlockId| scene.block_names.get(block.index());
    let (first, second) = (name(overlap.blocks.0), name(overlap.blocks.1));
    let origin = scene.terrain.as_ref().map(|terrain| terrain.origin);
    format!(
        "blocks `{}` and `{}` {overlap}{}",
        first.map_or("", String::as_str),
        second.map_or("", String::as_str),
        on_the_map(&overlap.at, origin)
    )
}

/// `, on the map (x, y, z) m` of a point (m), where the scene is part of a map.
pub(crate) fn on_the_map(at: &Vec3, origin: Option<Triple>) -> String {
    match origin {
        Some((x, y, z)) if (x, y, z) != (0.0, 0.0, 0.0) => format!(
            ", on the map ({:.1}, {:.1}, {:.1}) m",
            x + at.x,
            y + at.y,
            z + at.z
        ),
        _ => String::new(),
    }
}
