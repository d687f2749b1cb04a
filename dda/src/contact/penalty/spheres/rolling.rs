//! Rolling resistance: a spring and a dashpot of turning.

use super::{Law, sides::Side};
use crate::Vec3;
use crate::contact::detection::manifold::PointManifold;
use crate::contact::penalty::friction::carry;
use crate::contact::rates::Rates;
use crate::contact::tally::Tally;
use crate::material::RollingLaw;
use serde::{Deserialize, Serialize};

/// Memory of the rolling spring of a touching pair; only where a material resists rolling.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Rolling {
    /// `θ`, of i and of j on their own, or of j against i and nothing; rad.
    pub angles: (Vec3, Vec3),
    /// On i and j; N m.
    pub torques: (Vec3, Vec3),
    /// `k_r`; N m.
    pub stiffness: f64,
}

impl Rolling {
    pub fn energy(&self) -> f64 {
        0.5 * self.stiffness * (self.angles.0.norm_squared() + self.angles.1.norm_squared())
    }

    pub fn for_each_state_f64(&self, f: &mut dyn FnMut(f64)) {
        for v in [
            &self.angles.0,
            &self.angles.1,
            &self.torques.0,
            &self.torques.1,
        ] {
            v.iter().for_each(|&c| f(c));
        }
    }

    /// Dashpots of i and j, of their [`Kinematics::rolling_mobility`]; what cannot turn needs none on its own; N m s.
    pub fn dashpots(&self, law: RollingLaw, mobilities: (f64, f64)) -> (f64, f64) {
        let of = |mobility: f64| match mobility > 0.0 {
            true => 2.0 * ROLLING_DAMPING_RATIO * (self.stiffness / mobility).sqrt(),
            false => 0.0,
        };
        match law {
            RollingLaw::Relative => {
                let dashpot = of(mobilities.0 + mobilities.1);
                (dashpot, dashpot)
            }
            RollingLaw::OwnSpin => (of(mobilities.0), of(mobilities.1)),
        }
    }

    /// Rates of a pair that may touch, of a normal stiffness (N/m).
    pub(super) fn rates_before_touch<A: Side, B: Side>(
        law: &Law,
        normal_stiffness: f64,
        sides: &(A, B),
    ) -> Rates {
        let mobilities = (
            sides.0.kinematics().rolling_mobility(),
            sides.1.kinematics().rolling_mobility(),
        );
        let rolling = Self {
            stiffness: law.rolling_stiffness(normal_stiffness),
            ..Self::default()
        };
        let dashpots = rolling.dashpots(law.rolling_law, mobilities);
        Rates {
            stiffness: rolling.stiffness * (mobilities.0 + mobilities.1),
            damping: dashpots.0 * mobilities.0 + dashpots.1 * mobilities.1,
        }
    }

    /// Books half a step (s) of the torques.
    #[inline]
    pub(super) fn book_half<A: Side, B: Side>(&self, dt: f64, sides: &(A, B), tally: &mut Tally) {
        let (a, b) = (sides.0.kinematics(), sides.1.kinematics());
        let power = self.torques.0.dot(&a.spin) + self.torques.1.dot(&b.spin);
        tally.friction -= 0.5 * dt * power;
        tally.rolling_impulse += (self.torques.0 + self.torques.1) * (0.5 * dt);
    }
}

impl Law<'_> {
    /// `k_r`, of a normal stiffness (N/m); N m.
    fn rolling_stiffness(&self, normal_stiffness: f64) -> f64 {
        let arm = self.joint.rolling_friction * self.effective_radius;
        2.25 * normal_stiffness * arm * arm
    }
}

/// Damping ratio of the rolling dashpot while its spring holds; –.
const ROLLING_DAMPING_RATIO: f64 = 0.3;

impl Rolling {
    /// Advances the springs by the turning of a step and finds the torques, each at most `limit` (N m). Returns
    /// the dashpot of each side; N m s.
    #[inline]
    pub(super) fn apply<A: Side, B: Side>(
        &mut self,
        law: &Law,
        found: &PointManifold,
        normal_stiffness: f64,
        sides: &(A, B),
        limit: f64,
    ) -> (f64, f64) {
        let n = found.normal;
        let (a, b) = (sides.0.kinematics(), sides.1.kinematics());
        let stiffness = law.rolling_stiffness(normal_stiffness);
        let kept = if stiffness > self.stiffness {
            self.stiffness / stiffness
        } else {
            1.0
        };
        self.stiffness = stiffness;
        let spring = |angle: Vec3, rate: Vec3, dashpot: f64| {
            let torque = -angle * stiffness - rate * dashpot;
            let size = torque.norm();
            if size > limit {
                let torque = torque * (limit / size);
                (torque * (-1.0 / stiffness), torque)
            } else {
                (angle, torque)
            }
        };
        let mobilities = (a.rolling_mobility(), b.rolling_mobility());
        let dashpots = self.dashpots(law.rolling_law, mobilities);
        match law.rolling_law {
            RollingLaw::Relative => {
                let turning = b.spin - a.spin;
                let rolling = turning - n * turning.dot(&n);
                let spin = 0.5 * (a.spin + b.spin).dot(&n) * law.dt;
                let angle = carry(&self.angles.0, &n, spin) * kept + rolling * law.dt;
                let (angle, torque) = spring(angle, rolling, dashpots.0);
                self.angles.0 = angle;
                self.torques = (-torque, torque);
            }
            RollingLaw::OwnSpin => {
                let own = |angle: Vec3, rate: Vec3, dashpot: f64| {
                    spring(angle * kept + rate * law.dt, rate, dashpot)
                };
                let first = own(self.angles.0, sides.0.own_spin(), dashpots.0);
                let second = own(self.angles.1, sides.1.own_spin(), dashpots.1);
                self.angles = (first.0, second.0);
                self.torques = (first.1, second.1);
            }
        }
        dashpots
    }
}
