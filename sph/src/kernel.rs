//! Smoothing kernels in three dimensions: Mueller's three.
//!
//! A kernel here has support radius `H`; it is zero beyond. Gradients are given as the factor
//! `W'(r)/r`, so that `∇W = factor · (x_a − x_b)`.
//!
//! Source: Mueller, Charypar & Gross (2003), Eqs. 20 to 22.

use std::f64::consts::PI;

/// What a scheme asks of a kernel.
pub trait Kernel {
    /// Radius beyond which the kernel is zero; m.
    fn support_radius(&self) -> f64;

    /// `W(r)`; 1/m³.
    fn value(&self, r: f64) -> f64;

    /// `W'(r)/r`; 1/m⁵.
    fn gradient_factor(&self, r: f64) -> f64;

    /// `Σ V W` over a cubic lattice of the given spacing, the centre included; dimensionless.
    ///
    /// The lattice value of unity: what a density sum must be divided by so that undisturbed water
    /// has its reference density.
    fn lattice_sum(&self, spacing: [f64; 3]) -> f64 {
        let reach = spacing.map(|s| (self.support_radius() / s).ceil() as i32);
        let mut sum = 0.0;
        for k in -reach[2]..=reach[2] {
            for j in -reach[1]..=reach[1] {
                for i in -reach[0]..=reach[0] {
                    let offset = [i, j, k].map(f64::from);
                    let r2: f64 = (0..3)
                        .map(|axis| (offset[axis] * spacing[axis]).powi(2))
                        .sum();
                    sum += self.value(r2.sqrt());
                }
            }
        }
        sum * spacing.iter().product::<f64>()
    }
}

/// `W = 315/(64 π H⁹) (H² − r²)³`: the density kernel; it needs no square root.
#[derive(Clone, Copy, Debug)]
pub struct Poly6 {
    support_radius: f64,
    factor: f64,
}

/// `W = 15/(π H⁶) (H − r)³`: the pressure kernel; its gradient does not vanish at the centre.
#[derive(Clone, Copy, Debug)]
pub struct Spiky {
    support_radius: f64,
    factor: f64,
}

/// `∇²W = 45/(π H⁶) (H − r)`: the viscous kernel; its Laplacian is positive everywhere.
#[derive(Clone, Copy, Debug)]
pub struct Viscous {
    support_radius: f64,
    factor: f64,
}

impl Poly6 {
    /// The kernel of the given support radius; m, above zero.
    pub fn new(support_radius: f64) -> Self {
        Self {
            support_radius,
            factor: 315.0 / (64.0 * PI * support_radius.powi(9)),
        }
    }

    /// `315/(64 π H⁹)`, to be multiplied by the sum of [`Self::shape`]; 1/m⁹.
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
    pub fn new(support_radius: f64) -> Self {
        Self {
            support_radius,
            factor: 15.0 / (PI * support_radius.powi(6)),
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

    /// Finite at the centre: two particles at one place push each other in no direction.
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
    /// The kernel of the given support radius; m, above zero.
    pub fn new(support_radius: f64) -> Self {
        Self {
            support_radius,
            factor: 45.0 / (PI * support_radius.powi(6)),
        }
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
        assert!((Poly6::new(1.0).value(0.5) - 0.660_943_75).abs() < 1e-7);
        assert!((Spiky::new(1.0).value(0.5) - 0.596_831_04).abs() < 1e-7);
        assert!((Spiky::new(1.0).gradient_factor(0.5) * 0.5 + 3.580_986_22).abs() < 1e-7);
        assert!((Viscous::new(1.0).laplacian(0.5) - 7.161_972_44).abs() < 1e-7);
    }

    #[test]
    fn kernels_integrate_to_one_at_any_support() {
        for support in [0.02, 1.0, 30.0] {
            // midpoint rule, 20000 intervals: error of order 1e-9
            let poly6 = volume_integral(support, |r| Poly6::new(support).value(r));
            let spiky = volume_integral(support, |r| Spiky::new(support).value(r));
            assert!((poly6 - 1.0).abs() < 1e-7, "poly6 {poly6}");
            assert!((spiky - 1.0).abs() < 1e-7, "spiky {spiky}");
        }
    }

    #[test]
    fn gradients_are_the_derivatives_of_the_values() {
        let (poly6, spiky) = (Poly6::new(0.3), Spiky::new(0.3));
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
        let factor = Spiky::new(1.0).gradient_factor(0.4);
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
                (laplacian - Viscous::new(1.0).laplacian(r)).abs() < 2e-3,
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
            let sum = Poly6::new(ratio * 0.05).lattice_sum([0.05; 3]);
            assert!((sum - expected).abs() < 1e-6, "H/dp {ratio}: {sum}");
        }
    }
}
