//! Blocks at rest sleep: they keep their position, and their contacts with other blocks at rest, until their load changes.
//!
//! A block is put to sleep when it has not moved for a while, even if it vibrates under fluctuating loads, mainly of water. Its
//! residual kinetic energy is booked. Its load is monitored as a mean over a short time, since single kicks fluctuate:
//!
//! ```text
//! L += (F − L) dt/τ,      asleep until |L_f − L_f0| > s m g  or  |L_t − L_t0| > s m g R           [N, N m]
//! ```
//! A load includes contacts, attachments and external impulses (`apply_impulse`). Sleeping blocks support each other and blocks on
//! them as fixed blocks do, so that a block pushed out from under others wakes them by the loss of support.

use crate::blocks::Rest;
use crate::motion::update::Update;
use crate::{Blocks, Load, Vec3};

/// Averaging time of the monitored load, × time at rest before sleep; –.
const MEAN_OVER: f64 = 0.05;

impl Blocks {
    /// Initializes sleep: all blocks are awake, and may sleep if enabled, except deformable, held and statically damped ones.
    pub(crate) fn begin_rest(&mut self) {
        if self.constants.settings.resting.is_none() {
            return;
        }
        let n = self.n_blocks();
        self.state.rest = Rest {
            is_asleep: vec![false; n],
            since: self
                .state
                .centroid
                .iter()
                .copied()
                .zip(self.state.attitude.iter().copied())
                .collect(),
            time_at_rest: vec![0.0; n],
            mean: vec![Load::default(); n],
            at_rest: vec![Load::default(); n],
            outside: vec![Load::default(); n],
        };
    }

    /// Number of sleeping blocks.
    pub fn n_asleep(&self) -> usize {
        self.state.rest.is_asleep.iter().filter(|&&is| is).count()
    }

    /// Wakes all blocks.
    pub(crate) fn wake_all(&mut self) {
        for b in 0..self.state.rest.is_asleep.len() {
            self.wake(b);
        }
        self.sort_by_update();
    }

    pub(crate) fn wake_one(&mut self, b: usize) {
        if self.state.rest.has(b) {
            self.wake(b);
            self.sort_by_update();
        }
    }

    fn wake(&mut self, b: usize) {
        self.state.rest.is_asleep[b] = false;
        self.state.rest.time_at_rest[b] = 0.0;
        self.state.rest.since[b] = (self.state.centroid[b], self.state.attitude[b]);
    }

    /// Puts blocks to sleep that have been at rest for long enough, and wakes those whose load has changed, at the end of a step.
    pub(crate) fn rest_or_wake(&mut self, dt: f64) {
        let Some(resting) = self.constants.settings.resting else {
            return;
        };
        let share = (dt / (MEAN_OVER * resting.time)).min(1.0);
        let mut has_changed = false;
        for b in 0..self.n_blocks() {
            if !matches!(self.derived.update[b], Update::Rigid | Update::Asleep) {
                continue;
            }
            let mut load = self.state.contact_load[b];
            let is_free_flight = load.force == Vec3::zeros();
            if let Some(attached) = self.state.attachments.loads.get(b) {
                load += *attached;
            }
            load += self.state.rest.outside[b];
            let mean = &mut self.state.rest.mean[b];
            mean.force += (load.force - mean.force) * share;
            mean.torque += (load.torque - mean.torque) * share;
            if self.state.rest.is_asleep[b] {
                let at_rest = &self.state.rest.at_rest[b];
                let much =
                    resting.load * self.constants.mass[b] * self.constants.settings.gravity.norm();
                let is_pushed = (mean.force - at_rest.force).norm() > much
                    || (mean.torque - at_rest.torque).norm() > much * self.constants.radius[b];
                if is_pushed {
                    self.wake(b);
                    has_changed = true;
                }
                continue;
            }
            let (place, attitude) = &self.state.rest.since[b];
            let way = (self.state.centroid[b] - place).norm()
                + attitude.angle_to(&self.state.attitude[b]) * self.constants.radius[b];
            let size = self.constants.size[self.constants.part_start[b] as usize];
            if is_free_flight || way > resting.displacement * size {
                self.wake(b);
                continue;
            }
            self.state.rest.time_at_rest[b] += dt;
            if self.state.rest.time_at_rest[b] >= resting.time {
                self.put_to_sleep(b);
                has_changed = true;
            }
        }
        if has_changed {
            self.sort_by_update();
        }
    }

    fn put_to_sleep(&mut self, b: usize) {
        self.state.totals.sleep_loss.book(self.kinetic_energy(b));
        self.state.totals.support_impulse -= self.state.velocity[b] * self.constants.mass[b];
        self.state.velocity[b] = Vec3::zeros();
        self.state.angular_momentum[b] = Vec3::zeros();
        self.set_kinematics(b);
        self.state.rest.is_asleep[b] = true;
        self.state.rest.at_rest[b] = self.state.rest.mean[b];
    }
}
