//! Contact dynamics: drift, kick with all contacts solved together, drift.
//!
//! ```text
//! q(mid) = q + dt/2 u                        rotations free and exact, as in central differences
//! u(free) = u + dt g;   b = H u(free) + s n;    R from the laws of contact;   u := u(free) + M⁻¹ Hᵀ R
//! q := q(mid) + dt/2 u
//! ```
//! Symmetric, second order while no contact changes its state, first order through impacts. Positions at mid-steps are a leap-frog sequence,
//! and that is where gaps count:
//!
//! ```text
//! s = e min(0, U_n(old))      impact: U_n(old) < −v_e, and the gap closes within the step
//! s = gap/dt                  otherwise, gap > 0 at mid-step
//! s = 0                       touching
//! ```
//! with `v_e = 5 g dt`: slower contacts have no restitution. The gap has no place in an impact: it would slow the body in the step before
//! it touches, and the rebound would be lost.
//!
//! Weight, loads, supports, bolts and impulses from outside act at the middle of the step with the contacts. A hold is exact: the inverse
//! mass and inertia of its block are those of what it leaves free. Joints are rows among those of contacts, see [`joints`].
//!
//! Friction has two values, see [`slip`]; spheres resist rolling by torques among the contacts; parts that were bonded at the start are fixed
//! to each other until that breaks, see [`bonds`].
//!
//! Blocks that deform have their velocity gradient among the unknowns, with a mass of strain that their stiffness is part of, see
//! [`crate::motion::deformation`]: neither strain nor rotation limits the step.
//!
//! What overlap remains goes out as a displacement, not as a velocity, see [`overlap`]. Work of contacts is that of the mean velocity
//! in the kick, so that the account of energy closes to round-off but for the turning of blocks: tangential work is friction, normal work
//! and that of bonds damping.
//!
//! Sources: Moreau (1999), Jean (1999).

mod bonds;
mod closing;
mod joints;
mod kick;
mod overlap;
mod slip;
mod spanning;
mod start;
mod straining;
mod time_step;
mod touches;

pub use spanning::Kicks;

use crate::blocks::{ContactDynamics, Update};
use crate::contact::dynamics::kept::{ContactSolution, SolvedSteps};
use crate::error::OpenJoint;
use crate::step::phase::Phase;
use crate::{Blocks, StepError};
use straining::Half;

/// Unsolved steps running at which a run ends.
const TOO_MANY_UNSOLVED: u32 = 3;

impl Blocks {
    /// Contacts of the last step of contact dynamics.
    pub fn contact_solution(&self) -> ContactSolution {
        self.state.solution
    }

    /// Contacts of all steps of contact dynamics since t = 0.
    pub fn solved_steps(&self) -> &SolvedSteps {
        &self.state.totals.solved
    }

    /// One step from `from` to `to` (s):
    ///
    /// 1. half a drift, with the parts in place;
    /// 2. pairs that may meet within the step, and their points;
    /// 3. kick by weight, attachments, impulses from outside, contacts, bonds and joints, with their accounts; bonds and rods that do not
    ///    bear it break;
    /// 4. overlap is removed;
    /// 5. half a drift, sleep, velocities at the end of the step, guards.
    pub(crate) fn mid_step(
        &mut self,
        (from, to): (f64, f64),
        dynamics: &ContactDynamics,
        ended: &mut impl FnMut(Phase),
    ) -> Result<(), StepError> {
        let (dt, middle) = (to - from, 0.5 * (from + to));
        self.drift(from, middle, 0.5 * dt);
        self.drift_straining(Half::ToMiddle, 0.5 * dt);
        let open = self.kick_in_place(middle, dt, dynamics, ended);
        self.state.spanned.period = dt;
        self.drift(middle, to, 0.5 * dt);
        self.drift_straining(Half::FromMiddle, 0.5 * dt);
        self.place_parts(false);
        self.rest_or_wake(dt);
        self.set_velocities(to);
        let checked = self.check_solution(open, to).and_then(|()| self.check(to));
        ended(Phase::Motion);
        checked
    }

    /// Kick over `dt` (s) with all blocks where they are at a time, items 2 to 4 above; tells of a joint that stays open.
    fn kick_in_place(
        &mut self,
        time: f64,
        dt: f64,
        dynamics: &ContactDynamics,
        ended: &mut impl FnMut(Phase),
    ) -> Option<OpenJoint> {
        self.note_reach(dt);
        self.move_parts(dt, ended);
        self.set_mean_velocities(time, dt);
        self.evaluate_attachments(false);
        let touches = self.touches(dt);
        self.wake_pushed(&touches, dt);
        ended(Phase::Contacts);
        let closing = self.closing(touches, dt);
        let open = self.kick_with_contacts(closing, dynamics, dt);
        ended(Phase::Sums);
        open
    }

    /// Velocities of prescribed blocks from this middle of a step to the next one.
    fn set_mean_velocities(&mut self, middle: f64, dt: f64) {
        for b in 0..self.n_blocks() {
            if let Some(path) = self.followed_path(b) {
                let next = middle + dt;
                let way = path.displacement(next) - path.displacement(middle);
                let turn = path.turn(next) * path.turn(middle).inverse();
                self.state.velocity[b] = way / dt + self.steering(b).1;
                self.set_spin(b, &(turn.scaled_axis() / dt));
                self.set_kinematics(b);
            }
        }
    }

    /// Whether impulses move a block.
    fn is_driven(&self, b: usize) -> bool {
        matches!(self.derived.update[b], Update::Rigid | Update::Constrained)
    }

    /// Refuses to go on from contacts and joints that were left unsolved too often.
    fn check_solution(&self, joint: Option<OpenJoint>, time: f64) -> Result<(), StepError> {
        let n_steps = self.state.totals.solved.n_unsolved_running;
        if n_steps < TOO_MANY_UNSOLVED {
            return Ok(());
        }
        let ContactSolution {
            n_iterations,
            residual,
            ..
        } = self.state.solution;
        Err(StepError::Unsolved {
            n_steps,
            residual,
            n_iterations,
            joint,
            time,
        })
    }
}
