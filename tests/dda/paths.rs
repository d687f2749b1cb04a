//! Blocks that slide along a path: exact answers.

use crate::setup::*;
use riprap_dda::{Motion, Path, PathError, PrescribedMotion, Sliding, Vec3};

/// A way that starts and stops; s, m.
fn there(from: f64, to: f64) -> Vec<[f64; 2]> {
    vec![
        [0.0, from],
        [0.4, from + 0.2 * (to - from)],
        [1.1, from + 0.7 * (to - from)],
        [1.5, to],
    ]
}

/// On a straight ramp the motion is that of the table of its displacements, with and without a base.
#[test]
fn on_a_straight_ramp_a_block_moves_without_turning() {
    let (start, down) = (Vec3::new(-1.0, 0.2, 0.5), Vec3::new(4.0, 0.0, -3.0) / 5.0);
    let points = [start, start + down * 0.7, start + down * 2.0];
    let rows = there(0.3, 1.7);
    let table = PrescribedMotion::Table {
        time: rows.iter().map(|row| row[0]).collect(),
        displacement: rows.iter().map(|row| down * (row[1] - 0.3)).collect(),
        turning: Vec::new(),
    };
    for base in [0.0, 0.5] {
        let path = Path::through(&points, f64::INFINITY).unwrap();
        assert!((path.length() - 2.0).abs() < 1e-14);
        let sliding = PrescribedMotion::Sliding(Sliding::new(path, base, &rows, Vec3::zeros()));
        for k in 0..=160 {
            let t = 0.01 * f64::from(k);
            // round-off of places of the size of a meter
            let off = sliding.displacement(t) - table.displacement(t);
            assert!(off.norm() < 1e-14, "{t}: {off:?}");
            let off = sliding.velocity(t) - table.velocity(t);
            assert!(off.norm() < 1e-14, "{t}: {off:?}");
            assert!(sliding.turn(t).angle() < 1e-14 && sliding.spin(t).norm() < 1e-14);
        }
    }
}

/// Between the middles of equal chords the path is a circle: each corner of a block moves with `ω × r` about its center, and the
/// block in the solver is turned about it.
#[test]
fn on_an_arc_every_corner_moves_about_its_center() {
    let (center, radius, step) = (Vec3::new(0.3, 0.0, 2.0), 1.5, 6.0_f64.to_radians());
    let points: Vec<Vec3> = (-10..=10)
        .map(|k| step * f64::from(k))
        .map(|angle| center + Vec3::new(angle.sin(), 0.0, -angle.cos()) * radius)
        .collect();
    let inner = radius * (0.5 * step).cos();
    let corners = [[0.0, 0.0], [0.4, 0.0], [0.3, 0.2], [0.1, 0.2]];
    for base in [0.0, 0.4] {
        let path = Path::through(&points, f64::INFINITY).unwrap();
        let length = path.length();
        let rows = there(0.3 * length, 0.65 * length);
        let shift = Vec3::new(-0.6, 0.0, 0.7);
        let centroid = shift + Vec3::new(0.2, 0.0, 0.1);
        let motion = PrescribedMotion::Sliding(Sliding::new(path, base, &rows, centroid));
        for k in 1..150 {
            let t = 0.01 * f64::from(k);
            let (spin, turn) = (motion.spin(t), motion.turn(t));
            let middle = centroid + motion.displacement(t);
            assert!(0.0 < spin.norm());
            for [x, z] in corners {
                let arm = turn * (shift + Vec3::new(x, 0.0, z) - centroid);
                let moves = motion.velocity(t) + spin.cross(&arm);
                let about = spin.cross(&(middle + arm - center));
                // round-off of lengths of a meter at a meter a second
                assert!((moves - about).norm() < 1e-12, "{t}: {moves:?} {about:?}");
            }
        }
        // the way of a point goes round the inscribed circle; the last pieces are straight for half a chord
        let turned = motion.turn(1.5).angle();
        assert!((turned - 0.35 * length / inner).abs() < 1e-12, "{turned}");

        let body = block(
            cuboid([-0.6, -0.1, 0.7], [-0.2, 0.1, 0.9]),
            Motion::Prescribed(motion),
        );
        let mut blocks = blocks(vec![body], rock(), down());
        let start = blocks.centroid(0) - center;
        run_steps(&mut blocks, 1.5, 300);
        let turn = blocks.orientation(0);
        let off = blocks.centroid(0) - center - turn * start;
        // 300 turns of a quaternion
        assert!(off.norm() < 1e-12, "{off:?}");
        assert!((turn.angle() - turned).abs() < 1e-12, "{}", turn.angle());
    }
}

