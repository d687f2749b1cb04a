//! Smoothing kernels: Mueller's three, Wendland's C2 and the cubic spline.
//!
//! A kernel here has support radius `H = 2h`; it is zero beyond. Gradients are given as the factor
//! `W'(r)/r`, so that `∇W = factor · (x_a − x_b)`. Each kernel is written once for registers
//! (`PairKernel`) and once for single numbers ([`Kernel`]); a test holds the two together.
//!
//! Sources: Mueller, Charypar & Gross (2003), Eqs. 20 to 22; Wendland (1995); Monaghan (1992).

use std::f64::consts::PI;

use crate::simd::lanes::Lanes;

/// Number of dimensions of the flow.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Dimensions {
    /// In a vertical plane: nothing depends on y.
    Two {
        /// Of the slice along y, to which masses and forces belong; m.
        width: f64,
    },
    /// Three-dimensional.
    #[default]
    Three,
}

impl Dimensions {
    /// 2 or 3.
    pub fn count(self) -> f64 {
        match self {
            Self::Two { .. } => 2.0,
            Self::Three => 3.0,
        }
    }
}

/// A kernel by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KernelChoice {
    /// Poly6 for values, spiky for gradients: the published pair.
    Mueller,
    /// Wendland's C2: no pairing at any number of neighbors.
    WendlandC2,
    /// The cubic spline: pairs above some 60 neighbors; for comparison.
    CubicSpline,
}

/// Kernel functions for pair loops.
pub(crate) trait PairKernel<L: Lanes>: Copy + Send + Sync {
    /// Whether sums with this kernel are compiled for the usual pair terms one by one. The others take their terms when
    /// they run, with the same arithmetic: they are for comparison, and code of their own for each would take most of
    /// the time to build the program.
    const IS_SPECIALIZED: bool = false;

    /// A kernel of points in registers.
    fn new(machine: L::Machine, kernel: &PointKernel) -> Self;
    /// `W(r)`; 1/m³.
    fn value(&self, r2: L) -> L;
    /// `W'(r)/r`; 1/m⁵.
    fn gradient_factor(&self, r2: L) -> L;
}

/// [`KernelChoice::WendlandC2`] in registers.
#[derive(Clone, Copy)]
pub(crate) struct WendlandC2<L> {
    zero: L,
    one: L,
    four: L,
    inverse_support: L,
    value: L,
    gradient: L,
}

impl<L: Lanes> PairKernel<L> for WendlandC2<L> {
    const IS_SPECIALIZED: bool = L::IS_SPECIALIZED;

    fn new(machine: L::Machine, kernel: &PointKernel) -> Self {
        let (support_radius, dimensions) = (kernel.support_radius, kernel.dimensions);
        let (value, gradient) = wendland_factors(0.5 * support_radius, dimensions);
        let splat = |x| L::splat(machine, x);
        Self {
            zero: splat(0.0),
            one: splat(1.0),
            four: splat(4.0),
            inverse_support: splat(1.0 / support_radius),
            value: splat(value),
            gradient: splat(gradient),
        }
    }

    #[inline(always)]
    fn value(&self, r2: L) -> L {
        let u = r2.sqrt() * self.inverse_support;
        let s = (self.one - u).max(self.zero);
        let s2 = s * s;
        self.value * (s2 * s2) * self.four.mul_add(u, self.one)
    }

    #[inline(always)]
    fn gradient_factor(&self, r2: L) -> L {
        let s = (self.one - r2.sqrt() * self.inverse_support).max(self.zero);
        self.gradient * s * (s * s)
    }
}

/// `W(0)` and `W'(r)/r` at 0 of Wendland's C2.
///
/// ```text
/// W = σ (1 − q/2)⁴ (1 + 2q),   W'/r = −5 σ/h² (1 − q/2)³,   q = r/h
/// σ = 21/(16 π h³) in three, 7/(4 π h² width) in two dimensions
/// ```
fn wendland_factors(h: f64, dimensions: Dimensions) -> (f64, f64) {
    let sigma = match dimensions {
        Dimensions::Three => 21.0 / (16.0 * PI * h.powi(3)),
        Dimensions::Two { width } => 7.0 / (4.0 * PI * h * h * width),
    };
    (sigma, -5.0 * sigma / (h * h))
}

