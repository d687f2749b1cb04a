//! Motion of a block: free, fixed, or prescribed.

use super::path::Sliding;
use super::table::table_at;
use crate::{BlockError, Vec3};
use nalgebra::UnitQuaternion;
use std::f64::consts::TAU;

/// Motion of a block.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// By the forces on it.
    Free,
    /// Not at all.
    Fixed,
    /// Along a path.
    Prescribed(PrescribedMotion),
}

/// A path in time, as displacement from the initial placement.
#[derive(Clone, Debug, PartialEq)]
pub enum PrescribedMotion {
    /// Back and forth along a line.
    Sinusoid {
        /// Unit vector.
        direction: Vec3,
        /// Half the stroke; m.
        amplitude: f64,
        /// Period, > 0; s.
        period: f64,
        /// Phase; rad.
        phase: f64,
        /// Time over which the amplitude grows from 0, ≥ 0; s.
        ramp: f64,
    },
    /// Through given points, by monotone cubic Hermite pieces: no overshoot between points, and a
    /// continuous velocity. Held before the first and after the last point.
    Table {
        /// Increasing; s.
        time: Vec<f64>,
        /// One per time; m.
        displacement: Vec<Vec3>,
        /// Rotation vectors from the initial placement, about the centroid; one per time, or empty; rad.
        turning: Vec<Vec3>,
    },
    /// Along a path, turned as it is.
    Sliding(Sliding),
    /// Base shaking.
    Shaking(Accelerogram),
}

/// A record of acceleration along a line, integrated twice from rest. The acceleration is linear
/// between samples, so that velocity and displacement are exact quadratics and cubics; after the
/// record the final velocity persists (zero for a record with baseline correction).
#[derive(Clone, Debug, PartialEq)]
pub struct Accelerogram {
    direction: Vec3,
    interval: f64,
    acceleration: Vec<f64>,
    /// At the samples.
    velocity: Vec<f64>,
    displacement: Vec<f64>,
}

impl Accelerogram {
    /// Samples (m/s²) at 0, `interval`, 2 `interval`, ... (s) along a unit vector. They are checked
    /// when a block gets the motion.
    pub fn new(direction: Vec3, interval: f64, acceleration: Vec<f64>) -> Self {
        let mut velocity = vec![0.0];
        let mut displacement = vec![0.0];
        let (mut v, mut d) = (0.0, 0.0);
        for pair in acceleration.windows(2) {
            d += v * interval + interval * interval * (pair[0] / 3.0 + pair[1] / 6.0);
            v += 0.5 * interval * (pair[0] + pair[1]);
            velocity.push(v);
            displacement.push(d);
        }
        Self {
            direction,
            interval,
            acceleration,
            velocity,
            displacement,
        }
    }

    fn at(&self, time: f64) -> (Vec3, Vec3) {
        if time <= 0.0 {
            return (Vec3::zeros(), Vec3::zeros());
        }
        let k = ((time / self.interval) as usize).min(self.acceleration.len() - 1);
        let s = time - k as f64 * self.interval;
        let (v, d, a) = (self.velocity[k], self.displacement[k], self.acceleration[k]);
        let (displacement, velocity) = match self.acceleration.get(k + 1) {
            None => (d + v * s, v),
            Some(next) => {
                let slope = (next - a) / self.interval;
                (
                    d + s * (v + s * (a / 2.0 + s * slope / 6.0)),
                    v + s * (a + s * slope / 2.0),
                )
            }
        };
        (self.direction * displacement, self.direction * velocity)
    }
}

impl PrescribedMotion {
    /// Displacement from the initial placement at a time (s); m.
    ///
    /// ```text
    /// d(t) = A r(t/ramp) sin(2πt/T + phase) · direction,     r(τ) = τ³(10 − 15τ + 6τ²), 1 beyond τ = 1
    /// ```
    pub fn displacement(&self, time: f64) -> Vec3 {
        self.at(time).0
    }

    /// Velocity at a time (s), the derivative of [`displacement`](Self::displacement); m/s.
    pub fn velocity(&self, time: f64) -> Vec3 {
        self.at(time).1
    }

