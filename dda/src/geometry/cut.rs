//! Cutting convex polyhedra by planes.

use crate::{Polyhedron, PolyhedronError, Vec3};

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

/// Corners nearer to the plane than this lie on it; × L, the cube root of the volume. The distance below
/// which [`Polyhedron::from_faces`] takes two vertices for one: a corner farther off is at least that far
/// from every corner that the cut makes on its edges.
const ON_PLANE: f64 = 1e-9;
/// And nearer than rounding explains: the height of a point above a plane is a sum of four terms, each
/// rounded, over a corner that is itself rounded; × largest coordinate.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

impl Polyhedron {
    /// The parts below and above a plane, or `None` if the plane misses the body or only touches it: all
    /// corners on one side, within 1e-9 L, L the cube root of the volume, and the rounding of
    /// coordinates.
    ///
    /// Both parts have the corners of the cut in common, bit for bit, and cut its face into the same
    /// triangles, so that their volumes add up.
    ///
    /// # Errors
    ///
    /// Those of [`Polyhedron::from_faces`]: one part would be too thin to be a polyhedron, or two corners
    /// of the cut would fall together.
    pub fn cut(&self, plane: &Plane) -> Result<Option<(Self, Self)>, PolyhedronError> {
        let tolerance = self.same_place();
        let heights = || self.vertices().iter().map(|x| plane.height(x));
        if heights().all(|h| h >= -tolerance) || heights().all(|h| h <= tolerance) {
            return Ok(None);
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
        // Turned about its first corner: corners on the plane lie up to the tolerance off it, and volumes
        // add up only if both parts see the same fan of triangles.
        if let Some(rest) = rim.get_mut(1..) {
            rest.reverse();
        }
        let above = self.part(&vertices, &height, &crossing, &rim, -1.0)?;
        Ok(Some((below, above)))
    }

    /// Points nearer to a plane than this lie on it, as far as cuts of this body are concerned; m.
    pub(crate) fn same_place(&self) -> f64 {
        let farthest = self.vertices().iter().map(|x| x.amax()).fold(0.0, f64::max);
        (ON_PLANE * self.size()).max(ROUNDING * farthest)
    }

    /// The part where `height · side ≤ 0`, closed by the rim.
    fn part(
        &self,
        vertices: &[Vec3],
        height: &[f64],
        crossing: &[u32],
        rim: &[u32],
        side: f64,
    ) -> Result<Self, PolyhedronError> {
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
            // A face that only touches the plane does not belong to this part.
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
        Self::from_faces(&used, &faces)
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
            .unwrap()
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
            .unwrap()
            .unwrap();
        assert_eq!((below.n_faces(), above.n_faces()), (5, 5));
        assert!((crate::volume(&below) - 0.5).abs() < 1e-15);
        // Touching or missing leaves it whole.
        for z in [0.0, 1.0, 1.5, 1e-13, 9e-10] {
            let plane = Plane::through(&Vec3::new(0.0, 0.0, z), &Vec3::z());
            assert!(cube.cut(&plane).unwrap().is_none(), "z {z}");
        }
    }

    /// A corner within the tolerance stays where it is, though the face of the cut is bent there.
    #[test]
    fn volumes_add_up_where_the_plane_passes_near_a_corner() {
        let cube = Polyhedron::cuboid(Vec3::zeros(), Vec3::repeat(1.0)).unwrap();
        let plane = Plane {
            offset: 8e-10,
            ..Plane::through(&Vec3::zeros(), &Vec3::new(1.0, -1.0, 0.5))
        };
        let (below, above) = cube.cut(&plane).unwrap().unwrap();
        assert!(below.vertices().contains(&Vec3::zeros()));
        // Measured 0; 1e-10 if each part had triangles of its own.
        assert!((crate::volume(&below) + crate::volume(&above) - 1.0).abs() < 1e-15);
    }

    /// The edge of a knife, thinner than rounding can tell from nothing: refused, not passed over.
    #[test]
    fn a_cut_that_cannot_be_made_is_an_error() {
        let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.01]];
        let knife = Polyhedron::extrusion(&outline, 1, 0.0, 1.0).unwrap();
        let plane = Plane::through(&Vec3::new(5e-9, 0.0, 0.0), &Vec3::x());
        let refused = knife[0].cut(&plane);
        assert!(
            matches!(refused, Err(PolyhedronError::NoVolume { .. })),
            "{refused:?}"
        );
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
            let plane = Plane::through(&through.into(), &normal);
            let Ok(Some((below, above))) = hull.cut(&plane) else {
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
