//! Damping in the search for a static equilibrium. It is not physical: each kind acts against motion in the
//! fixed frame, and only the final equilibrium of such a run is meaningful.

use crate::motion::kinematics::{InternalMotion, flushed};
use crate::{Blocks, Load, StaticDamping, Vec3};

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

impl Blocks {
    /// Damping that scales velocities, if the settings ask for it.
    pub(crate) fn damp(&mut self, dt: f64) {
        let Some(damping) = self.constants.settings.static_damping else {
            return;
        };
        let factor = damping.velocity_factor(dt);
        if factor == 1.0 {
            return;
        }
        for b in 0..self.n_blocks() {
            if !self.is_free(b) {
                continue;
            }
            self.state
                .totals
                .static_damping
                .book((1.0 - factor * factor) * self.kinetic_energy(b));
            self.state.totals.support_impulse +=
                self.state.velocity[b] * (self.constants.mass[b] * (factor - 1.0));
            let momentum = self.accounted_momentum(b);
            self.state.velocity[b].apply(|c| *c = flushed(*c * factor));
            match self.constants.deformable_of[b] {
                None => self.rigid(b).scale_velocities(factor),
                Some(k) => self.state.deformables[k as usize]
                    .motion()
                    .scale_velocities(factor),
            }
            self.account_restraint(b, momentum, &Load::default());
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
