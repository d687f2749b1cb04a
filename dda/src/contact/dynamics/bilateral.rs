//! Rows of joints, which push and pull.
//!
//! ```text
//! point    U = 0                                           b with the error of position over the step
//! rod      |Z + dt U| = l,   R along z,   |R| ≤ R_max      Z between its ends, z = Z/|Z| the normal of its frame
//! ```
//! The rod obeys exactly, not linearized: with `a = Z + dt b` and `g = dt W z`
//!
//! ```text
//! (g·g) R² + 2 (a·g) R + a·a − l² = 0                      the root of smaller |R|;  R = −b_n/W_nn without a real one
//! ```
//! In the solvers for all rows it is one of shifted velocity 0, `U_n + (|Z| − √(l² − dt² |U_t|²))/dt`, or `U_n` without a real root.

use crate::Vec3;
use nalgebra::Matrix3;

/// Compliance below which a direction counts as held, × trace.
const HELD: f64 = 1e-12;

/// Law of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bilateral {
    /// Two points stay together.
    Point {
        /// `W_aa⁻¹`, without directions that impulses do not move; kg.
        inverse: Matrix3<f64>,
    },
    /// Two points stay at a distance, along the normal.
    Rod(Rod),
}

/// A bar without mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rod {
    /// Distance of the ends, above 0; m.
    pub span: f64,
    /// Length to be kept; m.
    pub length: f64,
    /// Step over which the velocity acts; s.
    pub dt: f64,
    /// Largest impulse in tension and compression; N s.
    pub largest: f64,
}

impl Bilateral {
    /// A point whose `W_aa` is `w` (1/kg).
    pub fn point(w: &Matrix3<f64>) -> Self {
        let inverse = w.pseudo_inverse(HELD * w.trace());
        Self::Point {
            inverse: inverse.unwrap_or_else(|_| Matrix3::zeros()),
        }
    }

    /// Impulse (N s) by which a row of free velocity `b` (m/s) obeys.
    pub fn impulse(&self, w: &Matrix3<f64>, b: &Vec3) -> Vec3 {
        match self {
            Self::Point { inverse } => -(inverse * b),
            Self::Rod(rod) => Vec3::x() * rod.impulse(w, b),
        }
    }

    /// Shift of the normal velocity at a velocity (m/s), by which the shifted one is 0 where the law is obeyed; m/s.
    pub fn shift(&self, velocity: &Vec3) -> f64 {
        match self {
            Self::Point { .. } => 0.0,
            Self::Rod(rod) => rod.shift(velocity),
        }
    }

    /// Nearest impulse that the joint may bear, over a scale.
    pub(super) fn projected(&self, scaled: &Vec3, scale: f64) -> Vec3 {
        match self {
            Self::Point { .. } => *scaled,
            Self::Rod(rod) => {
                let largest = rod.largest / scale;
                Vec3::x() * scaled.x.clamp(-largest, largest)
            }
        }
    }

    /// The part of a vector in which the joint acts.
    pub(super) fn acting(&self, v: &Vec3) -> Vec3 {
        match self {
            Self::Point { .. } => *v,
            Self::Rod(_) => Vec3::x() * v.x,
        }
    }

    /// Inverse of `W_aa` where the joint acts; kg.
    pub(super) fn inverse(&self, w: &Matrix3<f64>) -> Matrix3<f64> {
        match self {
            Self::Point { inverse } => *inverse,
            Self::Rod(_) => {
                let along = w[(0, 0)];
                let mass = if 0.0 < along { 1.0 / along } else { 0.0 };
                Matrix3::from_diagonal(&Vec3::new(mass, 0.0, 0.0))
            }
        }
    }

    /// The law for displacements that leave the joint as it is.
    #[must_use]
    pub fn of_displacements(&self) -> Self {
        match *self {
            Self::Point { .. } => *self,
            Self::Rod(Rod { span, .. }) => Self::Rod(Rod {
                span,
                length: span,
                dt: 1.0,
                largest: f64::INFINITY,
            }),
        }
    }
}

