//! Shapes, placements and motions as the scene writes them.

use std::path::Path;

use riprap::scene::access::Access;
use riprap::scene::file::{Axis, BlockFile, MotionFile, PlacementFile, RotationFile, ShapeFile};
use riprap::scene::motion::motion;
use riprap::scene::shape::solid;
use riprap_dda::{Motion, PrescribedMotion, Vec3};

fn block(shape: ShapeFile, placement: PlacementFile) -> BlockFile {
    BlockFile {
        name: "stone".into(),
        material: "rock".into(),
        shape,
        placement,
        motion: MotionFile::Free,
        velocity: (0.0, 0.0, 0.0),
        angular_velocity: (0.0, 0.0, 0.0),
        deformable: None,
        hold: None,
        sealed: false,
        group: None,
        joint_faces: Vec::new(),
    }
}

fn unit_box() -> ShapeFile {
    ShapeFile::Box {
        min: (0.0, 0.0, 0.0),
        max: (1.0, 1.0, 1.0),
    }
}

#[test]
fn volumes_of_all_shapes() {
    let cube: Vec<(f64, f64, f64)> = (0..8)
        .map(|k| (f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)))
        .collect();
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let mut points = cube.clone();
    points.push((0.5, 0.5, 0.5));
    let cases = [
        (unit_box(), 1.0),
        (
            ShapeFile::Wedge {
                length: 2.0,
                height: 0.5,
                width: 3.0,
            },
            1.5,
        ),
        (ShapeFile::Hull { points }, 1.0),
        (
            ShapeFile::Polyhedron {
                vertices: cube,
                faces: faces.map(|f| f.to_vec()).to_vec(),
            },
            1.0,
        ),
        (
            // an L, clockwise
            ShapeFile::Extrusion {
                polygon: vec![
                    (0.0, 0.0),
                    (0.0, 2.0),
                    (1.0, 2.0),
                    (1.0, 1.0),
                    (2.0, 1.0),
                    (2.0, 0.0),
                ],
                axis: Axis::Y,
                from: -1.0,
                to: 1.0,
            },
            6.0,
        ),
        (
            ShapeFile::Sphere {
                center: (1.0, 2.0, 3.0),
                radius: 0.5,
            },
            std::f64::consts::PI / 6.0,
        ),
    ];
    for (shape, expected) in cases {
        let placement = PlacementFile {
            rotate: Some(RotationFile {
                axis: (1.0, 2.0, 3.0),
                angle_deg: 37.0,
                about: (1.0, 0.0, 0.0),
            }),
            translate: (10.0, -20.0, 5.0),
        };
        let found = solid(
            &block(shape.clone(), placement),
            0,
            &Access::of(Path::new(".")),
        )
        .unwrap();
        assert!(
            (found.volume() / expected - 1.0).abs() < 1e-12,
            "{shape:?}: {}",
            found.volume()
        );
    }
}

/// A quarter turn about z through (1, 0) takes the unit box to [1, 0]..[2, 1] turned: x from 0 to 1
/// becomes y from -1 to 0, y from 0 to 1 becomes x from 1 down to 0; then the shift.
#[test]
fn a_placement_turns_first_and_then_shifts() {
    let placement = PlacementFile {
        rotate: Some(RotationFile {
            axis: (0.0, 0.0, 7.0),
            angle_deg: 90.0,
            about: (1.0, 0.0, 0.0),
        }),
        translate: (10.0, 20.0, 30.0),
    };
    let (min, max) = solid(
        &block(unit_box(), placement),
        0,
        &Access::of(Path::new(".")),
    )
    .unwrap()
    .aabb();
    assert!((min - Vec3::new(10.0, 19.0, 30.0)).norm() < 1e-14);
    assert!((max - Vec3::new(11.0, 20.0, 31.0)).norm() < 1e-14);
}

#[test]
fn problems_name_the_field_and_the_block() {
    let still = PlacementFile::default;
    let no_axis = PlacementFile {
        rotate: Some(RotationFile {
            axis: (0.0, 0.0, 0.0),
            angle_deg: 90.0,
            about: (0.0, 0.0, 0.0),
        }),
        translate: (0.0, 0.0, 0.0),
    };
    let flat = vec![
        (0.0, 0.0, 0.0),
        (1.0, 0.0, 0.0),
        (0.0, 1.0, 0.0),
        (1.0, 1.0, 0.0),
    ];
    let cases = [
        (
            unit_box(),
            no_axis,
            "blocks[2].placement.rotate.axis",
            "the axis has no direction",
        ),
        (
            ShapeFile::Hull { points: flat },
            still(),
            "blocks[2].shape.points",
            "",
        ),
        (
            ShapeFile::Sphere {
                center: (0.0, 0.0, 0.0),
                radius: -1.0,
            },
            still(),
            "blocks[2].shape.radius",
            "radius must be finite and > 0, got -1",
        ),
        (
            ShapeFile::Polyhedron {
                vertices: vec![(0.0, 0.0, 0.0); 4],
                faces: vec![vec![0, 1, 9]; 4],
            },
            still(),
            "blocks[2].shape.faces",
            "names vertex 9",
        ),
        (
            ShapeFile::Mesh {
                file: "../cube.stl".into(),
                scale: 1.0,
                split: Default::default(),
            },
            still(),
            "blocks[2].shape.file",
            "`../cube.stl`: leads out of the scene's folder",
        ),
        (
            ShapeFile::Extrusion {
                polygon: vec![(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)],
                axis: Axis::Z,
                from: 0.0,
                to: 1.0,
            },
            still(),
            "blocks[2].shape.polygon",
            "cross",
        ),
    ];
    for (shape, placement, path, message) in cases {
        let found = solid(&block(shape, placement), 2, &Access::of(Path::new("."))).unwrap_err();
        assert_eq!(found[0].path, path);
        assert!(found[0].message.starts_with("block `stone`: "), "{found:?}");
        assert!(found[0].message.contains(message), "{found:?}");
    }
}

#[test]
fn motions_are_unit_vectors_radians_and_records() {
    let folder = tempfile::tempdir().unwrap();
    let sway = MotionFile::Sinusoid {
        direction: (3.0, 0.0, 4.0),
        amplitude: 0.1,
        period: 2.0,
        phase_deg: 90.0,
        ramp: 1.0,
    };
    let Motion::Prescribed(PrescribedMotion::Sinusoid {
        direction, phase, ..
    }) = motion(&sway, "blocks[0].motion", &Access::of(folder.path())).unwrap()
    else {
        unreachable!()
    };
    assert!((direction - Vec3::new(0.6, 0.0, 0.8)).norm() < 1e-15);
    assert!((phase - std::f64::consts::FRAC_PI_2).abs() < 1e-15);

    std::fs::write(
        folder.path().join("paddle.csv"),
        "t,x,y,z\n0,0,0,0\n1,0.5,0,0\n1,0,0,0\n",
    )
    .unwrap();
    let table = MotionFile::Table {
        file: "paddle.csv".into(),
    };
    let found = motion(&table, "blocks[0].motion", &Access::of(folder.path())).unwrap_err();
    assert_eq!(found.path, "blocks[0].motion.file");
    assert_eq!(
        found.message,
        "`paddle.csv` line 4: time must increase, found 1 s"
    );
}