/// From a ramp through a bend to a floor both ends of a base stay on the path, and velocity and spin are the rates of place and turn.
#[test]
fn a_base_keeps_both_ends_on_the_path() {
    let points = [[-2.0, 0.0, 0.8], [0.0, 0.0, 0.0], [2.0, 0.0, 0.0]].map(Vec3::from);
    let path = Path::through(&points, 1.0).unwrap();
    let ramp = (points[1] - points[0]).norm();
    // an arc of a meter about (c, 1), which touches the floor at c
    let turn = 0.4_f64.atan();
    let c = (0.5 * turn).tan();
    assert!((path.length() - (ramp + 2.0 - 2.0 * c + turn)).abs() < 1e-14);
    assert!((path.cuts()[0].distance - (1.0 / (0.5 * turn).cos() - 1.0)).abs() < 1e-14);
    let base = 0.5;
    let rows = there(0.4, 3.4);
    let along = (points[1] - points[0]) / ramp;
    let (rear, front) = (points[0] + along * 0.15, points[0] + along * 0.65);
    let centroid = Vec3::new(-1.5, 0.0, 0.9);
    let motion = PrescribedMotion::Sliding(Sliding::new(path, base, &rows, centroid));
    // height above the bed of a point on the path
    let above = |x: &Vec3| {
        let arm = x - Vec3::new(c, 0.0, 1.0);
        if c <= x.x {
            x.z
        } else if arm.dot(&along) < 0.0 {
            Vec3::new(-along.z, 0.0, along.x).dot(x)
        } else {
            1.0 - arm.norm()
        }
    };
    for k in 0..=150 {
        let t = 0.01 * f64::from(k);
        let place = centroid + motion.displacement(t);
        for end in [rear, front] {
            let end = place + motion.turn(t) * (end - centroid);
            // Newton's method ends at round-off
            assert!(above(&end).abs() < 1e-13, "{t}: {end:?} {}", above(&end));
        }
        let h = 1e-6;
        let rate = (motion.displacement(t + h) - motion.displacement(t - h)) / (2.0 * h);
        // central difference: first order in h where the acceleration jumps
        assert!((rate - motion.velocity(t)).norm() < 1e-4, "{t}");
        let turned = (motion.turn(t + h) * motion.turn(t - h).inverse()).scaled_axis();
        assert!((turned / (2.0 * h) - motion.spin(t)).norm() < 1e-4, "{t}");
    }
}

#[test]
fn wrong_points_are_named() {
    let fault = |points: &[[f64; 3]]| {
        let points: Vec<Vec3> = points.iter().copied().map(Vec3::from).collect();
        Path::through(&points, 1.0).unwrap_err()
    };
    assert_eq!(fault(&[[0.0; 3]]), PathError::TooFewPoints);
    let [a, b, c] = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 1.0]];
    assert_eq!(fault(&[a, a, b]), PathError::Repeated(1));
    assert_eq!(fault(&[a, b, b]), PathError::Repeated(2));
    assert_eq!(fault(&[a, b, c, [3.0, 1.0, 1.0]]), PathError::NotPlane(3));
    assert_eq!(fault(&[a, b, a]), PathError::TurnsBack(1));
}
