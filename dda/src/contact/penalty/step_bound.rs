//! Share of a contact in the bound of the stable step.

use crate::StepBound;
use crate::contact::rates::Rates;
use crate::motion::kinematics::{Kinematics, LeverArm};

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

/// A body of a contact that may form, and its lever arm.
pub(super) type Levered<'a> = (&'a Kinematics, &'a LeverArm);

impl Springs {
    /// Rates of a contact that may form in the next step, for its two bodies, at their worst points.
    ///
    /// Compliances of one body are twice as much against a partner that is free. Eigenvalues are those of the two alone,
    ///
    /// ```text
    /// Λ_K = max(k_n, k_t) (w_i + w_j)                                                            [1/s²]
    /// Λ_C = max(2 ξ_n √(k_n (w_i + w_j)), 2 ξ_t √(k_t/(1/m_i + 1/m_j)) (w_i + w_j))              [1/s]
    /// ```
    /// with `w` the largest compliances: the dashpot along the normal is that of the mobility at the contact.
    pub fn before_touch(&self, bodies: (Levered, Levered), bound: StepBound) -> (Rates, Rates) {
        let is_free = |body: &Kinematics| body.inverse_mass > 0.0;
        let (a, b) = bodies;
        let of = |body: &Kinematics, rates: Rates| {
            if is_free(body) {
                rates
            } else {
                Rates::default()
            }
        };
        match bound {
            StepBound::Compliances => {
                let twice = |partner: &Kinematics| if is_free(partner) { 2.0 } else { 1.0 };
                (
                    of(a.0, self.by_compliances(a).times(twice(b.0))),
                    of(b.0, self.by_compliances(b).times(twice(a.0))),
                )
            }
            StepBound::Eigenvalues => {
                let largest = |(body, lever_arm): Levered| {
                    if is_free(body) {
                        body.largest_compliance(lever_arm)
                    } else {
                        0.0
                    }
                };
                let compliance = largest(a) + largest(b);
                let rates = self.of_two(compliance, compliance);
                (of(a.0, rates), of(b.0, rates))
            }
        }
    }

    fn by_compliances(&self, (body, lever_arm): Levered) -> Rates {
        let dashpot = |k: f64, ratio: f64| 2.0 * ratio * (k / self.mobility).sqrt();
        let (k_n, k_t) = self.stiffness;
        let (xi_n, xi_t) = self.damping_ratio;
        let (along, sum) = body.worst_compliance(lever_arm.length);
        let across = sum - along;
        Rates {
            stiffness: k_n * along + k_t * across,
            damping: dashpot(k_n, xi_n) * along + dashpot(k_t, xi_t) * across,
        }
    }

    /// Largest eigenvalues of two bodies held by nothing else, of sums of compliances along the normal and across it; 1/kg.
    pub fn of_two(&self, along: f64, across: f64) -> Rates {
        let (k_n, k_t) = self.stiffness;
        let (xi_n, xi_t) = self.damping_ratio;
        let damping_along = 2.0 * xi_n * (k_n * along).sqrt();
        let damping_across = 2.0 * xi_t * (k_t / self.mobility).sqrt() * across;
        Rates {
            stiffness: f64::max(k_n * along, k_t * across),
            damping: damping_along.max(damping_across),
        }
    }
}
