//! Damping in the search for a static equilibrium. It is not physical: each kind acts against motion in the
//! fixed frame, and only the final equilibrium of such a run is meaningful.

use crate::{StaticDamping, Vec3};

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
