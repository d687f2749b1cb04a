//! The two sides of a contact: a sphere, or any other body.

use crate::Vec3;
use crate::motion::kinematics::{Kinematics, LeverArm};

/// One side of a contact. A sphere answers without its inertia tensor.
pub(super) trait Side {
    fn kinematics(&self) -> &Kinematics;
    /// m/s.
    fn velocity_at(&self, x: &Vec3) -> Vec3;
    /// See [`Kinematics::compliance`]; 1/kg.
    fn compliance(&self, x: &Vec3, n: &Vec3) -> f64;
    /// See [`Kinematics::compliance_trace`], of a sphere what no overlap exceeds; 1/kg.
    fn compliance_trace(&self, x: &Vec3) -> f64;
    /// Upper bounds of the compliance along the normal and across it; 1/kg.
    fn largest_compliances(&self, lever_arm: &LeverArm) -> (f64, f64);
    /// `tr J⁻¹`; 1/(kg m²).
    fn turning_trace(&self) -> f64;
    /// Spin opposed by [`RollingLaw::OwnSpin`](crate::RollingLaw::OwnSpin), nonzero for spheres only; rad/s.
    fn own_spin(&self) -> Vec3;

    /// Velocity of the material that was at `x` before the drift of the last `dt` (s); m/s.
    fn velocity_from(&self, x: &Vec3, dt: f64) -> Vec3 {
        self.velocity_at(&(x + self.kinematics().velocity * dt))
    }

    /// Do its compliances stay what they are?
    fn has_steady_rates(&self) -> bool {
        self.kinematics().inverse_mass == 0.0
    }

    /// Twice as much for the other side if this one gives way.
    fn twice(&self) -> f64 {
        if self.kinematics().inverse_mass > 0.0 {
            2.0
        } else {
            1.0
        }
    }
}

/// A sphere and its radius (m).
pub(super) struct Ball<'a>(pub &'a Kinematics, pub f64);

impl Side for Ball<'_> {
    fn kinematics(&self) -> &Kinematics {
        self.0
    }

    fn velocity_at(&self, x: &Vec3) -> Vec3 {
        self.0.velocity + self.0.spin.cross(&(x - self.0.centroid))
    }

    fn compliance(&self, _: &Vec3, _: &Vec3) -> f64 {
        self.0.inverse_mass
    }

    /// The arm is the radius less half the overlap. With the radius itself the bound stays the same for as long
    /// as two spheres touch, and need not be summed again in every step.
    fn compliance_trace(&self, _: &Vec3) -> f64 {
        3.0 * self.0.inverse_mass + 2.0 * self.0.inverse_inertia.m11 * (self.1 * self.1)
    }

    fn largest_compliances(&self, _: &LeverArm) -> (f64, f64) {
        let turning = self.0.inverse_inertia.m11 * (self.1 * self.1);
        (self.0.inverse_mass, self.0.inverse_mass + turning)
    }

    fn turning_trace(&self) -> f64 {
        3.0 * self.0.inverse_inertia.m11
    }

    fn own_spin(&self) -> Vec3 {
        self.0.spin
    }

    fn has_steady_rates(&self) -> bool {
        true
    }
}

/// Any other body.
pub(super) struct Body<'a>(pub &'a Kinematics);

impl Side for Body<'_> {
    fn kinematics(&self) -> &Kinematics {
        self.0
    }

    fn velocity_at(&self, x: &Vec3) -> Vec3 {
        self.0.velocity_at(x)
    }

    fn compliance(&self, x: &Vec3, n: &Vec3) -> f64 {
        self.0.compliance(x, n)
    }

    fn compliance_trace(&self, x: &Vec3) -> f64 {
        self.0.compliance_trace(x)
    }

    fn largest_compliances(&self, lever_arm: &LeverArm) -> (f64, f64) {
        let largest = match self.0.inverse_mass > 0.0 {
            true => self.0.largest_compliance(lever_arm),
            false => 0.0,
        };
        (largest, largest)
    }

    fn turning_trace(&self) -> f64 {
        self.0.inverse_inertia.trace()
    }

    fn own_spin(&self) -> Vec3 {
        Vec3::zeros()
    }
}
