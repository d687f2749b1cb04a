//! Quality of block shapes: slivers and short edges reduce time step and stability.

use crate::{Polyhedron, Vec3, volume};

/// Shape of one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockQuality {
    /// Volume, > 0; m³.
    pub volume: f64,
    /// Largest distance of two corners over the smallest thickness across a face, > 1: 1.22 for a
    /// regular tetrahedron, 1.73 for a cube.
    pub aspect: f64,
    /// Shortest edge, > 0; m.
    pub shortest_edge: f64,
    /// Smallest angle inside the block between two faces that share an edge, 0 to π: small where it is a
    /// wedge, π/2 for a box; rad.
    pub smallest_dihedral: f64,
    /// Smallest angle of a face at one of its corners, 0 to π: small where it is a needle, π/2 for a box;
    /// rad.
    pub smallest_face_angle: f64,
}

impl BlockQuality {
    /// Of a convex block.
    pub fn of(body: &Polyhedron) -> Self {
        Self::of_union(std::slice::from_ref(body))
    }

    /// Quality of a block of convex parts, at least one. Lengths and thicknesses are those of the union: corners
    /// of all parts, along the normals of their faces. Edges and angles are those of the parts.
    pub fn of_union(parts: &[Polyhedron]) -> Self {
        let corners: Vec<&Vec3> = parts.iter().flat_map(Polyhedron::vertices).collect();
        let longest = corners
            .iter()
            .enumerate()
            .flat_map(|(k, a)| corners[k + 1..].iter().map(move |b| (*b - *a).norm()))
            .fold(0.0, f64::max);
        let thickness = normals(parts)
            .map(|normal| {
                let heights = corners.iter().map(|x| normal.dot(x));
                let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |span, h| {
                    (span.0.min(h), span.1.max(h))
                });
                high - low
            })
            .fold(f64::INFINITY, f64::min);
        let smallest =
            |of: fn(&Polyhedron) -> f64| parts.iter().map(of).fold(f64::INFINITY, f64::min);
        Self {
            volume: parts.iter().map(volume).sum(),
            aspect: longest / thickness,
            shortest_edge: smallest(shortest_edge),
            smallest_dihedral: smallest(smallest_dihedral),
            smallest_face_angle: smallest(smallest_face_angle),
        }
    }
}

fn normals(parts: &[Polyhedron]) -> impl Iterator<Item = Vec3> + '_ {
    parts
        .iter()
        .flat_map(|part| (0..part.n_faces()).map(|face| part.face_normal(face)))
}

/// From the start of a half-edge to its end.
fn along(body: &Polyhedron, half_edge: u32) -> Vec3 {
    let corner = |v: u32| body.vertices()[v as usize];
    corner(body.target(half_edge)) - corner(body.origin(half_edge))
}

fn shortest_edge(body: &Polyhedron) -> f64 {
    let lengths = body.edges().map(|e| along(body, e).norm());
    lengths.fold(f64::INFINITY, f64::min)
}

/// ```text
/// θ = π − ∠(n, m)        n, m: outward normals
/// ```
fn smallest_dihedral(body: &Polyhedron) -> f64 {
    let angles = body.edges().map(|e| {
        let n = body.face_normal(body.face_of(e));
        let m = body.face_normal(body.face_of(body.twin(e)));
        n.cross(&m).norm().atan2(-n.dot(&m))
    });
    angles.fold(f64::INFINITY, f64::min)
}

fn smallest_face_angle(body: &Polyhedron) -> f64 {
    let angles = (0..body.n_faces()).flat_map(|face| {
        body.face_loop(face).map(|e| {
            let (arriving, leaving) = (-along(body, e), along(body, body.next(e)));
            arriving
                .cross(&leaving)
                .norm()
                .atan2(arriving.dot(&leaving))
        })
    });
    angles.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_cube_a_tetrahedron_and_a_wedge() {
        let cube = Polyhedron::cuboid(Vec3::zeros(), Vec3::repeat(2.0)).unwrap();
        let quality = BlockQuality::of(&cube);
        assert!((quality.aspect - 3.0_f64.sqrt()).abs() < 1e-15);
        assert!((quality.smallest_dihedral - FRAC_PI_2).abs() < 1e-15);
        assert!((quality.smallest_face_angle - FRAC_PI_2).abs() < 1e-15);
        let corners = [
            [1.0, 1.0, 1.0],
            [1.0, -1.0, -1.0],
            [-1.0, 1.0, -1.0],
            [-1.0, -1.0, 1.0],
        ];
        let tetrahedron = Polyhedron::convex_hull(&corners.map(Vec3::from)).unwrap();
        let quality = BlockQuality::of(&tetrahedron);
        assert!((quality.aspect - 1.5_f64.sqrt()).abs() < 1e-15);
        assert!((quality.smallest_dihedral - (1.0_f64 / 3.0).acos()).abs() < 1e-15);
        assert!((quality.smallest_face_angle - FRAC_PI_2 / 1.5).abs() < 1e-15);
        let wedge = Polyhedron::extrusion(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.01]], 1, 0.0, 1.0);
        let quality = BlockQuality::of(&wedge.unwrap()[0]);
        assert!((quality.smallest_dihedral - 0.01_f64.atan()).abs() < 1e-15);
        assert!((quality.smallest_face_angle - 0.01_f64.atan()).abs() < 1e-15);
        assert!((quality.shortest_edge - 0.01).abs() < 1e-15);
    }

    /// Two thin slabs on each other are one thick one.
    #[test]
    fn a_union_is_as_thick_as_the_whole() {
        let slab = |z: f64| {
            Polyhedron::cuboid(Vec3::new(0.0, 0.0, z), Vec3::new(1.0, 1.0, z + 0.1)).unwrap()
        };
        let quality = BlockQuality::of_union(&[slab(0.0), slab(0.1)]);
        assert!((quality.aspect - 2.04_f64.sqrt() / 0.2).abs() < 1e-13);
        assert!((quality.volume - 0.2).abs() < 1e-15);
    }
}
