//! Narrow phase of spheres: a point, in the middle of the overlap.

use super::manifold::PointManifold;
use crate::geometry::parts::Part;
use crate::{SurfacePoint, Vec3};

/// `R̃ = 1/(1/r_i + 1/r_j)` of two parts, a polyhedron or a surface being flat; infinite without spheres; m.
pub(crate) fn effective_radius(parts: (&Part, &Part)) -> f64 {
    let radius = |part: &Part| match part {
        Part::Sphere { radius, .. } => *radius,
        Part::Polyhedron(_) | Part::Surface(_) => f64::INFINITY,
    };
    let curvature = 1.0 / radius(parts.0) + 1.0 / radius(parts.1);
    1.0 / curvature
}

/// Contact of two spheres of center and radius (m); `None` if they are apart.
#[inline]
pub(crate) fn of_two((a, r): (&Vec3, f64), (b, s): (&Vec3, f64)) -> Option<PointManifold> {
    let offset = b - a;
    let square = offset.norm_squared();
    if square >= (r + s) * (r + s) {
        return None;
    }
    let distance = square.sqrt();
    let normal = if distance > 0.0 {
        offset * (1.0 / distance)
    } else {
        Vec3::z()
    };
    let overlap = r + s - distance;
    let position = a + normal * (r - 0.5 * overlap);
    Some(PointManifold::single(normal, position, overlap))
}

/// Point between two spheres of center and radius (m), the normal from the first to the second, and the gap; m.
pub(crate) fn between((a, r): (&Vec3, f64), (b, s): (&Vec3, f64)) -> (Vec3, Vec3, f64) {
    let offset = b - a;
    let distance = offset.norm();
    let normal = if distance > 0.0 {
        offset / distance
    } else {
        Vec3::z()
    };
    let gap = distance - r - s;
    (a + normal * (r + 0.5 * gap), normal, gap)
}

/// Contact of a sphere of a radius (m) with the nearest point of a body; `normal` from i to j.
pub(crate) fn with_body(nearest: &SurfacePoint, normal: Vec3, radius: f64) -> PointManifold {
    let overlap = radius - nearest.distance;
    let position = nearest.point - nearest.normal * (0.5 * overlap);
    PointManifold::single(normal, position, overlap)
}
