//! Rows of exact joints, with their forces and accounts.
//!
//! ```text
//! c = error of position in the middle of the step
//! held point, ball joint      U = −c/dt                           at the middle of both points, so that angular momentum is kept
//! rod                         |Z + dt U| = l                      at its ends
//! ```
//! Positions at mid-steps are a leap-frog sequence: what a step leaves open the next one closes, and no joint drifts. The velocity −c/dt of a
//! body that turns about its joint is that of half a step later, so that the motion is of second order. Work of a joint is zero in the
//! mean then, and what it is in a step has a place of its own in the account.

use super::closing::{Closing, JointRow};
use super::touches::Touch;
use crate::blocks::attachments::End;
use crate::blocks::attachments::exact_joints::{ExactJoint, Tie};
use crate::contact::dynamics::bilateral::{Bilateral, Rod};
use crate::contact::dynamics::bodies::{Arm, Point};
use crate::contact::dynamics::delassus::{BodyContacts, Delassus};
use crate::error::OpenJoint;
use crate::{BlockId, Blocks, Vec3};

/// Error of position that a step may leave, × size of the smaller block: a joint beyond it contradicts another one.
const OPEN: f64 = 1e-3;
/// Distance from a joint within which two blocks have no contact, × size of the smaller one.
const AT_JOINT: f64 = 1e-2;
/// Distance from its strength within which a rod breaks, × the strength.
const AT_STRENGTH: f64 = 1e-9;

impl JointRow {
    /// Whether a rod bears all that it can.
    fn is_at_strength(&self, impulse: &Vec3) -> bool {
        let bears = |rod: &Rod| rod.largest * (1.0 - AT_STRENGTH) <= impulse.x.abs();
        self.rod.as_ref().is_some_and(bears)
    }
}

impl Blocks {
    /// Drops the points of two blocks at the place of a joint between them, which says already how they move there: both rows together
    /// have no bound on what they press.
    pub(super) fn drop_touches_at_joints(&self, touches: &mut Vec<Touch>) {
        for joint in &self.state.attachments.joints {
            let (first, Some(second)) = joint.blocks() else {
                continue;
            };
            if joint.is_broken || matches!(joint.tie, Tie::Rod { .. }) {
                continue;
            }
            let place = self.place_of(&joint.end);
            let sizes = [first, second].map(|b| &self.constants.size[self.parts_of(b as usize)]);
            let size = sizes
                .into_iter()
                .flatten()
                .fold(f64::INFINITY, |a, b| a.min(*b));
            touches.retain(|touch| {
                let is_between = touch.blocks == [first, second] || touch.blocks == [second, first];
                !is_between || AT_JOINT * size < (touch.position - place).norm()
            });
        }
    }

    /// Rows of the joints, after all others.
    pub(super) fn add_joints(&self, closing: &mut Closing, dt: f64) {
        for (k, joint) in self.state.attachments.joints.iter().enumerate() {
            let (first, second) = joint.blocks();
            let blocks = [Some(first), second];
            let has = |is: &dyn Fn(usize) -> bool| {
                (blocks.iter().flatten()).any(|&block| is(block as usize))
            };
            if joint.is_broken || has(&|b| self.is_removed(b)) || !has(&|b| self.is_driven(b)) {
                continue;
            }
            let (row, point, restored) = self.row_of(k, joint, dt);
            let [a, b] = [0, 1].map(|side| {
                row.blocks[side].map_or(Vec3::zeros(), |block| {
                    self.velocity_at(block as usize, &row.places[side])
                })
            });
            let now = point.frame.tr_mul(&(b - a));
            let more = closing.bodies.relative(&point, &closing.gains);
            closing.points.push(point);
            closing.before.push(now);
            closing.gained.push(more);
            closing.free.push(now + more + restored);
            closing.joints.push(row);
        }
    }

    /// Row of a joint, with its points and the error of position over the step (m/s) that its law is not to know.
    fn row_of(&self, k: usize, joint: &ExactJoint, dt: f64) -> (JointRow, Point, Vec3) {
        let near = self.place_of(&joint.end);
        let (far, bar) = match &joint.tie {
            Tie::Place(place) => (*place, None),
            Tie::Ball(other) => (self.place_of(other), None),
            Tie::Rod {
                other,
                length,
                strength,
            } => (self.place_of(other), Some((*length, *strength))),
        };
        let (first, second) = joint.blocks();
        let apart = far - near;
        let is_driven = |block: Option<u32>| block.is_some_and(|b| self.is_driven(b as usize));
        let places = match (bar, is_driven(Some(first)), is_driven(second)) {
            (Some(_), ..) => [near, far],
            (None, true, true) => [near + apart * 0.5; 2],
            (None, true, false) => [near; 2],
            (None, false, _) => [far; 2],
        };
        let arm = |block: Option<u32>, place: Vec3| -> Arm {
            let block = block.filter(|&b| self.is_driven(b as usize))?;
            let centroid = self.state.kinematics[block as usize].centroid;
            Some((block, place - centroid))
        };
        let arms = [arm(Some(first), places[0]), arm(second, places[1])];
        let rod = bar.map(|(length, strength)| Rod {
            // the ends of a rod meet in no motion of its length
            span: apart.norm().max(f64::EPSILON * length),
            length,
            dt,
            largest: strength * dt,
        });
        let point = match rod {
            Some(_) => Point::new(apart.try_normalize(0.0).unwrap_or_else(Vec3::x), arms),
            None => Point {
                frame: nalgebra::Matrix3::identity(),
                arms,
                is_torque: false,
            },
        };
        let restored = match rod {
            Some(_) => Vec3::zeros(),
            None => apart / dt,
        };
        let row = JointRow {
            joint: k,
            blocks: [Some(first), second],
            places,
            rod,
        };
        (row, point, restored)
    }

