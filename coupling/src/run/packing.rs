//! Packing: particles between walls inclined to the lattice of the water are redistributed evenly before
//! the run.
//!
//! A lattice cut along an inclined wall leaves gaps and clusters of up to a spacing: still water flows into them,
//! and the effective size of a body is wrong. Here particles move toward lower concentration of
//! wall and water particles until they no longer advance; a mould of additional lattice above
//! the level keeps the surface in place. Where the lattice fits, nothing moves.

use riprap_dda::{BlockDefinition, Blocks};
use riprap_sph::{Fluid, FluidError, Start, Vec3};

use crate::scene::resolve::FluidScene;
use crate::walls::Walls;
use crate::walls::penalty::Interface;

/// Largest `h |∇C|` that counts as even.
const EVEN: f64 = 1e-3;
/// Largest number of iterations: unevenness spreads over some ten spacings.
const MOST_ROUNDS: usize = 200;

/// Packed initial state of the water, and the particles in it: at a shallow shore some would otherwise be above
/// the level.
///
/// # Errors
///
/// [`FluidError`] for settings that are out of range.
pub fn packed(
    water: &FluidScene,
    definitions: &[BlockDefinition],
    blocks: &Blocks,
) -> Result<(Start, Vec<u32>), FluidError> {
    let lattice = &water.lattice;
    let mut start = Start {
        positions: lattice.positions.clone(),
        velocities: lattice.velocities.clone(),
        pressures: water.pressures.clone(),
    };
    let all = (0..start.positions.len() as u32).collect();
    if lattice.mould.is_empty() {
        return Ok((start, all));
    }
    let mut settings = water.settings.clone();
    let support = settings.support_radius();
    let (_, top) = &mut settings.domain;
    top.z = lattice.mould.iter().fold(top.z, |top, x| top.max(x.z)) + support;
    let positions: Vec<Vec3> = [&lattice.positions, &lattice.mould]
        .into_iter()
        .flatten()
        .copied()
        .collect();
    let is_free = |(x, &region): (&Vec3, &u32)| {
        lattice.is_packed[region as usize] && !water.openings.has_near(x, support)
    };
    let particles = lattice.positions.iter().zip(&lattice.region);
    let is_free: Vec<bool> = particles.map(is_free).collect();
    let at_rest = Start {
        velocities: vec![Vec3::zeros(); positions.len()],
        positions,
        pressures: Vec::new(),
    };
    let mut fluid = Fluid::new(at_rest, settings)?;
    let Some(mut walls) = Walls::new(water.wall_method, definitions, blocks, &fluid, water.slip)
    else {
        return Ok((start, all));
    };
    let mut interface = Interface::new(water.walls, (blocks, water.averaged_blocks()), &fluid);
    for _ in 0..MOST_ROUNDS {
        fluid.refresh();
        interface.find(&fluid, blocks);
        // in a sharp corner only the surface itself stops them
        for penetration in interface.penetrations(&fluid, blocks) {
            fluid.relocate(
                penetration.particle as usize,
                penetration.clear,
                Vec3::zeros(),
            );
        }
        fluid.refresh();
        walls.find(&mut fluid);
        fluid.update_concentration();
        walls.add_concentrations(&mut fluid);
        if fluid.even_out(|id| is_free.get(id.index()) != Some(&true)) < EVEN {
            break;
        }
    }
    take_positions(&fluid, water, &mut start);
    let kept = below_level(water, &start);
    let start = Start {
        positions: kept.iter().map(|&a| start.positions[a]).collect(),
        velocities: kept.iter().map(|&a| start.velocities[a]).collect(),
        pressures: kept.iter().map(|&a| start.pressures[a]).collect(),
    };
    Ok((start, kept.into_iter().map(|a| a as u32).collect()))
}

/// Takes over the packed positions, with the hydrostatic pressure there.
fn take_positions(fluid: &Fluid, water: &FluidScene, start: &mut Start) {
    let particles = fluid.particles();
    let weight = water.settings.gravity * water.settings.reference_density;
    for (x, &id) in particles.position.iter().zip(&particles.id) {
        let a = id.index();
        // the mould is no part of the water
        if start.positions.len() <= a {
            continue;
        }
        // one and the same hydrostatic pressure field at the new place
        start.pressures[a] = (start.pressures[a] + weight.dot(&(x - start.positions[a]))).max(0.0);
        start.positions[a] = *x;
    }
}

/// Particles that are not above the level of their region.
fn below_level(water: &FluidScene, start: &Start) -> Vec<usize> {
    let lattice = &water.lattice;
    let height = water.settings.particle_spacing[2];
    let mut levels = vec![f64::NEG_INFINITY; lattice.is_packed.len()];
    for (x, &region) in lattice.positions.iter().zip(&lattice.region) {
        let level = &mut levels[region as usize];
        *level = level.max(x.z + 0.5 * height);
    }
    let is_below = |a: usize| start.positions[a].z <= levels[lattice.region[a] as usize];
    (0..start.positions.len())
        .filter(|&a| is_below(a))
        .collect()
}
