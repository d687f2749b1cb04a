//! Exact integrals of Wendland's C2 kernel over a polyhedron.
//!
//! The effect of a wall on a point `x` of the fluid is the part of its kernel inside the solid. The
//! divergence theorem converts that volume integral to integrals over faces, and further to
//! integrals along edges. With `R` the support radius and `u = r/R`:
//!
//! ```text
//! A(r) = ∫_r^R W t dt   = 3 (1−u)⁵ (8u²+5u+1) / (4π R)
//! B(r) = ∫_r^R W t² dt  = (1−u)⁵ (21u³+15u²+5u+1) / (4π)
//! G(r) = B(r)/r³          satisfies div(y G) = −W
//! C(r) = ∫_r^R G t dt   = (1−u)⁶ (3u²+3u+1) / (4π u R)
//! ```
//!
//! Both `A` and `C` are polynomials in `u` except for the `1/u` of `C`, so that the integrals along an
//! edge have closed forms: accurate to round-off, also for a point on a face or on the line of an edge,
//! where Gauss points along the edge lose digits.
//!
//! In two dimensions, where nothing depends on y, the same holds for polygons.
//!
//! Lengths inside this file are in units of `R`.

mod plane;

use std::f64::consts::PI;

use nalgebra::Matrix3;

use crate::Vec3;
use crate::kernel::Dimensions;

/// A plane face of a polyhedron.
#[derive(Clone, Copy, Debug)]
pub struct Face<'a> {
    /// Unit normal, out of the solid.
    pub normal: Vec3,
    /// Corners of a convex polygon, at least three, counter-clockwise seen from outside; m.
    pub vertices: &'a [Vec3],
}

impl Face<'_> {
    /// Distance of a point from the plane, positive outside the solid; m.
    pub fn distance(&self, x: &Vec3) -> f64 {
        self.vertices
            .first()
            .map_or(f64::INFINITY, |v| self.normal.dot(&(x - v)))
    }
}

/// Integral of the kernel of a point over a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallIntegral {
    /// Share of the kernel inside the solid, `λ = ∫ W dV`; 0 to 1.
    pub lambda: f64,
    /// `∇λ = ∫ ∇W dV`, the gradient taken at the point: it points into the solid; 1/m.
    pub gradient: Vec3,
    /// `Q = ∫ (y − x) ⊗ ∇W dV`: takes a pressure gradient to a force; 1.
    pub moment: Matrix3<f64>,
}

impl WallIntegral {
    /// No solid within the support.
    pub fn zero() -> Self {
        Self {
            lambda: 0.0,
            gradient: Vec3::zeros(),
            moment: Matrix3::zeros(),
        }
    }
}

/// Entries of [`LayerTable`] over `0 ≤ d ≤ R`.
const LAYER_ENTRIES: usize = 400;

/// Corrections from a continuous solid to rows of particles.
///
/// Fluid next to a wall sits in rows; the continuous integral leaves a residual of 2 to 3 % of
/// `1/h` there, which multiplies twice the pressure. Rows of wall at depths `(k + ½) dp` do not:
///
/// ```text
/// c_g(d) = Σ_k dp w'(s_k) / (−w(d)),      s_k = d + (k + ½) dp
/// c_q(d) = Σ_k dp (−s_k) w'(s_k) / Q_nn(d)
/// w(d) = 2π A(d),   w'(d) = −2π d W(d),   Q_nn(d) = 2π B(d)                 in space
/// w(d) = ∫ W dt,    Q_nn(d) = d w + λ                                        in a plane
/// ```
///
/// Both multiply the contribution of a face, by the distance of the point from its plane. The same factors hold on the
/// inner side of a plane, where the rows outside complete a full lattice.
#[derive(Clone, Debug)]
pub struct LayerTable {
    /// `[c_g, c_q]` at `d = k R/(LAYER_ENTRIES − 1)`; 1.
    entries: Vec<[f64; 2]>,
}

impl LayerTable {
    /// Table of a particle spacing (m) and a support radius (m), both above zero.
    pub fn new(particle_spacing: f64, support_radius: f64, dimensions: Dimensions) -> Self {
        let dp = particle_spacing / support_radius;
        let last = (LAYER_ENTRIES - 1) as f64;
        let entries = (0..LAYER_ENTRIES)
            .map(|k| layer_factors(k as f64 / last, dp, dimensions))
            .collect();
        Self { entries }
    }

