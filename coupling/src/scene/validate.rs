//! Validation of a scene from the file alone; reports every problem, not only the first.

mod attachments;
mod blocks;
mod bulk;
mod checks;
mod domain;
mod fluid;
mod gauges;
mod materials;
mod numerics;
mod openings;
mod records;
mod shapes;
mod terrain;
mod units;
mod waves;

use super::error::Problem;
use super::file::{CounterFile, SceneFile};
use crate::messages::Code;
use checks::Checks;
use gauges::gauge_name;

/// All problems of the values of a scene.
pub fn values(scene: &SceneFile) -> Vec<Problem> {
    let mut check = Checks::default();
    check.domain(scene);
    for (index, material) in scene.materials.iter().enumerate() {
        check.material(index, material);
    }
    check.unique("materials", scene.materials.iter().map(|m| m.name.as_str()));
    for (index, joint) in scene.joints.iter().enumerate() {
        check.joint(index, joint, scene);
    }
    for (index, block) in scene.blocks.iter().enumerate() {
        check.block(index, block, scene);
        check.wave_maker(index, block, scene);
    }
    check.unique("blocks", scene.blocks.iter().map(|b| b.name.as_str()));
    for (index, mass) in scene.rock_masses.iter().enumerate() {
        check.rock_mass(index, mass, scene);
    }
    check.unique(
        "rock_masses",
        scene.rock_masses.iter().map(|m| m.name.as_str()),
    );
    check.terrain(scene);
    check.units(scene);
    for (index, grains) in scene.grains.iter().enumerate() {
        check.grains(index, grains, scene);
    }
    check.unique("grains", scene.grains.iter().map(|g| g.name.as_str()));
    for (index, attachment) in scene.attachments.iter().enumerate() {
        check.attachment(index, attachment, scene);
    }
    if let Some(fluid) = &scene.fluid {
        check.fluid(fluid, scene);
    }
    check.openings(scene);
    let has_blocks =
        !(scene.blocks.is_empty() && scene.rock_masses.is_empty() && scene.grains.is_empty());
    if !has_blocks && scene.fluid.is_none() {
        check.refuse(
            Code::EmptyList,
            "",
            "the scene has neither blocks nor fluid; add one of them".to_owned(),
        );
    }
    check.numbers(scene);
    for (index, gauge) in scene.gauges.iter().enumerate() {
        check.gauge(index, gauge, scene);
    }
    check.unique("gauges", scene.gauges.iter().map(gauge_name));
    if let Some(forces) = &scene.forces {
        check.forces(forces, scene);
    }
    if let Some(maps) = &scene.maps {
        check.maps(maps, scene);
    }
    for (index, mass) in scene.masses.iter().enumerate() {
        check.mass(index, mass, scene);
    }
    check.unique("masses", scene.masses.iter().map(|mass| mass.name.as_str()));
    if let Some(trajectories) = &scene.trajectories {
        check.trajectories(trajectories, scene);
    }
    for (index, counter) in scene.counters.iter().enumerate() {
        check.counter(index, counter, scene);
    }
    check.unique("counters", scene.counters.iter().map(CounterFile::name));
    for (index, reaction) in scene.reactions.iter().enumerate() {
        check.reaction(index, reaction);
    }
    check.unique("reactions", scene.reactions.iter().map(|r| r.name.as_str()));
    for (index, barrier) in scene.barriers.iter().enumerate() {
        check.barrier(index, barrier);
    }
    check.unique("barriers", scene.barriers.iter().map(|b| b.name.as_str()));
    if let Some(handoff) = &scene.handoff {
        check.handoff(handoff, scene);
    }
    if let Some(camera) = &scene.camera {
        check.camera(camera);
    }
    check.problems
}
