//! Deformable blocks: the velocity of their points is linear in position.
//!
//! ```text
//! x = x_c + F X,    F' = L F,    L = [ω]× + D                             X: place from the centroid at the start
//! m v_c' = Σ f,     F'' S₀ = Σ f ⊗ X − V₀ P                               S₀ = ∫ ρ X Xᵀ dV          [N m]
//! ```
//! Twelve unknowns, exact for any rotation: nothing is linearized, so that a rotating block does not
//! grow, and centrifugal and gyroscopic effects are exact. Source: Cohen & Muncaster
//! (1988); the equations of first-order DDA (Shi 1993) follow for small increments.
//!
//! Two models share this motion and differ in how strain and stress are followed:
//!
//! - [`Affine12`](DeformableModel::Affine12): stress from the present `F` by a hyperelastic law.
//! - [`Dda12`](DeformableModel::Dda12): increments `D` of the classical unknowns, stress summed up
//!   from step to step, with the three corrections that the classical scheme needs (below).
//!
//! Contacts and coupling need three functions of any block, rigid or not: the velocity of a point, the
//! compliance at a point, and the application of a force at a point (see `kinematics`). The internal dynamics
//! is an `InternalMotion`, one implementation per model, including the rigid one.

mod affine;
mod classical;
mod elastic;
mod rotating;

use crate::motion::kinematics::{InternalMotion, Moment, flushed};
use crate::{Elastic, Vec3};
pub(crate) use affine::Affine12;
pub(crate) use classical::Dda12;
pub use classical::classical_mass_matrix;
use elastic::Constants;
pub use elastic::natural_frequencies;
use nalgebra::{Matrix3, UnitQuaternion};
pub use rotating::MomentCompliance;
pub(crate) use rotating::product;
use serde::{Deserialize, Serialize};

/// Symmetric tensor in Voigt's order `xx yy zz yz zx xy`, shear entries as they stand in the
/// tensor.
pub type Voigt = [f64; 6];

/// Stress law of a deformable block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum StressLaw {
    /// `P = F (λ tr(E) I + 2μ E)`, `E = (FᵀF − I)/2`. Softens in strong compression.
    #[default]
    SaintVenantKirchhoff,
    /// `P = R (λ tr(U − I) I + 2μ (U − I))`, `F = R U`: linear in stretch.
    Corotational,
}

/// The kinematic model of a block that deforms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeformableModel {
    /// Exact affine motion with a hyperelastic law.
    Affine12(StressLaw),
    /// The unknowns of classical DDA, corrected; for comparison with the literature.
    Dda12,
}

/// Deformability of a block. Its material must have elastic moduli.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deformability {
    /// Kinematic model.
    pub model: DeformableModel,
    /// Cauchy stress at t = 0, tension positive; Pa.
    pub initial_stress: Voigt,
    /// Factor on the inertia of the strain modes, ≥ 1; 1 has no effect. Translation and
    /// rotation are unaffected. The added kinetic energy is a separate term of the ledger.
    pub strain_mass_factor: f64,
}

impl Default for Deformability {
    fn default() -> Self {
        Self {
            model: DeformableModel::Affine12(StressLaw::default()),
            initial_stress: [0.0; 6],
            strain_mass_factor: 1.0,
        }
    }
}

/// Common state of both deformable models: position, velocity and inertia of an affine body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct AffineBody {
    // State.
    /// `F`.
    pub gradient: Matrix3<f64>,
    /// `F'`; 1/s.
    pub rate: Matrix3<f64>,
    // Constants.
    /// `S₀`; kg m².
    pub second_moment: Matrix3<f64>,
    pub inverse_second_moment: Matrix3<f64>,
    /// `V₀`; m³.
    pub volume: f64,
    /// Factor on the inertia of strain modes.
    pub strain_mass_factor: f64,
}

impl AffineBody {
    /// At rest in its initial place, spinning with `spin` (rad/s).
    pub fn new(
        second_moment: Matrix3<f64>,
        volume: f64,
        spin: &Vec3,
        strain_mass_factor: f64,
    ) -> Option<Self> {
        Some(Self {
            gradient: Matrix3::identity(),
            rate: spin.cross_matrix(),
            inverse_second_moment: second_moment.try_inverse()?,
            second_moment,
            volume,
            strain_mass_factor,
        })
    }

    /// `F⁻¹`; the identity if the block has collapsed, which the check of the step reports.
    pub fn inverse_gradient(&self) -> Matrix3<f64> {
        self.gradient
            .try_inverse()
            .unwrap_or_else(Matrix3::identity)
    }

    /// `L = F' F⁻¹`; 1/s.
    pub fn velocity_gradient(&self) -> Matrix3<f64> {
        self.rate * self.inverse_gradient()
    }

