//! One contact, exactly up to one scalar root.
//!
//! ```text
//! U = b + W R;   W = (W_nn c; w H₀),   H = H₀ − w cᵀ/W_nn,   h = b_t − w b_n/W_nn
//! b_n ≥ 0                R = 0
//! R_t = −(H + l 1)⁻¹ h,  R_n = −(b_n + c·R_t)/W_nn;   l = 0 if |R_t| ≤ μ R_n: it sticks
//! l > 0 with |R_t| = μ R_n otherwise: it slides against R_t, as U_t = −l R_t
//! ```
//! `W` need not be symmetric.
//!
//! Friction above Painlevé's limit, `W_nn < μ |W_nt|`, may leave several solutions: no impulse comes first, then sticking, then the
//! root that the bracket finds, so that the answer is the same everywhere.

use crate::Vec3;
use nalgebra::{Matrix2, Matrix3, Vector2};

/// Difference of both sides of the friction bound at which the root is found, × the bound.
const ROUND_OFF: f64 = 1e-14;
/// Entries beside the diagonal that are round-off, × the first of it.
const DIAGONAL: f64 = 1e-14;
/// Factor between trial values of `l` before it is bracketed.
const WIDENING: f64 = 4.0;
/// Limits of the search; five evaluations are usual.
const MAX_WIDENINGS: usize = 600;
const MAX_ITERATIONS: usize = 200;

/// Impulse (N s) that lets a contact of free velocity `b` (m/s) obey Signorini's and Coulomb's laws, in the frame (n, t1, t2).
///
/// `slip` is the `l` (1/kg) of its last solution, or 0: the search begins there, and leaves the new one. A contact whose `W_nn` is
/// not positive, of two bodies that impulses do not move, has none.
pub fn impulse(w: &Matrix3<f64>, b: &Vec3, friction: f64, slip: &mut f64) -> Vec3 {
    let along_normal = w[(0, 0)];
    if !(b.x < 0.0 && 0.0 < along_normal) {
        return Vec3::zeros();
    }
    if friction <= 0.0 {
        return Vec3::new(-b.x / along_normal, 0.0, 0.0);
    }
    if is_diagonal(w) {
        return closed_form(w, b, friction);
    }
    Tangential::of(w, b, friction).solve(slip)
}

/// Whether normal and tangents do not act on each other and both tangents are alike, to round-off: spheres.
fn is_diagonal(w: &Matrix3<f64>) -> bool {
    let little = DIAGONAL * w[(0, 0)];
    let off = [(0, 1), (0, 2), (1, 0), (2, 0), (1, 2), (2, 1)];
    off.iter().all(|&at| w[at].abs() <= little) && (w[(1, 1)] - w[(2, 2)]).abs() <= little
}

/// `R_n = −b_n/w_n`, `R_t = −b_t/w_t` cut back to `μ R_n`.
fn closed_form(w: &Matrix3<f64>, b: &Vec3, friction: f64) -> Vec3 {
    let normal = -b.x / w[(0, 0)];
    let tangential = Vector2::new(b.y, b.z) * (-1.0 / w[(1, 1)]);
    let (bound, size) = (friction * normal, tangential.norm());
    let share = if bound < size { bound / size } else { 1.0 };
    Vec3::new(normal, share * tangential.x, share * tangential.y)
}

/// Impulse (N s) of at most a bound across the normal that holds free velocity `b` (m/s) there, or slides against it; `slip` as of
/// [`impulse`].
pub fn rolling_impulse(w: &Matrix3<f64>, b: &Vec3, bound: f64, slip: &mut f64) -> Vec3 {
    let matrix = w.fixed_view::<2, 2>(1, 1).into_owned();
    if !(0.0 < bound && 0.0 < matrix.trace()) {
        return Vec3::zeros();
    }
    let row = Tangential {
        matrix,
        velocity: Vector2::new(b.y, b.z),
        to_normal: Vector2::zeros(),
        normal: bound,
        friction: 1.0,
    };
    let found = row.solve(slip);
    Vec3::new(0.0, found.y, found.z)
}

