//! Blocks that come to rest before t = 0: prescribed ones wait, and all sums begin anew once they lie.

use super::Blocks;
use super::energy::Account;
use super::totals::Totals;
use crate::motion::update::Update;
use crate::{Impulses, Motion, PrescribedMotion, Vec3};

impl Blocks {
    /// Holds the prescribed blocks where their motions have them at t = 0, or lets them go on from there. Held, they are at rest.
    pub fn hold_paths(&mut self, are_held: bool) {
        self.state.are_paths_held = are_held;
        for b in 0..self.n_blocks() {
            let Motion::Prescribed(path) = &self.constants.motion[b] else {
                continue;
            };
            let (velocity, spin) = match are_held {
                true => (Vec3::zeros(), Vec3::zeros()),
                false => (path.velocity(0.0), path.spin(0.0)),
            };
            self.state.velocity[b] = velocity;
            self.set_spin(b, &spin);
            self.set_kinematics(b);
        }
    }

    /// Motion that a prescribed block follows now.
    pub(crate) fn followed_path(&self, b: usize) -> Option<&PrescribedMotion> {
        match (self.derived.update[b], &self.constants.motion[b]) {
            (Update::Fixed, Motion::Prescribed(path)) if !self.state.are_paths_held => Some(path),
            _ => None,
        }
    }

    /// Begins all sums anew, as at t = 0: energies lost and brought in, impulses, counts, and the accounts of chosen blocks.
    pub fn begin_sums(&mut self) {
        self.state.totals = Totals::default();
        self.state.accounts.rows.fill(Impulses::default());
        let attachments = &mut self.state.attachments;
        attachments.plastic = Account::default();
        attachments.work = Account::default();
        attachments.joint_correction = Account::default();
    }
}
