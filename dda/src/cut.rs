//! Cutting convex polyhedra by planes.

use crate::{Polyhedron, Vec3};

/// A plane: points with `normal · x = offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit normal.
    pub normal: Vec3,
    /// m.
    pub offset: f64,
}

impl Plane {
    /// The plane through a point with a normal of any length but zero.
    pub fn through(point: &Vec3, normal: &Vec3) -> Self {
        let normal = normal.normalize();
        Self {
            normal,
            offset: normal.dot(point),
        }
    }

    /// Height of a point above the plane; m.
    pub fn height(&self, x: &Vec3) -> f64 {
        self.normal.dot(x) - self.offset
    }
}

/// Corners nearer to the plane than this lie on it; × L, the cube root of the volume.
const ON_PLANE: f64 = 1e-10;

impl Polyhedron {
    /// The parts below and above a plane, or `None` if the plane leaves the body whole: because it
    /// misses it, only touches it, or would cut off a piece too thin to be a polyhedron.
    ///
    /// Both parts have the corners of the cut in common, bit for bit, so that their volumes add up.
    pub fn cut(&self, plane: &Plane) -> Option<(Self, Self)> {
        let tolerance = ON_PLANE * self.size();
        let heights = || self.vertices().iter().map(|x| plane.height(x));
        if heights().all(|h| h >= -tolerance) || heights().all(|h| h <= tolerance) {
            return None;
        }
        let height: Vec<f64> = self
            .vertices()
            .iter()
            .map(|x| {
                let height = plane.height(x);
                if height.abs() <= tolerance {
                    0.0
                } else {
                    height
                }
            })
            .collect();
        // Corners of both parts, those of the cut behind the old ones: one per edge that crosses.
        let mut vertices = self.vertices().to_vec();
        let mut crossing = vec![u32::MAX; 2 * self.n_edges()];
        for e in self.edges() {
            let (from, to) = (self.origin(e) as usize, self.target(e) as usize);
            if height[from] * height[to] < 0.0 {
                let share = height[from] / (height[from] - height[to]);
                let x = vertices[from] + (vertices[to] - vertices[from]) * share;
                crossing[e as usize] = vertices.len() as u32;
                crossing[self.twin(e) as usize] = vertices.len() as u32;
                vertices.push(x);
            }
        }
        let mut rim: Vec<u32> = (0..vertices.len() as u32)
            .filter(|&v| height.get(v as usize).is_none_or(|&h| h == 0.0))
            .collect();
        sort_around(&mut rim, &vertices, &plane.normal);
        let below = self.part(&vertices, &height, &crossing, &rim, 1.0)?;
        rim.reverse();
        let above = self.part(&vertices, &height, &crossing, &rim, -1.0)?;
        Some((below, above))
    }

    /// The part where `height · side ≤ 0`, closed by the rim.
    fn part(
        &self,
        vertices: &[Vec3],
        height: &[f64],
        crossing: &[u32],
        rim: &[u32],
        side: f64,
    ) -> Option<Self> {
        let mut faces: Vec<Vec<u32>> = Vec::with_capacity(self.n_faces() + 1);
        for face in 0..self.n_faces() {
            let mut corners = Vec::new();
            let mut is_inside = false;
            for e in self.face_loop(face) {
                let v = self.origin(e);
                let h = height[v as usize] * side;
                if h <= 0.0 {
                    corners.push(v);
                    is_inside |= h < 0.0;
                }
                if crossing[e as usize] != u32::MAX {
                    corners.push(crossing[e as usize]);
                }
            }
            // A face that only touches the plane is none of this part's.
            if is_inside {
                faces.push(corners);
            }
        }
        faces.push(rim.to_vec());
        let mut number = vec![u32::MAX; vertices.len()];
        let mut used = Vec::new();
        for corner in faces.iter_mut().flatten() {
            let slot = &mut number[*corner as usize];
            if *slot == u32::MAX {
                *slot = used.len() as u32;
                used.push(vertices[*corner as usize]);
            }
            *corner = *slot;
        }
        Self::from_faces(&used, &faces).ok()
    }
}

/// Sorts the corners of a convex polygon counter-clockwise, seen against the normal.
fn sort_around(rim: &mut [u32], vertices: &[Vec3], normal: &Vec3) {
    let middle = rim.iter().map(|&v| vertices[v as usize]).sum::<Vec3>() / rim.len() as f64;
    let Some(&first) = rim.first() else { return };
    let u = vertices[first as usize] - middle;
    let v = normal.cross(&u);
    let angle = |corner: &u32| {
        let r = vertices[*corner as usize] - middle;
        v.dot(&r).atan2(u.dot(&r))
    };
    rim.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use crate::mass_properties;
    use proptest::prelude::*;

    #[test]
    fn a_cube_in_halves() {
        let cube = Polyhedron::cuboid(Vec3::zeros(), Vec3::repeat(1.0)).unwrap();
        let (below, above) = cube
            .cut(&Plane::through(&Vec3::new(0.0, 0.0, 0.25), &Vec3::z()))
            .unwrap();
        assert!((crate::volume(&below) - 0.25).abs() < 1e-15);
        assert!((crate::volume(&above) - 0.75).abs() < 1e-15);
        assert_eq!(
            (below.n_faces(), below.vertices().len(), below.n_edges()),
            (6, 8, 12)
        );
        // Along a diagonal, through four corners.
        let (below, above) = cube
            .cut(&Plane::through(&Vec3::zeros(), &Vec3::new(1.0, -1.0, 0.0)))
            .unwrap();
        assert_eq!((below.n_faces(), above.n_faces()), (5, 5));
        assert!((crate::volume(&below) - 0.5).abs() < 1e-15);
        // Touching or missing leaves it whole.
        for z in [0.0, 1.0, 1.5, 1e-13] {
            let plane = Plane::through(&Vec3::new(0.0, 0.0, z), &Vec3::z());
            assert!(cube.cut(&plane).is_none(), "z {z}");
        }
    }

    proptest! {
        /// Volumes and second moments of the parts add up, Euler's formula holds (else no polyhedron is made).
        #[test]
        fn parts_add_up(
            points in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 6..20),
            through in prop::array::uniform3(-0.5..0.5_f64),
            normal in prop::array::uniform3(-1.0..1.0_f64),
        ) {
            let points: Vec<Vec3> = points.into_iter().map(Vec3::from).collect();
            let normal = Vec3::from(normal);
            prop_assume!(normal.norm() > 0.1);
            let Ok(hull) = Polyhedron::convex_hull(&points) else { return Ok(()) };
            let Some((below, above)) = hull.cut(&Plane::through(&through.into(), &normal)) else {
                return Ok(());
            };
            let [whole, first, second] = [&hull, &below, &above].map(mass_properties);
            let error = (first.volume + second.volume) / whole.volume - 1.0;
            prop_assert!(error.abs() < 1e-12, "{error:e}");
            let both = crate::MassProperties::of_union(&[first, second]);
            prop_assert!((both.second_moment - whole.second_moment).norm() < 1e-11);
        }
    }
}
