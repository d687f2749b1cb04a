//! Damping in the search for a static equilibrium. It is not physical: each kind acts against motion in the
//! fixed frame, and only the final equilibrium of such a run is meaningful.

use crate::Vec3;

/// Damping for statics; its dissipation is a separate term of the ledger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StaticDamping {
    /// `f −= α m v`, α ≥ 0; 1/s.
    MassProportional(f64),
    /// `f −= α |f| sign(v)` for each component of force and torque, 0 ≤ α < 1. Source: Cundall (1987).
    Local(f64),
    /// `v := κ v` after each sub-step, 0 < κ ≤ 1: the dynamic coefficient of DDA, whose effect depends
    /// on the step.
    Kinetic(f64),
}

impl StaticDamping {
    /// Factor on all velocities after a sub-step of `dt` (s).
    pub(crate) fn velocity_factor(&self, dt: f64) -> f64 {
        match self {
            Self::MassProportional(alpha) => (-alpha * dt).exp(),
            Self::Local(_) => 1.0,
            Self::Kinetic(kappa) => *kappa,
        }
    }
}

/// `−α |f| sign(v)`, component by component.
pub(crate) fn local_damping(alpha: f64, force: &Vec3, velocity: &Vec3) -> Vec3 {
    force.zip_map(velocity, |f, v| {
        if v == 0.0 {
            0.0
        } else {
            -alpha * f.abs() * v.signum()
        }
    })
}
