//! Prisms over a polygon; a non-convex polygon becomes several convex prisms that fill it exactly.

use super::{Polyhedron, PolyhedronError};
use crate::Vec3;

type Point = [f64; 2];

impl Polyhedron {
    /// Draws a polygon (m) along an axis (0, 1 or 2) from one height to another (m).
    ///
    /// The corners lie in the plane of the remaining axes, in their order (axis 1: x, z), in
    /// either sense. A non-convex polygon is cut into triangles by ear clipping, which are joined
    /// while they stay convex (Hertel & Mehlhorn 1983): at most four times the least number of
    /// parts. Corners on a straight line are dropped.
    ///
    /// # Errors
    ///
    /// [`PolyhedronError::SelfIntersection`], [`PolyhedronError::Polygon`] for an unknown axis,
    /// fewer than three corners, no area or no height, and those of [`Polyhedron::from_faces`].
    pub fn extrusion(
        polygon: &[[f64; 2]],
        axis: usize,
        from: f64,
        to: f64,
    ) -> Result<Vec<Self>, PolyhedronError> {
        let refused = |reason| PolyhedronError::Polygon {
            n: polygon.len(),
            reason,
        };
        if axis > 2 {
            return Err(refused("the axis must be 0, 1 or 2"));
        }
        if !polygon.iter().flatten().all(|c| c.is_finite()) || !from.is_finite() || !to.is_finite()
        {
            return Err(refused("a coordinate is not finite"));
        }
        if from == to {
            return Err(refused("it is drawn from a height to the same height"));
        }
        let outline = outline(polygon)
            .ok_or_else(|| refused("it needs three corners that are not on one line"))?;
        check_simple(polygon)?;
        let parts =
            convex_parts(&outline).ok_or_else(|| refused("it cannot be cut into triangles"))?;
        parts
            .iter()
            .map(|corners| prism(&outline, corners, axis, from, to))
            .collect()
    }
}

/// Twice the signed area of a triangle.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn extent(polygon: &[Point]) -> f64 {
    let first = polygon.first().copied().unwrap_or_default();
    polygon
        .iter()
        .map(|p| (p[0] - first[0]).hypot(p[1] - first[1]))
        .fold(0.0, f64::max)
}

/// Counter-clockwise, without repeated corners and corners on a straight line.
fn outline(polygon: &[Point]) -> Option<Vec<Point>> {
    let scale = extent(polygon);
    let mut corners = polygon.to_vec();
    loop {
        let n = corners.len();
        if n < 3 {
            return None;
        }
        let straight = (0..n).find(|&k| {
            let (a, b, c) = (corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n]);
            let base = (c[0] - a[0]).hypot(c[1] - a[1]).max(1e-9 * scale);
            turn(a, b, c).abs() <= 1e-10 * scale * base
        });
        match straight {
            Some(k) => corners.remove(k),
            None => break,
        };
    }
    let first = corners[0];
    let area: f64 = (1..corners.len() - 1)
        .map(|k| turn(first, corners[k], corners[k + 1]))
        .sum();
    if area < 0.0 {
        corners.reverse();
    }
    Some(corners)
}

fn check_simple(polygon: &[Point]) -> Result<(), PolyhedronError> {
    let n = polygon.len();
    for first in 0..n {
        for second in first + 1..n {
            let (a, b) = (polygon[first], polygon[(first + 1) % n]);
            let (c, d) = (polygon[second], polygon[(second + 1) % n]);
            let is_neighbor = second == first + 1 || (first == 0 && second == n - 1);
            if !is_neighbor && segments_meet(a, b, c, d) {
                return Err(PolyhedronError::SelfIntersection { first, second });
            }
        }
    }
    Ok(())
}

fn segments_meet(a: Point, b: Point, c: Point, d: Point) -> bool {
    let (t1, t2) = (turn(a, b, c), turn(a, b, d));
    let (t3, t4) = (turn(c, d, a), turn(c, d, b));
    let inside = |p: Point, q: Point, r: Point| {
        r[0] >= p[0].min(q[0])
            && r[0] <= p[0].max(q[0])
            && r[1] >= p[1].min(q[1])
            && r[1] <= p[1].max(q[1])
    };
    (t1 * t2 < 0.0 && t3 * t4 < 0.0)
        || (t1 == 0.0 && inside(a, b, c))
        || (t2 == 0.0 && inside(a, b, d))
        || (t3 == 0.0 && inside(c, d, a))
        || (t4 == 0.0 && inside(c, d, b))
}

