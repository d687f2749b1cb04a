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
//! Twisting resistance is the same along the normal, with `V = R̃ ω_n` and a coefficient `μ_w` of its own.
//!
//! With `Û = (U_n + μ|U_t|, U_t)` of De Saxcé & Feng (1998) it is one statement: `R` in the cone `K_μ`, `Û` in its dual, at right angles.
//! Joints are rows like contacts, with all of space or a line as their cone; so are bonds, until they break.
//!
//! Reading order: [`one_contact`] solves one contact exactly, [`bilateral`] a joint; [`delassus`] is the operator of [`bodies`], or a matrix; [`gauss_seidel`] and
//! [`gradient`] solve all of them, [`solver`] chooses; [`accuracy`] tells how far from the laws they are.
//!
//! Sources: Moreau (1999), Jean (1999), Acary & Brogliato (2008).

pub mod accuracy;
pub mod bilateral;
pub mod bodies;
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

/// Residual above which a step counts as unsolved; –.
pub const UNSOLVED: f64 = 1e-2;

/// Rows that one thread takes at a time.
const ROWS_AT_A_TIME: usize = 1024;

/// The contacts of a step, their resistance to spin and joints, whose rows follow each other; vectors in the local frames (n, t1, t2).
#[derive(Clone, Debug)]
pub struct ContactProblem<D> {
    /// From impulses to velocities.
    pub operator: D,
    /// Velocity of B seen from A without impulses at the rows, and the shift of its normal part; one per row; m/s.
    pub free_velocity: Vec<Vec3>,
    /// Coefficient of friction; one per contact; –, >= 0.
    pub friction: Vec<f64>,
    /// Rolling and twisting resistance of contacts.
    pub rolling: Vec<Rolling>,
    /// Laws of joints and bonds.
    pub joints: Vec<Bilateral>,
}

/// Resistance of a contact to relative spin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rolling {
    /// The contact.
    pub contact: u32,
    /// `μ_r` or `μ_w`; –.
    pub coefficient: f64,
    /// The spin that it resists.
    pub axis: SpinAxis,
}

/// Direction of a relative spin at a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpinAxis {
    /// Across the normal: rolling.
    Across,
    /// Along the normal: twisting.
    Along,
}

/// Kind of a row.
enum Row<'a> {
    /// Contact with a coefficient of friction.
    Contact(f64),
    Rolling(&'a Rolling),
    Joint(&'a Bilateral),
}

impl Rolling {
    /// Bound on its impulse, of the normal impulses of contacts; N s.
    fn bound(&self, pressed: impl Fn(usize) -> f64) -> f64 {
        self.coefficient * pressed(self.contact as usize).max(0.0)
    }
}

impl<D: Delassus> ContactProblem<D> {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.friction.len() + self.rolling.len() + self.joints.len()
    }

    /// Whether nothing touches, and nothing is joined.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    #[inline]
    fn row(&self, a: usize) -> Row<'_> {
        if let Some(&friction) = self.friction.get(a) {
            return Row::Contact(friction);
        }
        let a = a - self.friction.len();
        match self.rolling.get(a) {
            Some(rolling) => Row::Rolling(rolling),
            None => Row::Joint(&self.joints[a - self.rolling.len()]),
        }
    }

    /// Whether the friction of a contact is above Painlevé's limit, `μ |W_nt| > W_nn`: friction there presses the point as it slides, so that
    /// more than one impulse may obey the laws, and one may be needed where nothing collides. Source: Génot & Brogliato (1999).
    pub fn is_above_painleve(&self, contact: usize) -> bool {
        let w = self.operator.diagonal(contact);
        w[(0, 0)] < self.friction[contact] * w[(1, 0)].hypot(w[(2, 0)])
    }

    /// Impulse (N s) by which a row of free velocity `b` (m/s) obeys its law, the other rows as they are. `slip` as in [`one_contact`].
    fn impulse(&self, a: usize, b: &Vec3, impulses: &[Vec3], slip: &mut f64) -> Vec3 {
        let w = self.operator.diagonal(a);
        match self.row(a) {
            Row::Contact(friction) => one_contact::impulse(w, b, friction, slip),
            Row::Rolling(rolling) => {
                let bound = rolling.bound(|contact| impulses[contact].x);
                match rolling.axis {
                    SpinAxis::Across => one_contact::rolling_impulse(w, b, bound, slip),
                    SpinAxis::Along => one_contact::twisting_impulse(w, b, bound),
                }
            }
            Row::Joint(joint) => joint.impulse(w, b),
        }
    }

    /// Shift of the normal velocity that makes a row one of a cone and its dual: De Saxcé's of a contact, that of the length of a rod; m/s.
    #[inline]
    fn shift(&self, a: usize, velocity: &Vec3) -> f64 {
        match self.row(a) {
            Row::Contact(friction) => friction * cone::tangential(velocity),
            Row::Rolling(_) => 0.0,
            Row::Joint(joint) => joint.shift(velocity),
        }
    }

    /// Nearest point of the cone of a row, for impulses over a scale, with the normal impulses of contacts (N s).
    #[inline]
    fn projected(
        &self,
        a: usize,
        scaled: &Vec3,
        scale: f64,
        pressed: impl Fn(usize) -> f64,
    ) -> Vec3 {
        match self.row(a) {
            Row::Contact(friction) => cone::projected(friction, scaled),
            Row::Rolling(rolling) => scaled.cap_magnitude(rolling.bound(pressed) / scale),
            Row::Joint(joint) => joint.projected(scaled, scale),
        }
    }

    /// Mass that a row feels: `3/tr W_aa`, of a rod and of twisting `1/W_nn`; kg. 1 where impulses move nothing.
    #[inline]
    fn mass(&self, a: usize) -> f64 {
        let w = self.operator.diagonal(a);
        let (n, compliance) = match self.row(a) {
            Row::Joint(Bilateral::Rod(_))
            | Row::Rolling(Rolling {
                axis: SpinAxis::Along,
                ..
            }) => (1.0, w[(0, 0)]),
            _ => (3.0, w.trace()),
        };
        if 0.0 < compliance {
            n / compliance
        } else {
            1.0
        }
    }

    /// The part of a vector in which a row acts.
    #[inline]
    fn acting(&self, a: usize, v: &Vec3) -> Vec3 {
        match self.row(a) {
            Row::Contact(_) | Row::Rolling(_) => *v,
            Row::Joint(joint) => joint.acting(v),
        }
    }

    /// Inverse of `W_aa` where the row acts, if there is one; kg.
    fn inverse(&self, a: usize) -> Option<Matrix3<f64>> {
        let w = self.operator.diagonal(a);
        match self.row(a) {
            Row::Contact(_) | Row::Rolling(_) => w.try_inverse(),
            Row::Joint(joint) => Some(joint.inverse(w)),
        }
    }

    /// Velocity `U_a` of a row, of the velocities that all impulses give; m/s.
    #[inline]
    fn velocity(&self, of_impulses: &D::Velocities, a: usize) -> Vec3 {
        self.free_velocity[a] + self.operator.velocity(of_impulses, a)
    }
}