    /// `S = F S₀ Fᵀ` at the current position; kg m².
    fn present_second_moment(&self) -> Matrix3<f64> {
        self.gradient * self.second_moment * self.gradient.transpose()
    }

    /// `J⁻¹`, `J = tr(S) I − S`; zero if the block has collapsed, which the check of the step reports; 1/(kg m²).
    pub fn inverse_inertia(&self) -> Matrix3<f64> {
        let second = self.present_second_moment();
        let inertia = Matrix3::identity() * second.trace() - second;
        inertia.try_inverse().unwrap_or_else(Matrix3::zeros)
    }

    /// `S⁻¹`; 1/(kg m²).
    pub fn present_inverse_second_moment(&self) -> Matrix3<f64> {
        let inverse = self.inverse_gradient();
        inverse.transpose() * self.inverse_second_moment * inverse
    }

    /// Kick by the moment of outer forces and a stress `P` (Pa).
    ///
    /// ```text
    /// F'' = (Σ f ⊗ r F⁻ᵀ − V₀ P) S₀⁻¹                                                      [1/s²]
    /// ```
    /// With mass scaling, the part of `F'' F⁻¹` that a rigid body would not have is divided by
    /// the factor: the torque, and with it the angular momentum, is not touched.
    fn kick(&mut self, moment: &Moment, stress: &Matrix3<f64>, dt: f64) {
        let inverse = self.inverse_gradient();
        let force = moment.matrix() * inverse.transpose() - stress * self.volume;
        let mut change = force * self.inverse_second_moment;
        if self.strain_mass_factor > 1.0 {
            let torque = axial(&(force * self.gradient.transpose())) * 2.0;
            let turning = self.inverse_inertia() * torque;
            let rigid = turning.cross_matrix() * self.gradient;
            change = rigid + (change - rigid) / self.strain_mass_factor;
        }
        self.rate += change * dt;
        self.rate.apply(|c| *c = flushed(*c));
    }

    /// `½ tr(F' S₀ F'ᵀ)`; J.
    fn kinetic_energy(&self) -> f64 {
        0.5 * (self.rate * self.second_moment).dot(&self.rate)
    }

    /// Kinetic energy added by the scaled inertia of the strain modes; J.
    pub fn added_kinetic_energy(&self) -> f64 {
        if self.strain_mass_factor <= 1.0 {
            return 0.0;
        }
        let spin = self.inverse_inertia() * self.angular_momentum();
        let straining = self.rate - spin.cross_matrix() * self.gradient;
        0.5 * (self.strain_mass_factor - 1.0) * (straining * self.second_moment).dot(&straining)
    }

    /// `Σ r × m v = 2 axial(F' S₀ Fᵀ)`; N m s.
    fn angular_momentum(&self) -> Vec3 {
        axial(&(self.rate * self.second_moment * self.gradient.transpose())) * 2.0
    }
}

/// Notch of the strain that the step bound knows; –.
const NOTCH: f64 = 5e-3;

/// A strain rounded up to a discrete level. A step that follows every oscillation of the strain would be shorter at larger
/// strain, in phase with the oscillation, and amplify it: a cube spinning without losses burst after
/// 74,000 steps.
fn in_notches(strain: f64) -> f64 {
    (strain / NOTCH).ceil() * NOTCH
}

/// Deformable block of either model, with its stress.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Deformable {
    Affine12(Affine12),
    Dda12(Dda12),
}

impl Deformable {
    pub fn body(&self) -> &AffineBody {
        match self {
            Self::Affine12(model) => &model.body,
            Self::Dda12(model) => &model.body,
        }
    }

    /// The exact affine motion, if that is the model.
    pub fn affine(&self) -> Option<&Affine12> {
        match self {
            Self::Affine12(model) => Some(model),
            Self::Dda12(_) => None,
        }
    }

    /// The exact affine motion, if that is the model.
    pub fn affine_mut(&mut self) -> Option<&mut Affine12> {
        match self {
            Self::Affine12(model) => Some(model),
            Self::Dda12(_) => None,
        }
    }

    pub fn motion(&mut self) -> &mut dyn InternalMotion {
        match self {
            Self::Affine12(model) => model,
            Self::Dda12(model) => model,
        }
    }

    /// Kinetic energy about the centroid; J.
    pub fn kinetic_energy(&self) -> f64 {
        self.body().kinetic_energy()
    }

    pub fn angular_momentum(&self) -> Vec3 {
        self.body().angular_momentum()
    }

