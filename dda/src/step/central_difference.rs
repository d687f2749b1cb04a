//! Central differences: kick, drift, kick, with exact rotations.
//!
//! ```text
//! v += dt/2 M⁻¹f;   x += dt v,  Q := Q R;   contacts, f;   v += dt/2 M⁻¹f
//! ```

use crate::blocks::{CHUNK, Constants, Derived, State};
use crate::motion::kinematics::{InternalMotion, Kinematics, Moment};
use crate::motion::rigid::Rigid6;
use crate::motion::update::Update;
use crate::step::damping::local_damping;
use crate::step::phase::Phase;
use crate::{Blocks, Integrator, Load, StaticDamping, StepError, Vec3, chunks};
use nalgebra::{Matrix3, UnitQuaternion};

/// Impulses of half a kick; N s.
#[derive(Clone, Copy, Debug, Default)]
struct Kicked {
    /// Of gravity and of the supports on free blocks.
    impulse: Vec3,
    /// Sum of their sizes.
    exchanged: f64,
}

impl Kicked {
    fn with(self, other: Self) -> Self {
        Self {
            impulse: self.impulse + other.impulse,
            exchanged: self.exchanged + other.exchanged,
        }
    }
}

impl Blocks {
    /// One step from `from` to `to` (s):
    ///
    /// 1. half a kick by the forces of the last step;
    /// 2. drift, with the parts in place;
    /// 3. pairs that are near;
    /// 4. forces of contacts and attachments, and their accounts;
    /// 5. half a kick by them, cut where bodies met or parted within the step;
    /// 6. damping of statics, sleep;
    /// 7. velocities at the end of the step, bound of the next, and guards.
    pub(crate) fn central_difference(
        &mut self,
        (from, to): (f64, f64),
        dt: f64,
        ended: &mut impl FnMut(Phase),
    ) -> Result<(), StepError> {
        self.account_half_kick(dt);
        self.half_kick(dt);
        self.drift(from, to, dt);
        self.move_parts(dt, ended);
        self.evaluate_contacts(dt, ended);
        self.evaluate_attachments(false);
        self.book_external_work(dt);
        self.account_half_kick(dt);
        self.half_kick(dt);
        self.drop_half_kick_corrections();
        self.damp(dt);
        self.rest_or_wake(dt);
        self.set_velocities(to);
        self.renew_bound();
        let checked = self.check(to);
        ended(Phase::Motion);
        checked
    }

    /// Velocities at the end of the step; those of paths are their own.
    pub(crate) fn set_velocities(&mut self, to: f64) {
        for b in 0..self.n_blocks() {
            if let Some(path) = self.followed_path(b) {
                let (velocity, spin) = (path.velocity(to), path.spin(to));
                self.state.velocity[b] = velocity + self.steering(b).1;
                self.set_spin(b, &spin);
                self.set_kinematics(b);
            } else if self.derived.update[b] == Update::Constrained {
                self.set_kinematics(b);
            }
        }
        self.set_plain_velocities();
    }

    fn half_kick(&mut self, dt: f64) {
        let mut kicked = self.kick_plain(dt);
        let outer = self.state.attachments.outer_force * (0.5 * dt);
        kicked.impulse += outer;
        kicked.exchanged += outer.norm();
        for k in 0..self.derived.constrained.len() {
            kicked = kicked.with(self.kick_special(self.derived.constrained[k] as usize, dt));
        }
        self.state.totals.support_impulse += kicked.impulse;
        self.state.totals.impulse_exchanged += kicked.exchanged;
    }

