//! Points that may bear an impulse in a step, with the law of impact and of gaps.

use super::touches::Touch;
use crate::contact::detection::spheres::effective_radius;
use crate::contact::dynamics::bilateral::Rod;
use crate::contact::dynamics::bodies::{Arm, Bodies, Body, BodyVelocities, Point};
use crate::contact::dynamics::{Rolling, SpinAxis};
use crate::{Blocks, Vec3};

/// Impact speed below which there is no restitution, over `g dt`.
const SLOW: f64 = 5.0;
/// Gap up to which parts touch, × size of the smaller one. Without it the corners of a column at rest close gaps of round-off in turn, and a
/// step takes three times the iterations.
const TOUCHING: f64 = 1e-6;

/// Points that may bear an impulse in a step.
pub(super) struct Closing {
    pub bodies: Bodies,
    /// Velocities that bodies get without contacts.
    pub gains: BodyVelocities,
    pub touches: Vec<Touch>,
    /// Of the touches, then of rolling resistance, of bonds, of joints.
    pub points: Vec<Point>,
    pub rolling: Vec<Rolling>,
    pub joints: Vec<JointRow>,
    /// `U` at the points before the kick, of all bodies; m/s.
    pub before: Vec<Vec3>,
    /// What the gains add to it; m/s.
    pub gained: Vec<Vec3>,
    /// `b`, with the shift; m/s.
    pub free: Vec<Vec3>,
}

/// A joint in a step.
pub(super) struct JointRow {
    /// Position among the joints.
    pub joint: usize,
    /// The first block, and the second one or the world.
    pub blocks: [Option<u32>; 2],
    /// Points at which the impulse acts on them; m.
    pub places: [Vec3; 2],
    pub rod: Option<Rod>,
}

impl Blocks {
    /// Points of which the gap is closed or closes within the step, by the law of impact and of gaps.
    pub(super) fn closing(&self, touches: Vec<Touch>, dt: f64) -> Closing {
        let limits = self.constants.overlap_limits();
        let slow = SLOW * self.constants.settings.gravity.norm() * dt;
        let bodies = self.bodies(dt);
        let gains = self.gains(&bodies, dt);
        let n = touches.len();
        let mut points = Vec::with_capacity(n);
        let [mut before, mut gained, mut free] = [(); 3].map(|()| Vec::with_capacity(n));
        for touch in &touches {
            let arms = touch.blocks.map(|block| self.arm(block, &touch.position));
            let point = Point::new(touch.normal, arms);
            let [a, b] = touch
                .blocks
                .map(|block| self.state.kinematics[block as usize].velocity_at(&touch.position));
            let now = point.frame.tr_mul(&(b - a));
            let more = bodies.relative(&point, &gains);
            let mut after = now + more;
            let closes = touch.gap + dt * after.x < 0.0;
            let open = touch.gap - TOUCHING * limits.size_of(touch.parts);
            after.x += if now.x < -slow && closes {
                touch.restitution * now.x
            } else {
                open.max(0.0) / dt
            };
            points.push(point);
            before.push(now);
            gained.push(more);
            free.push(after);
        }
        let mut closing = Closing {
            bodies,
            gains,
            touches,
            points,
            rolling: Vec::new(),
            joints: Vec::new(),
            before,
            gained,
            free,
        };
        self.add_rolling(&mut closing);
        self.add_bonds(&mut closing, dt);
        self.add_joints(&mut closing, dt);
        closing
    }

    /// A place from the centroid of a block; none of one that impulses do not move.
    pub(super) fn arm(&self, block: u32, position: &Vec3) -> Arm {
        let centroid = self.state.kinematics[block as usize].centroid;
        (self.is_driven(block as usize)).then(|| (block, position - centroid))
    }

    /// Rows of rolling and twisting resistance, after those of the touches.
    fn add_rolling(&self, closing: &mut Closing) {
        for (a, touch) in closing.touches.iter().enumerate() {
            let parts = [touch.parts.0, touch.parts.1].map(|p| &self.derived.parts[p as usize]);
            let [i, j] = touch.blocks.map(|b| self.state.kinematics[b as usize].spin);
            for (axis, coefficient) in [
                (SpinAxis::Across, touch.rolling_friction),
                (SpinAxis::Along, touch.twisting_friction),
            ] {
                if coefficient <= 0.0 {
                    continue;
                }
                let length = effective_radius((parts[0], parts[1]));
                let contact = &closing.points[a];
                let point = match axis {
                    SpinAxis::Across => Point::rolling(contact, length),
                    SpinAxis::Along => Point::twisting(contact, length),
                };
                let now = point.frame.tr_mul(&(j - i));
                let more = closing.bodies.relative(&point, &closing.gains);
                closing.points.push(point);
                closing.before.push(now);
                closing.gained.push(more);
                closing.free.push(now + more);
                closing.rolling.push(Rolling {
                    contact: a as u32,
                    coefficient,
                    axis,
                });
            }
        }
    }

    /// Blocks as impulses within `dt` (s) move them.
    fn bodies(&self, dt: f64) -> Bodies {
        let of = |(b, kinematics): (usize, &crate::motion::kinematics::Kinematics)| Body {
            inverse_mass: kinematics.inverse_mass,
            freedom: self.hold_of(b).map(|hold| hold.freedom()[0]),
            inverse_inertia: kinematics.inverse_inertia,
        };
        let rigid = self.state.kinematics.iter().enumerate().map(of).collect();
        Bodies::new(rigid, self.straining_bodies(dt))
    }

    /// Velocities that blocks get within `dt` (s) by weight, attachments and what acted from outside; by their stress, too.
    fn gains(&self, bodies: &Bodies, dt: f64) -> BodyVelocities {
        let of = |(b, body): (usize, &Body)| {
            if !self.is_driven(b) || self.is_deformable(b) {
                return [Vec3::zeros(); 2];
            }
            let given = self.impulse_without_contacts(b, dt);
            body.kicked(&given.force, &given.torque)
        };
        let mut gains = bodies.at_rest();
        for (gain, body) in gains
            .rigid
            .iter_mut()
            .zip(bodies.rigid().iter().enumerate())
        {
            *gain = of(body);
        }
        self.add_gains_of_straining(bodies, &mut gains, dt);
        gains
    }
}
