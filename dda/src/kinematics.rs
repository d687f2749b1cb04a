//! How a block answers at a point: velocity, force, compliance. The only three things that contacts
//! and coupling ask, so that deformable kinds can take a rigid block's place.

use crate::Vec3;
use nalgebra::Matrix3;

/// Force and torque on a block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// N.
    pub force: Vec3,
    /// About the centroid; N m.
    pub torque: Vec3,
}

impl Load {
    /// Adds a force at a point, given from the centroid (m).
    pub fn add(&mut self, force: &Vec3, offset_rel: &Vec3) {
        self.force += force;
        self.torque += offset_rel.cross(force);
    }
}

impl std::ops::AddAssign for Load {
    fn add_assign(&mut self, other: Self) {
        self.force += other.force;
        self.torque += other.torque;
    }
}

/// Rigid block at one instant, in the world frame; inverse mass and inertia are zero if forces do
/// not move it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kinematics {
    pub centroid: Vec3,
    pub velocity: Vec3,
    pub spin: Vec3,
    pub inverse_mass: f64,
    pub inverse_inertia: Matrix3<f64>,
}

impl Kinematics {
    /// `v(x) = v_c + ω × (x − x_c)`; m/s.
    pub fn velocity_at(&self, x: &Vec3) -> Vec3 {
        self.velocity + self.spin.cross(&(x - self.centroid))
    }

    /// Acceleration of the point `x` along `n` under a unit force along `n` there.
    ///
    /// ```text
    /// w = 1/m + (r × n)·J⁻¹(r × n)                                              [1/kg]
    /// ```
    pub fn compliance(&self, x: &Vec3, n: &Vec3) -> f64 {
        let arm = (x - self.centroid).cross(n);
        self.inverse_mass + arm.dot(&(self.inverse_inertia * arm))
    }

    /// Sum of the compliances in three directions at right angles,
    /// `3/m + tr(J⁻¹) r² − r·J⁻¹r`; 1/kg.
    pub fn compliance_trace(&self, x: &Vec3) -> f64 {
        let r = x - self.centroid;
        3.0 * self.inverse_mass + self.inverse_inertia.trace() * r.norm_squared()
            - r.dot(&(self.inverse_inertia * r))
    }

    /// No point within a radius of the centroid is more compliant; 1/kg.
    pub fn worst_compliance(&self, radius: f64) -> f64 {
        self.inverse_mass + self.inverse_inertia.trace() * radius * radius
    }
}
