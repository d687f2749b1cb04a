//! Quadrature over convex polygons: a fan of triangles about the middle.
//!
//! ```text
//! ∫ f dA = Σ_triangles A/12 (f₁ + f₂ + f₃) + 3A/4 f_centroid
//! ```
//! exact for quadratics.

use crate::Vec3;

/// Corner of a polygon.
pub(crate) trait Corner {
    /// Its position; m.
    fn position(&self) -> Vec3;
}

impl Corner for Vec3 {
    fn position(&self) -> Vec3 {
        *self
    }
}

/// Point of the quadrature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FanPoint {
    /// Corner of the polygon.
    Corner(usize),
    /// Centroid of the triangle of the middle and the side that leaves this corner.
    Triangle(usize),
    /// Mean of the corners.
    Middle,
}

/// Triangles of the middle of a convex polygon and its sides.
pub(crate) struct Fan<'a, C, A> {
    corners: &'a [C],
    middle: Vec3,
    /// Twice the area of a triangle from the cross product of two of its sides; m².
    twice_area: A,
}

impl<'a, C: Corner, A: Fn(&Vec3) -> f64> Fan<'a, C, A> {
    /// Fan of a polygon, none of fewer than three corners.
    pub fn new(corners: &'a [C], twice_area: A) -> Option<Self> {
        if corners.len() < 3 {
            return None;
        }
        let sum: Vec3 = corners.iter().map(Corner::position).sum();
        Some(Self {
            corners,
            middle: sum / corners.len() as f64,
            twice_area,
        })
    }

    fn position(&self, k: usize) -> Vec3 {
        self.corners[k % self.corners.len()].position()
    }

    /// Area of the triangle of the side that leaves corner `k`; m².
    fn triangle(&self, k: usize) -> f64 {
        let (a, b) = (self.position(k), self.position(k + 1));
        0.5 * (self.twice_area)(&(a - self.middle).cross(&(b - self.middle)))
    }

    /// Area of the polygon; m².
    pub fn area(&self) -> f64 {
        (0..self.corners.len()).map(|k| self.triangle(k)).sum()
    }

    /// Visits the points with their share of the area (m²): each corner and the triangle after it, then the middle.
    #[inline]
    pub fn for_each_point(&self, mut visit: impl FnMut(FanPoint, Vec3, f64)) {
        let n = self.corners.len();
        let mut total = 0.0;
        let mut before = self.triangle(n - 1);
        for k in 0..n {
            let area = self.triangle(k);
            let (here, next) = (self.position(k), self.position(k + 1));
            visit(FanPoint::Corner(k), here, (before + area) / 12.0);
            let centroid = (self.middle + here + next) / 3.0;
            visit(FanPoint::Triangle(k), centroid, 0.75 * area);
            total += area;
            before = area;
        }
        visit(FanPoint::Middle, self.middle, total / 12.0);
    }
}

/// Point of the quadrature by midpoints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Midpoint {
    /// Of the side that leaves this corner.
    Side(usize),
    /// Of the diagonal from the first corner to this one.
    Diagonal(usize),
}

/// Visits the midpoints of the sides and diagonals of a convex polygon with their share of its area (m²).
///
/// ```text
/// ∫ f dA = Σ_triangles A/3 (f₁₂ + f₂₃ + f₃₁)          triangles of the first corner and each side
/// ```
/// exact for quadratics, with fewer points than a fan about the middle, but less even ones.
pub(crate) fn for_each_midpoint<C: Corner>(
    corners: &[C],
    twice_area: impl Fn(&Vec3) -> f64,
    mut visit: impl FnMut(Midpoint, Vec3, f64),
) {
    let n = corners.len();
    let Some(first) = corners.first().map(Corner::position) else {
        return;
    };
    let mut before = 0.0;
    for k in 1..n.saturating_sub(1) {
        let (here, next) = (corners[k].position(), corners[k + 1].position());
        let third = twice_area(&(here - first).cross(&(next - first))) / 6.0;
        let spoke = if k == 1 {
            Midpoint::Side(0)
        } else {
            Midpoint::Diagonal(k)
        };
        visit(spoke, (first + here) / 2.0, before + third);
        visit(Midpoint::Side(k), (here + next) / 2.0, third);
        before = third;
    }
    if n > 2 {
        let last = corners[n - 1].position();
        visit(Midpoint::Side(n - 1), (first + last) / 2.0, before);
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn quadratics_over_a_rectangle_are_exact() {
        let corners =
            [(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let fan = Fan::new(&corners, Vec3::norm).unwrap();
        let mut sums = [0.0; 4];
        fan.for_each_point(|_, x, area| {
            let values = [1.0, x.x, x.x * x.y, x.x * x.x];
            sums.iter_mut()
                .zip(values)
                .for_each(|(s, f)| *s += area * f);
        });
        assert!((fan.area() - 6.0).abs() < 1e-14);
        let mut by_midpoints = [0.0; 4];
        for_each_midpoint(&corners, Vec3::norm, |_, x, area| {
            let values = [1.0, x.x, x.x * x.y, x.x * x.x];
            by_midpoints
                .iter_mut()
                .zip(values)
                .for_each(|(s, f)| *s += area * f);
        });
        // ∫ over 3 m × 2 m; rounding is some 1e-15
        for (sum, exact) in sums.iter().zip([6.0, 9.0, 9.0, 18.0]) {
            assert!((sum - exact).abs() < 1e-13, "{sum} of {exact}");
        }
        for (sum, exact) in by_midpoints.iter().zip([6.0, 9.0, 9.0, 18.0]) {
            assert!((sum - exact).abs() < 1e-13, "{sum} of {exact}");
        }
    }

    #[test]
    fn two_corners_make_no_fan() {
        assert!(Fan::new(&[Vec3::zeros(), Vec3::x()], Vec3::norm).is_none());
    }
}
