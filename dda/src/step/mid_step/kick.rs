//! The kick of a step: weight, attachments, impulses from outside, joints and contacts, with their accounts.
//!
//! Work of an impulse is that with the mean of the velocities before and after the kick, so that the account of energy closes to round-off
//! but for the turning of blocks: tangential work of contacts is friction, normal work damping.

use super::closing::Closing;
use super::joints::{JointRow, laws};
use super::touches::Touch;
use crate::blocks::{ContactDynamics, Update};
use crate::contact::dynamics::ContactProblem;
use crate::contact::dynamics::accuracy::Scaling;
use crate::contact::dynamics::delassus::{BodyContacts, Delassus, Point};
use crate::contact::dynamics::gauss_seidel::Until;
use crate::contact::dynamics::kept::ContactSolution;
use crate::contact::dynamics::solver;
use crate::error::OpenJoint;
use crate::{Blocks, Load, Motion, Vec3};

/// Residual above which a step counts as unsolved; –.
const UNSOLVED: f64 = 1e-2;

impl Blocks {
    /// Impulse on a free block within `dt` (s) of its weight, its attachments, and of what acted from outside since the last step; that of
    /// joints, too, once they are solved; N s, N m s.
    pub(super) fn impulse_without_contacts(&self, b: usize, dt: f64) -> Load {
        let mut impulse = Load {
            force: self.constants.settings.gravity * (self.constants.mass[b] * dt),
            torque: Vec3::zeros(),
        };
        if let Some(attached) = self.state.attachments.loads.get(b) {
            impulse += attached.times(dt);
        }
        if let Some(outside) = self.state.outside.get(b) {
            impulse += *outside;
        }
        impulse
    }

    /// Kick over `dt` (s); tells of a joint that stays open.
    pub(super) fn kick_with_contacts(
        &mut self,
        (closing, joints): (Closing, &[JointRow]),
        dynamics: &ContactDynamics,
        dt: f64,
    ) -> Option<OpenJoint> {
        let Closing {
            bodies,
            gains,
            touches,
            points,
            before,
            gained,
            free,
        } = closing;
        let n_contacts = touches.len();
        let mut impulses = self.impulses_before(&touches, &points, dt);
        impulses.extend(self.joint_impulses_before(joints, &points[n_contacts..], dt));
        let operator = BodyContacts::new(bodies, points.clone());
        let problem = ContactProblem {
            friction: touches.iter().map(|touch| touch.friction).collect(),
            free_velocity: free,
            joints: laws(joints, n_contacts, &operator),
            operator,
        };
        let until = Until {
            tolerance: dynamics.tolerance,
            scaling: Scaling::ContactMass,
            n_iterations: dynamics.n_iterations,
        };
        let ended = solver::solve(&problem, &mut impulses, until);
        let given = problem.operator.product(&impulses);
        let solution = ContactSolution {
            n_contacts,
            n_iterations: ended.n_iterations,
            residual: ended.residual,
        };
        let kicked = |a: usize| problem.operator.velocity(&given, a);
        let of_joints = &impulses[n_contacts..];
        let after: Vec<Vec3> = (n_contacts..problem.len())
            .map(|a| problem.free_velocity[a] + kicked(a))
            .collect();
        let open = self.open_joint(joints, &problem.joints, (of_joints, &after), dt);
        self.state.attachments.has_open_joint = open.is_some();
        self.note_solution(solution);
        let mean: Vec<Vec3> = (0..problem.len())
            .map(|a| before[a] + (kicked(a) + gained[a]) * 0.5)
            .collect();
        let rows = (&points[n_contacts..], of_joints, &mean[n_contacts..]);
        self.keep_joints(joints, rows, dt);
        self.keep_impulses(&touches, &points, &impulses, dt);
        self.set_contact_loads(&touches, &points, &impulses, dt);
        self.book_contacts(&impulses[..n_contacts], &mean);
        self.kick_bodies(&gains, &given, dt);
        self.remove_overlap(&problem, &touches);
        open
    }