    /// `c_g` and `c_q` at a distance in units of the support radius.
    fn at(&self, d: f64) -> [f64; 2] {
        let place = d * (LAYER_ENTRIES - 1) as f64;
        let low = (place as usize).min(LAYER_ENTRIES - 2);
        let t = place - low as f64;
        let ([g0, q0], [g1, q1]) = (self.entries[low], self.entries[low + 1]);
        [g0 + t * (g1 - g0), q0 + t * (q1 - q0)]
    }
}

/// `c_g` and `c_q` at distance `d` for rows `dp` apart.
fn layer_factors(d: f64, dp: f64, dimensions: Dimensions) -> [f64; 2] {
    let (mut g, mut q) = (0.0, 0.0);
    let mut s = d + 0.5 * dp;
    while s < 1.0 {
        let slope = PlaneSums::at(s, dimensions).slope;
        g += dp * slope;
        q += dp * s * slope;
        s += dp;
    }
    if g == 0.0 {
        // no row within reach; at d = R the ratio would be 0/0
        return [0.0; 2];
    }
    let whole = PlaneSums::at(d, dimensions);
    [g / whole.value, q / whole.moment]
}

/// Integrals at a distance from a solid behind a plane wall; units of the support radius.
struct PlaneSums {
    /// `λ`.
    share: f64,
    /// `w`: the kernel over the plane.
    value: f64,
    /// `−w'`.
    slope: f64,
    /// `Q_nn`.
    moment: f64,
    /// `∫ 2 W'/r dV`.
    viscous: f64,
}

impl PlaneSums {
    /// At a distance `u` from 0 to below 1.
    fn at(u: f64, dimensions: Dimensions) -> Self {
        match dimensions {
            Dimensions::Two { .. } => plane::plane_sums(u),
            Dimensions::Three => Self {
                share: 0.5 * (1.0 - u).powi(6) * (1.0 + u * (3.0 + 3.0 * u)),
                value: 2.0 * PI * kernel_a(u),
                slope: 2.0 * PI * u * kernel(u),
                moment: 2.0 * PI * kernel_b(u),
                viscous: -14.0 * (1.0 - u).powi(5) * (1.0 + 2.0 * u),
            },
        }
    }
}

/// A point closer than this to a line where two faces meet is moved off it, outward; of `R`.
///
/// The angle subtended by a face would be dominated by round-off. The integrals
/// are continuous, and change by this much relative to their size.
const ON_EDGE: f64 = 1e-8;

/// Integrals over the convex solid bounded by `faces`, seen from `x`.
///
/// ```text
/// λ  = Σ_f d_f I_f[G]                    (+ 1 for x inside)
/// ∇λ = − Σ_f n_f I_f[W]
/// Q  = λ 1 − Σ_f ( ∫_f (y − x) W dA ) ⊗ n_f
/// ```
///
/// `d_f` is the distance from the plane of a face. With `layers`, the contribution of each face to `∇λ` and
/// `Q` is corrected for rows; `λ` remains that of the continuous solid. `support_radius` in m, above
/// zero. The point may be anywhere, but is normally outside. In two dimensions the solid is a prism along y.
pub fn integrate(
    faces: &[Face],
    x: &Vec3,
    support_radius: f64,
    dimensions: Dimensions,
    layers: Option<&LayerTable>,
) -> WallIntegral {
    let mut result = WallIntegral::zero();
    let Some(x) = off_edges(faces, x, support_radius) else {
        return result;
    };
    let all = match dimensions {
        Dimensions::Two { .. } => Matrix3::from_diagonal(&Vec3::new(1.0, 0.0, 1.0)),
        Dimensions::Three => Matrix3::identity(),
    };
    let mut is_inside = true;
    for face in faces {
        let d = face.distance(&x) / support_radius;
        is_inside &= d < 0.0;
        if 1.0 <= d.abs() {
            continue;
        }
        let sums = match dimensions {
            Dimensions::Two { .. } => plane::edge_sums(face, &x, d.abs(), support_radius.recip()),
            Dimensions::Three => face_sums(face, &x, d.abs(), support_radius.recip()),
        };
        let Some(sums) = sums else {
            continue;
        };
        let [c_g, c_q] = layers.map_or([1.0; 2], |table| table.at(d.abs()));
        let solid_angle = d.signum() * sums.distance_times_g;
        let first_moment = face.normal * (d * sums.w) + sums.rim;
        result.lambda += solid_angle;
        result.gradient -= face.normal * (c_g * sums.w / support_radius);
        result.moment += (all * solid_angle + first_moment * face.normal.transpose()) * c_q;
    }
    if is_inside {
        result.lambda += 1.0;
        result.moment += all;
    }
    result
}

