//! Kinematics and world geometry of the blocks, from their state.

use super::{CHUNK, Constants, Derived, State, Update};
use crate::geometry::bounds::Bounds;
use crate::geometry::parts::Part;
use crate::motion::deformation::{axial, symmetric};
use crate::motion::kinematics::Kinematics;
use crate::motion::rigid::{is_isotropic, rigid_kinematics};
use crate::{Blocks, Isometry, Motion, Vec3, chunks};
use nalgebra::Matrix3;

impl Blocks {
    /// Updates kinematics, world geometry and boxes from the state; those of fixed blocks only if `all`.
    pub(crate) fn place_parts(&mut self, all: bool) {
        for block in 0..self.n_blocks() {
            if !matches!(self.derived.update[block], Update::Rigid | Update::Asleep)
                && (all || !matches!(self.constants.motion[block], Motion::Fixed))
            {
                self.set_kinematics(block);
            }
        }
        self.set_plain_kinematics();
        let Self {
            derived: Derived { parts, update, .. },
            state:
                State {
                    boxes,
                    attitude,
                    centroid,
                    deformables,
                    ..
                },
            constants:
                Constants {
                    reference,
                    block_of_part,
                    motion,
                    principal,
                    deformable_of,
                    ..
                },
            ..
        } = self;
        let place = |first: usize, (parts, boxes): (&mut [Part], &mut [Bounds])| {
            for ((k, part), bounds) in (first..).zip(parts).zip(boxes) {
                let block = block_of_part[k] as usize;
                if !all
                    && (matches!(motion[block], Motion::Fixed) || update[block] == Update::Asleep)
                {
                    continue;
                }
                let turn = || attitude[block] * principal[block].inverse();
                match (deformable_of[block], &mut *part) {
                    (None, Part::Sphere { center, .. }) => *center = centroid[block],
                    (None, part) => part.set_transformed(
                        &reference[k],
                        &Isometry::from_parts(centroid[block].into(), turn()),
                    ),
                    (Some(of), part) => part.set_deformed(
                        &reference[k],
                        &deformables[of as usize].body().gradient,
                        &centroid[block],
                    ),
                }
                *bounds = part.aabb();
            }
        };
        let columns = (parts.as_mut_slice(), boxes.as_mut_slice());
        chunks::for_each(columns, CHUNK, &place);
    }

    fn set_plain_kinematics(&mut self) {
        let Self {
            state:
                State {
                    kinematics,
                    centroid,
                    velocity,
                    attitude,
                    angular_momentum,
                    ..
                },
            constants: Constants { inertia, mass, .. },
            derived: Derived { update, .. },
            ..
        } = self;
        let set = |first: usize, kinematics: &mut [Kinematics]| {
            for (b, kinematics) in (first..).zip(kinematics) {
                if !matches!(update[b], Update::Rigid | Update::Asleep) {
                    continue;
                }
                if is_isotropic(&inertia[b]) && kinematics.inverse_mass > 0.0 {
                    // the inertia of a sphere does not rotate
                    kinematics.centroid = centroid[b];
                    kinematics.velocity = velocity[b];
                    kinematics.spin = attitude[b] * angular_momentum[b] * (1.0 / inertia[b].x);
                } else {
                    *kinematics = rigid_kinematics(
                        (centroid[b], velocity[b], mass[b]),
                        &attitude[b],
                        &angular_momentum[b],
                        &inertia[b],
                    );
                }
            }
        };
        chunks::for_each(kinematics.as_mut_slice(), CHUNK, &set);
    }

    pub(crate) fn set_kinematics(&mut self, block: usize) {
        if let Some(k) = self.constants.deformable_of[block] {
            self.set_deformable_kinematics(block, k as usize);
            return;
        }
        if self.is_free(block) {
            let mut kinematics = rigid_kinematics(
                (
                    self.state.centroid[block],
                    self.state.velocity[block],
                    self.constants.mass[block],
                ),
                &self.state.attitude[block],
                &self.state.angular_momentum[block],
                &self.constants.inertia[block],
            );
            if let Some(hold) = self.hold_of(block) {
                kinematics.inverse_inertia = hold.inverse_inertia(
                    kinematics.inverse_inertia,
                    &self.state.attitude[block],
                    &self.constants.inertia[block],
                );
            }
            self.state.kinematics[block] = kinematics;
            return;
        }
        self.state.kinematics[block] = Kinematics {
            centroid: self.state.centroid[block],
            velocity: self.state.velocity[block],
            spin: match self.constants.motion[block] {
                Motion::Prescribed(_) => self.angular_velocity(block),
                Motion::Free | Motion::Fixed => Vec3::zeros(),
            },
            inverse_mass: 0.0,
            inverse_inertia: Matrix3::zeros(),
            strain_rate: None,
        };
    }

    /// Kinematics of a deformable block; its orientation and angular momentum are derived for queries.
    fn set_deformable_kinematics(&mut self, block: usize, k: usize) {
        let is_free = self.is_free(block);
        let deformable = &self.state.deformables[k];
        let body = deformable.body();
        let gradient = body.velocity_gradient();
        self.state.attitude[block] = deformable.rotation() * self.constants.principal[block];
        self.state.angular_momentum[block] =
            self.state.attitude[block].inverse_transform_vector(&deformable.angular_momentum());
        self.state.kinematics[block] = Kinematics {
            centroid: self.state.centroid[block],
            velocity: self.state.velocity[block],
            spin: axial(&gradient),
            inverse_mass: if is_free {
                1.0 / self.constants.mass[block]
            } else {
                0.0
            },
            inverse_inertia: if is_free {
                body.present_inverse_second_moment()
            } else {
                Matrix3::zeros()
            },
            strain_rate: Some(symmetric(&gradient)),
        };
    }

    /// Deformation gradient of a block, world from the initial axes: its rotation, with the strain of a deformable block.
    pub(crate) fn placement_gradient(&self, block: usize) -> Matrix3<f64> {
        match self.constants.deformable_of[block] {
            None => *self.orientation(block).to_rotation_matrix().matrix(),
            Some(k) => self.state.deformables[k as usize].body().gradient,
        }
    }
}
