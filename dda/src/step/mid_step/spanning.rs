//! Steps of contact dynamics that do not end with those of the caller: one kick in several of the caller's steps.
//!
//! Blocks drift with each step of the caller. The time that no kick has covered yet is owed, and a kick comes when half a period is:
//!
//! ```text
//! owed = T/2:   kick over (T + T')/2,   owed := −T'/2            T, T': periods of the last kick and of this one    [s]
//! ```
//! so that kicks are a period apart, each in the middle of what it covers, and the times that they cover add up to the time passed whatever
//! becomes of the period. Impulses from outside wait for the kick.

use crate::blocks::Spanned;
use crate::step::phase::Phase;
use crate::{Blocks, ContactDynamics, Integrator, StepError, chunks};

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
    /// integrators take one step of `dt`. `ended` as in [`Blocks::advance_watched`].
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
        let Integrator::ContactDynamics(dynamics) = self.constants.settings.integrator else {
            let count = self.advance_watched(time, dt, 1, ended)?;
            return Ok(Kicks { count, over: dt });
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
            let Spanned { owed, period: last } = self.state.spanned;
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
            let open = self.kick_in_place(next, over, dynamics, ended);
            self.state.spanned = Spanned {
                owed: -0.5 * period,
                period,
            };
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

    fn drift_on(&mut self, (from, to): (f64, f64), dt: f64) {
        if 0.0 < dt {
            self.drift(from, to, dt);
        }
    }
}
