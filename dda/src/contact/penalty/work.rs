//! Work of the contact forces: what springs give and what dashpots and friction take.
//!
//! The forces act at both ends of a step, the rates are those of its middle: each evaluation books half of the step with
//! the points that it has found, and half of the next.

use crate::Vec3;
use crate::contact::report::PointState;
use crate::motion::kinematics::Kinematics;
use serde::{Deserialize, Serialize};

/// Energy that contacts took; J.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Losses {
    pub friction: f64,
    pub damping: f64,
}

/// Normals of points, from i to j.
pub(super) trait Normals: Copy {
    /// Unit.
    fn of_point(&self, k: usize) -> Vec3;
}

impl Normals for Vec3 {
    fn of_point(&self, _: usize) -> Vec3 {
        *self
    }
}

impl Normals for &[Vec3] {
    fn of_point(&self, k: usize) -> Vec3 {
        self[k]
    }
}

/// Forces that act at the points of two bodies.
#[derive(Clone, Copy)]
pub(super) struct Acting<'a, N> {
    /// i and j.
    pub bodies: (&'a Kinematics, &'a Kinematics),
    pub points: &'a [PointState],
    pub normals: N,
    /// Time since the points were found; s.
    pub ago: f64,
}

impl<N: Normals> Acting<'_, N> {
    /// The points with their normals.
    pub fn points(&self) -> impl Iterator<Item = (&PointState, Vec3)> {
        let normals = self.normals;
        (0..)
            .zip(self.points)
            .map(move |(k, point)| (point, normals.of_point(k)))
    }

    /// Velocity of j against i at a point; m/s.
    pub fn rate(&self, x: &Vec3) -> Vec3 {
        let (a, b) = self.bodies;
        b.velocity_from(x, self.ago) - a.velocity_from(x, self.ago)
    }

    /// Half a step's work of dashpots and shear springs. What the shear springs were given and do not hold has slipped.
    pub fn book_half(&self, dt: f64, losses: &mut Losses) {
        for (point, n) in self.points() {
            let rate = self.rate(&point.at.position);
            let viscous = n * point.normal_viscous + point.shear_viscous;
            losses.damping -= 0.5 * dt * viscous.dot(&rate);
            losses.friction -= 0.5 * dt * (point.shear_force - point.shear_viscous).dot(&rate);
        }
    }

    /// Half a step's work of the normal springs on the bodies; J.
    pub fn work_of_normal_springs(&self, dt: f64) -> f64 {
        let work = |(point, n): (&PointState, Vec3)| {
            let opening = self.rate(&point.at.position).dot(&n);
            0.5 * dt * (point.normal_force - point.normal_viscous) * opening
        };
        self.points().map(work).sum()
    }
}
