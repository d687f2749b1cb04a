//! A pressure transducer: the mean over its face and over a while.

use std::f64::consts::TAU;

use riprap_dda::Blocks;
use riprap_sph::{Fluid, Vec3};
use serde::{Deserialize, Serialize};

use crate::scene::resolved::recording::PressureGauge;

/// Points on a ring about the center of a disc, of an eighth of its area each.
const RING: usize = 6;

/// Readings so far within the averaging time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Readings {
    /// Times and means over the face, the oldest first; s, Pa.
    latest: Vec<(f64, f64)>,
}

/// Pressure at a point, or the mean over a disc and a while.
#[derive(Clone, Debug)]
pub(super) struct Transducer {
    /// Points of its face with their shares; m.
    face: Vec<(Vec3, f64)>,
    /// s.
    averaging_time: f64,
    pub(super) readings: Readings,
}

impl Transducer {
    /// A transducer that faces away from the nearest wall, or upward in open water.
    pub(super) fn new(gauge: &PressureGauge, blocks: &Blocks) -> Self {
        let center = gauge.position;
        let radius = 0.5 * gauge.diameter;
        let face = if 0.0 < radius {
            disc(&center, &facing(&center, gauge.diameter, blocks), radius)
        } else {
            vec![(center, 1.0)]
        };
        Self {
            face,
            averaging_time: gauge.averaging_time,
            readings: Readings::default(),
        }
    }

    /// Whether a reading now counts for the row that is due at a time (s).
    pub(super) fn is_listening(&self, time: f64, due: f64) -> bool {
        0.0 < self.averaging_time && due - self.averaging_time <= time
    }

    /// Takes a reading.
    pub(super) fn listen(&mut self, fluid: Option<&Fluid>, time: f64) {
        let readings = &mut self.readings.latest;
        if readings.last().is_some_and(|(last, _)| time <= *last) {
            return;
        }
        readings.push((time, mean_over(&self.face, fluid)));
        // the reading before the averaging time stands at its beginning
        let begin = time - self.averaging_time;
        let n_old = readings.partition_point(|(time, _)| *time <= begin);
        readings.drain(..n_old.saturating_sub(1));
    }

    /// Mean of the last averaging time, each reading held until the next; NaN when dry all the time; Pa.
    pub(super) fn mean(&mut self, fluid: Option<&Fluid>, time: f64) -> f64 {
        self.listen(fluid, time);
        mean_since(&self.readings.latest, time - self.averaging_time)
    }
}

/// Mean of readings after a time (s), each of the while before it; NaN when dry all the time; Pa.
fn mean_since(readings: &[(f64, f64)], begin: f64) -> f64 {
    let (mut sum, mut length) = (0.0, 0.0);
    for pair in readings.windows(2) {
        let during = pair[1].0 - pair[0].0.max(begin);
        sum += during * or_air(pair[1].1);
        length += during;
    }
    let last = readings.last().map_or(f64::NAN, |(_, p)| *p);
    if readings.iter().all(|(_, p)| p.is_nan()) || length <= 0.0 {
        last
    } else {
        sum / length
    }
}

/// The pressure, or that of the air for a dry transducer; Pa.
fn or_air(pressure: f64) -> f64 {
    if pressure.is_nan() { 0.0 } else { pressure }
}

/// Mean over a face; dry points of a wet one are under air; NaN when all are dry; Pa.
fn mean_over(face: &[(Vec3, f64)], fluid: Option<&Fluid>) -> f64 {
    let Some(fluid) = fluid else { return f64::NAN };
    let mut mean = f64::NAN;
    for (point, share) in face {
        if let Some(sample) = fluid.sample(point) {
            mean = or_air(mean) + share * sample.pressure;
        }
    }
    mean
}

/// Points of a disc (m) with their shares of its area, which integrate polynomials of degree 5 (Abramowitz & Stegun 1964,
/// 25.4.61).
fn disc(center: &Vec3, normal: &Vec3, radius: f64) -> Vec<(Vec3, f64)> {
    let (u, v) = across(normal);
    let arm = radius * (2.0_f64 / 3.0).sqrt();
    let on_ring = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / RING as f64).sin_cos();
        (center + (u * cos + v * sin) * arm, 0.125)
    };
    (0..RING).map(on_ring).chain([(*center, 0.25)]).collect()
}

/// Normal of the nearest surface within a distance (m); upward without one.
fn facing(center: &Vec3, within: f64, blocks: &Blocks) -> Vec3 {
    (0..blocks.n_parts())
        .filter_map(|part| blocks.surface_point_within(part, center, within))
        .min_by(|a, b| a.distance.abs().total_cmp(&b.distance.abs()))
        .map_or(Vec3::z(), |surface| surface.normal)
}

/// Two unit vectors across a unit vector.
fn across(normal: &Vec3) -> (Vec3, Vec3) {
    let helper = if normal.z.abs() < 0.9 {
        Vec3::z()
    } else {
        Vec3::x()
    };
    let u = normal.cross(&helper).normalize();
    (u, normal.cross(&u))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_integrates_polynomials() {
        let (center, normal) = (Vec3::new(1.0, 2.0, 3.0), Vec3::x());
        let points = disc(&center, &normal, 0.5);
        let mean = |f: fn(&Vec3) -> f64| -> f64 {
            points
                .iter()
                .map(|(x, share)| share * f(&(x - center)))
                .sum()
        };
        // r²/4 of each square, r⁴/24 of the product of both
        for (found, exact) in [
            (mean(|_| 1.0), 1.0),
            (mean(|x| x.x), 0.0),
            (mean(|x| x.y + x.z), 0.0),
            (mean(|x| x.y * x.y), 0.0625),
            (mean(|x| x.z * x.z), 0.0625),
            (mean(|x| (x.y * x.z).powi(2)), 0.0625 / 24.0),
        ] {
            assert!((found - exact).abs() < 1e-15, "{found} {exact}");
        }
    }

    #[test]
    fn readings_count_by_the_while_before_them() {
        let readings = [(0.0, 9.0), (1.0, 2.0), (3.0, 4.0), (4.0, f64::NAN)];
        assert_eq!(mean_since(&readings, 0.0), (2.0 + 8.0) / 4.0);
        // half of the first while is too old
        assert_eq!(mean_since(&readings, 0.5), (1.0 + 8.0) / 3.5);
        assert!(mean_since(&[(0.0, f64::NAN), (1.0, f64::NAN)], 0.0).is_nan());
        assert_eq!(mean_since(&[(0.0, 7.0)], -1.0), 7.0);
    }
}
