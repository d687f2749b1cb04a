//! Impulses on blocks: from outside, and the small parts that every integrator shares.

use crate::motion::kinematics::{InternalMotion, Moment};
use crate::motion::rigid::Rigid6;
use crate::{Blocks, Load, Vec3};
use nalgebra::Matrix3;

impl Blocks {
    /// Gives every free block the impulse `loads · dt`, `v += dt M⁻¹ load`: the half kicks of a
    /// fluid. Fixed, prescribed and removed blocks ignore theirs; a deformable one receives force and
    /// torque here, and generalized strain forces by [`Self::apply_stretch`]. Contact dynamics keeps the impulse for the middle of
    /// its next step, where contacts answer to it.
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

    /// Gives a block at once the impulse of a force and a moment about its centroid (N s, N m s), and returns its work (J). Blocks that
    /// are not free ignore it. Contact dynamics gives it in the middle of its next step; its work is that at the velocities of now.
    pub fn apply_impulse_to(&mut self, b: usize, impulse: &Load) -> f64 {
        if !self.is_free(b) {
            return 0.0;
        }
        self.wake_one(b);
        if self.state.outside.is_empty() {
            let before = self.kinetic_energy(b);
            self.push_block(b, impulse, 1.0);
            return self.kinetic_energy(b) - before;
        }
        let [velocity, spin] = self.velocity_with_outside(b);
        self.push_block(b, impulse, 1.0);
        let [pushed, turned] = self.velocity_with_outside(b);
        0.5 * (impulse.force.dot(&(velocity + pushed)) + impulse.torque.dot(&(spin + turned)))
    }

    /// Velocity and angular velocity of a block with what acted on it from outside since its last step of contact dynamics; m/s, rad/s.
    pub fn velocity_with_outside(&self, b: usize) -> [Vec3; 2] {
        let now = [self.velocity(b), self.angular_velocity(b)];
        match self.state.outside.get(b).filter(|_| self.is_free(b)) {
            None => now,
            Some(outside) => {
                let inverse = match self.constants.deformable_of[b] {
                    None => self.state.kinematics[b].inverse_inertia,
                    Some(k) => self.state.deformables[k as usize].body().inverse_inertia(),
                };
                let held = self.hold_of(b).map(|hold| hold.held_part(&outside.force));
                let given = (outside.force - held.unwrap_or_default()) / self.constants.mass[b];
                [now[0] + given, now[1] + inverse * outside.torque]
            }
        }
    }

    fn push_block(&mut self, b: usize, load: &Load, dt: f64) {
        if let Some(outside) = self.state.outside.get_mut(b) {
            *outside += load.times(dt);
            return;
        }
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
    /// moment of some forces, over `dt` (s); others ignore it. Contact dynamics keeps it like the impulse.
    pub fn apply_stretch(&mut self, b: usize, stretch: Matrix3<f64>, dt: f64) {
        let Some(k) = self.constants.deformable_of[b].filter(|_| self.is_free(b)) else {
            return;
        };
        if let Some(outside) = self.state.outside_stretch.get_mut(k as usize) {
            *outside += stretch * dt;
            return;
        }
        let torque = Vec3::zeros();
        self.state.deformables[k as usize].push(&Moment { torque, stretch }, dt);
        self.set_kinematics(b);
    }

    pub(crate) fn kick_centroid(&mut self, b: usize, force: &Vec3, dt: f64) {
        self.state.velocity[b] += force * (dt / self.constants.mass[b]);
    }

    pub(crate) fn rigid(&mut self, b: usize) -> Rigid6<'_> {
        Rigid6 {
            attitude: &mut self.state.attitude[b],
            angular_momentum: &mut self.state.angular_momentum[b],
            inertia: &self.constants.inertia[b],
        }
    }

    /// Removes the constrained velocity; the impulse is that of the supports.
    pub(crate) fn hold_velocities(&mut self, b: usize) {
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

    /// Gives a block an angular velocity (rad/s).
    pub(crate) fn set_spin(&mut self, b: usize, spin: &Vec3) {
        let spin_rel = self.state.attitude[b].inverse_transform_vector(spin);
        self.state.angular_momentum[b] = spin_rel.component_mul(&self.constants.inertia[b]);
    }
}