    /// Rotation from the initial placement about the centroid, at a time (s).
    pub fn turn(&self, time: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(self.turning_at(time).0)
    }

    /// Angular velocity at a time (s); rad/s.
    ///
    /// ```text
    /// ω = θ' + (1 − cos θ)/θ² θ × θ' + (θ − sin θ)/θ³ θ × (θ × θ')
    /// ```
    /// for a rotation vector `θ`.
    pub fn spin(&self, time: f64) -> Vec3 {
        let (turning, rate) = self.turning_at(time);
        let angle = turning.norm();
        if angle < 1e-6 {
            return rate + turning.cross(&rate) * 0.5;
        }
        let across = turning.cross(&rate);
        rate + across * ((1.0 - angle.cos()) / (angle * angle))
            + turning.cross(&across) * ((angle - angle.sin()) / angle.powi(3))
    }

    /// Rotation vector and its rate.
    fn turning_at(&self, time: f64) -> (Vec3, Vec3) {
        match self {
            Self::Table {
                time: times,
                turning,
                ..
            } if !turning.is_empty() => table_at(times, turning, time),
            Self::Sliding(sliding) => sliding.turning(time),
            _ => (Vec3::zeros(), Vec3::zeros()),
        }
    }

    fn at(&self, time: f64) -> (Vec3, Vec3) {
        match self {
            Self::Sinusoid {
                direction,
                amplitude,
                period,
                phase,
                ramp,
            } => {
                let (sin, cos) = (TAU * time / period + phase).sin_cos();
                let (share, share_rate) = smooth_start(time, *ramp);
                let rate = share * TAU / period * cos + share_rate * sin;
                (
                    direction * (amplitude * share * sin),
                    direction * (amplitude * rate),
                )
            }
            Self::Table {
                time: times,
                displacement,
                ..
            } => table_at(times, displacement, time),
            Self::Sliding(sliding) => sliding.displacement(time),
            Self::Shaking(record) => record.at(time),
        }
    }

    pub(crate) fn check(&self, block: usize) -> Result<(), BlockError> {
        let refuse = |reason| Err(BlockError::Motion { block, reason });
        match self {
            Self::Sinusoid {
                direction,
                amplitude,
                period,
                phase,
                ramp,
            } => {
                if !is_unit(direction) {
                    refuse("the direction must be a unit vector")
                } else if !(*period > 0.0 && period.is_finite()) {
                    refuse("the period must be > 0 s")
                } else if !(*ramp >= 0.0 && ramp.is_finite()) {
                    refuse("the ramp must be >= 0 s")
                } else if !(amplitude.is_finite() && phase.is_finite()) {
                    refuse("amplitude and phase must be finite")
                } else {
                    Ok(())
                }
            }
            Self::Table {
                time,
                displacement,
                turning,
            } => {
                if time.is_empty() || time.len() != displacement.len() {
                    refuse("the table needs as many displacements as times, at least one")
                } else if !turning.is_empty() && time.len() != turning.len() {
                    refuse("a table that turns needs as many rotation vectors as times")
                } else if !time.windows(2).all(|t| t[0] < t[1]) {
                    refuse("the times of the table must increase")
                } else if !time
                    .iter()
                    .chain(displacement.iter().chain(turning).flatten())
                    .all(|c| c.is_finite())
                {
                    refuse("the table has a number that is not finite")
                } else {
                    Ok(())
                }
            }
            Self::Sliding(sliding) => match sliding.check() {
                Ok(()) => Ok(()),
                Err(reason) => refuse(reason),
            },
            Self::Shaking(record) => {
                if !is_unit(&record.direction) {
                    refuse("the direction must be a unit vector")
                } else if !(record.interval > 0.0 && record.interval.is_finite()) {
                    refuse("the interval of the record must be > 0 s")
                } else if record.acceleration.is_empty()
                    || record.acceleration.iter().any(|a| !a.is_finite())
                {
                    refuse("the record needs accelerations, all finite")
                } else {
                    Ok(())
                }
            }
        }
    }
}

