//! Steps of the blocks, by the integrator of the settings.

use crate::blocks::CHUNK;
use crate::contact::rates::KeptBound;
use crate::contact::tally::PAIR_CHUNK;
use crate::step::phase::Phase;
use crate::{Blocks, Integrator, Settings, StepBound, StepError, chunks};

/// Steps that differ by less are equal; –.
const ROUND_OFF: f64 = 1e-9;
/// Share of a step below which a sub-step gets nowhere.
const SMALLEST_SHARE: f64 = 1e-6;

impl Blocks {
    /// Moves all blocks from `time` over `dt` (s) in `n_substeps` equal sub-steps, under gravity and
    /// contact forces; prescribed blocks follow their paths exactly. Returns the number of sub-steps.
    ///
    /// With [`StepBound::Eigenvalues`] every sub-step asks for the bound anew, and they are at least that many.
    ///
    /// # Errors
    ///
    /// [`StepError`] if the step is unusable, a block's state is no longer finite, or two blocks
    /// overlap by more than the limit of the settings.
    pub fn advance(&mut self, time: f64, dt: f64, n_substeps: u32) -> Result<u32, StepError> {
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
    ) -> Result<u32, StepError> {
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(StepError::TimeStep { dt, time });
        }
        let n_free = self.n_free();
        let n_substeps = n_substeps.max(1);
        if n_free == 0 && self.n_prescribed() == 0 {
            return Ok(n_substeps);
        }
        chunks::in_pool(self.is_large(), || {
            let Settings {
                integrator,
                step_bound,
                ..
            } = self.constants.settings;
            match (integrator, step_bound) {
                (Integrator::CentralDifference, StepBound::Eigenvalues) => {
                    self.bounded_sub_steps((time, dt), n_substeps, ended)
                }
                (Integrator::ContactDynamics(dynamics), _) if self.state.spanned.owed != 0.0 => {
                    let period = dt / f64::from(n_substeps);
                    self.span((time, time + dt), period, &dynamics, ended)
                        .map(|kicks| kicks.count)
                }
                _ => self.equal_sub_steps((time, dt), n_substeps, ended),
            }
        })
    }

    fn equal_sub_steps(
        &mut self,
        (time, dt): (f64, f64),
        n_substeps: u32,
        ended: &mut impl FnMut(Phase),
    ) -> Result<u32, StepError> {
        let n = f64::from(n_substeps);
        for k in 0..n_substeps {
            let from = time + dt * (f64::from(k) / n);
            let to = time + dt * (f64::from(k + 1) / n);
            self.sub_step((from, to), dt / n, ended)?;
        }
        Ok(n_substeps)
    }

    /// Sub-steps that divide what is left of the step equally, within the bound at the start of each. The bound at the start of the
    /// first is what the caller found.
    fn bounded_sub_steps(
        &mut self,
        (time, dt): (f64, f64),
        n_least: u32,
        ended: &mut impl FnMut(Phase),
    ) -> Result<u32, StepError> {
        let longest = dt / f64::from(n_least);
        let (mut left, mut n_taken, mut bound) = (dt, 0, longest);
        loop {
            let n_left = (left / bound * (1.0 - ROUND_OFF)).ceil().max(1.0);
            let step = left / n_left;
            if step < SMALLEST_SHARE * dt {
                return Err(StepError::TimeStep { dt: step, time });
            }
            let from = time + (dt - left);
            left -= step;
            let is_last = n_left <= 1.0;
            let to = if is_last {
                time + dt
            } else {
                time + (dt - left)
            };
            self.sub_step((from, to), step, ended)?;
            n_taken += 1;
            if is_last {
                return Ok(n_taken);
            }
            bound = self.critical_time_step().dt.min(longest);
        }
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
            Integrator::ContactDynamics(dynamics) => self.mid_step((from, to), &dynamics, ended),
        }
    }

    /// Positions of the parts after a drift, and the pairs that may touch there.
    pub(crate) fn move_parts(&mut self, dt: f64, ended: &mut impl FnMut(Phase)) {
        self.place_parts(false);
        ended(Phase::Motion);
        if self.is_skin_used_up() {
            self.find_candidates(dt);
            // it knows nothing of new pairs
            self.state.bound = KeptBound::default();
        }
        ended(Phase::BroadPhase);
    }

    fn is_skin_used_up(&self) -> bool {
        let leaves = |first: usize, can_move: &[bool]| {
            (first..)
                .zip(can_move)
                .any(|(part, can_move)| *can_move && self.has_left(part))
        };
        let can_move = self.derived.can_move.as_slice();
        chunks::reduce(can_move, CHUNK, &leaves, &|a, b| a || b)
    }
}
