//! Two-dimensional integrals: Wendland's C2 kernel over prisms across a vertical plane in which nothing depends on y.
//!
//! Faces become edges of a polygon, seen from a foot on the edge's line at distance `a`, `ρ² = a² + t²`:
//!
//! ```text
//! W(ρ) = 7/π (1 − 10u² + 20u³ − 15u⁴ + 4u⁵)
//! B(r) = ∫_r^R W t dt = 1/(2π) (1 − 7u² + 35u⁴ − 56u⁵ + 35u⁶ − 8u⁷)
//! G(r) = B(r)/r²          satisfies div(y G) = −W
//! ∫ t W dt = −B(ρ),   a ∫ G dt = 1/(2π) ( atan(t/a) + a (−7P₀ + 35P₂ − 56P₃ + 35P₄ − 8P₅) )
//! P_m = ∫ ρ^m dt = ( t ρ^m + m a² P_{m−2} )/(m + 1),   P_{−1} = asinh(t/a)
//! ```
//!
//! Lengths inside this file are in units of `R`.

use std::f64::consts::PI;

use super::{Face, FaceSums, PlaneSums};
use crate::Vec3;

/// Most that the normal of a face has across the plane; the ends of a prism have all of it there.
const ACROSS: f64 = 0.5;

/// Sums of the edge in which a face across the plane meets it, the point at distance `a < 1` from its line; `None` if
/// it is beyond the support, or an end of the prism.
pub(super) fn edge_sums(face: &Face, x: &Vec3, a: f64, inverse_radius: f64) -> Option<FaceSums> {
    if ACROSS < face.normal.y.abs() {
        return None;
    }
    let along = Vec3::new(face.normal.z, 0.0, -face.normal.x).try_normalize(0.0)?;
    let ends = face.vertices.iter().map(|v| along.dot(&(v - x)));
    let (t0, t1) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| {
        (low.min(t), high.max(t))
    });
    let reach = (1.0 - a * a).sqrt();
    let (low, high) = (
        (t0 * inverse_radius).max(-reach),
        (t1 * inverse_radius).min(reach),
    );
    if high <= low {
        return None;
    }
    let powers = Powers::new(a, low, high);
    let rho = [low, high].map(|t| (a * a + t * t).sqrt().min(1.0));
    Some(FaceSums {
        w: powers.w(),
        distance_times_g: powers.distance_times_g(),
        rim: along * (kernel_b(rho[1]) - kernel_b(rho[0])),
    })
}

/// Integrals over a half space at a distance `a < 1`.
pub(super) fn plane_sums(a: f64) -> PlaneSums {
    let reach = (1.0 - a * a).sqrt();
    let powers = Powers::new(a, -reach, reach);
    let (share, value) = (powers.distance_times_g(), powers.w());
    PlaneSums {
        share,
        value,
        slope: a * powers.cubed() * 140.0 / PI,
        moment: a * value + share,
        viscous: powers.viscous(),
    }
}

/// `P_m` from 0 to 5, and the angle `∫ a dt/ρ²`, over a part of an edge within the support.
struct Powers {
    a: f64,
    p: [f64; 6],
    angle: f64,
}

impl Powers {
    fn new(a: f64, low: f64, high: f64) -> Self {
        let c2 = a * a;
        let rho = [low, high].map(|t| (c2 + t * t).sqrt());
        let power = |m: i32, before: f64| {
            let ends = high * rho[1].powi(m) - low * rho[0].powi(m);
            (ends + f64::from(m) * c2 * before) / f64::from(m + 1)
        };
        // with a = 0 it is only ever multiplied by zero
        let log = if f64::MIN_POSITIVE < c2 {
            (high / a).asinh() - (low / a).asinh()
        } else {
            0.0
        };
        let p0 = high - low;
        let p1 = power(1, log);
        let p2 = power(2, p0);
        let p3 = power(3, p1);
        Self {
            a,
            p: [p0, p1, p2, p3, power(4, p2), power(5, p3)],
            angle: high.atan2(a) - low.atan2(a),
        }
    }

    /// `∫ W dt`.
    fn w(&self) -> f64 {
        let [p0, _, p2, p3, p4, p5] = self.p;
        7.0 / PI * (p0 - 10.0 * p2 + 20.0 * p3 - 15.0 * p4 + 4.0 * p5)
    }

    /// `a ∫ G dt`.
    fn distance_times_g(&self) -> f64 {
        let [p0, _, p2, p3, p4, p5] = self.p;
        let rest = -7.0 * p0 + 35.0 * p2 - 56.0 * p3 + 35.0 * p4 - 8.0 * p5;
        (self.angle + self.a * rest) / (2.0 * PI)
    }

    /// `∫ (1 − ρ)³ dt`: `−W'/ρ` up to its factor.
    fn cubed(&self) -> f64 {
        let [p0, p1, p2, p3, ..] = self.p;
        p0 - 3.0 * p1 + 3.0 * p2 - p3
    }

    /// `a ∫ F/ρ² dt` of `F(r) = ∫_r^R 2W' dt = −280/π ∫_r^R (1−t)³ t dt`.
    fn viscous(&self) -> f64 {
        let [p0, p1, p2, p3, ..] = self.p;
        let rest = p0 / 2.0 - p1 + 0.75 * p2 - p3 / 5.0;
        -280.0 / PI * (self.angle / 20.0 - self.a * rest)
    }
}

/// `B` at `u ≤ 1`.
fn kernel_b(u: f64) -> f64 {
    (1.0 - u).powi(5) * (1.0 + u * (5.0 + 8.0 * u)) / (2.0 * PI)
}
