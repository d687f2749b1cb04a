//! Constraints of free blocks: held in some directions, or rotating about one axis only.

use crate::{BlockError, Vec3};
use nalgebra::{Matrix3, UnitQuaternion};

/// Rotation of a held block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Turning {
    /// As forces make it.
    #[default]
    Free,
    /// About this world axis (unit vector) only.
    About(Vec3),
    /// Not at all.
    Held,
}

/// Constraints on a free block. Constraint forces do no work; their impulse counts as that of the
/// supports.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hold {
    /// World directions in which the centroid does not move: unit vectors at right angles, at most
    /// three.
    pub directions: Vec<Vec3>,
    /// Its rotation.
    pub turning: Turning,
}

impl Hold {
    pub(crate) fn check(&self, block: usize) -> Result<(), BlockError> {
        let refuse = |reason| Err(BlockError::Hold { block, reason });
        let is_unit = |v: &Vec3| (v.norm() - 1.0).abs() <= 1e-9;
        if self.directions.len() > 3 {
            return refuse("there are at most three directions");
        }
        for (k, direction) in self.directions.iter().enumerate() {
            if !is_unit(direction) {
                return refuse("directions must be unit vectors");
            }
            if self.directions[..k]
                .iter()
                .any(|other| other.dot(direction).abs() > 1e-9)
            {
                return refuse("directions must be at right angles");
            }
        }
        match &self.turning {
            Turning::About(axis) if !is_unit(axis) => refuse("the axis must be a unit vector"),
            _ => Ok(()),
        }
    }

    /// Projections on the free directions: of velocity, of rotation.
    pub(crate) fn freedom(&self) -> [Matrix3<f64>; 2] {
        let held: Matrix3<f64> = self.directions.iter().map(|d| d * d.transpose()).sum();
        let turning = match &self.turning {
            Turning::Free => Matrix3::identity(),
            Turning::About(axis) => axis * axis.transpose(),
            Turning::Held => Matrix3::zeros(),
        };
        [Matrix3::identity() - held, turning]
    }

    /// The part of a velocity or force that is held.
    pub(crate) fn held_part(&self, v: &Vec3) -> Vec3 {
        self.directions.iter().map(|d| d * d.dot(v)).sum()
    }

    /// Projects the angular momentum (principal axes) on the allowed rotation.
    pub(crate) fn hold_turning(
        &self,
        attitude: &UnitQuaternion<f64>,
        inertia: &Vec3,
        p: &mut Vec3,
    ) {
        match &self.turning {
            Turning::Free => {}
            Turning::Held => *p = Vec3::zeros(),
            Turning::About(axis) => {
                let axis_rel = attitude.inverse_transform_vector(axis);
                let carried = axis_rel.component_mul(inertia);
                *p = carried * (axis_rel.dot(p) / axis_rel.dot(&carried));
            }
        }
    }

    /// Rotates about the axis over `dt` (s); false if the block rotates freely.
    pub(crate) fn turn(
        &self,
        attitude: &mut UnitQuaternion<f64>,
        inertia: &Vec3,
        p: &mut Vec3,
        dt: f64,
    ) -> bool {
        match &self.turning {
            Turning::Free => return false,
            Turning::Held => {}
            Turning::About(axis) => {
                let axis_rel = attitude.inverse_transform_vector(axis);
                let spin = axis_rel.dot(p) / axis_rel.dot(&axis_rel.component_mul(inertia));
                *attitude = UnitQuaternion::from_scaled_axis(axis * (spin * dt)) * *attitude;
                attitude.renormalize();
                let axis_rel = attitude.inverse_transform_vector(axis);
                *p = axis_rel.component_mul(inertia) * spin;
            }
        }
        true
    }

    /// Inverse inertia, world, of the allowed rotation; 1/(kg m²).
    pub(crate) fn inverse_inertia(
        &self,
        free: Matrix3<f64>,
        attitude: &UnitQuaternion<f64>,
        inertia: &Vec3,
    ) -> Matrix3<f64> {
        match &self.turning {
            Turning::Free => free,
            Turning::Held => Matrix3::zeros(),
            Turning::About(axis) => {
                let axis_rel = attitude.inverse_transform_vector(axis);
                axis * axis.transpose() / axis_rel.dot(&axis_rel.component_mul(inertia))
            }
        }
    }
}
