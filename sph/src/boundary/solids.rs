//! Solids and numbers for tests of walls.

use nalgebra::{Rotation3, Unit};

use crate::Vec3;
use crate::boundary::integral::Face;

/// Uniform numbers of −1 to 1 from a fixed seed.
pub(super) struct Noise(pub(super) u64);

impl Noise {
    pub(super) fn next(&mut self) -> f64 {
        // a linear congruence by Knuth; its high bits are random enough to place points
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(super) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }

    pub(super) fn rotation(&mut self) -> Rotation3<f64> {
        Rotation3::from_axis_angle(&Unit::new_normalize(self.vector()), 3.0 * self.next())
    }
}

/// A polyhedron that owns its corners.
pub(super) struct Solid(pub(super) Vec<(Vec3, Vec<Vec3>)>);

impl Solid {
    pub(super) fn cuboid(min: [f64; 3], max: [f64; 3]) -> Self {
        let corner = |k: usize| {
            Vec3::from_fn(|axis, _| {
                if k >> axis & 1 == 1 {
                    max[axis]
                } else {
                    min[axis]
                }
            })
        };
        let loops = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        Self::of_loops(loops.map(|l| l.map(corner).to_vec()).to_vec())
    }

    pub(super) fn tetrahedron(p: [Vec3; 4]) -> Self {
        let [a, b, c, d] = p;
        Self::of_loops(vec![
            vec![a, c, b],
            vec![a, b, d],
            vec![b, c, d],
            vec![c, a, d],
        ])
    }

    pub(super) fn of_loops(loops: Vec<Vec<Vec3>>) -> Self {
        let with_normal = |l: Vec<Vec3>| ((l[1] - l[0]).cross(&(l[2] - l[0])).normalize(), l);
        Self(loops.into_iter().map(with_normal).collect())
    }

    pub(super) fn moved(&self, rotation: &Rotation3<f64>, shift: &Vec3) -> Self {
        let point = |p: &Vec3| rotation * p + shift;
        Self(
            self.0
                .iter()
                .map(|(n, l)| (rotation * n, l.iter().map(point).collect()))
                .collect(),
        )
    }

    pub(super) fn faces(&self) -> Vec<Face<'_>> {
        self.0
            .iter()
            .map(|(normal, vertices)| Face {
                normal: *normal,
                vertices,
            })
            .collect()
    }

    /// Distances at which a ray from `x` enters and leaves, 0 and 0 when it misses.
    pub(super) fn crossing(&self, x: &Vec3, direction: &Vec3) -> (f64, f64) {
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for face in self.faces() {
            let (d, speed) = (face.distance(x), face.normal.dot(direction));
            if speed < 0.0 {
                enter = enter.max(-d / speed);
            } else {
                leave = leave.min(-d / speed);
            }
        }
        if enter < leave {
            (enter, leave)
        } else {
            (0.0, 0.0)
        }
    }

    /// The hull of points in general position, of triangles: every plane with all points below.
    pub(super) fn hull(points: &[Vec3]) -> Self {
        let mut loops = Vec::new();
        for a in points {
            for b in points {
                for c in points {
                    let normal = (b - a).cross(&(c - a));
                    let is_highest = points.iter().all(|p| normal.dot(&(p - a)) <= 1e-12);
                    // each triangle once: from its first corner in the order of x
                    if is_highest && 1e-9 < normal.norm() && a.x < b.x && a.x < c.x {
                        loops.push(vec![*a, *b, *c]);
                    }
                }
            }
        }
        Self::of_loops(loops)
    }

    /// The lowest depth below a face, negative outside.
    pub(super) fn depth(&self, x: &Vec3) -> f64 {
        let depth = |face: &Face| -face.distance(x);
        self.faces().iter().map(depth).fold(f64::INFINITY, f64::min)
    }
}
