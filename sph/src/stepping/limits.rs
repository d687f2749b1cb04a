//! Limits of the step by cause.

use rayon::prelude::*;

use crate::scheme::{DensityMethod, ViscousStep};
use crate::settings::StepLimits;
use crate::{Fluid, Settings, Vec3};

impl Settings {
    /// Limit of sound times its speed; m.
    fn sound_length(&self) -> f64 {
        match self.scheme.density {
            DensityMethod::Summation => 0.95 * self.support_radius(),
            DensityMethod::Continuity => super::sound_limit(&self.scheme) * self.smoothing_length,
        }
    }

    /// Largest step with explicit viscosity (m²/s), see [`Fluid::step_limits`]; s.
    pub fn viscous_limit(&self, kinematic_viscosity: f64) -> f64 {
        let (h, support) = (self.smoothing_length, self.support_radius());
        let share = match self.scheme.density {
            DensityMethod::Summation => 0.127 * support * support,
            DensityMethod::Continuity if self.scheme.viscosity.is_after_morris() => 0.25 * h * h,
            DensityMethod::Continuity => 0.10 * h * h,
        };
        self.time_step_factor * share / kinematic_viscosity
    }

    /// Step limit of sound in a fluid at rest over that of explicit viscosity (m²/s); –.
    pub fn sound_over_viscous_limit(&self, kinematic_viscosity: f64) -> f64 {
        let sound = self.time_step_factor * self.sound_length() / self.sound_speed;
        sound / self.viscous_limit(kinematic_viscosity)
    }
}

impl Fluid {
    /// Largest steps by cause at the present state; s.
    ///
    /// ```text
    /// summation    sound 0.95 H/(c₀ + max|v|)   viscosity 0.127 H² ρ₀/μ   force 0.5 √(h/max|a|)
    /// continuity   sound s h/(c₀ + max|v|)      viscosity 0.10 h²/ν       force 0.5 √(h/max|a|)
    ///   predictor-corrector   0.59 ∛(δ/0.1) h/(c₀ + max|v|)
    /// ```
    /// each times the time-step factor. `s` is 1 without bulk viscosity, 0.98, 0.96, 0.92, 0.63 with `α₂` of 0.05, 0.1, 0.2,
    /// 1: the limit of a lattice falls as much. Viscosity after Morris has 0.25 h²/ν. The limits of sound and
    /// viscosity of summation are those of a lattice; those of continuity are a share of them: on a
    /// lattice sound allows 1.75 h/c₀ without and 1.54 with the usual density diffusion. Viscosity
    /// allows 0.112 to 0.128 h²/ν along lines of centers, where one wave has all of the 2(d + 2), and
    /// 0.29 to 0.32 after Morris; a wall that does not slip mirrors velocities and takes some of that.
    /// That of the force is the customary one at a factor of 0.5. Where viscosity varies ν is the largest of any particle over ρ₀. Implicit
    /// viscous steps have no limit of viscosity.
    pub fn step_limits(&self) -> StepLimits {
        let s = &self.settings;
        StepLimits {
            sound: s.time_step_factor * s.sound_length() / (s.sound_speed + self.max_speed()),
            viscosity: match s.scheme.viscous_step {
                ViscousStep::Implicit => f64::INFINITY,
                ViscousStep::Explicit => s.viscous_limit(self.largest_kinematic_viscosity()),
            },
            force: s.time_step_factor
                * 0.5
                * (s.smoothing_length / largest_norm(&self.particles.acceleration)).sqrt(),
        }
    }

    /// Largest kinematic viscosity of any particle; m²/s.
    fn largest_kinematic_viscosity(&self) -> f64 {
        if !self.varies_viscosity() {
            return self.settings.kinematic_viscosity();
        }
        let viscosity = self.particles.viscosity.par_iter().with_min_len(4096);
        viscosity.copied().reduce(|| 0.0, f64::max) / self.settings.reference_density
    }

    /// Largest particle speed; m/s.
    pub fn max_speed(&self) -> f64 {
        largest_norm(&self.particles.velocity)
    }
}

/// Largest length of a list of vectors. A maximum is the same in any order.
fn largest_norm(vectors: &[Vec3]) -> f64 {
    vectors
        .par_iter()
        .with_min_len(4096)
        .map(|v| v.norm_squared())
        .reduce(|| 0.0, f64::max)
        .sqrt()
}
