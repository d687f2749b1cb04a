//! Names of the scene in errors that the solver tells by numbers.

use riprap_dda::BlockId;

use crate::scene::overlaps::in_words;
use crate::scene::resolve::Scene;
use crate::world::StepError;

/// The error of a step with the names of its blocks and their place on the map.
pub(crate) fn named(error: StepError, scene: &Scene) -> StepError {
    match error {
        StepError::Blocks {
            time,
            step,
            source: riprap_dda::StepError::Overlap { overlap, .. },
        } => StepError::Overlap {
            time,
            step,
            words: in_words(&overlap, scene),
        },
        other => match block_of(&other) {
            Some(block) => with_name(other, block, scene),
            None => other,
        },
    }
}

/// The block that an error tells of by its number.
fn block_of(error: &StepError) -> Option<BlockId> {
    match error {
        StepError::AtPlane { block, .. } => Some(*block),
        StepError::Blocks { source, .. } => match source {
            riprap_dda::StepError::NotFinite { block, .. }
            | riprap_dda::StepError::Crushed { block, .. } => Some(*block),
            riprap_dda::StepError::Overlap { .. }
            | riprap_dda::StepError::Unsolved { .. }
            | riprap_dda::StepError::TimeStep { .. } => None,
        },
        _ => None,
    }
}

/// The error with the name of a block in place of its number.
fn with_name(error: StepError, block: BlockId, scene: &Scene) -> StepError {
    let Some(name) = scene.block_names.get(block.index()) else {
        return error;
    };
    let (number, name) = (format!("block {block} "), format!("block `{name}` "));
    StepError::Named {
        words: error.to_string().replace(&number, &name),
        error: Box::new(error),
    }
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;
    use crate::scene::parse;

    #[test]
    fn a_block_has_its_name_in_every_error() {
        let text = r#"(title: "two", domain: (min: (-9, -9, -9), max: (9, 9, 9)),
            materials: [(name: "rock", density: 2500, friction_angle_deg: 30)],
            blocks: [(name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-1, -1, -1), max: (1, 1, 0))),
                     (name: "cap stone", material: "rock", shape: Box(min: (0, 0, 1), max: (1, 1, 2)))],
            time: (duration: 1))"#;
        let scene = Scene::resolve(parse::read(text).unwrap(), std::path::Path::new(".")).unwrap();
        let (time, step, block) = (0.1, 7, BlockId::new(1));
        let crushed = StepError::Blocks {
            time,
            step,
            source: riprap_dda::StepError::Crushed {
                block,
                strain: -0.7,
                limit: -0.5,
                time,
            },
        };
        let axis = 1;
        let at_plane = StepError::AtPlane {
            time,
            step,
            block,
            axis,
        };
        for error in [crushed, at_plane] {
            let (was, told) = (error.is_of_the_step(), named(error, &scene));
            assert!(told.to_string().contains("block `cap stone` "), "{told}");
            assert_eq!(told.is_of_the_step(), was);
        }
    }
}