fn is_unit(v: &Vec3) -> bool {
    (v.norm() - 1.0).abs() <= 1e-9
}

/// Quintic step from 0 to 1 with two vanishing derivatives at both ends, and its rate; –, 1/s.
fn smooth_start(time: f64, ramp: f64) -> (f64, f64) {
    if time >= ramp {
        (1.0, 0.0)
    } else if time <= 0.0 {
        (0.0, 0.0)
    } else {
        let s = time / ramp;
        (
            s * s * s * (10.0 - 15.0 * s + 6.0 * s * s),
            30.0 * (s * (1.0 - s)).powi(2) / ramp,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_derivative(motion: &PrescribedMotion, from: f64, to: f64) {
        let step = 1e-6;
        for k in 0..=400 {
            let t = from + (to - from) * k as f64 / 400.0;
            let difference =
                (motion.displacement(t + step) - motion.displacement(t - step)) / (2.0 * step);
            // Second order in the step, save where the second derivative jumps: first order there.
            assert!((difference - motion.velocity(t)).norm() < 1e-4, "at {t}");
        }
    }

    #[test]
    fn velocity_is_the_derivative() {
        let sinusoid = PrescribedMotion::Sinusoid {
            direction: Vec3::x(),
            amplitude: 0.1,
            period: 1.3,
            phase: 0.4,
            ramp: 0.8,
        };
        check_derivative(&sinusoid, -0.5, 2.0);
        let table = PrescribedMotion::Table {
            time: vec![0.0, 0.3, 0.5, 1.0, 1.5],
            displacement: [0.0, 0.1, 0.4, 0.4, -0.2]
                .iter()
                .map(|&x| Vec3::new(x, 0.0, -x))
                .collect(),
            turning: Vec::new(),
        };
        check_derivative(&table, -0.5, 2.0);
        let record = Accelerogram::new(Vec3::x(), 0.1, vec![0.0, 1.0, -2.0, 3.0, 0.0]);
        check_derivative(&PrescribedMotion::Shaking(record), -0.2, 1.0);
    }

    #[test]
    fn spin_is_the_rate_of_the_turn() {
        let vectors = [
            [0.0; 3],
            [0.2, -0.1, 0.4],
            [1.1, 0.3, -0.2],
            [1.4, 1.0, 0.5],
        ];
        let motion = PrescribedMotion::Table {
            time: vec![0.0, 0.4, 1.0, 1.7],
            displacement: vec![Vec3::zeros(); 4],
            turning: vectors.map(Vec3::from).to_vec(),
        };
        let step = 1e-6;
        for k in 1..170 {
            let t = 0.01 * f64::from(k);
            let turned = motion.turn(t + step) * motion.turn(t - step).inverse();
            let difference = turned.scaled_axis() / (2.0 * step);
            // as of the velocity: first order where the second derivative jumps
            assert!((difference - motion.spin(t)).norm() < 1e-4, "at {t}");
        }
    }

    #[test]
    fn a_record_is_integrated_exactly() {
        // a = 6t, sampled: d = t³, v = 3t²; then the velocity stays.
        let samples = (0..=10).map(|k| 0.6 * f64::from(k)).collect();
        let record = PrescribedMotion::Shaking(Accelerogram::new(Vec3::x(), 0.1, samples));
        for t in [0.05, 0.33, 1.0] {
            assert!((record.displacement(t).x - t * t * t).abs() < 1e-14);
            assert!((record.velocity(t).x - 3.0 * t * t).abs() < 1e-14);
        }
        assert!((record.displacement(2.0).x - 4.0).abs() < 1e-14);
    }

    #[test]
    fn a_table_does_not_overshoot() {
        let table = PrescribedMotion::Table {
            time: vec![0.0, 1.0, 1.1, 3.0],
            displacement: [0.0, 0.0, 1.0, 1.0]
                .iter()
                .map(|&x| Vec3::new(x, 0.0, 0.0))
                .collect(),
            turning: Vec::new(),
        };
        for k in 0..=300 {
            let x = table.displacement(k as f64 * 0.01).x;
            assert!((0.0..=1.0).contains(&x), "{x}");
        }
    }
}