    /// Rotation of the block: `R` of `F = R U`.
    pub fn rotation(&self) -> UnitQuaternion<f64> {
        let turn = polar_rotation(&self.body().gradient);
        UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(turn))
    }

    /// Cauchy stress, without its viscous part; Pa.
    pub fn stress(&self) -> Matrix3<f64> {
        match self {
            Self::Affine12(model) => model.cauchy_stress(),
            Self::Dda12(model) => model.stress,
        }
    }

    /// Green's strain `E = (FᵀF − I)/2`, in the axes of the start; –.
    pub fn strain(&self) -> Matrix3<f64> {
        green_strain(&self.body().gradient)
    }

    /// Kick by outer forces alone, beside those inside.
    pub fn push(&mut self, moment: &Moment, dt: f64) {
        let body = match self {
            Self::Affine12(model) => &mut model.body,
            Self::Dda12(model) => &mut model.body,
        };
        body.kick(moment, &Matrix3::zeros(), dt);
    }

    /// Lowest principal value of Green's strain; NaN if the state is not finite; –.
    pub fn lowest_strain(&self) -> f64 {
        let strain = self.strain();
        // No eigenvalue is below minus the norm: most blocks need no more.
        let bound = -strain.norm();
        if bound >= -0.1 || bound.is_nan() {
            return bound;
        }
        strain.symmetric_eigenvalues().min()
    }

    /// Elastic energy of the block; J.
    pub fn strain_energy(&self) -> f64 {
        match self {
            Self::Affine12(model) => model.strain_energy(),
            Self::Dda12(model) => model.strain_energy(),
        }
    }

    /// Dissipation by strain viscosity in the last drift; J.
    pub fn viscous_loss(&self) -> f64 {
        match self {
            Self::Affine12(model) => model.viscous_loss,
            Self::Dda12(model) => model.viscous_loss,
        }
    }

    /// Bound of the squared frequency of its strain modes and their damping ratio; 1/s², –.
    pub fn stiffness_rate(&self) -> (f64, f64) {
        let (elastic, body) = match self {
            Self::Affine12(model) => (&model.elastic, &model.body),
            Self::Dda12(model) => (&model.elastic, &model.body),
        };
        // Stretched by λ the stiffness of Saint Venant-Kirchhoff grows no faster than λ⁴.
        let stretch = 1.0 + 2.0 * in_notches(green_strain(&body.gradient).norm());
        let square = elastic.largest_square * stretch * stretch / body.strain_mass_factor;
        (square, elastic.damping_ratio(square.sqrt()))
    }

    /// Visits every number of the state.
    pub fn for_each_state_f64(&self, f: &mut dyn FnMut(f64)) {
        let body = self.body();
        body.gradient
            .iter()
            .chain(body.rate.iter())
            .for_each(|&c| f(c));
        match self {
            Self::Affine12(model) => model.viscous.iter().for_each(|&c| f(c)),
            Self::Dda12(model) => model
                .stress
                .iter()
                .chain(model.viscous.iter())
                .for_each(|&c| f(c)),
        }
    }
}

/// Constants of an elastic block with the given second moment (kg m²) and volume (m³).
pub(crate) fn elastic_constants(
    elastic: &Elastic,
    second_moment: &Matrix3<f64>,
    volume: f64,
) -> Constants {
    Constants::new(elastic, second_moment, volume)
}

/// Vector `a` with `[a]× = (A − Aᵀ)/2`.
pub(crate) fn axial(a: &Matrix3<f64>) -> Vec3 {
    0.5 * Vec3::new(
        a[(2, 1)] - a[(1, 2)],
        a[(0, 2)] - a[(2, 0)],
        a[(1, 0)] - a[(0, 1)],
    )
}

pub(crate) fn symmetric(a: &Matrix3<f64>) -> Matrix3<f64> {
    0.5 * (a + a.transpose())
}

/// `E = (FᵀF − I)/2`.
pub(crate) fn green_strain(gradient: &Matrix3<f64>) -> Matrix3<f64> {
    0.5 * (gradient.transpose() * gradient - Matrix3::identity())
}

/// `R` of `F = R U`, by Newton's iteration `R := (R + R⁻ᵀ)/2`. Source: Higham (1986).
pub(crate) fn polar_rotation(gradient: &Matrix3<f64>) -> Matrix3<f64> {
    let mut turn = *gradient;
    for _ in 0..20 {
        let Some(inverse) = turn.try_inverse() else {
            return Matrix3::identity();
        };
        let next = 0.5 * (turn + inverse.transpose());
        let change = (next - turn).norm();
        turn = next;
        if change <= 1e-15 {
            break;
        }
    }
    turn
}

pub(crate) fn tensor(voigt: &Voigt) -> Matrix3<f64> {
    let [xx, yy, zz, yz, zx, xy] = *voigt;
    Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz)
}

pub(crate) fn voigt(tensor: &Matrix3<f64>) -> Voigt {
    [
        tensor[(0, 0)],
        tensor[(1, 1)],
        tensor[(2, 2)],
        tensor[(1, 2)],
        tensor[(0, 2)],
        tensor[(0, 1)],
    ]
}
