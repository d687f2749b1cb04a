//! Tables over time: monotone cubic pieces.

use crate::Vec3;

/// Value and rate of a table at a time (s).
pub(super) fn table_at(times: &[f64], values: &[Vec3], time: f64) -> (Vec3, Vec3) {
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
/// neighboring slopes. Source: Fritsch & Butland (1984), which keeps the pieces monotone.
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
