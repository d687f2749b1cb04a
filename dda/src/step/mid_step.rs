//! Contact dynamics: drift, kick with all contacts solved together, drift.
//!
//! ```text
//! q(mid) = q + dt/2 u                        rotations free and exact, as in central differences
//! u(free) = u + dt g;   b = H u(free) + s n;   R from the laws of contact;   u := u(free) + M⁻¹ Hᵀ R
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
//! What overlap remains goes out as a displacement, not as a velocity, see [`overlap`]. Work of contacts is that of the mean velocity
//! in the kick, so that the account of energy closes to round-off but for the turning of blocks: tangential work is friction, normal work
//! damping.
//!
//! Sources: Moreau (1999), Jean (1999).

mod overlap;
mod touches;

use crate::blocks::{ContactDynamics, Update};
use crate::contact::dynamics::ContactProblem;
use crate::contact::dynamics::accuracy::Scaling;
use crate::contact::dynamics::delassus::{Arm, Body, BodyContacts, Delassus, Point};
use crate::contact::dynamics::gauss_seidel::Until;
use crate::contact::dynamics::kept::{ContactSolution, KeptImpulse};
use crate::contact::dynamics::solver;
use crate::contact::report::ContactState;
use crate::step::phase::Phase;
use crate::{Blocks, Load, Motion, StepError, Vec3};
use touches::Touch;

/// Residual above which a step counts as unsolved; –.
const UNSOLVED: f64 = 1e-2;
/// Impact speed below which there is no restitution, over `g dt`.
const SLOW: f64 = 5.0;
/// Distance from the friction bound within which a point slides, × the bound.
const AT_THE_BOUND: f64 = 1e-9;
/// Gap up to which parts touch, × size of the smaller one. Without it the corners of a column at rest close gaps of round-off in turn, and a
/// step takes three times the iterations.
const TOUCHING: f64 = 1e-6;

/// Points that may bear an impulse in a step.
struct Closing {
    touches: Vec<Touch>,
    points: Vec<Point>,
    /// `U` at the points before the kick, of all bodies; m/s.
    before: Vec<Vec3>,
    /// `b`, with the shift; m/s.
    free: Vec<Vec3>,
}

/// State of a point with an impulse in its frame.
fn state_of(friction: f64, impulse: &Vec3) -> ContactState {
    let bound = friction * impulse.x;
    if impulse.x <= 0.0 {
        ContactState::Open
    } else if impulse.y.hypot(impulse.z) < bound * (1.0 - AT_THE_BOUND) {
        ContactState::Stick
    } else {
        ContactState::Slide
    }
}

impl Blocks {
    /// Contacts of the last step of contact dynamics.
    pub fn contact_solution(&self) -> ContactSolution {
        self.state.solution
    }

    /// Steps of contact dynamics whose contacts were left with a residual above 1e-2, since t = 0.
    pub fn unsolved_steps(&self) -> u64 {
        self.state.totals.n_unsolved
    }

    /// One step from `from` to `to` (s):
    ///
    /// 1. half a drift, with the parts in place;
    /// 2. pairs and points that are near;
    /// 3. kick by gravity and by the impulses of contacts, with their accounts;
    /// 4. overlap is removed;
    /// 5. half a drift, velocities at the end of the step, guards.
    pub(crate) fn mid_step(
        &mut self,
        (from, to): (f64, f64),
        dynamics: &ContactDynamics,
        ended: &mut impl FnMut(Phase),
    ) -> Result<(), StepError> {
        let (dt, middle) = (to - from, 0.5 * (from + to));
        self.drift(from, middle, 0.5 * dt);
        self.move_parts(ended);
        self.set_mean_velocities(middle, dt);
        let touches = self.touches(dt);
        let closing = self.closing(touches, dt);
        ended(Phase::Contacts);
        self.kick_with_contacts(closing, dynamics, dt);
        ended(Phase::Sums);
        self.drift(middle, to, 0.5 * dt);
        self.place_parts(false);
        self.set_velocities(to);
        let checked = self.check(to);
        ended(Phase::Motion);
        checked
    }

