//! State at the start of a step, for steppings that predict.

use crate::Vec3;
use crate::particles::filter;

/// State at the start of a step, while [`Fluid::predict`](crate::Fluid::predict) has taken the particles half way; empty otherwise.
#[derive(Clone, Debug, Default)]
pub(crate) struct AtStart {
    /// m/s.
    pub velocity: Vec<Vec3>,
    /// Empty where density is not advanced; kg/m³.
    pub density: Vec<f64>,
}

impl AtStart {
    /// Velocity and density of a particle at the start of the step, where they are another.
    pub(crate) fn of(&self, a: usize) -> (Option<Vec3>, Option<f64>) {
        (self.velocity.get(a).copied(), self.density.get(a).copied())
    }

    /// Keeps the particles whose flag is set, in order.
    pub(crate) fn retain(&mut self, keep: &[bool]) {
        filter(&mut self.velocity, keep);
        filter(&mut self.density, keep);
    }
}
