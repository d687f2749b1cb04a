//! The kick of a step: weight, attachments, impulses from outside and contacts, with their accounts.
//!
//! Work of an impulse is that with the mean of the velocities before and after the kick, so that the account of energy closes to round-off
//! but for the turning of blocks: tangential work of contacts is friction, normal work damping.

use super::closing::{Closing, JointRow};
use super::touches::Touch;
use crate::blocks::{ContactDynamics, Update};
use crate::contact::dynamics::accuracy::{Scaling, energy_error};
use crate::contact::dynamics::bodies::{BodyVelocities, Point};
use crate::contact::dynamics::delassus::{BodyContacts, Delassus};
use crate::contact::dynamics::gauss_seidel::Until;
use crate::contact::dynamics::kept::{ContactSolution, KeptImpulse};
use crate::contact::dynamics::solver;
use crate::contact::dynamics::{ContactProblem, Rolling, UNSOLVED};
use crate::error::OpenJoint;
use crate::{Blocks, Load, Motion, Vec3};
use nalgebra::Matrix3;

/// Contacts, bonds and joints of a step with their impulses.
struct Solved {
    problem: ContactProblem<BodyContacts>,
    solution: ContactSolution,
    /// One per row; N s.
    impulses: Vec<Vec3>,
    /// Mean velocity of each row in the kick; m/s.
    mean: Vec<Vec3>,
    /// Velocities that the impulses give bodies.
    given: BodyVelocities,
    /// What bonds carry.
    carried: Vec<KeptImpulse>,
    /// As those of [`Closing`].
    gains: BodyVelocities,
    touches: Vec<Touch>,
    points: Vec<Point>,
    joints: Vec<JointRow>,
}