/// [`KernelChoice::CubicSpline`] in registers.
#[derive(Clone, Copy)]
pub(crate) struct CubicSpline<L> {
    zero: L,
    one: L,
    two: L,
    inverse_h: L,
    value: L,
    gradient: L,
    quarter: L,
    nine_quarters: L,
    three_quarters: L,
}

impl<L: Lanes> PairKernel<L> for CubicSpline<L> {
    fn new(machine: L::Machine, kernel: &PointKernel) -> Self {
        let (support_radius, dimensions) = (kernel.support_radius, kernel.dimensions);
        let h = 0.5 * support_radius;
        let sigma = cubic_factor(h, dimensions);
        let splat = |x| L::splat(machine, x);
        Self {
            zero: splat(0.0),
            one: splat(1.0),
            two: splat(2.0),
            inverse_h: splat(1.0 / h),
            value: splat(sigma),
            gradient: splat(sigma / (h * h)),
            quarter: splat(0.25),
            nine_quarters: splat(2.25),
            three_quarters: splat(0.75),
        }
    }

    #[inline(always)]
    fn value(&self, r2: L) -> L {
        let q = r2.sqrt() * self.inverse_h;
        let outer = (self.two - q).max(self.zero);
        let inner = (self.one - q).max(self.zero);
        self.value * (self.quarter * outer * outer * outer - inner * inner * inner)
    }

    #[inline(always)]
    fn gradient_factor(&self, r2: L) -> L {
        let q = r2.sqrt() * self.inverse_h;
        // q < 1: −3 + 2.25 q,  else −0.75 (2 − q)²/q; they meet at −0.75
        let beyond = q.max(self.one);
        let outer = (self.two - beyond).max(self.zero);
        let inner = self.nine_quarters * (q - self.one).min(self.zero);
        self.gradient * (inner - self.three_quarters * outer * outer / beyond)
    }
}

fn cubic_factor(h: f64, dimensions: Dimensions) -> f64 {
    match dimensions {
        Dimensions::Three => 1.0 / (PI * h.powi(3)),
        Dimensions::Two { width } => 10.0 / (7.0 * PI * h * h * width),
    }
}

/// [`KernelChoice::Mueller`] in registers: poly6 for values, spiky for gradients.
#[derive(Clone, Copy)]
pub(crate) struct Mueller<L> {
    zero: L,
    support: L,
    support2: L,
    value: L,
    gradient: L,
    smallest: L,
}

impl<L: Lanes> PairKernel<L> for Mueller<L> {
    fn new(machine: L::Machine, kernel: &PointKernel) -> Self {
        let (support_radius, dimensions) = (kernel.support_radius, kernel.dimensions);
        let splat = |x| L::splat(machine, x);
        Self {
            zero: splat(0.0),
            support: splat(support_radius),
            support2: splat(support_radius * support_radius),
            value: splat(Poly6::new(support_radius, dimensions).factor),
            gradient: splat(-3.0 * Spiky::new(support_radius, dimensions).factor),
            smallest: splat(1e-12 * support_radius),
        }
    }

    #[inline(always)]
    fn value(&self, r2: L) -> L {
        let d = (self.support2 - r2).max(self.zero);
        self.value * d * (d * d)
    }

    #[inline(always)]
    fn gradient_factor(&self, r2: L) -> L {
        let r = r2.sqrt();
        let d = (self.support - r).max(self.zero);
        self.gradient * (d * d) / r.max(self.smallest)
    }
}

/// Any kernel, by the choice at run time.
#[derive(Clone, Copy)]
pub(crate) enum AnyKernel<L> {
    WendlandC2(WendlandC2<L>),
    CubicSpline(CubicSpline<L>),
    Mueller(Mueller<L>),
}

impl<L: Lanes> PairKernel<L> for AnyKernel<L> {
    fn new(machine: L::Machine, kernel: &PointKernel) -> Self {
        match kernel.choice {
            KernelChoice::WendlandC2 => Self::WendlandC2(PairKernel::new(machine, kernel)),
            KernelChoice::CubicSpline => Self::CubicSpline(PairKernel::new(machine, kernel)),
            KernelChoice::Mueller => Self::Mueller(PairKernel::new(machine, kernel)),
        }
    }

    #[inline(always)]
    fn value(&self, r2: L) -> L {
        match self {
            Self::WendlandC2(kernel) => kernel.value(r2),
            Self::CubicSpline(kernel) => kernel.value(r2),
            Self::Mueller(kernel) => kernel.value(r2),
        }
    }

