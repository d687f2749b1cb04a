//! Initial flow of the water.

use riprap_dda::Vec3;

use super::file::vec3;
use super::file::{FlowFile, RegionShapeFile, SceneFile};
use super::fill::Lattice;

/// The lattice with the flow of each region added to its velocity.
pub(super) fn with_flow(mut lattice: Lattice, file: &SceneFile) -> Lattice {
    let regions = file.fluid.iter().flat_map(|fluid| &fluid.regions);
    let gravity = vec3(file.gravity).norm();
    for (index, region) in regions.enumerate() {
        let Some(flow) = &region.flow else { continue };
        let level = match region.shape {
            RegionShapeFile::Box { max, .. } => max.2,
            RegionShapeFile::Below { level, .. } => level,
        };
        let water = lattice.positions.iter().zip(&mut lattice.velocities);
        for ((x, velocity), _) in water
            .zip(&lattice.region)
            .filter(|(_, of)| **of as usize == index)
        {
            *velocity += velocity_of(flow, gravity, level, x);
        }
    }
    lattice
}

/// Velocity of a standing wave at the instant of a level surface: Airy's wave and its mirror image; m/s.
///
/// ```text
/// u = −a ω cosh(k (z + d)) sin(k (x − x₀))/sinh(k d)      w = a ω sinh(k (z + d)) cos(k (x − x₀))/sinh(k d)
/// ω² = g k tanh(k d)                                       a = H/2, z from the level
/// ```
fn velocity_of(flow: &FlowFile, gravity: f64, level: f64, x: &Vec3) -> Vec3 {
    let FlowFile::StandingWave {
        height,
        length,
        depth,
        crest,
    } = *flow;
    let k = std::f64::consts::TAU / length;
    let speed = 0.5 * height * (gravity * k * (k * depth).tanh()).sqrt();
    let (phase, up) = (k * (x.x - crest), k * (x.z - level + depth));
    let shape = Vec3::new(-up.cosh() * phase.sin(), 0.0, up.sinh() * phase.cos());
    shape * (speed / (k * depth).sinh())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_standing_wave_is_a_potential_flow_that_keeps_its_bed_and_walls() {
        let (gravity, level, depth, length, height) = (9.81, 0.3, 0.5, 2.0, 0.01);
        let wave = FlowFile::StandingWave {
            height,
            length,
            depth,
            crest: 0.1,
        };
        let at = |x: f64, z: f64| velocity_of(&wave, gravity, level, &Vec3::new(x, 0.7, z));
        // nothing flows through the bed, nor through the upright planes of crests and troughs
        for x in [0.1, 0.35, 0.9] {
            assert!(at(x, level - depth).z.abs() < 1e-15);
        }
        for z in [-0.2, 0.0, 0.3] {
            assert!(at(0.1, z).x.abs() < 1e-15 && at(1.1, z).x.abs() < 1e-15);
        }
        // the surface rises at the crest by a ω = H/2 · 2π/T
        let k = std::f64::consts::TAU / length;
        let omega = (gravity * k * (k * depth).tanh()).sqrt();
        assert!((at(0.1, level).z - 0.5 * height * omega).abs() < 1e-15);
        // no divergence and no rotation, to the error of central differences, (k h)²/6 of a ω k ~ 0.09
        let h = 1e-4;
        let slope = |of: &dyn Fn(f64) -> f64| (of(h) - of(-h)) / (2.0 * h);
        let (x, z) = (0.4, 0.1);
        let divergence = slope(&|e| at(x + e, z).x) + slope(&|e| at(x, z + e).z);
        let rotation = slope(&|e| at(x + e, z).z) - slope(&|e| at(x, z + e).x);
        assert!(divergence.abs() < 1e-8 && rotation.abs() < 1e-8);
    }
}
