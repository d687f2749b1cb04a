//! Contact dynamics: the contacts of a step solved together, without springs.
//!
//! All contacts of a step are one problem in the impulses `R` at their points, in local frames of the normal and two
//! tangents. `W` is the Delassus operator, `b` the velocities without contacts, with the shift of the impact rule in their normal part:
//!
//! ```text
//! U = b + W R                                           velocity of body B seen from A at the point        [m/s]
//! 0 ≤ U_n ⊥ R_n ≥ 0
//! |R_t| ≤ μ R_n;   |R_t| < μ R_n ⇒ U_t = 0;   |R_t| = μ R_n ⇒ U_t = −λ R_t, λ ≥ 0
//! ```
//! Rolling resistance is a pair of torques across the normal, rows of their own after those of the contacts, with `S` the torque over the
//! effective radius `R̃` and `V = R̃ ω_t` of the relative spin:
//!
//! ```text
//! |S| ≤ μ_r R_n;   |S| < μ_r R_n ⇒ V = 0;   |S| = μ_r R_n ⇒ V = −λ S, λ ≥ 0
//! ```
//!
//! Rows after those are fixed: `U = 0`, whatever the impulse. So are bonds, until they break.
//!
//! With `Û = (U_n + μ|U_t|, U_t)` of De Saxcé & Feng (1998) it is one statement: `R` in the cone `K_μ`, `Û` in its dual, at right angles.
//!
//! Reading order: [`one_contact`] solves one contact exactly; [`delassus`] is the operator of bodies, or a matrix; [`gauss_seidel`] and
//! [`gradient`] solve all of them, [`solver`] chooses; [`accuracy`] tells how far from the laws they are.
//!
//! Sources: Moreau (1999), Jean (1999), Acary & Brogliato (2008).

pub mod accuracy;
mod cone;
pub mod delassus;
pub mod gauss_seidel;
pub mod gradient;
pub(crate) mod kept;
pub mod one_contact;
pub mod solver;

use crate::Vec3;
use delassus::Delassus;

/// Residual above which a step counts as unsolved; –.
pub const UNSOLVED: f64 = 1e-2;

/// The contacts of a step; vectors in the local frames (n, t1, t2).
#[derive(Clone, Debug)]
pub struct ContactProblem<D> {
    /// From impulses to velocities.
    pub operator: D,
    /// Velocity of B seen from A without contacts, and the shift of its normal part; one per contact; m/s.
    pub free_velocity: Vec<Vec3>,
    /// Coefficient of friction; one per contact; –, >= 0.
    pub friction: Vec<f64>,
    /// Rolling resistance; rows of the operator and of the velocities after those of the contacts.
    pub rolling: Vec<Rolling>,
}

/// Law of a row.
#[derive(Clone, Copy, Debug)]
enum Law {
    /// Signorini's and Coulomb's, with the coefficient of friction; –.
    Contact(f64),
    /// Rolling resistance with its bound; N s.
    Rolling(f64),
    /// `U = 0` whatever the impulse.
    Fixed,
}

/// Rolling resistance of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rolling {
    /// The contact.
    pub contact: u32,
    /// `μ_r`; –.
    pub coefficient: f64,
}

impl<D: Delassus> ContactProblem<D> {
    /// Number of contacts.
    pub fn len(&self) -> usize {
        self.friction.len()
    }

    /// Whether nothing touches.
    pub fn is_empty(&self) -> bool {
        self.friction.is_empty()
    }

    /// Law of a row, with the normal impulses of contacts (N s).
    fn law(&self, a: usize, pressed: impl Fn(usize) -> f64) -> Law {
        if let Some(&friction) = self.friction.get(a) {
            return Law::Contact(friction);
        }
        match self.rolling.get(a - self.len()) {
            Some(rolling) => {
                Law::Rolling(rolling.coefficient * pressed(rolling.contact as usize).max(0.0))
            }
            None => Law::Fixed,
        }
    }

    /// Velocity `U_a` of a contact, of the velocities that all impulses give; m/s.
    fn velocity(&self, of_impulses: &D::Velocities, a: usize) -> Vec3 {
        self.free_velocity[a] + self.operator.velocity(of_impulses, a)
    }
}
