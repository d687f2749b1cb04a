//! Damping that gives a restitution, for linear springs and for Hertz's.

/// Restitution of a spring and dashpot whose force is never allowed to pull.
///
/// ```text
/// e = exp( −(ξ/s)(π − atan2(2ξs, s² − ξ²)) ),   s = √(1 − ξ²);   with ξ = cos θ:   e = exp(−2θ cot θ)
/// ```
/// Source: Schwager & Pöschel (2007). At ξ = 1 the rebound is exp(−2).
pub fn clamped_restitution(damping_ratio: f64) -> f64 {
    if damping_ratio >= 1.0 {
        return (-2.0_f64).exp();
    }
    let theta = damping_ratio.acos();
    (-2.0 * theta * damping_ratio / theta.sin()).exp()
}

/// Damping ratio that gives a restitution, by bisection of [`clamped_restitution`]; at most 1.
pub fn damping_ratio(restitution: f64) -> f64 {
    if restitution <= clamped_restitution(1.0) {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if clamped_restitution(middle) > restitution {
            low = middle;
        } else {
            high = middle;
        }
    }
    if restitution >= 1.0 {
        0.0
    } else {
        0.5 * (low + high)
    }
}

/// Restitution of Hertz's spring with the dashpot `β`, its force never pulling. It does not depend on the
/// speed: with `x` in units of `(m̃ v²/K)^2/5`,
///
/// ```text
/// x″ = −max(0, x^3/2 + β x^1/4 x′),    x = 0, x′ = 1 at first;    e = −x′ where the force ends
/// ```
/// Runge-Kutta with some 3000 steps in a contact.
fn hertz_restitution(damping: f64) -> f64 {
    const STEP: f64 = 1e-3;
    /// Ten contacts without damping: what is over-damped creeps back, with next to no speed.
    const LONGEST: u32 = 30_000;
    let force = |x: f64, v: f64| {
        let root = x.max(0.0).sqrt();
        x.max(0.0) * root + damping * root.sqrt() * v
    };
    let (mut x, mut v) = (0.0, 1.0);
    for _ in 0..LONGEST {
        let slope = |x: f64, v: f64| (v, -force(x, v));
        let a = slope(x, v);
        let b = slope(x + 0.5 * STEP * a.0, v + 0.5 * STEP * a.1);
        let c = slope(x + 0.5 * STEP * b.0, v + 0.5 * STEP * b.1);
        let d = slope(x + STEP * c.0, v + STEP * c.1);
        let (before, pushed) = (v, force(x, v));
        x += STEP / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0);
        v += STEP / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1);
        let push = force(x, v);
        if push <= 0.0 && v < 0.0 {
            // The force falls to zero inside the step: the rest of its impulse is a triangle.
            let share = pushed / (pushed - push);
            return -(before - 0.5 * pushed * share * STEP);
        }
    }
    -v
}

/// `β` that gives a restitution, by bisection of [`hertz_restitution`]; at most what damps critically in
/// effect.
pub(super) fn hertz_damping(restitution: f64) -> f64 {
    const MOST: f64 = 4.0;
    if restitution >= 1.0 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, MOST);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if hertz_restitution(middle) > restitution {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damping_from_restitution() {
        // Values of Schwager & Pöschel's formula, five digits.
        for (restitution, ratio) in [(0.2, 0.73125), (0.5, 0.25528), (0.8, 0.07436)] {
            assert!((damping_ratio(restitution) - ratio).abs() < 1e-5);
            assert!((clamped_restitution(damping_ratio(restitution)) - restitution).abs() < 1e-12);
        }
        assert!((clamped_restitution(0.45595) - 0.32486).abs() < 1e-5);
        assert_eq!(damping_ratio(1.0), 0.0);
        assert_eq!(damping_ratio(0.0), 1.0);
    }
}