    /// Kicks the plain blocks; the forces on those that stand still are the supports'.
    fn kick_plain(&mut self, dt: f64) -> Kicked {
        let Self {
            state:
                State {
                    velocity,
                    angular_momentum,
                    attitude,
                    contact_load,
                    attachments,
                    ..
                },
            constants: Constants { mass, settings, .. },
            derived: Derived { update, .. },
            ..
        } = self;
        let (attached, gravity) = (&attachments.loads, settings.gravity);
        let heaviness = gravity.norm();
        type Moving<'a> = (&'a mut [Vec3], &'a mut [Vec3]);
        let kick = |first: usize, (velocity, momentum): Moving| {
            let mut kicked = Kicked::default();
            for ((b, velocity), momentum) in (first..).zip(velocity).zip(momentum) {
                if update[b] == Update::Constrained {
                    continue;
                }
                let mut load = contact_load[b];
                if let Some(attached) = attached.get(b) {
                    load += *attached;
                }
                if matches!(update[b], Update::Fixed | Update::Asleep) {
                    kicked.impulse -= load.force * (0.5 * dt);
                    kicked.exchanged += load.force.norm() * (0.5 * dt);
                    continue;
                }
                let weight = gravity * mass[b];
                kicked.impulse += weight * (0.5 * dt);
                kicked.exchanged += heaviness * mass[b] * (0.5 * dt);
                *velocity += (load.force + weight) * (0.5 * dt / mass[b]);
                *momentum += attitude[b].inverse_transform_vector(&load.torque) * (0.5 * dt);
            }
            kicked
        };
        let columns = (velocity.as_mut_slice(), angular_momentum.as_mut_slice());
        chunks::reduce(columns, CHUNK, &kick, &Kicked::with)
    }

    fn kick_special(&mut self, b: usize, dt: f64) -> Kicked {
        let mut load = self.state.contact_load[b];
        if let Some(attached) = self.state.attachments.loads.get(b) {
            load += *attached;
        }
        let weight = self.constants.settings.gravity * self.constants.mass[b];
        load.force += weight;
        let known = load.times(0.5 * dt);
        let momentum = self.accounted_momentum(b);
        let damper = self.local_damper(b, &load);
        load += damper;
        let before = (self.state.velocity[b], self.angular_velocity(b));
        self.kick(b, &load, 0.5 * dt);
        self.hold_velocities(b);
        self.account_restraint(b, momentum, &known);
        let after = (self.state.velocity[b], self.angular_velocity(b));
        // The kick of a force f does the work f·(v + v')/2 dt, exactly.
        self.state.totals.static_damping.book(
            -0.25
                * dt
                * (damper.force.dot(&(before.0 + after.0))
                    + damper.torque.dot(&(before.1 + after.1))),
        );
        Kicked {
            impulse: (weight + damper.force) * (0.5 * dt),
            exchanged: weight.norm() * (0.5 * dt),
        }
    }

    fn local_damper(&self, b: usize, load: &Load) -> Load {
        match self.constants.settings.static_damping {
            Some(StaticDamping::Local(alpha)) => Load {
                force: local_damping(alpha, &load.force, &self.state.velocity[b]),
                torque: local_damping(alpha, &load.torque, &self.angular_velocity(b)),
            },
            _ => Load::default(),
        }
    }

    /// Forces inside and outside act on a free block.
    fn kick(&mut self, b: usize, load: &Load, dt: f64) {
        self.kick_centroid(b, &load.force, dt);
        let torque = load.torque;
        match self.constants.deformable_of[b] {
            None => self.rigid(b).kick(
                &Moment {
                    torque,
                    stretch: Matrix3::zeros(),
                },
                dt,
            ),
            Some(k) => {
                let k = k as usize;
                let mut stretch = self.state.contact_stretch[k];
                if let Some(attached) = self.state.attachments.stretch.get(k) {
                    stretch += attached;
                }
                self.state.deformables[k]
                    .motion()
                    .kick(&Moment { torque, stretch }, dt);
            }
        }
    }

