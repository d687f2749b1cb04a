//! Kernels against their closed forms, published lattice sums, and each other.

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
