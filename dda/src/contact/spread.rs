//! Springs of one normal, spread over a patch, by the moments of their places.
//!
//! The compliances of a rigid or affine block are quadratic in the place: of any number of springs their bounds need no more than
//!
//! ```text
//! Σ w,   Σ w r,   Σ w r rᵀ
//! ```

use crate::Vec3;
use crate::contact::report::PointState;
use crate::motion::kinematics::Kinematics;
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

/// Moments of weights about a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Moments {
    /// `Σ w`.
    pub total: f64,
    /// `Σ w r`; m.
    pub first: Vec3,
    /// `Σ w r rᵀ`; m².
    pub second: Matrix3<f64>,
}

impl Moments {
    fn add(&mut self, r: &Vec3, weight: f64) {
        let weighted = r * weight;
        self.total += weight;
        self.first += weighted;
        self.second += weighted * r.transpose();
    }

    /// About a point from which the present one is at `shift` (m).
    fn shifted(&self, shift: &Vec3) -> Self {
        let mixed = self.first * shift.transpose();
        Self {
            total: self.total,
            first: self.first + shift * self.total,
            second: self.second
                + mixed
                + mixed.transpose()
                + shift * (shift.transpose() * self.total),
        }
    }

    /// `Σ w (r × n)(r × n)ᵀ`; m².
    pub fn across(&self, normal: &Vec3) -> Matrix3<f64> {
        let turn = normal.cross_matrix();
        turn * self.second * turn.transpose()
    }
}

/// Places of the springs of a patch of one normal. Shear springs lie where the pressure is, those of a bond where its patch is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spread {
    /// Of the moments, world; m.
    origin: Vec3,
    /// Unit.
    pub normal: Vec3,
    /// Weights of the springs along the normal.
    along: Moments,
    /// Shares of the shear springs.
    across: Moments,
}

impl Spread {
    pub fn of(points: &[PointState], normal: &Vec3, is_bonded: bool) -> Self {
        let total: f64 = points.iter().map(|p| p.at.weight).sum();
        let pressed: f64 = points.iter().map(|p| p.normal_force.max(0.0)).sum();
        let mut spread = Self {
            origin: points.first().map_or_else(Vec3::zeros, |p| p.at.position),
            normal: *normal,
            ..Self::default()
        };
        for point in points {
            let r = point.at.position - spread.origin;
            let share = if is_bonded || pressed <= 0.0 {
                point.at.weight / total
            } else {
                point.normal_force.max(0.0) / pressed
            };
            spread.along.add(&r, point.at.weight);
            spread.across.add(&r, share);
        }
        spread
    }

    /// Moments of the weights along the normal and of the shares across it, about the centroid of a body.
    pub fn about(&self, centroid: &Vec3) -> [Moments; 2] {
        let shift = self.origin - centroid;
        [self.along.shifted(&shift), self.across.shifted(&shift)]
    }

    /// Sums of the weights along the normal times the compliance of a body there, and of the shares times the compliances in the two
    /// directions across it; 1/kg.
    pub fn compliances(&self, body: &Kinematics) -> [f64; 2] {
        let [along, across] = self.about(&body.centroid);
        let inverse = &body.inverse_inertia;
        let mass = body.inverse_mass;
        if body.strain_rate.is_some() {
            return [
                along.total * mass + inverse.dot(&along.second),
                2.0 * (across.total * mass + inverse.dot(&across.second)),
            ];
        }
        let turning = inverse.trace() * across.second.trace() - inverse.dot(&across.second);
        [
            along.total * mass + inverse.dot(&along.across(&self.normal)),
            2.0 * across.total * mass + turning - inverse.dot(&across.across(&self.normal)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Random;
    use crate::contact::detection::manifold::ManifoldPoint;
    use nalgebra::UnitQuaternion;

    fn vector(random: &mut Random) -> Vec3 {
        Vec3::new(random.uniform(), random.uniform(), random.uniform()).add_scalar(-0.5)
    }

    /// Sums of point by point, for rigid bodies and those that deform, far from the origin.
    #[test]
    fn compliances_are_those_of_the_points() {
        let mut random = Random::new(3);
        for case in 0..40 {
            let far = Vec3::new(1e4, -2e4, 300.0);
            let turn = UnitQuaternion::from_scaled_axis(vector(&mut random) * 3.0)
                .to_rotation_matrix()
                .into_inner();
            let moments = Vec3::new(3.0, 0.4, 1.7);
            let body = Kinematics {
                centroid: far + vector(&mut random),
                velocity: Vec3::zeros(),
                spin: Vec3::zeros(),
                inverse_mass: 0.8,
                inverse_inertia: turn * Matrix3::from_diagonal(&moments) * turn.transpose(),
                strain_rate: (case % 2 == 1).then(Matrix3::zeros),
            };
            let normal = vector(&mut random).normalize();
            let points: Vec<PointState> = (0..9)
                .map(|key| PointState {
                    normal_force: random.uniform() - 0.2,
                    ..PointState::free(ManifoldPoint {
                        key,
                        position: far + vector(&mut random),
                        weight: random.uniform(),
                        overlap: 0.0,
                    })
                })
                .collect();
            let pressed: f64 = points.iter().map(|p| p.normal_force.max(0.0)).sum();
            let mut expected = [0.0; 2];
            for point in &points {
                let x = &point.at.position;
                let along = body.compliance(x, &normal);
                expected[0] += point.at.weight * along;
                expected[1] +=
                    point.normal_force.max(0.0) / pressed * (body.compliance_trace(x) - along);
            }
            let found = Spread::of(&points, &normal, false).compliances(&body);
            for (found, expected) in found.iter().zip(expected) {
                // places are known to 2e4 × 1e-16
                assert!((found / expected - 1.0).abs() < 1e-10, "{found} {expected}");
            }
        }
    }
}
