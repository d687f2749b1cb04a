//! Fastest motion expected in a scene.

use riprap_dda::{Motion, PrescribedMotion};

use super::solids::Solids;
use crate::scene::file::{InflowFile, SceneFile, vec3};
use crate::scene::fill::Lattice;
use crate::series::Series;

/// Samples of a prescribed motion: enough for the maximum of any record a laboratory would drive.
const SAMPLES: i32 = 1000;

/// Fastest motion that the scene suggests: long waves, falls to the still-water level (or to the bottom of the domain),
/// prescribed and initial velocities; m/s.
pub(super) fn expected_speed(file: &SceneFile, solids: &Solids, lattice: Option<&Lattice>) -> f64 {
    if let Some(given) = file.numerics.expected_speed {
        return given;
    }
    let gravity = vec3(file.gravity).norm();
    let depth = lattice.map_or(0.0, |l| l.depth);
    let floor = lattice.map_or(file.domain.min.2, |l| l.still_water_level);
    let mut fastest = (gravity * depth).sqrt();
    let bodies = solids.motions.iter().zip(&solids.named);
    for ((motion, (_, shape)), block) in bodies.zip(&file.blocks) {
        let speed = match motion {
            Motion::Fixed => 0.0,
            Motion::Prescribed(prescribed) => {
                let (min, max) = shape.aabb();
                largest_speed(prescribed, 0.5 * (max - min).norm(), file.time.duration)
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

/// Largest speed of a body of some radius (m); m/s.
fn largest_speed(motion: &PrescribedMotion, radius: f64, duration: f64) -> f64 {
    let speed = |t: f64| motion.velocity(t).norm() + motion.spin(t).norm() * radius;
    (0..=SAMPLES)
        .map(|i| speed(duration * f64::from(i) / f64::from(SAMPLES)))
        .fold(0.0, f64::max)
}
