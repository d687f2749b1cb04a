//! Queries of one block: its motion, mass, stress and forces. They change nothing.

use crate::geometry::parts::Part;
use crate::motion::deformation::{axial, voigt};
use crate::motion::holds::Hold;
use crate::{Blocks, Isometry, Load, Motion, Settings, Vec3, Voigt};
use nalgebra::{Matrix3, UnitQuaternion};

impl Blocks {
    // Counts.

    /// Number of blocks, removed ones included.
    pub fn n_blocks(&self) -> usize {
        self.state.centroid.len()
    }

    /// Number of blocks that forces move.
    pub fn n_free(&self) -> usize {
        (0..self.n_blocks()).filter(|&b| self.is_free(b)).count()
    }

    /// Number of blocks that never move.
    pub fn n_fixed(&self) -> usize {
        self.count(|motion| matches!(motion, Motion::Fixed))
    }

    /// Number of blocks that follow a path.
    pub fn n_prescribed(&self) -> usize {
        self.count(|motion| matches!(motion, Motion::Prescribed(_)))
    }

    fn count(&self, is_wanted: impl Fn(&Motion) -> bool) -> usize {
        (0..self.n_blocks())
            .filter(|&b| !self.state.is_removed[b] && is_wanted(&self.constants.motion[b]))
            .count()
    }

    /// Number of blocks taken out with [`remove`](Self::remove).
    pub fn n_removed(&self) -> usize {
        self.state
            .is_removed
            .iter()
            .filter(|&&is_removed| is_removed)
            .count()
    }

    /// Number of convex parts.
    pub fn n_parts(&self) -> usize {
        self.derived.parts.len()
    }

    /// The block that a part belongs to.
    pub fn block_of_part(&self, part: usize) -> usize {
        self.constants.block_of_part[part] as usize
    }

    /// The parts of a block.
    pub fn parts_of(&self, b: usize) -> std::ops::Range<usize> {
        self.constants.part_start[b] as usize..self.constants.part_start[b + 1] as usize
    }

