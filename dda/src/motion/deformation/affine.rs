//! Exact affine motion with a hyperelastic law.

use super::{AffineBody, elastic::Constants};
use crate::StressLaw;
use crate::motion::kinematics::{InternalMotion, Moment};
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

/// `F'' S₀ = Σ f ⊗ X − V₀ P(F)`, stepped by kick, drift, kick: the force of an instant acts in the
/// half kicks on both sides of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Affine12 {
    pub body: AffineBody,
    pub law: StressLaw,
    pub elastic: Constants,
    /// Second Piola stress at the start; Pa.
    pub initial_stress: Matrix3<f64>,
    /// Viscous part of `P`, of the last half step's rate; state, since it acts in the next kick; Pa.
    pub viscous: Matrix3<f64>,
    /// Energy that it took in the last drift; J.
    pub viscous_loss: f64,
}

impl Affine12 {
    pub fn new(
        body: AffineBody,
        law: StressLaw,
        elastic: Constants,
        initial_stress: Matrix3<f64>,
    ) -> Self {
        Self {
            body,
            law,
            elastic,
            initial_stress,
            viscous: Matrix3::zeros(),
            viscous_loss: 0.0,
        }
    }

    /// `P`, without its viscous part; Pa.
    pub(super) fn first_piola(&self) -> Matrix3<f64> {
        let gradient = &self.body.gradient;
        self.elastic.first_piola(self.law, gradient) + gradient * self.initial_stress
    }

    /// `σ = P Fᵀ/det F`; Pa.
    pub fn cauchy_stress(&self) -> Matrix3<f64> {
        let gradient = &self.body.gradient;
        self.first_piola() * gradient.transpose() / gradient.determinant()
    }

    /// `V₀ (W + S_i : E)`; J.
    pub fn strain_energy(&self) -> f64 {
        let gradient = &self.body.gradient;
        let density = self.elastic.energy_density(self.law, gradient)
            + self.initial_stress.dot(&super::green_strain(gradient));
        self.body.volume * density
    }
}

impl InternalMotion for Affine12 {
    fn kick(&mut self, moment: &Moment, dt: f64) {
        let stress = self.first_piola() + self.viscous;
        self.body.kick(moment, &stress, dt);
    }

    fn drift(&mut self, dt: f64) {
        let rate = self.body.rate;
        let work = |viscous: &Matrix3<f64>| 0.5 * dt * self.body.volume * viscous.dot(&rate);
        let before = work(&self.viscous);
        self.body.gradient += rate * dt;
        if self.elastic.viscosity > 0.0 {
            let viscous = self.elastic.viscous_piola(&self.body.gradient, &rate);
            self.viscous_loss = before + work(&viscous);
            self.viscous = viscous;
        }
    }

    fn scale_velocities(&mut self, factor: f64) {
        self.body.rate *= factor;
    }
}