/// Impulse (N s) of at most a bound along the normal that holds free velocity `b` (m/s) there, or slides against it.
pub fn twisting_impulse(w: &Matrix3<f64>, b: &Vec3, bound: f64) -> Vec3 {
    let compliance = w[(0, 0)];
    if !(0.0 < bound && 0.0 < compliance) {
        return Vec3::zeros();
    }
    Vec3::x() * (-b.x / compliance).clamp(-bound, bound)
}

/// The contact with its normal direction eliminated.
struct Tangential {
    /// `H`; 1/kg.
    matrix: Matrix2<f64>,
    /// `h`; m/s.
    velocity: Vector2<f64>,
    /// `W_nt/W_nn`; –.
    to_normal: Vector2<f64>,
    /// `−b_n/W_nn`; N s.
    normal: f64,
    friction: f64,
}

/// Impulse at a value of `l`, and what it exceeds the friction bound by.
struct Trial {
    impulse: Vec3,
    excess: f64,
    /// `−d excess/dl`.
    slope: f64,
}

impl Tangential {
    fn of(w: &Matrix3<f64>, b: &Vec3, friction: f64) -> Self {
        let along_normal = w[(0, 0)];
        let column = Vector2::new(w[(1, 0)], w[(2, 0)]);
        let row = Vector2::new(w[(0, 1)], w[(0, 2)]);
        Self {
            matrix: w.fixed_view::<2, 2>(1, 1) - column * row.transpose() / along_normal,
            velocity: Vector2::new(b.y, b.z) - column * (b.x / along_normal),
            to_normal: row / along_normal,
            normal: -b.x / along_normal,
            friction,
        }
    }

    /// `None` where the matrix is singular.
    fn at(&self, slip: f64) -> Option<Trial> {
        let inverse = (self.matrix + Matrix2::identity() * slip).try_inverse()?;
        let tangential = -(inverse * self.velocity);
        let normal = self.normal - self.to_normal.dot(&tangential);
        let size = tangential.norm();
        let change = inverse * tangential;
        let turned = if 0.0 < size {
            tangential.dot(&change) / size
        } else {
            0.0
        };
        Some(Trial {
            impulse: Vec3::new(normal, tangential.x, tangential.y),
            excess: size - self.friction * normal,
            slope: turned + self.friction * self.to_normal.dot(&change),
        })
    }

