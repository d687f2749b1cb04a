//! Impulses on chosen blocks by source: booked half a kick at a time.

use crate::{Blocks, Impulses, Load, Motion};

impl Blocks {
    /// Keeps accounts of some blocks: those open go on, all others end.
    pub fn keep_accounts(&mut self, blocks: &[usize]) {
        let mut chosen: Vec<u32> = blocks.iter().map(|&b| b as u32).collect();
        chosen.sort_unstable();
        chosen.dedup();
        let row = |&b: &u32| self.account(b as usize).copied().unwrap_or_default();
        self.state.accounts.rows = chosen.iter().map(row).collect();
        self.state.accounts.blocks = chosen;
    }

    /// Impulses on a block of which an account is kept.
    pub fn account(&self, b: usize) -> Option<&Impulses> {
        let k = self.state.accounts.blocks.binary_search(&(b as u32)).ok()?;
        self.state.accounts.rows.get(k)
    }

    /// Books half a kick of contacts, attachments and gravity; `dt` (s) is that of the whole kick.
    pub(crate) fn account_half_kick(&mut self, dt: f64) {
        let half = 0.5 * dt;
        for k in 0..self.state.accounts.blocks.len() {
            let b = self.state.accounts.blocks[k] as usize;
            let is_free = self.is_free(b);
            let row = &mut self.state.accounts.rows[k];
            row.contact += self.state.contact_load[b].times(half);
            if !is_free {
                continue;
            }
            if let Some(attached) = self.state.attachments.loads.get(b) {
                row.attached += attached.times(half);
            }
            row.gravity += self.constants.settings.gravity * (self.constants.mass[b] * half);
        }
    }

    /// Momentum and angular momentum about the centroid of a block of which an account is kept; kg m/s, kg m²/s.
    pub(crate) fn accounted_momentum(&self, b: usize) -> Option<Load> {
        self.state.accounts.blocks.binary_search(&(b as u32)).ok()?;
        Some(Load {
            force: self.state.velocity[b] * self.constants.mass[b],
            torque: self.spin_momentum(b),
        })
    }

    /// Books the change of momentum since `before` that an impulse `given` does not explain.
    pub(crate) fn account_restraint(&mut self, b: usize, before: Option<Load>, given: &Load) {
        let (Some(before), Some(after)) = (before, self.accounted_momentum(b)) else {
            return;
        };
        if let Ok(k) = self.state.accounts.blocks.binary_search(&(b as u32)) {
            let row = &mut self.state.accounts.rows[k].restrained;
            row.force += after.force - before.force - given.force;
            row.torque += after.torque - before.torque - given.torque;
        }
    }

    /// Work of prescribed blocks on free ones over the sub-step, force at its two ends.
    pub(crate) fn book_external_work(&mut self, dt: f64) {
        for b in 0..self.n_blocks() {
            if matches!(self.constants.motion[b], Motion::Prescribed(_)) {
                let (now, before) = (
                    &self.state.contact_load[b],
                    &self.state.contact_load_before[b],
                );
                let power = (now.force + before.force).dot(&self.state.velocity[b])
                    + (now.torque + before.torque).dot(&self.angular_velocity(b));
                self.state.totals.external_work.book(-0.5 * power * dt);
            }
        }
    }
}
