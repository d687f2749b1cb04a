//! Normal springs and dashpots of the points of a manifold, or of several that share one motion.

use super::work::Normals;
use crate::Vec3;
use crate::contact::detection::manifold::ManifoldPoint;
use crate::contact::report::PointState;
use crate::motion::kinematics::Kinematics;

/// Springs of two bodies along their normals.
#[derive(Clone, Copy)]
pub(super) struct Pressing<'a> {
    /// i and j.
    pub bodies: (&'a Kinematics, &'a Kinematics),
    /// `K` of a unit of weight; N/m, or Pa/m.
    pub stiffness: f64,
    /// `ξ`; –.
    pub damping_ratio: f64,
}

/// Dashpot of the whole.
#[derive(Clone, Copy)]
pub(super) struct Dashpot {
    /// `c`, per unit of weight; N s/m.
    pub per_weight: f64,
    /// `c Σw/m_e`; 1/s.
    pub rate: f64,
    /// Middle of the points; m.
    pub middle: Vec3,
}

/// Forces along the normal that a contact can bear.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Bearing {
    Pressure,
    /// A bond pulls, too.
    PressureAndTension,
}

impl Pressing<'_> {
    /// Dashpot `2 ξ √(K_e m_e)` of the motion along a direction.
    pub fn dashpot(&self, points: &[ManifoldPoint], along: &Vec3) -> Dashpot {
        let (a, b) = self.bodies;
        let total: f64 = points.iter().map(|p| p.weight).sum();
        let middle: Vec3 = points.iter().map(|p| p.position * (p.weight / total)).sum();
        let stiffness = self.stiffness * total;
        let mobility = a.compliance(&middle, along) + b.compliance(&middle, along);
        let per_weight = if mobility > 0.0 {
            2.0 * self.damping_ratio * (stiffness / mobility).sqrt() / total
        } else {
            0.0
        };
        Dashpot {
            per_weight,
            rate: per_weight * total * mobility,
            middle,
        }
    }

    /// Appends the points with their normal forces, of a dashpot per unit of weight (N s/m).
    pub fn press(
        &self,
        points: &[ManifoldPoint],
        normals: impl Normals,
        dashpot: f64,
        bearing: Bearing,
        out: &mut Vec<PointState>,
    ) {
        let (a, b) = self.bodies;
        for (k, &at) in points.iter().enumerate() {
            let x = &at.position;
            let opening = (b.velocity_at(x) - a.velocity_at(x)).dot(&normals.of_point(k));
            let spring = at.weight * self.stiffness * at.overlap;
            let mut normal_force = spring - at.weight * dashpot * opening;
            if bearing == Bearing::Pressure {
                normal_force = normal_force.max(0.0);
            }
            out.push(PointState {
                normal_force,
                normal_viscous: normal_force - spring,
                ..PointState::free(at)
            });
        }
    }
}

/// Share of the dashpot that acts in a step, so that the rebound is in the mean the one asked, to second order
/// in it.
///
/// ```text
/// s = 1/(1 + c w dt/4)                                    later on                                [–]
/// s = (1/2 + δ/(u dt))/(1 + c w dt/4),   s c w dt ≤ 1     in the step in which the bodies meet
/// ```
/// The velocity is that of half a step ago, which was faster by `(k δ + c u) w dt/2`: damping and stiffness
/// seem larger, and the damping ratio by `1 + c w dt/4`. The force at the end of a step stands for half a step
/// on either side, but they met only `δ/u` ago: with a whole force the rebound of one spring was 0.40 to 0.58
/// for 0.5, depending on where in a step they met, with five steps in a contact. It then takes no more than all of the
/// speed. Rate of damping `c w` (1/s); `meeting`: overlap δ (m) and closing rate u (m/s).
pub(super) fn dashpot_share(rate: f64, dt: f64, meeting: Option<(f64, f64)>) -> f64 {
    let later = 1.0 / (1.0 + 0.25 * rate * dt);
    match meeting {
        Some((overlap, closing)) if closing * dt > 0.0 => {
            let first = (0.5 + overlap / (closing * dt)).clamp(0.5, 1.5) * later;
            first.min(f64::max(1.0 / (rate * dt), later))
        }
        _ => later,
    }
}
