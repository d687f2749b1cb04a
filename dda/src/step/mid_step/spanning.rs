//! Steps of contact dynamics that do not end with those of the caller: one kick in several of the caller's steps.
//!
//! Blocks drift with each step of the caller. The time that no kick has covered yet is owed, and a kick comes when half a period is:
//!
//! ```text
//! owed = T/2:   kick over (T + T')/2,   owed := −T'/2            T, T': periods of the last kick and of this one    [s]
//! ```
//! so that kicks are a period apart, each in the middle of what it covers, and the times that they cover add up to the time passed whatever
//! becomes of the period.
//!
//! Impulses from outside wait for the kick, too, which must give those of the half period to come, or the motion would lag behind them by as much
//! and gain energy in waves. It gives what the mean force since the last kick would, and the next one what was wrong with it:
//!
//! ```text
//! J = I − A + A',   A' = I/D T'/2          I: impulses in the time D since the last kick,  A: what that gave in advance       [N s]
//! ```
//! With equal periods that is Adams-Bashforth's second-order step, `J = 3/2 I_k − 1/2 I_(k−1)`.

use crate::blocks::Spanned;
use crate::step::phase::Phase;
use crate::{Blocks, ContactDynamics, Integrator, Load, StepError, chunks};

/// Largest growth of the period from one kick to the next, whose contacts were solved for the shorter one.
const LARGEST_GROWTH: f64 = 1.5;

/// Kicks within a step of the caller.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kicks {
    /// Number.
    pub count: u32,
    /// Time that they cover, of which a part may be past or still to come; s.
    pub over: f64,
}

impl Blocks {
    /// Moves all blocks from `time` over `dt` (s) by contact dynamics with a kick in each `period` (s), which may be longer than `dt`. Other
    /// integrators take one step of `dt`, and so do systems with deformable blocks. `ended` as in [`Blocks::advance_watched`].
    ///
    /// # Errors
    ///
    /// As [`Blocks::advance`].
    pub fn advance_spanning(
        &mut self,
        time: f64,
        dt: f64,
        period: f64,
        ended: &mut (impl FnMut(Phase) + Send),
    ) -> Result<Kicks, StepError> {
        let spans = self.state.deformables.is_empty();
        let dynamics = match self.constants.settings.integrator {
            Integrator::ContactDynamics(dynamics) if spans => dynamics,
            _ => {
                let count = self.advance_watched(time, dt, 1, ended)?;
                return Ok(Kicks { count, over: dt });
            }
        };
        if !(0.0 < dt && dt.is_finite() && 0.0 < period) {
            return Err(StepError::TimeStep { dt, time });
        }
        if self.n_free() == 0 && self.n_prescribed() == 0 {
            return Ok(Kicks { count: 1, over: dt });
        }
        chunks::in_pool(self.is_large(), || {
            self.span((time, time + dt), period, &dynamics, ended)
        })
    }

    /// Drifts from `from` to `to` (s), with the kicks that fall due on the way.
    pub(crate) fn span(
        &mut self,
        (from, to): (f64, f64),
        period: f64,
        dynamics: &ContactDynamics,
        ended: &mut impl FnMut(Phase),
    ) -> Result<Kicks, StepError> {
        let mut kicks = Kicks::default();
        let mut solved = Ok(());
        let (mut at, mut left) = (from, to - from);
        while solved.is_ok() {
            let Spanned {
                owed, period: last, ..
            } = self.state.spanned;
            let due = 0.5 * if 0.0 < last { period.min(last) } else { period };
            let wait = (due - owed).max(0.0);
            if left < wait {
                break;
            }
            let next = at + wait;
            self.drift_on((at, next), wait);
            let period = match 0.0 < last {
                true => period.min(LARGEST_GROWTH * last),
                false => period,
            };
            let over = owed + wait + 0.5 * period;
            self.look_ahead(0.5 * period / (owed + wait + 0.5 * last));
            let open = self.kick_in_place(next, over, dynamics, ended);
            self.owe_what_was_given();
            self.state.spanned.owed = -0.5 * period;
            self.state.spanned.period = period;
            self.rest_or_wake(over);
            solved = self.check_solution(open, next);
            kicks.count += 1;
            kicks.over += over;
            (at, left) = (next, left - wait);
        }
        self.drift_on((at, to), left);
        self.state.spanned.owed += left;
        self.place_parts(false);
        self.set_velocities(to);
        let checked = solved.and_then(|()| self.check(to));
        ended(Phase::Motion);
        checked.map(|()| kicks)
    }

    /// Adds what is to come from outside until half a period after the kick, `share` of what came since the last one.
    fn look_ahead(&mut self, share: f64) {
        let mut ahead = std::mem::take(&mut self.state.spanned.ahead);
        ahead.resize(self.n_blocks(), Load::default());
        for (b, ahead) in ahead.iter_mut().enumerate() {
            let Some(outside) = self.state.outside.get(b).copied() else {
                continue;
            };
            if !self.is_driven(b) {
                // held by its support
                self.state.totals.support_impulse -= outside.force;
                *ahead = Load::default();
                continue;
            }
            let mut came = outside;
            came += *ahead;
            *ahead = came.times(share);
            self.state.outside[b] += *ahead;
        }
        self.state.spanned.ahead = ahead;
    }

    /// What was given in advance is missing from what comes.
    fn owe_what_was_given(&mut self) {
        for (outside, ahead) in self.state.outside.iter_mut().zip(&self.state.spanned.ahead) {
            *outside = ahead.times(-1.0);
        }
    }

    fn drift_on(&mut self, (from, to): (f64, f64), dt: f64) {
        if 0.0 < dt {
            self.drift(from, to, dt);
        }
    }
}