    #[inline(always)]
    fn gradient_factor(&self, r2: L) -> L {
        match self {
            Self::WendlandC2(kernel) => kernel.gradient_factor(r2),
            Self::CubicSpline(kernel) => kernel.gradient_factor(r2),
            Self::Mueller(kernel) => kernel.gradient_factor(r2),
        }
    }
}

/// Kernel functions for a scheme.
pub trait Kernel {
    /// Radius beyond which the kernel is zero; m.
    fn support_radius(&self) -> f64;

    /// `W(r)`; 1/m³.
    fn value(&self, r: f64) -> f64;

    /// `W'(r)/r`; 1/m⁵.
    fn gradient_factor(&self, r: f64) -> f64;

    /// `Σ V W` over a cubic lattice of the given spacing, the center included; dimensionless.
    ///
    /// The lattice value of unity: divisor of a density sum for which undisturbed water
    /// has its reference density.
    fn lattice_sum(&self, spacing: [f64; 3]) -> f64
    where
        Self: Sized,
    {
        lattice_sum(self, spacing, [1; 3])
    }
}

/// A kernel for single points: gauges, start values, tests.
#[derive(Clone, Copy, Debug)]
pub struct PointKernel {
    choice: KernelChoice,
    support_radius: f64,
    dimensions: Dimensions,
}

impl PointKernel {
    /// The kernel of a support radius; m, above zero.
    pub fn new(choice: KernelChoice, support_radius: f64, dimensions: Dimensions) -> Self {
        Self {
            choice,
            support_radius,
            dimensions,
        }
    }
}

impl Kernel for PointKernel {
    fn support_radius(&self) -> f64 {
        self.support_radius
    }

    fn value(&self, r: f64) -> f64 {
        let h = 0.5 * self.support_radius;
        let q = r / h;
        match self.choice {
            KernelChoice::Mueller => Poly6::new(self.support_radius, self.dimensions).value(r),
            KernelChoice::WendlandC2 => {
                let s = (1.0 - 0.5 * q).max(0.0);
                wendland_factors(h, self.dimensions).0 * s.powi(4) * (1.0 + 2.0 * q)
            }
            KernelChoice::CubicSpline => {
                let (outer, inner) = ((2.0 - q).max(0.0), (1.0 - q).max(0.0));
                cubic_factor(h, self.dimensions) * (0.25 * outer.powi(3) - inner.powi(3))
            }
        }
    }

    fn gradient_factor(&self, r: f64) -> f64 {
        let h = 0.5 * self.support_radius;
        let q = r / h;
        match self.choice {
            KernelChoice::Mueller => {
                Spiky::new(self.support_radius, self.dimensions).gradient_factor(r)
            }
            KernelChoice::WendlandC2 => {
                wendland_factors(h, self.dimensions).1 * (1.0 - 0.5 * q).max(0.0).powi(3)
            }
            KernelChoice::CubicSpline => {
                let shape = if q < 1.0 {
                    2.25 * q - 3.0
                } else {
                    -0.75 * (2.0 - q).max(0.0).powi(2) / q
                };
                cubic_factor(h, self.dimensions) / (h * h) * shape
            }
        }
    }

    fn lattice_sum(&self, spacing: [f64; 3]) -> f64 {
        match self.dimensions {
            Dimensions::Three => lattice_sum(self, spacing, [1; 3]),
            Dimensions::Two { width } => width * lattice_sum(self, spacing, [1, 0, 1]),
        }
    }
}

/// `Σ V W` over the lattice along the axes that count.
fn lattice_sum(kernel: &impl Kernel, spacing: [f64; 3], axes: [i32; 3]) -> f64 {
    let reach: [i32; 3] = std::array::from_fn(|axis| {
        axes[axis] * (kernel.support_radius() / spacing[axis]).ceil() as i32
    });
    let mut sum = 0.0;
    for k in -reach[2]..=reach[2] {
        for j in -reach[1]..=reach[1] {
            for i in -reach[0]..=reach[0] {
                let offset = [i, j, k].map(f64::from);
                let r2: f64 = (0..3)
                    .map(|axis| (offset[axis] * spacing[axis]).powi(2))
                    .sum();
                sum += kernel.value(r2.sqrt());
            }
        }
    }
    let volume: f64 = (0..3)
        .filter(|&axis| axes[axis] == 1)
        .map(|axis| spacing[axis])
        .product();
    sum * volume
}