impl Rod {
    fn shift(&self, velocity: &Vec3) -> f64 {
        let Self {
            span, length, dt, ..
        } = *self;
        let across = dt * dt * (velocity.y * velocity.y + velocity.z * velocity.z);
        if length * length <= across {
            return 0.0;
        }
        let along = (length * length - across).sqrt();
        // length − along, without cancellation
        let turned = (length * length - along * along) / (length + along);
        (span - length + turned) / dt
    }

    fn impulse(&self, w: &Matrix3<f64>, b: &Vec3) -> f64 {
        let along = w[(0, 0)];
        if !(0.0 < along) {
            return 0.0;
        }
        let Self {
            span,
            length,
            dt,
            largest,
        } = *self;
        let gained = w.column(0) * dt;
        let (square, half) = (gained.norm_squared(), {
            let reached = b * dt + Vec3::x() * span;
            reached.dot(&gained)
        });
        let rest =
            (span - length) * (span + length) + dt * (2.0 * span * b.x + dt * b.norm_squared());
        let discriminant = half * half - square * rest;
        let found = if discriminant < 0.0 {
            -b.x / along
        } else {
            // the smaller root from the larger one, without cancellation
            let larger = -(half + discriminant.sqrt().copysign(half));
            if larger == 0.0 { 0.0 } else { rest / larger }
        };
        found.clamp(-largest, largest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Random;

    /// Random rods that turn by a tenth of a radian in the step end with their length; where none could, along the rod nothing moves.
    #[test]
    fn rods_keep_their_length() {
        let mut random = Random::new(4);
        let mut n_without = 0;
        for k in 0..10_000 {
            let a = Matrix3::from_fn(|_, _| 2.0 * random.uniform() - 1.0);
            let scale = 10_f64.powf(6.0 * random.uniform() - 3.0);
            let w = (a * a.transpose() + Matrix3::identity() * 0.2) * scale;
            let length = 10_f64.powf(2.0 * random.uniform() - 1.0);
            let rod = Rod {
                span: length * (1.0 + 1e-2 * (random.uniform() - 0.5)),
                length,
                dt: 0.01,
                largest: f64::INFINITY,
            };
            let speed = 0.2 * length / rod.dt;
            let b = Vec3::from_fn(|_, _| speed * (random.uniform() - 0.5));
            let law = Bilateral::Rod(rod);
            let impulse = law.impulse(&w, &b);
            let velocity = b + w * impulse;
            if velocity.x.abs() < 1e-12 * speed {
                n_without += 1;
                continue;
            }
            let ends = (velocity * rod.dt + Vec3::x() * rod.span).norm();
            // a multiple of round-off, measured 4e-15
            assert!((ends / length - 1.0).abs() < 1e-13, "{k}: {ends} {length}");
            let shifted = velocity.x + law.shift(&velocity);
            assert!(shifted.abs() < 1e-12 * speed, "{k}: {shifted:e}");
        }
        assert!(n_without < 500, "{n_without}");
    }

    #[test]
    fn rods_bear_no_more_than_their_strength() {
        let rod = Rod {
            span: 1.0,
            length: 1.0,
            dt: 0.01,
            largest: 2.0,
        };
        let pulled = Bilateral::Rod(rod).impulse(&Matrix3::identity(), &(Vec3::x() * 5.0));
        assert_eq!(pulled, Vec3::x() * -2.0);
        let none = Bilateral::Rod(rod).impulse(&Matrix3::zeros(), &Vec3::x());
        assert_eq!(none, Vec3::zeros());
    }

    /// Where a hold takes a direction, the joint leaves it alone.
    #[test]
    fn points_leave_what_is_held() {
        let held = Vec3::new(1.0, 2.0, 2.0) / 3.0;
        let w = Matrix3::identity() - held * held.transpose();
        let b = Vec3::new(3.0, -1.0, 0.5);
        let impulse = Bilateral::point(&w).impulse(&w, &b);
        assert!((b + w * impulse - held * held.dot(&b)).norm() < 1e-14);
        assert!(impulse.dot(&held).abs() < 1e-14);
    }
}