    /// Velocities of prescribed blocks from this middle of a step to the next one.
    fn set_mean_velocities(&mut self, middle: f64, dt: f64) {
        for b in 0..self.n_blocks() {
            if let (Update::Fixed, Motion::Prescribed(path)) =
                (self.derived.update[b], &self.constants.motion[b])
            {
                let next = middle + dt;
                let way = path.displacement(next) - path.displacement(middle);
                let turn = path.turn(next) * path.turn(middle).inverse();
                self.state.velocity[b] = way / dt;
                self.set_spin(b, &(turn.scaled_axis() / dt));
                self.set_kinematics(b);
            }
        }
    }

    /// Points of which the gap is closed or closes within the step, by the law of impact and of gaps.
    fn closing(&self, touches: Vec<Touch>, dt: f64) -> Closing {
        let limits = self.constants.overlap_limits();
        let slow = SLOW * self.constants.settings.gravity.norm() * dt;
        let mut closing = Closing {
            touches: Vec::new(),
            points: Vec::new(),
            before: Vec::new(),
            free: Vec::new(),
        };
        for touch in touches {
            let [a, b] = touch
                .blocks
                .map(|block| self.state.kinematics[block as usize]);
            let arm = |block: u32| -> Arm {
                let is_moved = self.derived.update[block as usize] == Update::Rigid;
                let centroid = self.state.kinematics[block as usize].centroid;
                is_moved.then(|| (block, touch.position - centroid))
            };
            let point = Point::new(touch.normal, touch.blocks.map(arm));
            let relative = b.velocity_at(&touch.position) - a.velocity_at(&touch.position);
            let before = point.frame.tr_mul(&relative);
            let mut free = before + self.fallen(&point, dt);
            let closes = touch.gap + dt * free.x < 0.0;
            let open = touch.gap - TOUCHING * limits.size_of(touch.parts);
            free.x += if before.x < -slow && closes {
                touch.restitution * before.x
            } else {
                open.max(0.0) / dt
            };
            closing.touches.push(touch);
            closing.points.push(point);
            closing.before.push(before);
            closing.free.push(free);
        }
        closing
    }

    /// Kick over `dt` (s) by gravity and contacts.
    fn kick_with_contacts(&mut self, closing: Closing, dynamics: &ContactDynamics, dt: f64) {
        let Closing {
            touches,
            points,
            before,
            free,
        } = closing;
        let bodies = (self.state.kinematics.iter())
            .map(|kinematics| Body {
                inverse_mass: kinematics.inverse_mass,
                inverse_inertia: kinematics.inverse_inertia,
            })
            .collect();
        let mut impulses = self.impulses_before(&touches, &points, dt);
        let problem = ContactProblem {
            friction: touches.iter().map(|touch| touch.friction).collect(),
            free_velocity: free,
            operator: BodyContacts::new(bodies, points.clone()),
        };
        let until = Until {
            tolerance: dynamics.tolerance,
            scaling: Scaling::ContactMass,
            n_iterations: dynamics.n_iterations,
        };
        let ended = solver::solve(&problem, &mut impulses, until);
        self.state.solution = ContactSolution {
            n_contacts: touches.len(),
            n_iterations: ended.n_iterations,
            residual: ended.residual,
        };
        self.state.totals.n_unsolved += u64::from(UNSOLVED < ended.residual);
        let given = problem.operator.product(&impulses);
        self.keep_impulses(&touches, &points, &impulses, dt);
        self.set_contact_loads(&touches, &points, &impulses, dt);
        let [mut friction, mut damping] = [0.0; 2];
        for (a, impulse) in impulses.iter().enumerate() {
            let kicked = problem.operator.velocity(&given, a);
            let fallen = self.fallen(&points[a], dt);
            let mean = before[a] + (kicked + fallen) * 0.5;
            damping -= impulse.x * mean.x;
            friction -= impulse.y * mean.y + impulse.z * mean.z;
        }
        self.state.totals.damping.book(damping);
        self.state.totals.friction.book(friction);
        self.state.totals.n_contact_updates += touches.len() as u64;
        self.kick_bodies(&given, dt);
        self.remove_overlap(&problem, &touches);
    }

