//! Guards at the end of a step: what can not be continued is refused.

use crate::blocks::CHUNK;
use crate::{BlockId, Blocks, StepError, Vec3, chunks};

/// Principal value of Green's strain below which Saint Venant-Kirchhoff's law softens; –.
const CRUSHED: f64 = -0.2;

impl Blocks {
    pub(crate) fn check(&self, time: f64) -> Result<(), StepError> {
        // A sum is finite if all its terms are; one that overflows is past saving too.
        let bad = |first: usize, (centroid, velocity, momentum): (&[Vec3], &[Vec3], &[Vec3])| {
            (first..)
                .zip(centroid.iter().zip(velocity).zip(momentum))
                .find(|(b, ((x, v), l))| {
                    let turn = self.state.attitude[*b].coords.sum();
                    !(x.sum() + v.sum() + l.sum() + turn).is_finite()
                })
                .map(|(b, _)| b)
        };
        let columns = (
            self.state.centroid.as_slice(),
            self.state.velocity.as_slice(),
            self.state.angular_momentum.as_slice(),
        );
        if let Some(block) = chunks::reduce(columns, CHUNK, &bad, &Option::or) {
            return Err(StepError::NotFinite {
                block: BlockId::new(block),
                time,
            });
        }
        for (k, block) in self
            .constants
            .deformable_of
            .iter()
            .enumerate()
            .filter_map(|(b, k)| k.map(|k| (k, b)))
        {
            let strain = self.state.deformables[k as usize].lowest_strain();
            // NaN counts as crushed.
            if !(strain >= CRUSHED) {
                return Err(StepError::Crushed {
                    block: BlockId::new(block),
                    strain,
                    limit: CRUSHED,
                    time,
                });
            }
        }
        let (over_allowed, parts) = self.state.worst_overlap;
        if over_allowed > 1.0 {
            let parts = [parts.0 as usize, parts.1 as usize];
            let least = |of: &[f64]| of[parts[0]].min(of[parts[1]]);
            let allowed = least(&self.constants.deepest_allowed);
            return Err(StepError::Overlap {
                first: self.constants.block_of_part[parts[0]].into(),
                second: self.constants.block_of_part[parts[1]].into(),
                overlap: over_allowed * allowed,
                size: least(&self.constants.size),
                allowed,
                time,
            });
        }
        Ok(())
    }
}
