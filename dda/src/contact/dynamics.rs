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
//! With `Û = (U_n + μ|U_t|, U_t)` of De Saxcé & Feng (1998) it is one statement: `R` in the cone `K_μ`, `Û` in its dual, at right angles.
//! Joints are rows like contacts, with all of space or a line as their cone.
//!
//! Reading order: [`one_contact`] solves one contact exactly, [`bilateral`] a joint; [`delassus`] is the operator of bodies, or a matrix; [`gauss_seidel`] and
//! [`gradient`] solve all of them, [`solver`] chooses; [`accuracy`] tells how far from the laws they are.
//!
//! Sources: Moreau (1999), Jean (1999), Acary & Brogliato (2008).

pub mod accuracy;
pub mod bilateral;
mod cone;
pub mod delassus;
pub mod gauss_seidel;
pub mod gradient;
pub(crate) mod kept;
pub mod one_contact;
pub mod solver;

use crate::Vec3;
use bilateral::Bilateral;
use delassus::Delassus;
use nalgebra::Matrix3;

/// The contacts of a step and its joints, which are the last rows; vectors in the local frames (n, t1, t2).
#[derive(Clone, Debug)]
pub struct ContactProblem<D> {
    /// From impulses to velocities.
    pub operator: D,
    /// Velocity of B seen from A without impulses at the rows, and the shift of its normal part; one per row; m/s.
    pub free_velocity: Vec<Vec3>,
    /// Coefficient of friction; one per contact; –, >= 0.
    pub friction: Vec<f64>,
    /// Laws of the joints, whose rows follow those of the contacts.
    pub joints: Vec<Bilateral>,
}

/// Law of a row.
enum Law<'a> {
    /// Of a contact with a coefficient of friction.
    Contact(f64),
    Joint(&'a Bilateral),
}

impl<D: Delassus> ContactProblem<D> {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.friction.len() + self.joints.len()
    }

    /// Whether nothing touches, and nothing is joined.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn law(&self, a: usize) -> Law<'_> {
        match self.friction.get(a) {
            Some(&friction) => Law::Contact(friction),
            None => Law::Joint(&self.joints[a - self.friction.len()]),
        }
    }

    /// Impulse (N s) by which a row of free velocity `b` (m/s) obeys its law, the other rows as they are. `slip` as in [`one_contact`].
    fn impulse(&self, a: usize, b: &Vec3, slip: &mut f64) -> Vec3 {
        let w = self.operator.diagonal(a);
        match self.law(a) {
            Law::Contact(friction) => one_contact::impulse(w, b, friction, slip),
            Law::Joint(joint) => joint.impulse(w, b),
        }
    }

    /// Shift of the normal velocity that makes a row one of a cone and its dual: De Saxcé's of a contact, that of the length of a rod; m/s.
    fn shift(&self, a: usize, velocity: &Vec3) -> f64 {
        match self.law(a) {
            Law::Contact(friction) => friction * cone::tangential(velocity),
            Law::Joint(joint) => joint.shift(velocity),
        }
    }

    /// Nearest point of the cone of a row, for impulses over a scale.
    fn projected(&self, a: usize, scaled: &Vec3, scale: f64) -> Vec3 {
        match self.law(a) {
            Law::Contact(friction) => cone::projected(friction, scaled),
            Law::Joint(joint) => joint.projected(scaled, scale),
        }
    }

    /// Mass that a row feels: `3/tr W_aa`, of a rod `1/W_nn`; kg. 1 where impulses move nothing.
    fn mass(&self, a: usize) -> f64 {
        let w = self.operator.diagonal(a);
        let (n, compliance) = match self.law(a) {
            Law::Joint(Bilateral::Rod(_)) => (1.0, w[(0, 0)]),
            Law::Contact(_) | Law::Joint(Bilateral::Point { .. }) => (3.0, w.trace()),
        };
        if 0.0 < compliance {
            n / compliance
        } else {
            1.0
        }
    }

    /// The part of a vector in which a row acts.
    fn acting(&self, a: usize, v: &Vec3) -> Vec3 {
        match self.law(a) {
            Law::Contact(_) => *v,
            Law::Joint(joint) => joint.acting(v),
        }
    }

    /// Inverse of `W_aa` where the row acts, if there is one; kg.
    fn inverse(&self, a: usize) -> Option<Matrix3<f64>> {
        let w = self.operator.diagonal(a);
        match self.law(a) {
            Law::Contact(_) => w.try_inverse(),
            Law::Joint(joint) => Some(joint.inverse(w)),
        }
    }

    /// Velocity `U_a` of a row, of the velocities that all impulses give; m/s.
    fn velocity(&self, of_impulses: &D::Velocities, a: usize) -> Vec3 {
        self.free_velocity[a] + self.operator.velocity(of_impulses, a)
    }
}