    /// What gravity adds to the velocity at a point in a step; m/s.
    fn fallen(&self, point: &Point, dt: f64) -> Vec3 {
        let gravity = self.constants.settings.gravity * dt;
        let fall = |arm: &Arm| arm.map_or(Vec3::zeros(), |_| gravity);
        let [a, b] = &point.arms;
        point.frame.tr_mul(&(fall(b) - fall(a)))
    }

    /// Impulses of the last step for this one; N s. Each goes to the nearest point of its parts: corners of faces that lie on each
    /// other change their names by round-off, and their sum should not.
    fn impulses_before(&self, touches: &[Touch], points: &[Point], dt: f64) -> Vec<Vec3> {
        let mut impulses = vec![Vec3::zeros(); touches.len()];
        let mut first = 0;
        for group in touches.chunk_by(|a, b| a.parts == b.parts) {
            let parts = group[0].parts;
            let kept = &self.state.impulses;
            let from = kept.partition_point(|kept| kept.parts < parts);
            for kept in kept[from..].iter().take_while(|kept| kept.parts == parts) {
                let away = |touch: &Touch| (touch.position - kept.position).norm_squared();
                let nearest =
                    (group.iter().enumerate()).min_by(|a, b| away(a.1).total_cmp(&away(b.1)));
                if let Some((k, _)) = nearest {
                    let at = first + k;
                    impulses[at] += points[at].frame.tr_mul(&kept.impulse) * (dt / kept.dt);
                }
            }
            first += group.len();
        }
        impulses
    }

    fn keep_impulses(&mut self, touches: &[Touch], points: &[Point], impulses: &[Vec3], dt: f64) {
        self.state.impulses.clear();
        let rows = touches.iter().zip(points).zip(impulses);
        self.state
            .impulses
            .extend(rows.map(|((touch, point), impulse)| KeptImpulse {
                parts: touch.parts,
                blocks: touch.blocks.into(),
                position: touch.position,
                normal: touch.normal,
                gap: touch.gap,
                impulse: point.frame * impulse,
                dt,
                state: state_of(touch.friction, impulse),
            }));
        self.state.impulses.sort_by_key(|kept| kept.parts);
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
        for b in 0..self.n_blocks() {
            let load = self.state.contact_load[b];
            match (self.derived.update[b], &self.constants.motion[b]) {
                (Update::Fixed, motion) => {
                    self.state.totals.support_impulse -= load.force * dt;
                    self.state.totals.impulse_exchanged += load.force.norm() * dt;
                    if matches!(motion, Motion::Prescribed(_)) {
                        let body = &self.state.kinematics[b];
                        let power = load.force.dot(&body.velocity) + load.torque.dot(&body.spin);
                        self.state.totals.external_work.book(-power * dt);
                    }
                }
                _ => {
                    let weight = self.constants.settings.gravity * self.constants.mass[b];
                    self.state.totals.support_impulse += weight * dt;
                    self.state.totals.impulse_exchanged += weight.norm() * dt;
                }
            }
        }
    }

    /// Velocities of free blocks after a kick of gravity and of contacts, which add velocity and spin (m/s, rad/s).
    fn kick_bodies(&mut self, given: &[[Vec3; 2]], dt: f64) {
        let gravity = self.constants.settings.gravity;
        for (b, [velocity, spin]) in given.iter().enumerate() {
            if self.derived.update[b] != Update::Rigid {
                continue;
            }
            self.state.velocity[b] += gravity * dt + velocity;
            let turned = self.state.attitude[b].inverse_transform_vector(spin);
            self.state.angular_momentum[b] += turned.component_mul(&self.constants.inertia[b]);
        }
    }
}