/// Viscous factor of a plane wall at distance `d`; 1/m².
///
/// ```text
/// ∫ 2 W'/r dV = −14 (1−u)⁵ (1+2u)/R²,   u = d/R           in space
/// ```
///
/// Both lengths in m; zero beyond the support.
pub fn viscous_factor(d: f64, support_radius: f64, dimensions: Dimensions) -> f64 {
    let u = (d / support_radius).clamp(0.0, 1.0);
    PlaneSums::at(u, dimensions).viscous / (support_radius * support_radius)
}

/// Fraction of the kernel behind a plane wall at distance `d`, both lengths in m: `λ = (1−u)⁶ (3u²+3u+1)/2` in three dimensions.
pub fn plane_share(d: f64, support_radius: f64, dimensions: Dimensions) -> f64 {
    let u = (d / support_radius).clamp(0.0, 1.0);
    PlaneSums::at(u, dimensions).share
}

/// The point, moved off any line where two planes meet; `None` if it is beyond the support.
fn off_edges(faces: &[Face], x: &Vec3, support_radius: f64) -> Option<Vec3> {
    let mut n_near = 0;
    let mut outward = Vec3::zeros();
    for face in faces {
        let d = face.distance(x);
        if support_radius <= d {
            return None;
        }
        if d.abs() < ON_EDGE * support_radius {
            n_near += 1;
            outward += face.normal;
        }
    }
    if n_near < 2 {
        return Some(*x);
    }
    let direction = outward.try_normalize(ON_EDGE).unwrap_or_default();
    Some(x + direction * (2.0 * ON_EDGE * support_radius))
}

/// Integrals over one face, or an edge of a polygon in two dimensions; lengths in units of `R`.
struct FaceSums {
    /// `I[W]`.
    w: f64,
    /// `|d| I[G]`: finite on the plane too.
    distance_times_g: f64,
    /// `Σ_e m_e ∫_e A dl`, `m_e` the outward normal of an edge in the plane: `−∫ (y − x)_t W dA`.
    rim: Vec3,
}

/// An edge seen from the foot of the point on the plane of the face; units of `R`.
struct Edge {
    /// Unit normal of the edge in the plane, out of the face.
    normal: Vec3,
    /// Distance of the foot from the line, positive on the side of the face.
    b: f64,
    /// Ends along the line, from the foot of the foot.
    t: [f64; 2],
}

/// Sums of a face whose plane is at distance `a < 1`; `None` if it is beyond the support.
fn face_sums(face: &Face, x: &Vec3, a: f64, inverse_radius: f64) -> Option<FaceSums> {
    let disc = (1.0 - a * a).sqrt();
    let mut is_whole = true;
    for edge in edges(face, x, inverse_radius) {
        if edge.b <= -disc {
            return None;
        }
        is_whole &= disc <= edge.b;
    }
    let (a_at, c_at) = (kernel_a(a), distance_times_c(a));
    let mut sums = FaceSums {
        w: 0.0,
        distance_times_g: 0.0,
        rim: Vec3::zeros(),
    };
    if is_whole {
        sums.w = 2.0 * PI * a_at;
        sums.distance_times_g = 2.0 * PI * c_at;
        return Some(sums);
    }
    for edge in edges(face, x, inverse_radius) {
        let (b, [t0, t1]) = (edge.b.abs(), edge.t);
        let angle = t1.atan2(b) - t0.atan2(b);
        let (mut w, mut g) = (a_at * angle, c_at * angle);
        let reach = (1.0 - a * a - b * b).max(0.0).sqrt();
        let (low, high) = (t0.max(-reach), t1.min(reach));
        if low < high {
            let part = edge_sums(a, b, low, high);
            w -= part.w;
            g -= part.distance_times_g;
            sums.rim += edge.normal * part.line;
        }
        sums.w += edge.b.signum() * w;
        sums.distance_times_g += edge.b.signum() * g;
    }
    Some(sums)
}

/// The edges of a face, those of no length left out.
fn edges<'a>(
    face: &'a Face,
    x: &'a Vec3,
    inverse_radius: f64,
) -> impl Iterator<Item = Edge> + use<'a> {
    let next = face.vertices.iter().cycle().skip(1);
    face.vertices.iter().zip(next).filter_map(move |(p, q)| {
        let side = q - p;
        let direction = side.try_normalize(0.0)?;
        let normal = direction.cross(&face.normal);
        let from_x = (p - x) * inverse_radius;
        let t = from_x.dot(&direction);
        Some(Edge {
            normal,
            b: from_x.dot(&normal),
            t: [t, t + side.norm() * inverse_radius],
        })
    })
}

