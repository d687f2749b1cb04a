//! Building the world of a scene.

use riprap_dda::{BlockDefinition, Blocks, Shape};
use riprap_sph::Fluid;

use super::RunError;
use super::packing::packed;
use crate::grains::AveragedGrains;
use crate::joints::JointWater;
use crate::scene::resolve::{FluidScene, Scene};
use crate::scene::resolved::recording::Quantity;
use crate::walls::Walls;
use crate::world::pistons::AbsorbingPiston;
use crate::world::{Water, WaterBoundaries, World, WorldSettings};

/// Builds the world of a scene.
///
/// # Errors
///
/// [`RunError`] when blocks or fluid refuse their settings.
pub fn build(scene: &Scene) -> Result<World, RunError> {
    let mut blocks = Blocks::with_joints(
        scene.blocks.clone(),
        scene.materials.clone(),
        &scene.joints,
        scene.block_settings,
    )?;
    for (block, hold) in &scene.holds {
        blocks.hold(*block, hold.clone())?;
    }
    blocks.attach(&scene.attachments)?;
    let water = (scene.fluid.as_ref())
        .map(|fluid| water(fluid, scene, &blocks))
        .transpose()?;
    let settings = WorldSettings {
        gravity: scene.gravity,
        domain: (scene.domain.min, scene.domain.max),
        out_of_domain: scene.domain.out_of_domain,
        weakenings: scene.weakenings.clone(),
        pistons: pistons(scene, &blocks),
    };
    let mut world = World::new(blocks, water, settings)?;
    world.keep_accounts(&recorded(scene));
    Ok(world)
}

/// Blocks whose impulses are recorded.
fn recorded(scene: &Scene) -> Vec<usize> {
    let by_source = scene.forces.iter().flat_map(|asked| asked.blocks.clone());
    let of_gauges = scene
        .gauges
        .iter()
        .filter_map(|gauge| match gauge.quantity {
            Quantity::BlockForce { block } => Some(block),
            _ => None,
        });
    let of_barriers = scene.barriers.iter().flat_map(|b| b.blocks.iter().copied());
    by_source.chain(of_gauges).chain(of_barriers).collect()
}

/// Wave makers that absorb.
fn pistons(scene: &Scene, blocks: &Blocks) -> Vec<AbsorbingPiston> {
    let Some(fluid) = &scene.fluid else {
        return Vec::new();
    };
    let spacing = fluid.settings.mean_spacing();
    let absorbing = scene.wave_makers.iter().filter(|maker| maker.absorbs);
    absorbing
        .map(|maker| {
            let front = maker.front - blocks.centroid(maker.block);
            AbsorbingPiston::new(
                (maker.block, maker.direction),
                (front, maker.half_width),
                (maker.piston.water.depth, spacing),
                maker.piston.control(AbsorbingPiston::reads_at(spacing)),
            )
        })
        .collect()
}

/// Packed water with its walls, joints and openings.
fn water(water: &FluidScene, scene: &Scene, blocks: &Blocks) -> Result<Water, RunError> {
    let solids = solids(water, scene);
    let (start, kept) = packed(water, &solids, blocks)?;
    let mut settings = water.settings.clone();
    // what packing left out, because it would have stood above the level, is shared by all others
    let n_drawn = water.lattice.positions.len();
    settings.particle_spacing[2] *= n_drawn as f64 / start.positions.len().max(1) as f64;
    let mut fluid = Fluid::new(start, settings)?;
    if !water.rheologies.is_empty() {
        let kinds: Vec<_> = kept.iter().map(|&a| water.kinds[a as usize]).collect();
        fluid.set_rheologies(water.rheologies.clone(), &kinds)?;
    }
    let walls = Walls::new(water.wall_method, &solids, blocks, &fluid, water.slip);
    let is_sealed = |b: usize| scene.is_sealed[b];
    let recorded = recorded(scene);
    let is_recorded = |b: usize| recorded.contains(&b);
    let boundaries = WaterBoundaries {
        joints: JointWater::new(&solids, blocks, &fluid, (is_sealed, is_recorded)),
        grains: (water.averaged.as_ref()).map(|averaged| {
            AveragedGrains::new(averaged.settings.clone(), &averaged.blocks, blocks)
        }),
        penalty: water.walls,
        walls,
        openings: water.openings.clone(),
        absorbers: water.absorbers.clone(),
        sleeping: water.sleeping,
    };
    Ok(Water::new(fluid, boundaries, blocks)?)
}

/// Blocks as the water sees them: grains whose forces are averages have no walls.
fn solids(water: &FluidScene, scene: &Scene) -> Vec<BlockDefinition> {
    let mut solids = scene.blocks.clone();
    for &block in water.averaged_blocks() {
        solids[block].shape = Shape::Polyhedra(Vec::new());
    }
    solids
}

/// World of a scene's text, for the unit tests of what is in it.
#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
pub(crate) fn world_of(text: &str) -> World {
    let file = crate::scene::parse::read(text).unwrap();
    build(&Scene::resolve(file, std::path::Path::new(".")).unwrap()).unwrap()
}
