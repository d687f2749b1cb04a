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
            let depth = over_allowed * self.allowed_overlap(parts);
            return Err(StepError::Overlap {
                overlap: self.deep_overlap(parts, depth),
                time,
            });
        }
        Ok(())
    }
}
