//! Isotropic elasticity: stresses, energies, and the frequencies of a free affine block.

use super::{green_strain, polar_rotation, symmetric};
use crate::{Elastic, StressLaw};
use nalgebra::{Matrix3, SMatrix, SymmetricEigen};
use serde::{Deserialize, Serialize};

/// Constants of an elastic block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Constants {
    /// Lamé's constants; Pa.
    pub lambda: f64,
    pub mu: f64,
    /// `η_s` of the strain rate; Pa s.
    pub viscosity: f64,
    /// Square of the largest natural frequency of the free block; 1/s².
    pub largest_square: f64,
}

impl Constants {
    pub fn new(elastic: &Elastic, second_moment: &Matrix3<f64>, volume: f64) -> Self {
        let (lambda, mu) = lame(elastic);
        let largest_square = frequency_squares(lambda, mu, second_moment, volume)
            .into_iter()
            .fold(0.0, f64::max);
        Self {
            lambda,
            mu,
            viscosity: elastic.viscosity,
            largest_square,
        }
    }

    /// `λ tr(e) I + 2μ e`; Pa.
    pub fn linear(&self, strain: &Matrix3<f64>) -> Matrix3<f64> {
        Matrix3::identity() * (self.lambda * strain.trace()) + strain * (2.0 * self.mu)
    }

    /// Inverse of [`linear`](Self::linear).
    pub fn strain_of(&self, stress: &Matrix3<f64>) -> Matrix3<f64> {
        let share = self.lambda / (3.0 * self.lambda + 2.0 * self.mu);
        (stress - Matrix3::identity() * (share * stress.trace())) / (2.0 * self.mu)
    }

    /// First Piola stress `P`; Pa.
    pub fn first_piola(&self, law: StressLaw, gradient: &Matrix3<f64>) -> Matrix3<f64> {
        match law {
            StressLaw::SaintVenantKirchhoff => gradient * self.linear(&green_strain(gradient)),
            StressLaw::Corotational => {
                let turn = polar_rotation(gradient);
                turn * self
                    .linear(&(symmetric(&(turn.transpose() * gradient)) - Matrix3::identity()))
            }
        }
    }

    /// Energy density; J/m³.
    ///
    /// ```text
    /// W = λ/2 tr(e)² + μ e:e                         e = E, or U − I
    /// ```
    pub fn energy_density(&self, law: StressLaw, gradient: &Matrix3<f64>) -> f64 {
        let strain = match law {
            StressLaw::SaintVenantKirchhoff => green_strain(gradient),
            StressLaw::Corotational => {
                symmetric(&(polar_rotation(gradient).transpose() * gradient)) - Matrix3::identity()
            }
        };
        0.5 * self.linear(&strain).dot(&strain)
    }

    /// Viscous part of the first Piola stress, `F 2η_s E'`; Pa.
    pub fn viscous_piola(&self, gradient: &Matrix3<f64>, rate: &Matrix3<f64>) -> Matrix3<f64> {
        gradient * symmetric(&(gradient.transpose() * rate)) * (2.0 * self.viscosity)
    }

    /// Ratio of the viscosity in a shear mode of frequency `omega`, `ξ = η ω/(2μ)`; other modes have
    /// less.
    pub fn damping_ratio(&self, omega: f64) -> f64 {
        0.5 * self.viscosity / self.mu * omega
    }
}

fn lame(elastic: &Elastic) -> (f64, f64) {
    let (e, nu) = (elastic.young_modulus, elastic.poisson_ratio);
    (
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        e / (2.0 * (1.0 + nu)),
    )
}

/// Squared frequencies of small strains and rotations of the free block, from
///
/// ```text
/// H'' S₀ = −V₀ C : sym H            with Z = H √S₀:   Z'' = −V₀ (C : sym(Z √S₀⁻¹)) √S₀⁻¹
/// ```
/// which is symmetric; nine values, three of them zero.
fn frequency_squares(lambda: f64, mu: f64, second_moment: &Matrix3<f64>, volume: f64) -> [f64; 9] {
    let eigen = SymmetricEigen::new(*second_moment);
    let root = eigen.eigenvectors
        * Matrix3::from_diagonal(&eigen.eigenvalues.map(|s| 1.0 / s.sqrt()))
        * eigen.eigenvectors.transpose();
    let mut operator = SMatrix::<f64, 9, 9>::zeros();
    for k in 0..9 {
        let mut z = Matrix3::zeros();
        z[k] = 1.0;
        let strain = symmetric(&(z * root));
        let stress = Matrix3::identity() * (lambda * strain.trace()) + strain * (2.0 * mu);
        let image = stress * root * volume;
        for i in 0..9 {
            operator[(i, k)] = image[i];
        }
    }
    let mut squares = [0.0; 9];
    for (square, &value) in squares
        .iter_mut()
        .zip(SymmetricEigen::new(operator).eigenvalues.iter())
    {
        *square = value.max(0.0);
    }
    squares.sort_by(f64::total_cmp);
    squares
}

/// Natural frequencies of a free elastic block that deforms linearly, sorted; the first three are
/// its rotations, zero; rad/s.
///
/// `second_moment` is `∫ ρ X Xᵀ dV` about the centroid (kg m²), `volume` in m³. For a cube of side a:
///
/// ```text
/// ω = √(12 E/((1 + ν) ρ))/a five times,      √(12 E/((1 − 2ν) ρ))/a once
/// ```
pub fn natural_frequencies(
    elastic: &Elastic,
    second_moment: &Matrix3<f64>,
    volume: f64,
) -> [f64; 9] {
    let (lambda, mu) = lame(elastic);
    frequency_squares(lambda, mu, second_moment, volume).map(f64::sqrt)
}
