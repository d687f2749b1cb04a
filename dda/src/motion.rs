//! How a block moves: by forces, not at all, or along a given path.

use crate::{BlockError, Vec3};
use std::f64::consts::TAU;

/// How a block moves.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// By the forces on it.
    Free,
    /// Not at all.
    Fixed,
    /// Along a path, without turning.
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
    },
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
            } => table_at(times, displacement, time),
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
                if (direction.norm() - 1.0).abs() > 1e-9 || direction.iter().any(|c| !c.is_finite())
                {
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
            Self::Table { time, displacement } => {
                if time.is_empty() || time.len() != displacement.len() {
                    refuse("the table needs as many displacements as times, at least one")
                } else if !time.windows(2).all(|t| t[0] < t[1]) {
                    refuse("the times of the table must increase")
                } else if !(time.iter().chain(displacement.iter().flatten())).all(|c| c.is_finite())
                {
                    refuse("the table has a number that is not finite")
                } else {
                    Ok(())
                }
            }
        }
    }
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

fn table_at(times: &[f64], values: &[Vec3], time: f64) -> (Vec3, Vec3) {
    let n = times.len();
    let k = times.partition_point(|&t| t <= time);
    if k == 0 {
        return (values[0], Vec3::zeros());
    }
    if k == n {
        return (values[n - 1], Vec3::zeros());
    }
    let width = times[k] - times[k - 1];
    let s = (time - times[k - 1]) / width;
    let (from, to) = (values[k - 1], values[k]);
    let (slope_from, slope_to) = (slope(times, values, k - 1), slope(times, values, k));
    let (s2, s3) = (s * s, s * s * s);
    let value = from * (2.0 * s3 - 3.0 * s2 + 1.0)
        + slope_from * (width * (s3 - 2.0 * s2 + s))
        + to * (3.0 * s2 - 2.0 * s3)
        + slope_to * (width * (s3 - s2));
    let rate = (from - to) * ((6.0 * s2 - 6.0 * s) / width)
        + slope_from * (3.0 * s2 - 4.0 * s + 1.0)
        + slope_to * (3.0 * s2 - 2.0 * s);
    (value, rate)
}

/// Slope at a point: zero at the ends and at turning points, else the weighted harmonic mean of the
/// neighbouring slopes. Source: Fritsch & Butland (1984), which keeps the pieces monotone.
fn slope(times: &[f64], values: &[Vec3], k: usize) -> Vec3 {
    if k == 0 || k + 1 == times.len() {
        return Vec3::zeros();
    }
    let (before, after) = (times[k] - times[k - 1], times[k + 1] - times[k]);
    let left = (values[k] - values[k - 1]) / before;
    let right = (values[k + 1] - values[k]) / after;
    left.zip_map(&right, |l, r| {
        if l * r <= 0.0 {
            return 0.0;
        }
        let (w1, w2) = (2.0 * after + before, after + 2.0 * before);
        (w1 + w2) / (w1 / l + w2 / r)
    })
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
        };
        check_derivative(&table, -0.5, 2.0);
    }

    #[test]
    fn a_table_does_not_overshoot() {
        let table = PrescribedMotion::Table {
            time: vec![0.0, 1.0, 1.1, 3.0],
            displacement: [0.0, 0.0, 1.0, 1.0]
                .iter()
                .map(|&x| Vec3::new(x, 0.0, 0.0))
                .collect(),
        };
        for k in 0..=300 {
            let x = table.displacement(k as f64 * 0.01).x;
            assert!((0.0..=1.0).contains(&x), "{x}");
        }
    }
}
