//! Steps of the blocks, by the integrator of the settings.

use crate::blocks::CHUNK;
use crate::contact::detection::broad_phase;
use crate::contact::detection::broad_phase::Bounds;
use crate::contact::tally::PAIR_CHUNK;
use crate::step::phase::Phase;
use crate::{Blocks, Integrator, StepError, chunks};

impl Blocks {
    /// Moves all blocks from `time` over `dt` (s) in `n_substeps` equal sub-steps, under gravity and
    /// contact forces; prescribed blocks follow their paths exactly.
    ///
    /// # Errors
    ///
    /// [`StepError`] if the step is unusable, a block's state is no longer finite, or two blocks
    /// overlap by more than the limit of the settings.
    pub fn advance(&mut self, time: f64, dt: f64, n_substeps: u32) -> Result<(), StepError> {
        self.advance_watched(time, dt, n_substeps, &mut |_| {})
    }

    /// Advances, and calls `ended` at the end of each phase, for the caller's timing. The
    /// solver has no clock.
    ///
    /// # Errors
    ///
    /// As [`Blocks::advance`].
    pub fn advance_watched(
        &mut self,
        time: f64,
        dt: f64,
        n_substeps: u32,
        ended: &mut (impl FnMut(Phase) + Send),
    ) -> Result<(), StepError> {
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(StepError::TimeStep { dt, time });
        }
        let n_free = self.n_free();
        if n_free == 0 && self.n_prescribed() == 0 {
            return Ok(());
        }
        let n = f64::from(n_substeps.max(1));
        chunks::in_pool(self.is_large(), || {
            for k in 0..n_substeps.max(1) {
                let from = time + dt * (f64::from(k) / n);
                let to = time + dt * (f64::from(k + 1) / n);
                self.sub_step((from, to), dt / n, ended)?;
            }
            Ok(())
        })
    }

    /// Is a step worth more than one thread?
    pub(crate) fn is_large(&self) -> bool {
        self.n_blocks().max(self.contacts.sphere_pairs.len()) > CHUNK
            || self
                .contacts
                .pairs
                .len()
                .max(self.contacts.surface_pairs.len())
                > 2 * PAIR_CHUNK
    }

    /// One step from `from` to `to` (s).
    fn sub_step(
        &mut self,
        (from, to): (f64, f64),
        dt: f64,
        ended: &mut impl FnMut(Phase),
    ) -> Result<(), StepError> {
        match self.constants.settings.integrator {
            Integrator::CentralDifference => self.central_difference((from, to), dt, ended),
        }
    }

    /// Positions of the parts after a drift, and the pairs that may touch there.
    pub(crate) fn move_parts(&mut self, ended: &mut impl FnMut(Phase)) {
        self.place_parts(false);
        ended(Phase::Motion);
        if self.is_skin_used_up() {
            self.find_candidates();
        }
        ended(Phase::BroadPhase);
    }

    fn is_skin_used_up(&self) -> bool {
        let leaves = |first: usize, (fat, boxes): (&[Bounds], &[Bounds])| {
            (first..)
                .zip(fat.iter().zip(boxes))
                .any(|(part, (fat, bounds))| {
                    self.derived.can_move[part] && !broad_phase::holds(fat, bounds)
                })
        };
        let columns = (self.state.fat_boxes.as_slice(), self.state.boxes.as_slice());
        chunks::reduce(columns, CHUNK, &leaves, &|a, b| a || b)
    }
}