/// `W = 315/(64 π H⁹) (H² − r²)³`, `4/(π H⁸)` in two dimensions: the density kernel; it needs no square root.
#[derive(Clone, Copy, Debug)]
pub struct Poly6 {
    support_radius: f64,
    factor: f64,
}

/// `W = 15/(π H⁶) (H − r)³`, `10/(π H⁵)` in two dimensions: the pressure kernel; its gradient does not vanish at the
/// center.
#[derive(Clone, Copy, Debug)]
pub struct Spiky {
    support_radius: f64,
    factor: f64,
}

/// `∇²W = 45/(π H⁶) (H − r)`, `40/(π H⁵)` in two dimensions: the viscous kernel; its Laplacian is positive everywhere.
#[derive(Clone, Copy, Debug)]
pub struct Viscous {
    support_radius: f64,
    factor: f64,
}

impl Poly6 {
    /// The kernel of the given support radius; m, above zero.
    pub fn new(support_radius: f64, dimensions: Dimensions) -> Self {
        Self {
            support_radius,
            factor: match dimensions {
                Dimensions::Three => 315.0 / (64.0 * PI * support_radius.powi(9)),
                Dimensions::Two { width } => 4.0 / (PI * support_radius.powi(8) * width),
            },
        }
    }

    /// `315/(64 π H⁹)` or its two-dimensional counterpart, to be multiplied by the sum of [`Self::shape`]; 1/m⁹.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// `(H² − r²)³` from the squared distance, zero beyond the support; m⁶.
    #[inline(always)]
    pub fn shape(&self, r2: f64) -> f64 {
        let d = (self.support_radius * self.support_radius - r2).max(0.0);
        d * d * d
    }
}

impl Kernel for Poly6 {
    fn support_radius(&self) -> f64 {
        self.support_radius
    }

    fn value(&self, r: f64) -> f64 {
        self.factor * self.shape(r * r)
    }

    fn gradient_factor(&self, r: f64) -> f64 {
        let d = (self.support_radius * self.support_radius - r * r).max(0.0);
        -6.0 * self.factor * d * d
    }
}

impl Spiky {
    /// The kernel of the given support radius; m, above zero.
    pub fn new(support_radius: f64, dimensions: Dimensions) -> Self {
        Self {
            support_radius,
            factor: match dimensions {
                Dimensions::Three => 15.0 / (PI * support_radius.powi(6)),
                Dimensions::Two { width } => 10.0 / (PI * support_radius.powi(5) * width),
            },
        }
    }
}

impl Kernel for Spiky {
    fn support_radius(&self) -> f64 {
        self.support_radius
    }

    fn value(&self, r: f64) -> f64 {
        self.factor * (self.support_radius - r).max(0.0).powi(3)
    }

    /// Finite at the center: two particles at the same position exert no force.
    ///
    /// Geraili Mikola & Sitar (2014), Eq. 15 lacks the leading minus:
    /// `−45/(π H⁶) [(H² + r²)/r − 2H] = −45/(π H⁶) (H − r)²/r`.
    #[inline(always)]
    fn gradient_factor(&self, r: f64) -> f64 {
        let d = (self.support_radius - r).max(0.0);
        -3.0 * self.factor * d * d / r.max(1e-12 * self.support_radius)
    }
}

impl Viscous {
    /// The kernel of the given support radius; m, above zero. In two dimensions it has the second moment of a Laplacian,
    /// `∫ r² ∇²W dA = 4`, as the published one in three.
    pub fn new(support_radius: f64, dimensions: Dimensions) -> Self {
        Self {
            support_radius,
            factor: match dimensions {
                Dimensions::Three => 45.0 / (PI * support_radius.powi(6)),
                Dimensions::Two { width } => 40.0 / (PI * support_radius.powi(5) * width),
            },
        }
    }

    /// `45/(π H⁶)` or its two-dimensional counterpart; 1/m⁶.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// `H`; m.
    pub fn support_radius(&self) -> f64 {
        self.support_radius
    }

