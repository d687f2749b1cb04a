//! The twelve unknowns of classical DDA, with the three corrections they need.
//!
//! ```text
//! D = [u₀ v₀ w₀ | r₁ r₂ r₃ | ε_x ε_y ε_z γ_yz γ_zx γ_xy],     displacement = T(x) D
//! ```
//! 1. A rotation applied as `x + r × x` makes a block grow by `1 + r²` per step; here the position is rotated
//!    exactly after it is strained, `x := R(r)(I + ε) x`.
//! 2. Stress is rotated with the block, `σ := R σ Rᵀ + C Δε`.
//! 3. The acceleration `L² x` of a point that moves with `L x` is included: the momentum `F' S₀`, not
//!    `L`, is conserved without forces.

use super::{AffineBody, axial, elastic::Constants, symmetric};
use crate::Vec3;
use crate::motion::kinematics::{InternalMotion, Moment};
use nalgebra::{Matrix3, Rotation3, SMatrix};
use serde::{Deserialize, Serialize};

/// Increments of strain and rotation per step, stress summed up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Dda12 {
    pub body: AffineBody,
    pub elastic: Constants,
    /// Cauchy stress, world; Pa.
    pub stress: Matrix3<f64>,
    /// Its viscous part, of the last half step's rate; Pa.
    pub viscous: Matrix3<f64>,
    /// Energy that it took in the last drift; J.
    pub viscous_loss: f64,
}

impl Dda12 {
    pub fn new(body: AffineBody, elastic: Constants, initial_stress: Matrix3<f64>) -> Self {
        Self {
            body,
            elastic,
            stress: initial_stress,
            viscous: Matrix3::zeros(),
            viscous_loss: 0.0,
        }
    }

    /// `V σ : C⁻¹ : σ/2`; J.
    pub fn strain_energy(&self) -> f64 {
        0.5 * self.volume() * self.elastic.strain_of(&self.stress).dot(&self.stress)
    }

    fn volume(&self) -> f64 {
        self.body.volume * self.body.gradient.determinant()
    }
}

impl InternalMotion for Dda12 {
    fn kick(&mut self, moment: &Moment, dt: f64) {
        // First Piola stress of the same forces: P = det F σ F⁻ᵀ.
        let stress = (self.stress + self.viscous)
            * self.body.inverse_gradient().transpose()
            * self.body.gradient.determinant();
        self.body.kick(moment, &stress, dt);
    }

    fn drift(&mut self, dt: f64) {
        // The velocity gradient belongs to the middle of the step; two iterations find the configuration there.
        let start = self.body.gradient;
        let mut middle = start;
        let mut gradient = Matrix3::zeros();
        for _ in 0..3 {
            gradient = self.body.rate * middle.try_inverse().unwrap_or_else(Matrix3::identity);
            middle = moved(&gradient, 0.5 * dt) * start;
        }
        let strain = symmetric(&gradient) * dt;
        let turn = Rotation3::new(axial(&gradient) * dt);
        let turn = turn.matrix();
        let before = 0.5 * self.volume() * self.viscous.dot(&strain);
        self.body.gradient = moved(&gradient, dt) * start;
        self.stress = turn * self.stress * turn.transpose() + self.elastic.linear(&strain);
        if self.elastic.viscosity > 0.0 {
            self.viscous = strain * (2.0 * self.elastic.viscosity / dt);
            self.viscous_loss = before + 0.5 * self.volume() * self.viscous.dot(&strain);
        }
    }

    fn scale_velocities(&mut self, factor: f64) {
        self.body.rate *= factor;
    }
}

/// `R(ω dt)(I + D dt)`.
fn moved(velocity_gradient: &Matrix3<f64>, dt: f64) -> Matrix3<f64> {
    Rotation3::new(axial(velocity_gradient) * dt).matrix()
        * (Matrix3::identity() + symmetric(velocity_gradient) * dt)
}

/// Mass matrix of the classical unknowns about the centroid; kg, kg m².
///
/// ```text
/// M = ∫ ρ Tᵀ T dV = m A₀ᵀ A₀ + Σ_kl S_kl A_kᵀ A_l,        T(x) = A₀ + Σ_k x_k A_k
/// ```
/// It couples rotation and shear: `M(r₁, γ_yz) = (S_yy − S_zz)/2` and cyclic.
pub fn classical_mass_matrix(mass: f64, second_moment: &Matrix3<f64>) -> SMatrix<f64, 12, 12> {
    let origin = shape_matrix(&Vec3::zeros());
    let along: Vec<_> = (0..3)
        .map(|k| {
            let mut x = Vec3::zeros();
            x[k] = 1.0;
            shape_matrix(&x) - origin
        })
        .collect();
    let mut matrix = origin.transpose() * origin * mass;
    for (k, first) in along.iter().enumerate() {
        for (l, second) in along.iter().enumerate() {
            matrix += first.transpose() * second * second_moment[(k, l)];
        }
    }
    matrix
}

/// `T(x)`, x from the centroid; m.
fn shape_matrix(x: &Vec3) -> SMatrix<f64, 3, 12> {
    let (x, y, z) = (x.x, x.y, x.z);
    #[rustfmt::skip]
    let rows = [
        1.0, 0.0, 0.0, 0.0,  z,  -y,   x, 0.0, 0.0, 0.0, z / 2.0, y / 2.0,
        0.0, 1.0, 0.0, -z,  0.0,  x,  0.0,  y, 0.0, z / 2.0, 0.0, x / 2.0,
        0.0, 0.0, 1.0,  y,  -x,  0.0, 0.0, 0.0,  z, y / 2.0, x / 2.0, 0.0,
    ];
    SMatrix::<f64, 3, 12>::from_row_slice(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// D05: one turn in 100 steps. `x + r × x` grows by (1 + r²)^100 = 1.4829; the exact turn not at all.
    #[test]
    fn exact_rotation_does_not_grow() {
        let spin = Vec3::new(0.0, 0.0, std::f64::consts::TAU / 100.0);
        let (mut classical, mut exact) = (Matrix3::identity(), Matrix3::identity());
        for _ in 0..100 {
            classical = (Matrix3::identity() + spin.cross_matrix()) * classical;
            exact = moved(&spin.cross_matrix(), 1.0) * exact;
        }
        let growth: f64 = classical.determinant();
        assert!((growth - 1.4829109).abs() < 1e-7, "{growth}");
        assert!((exact.determinant() - 1.0_f64).abs() < 1e-12);
        assert!((exact - Matrix3::identity()).norm() < 1e-12);
    }
}