    /// World; m.
    fn place_of(&self, end: &End) -> Vec3 {
        let b = end.block as usize;
        self.state.kinematics[b].centroid + self.placement_gradient(b) * end.offset_rel
    }

    /// Impulses of the last step for this one, none where it left a joint open; N s.
    pub(super) fn recall_joints(&self, closing: &Closing, impulses: &mut [Vec3], dt: f64) {
        let first = closing.points.len() - closing.joints.len();
        let of = |(row, point): (&JointRow, &Point)| {
            let attachments = &self.state.attachments;
            if attachments.has_open_joint {
                return Vec3::zeros();
            }
            let force = attachments.joints[row.joint].force;
            let impulse = point.frame.tr_mul(&(force * -dt));
            match row.rod {
                Some(_) => Vec3::x() * impulse.x,
                None => impulse,
            }
        };
        let rows = closing.joints.iter().zip(&closing.points[first..]);
        for (impulse, found) in impulses[first..].iter_mut().zip(rows.map(of)) {
            *impulse = found;
        }
    }

    /// Keeps the impulses of joints, adds them to the loads of their blocks, books their work at the mean velocities of the kick, and breaks
    /// rods.
    pub(super) fn keep_joints(
        &mut self,
        rows: &[JointRow],
        (points, impulses, mean): (&[Point], &[Vec3], &[Vec3]),
        dt: f64,
    ) {
        for joint in &mut self.state.attachments.joints {
            joint.force = Vec3::zeros();
        }
        for (k, row) in rows.iter().enumerate() {
            let force = points[k].frame * impulses[k] / dt;
            let work = impulses[k].dot(&mean[k]);
            let attachments = &mut self.state.attachments;
            let joint = &mut attachments.joints[row.joint];
            joint.force = -force;
            joint.is_broken = row.is_at_strength(&impulses[k]);
            match joint.is_broken {
                true => attachments.plastic.book(-work),
                false => attachments.joint_correction.book(work),
            }
            for (side, force) in [-force, force].into_iter().enumerate() {
                match row.blocks[side] {
                    Some(block) => {
                        let arm = row.places[side] - self.state.kinematics[block as usize].centroid;
                        attachments.loads[block as usize].add(&force, &arm);
                    }
                    // what the world bears, free blocks get from outside
                    None => attachments.outer_force -= force,
                }
            }
        }
    }

    /// The joint that the kick leaves open farthest, over what it may, of impulses and velocities after it.
    pub(super) fn open_joint(
        &self,
        rows: &[JointRow],
        laws: &[Bilateral],
        (impulses, after): (&[Vec3], &[Vec3]),
        dt: f64,
    ) -> Option<OpenJoint> {
        let mut worst = (1.0, None);
        for (k, row) in rows.iter().enumerate() {
            let left = match row.rod {
                None => after[k].norm(),
                Some(_) if row.is_at_strength(&impulses[k]) => 0.0,
                Some(_) => (after[k].x + laws[k].shift(&after[k])).abs(),
            };
            let opening = left * dt;
            let over_allowed = opening / (OPEN * self.size_at(row));
            if worst.0 < over_allowed {
                let [first, second] = row.blocks;
                let name = |block: u32| BlockId::from(block);
                worst = (
                    over_allowed,
                    first.map(|first| OpenJoint {
                        joint: row.joint,
                        blocks: (name(first), second.map(name)),
                        opening,
                    }),
                );
            }
        }
        worst.1
    }

    /// Size of the smallest part of the blocks of a joint; m.
    fn size_at(&self, row: &JointRow) -> f64 {
        let blocks = row.blocks.iter().flatten();
        let sizes = blocks.flat_map(|&block| &self.constants.size[self.parts_of(block as usize)]);
        sizes.copied().fold(f64::INFINITY, f64::min)
    }

    /// Laws of bonds and joints, whose rows follow `n_bounded` others.
    pub(super) fn laws(
        joints: &[JointRow],
        n_bounded: usize,
        operator: &BodyContacts,
    ) -> Vec<Bilateral> {
        let first = operator.n_contacts() - joints.len();
        let bonds = (n_bounded..first).map(|a| Bilateral::point(operator.diagonal(a)));
        let of = |(row, a): (&JointRow, usize)| match row.rod {
            Some(rod) => Bilateral::Rod(rod),
            None => Bilateral::point(operator.diagonal(a)),
        };
        bonds.chain(joints.iter().zip(first..).map(of)).collect()
    }
}
