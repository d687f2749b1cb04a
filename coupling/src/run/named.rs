//! Names of the scene in errors that the solver tells by numbers.

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
        other => other,
    }
}
