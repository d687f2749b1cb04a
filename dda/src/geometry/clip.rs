//! Clipping of convex polygons by planes.
//!
//! Source: Sutherland & Hodgman (1974).

use crate::Vec3;

/// Corners that lie on the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OnPlane {
    /// Kept once.
    Once,
    /// Kept, and repeated as the end of the side outside: each corner then names the two sides it comes from.
    Twice,
}

/// Side of a polygon that crosses the plane.
pub(crate) struct Crossing<'a, C> {
    pub from: &'a C,
    pub to: &'a C,
    /// Position of the plane on the side, 0 at `from`, 1 at `to`; –.
    pub share: f64,
    /// True of the side that leaves the part that is kept.
    pub is_leaving: bool,
}

impl Crossing<'_, Vec3> {
    /// Point of the side on the plane.
    pub fn point(&self) -> Vec3 {
        self.from + (self.to - self.from) * self.share
    }
}

/// Keeps the part of a convex polygon where `distance ≤ 0`; `spare` is a buffer.
#[inline]
pub(crate) fn clip<C: Copy>(
    (polygon, spare): (&mut Vec<C>, &mut Vec<C>),
    on_plane: OnPlane,
    distance: impl Fn(&C) -> f64,
    corner: impl Fn(Crossing<C>) -> C,
) {
    spare.clear();
    let n = polygon.len();
    for k in 0..n {
        let (from, to) = (&polygon[k], &polygon[(k + 1) % n]);
        let (before, after) = (distance(from), distance(to));
        if before <= 0.0 {
            spare.push(*from);
        }
        let is_crossed = match on_plane {
            OnPlane::Once => (before < 0.0 && after > 0.0) || (before > 0.0 && after < 0.0),
            OnPlane::Twice => (before <= 0.0 && after > 0.0) || (before > 0.0 && after <= 0.0),
        };
        if is_crossed {
            spare.push(corner(Crossing {
                from,
                to,
                share: before / (before - after),
                is_leaving: before <= 0.0,
            }));
        }
    }
    std::mem::swap(polygon, spare);
}

/// Part of a convex polygon where `distance ≤ 0`, signed from a plane; m.
pub fn clipped_polygon(polygon: &[Vec3], distance: impl Fn(&Vec3) -> f64) -> Vec<Vec3> {
    let (mut polygon, mut spare) = (polygon.to_vec(), Vec::with_capacity(polygon.len() + 1));
    let buffers = (&mut polygon, &mut spare);
    clip(buffers, OnPlane::Twice, distance, |at| at.point());
    polygon
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Vec3> {
        [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]
            .map(|(x, y)| Vec3::new(x, y, 0.0))
            .to_vec()
    }

    #[test]
    fn a_plane_through_the_middle_leaves_half_a_square() {
        let half = clipped_polygon(&square(), |x| x.x - 1.0);
        let expected = [(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)];
        assert_eq!(half, expected.map(|(x, y)| Vec3::new(x, y, 0.0)));
    }

    #[test]
    fn a_polygon_outside_vanishes_and_one_inside_stays() {
        assert!(clipped_polygon(&square(), |x| 1.0 + x.x).is_empty());
        assert_eq!(clipped_polygon(&square(), |x| x.x - 3.0), square());
    }

    #[test]
    fn corners_on_the_plane_are_kept_once_or_twice() {
        let diagonal = |x: &Vec3| x.x - x.y;
        for (on_plane, n) in [(OnPlane::Once, 3), (OnPlane::Twice, 5)] {
            let (mut polygon, mut spare) = (square(), Vec::new());
            clip((&mut polygon, &mut spare), on_plane, diagonal, |at| {
                at.point()
            });
            assert_eq!(polygon.len(), n, "{on_plane:?}: {polygon:?}");
        }
    }
}