    fn solve(&self, slip: &mut f64) -> Vec3 {
        if let Some(trial) = self.at(0.0)
            && trial.excess <= 0.0
        {
            *slip = 0.0;
            return trial.impulse;
        }
        let scale = self.matrix.norm().max(f64::MIN_POSITIVE);
        let (mut low, mut high) = (0.0, if 0.0 < *slip { *slip } else { scale });
        for _ in 0..MAX_WIDENINGS {
            match self.at(high) {
                Some(trial) if trial.excess < 0.0 => break,
                _ => (low, high) = (high, high * WIDENING),
            }
        }
        let mut at = high;
        let mut impulse = Vec3::zeros();
        for _ in 0..MAX_ITERATIONS {
            let Some(trial) = self.at(at) else {
                at = 0.5 * (low + high);
                continue;
            };
            impulse = trial.impulse;
            if trial.excess.abs() <= ROUND_OFF * self.friction * impulse.x.abs() {
                break;
            }
            if trial.excess < 0.0 {
                high = at;
            } else {
                low = at;
            }
            let next = at + trial.excess / trial.slope;
            let is_within = low < next && next < high;
            let next = if is_within { next } else { 0.5 * (low + high) };
            if next == at {
                break;
            }
            at = next;
        }
        *slip = at;
        impulse
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Random;
    use crate::contact::dynamics::cone::tangential;

    /// How far an impulse is from the laws, over the sizes of what they compare.
    fn residual(w: &Matrix3<f64>, b: &Vec3, friction: f64, r: &Vec3) -> f64 {
        let u = b + w * r;
        let (speed, size) = (b.norm(), r.norm());
        let mut off: f64 = 0.0;
        off = off.max(-u.x / speed).max(-r.x / size.max(1e-300));
        off = off.max((u.x * r.x).abs() / (speed * size).max(1e-300));
        off = off.max((tangential(r) - friction * r.x) / size.max(1e-300));
        let (ut, rt) = (Vector2::new(u.y, u.z), Vector2::new(r.y, r.z));
        let slides = ut.norm() > 1e-10 * speed;
        if slides && 0.0 < r.x {
            off = off.max((tangential(r) - friction * r.x).abs() / size);
            let cross = ut.x * rt.y - ut.y * rt.x;
            off = off.max(cross.abs() / (ut.norm() * rt.norm()).max(1e-300));
            off = off.max(ut.dot(&rt) / (speed * size));
        }
        off
    }

    /// N01: random problems of all scales, a quarter of them unsymmetric, below Painlevé's limit and above it.
    #[test]
    fn random_contacts_obey_the_laws() {
        let mut random = Random::new(7);
        for k in 0..100_000 {
            let a = Matrix3::from_fn(|_, _| 2.0 * random.uniform() - 1.0);
            let scale = 10_f64.powf(8.0 * random.uniform() - 4.0);
            let mut w = (a * a.transpose() + Matrix3::identity() * 0.05) * scale;
            if k % 4 == 0 {
                w += Matrix3::from_fn(|_, _| 1e-3 * scale * (random.uniform() - 0.5));
            }
            if k % 8 == 1 {
                // of two spheres
                w = Matrix3::from_diagonal(&Vec3::new(1.0, 3.5, 3.5)) * scale;
            }
            let speed = 10_f64.powf(8.0 * random.uniform() - 4.0);
            let b = Vec3::from_fn(|_, _| speed * (2.0 * random.uniform() - 1.0));
            let friction = 1.5 * random.uniform();
            let mut slip = 0.0;
            let r = impulse(&w, &b, friction, &mut slip);
            let off = residual(&w, &b, friction, &r);
            // measured 1.5e-11
            assert!(off < 1e-10, "{k}: {off:e} {w} {b} {friction} {r}");
            let again = impulse(&w, &b, friction, &mut slip);
            assert!((again - r).norm() <= 1e-12 * r.norm(), "from its own root");
        }
    }

    /// N15: a slender rod that slides on its tip, below and above Painlevé's limit of 4/3.
    #[test]
    fn a_rod_sticks_by_friction_above_painleves_limit() {
        let w = Matrix3::new(1.6, 1.2, 0.0, 1.2, 3.4, 0.0, 0.0, 0.0, 1.0);
        let b = Vec3::new(-0.01, 1.0, 0.0);
        let slides = impulse(&w, &b, 1.2, &mut 0.0);
        assert!(
            (slides - Vec3::new(0.0625, -0.075, 0.0)).norm() < 1e-10,
            "{slides}"
        );
        assert!(((b + w * slides).y - 0.82).abs() < 1e-10);
        let sticks = impulse(&w, &b, 1.6, &mut 0.0);
        assert!(
            (sticks - Vec3::new(0.3085, -0.403, 0.0)).norm() < 1e-10,
            "{sticks}"
        );
        assert!((b + w * sticks).norm() < 1e-12);
    }

    #[test]
    fn contacts_that_part_or_cannot_move_have_no_impulse() {
        let w = Matrix3::identity();
        let none = [
            impulse(&w, &Vec3::new(0.0, 1.0, 0.0), 0.5, &mut 0.0),
            impulse(&w, &Vec3::new(0.1, -1.0, 0.0), 0.5, &mut 0.0),
            impulse(&Matrix3::zeros(), &Vec3::new(-1.0, 0.0, 0.0), 0.5, &mut 0.0),
            impulse(&w, &Vec3::new(f64::NAN, 0.0, 0.0), 0.5, &mut 0.0),
        ];
        assert_eq!(none, [Vec3::zeros(); 4]);
        let smooth = impulse(&w, &Vec3::new(-2.0, 1.0, 0.0), 0.0, &mut 0.0);
        assert_eq!(smooth, Vec3::new(2.0, 0.0, 0.0));
    }
}
