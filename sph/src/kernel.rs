//! Smoothing kernels: Mueller's three, Wendland's C2 and the cubic spline.
//!
//! A kernel here has support radius `H = 2h`; it is zero beyond. Gradients are given as the factor
//! `W'(r)/r`, so that `∇W = factor · (x_a − x_b)`. Each kernel is written once for registers
//! (`PairKernel`) and once for single numbers ([`Kernel`]); a test holds the two together.
//!
//! Sources: Mueller, Charypar & Gross (2003), Eqs. 20 to 22; Wendland (1995); Monaghan (1992).

mod published;

use std::f64::consts::PI;

use crate::simd::lanes::Lanes;
pub use published::{Poly6, Spiky, Viscous};

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
            value: splat(Poly6::new(support_radius, dimensions).factor()),
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

#[cfg(test)]
mod tests;
