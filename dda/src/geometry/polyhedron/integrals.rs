//! Exact volume, centroid and second moments of a polyhedron; pure functions.

use super::Polyhedron;
use crate::Vec3;
use crate::geometry::mass_properties::MassProperties;
use nalgebra::Matrix3;

/// Exact volume, centroid and second moment of a polyhedron.
///
/// Faces are cut into fans of triangles (a, b, c); with `D = a·(b × c)` and all vectors from a
/// local origin inside the body, so that far from the world's origin no digits are lost:
///
/// ```text
/// V    = Σ D/6
/// V x_c = Σ D/24 (a + b + c)
/// S    = Σ D/120 [ (a+b+c)(a+b+c)ᵀ + aaᵀ + bbᵀ + ccᵀ ]      then shifted to the centroid
/// ```
/// Source: divergence theorem over tetrahedra that share the origin.
pub fn mass_properties(polyhedron: &Polyhedron) -> MassProperties {
    let origin = local_origin(polyhedron);
    let mut volume = 0.0;
    let mut first = Vec3::zeros();
    let mut second = Matrix3::zeros();
    for_each_triangle(polyhedron, &origin, |a, b, c| {
        let d = a.dot(&b.cross(&c));
        let sum = a + b + c;
        volume += d / 6.0;
        first += sum * (d / 24.0);
        second +=
            (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose())
                * (d / 120.0);
    });
    let centroid = first / volume;
    MassProperties {
        volume,
        centroid: origin + centroid,
        second_moment: second - centroid * centroid.transpose() * volume,
    }
}

/// Volume, negative if the faces are clockwise seen from outside; m³.
pub fn volume(polyhedron: &Polyhedron) -> f64 {
    let mut volume = 0.0;
    for_each_triangle(polyhedron, &local_origin(polyhedron), |a, b, c| {
        volume += a.dot(&b.cross(&c)) / 6.0;
    });
    volume
}

/// Area of a face; m².
pub fn face_area(polyhedron: &Polyhedron, face: usize) -> f64 {
    let corners = polyhedron.loop_origins(face);
    let x = |k: usize| polyhedron.vertices()[corners[k] as usize];
    let area: Vec3 = (1..corners.len() - 1)
        .map(|k| (x(k) - x(0)).cross(&(x(k + 1) - x(0))))
        .sum();
    area.norm() / 2.0
}

fn local_origin(polyhedron: &Polyhedron) -> Vec3 {
    let first = polyhedron.vertices()[0];
    let n = polyhedron.vertices().len() as f64;
    first
        + polyhedron
            .vertices()
            .iter()
            .map(|x| x - first)
            .sum::<Vec3>()
            / n
}

fn for_each_triangle(
    polyhedron: &Polyhedron,
    origin: &Vec3,
    mut visit: impl FnMut(Vec3, Vec3, Vec3),
) {
    for face in 0..polyhedron.loop_count() {
        let corners = polyhedron.loop_origins(face);
        let x = |k: usize| polyhedron.vertices()[corners[k] as usize] - origin;
        for k in 1..corners.len() - 1 {
            visit(x(0), x(k), x(k + 1));
        }
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn check(shift: f64, tolerance: f64) {
        let offset = Vec3::new(shift, -shift, shift);
        let side = Vec3::new(1.0, 0.7, 0.4);
        let found = mass_properties(&Polyhedron::cuboid(offset, offset + side).unwrap());
        let mass = 2600.0 * found.volume;
        assert!((mass / 728.0 - 1.0).abs() < tolerance, "mass {mass}");
        let expected = Matrix3::from_diagonal(&Vec3::new(1.0, 0.49, 0.16)) * (728.0 / 12.0);
        let error = (found.second_moment * 2600.0 - expected).abs().max() / expected.max();
        assert!(error < tolerance, "second moment {error:e}");
        let error = (found.centroid - offset - side / 2.0).norm();
        assert!(
            error < tolerance.max(4.0 * f64::EPSILON * shift),
            "centroid {error:e}"
        );
    }

    #[test]
    fn moments_of_a_box() {
        check(0.0, 1e-12); // D01; measured 2e-16
    }

    #[test]
    fn moments_far_from_the_origin() {
        check(1e4, 1e-9); // D02; the corners themselves carry 1e-12
    }

    #[test]
    fn union_of_two_halves_is_the_whole() {
        let whole =
            mass_properties(&Polyhedron::cuboid(Vec3::zeros(), Vec3::new(2.0, 1.0, 1.0)).unwrap());
        let halves = [0.0, 1.0].map(|x| {
            let corner = Vec3::new(x, 0.0, 0.0);
            mass_properties(&Polyhedron::cuboid(corner, corner + Vec3::repeat(1.0)).unwrap())
        });
        let union = MassProperties::of_union(&halves);
        assert!((union.second_moment - whole.second_moment).abs().max() < 1e-15);
        assert!((union.centroid - whole.centroid).norm() < 1e-15);
    }
}
