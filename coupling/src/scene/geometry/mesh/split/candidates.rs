//! Planes along which a shell may be cut.

use riprap_dda::{Plane, Polyhedron, Vec3};

use crate::scene::geometry::mesh::shells::Shell;

/// Planes through notches that are tried, the largest first.
const MOST_PLANES: usize = 48;
/// Difference of normals, and of places over the size, below which two planes are one.
const SAME_PLANE: f64 = 1e-6;
/// Places of further planes across the axes of a part, over its length along them.
const PLACES: [f64; 3] = [0.25, 0.5, 0.75];

/// Planes along which the parts of a shell may be cut.
pub(super) struct Candidates {
    /// Through the notches: along both of their sides, and between these.
    notches: Vec<Plane>,
    /// Normals of further planes: along the largest side, the largest one across it, and both.
    axes: Vec<Vec3>,
}

/// Two neighbors among the triangles of a shell, with the ends of their edge.
struct Hinge {
    ends: [Vec3; 2],
    normals: [Vec3; 2],
}

impl Candidates {
    /// Candidates of a shell; `size` is the cube root of the volume of its hull (m).
    pub(super) fn of(shell: &Shell, size: f64) -> Self {
        let mut planes = Planes {
            found: Vec::new(),
            same_offset: SAME_PLANE * size,
        };
        for Hinge { ends, normals } in hinges(shell) {
            let along = ends[1] - ends[0];
            // the normals of a notch turn towards each other
            let turn = normals[0].cross(&normals[1]).dot(&along);
            if turn < -SAME_PLANE * along.norm() {
                for normal in [normals[0] - normals[1], normals[0], normals[1]] {
                    planes.add(Plane::through(&ends[0], &normal), -turn);
                }
            }
        }
        Self {
            notches: planes.largest(MOST_PLANES),
            axes: axes(shell),
        }
    }

    /// Those that may go through a part.
    pub(super) fn through(&self, part: &Polyhedron) -> impl Iterator<Item = Plane> {
        let across = self.axes.iter().flat_map(|axis| {
            let at = |x: &Vec3| axis.dot(x);
            let along = part.vertices().iter().map(at);
            let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            });
            PLACES.map(|place| Plane {
                normal: *axis,
                offset: low + place * (high - low),
            })
        });
        self.notches.iter().copied().chain(across)
    }
}

/// Planes with weights.
struct Planes {
    found: Vec<(Plane, f64)>,
    /// m.
    same_offset: f64,
}

impl Planes {
    fn add(&mut self, plane: Plane, weight: f64) {
        let same_offset = self.same_offset;
        let is_same = |(other, _): &(Plane, f64)| {
            let side = plane.normal.dot(&other.normal).signum();
            (plane.normal - other.normal * side).norm() <= SAME_PLANE
                && (plane.offset - other.offset * side).abs() <= same_offset
        };
        match self.found.iter().position(is_same) {
            Some(known) => self.found[known].1 += weight,
            None => self.found.push((plane, weight)),
        }
    }

    fn largest(mut self, n: usize) -> Vec<Plane> {
        self.found.sort_by(|a, b| b.1.total_cmp(&a.1));
        self.found.truncate(n);
        self.found.into_iter().map(|(plane, _)| plane).collect()
    }
}

/// Unit normal of a triangle, or zero.
fn normal(shell: &Shell, corners: &[u32; 3]) -> Vec3 {
    let [a, b, c] = corners.map(|v| shell.points[v as usize]);
    let normal = (b - a).cross(&(c - a));
    normal.try_normalize(0.0).unwrap_or_default()
}

/// Edges with two triangles, in the order of the shell; the edge runs as in the first triangle.
fn hinges(shell: &Shell) -> Vec<Hinge> {
    let mut sides: Vec<([u32; 2], bool, usize)> = Vec::with_capacity(3 * shell.triangles.len());
    for (t, corners) in shell.triangles.iter().enumerate() {
        for k in 0..3 {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            sides.push(([from.min(to), from.max(to)], to < from, t));
        }
    }
    sides.sort_unstable();
    let pairs = sides.chunk_by(|a, b| a.0 == b.0);
    let hinge = |pair: &[([u32; 2], bool, usize)]| match pair {
        // the forward side sorts first
        [(ends, _, first), (_, _, second)] => Some(Hinge {
            ends: ends.map(|v| shell.points[v as usize]),
            normals: [first, second].map(|&t| normal(shell, &shell.triangles[t])),
        }),
        _ => None,
    };
    pairs.filter_map(hinge).collect()
}

/// The normal of the largest triangle, the part across it of that of the largest one across, and the third.
fn axes(shell: &Shell) -> Vec<Vec3> {
    let area = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|v| shell.points[v as usize]);
        (b - a).cross(&(c - a))
    };
    let largest = |weight: &dyn Fn(Vec3) -> Vec3| {
        let areas = shell.triangles.iter().map(|corners| weight(area(corners)));
        areas.fold(Vec3::zeros(), |best, this| {
            if best.norm_squared() < this.norm_squared() {
                this
            } else {
                best
            }
        })
    };
    let first = largest(&|area| area).try_normalize(0.0);
    let second =
        first.and_then(|first| largest(&|area| area - first * first.dot(&area)).try_normalize(0.0));
    match (first, second) {
        (Some(first), Some(second)) => vec![first, second, first.cross(&second)],
        _ => vec![Vec3::x(), Vec3::y(), Vec3::z()],
    }
}
