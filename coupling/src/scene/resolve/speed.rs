//! Fastest motion expected in a scene.

use riprap_dda::{Motion, PrescribedMotion, Shape, Vec3};

use super::solids::Solids;
use crate::scene::file::{InflowFile, SceneFile, vec3};
use crate::scene::fill::Lattice;
use crate::series::Series;

/// Samples of a prescribed motion: enough for the maximum of any record a laboratory would drive.
const SAMPLES: i32 = 1000;
/// Sine of the angle between a face and its velocity up to which the face slides along what it touches, as the sides of a gate
/// that is drawn not quite along itself.
const ALONG: f64 = 1e-3;

/// Fastest motion that the scene suggests: long waves, falls to the still-water level (or to the bottom of the domain),
/// initial velocities, and those with which prescribed blocks push what is before them; m/s.
pub(super) fn expected_speed(file: &SceneFile, solids: &Solids, lattice: Option<&Lattice>) -> f64 {
    if let Some(given) = file.numerics.expected_speed {
        return given;
    }
    let gravity = vec3(file.gravity).norm();
    let depth = lattice.map_or(0.0, |l| l.depth);
    let floor = lattice.map_or(file.domain.min.2, |l| l.still_water_level);
    // what is drawn out of the water along itself moves none of it, but may meet blocks above
    let reach = if solids.motions.contains(&Motion::Free) || lattice.is_none() {
        f64::INFINITY
    } else {
        floor
    };
    let mut fastest = (gravity * depth).sqrt();
    let bodies = solids.motions.iter().zip(&solids.named);
    for ((motion, (_, shape)), block) in bodies.zip(&file.blocks) {
        let speed = match motion {
            Motion::Fixed => 0.0,
            Motion::Prescribed(prescribed) => {
                pushing_speed(prescribed, shape, (reach, file.time.duration))
            }
            Motion::Free => {
                let drop = (shape.aabb().0.z - floor).max(0.0);
                (vec3(block.velocity).norm_squared() + 2.0 * gravity * drop).sqrt()
            }
        };
        fastest = fastest.max(speed);
    }
    for region in file.fluid.iter().flat_map(|fluid| &fluid.regions) {
        fastest = fastest.max(vec3(region.velocity).norm());
    }
    file.inflows
        .iter()
        .map(inflow_speed)
        .fold(fastest, f64::max)
}

/// Largest speed in an inflow; m/s.
fn inflow_speed(inflow: &InflowFile) -> f64 {
    let (axis, _) = inflow.towards.axis();
    let extent = vec3(inflow.max) - vec3(inflow.min);
    let across = extent[1 - axis.min(1)];
    let velocities = inflow.velocity.iter().map(|&(_, velocity)| velocity);
    let of_discharge = inflow.discharge.iter().map(|&(time, discharge)| {
        let depth = if inflow.depth.is_empty() {
            extent.z
        } else {
            Series::new(inflow.depth.clone()).at(time)
        };
        discharge / (across * depth).max(f64::MIN_POSITIVE)
    });
    velocities.chain(of_discharge).fold(0.0, f64::max)
}

/// Largest speed along its outward normal of any face that is below an elevation (m), until `duration` (s): the sides of a gate
/// that is drawn along itself push nothing, and its top edge only air; m/s.
fn pushing_speed(motion: &PrescribedMotion, shape: &Shape, (reach, duration): (f64, f64)) -> f64 {
    let faces = faces(shape);
    let centroid = shape.mass_properties().centroid;
    let largest_at = |t: f64| {
        let (velocity, spin, turn) = (motion.velocity(t), motion.spin(t), motion.turn(t));
        let center = centroid + motion.displacement(t);
        let Some(faces) = &faces else {
            let (min, max) = shape.aabb();
            return velocity.norm() + spin.norm() * 0.5 * (max - min).norm();
        };
        let mut largest = 0.0_f64;
        for (normal, corners) in faces {
            let normal = turn * normal;
            let arms = || corners.iter().map(|x| turn * (x - centroid));
            if arms().all(|arm| reach < center.z + arm.z) {
                continue;
            }
            for arm in arms() {
                let of_corner = velocity + spin.cross(&arm);
                let pushed = normal.dot(&of_corner);
                if ALONG * of_corner.norm() < pushed {
                    largest = largest.max(pushed);
                }
            }
        }
        largest
    };
    (0..=SAMPLES)
        .map(|i| largest_at(duration * f64::from(i) / f64::from(SAMPLES)))
        .fold(0.0, f64::max)
}

/// Outward normals of the faces with their corners (m); `None` for a shape that looks in all directions.
fn faces(shape: &Shape) -> Option<Vec<(Vec3, Vec<Vec3>)>> {
    let Shape::Polyhedra(parts) = shape else {
        return None;
    };
    let of_part = |part: &riprap_dda::Polyhedron| {
        let corners = |face| {
            part.face_vertices(face)
                .map(|vertex| part.vertices()[vertex as usize])
                .collect()
        };
        (0..part.n_faces())
            .map(|face| (part.face_normal(face), corners(face)))
            .collect::<Vec<_>>()
    };
    Some(parts.iter().flat_map(of_part).collect())
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test may stop where a library may not"
)]
mod tests {
    use super::*;
    use riprap_dda::Polyhedron;

    /// A gate of 0.02 x 1 x 1.2 m that stands 1 m deep in water, moved at a mean speed (m/s) for a second, from rest to rest: by
    /// a cubic, with 1.5 times the mean half way.
    fn of_gate(velocity: Vec3, reach: f64) -> f64 {
        let gate = Polyhedron::cuboid(Vec3::zeros(), Vec3::new(0.02, 1.0, 1.2)).unwrap();
        let motion = PrescribedMotion::Table {
            time: vec![0.0, 1.0],
            displacement: vec![Vec3::zeros(), velocity],
            turning: Vec::new(),
        };
        pushing_speed(&motion, &Shape::Polyhedra(vec![gate]), (reach, 1.0))
    }

    fn assert_close(speed: f64, expected: f64) {
        assert!((speed - expected).abs() < 1e-12, "{speed} {expected}");
    }

    #[test]
    fn a_gate_drawn_up_pushes_no_water() {
        assert_eq!(of_gate(Vec3::new(0.0, 0.0, 3.0), 1.0), 0.0);
        // blocks may stand on it
        assert_close(of_gate(Vec3::new(0.0, 0.0, 3.0), f64::INFINITY), 4.5);
    }

    #[test]
    fn a_piston_pushes_with_its_speed_and_a_plunger_until_it_is_out() {
        assert_close(of_gate(Vec3::new(-3.0, 0.0, 0.0), 1.0), 4.5);
        assert_close(of_gate(Vec3::new(0.0, 0.0, -3.0), 1.0), 4.5);
        // its faces look along the axes
        assert_close(of_gate(Vec3::new(1.8, 0.0, 1.2), 1.0), 2.7);
    }
}