impl Solved {
    /// First row of the joints.
    fn first_of_joints(&self) -> usize {
        self.points.len() - self.joints.len()
    }
}

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

    /// Kick over `dt` (s), solved again if bonds break by it; tells of a joint that stays open.
    pub(super) fn kick_with_contacts(
        &mut self,
        closing: Closing,
        dynamics: &ContactDynamics,
        dt: f64,
    ) -> Option<OpenJoint> {
        let mut solved = self.solve(closing, dynamics, dt);
        if solved.solution.residual <= UNSOLVED && self.break_bonds(&solved.carried) {
            let touches = self.touches(dt);
            solved = self.solve(self.closing(touches, dt), dynamics, dt);
        }
        let open = self.open_joint_of(&solved, dt);
        self.state.attachments.has_open_joint = open.is_some();
        self.state.solution = solved.solution;
        let solution = &solved.solution;
        self.state.totals.solved.count(solution, open.is_some());
        self.book_work(&solved);
        self.keep_joints_of(&solved, dt);
        let Solved {
            problem,
            impulses,
            touches,
            points,
            ..
        } = &solved;
        let rows = touches.len()..touches.len() + problem.rolling.len();
        let torques = torques(&problem.rolling, &points[rows.clone()], &impulses[rows]);
        self.keep_impulses(touches, points, impulses, &torques, dt);
        self.keep_carried(&solved.carried);
        self.sum_contact_loads();
        self.account_contact_loads(dt);
        self.kick_bodies(&solved.gains, &solved.given, dt);
        self.remove_overlap(&solved.problem, &solved.touches);
        open
    }

    /// Impulses of contacts, bonds and joints.
    fn solve(&self, closing: Closing, dynamics: &ContactDynamics, dt: f64) -> Solved {
        let mut impulses = self.impulses_before(&closing, dt);
        let Closing {
            bodies,
            gains,
            touches,
            points,
            rolling,
            joints,
            before,
            gained,
            free,
        } = closing;
        let n_bounded = touches.len() + rolling.len();
        let operator = BodyContacts::new(bodies, points.clone());
        let problem = ContactProblem {
            friction: touches.iter().map(|touch| touch.friction).collect(),
            free_velocity: free,
            rolling,
            joints: Self::laws(&joints, n_bounded, &operator),
            operator,
        };
        let until = Until {
            tolerance: dynamics.tolerance,
            scaling: Scaling::ContactMass,
            n_iterations: dynamics.n_iterations,
        };
        let ended = solver::solve_by(dynamics.solver, &problem, &mut impulses, until);
        let given = problem.operator.product(&impulses);
        let is_ambiguous = |&a: &usize| 0.0 < impulses[a].x && problem.is_above_painleve(a);
        let mean = |a: usize| before[a] + (problem.operator.velocity(&given, a) + gained[a]) * 0.5;
        Solved {
            solution: ContactSolution {
                n_contacts: touches.len(),
                n_iterations: ended.n_iterations,
                residual: ended.residual,
                energy_error: energy_error(&problem, (&impulses, &given)),
                n_above_painleve: (0..touches.len()).filter(is_ambiguous).count(),
            },
            mean: (0..problem.len()).map(mean).collect(),
            given,
            carried: self.carried((&points, &impulses), n_bounded, dt),
            problem,
            impulses,
            gains,
            touches,
            points,
            joints,
        }
    }

    fn open_joint_of(&self, solved: &Solved, dt: f64) -> Option<OpenJoint> {
        let first = solved.first_of_joints();
        let problem = &solved.problem;
        let after: Vec<Vec3> = (first..problem.len())
            .map(|a| problem.free_velocity[a] + problem.operator.velocity(&solved.given, a))
            .collect();
        let laws = &problem.joints[problem.joints.len() - solved.joints.len()..];
        self.open_joint(
            &solved.joints,
            laws,
            (&solved.impulses[first..], &after),
            dt,
        )
    }

    fn keep_joints_of(&mut self, solved: &Solved, dt: f64) {
        let first = solved.first_of_joints();
        let Solved {
            points,
            impulses,
            mean,
            ..
        } = solved;
        let rows = (&points[first..], &impulses[first..], &mean[first..]);
        self.keep_joints(&solved.joints, rows, dt);
    }

    /// Work of contacts, of rolling and twisting resistance, and of bonds, which is damping; joints book their own.
    fn book_work(&mut self, solved: &Solved) {
        let n_bounded = solved.touches.len() + solved.problem.rolling.len();
        let [mut friction, mut damping] = [0.0; 2];
        let rows = solved.impulses.iter().zip(&solved.mean).enumerate();
        for (a, (impulse, mean)) in rows.take(solved.first_of_joints()) {
            if n_bounded <= a {
                damping -= impulse.dot(mean);
                continue;
            }
            let along_normal = impulse.x * mean.x;
            // of a contact a hit, else twisting
            match a < solved.touches.len() {
                true => damping -= along_normal,
                false => friction -= along_normal,
            }
            friction -= impulse.y * mean.y + impulse.z * mean.z;
        }
        let totals = &mut self.state.totals;
        totals.damping.book(damping);
        totals.friction.book(friction);
        totals.n_contact_updates += solved.touches.len() as u64;
    }

    /// Mean loads of contacts and bonds in the step, on all blocks.
    fn sum_contact_loads(&mut self) {
        self.state.contact_load.fill(Load::default());
        for kept in &self.state.impulses {
            let (force, torque) = (kept.impulse / kept.dt, kept.torque / kept.dt);
            let (first, second) = kept.blocks;
            for (block, force, torque) in [(first, -force, -torque), (second, force, torque)] {
                let b = block as usize;
                let arm = kept.position - self.state.kinematics[b].centroid;
                self.state.contact_load[b].add(&force, &arm);
                self.state.contact_load[b].torque += torque;
            }
        }
    }

    /// Impulses of contacts on blocks that forces do not move, with their work.
    fn account_contact_loads(&mut self, dt: f64) {
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

    /// Velocities of free blocks after the kick: `gains` without contacts, `given` by them. A hold takes its part of it.
    fn kick_bodies(&mut self, gains: &BodyVelocities, given: &BodyVelocities, dt: f64) {
        for (b, (gain, of_contacts)) in gains.rigid.iter().zip(&given.rigid).enumerate() {
            match (self.derived.update[b], self.constants.deformable_of[b]) {
                (Update::Rigid, _) => {
                    self.state.velocity[b] += gain[0] + of_contacts[0];
                    let spin = gain[1] + of_contacts[1];
                    let turned = self.state.attitude[b].inverse_transform_vector(&spin);
                    self.state.angular_momentum[b] +=
                        turned.component_mul(&self.constants.inertia[b]);
                }
                (Update::Constrained, None) => self.kick_held(b, dt),
                (Update::Constrained, Some(k)) => {
                    self.kick_straining((b, k as usize), gains, given, dt);
                }
                (Update::Fixed | Update::Asleep, _) => {}
            }
        }
        self.state.outside.fill(Load::default());
        self.state.outside_stretch.fill(Matrix3::zeros());
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

/// Contacts that resist rolling or twisting, and their torques on B (N m s), of their rows.
fn torques(rolling: &[Rolling], points: &[Point], impulses: &[Vec3]) -> Vec<(u32, Vec3)> {
    (rolling.iter().zip(points.iter().zip(impulses)))
        .map(|(rolling, (point, impulse))| (rolling.contact, point.frame * impulse))
        .collect()
}
