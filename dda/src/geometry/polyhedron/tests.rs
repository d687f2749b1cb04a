//! Facts about constructors and walks.
#![expect(clippy::unwrap_used, reason = "a test may fail")]

use super::{Polyhedron, PolyhedronError};
use crate::{Isometry, Vec3, volume};

fn unit_cube() -> Polyhedron {
    Polyhedron::cuboid(Vec3::zeros(), Vec3::repeat(1.0)).unwrap()
}

fn faces_of(body: &Polyhedron) -> Vec<Vec<u32>> {
    (0..body.n_faces())
        .map(|face| body.face_vertices(face).collect())
        .collect()
}

#[test]
fn walks_close() {
    let cube = unit_cube();
    assert_eq!(
        (cube.vertices().len(), cube.n_edges(), cube.n_faces()),
        (8, 12, 6)
    );
    assert_eq!(cube.edges().count(), 12);
    for e in 0..24 {
        assert_eq!(cube.twin(cube.twin(e)), e);
        assert_eq!(cube.target(e), cube.origin(cube.next(e)));
        assert_eq!(cube.origin(cube.twin(e)), cube.target(e));
    }
    for v in 0..8 {
        assert!(cube.edges_around_vertex(v).all(|e| cube.origin(e) == v));
        assert_eq!(cube.faces_around_vertex(v).count(), 3);
    }
    for face in 0..6 {
        assert_eq!(cube.faces_around_face(face).count(), 4);
        assert!(cube.face_loop(face).all(|e| cube.face_of(e) == face));
    }
}

#[test]
fn clockwise_faces_are_reversed_all_at_once() {
    let cube = unit_cube();
    let reversed: Vec<Vec<u32>> = faces_of(&cube)
        .into_iter()
        .map(|f| f.into_iter().rev().collect())
        .collect();
    let again = Polyhedron::from_faces(cube.vertices(), &reversed).unwrap();
    assert!((volume(&again) - 1.0).abs() < 1e-15);
}

fn refuse(vertices: &[Vec3], faces: &[Vec<u32>]) -> PolyhedronError {
    Polyhedron::from_faces(vertices, faces).unwrap_err()
}

#[test]
fn errors_name_what_is_wrong_with_the_faces() {
    let cube = unit_cube();
    let (vertices, faces) = (cube.vertices().to_vec(), faces_of(&cube));

    let open = refuse(&vertices, &faces[..5]);
    assert!(matches!(open, PolyhedronError::OpenEdge { .. }), "{open}");

    let mut one_reversed = faces.clone();
    one_reversed[2].reverse();
    let twice = refuse(&vertices, &one_reversed);
    assert!(
        matches!(twice, PolyhedronError::EdgeUsedTwice { .. }),
        "{twice}"
    );

    let mut missing = faces.clone();
    missing[0][0] = 8;
    assert_eq!(
        refuse(&vertices, &missing).to_string(),
        "face 0 names vertex 8, but there are only 8 (0 to 7)"
    );

    // Two cubes as one list of faces: two shells.
    let mut two = vertices.clone();
    two.extend(vertices.iter().map(|x| x + Vec3::new(3.0, 0.0, 0.0)));
    let mut both = faces.clone();
    both.extend(
        faces
            .iter()
            .map(|f| f.iter().map(|v| v + 8).collect::<Vec<u32>>()),
    );
    let shells = refuse(&two, &both);
    assert!(
        matches!(
            shells,
            PolyhedronError::EulerCharacteristic {
                characteristic: 4,
                ..
            }
        ),
        "{shells}"
    );
}

#[test]
fn errors_name_what_is_wrong_with_the_vertices() {
    let cube = unit_cube();
    let (vertices, faces) = (cube.vertices().to_vec(), faces_of(&cube));

    let mut bent = vertices.clone();
    bent[7] += Vec3::new(0.1, 0.0, 0.0);
    let bent = refuse(&bent, &faces);
    assert!(matches!(bent, PolyhedronError::NotPlanar { .. }), "{bent}");
    assert!(bent.to_string().contains("leaves its plane by"), "{bent}");

    let mut nan = vertices.clone();
    nan[3].y = f64::NAN;
    assert_eq!(
        refuse(&nan, &faces),
        PolyhedronError::NotFinite { vertex: 3 }
    );

    let flat: Vec<Vec3> = vertices.iter().map(|x| Vec3::new(x.x, x.y, 0.0)).collect();
    assert!(matches!(
        refuse(&flat, &faces),
        PolyhedronError::NoVolume { .. }
    ));

    // A corner pushed in: closed and planar (triangles), but not convex.
    let apex = Vec3::new(0.3, 0.3, 0.1);
    let tetra = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z(), apex];
    let dented = [
        vec![0, 2, 1],
        vec![0, 1, 3],
        vec![0, 3, 2],
        vec![1, 2, 4],
        vec![2, 3, 4],
        vec![3, 1, 4],
    ];
    let dented = refuse(&tetra, &dented);
    assert!(
        matches!(dented, PolyhedronError::NotConvex { .. }),
        "{dented}"
    );
}