    /// Parts of fixed blocks, in ascending order.
    pub fn fixed_parts(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.n_parts()).filter(|&part| self.is_fixed(self.block_of_part(part)))
    }

    /// Parts of free and prescribed blocks that were not removed, in ascending order.
    pub fn movable_parts(&self) -> impl Iterator<Item = usize> + '_ {
        let can_move = self.derived.can_move.iter().enumerate();
        can_move.filter(|&(_, &can)| can).map(|(part, _)| part)
    }

    // One block.

    /// Motion.
    pub fn motion(&self, b: usize) -> &Motion {
        &self.constants.motion[b]
    }

    /// Do forces move it?
    pub fn is_free(&self, b: usize) -> bool {
        matches!(self.constants.motion[b], Motion::Free) && !self.state.is_removed[b]
    }

    /// Is it fixed? Such a block never moves.
    pub fn is_fixed(&self, b: usize) -> bool {
        matches!(self.constants.motion[b], Motion::Fixed)
    }

    /// Has it been taken out?
    pub fn is_removed(&self, b: usize) -> bool {
        self.state.is_removed[b]
    }

    /// Centroid, world; m.
    pub fn centroid(&self, b: usize) -> Vec3 {
        self.state.centroid[b]
    }

    /// Rotation since the initial placement.
    pub fn orientation(&self, b: usize) -> UnitQuaternion<f64> {
        self.state.attitude[b] * self.constants.principal[b].inverse()
    }

    /// World from the axes of the start: rotation, with the deformation gradient of a block that deforms.
    pub fn gradient(&self, b: usize) -> Matrix3<f64> {
        self.placement_gradient(b)
    }

    /// Projections of the velocity of the centroid and of the rotation of a free block on the free directions of its
    /// hold; identities without one.
    pub fn freedom(&self, b: usize) -> [Matrix3<f64>; 2] {
        let free = Matrix3::identity();
        self.hold_of(b).map_or([free; 2], Hold::freedom)
    }

    /// Present from initial placement.
    pub fn pose(&self, b: usize) -> Isometry {
        let turn = self.orientation(b);
        let shift = self.state.centroid[b] - turn * self.constants.initial_centroid[b];
        Isometry::from_parts(shift.into(), turn)
    }

    /// Velocity of the centroid; m/s.
    pub fn velocity(&self, b: usize) -> Vec3 {
        self.state.velocity[b]
    }

    /// Angular velocity, world; rad/s.
    pub fn angular_velocity(&self, b: usize) -> Vec3 {
        match self.constants.deformable_of[b] {
            None => {
                self.state.attitude[b]
                    * self.state.angular_momentum[b].component_div(&self.constants.inertia[b])
            }
            Some(k) => axial(
                &self.state.deformables[k as usize]
                    .body()
                    .velocity_gradient(),
            ),
        }
    }

    /// Whether it sleeps: a block at rest that is not advanced until its load changes.
    pub fn is_asleep(&self, b: usize) -> bool {
        self.state.rest.has(b)
    }

    /// Does it deform?
    pub fn is_deformable(&self, b: usize) -> bool {
        self.constants.deformable_of[b].is_some()
    }

    /// Mean Cauchy stress in a deformable block, tension positive; `None` for a rigid one; Pa.
    pub fn stress(&self, b: usize) -> Option<Voigt> {
        self.constants.deformable_of[b].map(|k| voigt(&self.state.deformables[k as usize].stress()))
    }

    /// Green's strain of a deformable block, in the initial axes; `None` for a rigid one; –.
    pub fn strain(&self, b: usize) -> Option<Voigt> {
        self.constants.deformable_of[b].map(|k| voigt(&self.state.deformables[k as usize].strain()))
    }

    /// Volume over initial volume: 1 for a rigid block; –.
    pub fn volume_ratio(&self, b: usize) -> f64 {
        self.constants.deformable_of[b].map_or(1.0, |k| {
            self.state.deformables[k as usize]
                .body()
                .gradient
                .determinant()
        })
    }

    /// Tension and yielded length of each rock bolt, in the order they were attached; N, m.
    pub fn bolts(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.state.attachments.bolts()
    }

    /// Mean force of the last step on the first block of each exact joint, and whether the joint is broken, in the order they were
    /// attached; N.
    pub fn joint_forces(&self) -> impl Iterator<Item = (Vec3, bool)> + '_ {
        let joints = self.state.attachments.joints.iter();
        joints.map(|joint| (joint.force, joint.is_broken))
    }

    /// Kinetic energy of a free block, without mass scaling; J.
    pub fn kinetic_energy(&self, b: usize) -> f64 {
        let p = self.state.angular_momentum[b];
        0.5 * self.constants.mass[b] * self.state.velocity[b].norm_squared()
            + match self.constants.deformable_of[b] {
                None => 0.5 * p.dot(&p.component_div(&self.constants.inertia[b])),
                Some(k) => self.state.deformables[k as usize].kinetic_energy(),
            }
    }

    /// Angular momentum about the centroid, world; N m s.
    pub fn spin_momentum(&self, b: usize) -> Vec3 {
        self.state.attitude[b] * self.state.angular_momentum[b]
    }

    /// Mass; kg.
    pub fn mass(&self, b: usize) -> f64 {
        self.constants.mass[b]
    }

    /// Volume; m³.
    pub fn volume(&self, b: usize) -> f64 {
        self.constants.volume[b]
    }

    /// Inertia tensor about the centroid, world; kg m².
    pub fn inertia(&self, b: usize) -> Matrix3<f64> {
        let turn = self.state.attitude[b].to_rotation_matrix();
        turn.matrix()
            * Matrix3::from_diagonal(&self.constants.inertia[b])
            * turn.matrix().transpose()
    }

    /// Farthest point of the block from its centroid; m.
    pub fn radius(&self, b: usize) -> f64 {
        self.constants.radius[b]
    }

    /// Radius of a block that is a sphere; m.
    pub fn sphere_radius(&self, b: usize) -> Option<f64> {
        match &self.constants.reference[self.parts_of(b)] {
            [Part::Sphere { radius, .. }] => Some(*radius),
            _ => None,
        }
    }

    /// Velocity of the block's material at a world point; m/s.
    pub fn velocity_at(&self, b: usize, point: &Vec3) -> Vec3 {
        self.state.kinematics[b].velocity_at(point)
    }

    /// Gradient of the velocity in the block: `ω×` of a rigid one; 1/s.
    pub fn velocity_gradient(&self, b: usize) -> Matrix3<f64> {
        match self.constants.deformable_of[b] {
            None => self.angular_velocity(b).cross_matrix(),
            Some(k) => self.state.deformables[k as usize]
                .body()
                .velocity_gradient(),
        }
    }

    /// `n·M⁻¹n` at a world point, rotation included: the acceleration along the unit vector `n`
    /// under a unit force along it; 0 for fixed and prescribed blocks; 1/kg.
    pub fn compliance(&self, b: usize, point: &Vec3, n: &Vec3) -> f64 {
        self.state.kinematics[b].compliance(point, n)
    }

    /// Contact forces on a block at the end of the last step.
    pub fn contact_force(&self, b: usize) -> Load {
        self.state.contact_load[b]
    }

    /// Numbers of the solver.
    pub fn settings(&self) -> &Settings {
        &self.constants.settings
    }
}
