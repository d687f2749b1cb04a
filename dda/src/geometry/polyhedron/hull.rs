//! Convex hull of points: triangles of parry, joined into polygons and checked.

use super::{Polyhedron, PolyhedronError, build::PLANE_TOLERANCE};
use crate::Vec3;
use parry3d_f64::math::Vector;
use std::collections::BTreeMap;

/// Triangles within this of one plane become one face; × extent of the points. Well below
/// [`PLANE_TOLERANCE`], so that a joined face passes the check of planarity.
const COPLANAR_TOLERANCE: f64 = 1e-8;

impl Polyhedron {
    /// The convex hull of points (m), at least four of them and not in one plane. Points inside,
    /// on faces and on edges are dropped.
    ///
    /// # Errors
    ///
    /// [`PolyhedronError::Hull`] if no hull is found or a point lies outside the one found,
    /// [`PolyhedronError::NoVolume`] and the others of [`Polyhedron::from_faces`].
    pub fn convex_hull(points: &[Vec3]) -> Result<Self, PolyhedronError> {
        let failed = |reason: String| PolyhedronError::Hull {
            n_points: points.len(),
            reason,
        };
        if let Some(vertex) = points.iter().position(|x| !x.iter().all(|c| c.is_finite())) {
            return Err(PolyhedronError::NotFinite { vertex });
        }
        if points.len() < 4 {
            return Err(failed("at least 4 are needed".into()));
        }
        // a local origin keeps the digits of hulls at map coordinates
        let shift = points[0];
        let local: Vec<Vector> = points
            .iter()
            .map(|x| Vector::new(x.x - shift.x, x.y - shift.y, x.z - shift.z))
            .collect();
        let (vertices, triangles) = parry3d_f64::transformation::try_convex_hull(&local)
            .map_err(|error| failed(format!("{error:?}")))?;
        let vertices: Vec<Vec3> = vertices
            .iter()
            .map(|x| Vec3::new(x.x, x.y, x.z) + shift)
            .collect();
        let (vertices, faces) = joined(&vertices, &triangles)
            .ok_or_else(|| failed("its faces do not close; are the points in one plane?".into()))?;
        let hull = Self::from_faces(&vertices, &faces)?;
        let limit = PLANE_TOLERANCE * hull.size();
        for (k, x) in points.iter().enumerate() {
            for face in 0..hull.n_faces() {
                let distance = hull.plane_distance(face, x);
                if distance > limit {
                    return Err(failed(format!(
                        "point {k} lies {distance:e} m outside the hull found"
                    )));
                }
            }
        }
        Ok(hull)
    }
}

/// Vertices and faces after triangles of one plane are joined and vertices where fewer than three faces meet are dropped.
fn joined(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Option<(Vec<Vec3>, Vec<Vec<u32>>)> {
    let owner = owner_of_sides(triangles);
    let (group, n_groups) = coplanar_groups(vertices, triangles, &owner)?;
    let outlines: Option<Vec<Vec<u32>>> = (0..n_groups)
        .map(|g| outline(triangles, &owner, &group, g))
        .collect();
    Some(without_flat_vertices(vertices, outlines?))
}

/// Triangle of each directed side.
type Sides = BTreeMap<(u32, u32), usize>;

fn owner_of_sides(triangles: &[[u32; 3]]) -> Sides {
    let mut owner = Sides::new();
    for (t, triangle) in triangles.iter().enumerate() {
        for k in 0..3 {
            owner.insert((triangle[k], triangle[(k + 1) % 3]), t);
        }
    }
    owner
}

/// Numbers of the connected groups of triangles in one plane, and the number of groups; `None` if a side has no neighbor.
fn coplanar_groups(
    vertices: &[Vec3],
    triangles: &[[u32; 3]],
    owner: &Sides,
) -> Option<(Vec<usize>, usize)> {
    let first = *vertices.first()?;
    let extent = vertices
        .iter()
        .map(|x| (x - first).norm())
        .fold(0.0, f64::max);
    let area = |t: usize| {
        let [a, b, c] = triangles[t].map(|v| vertices[v as usize]);
        (b - a).cross(&(c - a))
    };
    // large triangles first: their normals are the most accurate
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by(|&s, &t| area(t).norm().total_cmp(&area(s).norm()).then(s.cmp(&t)));
    let mut group = vec![usize::MAX; triangles.len()];
    let mut n_groups = 0;
    for seed in order {
        if group[seed] != usize::MAX {
            continue;
        }
        let normal = area(seed).normalize();
        let origin = vertices[triangles[seed][0] as usize];
        let is_near = |t: usize| {
            triangles[t].iter().all(|&v| {
                normal.dot(&(vertices[v as usize] - origin)).abs() <= COPLANAR_TOLERANCE * extent
            })
        };
        group[seed] = n_groups;
        let mut front = vec![seed];
        while let Some(t) = front.pop() {
            for k in 0..3 {
                let twin = (triangles[t][(k + 1) % 3], triangles[t][k]);
                let neighbor = *owner.get(&twin)?;
                if group[neighbor] == usize::MAX && is_near(neighbor) {
                    group[neighbor] = n_groups;
                    front.push(neighbor);
                }
            }
        }
        n_groups += 1;
    }
    Some((group, n_groups))
}

/// The closed loop of vertices around a group; `None` if its sides do not form exactly one.
fn outline(
    triangles: &[[u32; 3]],
    owner: &Sides,
    group: &[usize],
    number: usize,
) -> Option<Vec<u32>> {
    let mut after = BTreeMap::new();
    let of_group = triangles.iter().zip(group).filter(|(_, g)| **g == number);
    for (triangle, _) in of_group {
        for k in 0..3 {
            let (from, to) = (triangle[k], triangle[(k + 1) % 3]);
            if group[*owner.get(&(to, from))?] != number && after.insert(from, to).is_some() {
                return None;
            }
        }
    }
    let first = *after.keys().next()?;
    let mut corners = vec![first];
    while let Some(&to) = corners.last().and_then(|v| after.get(v)) {
        if to == first {
            break;
        }
        corners.push(to);
        if corners.len() > after.len() {
            return None;
        }
    }
    (corners.len() == after.len()).then_some(corners)
}

/// Vertices where at least three faces meet, and the faces with these alone.
fn without_flat_vertices(vertices: &[Vec3], outlines: Vec<Vec<u32>>) -> (Vec<Vec3>, Vec<Vec<u32>>) {
    let mut n_faces_at = vec![0_u32; vertices.len()];
    outlines
        .iter()
        .flatten()
        .for_each(|&v| n_faces_at[v as usize] += 1);
    let mut renumbered = vec![u32::MAX; vertices.len()];
    let mut kept = Vec::new();
    for (v, x) in vertices
        .iter()
        .enumerate()
        .filter(|(v, _)| n_faces_at[*v] >= 3)
    {
        renumbered[v] = kept.len() as u32;
        kept.push(*x);
    }
    let faces = outlines
        .into_iter()
        .map(|corners| {
            corners
                .into_iter()
                .map(|v| renumbered[v as usize])
                .filter(|&v| v != u32::MAX)
                .collect()
        })
        .collect();
    (kept, faces)
}