/// Corner numbers of convex parts, each counter-clockwise.
fn convex_parts(outline: &[Point]) -> Option<Vec<Vec<usize>>> {
    let mut parts = triangles(outline)?;
    // Join two parts over a common edge while the result is convex.
    'join: loop {
        for first in 0..parts.len() {
            for second in first + 1..parts.len() {
                if let Some(union) =
                    union(&parts[first], &parts[second]).filter(|u| is_convex(outline, u))
                {
                    parts[first] = union;
                    parts.remove(second);
                    continue 'join;
                }
            }
        }
        return Some(parts);
    }
}

/// Ear clipping, the fattest ear first, to avoid unnecessary needles.
fn triangles(outline: &[Point]) -> Option<Vec<Vec<usize>>> {
    let mut left: Vec<usize> = (0..outline.len()).collect();
    let mut found = Vec::new();
    while left.len() > 3 {
        let n = left.len();
        let mut best: Option<(f64, usize)> = None;
        for k in 0..n {
            let ids = [left[(k + n - 1) % n], left[k], left[(k + 1) % n]];
            let [a, b, c] = ids.map(|v| outline[v]);
            if turn(a, b, c) <= 0.0 {
                continue;
            }
            let is_ear = left.iter().filter(|v| !ids.contains(v)).all(|&v| {
                let p = outline[v];
                turn(a, b, p) < 0.0 || turn(b, c, p) < 0.0 || turn(c, a, p) < 0.0
            });
            let side = |p: Point, q: Point| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2);
            let quality = turn(a, b, c) / side(a, b).max(side(b, c)).max(side(c, a));
            if is_ear && best.is_none_or(|(q, _)| quality > q) {
                best = Some((quality, k));
            }
        }
        let (_, k) = best?;
        found.push(vec![left[(k + n - 1) % n], left[k], left[(k + 1) % n]]);
        left.remove(k);
    }
    found.push(left);
    Some(found)
}

/// The polygon around two polygons with a common edge, `a→b` in one and `b→a` in the other.
fn union(first: &[usize], second: &[usize]) -> Option<Vec<usize>> {
    let (n, m) = (first.len(), second.len());
    for i in 0..n {
        for j in 0..m {
            if first[i] == second[(j + 1) % m] && first[(i + 1) % n] == second[j] {
                let rest_of_first = (1..=n).map(|k| first[(i + k) % n]);
                let rest_of_second = (2..m).map(|k| second[(j + k) % m]);
                return Some(rest_of_first.chain(rest_of_second).collect());
            }
        }
    }
    None
}

fn is_convex(outline: &[Point], corners: &[usize]) -> bool {
    let n = corners.len();
    (0..n).all(|k| {
        let [a, b, c] = [k, k + 1, k + 2].map(|i| outline[corners[i % n]]);
        turn(a, b, c) >= 0.0
    })
}

fn prism(
    outline: &[Point],
    corners: &[usize],
    axis: usize,
    from: f64,
    to: f64,
) -> Result<Polyhedron, PolyhedronError> {
    let points: Vec<Point> = corners.iter().map(|&c| outline[c]).collect();
    // Two joined triangles can leave a corner on a straight line.
    let points = self::outline(&points).unwrap_or(points);
    let n = points.len() as u32;
    let lift = |p: &Point, height: f64| match axis {
        0 => Vec3::new(height, p[0], p[1]),
        1 => Vec3::new(p[0], height, p[1]),
        _ => Vec3::new(p[0], p[1], height),
    };
    let vertices: Vec<Vec3> = points
        .iter()
        .map(|p| lift(p, from))
        .chain(points.iter().map(|p| lift(p, to)))
        .collect();
    let mut faces: Vec<Vec<u32>> = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    faces.extend((0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]));
    Polyhedron::from_faces(&vertices, &faces)
}