    /// Books the work of contacts at the mean velocities of the kick.
    fn book_contacts(&mut self, impulses: &[Vec3], mean: &[Vec3]) {
        let [mut friction, mut damping] = [0.0; 2];
        for (impulse, mean) in impulses.iter().zip(mean) {
            damping -= impulse.x * mean.x;
            friction -= impulse.y * mean.y + impulse.z * mean.z;
        }
        let totals = &mut self.state.totals;
        totals.damping.book(damping);
        totals.friction.book(friction);
        totals.n_contact_updates += impulses.len() as u64;
    }

    fn note_solution(&mut self, solution: ContactSolution) {
        self.state.solution = solution;
        let is_unsolved = UNSOLVED < solution.residual || self.state.attachments.has_open_joint;
        let totals = &mut self.state.totals;
        totals.n_unsolved += u64::from(is_unsolved);
        totals.n_unsolved_running = match is_unsolved {
            true => totals.n_unsolved_running + 1,
            false => 0,
        };
        totals.n_iterations += solution.n_iterations as u64;
        totals.most_iterations = totals.most_iterations.max(solution.n_iterations);
        totals.most_solved_contacts = totals.most_solved_contacts.max(solution.n_contacts);
        totals.largest_residual = totals.largest_residual.max(solution.residual);
    }

    /// Mean loads of contacts in the step, on all blocks, with the impulses and the work of those that forces do not move.
    fn set_contact_loads(
        &mut self,
        touches: &[Touch],
        points: &[Point],
        impulses: &[Vec3],
        dt: f64,
    ) {
        self.state.contact_load.fill(Load::default());
        for ((touch, point), impulse) in touches.iter().zip(points).zip(impulses) {
            let force = point.frame * impulse / dt;
            for (block, force) in touch.blocks.into_iter().zip([-force, force]) {
                let b = block as usize;
                let arm = touch.position - self.state.kinematics[b].centroid;
                self.state.contact_load[b].add(&force, &arm);
            }
        }
        self.account_half_kick(2.0 * dt);
        let outer = self.state.attachments.outer_force * dt;
        self.state.totals.support_impulse += outer;
        self.state.totals.impulse_exchanged += outer.norm();
        for b in 0..self.n_blocks() {
            if self.is_driven(b) {
                let weight = self.constants.settings.gravity * self.constants.mass[b];
                self.state.totals.support_impulse += weight * dt;
                self.state.totals.impulse_exchanged += weight.norm() * dt;
                continue;
            }
            let mut load = self.state.contact_load[b];
            if let Some(attached) = self.state.attachments.loads.get(b) {
                load += *attached;
            }
            self.state.totals.support_impulse -= load.force * dt;
            self.state.totals.impulse_exchanged += load.force.norm() * dt;
            if matches!(self.constants.motion[b], Motion::Prescribed(_)) {
                let body = &self.state.kinematics[b];
                let power = load.force.dot(&body.velocity) + load.torque.dot(&body.spin);
                self.state.totals.external_work.book(-power * dt);
            }
        }
    }

    /// Velocities of free blocks after the kick: `gains` without contacts, `given` by them (m/s, rad/s). A hold takes its part of it.
    fn kick_bodies(&mut self, gains: &[[Vec3; 2]], given: &[[Vec3; 2]], dt: f64) {
        for (b, (gain, given)) in gains.iter().zip(given).enumerate() {
            match self.derived.update[b] {
                Update::Rigid => {
                    self.state.velocity[b] += gain[0] + given[0];
                    let spin = gain[1] + given[1];
                    let turned = self.state.attitude[b].inverse_transform_vector(&spin);
                    self.state.angular_momentum[b] +=
                        turned.component_mul(&self.constants.inertia[b]);
                }
                Update::Constrained => self.kick_held(b, dt),
                Update::Fixed | Update::Asleep => {}
            }
        }
        self.state.outside.fill(Load::default());
    }

    fn kick_held(&mut self, b: usize, dt: f64) {
        let mut impulse = self.impulse_without_contacts(b, dt);
        impulse += self.state.contact_load[b].times(dt);
        let momentum = self.accounted_momentum(b);
        self.state.velocity[b] += impulse.force / self.constants.mass[b];
        let moment = self.state.attitude[b].inverse_transform_vector(&impulse.torque);
        self.state.angular_momentum[b] += moment;
        self.hold_velocities(b);
        self.account_restraint(b, momentum, &impulse);
    }
}
