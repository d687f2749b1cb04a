//! Share of a contact in the bound of the stable step.

use crate::contact::rates::Rates;
use crate::contact::report::PointState;
use crate::motion::kinematics::Kinematics;
use crate::{StepBound, Vec3};

/// Springs that a contact would have, and their damping ratios.
#[derive(Clone, Copy)]
pub(super) struct Springs {
    /// Normal and shear; N/m.
    pub stiffness: (f64, f64),
    /// Normal and shear; –.
    pub damping_ratio: (f64, f64),
    /// Sum of the inverse masses; 1/kg.
    pub mobility: f64,
}

impl Springs {
    /// Rates of a contact that may form in the next step, at the worst point of the body within its lever (m).
    pub fn before_touch(&self, body: &Kinematics, lever: f64, bound: StepBound) -> Rates {
        let dashpot = |k: f64, ratio: f64| 2.0 * ratio * (k / self.mobility).sqrt();
        let (k_n, k_t) = self.stiffness;
        let (xi_n, xi_t) = self.damping_ratio;
        let (c_n, c_t) = (dashpot(k_n, xi_n), dashpot(k_t, xi_t));
        match bound {
            StepBound::Compliances => {
                let (along, sum) = body.worst_compliance(lever);
                let across = sum - along;
                Rates {
                    stiffness: k_n * along + k_t * across,
                    damping: c_n * along + c_t * across,
                }
            }
            StepBound::Eigenvalues => {
                let largest = body.largest_compliance(lever);
                Rates {
                    stiffness: k_n.max(k_t) * largest,
                    damping: c_n.max(c_t) * largest,
                }
            }
        }
    }
}

/// Stiffness and dashpots of a patch of one normal that touches.
#[derive(Clone, Copy)]
pub(super) struct PatchSprings<'a> {
    pub points: &'a [PointState],
    /// Unit.
    pub normal: Vec3,
    /// Normal of a unit of weight and shear of the whole; N/m, or Pa/m and N/m.
    pub stiffness: (f64, f64),
    /// Normal of a unit of weight and shear of the whole; N s/m.
    pub dashpots: (f64, f64),
    pub is_bonded: bool,
}

impl PatchSprings<'_> {
    /// Rates of one of the bodies. Shear stiffness lies where the pressure is, that of a bond where its patch is.
    pub fn rates(&self, body: &Kinematics) -> Rates {
        let total: f64 = self.points.iter().map(|p| p.at.weight).sum();
        let normal: f64 = self.points.iter().map(|p| p.normal_force.max(0.0)).sum();
        let (mut along, mut across) = (0.0, 0.0);
        for point in self.points {
            let x = &point.at.position;
            let compliance = body.compliance(x, &self.normal);
            along += point.at.weight * compliance;
            let share = if self.is_bonded || normal <= 0.0 {
                point.at.weight / total
            } else {
                point.normal_force.max(0.0) / normal
            };
            across += share * (body.compliance_trace(x) - compliance);
        }
        Rates {
            stiffness: self.stiffness.0 * along + self.stiffness.1 * across,
            damping: self.dashpots.0 * along + self.dashpots.1 * across,
        }
    }
}