    pub(crate) fn drift(&mut self, from: f64, to: f64, dt: f64) {
        for k in 0..self.derived.constrained.len() {
            let b = self.derived.constrained[k] as usize;
            self.state.centroid[b] += self.state.velocity[b] * dt;
            self.turn(b, dt);
        }
        self.drift_steered(dt);
        for b in 0..self.n_blocks() {
            if let Some(path) = self.followed_path(b) {
                let (before, after) = (path.displacement(from), path.displacement(to));
                let turns = (path.turn(from), path.turn(to));
                let (added, velocity) = self.steering(b);
                self.state.centroid[b] = self.constants.initial_centroid[b] + after + added;
                // Mean over the sub-step, as the half-step velocity of the free blocks is.
                self.state.velocity[b] = (after - before) / dt + velocity;
                let (before, after) = turns;
                self.state.attitude[b] = after * self.constants.principal[b];
                self.set_spin(b, &((after * before.inverse()).scaled_axis() / dt));
            }
        }
        let Self {
            state:
                State {
                    centroid,
                    attitude,
                    angular_momentum,
                    velocity,
                    travel,
                    ..
                },
            constants: Constants {
                inertia, radius, ..
            },
            derived: Derived { update, .. },
            ..
        } = self;
        type Moving<'a> = (
            (&'a mut [Vec3], &'a mut [f64]),
            &'a mut [UnitQuaternion<f64>],
            &'a mut [Vec3],
        );
        let drift = |first: usize, ((centroid, travel), attitude, momentum): Moving| {
            let rows = (first..)
                .zip(centroid)
                .zip(travel)
                .zip(attitude)
                .zip(momentum);
            for ((((b, centroid), travel), attitude), angular_momentum) in rows {
                if update[b] == Update::Rigid {
                    *centroid += velocity[b] * dt;
                    // no rotation of this momentum is faster
                    let fastest = angular_momentum.norm() / inertia[b].min();
                    *travel += dt * (velocity[b].norm() + fastest * radius[b]);
                    Rigid6 {
                        attitude,
                        angular_momentum,
                        inertia: &inertia[b],
                    }
                    .drift(dt);
                }
            }
        };
        let columns = (
            (centroid.as_mut_slice(), travel.as_mut_slice()),
            attitude.as_mut_slice(),
            angular_momentum.as_mut_slice(),
        );
        chunks::for_each(columns, CHUNK, &drift);
    }

    /// Rotates and strains a free block.
    fn turn(&mut self, b: usize, dt: f64) {
        if let Some(k) = self.constants.deformable_of[b] {
            if matches!(
                self.constants.settings.integrator,
                Integrator::ContactDynamics(_)
            ) {
                // has a drift of its own
                return;
            }
            let deformable = &mut self.state.deformables[k as usize];
            deformable.motion().drift(dt);
            self.state
                .totals
                .strain_damping
                .book(deformable.viscous_loss());
            return;
        }
        let is_held = self
            .constants
            .holds
            .get(b)
            .and_then(Option::as_ref)
            .is_some_and(|hold| {
                hold.turn(
                    &mut self.state.attitude[b],
                    &self.constants.inertia[b],
                    &mut self.state.angular_momentum[b],
                    dt,
                )
            });
        if !is_held {
            self.rigid(b).drift(dt);
        }
    }

    /// Velocities of rigid blocks after their last kick; their position is unchanged.
    fn set_plain_velocities(&mut self) {
        let Self {
            state:
                State {
                    kinematics,
                    velocity,
                    angular_momentum,
                    attitude,
                    ..
                },
            constants: Constants { inertia, .. },
            derived: Derived { update, .. },
            ..
        } = self;
        let set = |first: usize, kinematics: &mut [Kinematics]| {
            for (b, kinematics) in (first..).zip(kinematics) {
                if update[b] == Update::Rigid {
                    kinematics.velocity = velocity[b];
                    kinematics.spin = attitude[b] * angular_momentum[b].component_div(&inertia[b]);
                }
            }
        };
        chunks::for_each(kinematics.as_mut_slice(), CHUNK, &set);
    }
}
