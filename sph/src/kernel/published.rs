//! Kernels of Mueller, Charypar & Gross (2003), Eqs. 20 to 22: one for density, one for pressure, one for viscosity.

use std::f64::consts::PI;

use super::{Dimensions, Kernel};

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
    pub(super) factor: f64,
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