    /// `∇²W(r)`; 1/m⁵.
    #[inline(always)]
    pub fn laplacian(&self, r: f64) -> f64 {
        self.factor * (self.support_radius - r).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint rule for `4π ∫ f(r) r² dr` over the support.
    fn volume_integral(support: f64, f: impl Fn(f64) -> f64) -> f64 {
        let n = 20_000;
        let dr = support / f64::from(n);
        (0..n)
            .map(|i| {
                let r = (f64::from(i) + 0.5) * dr;
                4.0 * PI * r * r * f(r) * dr
            })
            .sum()
    }

    #[test]
    fn values_match_the_closed_forms() {
        // H = 1; digits from the formulas above evaluated by hand.
        assert!((Poly6::new(1.0, SPACE).value(0.5) - 0.660_943_75).abs() < 1e-7);
        assert!((Spiky::new(1.0, SPACE).value(0.5) - 0.596_831_04).abs() < 1e-7);
        assert!((Spiky::new(1.0, SPACE).gradient_factor(0.5) * 0.5 + 3.580_986_22).abs() < 1e-7);
        assert!((Viscous::new(1.0, SPACE).laplacian(0.5) - 7.161_972_44).abs() < 1e-7);
    }

    #[test]
    fn kernels_integrate_to_one_at_any_support() {
        for support in [0.02, 1.0, 30.0] {
            // midpoint rule, 20000 intervals: error of order 1e-9
            let poly6 = volume_integral(support, |r| Poly6::new(support, SPACE).value(r));
            let spiky = volume_integral(support, |r| Spiky::new(support, SPACE).value(r));
            assert!((poly6 - 1.0).abs() < 1e-7, "poly6 {poly6}");
            assert!((spiky - 1.0).abs() < 1e-7, "spiky {spiky}");
            // in a plane `2π ∫ f r dr`, of a slice of width 0.7 m; ∇²(r²) = 4
            let area = |f: &dyn Fn(f64) -> f64| volume_integral(support, |r| 0.35 * f(r) / r);
            let poly6 = Poly6::new(support, PLANE);
            let spiky = Spiky::new(support, PLANE);
            let viscous = Viscous::new(support, PLANE);
            assert!((area(&|r| poly6.value(r)) - 1.0).abs() < 1e-7);
            assert!((area(&|r| spiky.value(r)) - 1.0).abs() < 1e-7);
            assert!((area(&|r| r * r * viscous.laplacian(r)) - 4.0).abs() < 1e-6);
        }
    }

    #[test]
    fn gradients_are_the_derivatives_of_the_values() {
        let (poly6, spiky) = (Poly6::new(0.3, SPACE), Spiky::new(0.3, SPACE));
        for r in [0.01, 0.1, 0.2, 0.29] {
            let step = 1e-7;
            for (name, derivative, factor) in [
                (
                    "poly6",
                    (poly6.value(r + step) - poly6.value(r - step)) / (2.0 * step),
                    poly6.gradient_factor(r),
                ),
                (
                    "spiky",
                    (spiky.value(r + step) - spiky.value(r - step)) / (2.0 * step),
                    spiky.gradient_factor(r),
                ),
            ] {
                // central difference at 1e-7 of a cubic-like function: 1e-6 of the largest slope
                assert!(
                    (derivative - factor * r).abs() < 1e-6 * (1.0 + derivative.abs()),
                    "{name} at {r}"
                );
            }
        }
    }

    #[test]
    fn misprint_of_eq_15_pressure_pushes_apart() {
        // The printed gradient lacks the leading minus; with it the force of a compressed pair,
        // −(p_a + p_b) ∇W, points from b to a.
        let factor = Spiky::new(1.0, SPACE).gradient_factor(0.4);
        assert!(factor < 0.0);
        let printed_bracket = (1.0 + 0.4_f64.powi(2)) / 0.4 - 2.0;
        assert!((factor + 45.0 / PI * printed_bracket).abs() < 1e-12 * factor.abs());
    }

    #[test]
    fn viscous_laplacian_is_that_of_its_kernel() {
        // ∇²W = (1/r²) d/dr (r² W') with W = 15/(2πH³)(−r³/2H³ + r²/H² + H/2r − 1), H = 1
        let w = |r: f64| 15.0 / (2.0 * PI) * (-r.powi(3) / 2.0 + r * r + 0.5 / r - 1.0);
        let e = 1e-4;
        for r in [0.2, 0.5, 0.8_f64] {
            let flux = |r: f64| r * r * (w(r + e) - w(r - e)) / (2.0 * e);
            let laplacian = (flux(r + e) - flux(r - e)) / (2.0 * e * r * r);
            // second-order difference at 1e-4 of a function with fourth derivative ~ 1e3
            assert!(
                (laplacian - Viscous::new(1.0, SPACE).laplacian(r)).abs() < 2e-3,
                "r {r}: {laplacian}"
            );
        }
    }

    #[test]
    fn lattice_sums_match_published_values() {
        for (ratio, expected) in [
            (2.4, 1.000_765_6),
            (2.6, 0.993_338_1),
            (3.0, 1.002_189_0),
            (4.0, 0.999_997_7),
        ] {
            let sum = Poly6::new(ratio * 0.05, SPACE).lattice_sum([0.05; 3]);
            assert!((sum - expected).abs() < 1e-6, "H/dp {ratio}: {sum}");
        }
    }

    const SPACE: Dimensions = Dimensions::Three;
    const PLANE: Dimensions = Dimensions::Two { width: 0.7 };

    /// A kernel of smoothing length `h`.
    fn kernel(choice: KernelChoice, h: f64, dimensions: Dimensions) -> PointKernel {
        PointKernel::new(choice, 2.0 * h, dimensions)
    }

    /// S01.
    #[test]
    fn wendland_values_match_the_closed_forms() {
        let w = kernel(KernelChoice::WendlandC2, 1.0, SPACE);
        // h = 1: 21/(16 π) and 21/(16 π) (1/2)⁴ 3, eight printed digits
        assert!((w.value(0.0) - 0.417_781_73).abs() < 1e-7);
        assert!((w.value(1.0) - 0.078_334_07).abs() < 1e-7);
        // W'/r at 1: −105/(16 π) (1/2)³
        assert!((w.gradient_factor(1.0) + 105.0 / (128.0 * PI)).abs() < 1e-12);
        let plane = kernel(
            KernelChoice::WendlandC2,
            1.0,
            Dimensions::Two { width: 1.0 },
        );
        assert!((plane.value(0.0) - 7.0 / (4.0 * PI)).abs() < 1e-12);
        assert!((plane.gradient_factor(1.0) + 35.0 / (32.0 * PI)).abs() < 1e-12);
    }

    #[test]
    fn kernels_for_points_integrate_to_one_in_plane_and_space() {
        for choice in [KernelChoice::WendlandC2, KernelChoice::CubicSpline] {
            for h in [0.02, 3.0] {
                let space = kernel(choice, h, SPACE);
                let volume = volume_integral(2.0 * h, |r| space.value(r));
                let plane = kernel(choice, h, PLANE);
                // a shell of the plane is 2π r width dr, one of space 4π r² dr
                let area = volume_integral(2.0 * h, |r| plane.value(r) * 0.7 / (2.0 * r));
                // midpoint rule, 20000 intervals: error of order 1e-9
                assert!((volume - 1.0).abs() < 1e-7, "{choice:?} {volume}");
                assert!((area - 1.0).abs() < 1e-7, "{choice:?} {area}");
            }
        }
    }

    #[test]
    fn gradient_factors_for_points_are_derivatives() {
        for choice in [KernelChoice::WendlandC2, KernelChoice::CubicSpline] {
            for dimensions in [SPACE, PLANE] {
                let w = kernel(choice, 0.5, dimensions);
                let largest = w.gradient_factor(0.25).abs();
                for r in [0.01, 0.2, 0.49, 0.51, 0.8, 0.99_f64] {
                    let e = 1e-5;
                    let slope = (w.value(r + e) - w.value(r - e)) / (2.0 * e);
                    // central difference: third derivative times 1e-10/6
                    assert!(
                        (slope - w.gradient_factor(r) * r).abs() < 1e-7 * largest,
                        "{choice:?} {r}"
                    );
                }
            }
        }
    }

    /// S02.
    #[test]
    fn lattice_sums_of_wendland_match_published_values() {
        for (ratio, expected) in [
            (1.2, 1.017_456_9),
            (1.3, 1.009_500_8),
            (1.5, 1.003_141_1),
            (2.0, 1.000_548_6),
        ] {
            let sum = kernel(KernelChoice::WendlandC2, ratio * 0.05, SPACE).lattice_sum([0.05; 3]);
            // eight printed digits
            assert!((sum - expected).abs() < 1e-6, "h/dp {ratio}: {sum}");
        }
        // in the plane the sum counts the width once, whatever it is, and is as near to one
        for ratio in [1.3, 1.5, 2.0] {
            let sum = |choice| kernel(choice, ratio * 0.05, PLANE).lattice_sum([0.05, 0.7, 0.05]);
            // 1.01047, 1.00514, 1.00121 for Wendland's; 0.99995, 1.00344, 0.99996 for the spline
            let (wendland, spline) = (
                sum(KernelChoice::WendlandC2),
                sum(KernelChoice::CubicSpline),
            );
            assert!((wendland - 1.0).abs() < 0.0106, "h/dp {ratio}: {wendland}");
            assert!((spline - 1.0).abs() < 3.5e-3, "h/dp {ratio}: {spline}");
        }
    }

    /// S02: what a particle half a spacing from the cut of a half space feels.
    #[test]
    fn gradient_at_the_cut_of_a_half_space_matches_the_published_value() {
        let (dp, h) = (1.0, 1.3);
        let w = kernel(KernelChoice::WendlandC2, h, SPACE);
        let mut sum = 0.0;
        for k in 0..4 {
            for (j, i) in (-3..=3).flat_map(|j| (-3..=3).map(move |i| (j, i))) {
                let [x, y, z] = [i, j, k].map(|n| f64::from(n) * dp);
                sum += z * w.gradient_factor((x * x + y * y + z * z).sqrt());
            }
        }
        // five printed digits
        assert!(
            (h * sum.abs() * dp.powi(3) - 0.601_12).abs() < 1e-4,
            "{}",
            h * sum
        );
    }

    /// Largest differences of register kernels from point kernels, of values and gradient factors,
    /// relative to the value at the center and the gradient factor at a tenth of the support.
    fn register_error<L: Lanes, K: PairKernel<L>>(
        machine: L::Machine,
        choice: KernelChoice,
        dimensions: Dimensions,
    ) -> [f64; 2] {
        let support = 0.037;
        let (point, register) = (
            PointKernel::new(choice, support, dimensions),
            K::new(machine, &PointKernel::new(choice, support, dimensions)),
        );
        let scale = [point.value(0.0), point.gradient_factor(0.1 * support).abs()];
        let mut largest = [0.0_f64; 2];
        for k in 4..=48 {
            // beyond the support too
            let r = support * f64::from(k) / 40.0;
            let r2 = L::splat(machine, r * r);
            let lanes = L::WIDTH as f64;
            let value = register.value(r2).sum() / lanes - point.value(r);
            let factor = register.gradient_factor(r2).sum() / lanes - point.gradient_factor(r);
            for (largest, error) in largest
                .iter_mut()
                .zip([value / scale[0], factor / scale[1]])
            {
                *largest = largest.max(error.abs());
            }
        }
        largest
    }

    fn register_errors<L: Lanes>(machine: L::Machine) -> f64 {
        let mut errors = Vec::new();
        for dimensions in [SPACE, PLANE] {
            let choice = KernelChoice::WendlandC2;
            errors.extend(register_error::<L, WendlandC2<L>>(
                machine, choice, dimensions,
            ));
            let choice = KernelChoice::CubicSpline;
            errors.extend(register_error::<L, CubicSpline<L>>(
                machine, choice, dimensions,
            ));
            for choice in [
                KernelChoice::WendlandC2,
                KernelChoice::CubicSpline,
                KernelChoice::Mueller,
            ] {
                errors.extend(register_error::<L, AnyKernel<L>>(
                    machine, choice, dimensions,
                ));
            }
        }
        let choice = KernelChoice::Mueller;
        errors.extend(register_error::<L, Mueller<L>>(machine, choice, SPACE));
        errors.extend(register_error::<L, Mueller<L>>(machine, choice, PLANE));
        errors.into_iter().fold(0.0, f64::max)
    }

    #[test]
    fn kernels_in_registers_are_those_of_points() {
        use crate::simd::lanes::{Machine, Portable};
        // a dozen roundings of a quantity no larger than its scale: 1e-15 and 6e-8 each
        let check = |single: f64, double: f64| {
            assert!(single < 1e-6, "{single}");
            assert!(double < 1e-14, "{double}");
        };
        check(
            register_errors::<<Portable as Machine>::F32>(Portable),
            register_errors::<<Portable as Machine>::F64>(Portable),
        );
        #[cfg(target_arch = "x86_64")]
        if let Some(machine) = crate::simd::lanes::Avx2::detect() {
            use crate::simd::lanes::Avx2;
            check(
                register_errors::<<Avx2 as Machine>::F32>(machine),
                register_errors::<<Avx2 as Machine>::F64>(machine),
            );
        }
    }
}
