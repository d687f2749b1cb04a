//! Kinematics of a block at a point: velocity, force, compliance. Contacts and coupling use only these
//! three, of rigid and deformable blocks alike.

use crate::Vec3;
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

/// Smallest nonzero velocity: products of smaller ones are denormal, for which processors are up to
/// twenty-five times slower; SI units.
const NO_VELOCITY: f64 = 1e-150;

/// A component of a velocity, zero where it is next to nothing.
pub(crate) fn flushed(component: f64) -> f64 {
    if component.abs() < NO_VELOCITY {
        0.0
    } else {
        component
    }
}

/// Force and torque on a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
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

impl Load {
    /// Times a factor.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self {
            force: self.force * factor,
            torque: self.torque * factor,
        }
    }
}

impl std::ops::AddAssign for Load {
    fn add_assign(&mut self, other: Self) {
        self.force += other.force;
        self.torque += other.torque;
    }
}

/// First moment of the forces on a block about its centroid, `Σ f ⊗ r`, split into the torque, which
/// rotates, and the symmetric part, which strains.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moment {
    /// `Σ r × f`; N m.
    pub torque: Vec3,
    /// `Σ (f ⊗ r + r ⊗ f)/2`; N m.
    pub stretch: Matrix3<f64>,
}

impl Moment {
    /// `Σ f ⊗ r`; N m. (`[r × f]× = f rᵀ − r fᵀ`.)
    pub fn matrix(&self) -> Matrix3<f64> {
        self.stretch + self.torque.cross_matrix() * 0.5
    }
}

/// Motion of a block about its centroid: rotation, and deformation where there is any. The rigid and
/// the deformable models implement it.
pub(crate) trait InternalMotion {
    /// Changes the velocities by the impulse of a moment over `dt` (s), and of the stress inside.
    fn kick(&mut self, moment: &Moment, dt: f64);
    /// Advances the position over `dt` (s), with the current velocities.
    fn drift(&mut self, dt: f64);
    /// Takes all velocities times a factor.
    fn scale_velocities(&mut self, factor: f64);
}

/// Straining part of the moment of a force, `(f ⊗ r + r ⊗ f)/2`; N m.
pub(crate) fn stretch(force: &Vec3, offset_rel: &Vec3) -> Matrix3<f64> {
    let product = force * offset_rel.transpose();
    0.5 * (product + product.transpose())
}

/// A block at one instant, in the world frame; inverse mass and inertia are zero if forces do not
/// move it.
///
/// In the order of use: spheres need the first half only.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[repr(C)]
pub(crate) struct Kinematics {
    pub centroid: Vec3,
    pub velocity: Vec3,
    pub spin: Vec3,
    pub inverse_mass: f64,
    /// `J⁻¹` of a rigid block, `S⁻¹` of a deformable one; 1/(kg m²).
    pub inverse_inertia: Matrix3<f64>,
    /// `D`, deformable blocks only; 1/s.
    pub strain_rate: Option<Matrix3<f64>>,
}

/// Lever arm of the forces that a contact may exert on a block, at the worst of its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LeverArm {
    /// Lever of the largest rotational compliance: the radius, less for a needle; m.
    pub length: f64,
    /// Largest rotational compliance of a rigid block at a corner, in the worst direction; 1/kg.
    ///
    /// ```text
    /// max_r λ_max([r]×ᵀ J⁻¹ [r]×)
    /// ```
    /// It is convex in `r`, so that no other point of the block has more.
    pub compliance: f64,
}

impl Kinematics {
    /// `v(x) = v_c + ω × r + D r`, `r = x − x_c`; m/s.
    pub fn velocity_at(&self, x: &Vec3) -> Vec3 {
        let r = x - self.centroid;
        let rigid = self.velocity + self.spin.cross(&r);
        match &self.strain_rate {
            None => rigid,
            Some(strain_rate) => rigid + strain_rate * r,
        }
    }

    /// Velocity of the material at `x` before the drift of the last `dt` (s), for the work of forces
    /// at that position; m/s.
    pub fn velocity_from(&self, x: &Vec3, dt: f64) -> Vec3 {
        self.velocity_at(&(x + self.velocity * dt))
    }

    /// Acceleration of the point `x` along `n` under a unit force along `n` there.
    ///
    /// ```text
    /// rigid       w = 1/m + (r × n)·J⁻¹(r × n)
    /// deformable  w = 1/m + r·S⁻¹r, in any direction                            [1/kg]
    /// ```
    pub fn compliance(&self, x: &Vec3, n: &Vec3) -> f64 {
        let r = x - self.centroid;
        let arm = if self.strain_rate.is_none() {
            r.cross(n)
        } else {
            r
        };
        self.inverse_mass + arm.dot(&(self.inverse_inertia * arm))
    }

    /// Sum of the compliances in three directions at right angles,
    /// `3/m + tr(J⁻¹) r² − r·J⁻¹r`, or `3 (1/m + r·S⁻¹r)`; 1/kg.
    pub fn compliance_trace(&self, x: &Vec3) -> f64 {
        let r = x - self.centroid;
        let along = r.dot(&(self.inverse_inertia * r));
        if self.strain_rate.is_some() {
            return 3.0 * (self.inverse_mass + along);
        }
        3.0 * self.inverse_mass + self.inverse_inertia.trace() * r.norm_squared() - along
    }

    /// Mean compliance against torques over the axes, exact of spheres; 1/(kg m²).
    pub fn rolling_mobility(&self) -> f64 {
        self.inverse_inertia.trace() / 3.0
    }

    /// Upper bound of the compliance of a block in any direction at any of its points; 1/kg. For one that deforms, at most 1.15 times
    /// that at the length of its lever arm, by `(tr A⁸)^⅛`.
    pub fn largest_compliance(&self, lever_arm: &LeverArm) -> f64 {
        if self.strain_rate.is_none() {
            return self.inverse_mass + lever_arm.compliance;
        }
        let trace = self.inverse_inertia.trace();
        if trace <= 0.0 {
            return self.inverse_mass;
        }
        let scaled = self.inverse_inertia / trace;
        let square = scaled * scaled;
        let largest = trace * (square * square).norm().sqrt().sqrt();
        self.inverse_mass + largest * lever_arm.length * lever_arm.length
    }

    /// Upper bound over points within a radius of the centroid: the compliance in one direction, and
    /// its sum over three orthogonal ones; 1/kg.
    pub fn worst_compliance(&self, radius: f64) -> (f64, f64) {
        let square = radius * radius;
        // No eigenvalue exceeds the norm, nor two of three the trace.
        let largest = self.inverse_inertia.norm() * square;
        let trace = self.inverse_inertia.trace() * square;
        if self.strain_rate.is_some() {
            let along = self.inverse_mass + largest;
            return (along, 3.0 * along);
        }
        (self.inverse_mass + largest, 3.0 * self.inverse_mass + trace)
    }
}
