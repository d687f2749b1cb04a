//! Coulomb's cone `K_μ = {|R_t| ≤ μ R_n}` in a local frame (n, t1, t2).

use crate::Vec3;

/// Size of the tangential part.
#[inline]
pub(super) fn tangential(x: &Vec3) -> f64 {
    // no velocity is as large or as small as those for which `hypot` takes its time
    (x.y * x.y + x.z * x.z).sqrt()
}

/// Nearest point of the cone.
#[inline]
pub(super) fn projected(friction: f64, x: &Vec3) -> Vec3 {
    let along = tangential(x);
    if along <= friction * x.x {
        return *x;
    }
    if friction * along <= -x.x {
        return Vec3::zeros();
    }
    let normal = (x.x + friction * along) / (1.0 + friction * friction);
    let share = friction * normal / along;
    Vec3::new(normal, share * x.y, share * x.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Random;

    /// What is left of a projection is at right angles to it, and in the polar cone `{n ≤ −μ|t|}`.
    #[test]
    fn projections_are_the_nearest_points() {
        let mut random = Random::new(1);
        for k in 0..1000 {
            let friction = 1.5 * random.uniform() * f64::from(k % 10).min(1.0);
            let x = Vec3::from_fn(|_, _| 2.0 * random.uniform() - 1.0);
            let p = projected(friction, &x);
            let rest = x - p;
            assert!(tangential(&p) <= friction * p.x + 1e-15);
            assert!(p.dot(&rest).abs() < 1e-15);
            assert!(
                rest.x + friction * tangential(&rest) < 1e-15,
                "{friction} {x}"
            );
        }
    }
}