#[test]
fn hull_of_a_lattice_is_a_box_with_six_faces() {
    let mut points = Vec::new();
    for i in 0..27 {
        points.push(Vec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64) * 0.5);
    }
    let turn = Isometry::new(Vec3::new(1e3, 2.0, -3.0), Vec3::new(0.3, -0.2, 0.9));
    for placement in [Isometry::identity(), turn] {
        let placed: Vec<Vec3> = points
            .iter()
            .map(|x| placement.transform_point(&(*x).into()).coords)
            .collect();
        let hull = Polyhedron::convex_hull(&placed).unwrap();
        assert_eq!((hull.vertices().len(), hull.n_faces()), (8, 6));
        assert!((volume(&hull) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn hull_refuses_flat_and_few_points() {
    let flat: Vec<Vec3> = (0..9)
        .map(|i| Vec3::new((i % 3) as f64, (i / 3) as f64, 1.0))
        .collect();
    assert!(Polyhedron::convex_hull(&flat).is_err());
    assert!(Polyhedron::convex_hull(&flat[..3]).is_err());
    let line: Vec<Vec3> = (0..9).map(|i| Vec3::repeat(i as f64)).collect();
    assert!(Polyhedron::convex_hull(&line).is_err());
    // Two sheets 1e-7 apart: either a thin body of the right volume, or an error; never a wrong one.
    let mut sliver = flat.clone();
    sliver.extend(flat.iter().map(|x| x + Vec3::z() * 1e-7));
    if let Ok(hull) = Polyhedron::convex_hull(&sliver) {
        assert!((volume(&hull) / 4e-7 - 1.0).abs() < 1e-6);
    }
}

#[test]
fn extrusions_fill_their_polygon() {
    // polygon, area, least number of convex parts
    let shapes: [(&[[f64; 2]], f64, usize); 4] = [
        (&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]], 2.0, 1),
        (
            &[
                [0.0, 0.0],
                [2.0, 0.0],
                [2.0, 1.0],
                [1.0, 1.0],
                [1.0, 2.0],
                [0.0, 2.0],
            ],
            3.0,
            2,
        ),
        (
            // a slope on a bed, with a corner on a straight line
            &[
                [0.0, -0.1],
                [3.0, -0.1],
                [6.0, -0.1],
                [6.0, 0.0],
                [2.0, 0.0],
                [0.0, 1.0],
            ],
            0.6 + 1.0,
            2,
        ),
        (
            // a star of four rays
            &[
                [3.0, 0.0],
                [0.5, 0.5],
                [0.0, 3.0],
                [-0.5, 0.5],
                [-3.0, 0.0],
                [-0.5, -0.5],
                [0.0, -3.0],
                [0.5, -0.5],
            ],
            6.0,
            3,
        ),
    ];
    for (polygon, area, least) in shapes {
        for axis in 0..3 {
            for is_reversed in [false, true] {
                let mut polygon = polygon.to_vec();
                if is_reversed {
                    polygon.reverse();
                }
                let parts = Polyhedron::extrusion(&polygon, axis, 0.5, -1.5).unwrap();
                let filled: f64 = parts.iter().map(volume).sum();
                assert!(
                    (filled / (2.0 * area) - 1.0).abs() < 1e-12,
                    "axis {axis}: {filled} of {}",
                    2.0 * area
                );
                assert!(
                    parts.len() >= least && parts.len() <= 2 * least,
                    "{} parts",
                    parts.len()
                );
                for part in &parts {
                    let (lower, upper) = part.aabb();
                    assert_eq!((lower[axis], upper[axis]), (-1.5, 0.5));
                }
            }
        }
    }
}

#[test]
fn extrusion_refuses_bad_polygons() {
    let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    assert_eq!(
        Polyhedron::extrusion(&bow, 1, 0.0, 1.0).unwrap_err(),
        PolyhedronError::SelfIntersection {
            first: 0,
            second: 2
        }
    );
    let line = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]];
    assert!(matches!(
        Polyhedron::extrusion(&line, 1, 0.0, 1.0),
        Err(PolyhedronError::Polygon { .. })
    ));
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    assert!(Polyhedron::extrusion(&square, 3, 0.0, 1.0).is_err());
    assert!(Polyhedron::extrusion(&square, 1, 1.0, 1.0).is_err());
}
