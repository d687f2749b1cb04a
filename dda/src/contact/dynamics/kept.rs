//! State that contact dynamics keeps from step to step.

use crate::Vec3;
use serde::{Deserialize, Serialize};

/// Impulse at a point of two parts, from which the next step starts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptImpulse {
    pub parts: (u32, u32),
    /// World; m.
    pub position: Vec3,
    /// On the second; N s.
    pub impulse: Vec3,
    /// Of the step; s.
    pub dt: f64,
}

/// Contacts of the last step of contact dynamics, and how far their impulses are from the laws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactSolution {
    /// Points at which parts touched or were near.
    pub n_contacts: usize,
    /// Sweeps and iterations.
    pub n_iterations: usize,
    /// Residual of the laws; –.
    pub residual: f64,
}