/// Integrals along the part of an edge within the support.
struct EdgeSums {
    /// `∫ A(ρ) b dt/(b² + t²)`.
    w: f64,
    /// `a ∫ C(ρ) b dt/(b² + t²)`.
    distance_times_g: f64,
    /// `∫ A(ρ) dt`.
    line: f64,
}

/// Closed forms along an edge at `0 ≤ b` from the foot, `ρ² = a² + b² + t²`.
///
/// ```text
/// P_m = ∫ ρ^m dt                          = ( t ρ^m + m c² P_{m−2} )/(m + 1),  c² = a² + b²
/// S_m = b ∫ (ρ^m − a^m)/(b² + t²) dt      = b P_{m−2} + a² S_{m−2}
/// P_{−1} = asinh(t/c),   a S_{−1} = atan(a t/(b ρ)) − atan(t/b)
/// A = 3/(4π) (1 − 7u² + 35u⁴ − 56u⁵ + 35u⁶ − 8u⁷)
/// C = 1/(4π) (1/u − 3 + 7u² − 21u⁴ + 28u⁵ − 15u⁶ + 3u⁷)
/// ```
fn edge_sums(a: f64, b: f64, low: f64, high: f64) -> EdgeSums {
    let (a2, c2) = (a * a, a * a + b * b);
    let rho = [low, high].map(|t| (c2 + t * t).sqrt());
    let power = |m: i32, before: f64| {
        let ends = high * rho[1].powi(m) - low * rho[0].powi(m);
        (ends + f64::from(m) * c2 * before) / f64::from(m + 1)
    };
    let c = c2.sqrt();
    // with c = 0 it is only ever multiplied by zero
    let p_log = if f64::MIN_POSITIVE < c2 {
        (high / c).asinh() - (low / c).asinh()
    } else {
        0.0
    };
    let p1 = power(1, p_log);
    let p3 = power(3, p1);
    let p5 = power(5, p3);
    let p7 = power(7, p5);
    let p0 = high - low;
    let p2 = power(2, p0);
    let p4 = power(4, p2);
    let p6 = power(6, p4);
    let angle = high.atan2(b) - low.atan2(b);
    let tilted = (a * high).atan2(b * rho[1]) - (a * low).atan2(b * rho[0]);
    let s2 = b * p0;
    let s4 = b * p2 + a2 * s2;
    let s6 = b * p4 + a2 * s4;
    let s1 = b * p_log + a * (tilted - angle);
    let s3 = b * p1 + a2 * s1;
    let s5 = b * p3 + a2 * s3;
    let s7 = b * p5 + a2 * s5;
    let w = -7.0 * s2 + 35.0 * s4 - 56.0 * s5 + 35.0 * s6 - 8.0 * s7;
    let g = tilted - angle + a * (7.0 * s2 - 21.0 * s4 + 28.0 * s5 - 15.0 * s6 + 3.0 * s7);
    let line = p0 - 7.0 * p2 + 35.0 * p4 - 56.0 * p5 + 35.0 * p6 - 8.0 * p7;
    EdgeSums {
        w: kernel_a(a) * angle + 3.0 / (4.0 * PI) * w,
        distance_times_g: distance_times_c(a) * angle + g / (4.0 * PI),
        line: 3.0 / (4.0 * PI) * line,
    }
}

/// `W` of Wendland's C2 at `u < 1`; times 1/R³.
fn kernel(u: f64) -> f64 {
    21.0 / (2.0 * PI) * (1.0 - u).powi(4) * (1.0 + 4.0 * u)
}

/// `A` at `u ≤ 1`; times 1/R.
fn kernel_a(u: f64) -> f64 {
    3.0 / (4.0 * PI) * (1.0 - u).powi(5) * (1.0 + u * (5.0 + 8.0 * u))
}

/// `B` at `u ≤ 1`.
fn kernel_b(u: f64) -> f64 {
    (1.0 - u).powi(5) * (1.0 + u * (5.0 + u * (15.0 + 21.0 * u))) / (4.0 * PI)
}

/// `r C` at `u ≤ 1`: finite at zero.
fn distance_times_c(u: f64) -> f64 {
    (1.0 - u).powi(6) * (1.0 + u * (3.0 + 3.0 * u)) / (4.0 * PI)
}

#[cfg(test)]
#[expect(
    clippy::print_stdout,
    reason = "measured figures stand beside their bounds"
)]
mod tests;
