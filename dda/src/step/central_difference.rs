//! Time stepping: kick, drift, kick, with exact rotations.
//!
//! ```text
//! v += dt/2 M⁻¹f;   x += dt v,  Q := Q R;   contacts, f;   v += dt/2 M⁻¹f
//! ```

use crate::blocks::{CHUNK, Constants, Derived, State};
use crate::contact::detection::broad_phase;
use crate::contact::detection::broad_phase::Bounds;
use crate::contact::tally::PAIR_CHUNK;
use crate::motion::kinematics::{InternalMotion, Kinematics, Moment, flushed};
use crate::motion::rigid::Rigid6;
use crate::motion::update::Update;
use crate::step::damping::local_damping;
use crate::step::phase::Phase;
use crate::{Blocks, Load, Motion, StaticDamping, StepError, Vec3, chunks};
use nalgebra::{Matrix3, UnitQuaternion};

/// Principal value of Green's strain below which Saint Venant-Kirchhoff's law softens; –.
const CRUSHED: f64 = -0.2;

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
    /// Gives every free block the impulse `loads · dt`, `v += dt M⁻¹ load`: the half kicks of a
    /// fluid. Fixed, prescribed and removed blocks ignore theirs; a deformable one receives force and
    /// torque here, and generalized strain forces by [`Self::apply_stretch`].
    pub fn apply_impulse(&mut self, loads: &[Load], dt: f64) {
        for (b, load) in loads.iter().enumerate().take(self.n_blocks()) {
            self.state.rest.note_outside(b, load);
            if self.state.rest.has(b) {
                // held by its support
                self.state.totals.support_impulse -= load.force * dt;
            } else if self.is_free(b) {
                self.push_block(b, load, dt);
            }
        }
    }

    /// Gives a block at once the impulse of a force and a moment about its centroid; N s, N m s. Those that are not
    /// free ignore it.
    pub fn apply_impulse_to(&mut self, b: usize, impulse: &Load) {
        if self.is_free(b) {
            self.wake_one(b);
            self.push_block(b, impulse, 1.0);
        }
    }

    fn push_block(&mut self, b: usize, load: &Load, dt: f64) {
        self.kick_centroid(b, &load.force, dt);
        let moment = Moment {
            torque: load.torque,
            stretch: Matrix3::zeros(),
        };
        match self.constants.deformable_of[b] {
            None => self.rigid(b).kick(&moment, dt),
            Some(k) => self.state.deformables[k as usize].push(&moment, dt),
        }
        if self.hold_of(b).is_some() {
            let momentum = self.accounted_momentum(b);
            self.hold_velocities(b);
            self.account_restraint(b, momentum, &Load::default());
        }
        self.set_kinematics(b);
    }

    /// Gives a free deformable block the impulse of the straining part `Σ (f ⊗ r + r ⊗ f)/2` (N m) of the
    /// moment of some forces, over `dt` (s); others ignore it.
    pub fn apply_stretch(&mut self, b: usize, stretch: Matrix3<f64>, dt: f64) {
        let Some(k) = self.constants.deformable_of[b].filter(|_| self.is_free(b)) else {
            return;
        };
        let torque = Vec3::zeros();
        self.state.deformables[k as usize].push(&Moment { torque, stretch }, dt);
        self.set_kinematics(b);
    }

    fn kick_centroid(&mut self, b: usize, force: &Vec3, dt: f64) {
        self.state.velocity[b] += force * (dt / self.constants.mass[b]);
    }

    fn rigid(&mut self, b: usize) -> Rigid6<'_> {
        Rigid6 {
            attitude: &mut self.state.attitude[b],
            angular_momentum: &mut self.state.angular_momentum[b],
            inertia: &self.constants.inertia[b],
        }
    }

    /// Removes the constrained velocity; the impulse is that of the supports.
    fn hold_velocities(&mut self, b: usize) {
        let Some(hold) = self.constants.holds.get(b).and_then(Option::as_ref) else {
            return;
        };
        let held = hold.held_part(&self.state.velocity[b]);
        self.state.velocity[b] -= held;
        self.state.totals.support_impulse -= held * self.constants.mass[b];
        hold.hold_turning(
            &self.state.attitude[b],
            &self.constants.inertia[b],
            &mut self.state.angular_momentum[b],
        );
    }

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
                self.sub_step(from, to, dt / n, ended)?;
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

    fn sub_step(
        &mut self,
        from: f64,
        to: f64,
        dt: f64,
        ended: &mut impl FnMut(Phase),
    ) -> Result<(), StepError> {
        self.account_half_kick(dt);
        self.half_kick(dt);
        self.drift(from, to, dt);
        self.place_parts(false);
        ended(Phase::Motion);
        if self.is_skin_used_up() {
            self.find_candidates();
        }
        ended(Phase::BroadPhase);
        self.evaluate_contacts(dt, ended);
        self.evaluate_attachments(false);
        self.book_external_work(dt);
        self.account_half_kick(dt);
        self.half_kick(dt);
        self.drop_excess();
        self.damp(dt);
        self.rest_or_wake(dt);
        for b in 0..self.n_blocks() {
            match (self.derived.update[b], &self.constants.motion[b]) {
                (Update::Fixed, Motion::Prescribed(path)) => {
                    self.state.velocity[b] = path.velocity(to);
                    let spin = path.spin(to);
                    self.set_spin(b, &spin);
                    self.set_kinematics(b);
                }
                (Update::Constrained, _) => self.set_kinematics(b),
                _ => {}
            }
        }
        self.set_plain_velocities();
        let checked = self.check(to);
        ended(Phase::Motion);
        checked
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

    fn drift(&mut self, from: f64, to: f64, dt: f64) {
        for k in 0..self.derived.constrained.len() {
            let b = self.derived.constrained[k] as usize;
            self.state.centroid[b] += self.state.velocity[b] * dt;
            self.turn(b, dt);
        }
        for b in 0..self.n_blocks() {
            if let (Update::Fixed, Motion::Prescribed(path)) =
                (self.derived.update[b], &self.constants.motion[b])
            {
                let (before, after) = (path.displacement(from), path.displacement(to));
                self.state.centroid[b] = self.constants.initial_centroid[b] + after;
                // Mean over the sub-step, as the half-step velocity of the free blocks is.
                self.state.velocity[b] = (after - before) / dt;
                let (before, after) = (path.turn(from), path.turn(to));
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
                    ..
                },
            constants: Constants { inertia, .. },
            derived: Derived { update, .. },
            ..
        } = self;
        type Moving<'a> = (
            &'a mut [Vec3],
            &'a mut [UnitQuaternion<f64>],
            &'a mut [Vec3],
        );
        let drift = |first: usize, (centroid, attitude, momentum): Moving| {
            let rows = (first..).zip(centroid).zip(attitude).zip(momentum);
            for (((b, centroid), attitude), angular_momentum) in rows {
                if update[b] == Update::Rigid {
                    *centroid += velocity[b] * dt;
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
            centroid.as_mut_slice(),
            attitude.as_mut_slice(),
            angular_momentum.as_mut_slice(),
        );
        chunks::for_each(columns, CHUNK, &drift);
    }

    /// Gives a block an angular velocity (rad/s).
    pub(crate) fn set_spin(&mut self, b: usize, spin: &Vec3) {
        let spin_rel = self.state.attitude[b].inverse_transform_vector(spin);
        self.state.angular_momentum[b] = spin_rel.component_mul(&self.constants.inertia[b]);
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

    /// Rotates and strains a free block.
    fn turn(&mut self, b: usize, dt: f64) {
        if let Some(k) = self.constants.deformable_of[b] {
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

    /// Damping that scales velocities, if the settings ask for it.
    fn damp(&mut self, dt: f64) {
        let Some(damping) = self.constants.settings.static_damping else {
            return;
        };
        let factor = damping.velocity_factor(dt);
        if factor == 1.0 {
            return;
        }
        for b in 0..self.n_blocks() {
            if !self.is_free(b) {
                continue;
            }
            self.state
                .totals
                .static_damping
                .book((1.0 - factor * factor) * self.kinetic_energy(b));
            self.state.totals.support_impulse +=
                self.state.velocity[b] * (self.constants.mass[b] * (factor - 1.0));
            let momentum = self.accounted_momentum(b);
            self.state.velocity[b].apply(|c| *c = flushed(*c * factor));
            match self.constants.deformable_of[b] {
                None => self.rigid(b).scale_velocities(factor),
                Some(k) => self.state.deformables[k as usize]
                    .motion()
                    .scale_velocities(factor),
            }
            self.account_restraint(b, momentum, &Load::default());
        }
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

    /// Work of prescribed blocks on free ones over the sub-step, force at its two ends.
    fn book_external_work(&mut self, dt: f64) {
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

    fn check(&self, time: f64) -> Result<(), StepError> {
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
            return Err(StepError::NotFinite { block, time });
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
                    block,
                    strain,
                    limit: CRUSHED,
                    time,
                });
            }
        }
        let (over_allowed, parts) = self.state.worst_overlap;
        if over_allowed > 1.0 {
            let parts = [parts.0 as usize, parts.1 as usize];
            let least = |of: &[f64]| of[parts[0]].min(of[parts[1]]);
            let allowed = least(&self.constants.deepest_allowed);
            return Err(StepError::Overlap {
                first: self.constants.block_of_part[parts[0]] as usize,
                second: self.constants.block_of_part[parts[1]] as usize,
                overlap: over_allowed * allowed,
                size: least(&self.constants.size),
                allowed,
                time,
            });
        }
        Ok(())
    }
}
