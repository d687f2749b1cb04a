//! Blocks that water moves: on a column of it, released in it, floating on it, hit by it.

mod afloat;
mod loads;
mod released;
mod sealed;
mod sloped;
mod uplift;

use crate::support;
use crate::support::scene::{advance, resolved, resolved_in, world};

use riprap::observe::Observer;
use riprap::observe::frames::Frames;
use riprap::run::build;
use riprap::scene::resolved::recording::{Output, Sampling};
use riprap::time_step::TimeStep;
use riprap::vtk::{self, Values};
use riprap::world::World;
use riprap_sph::Vec3;

const RHO: f64 = 1000.0;

const G: f64 = 9.81;

/// No step is limited by it; s.
const DURATION: f64 = 10.0;

fn cuboid(name: &str, rest: &str, [x0, z0, x1, z1]: [f64; 4]) -> String {
    format!(
        "(name: \"{name}\", {rest}, shape: Box(min: ({x0:?}, -1.0, {z0:?}), max: ({x1:?}, 1.0, {z1:?}))),"
    )
}

/// A basin in a plane, `length` (m) long, with a block of which all but the name is given.
fn basin(length: f64, height: f64, level: f64, spacing: f64, body: &str, more: &str) -> String {
    let t = 4.0 * spacing;
    let walls = [
        ("floor", [-t, -t, length + t, 0.0]),
        ("left", [-t, 0.0, 0.0, height]),
        ("right", [length, 0.0, length + t, height]),
    ]
    .map(|(name, corners)| cuboid(name, "material: \"m\", motion: Fixed", corners));
    format!(
        "(title: \"floating\", gravity: (0, 0, -9.81),\n\
         domain: (min: ({:?}, 0.0, {:?}), max: ({:?}, 0.1, {height:?}), dimensions: Two),\n\
         materials: [(name: \"m\", density: 2000, friction_angle_deg: 0)],\n\
         blocks: [{} {body}],\n\
         fluid: (resolution: Spacing({spacing:?}),\n\
         regions: [(name: \"water\", shape: Below(level: {level:?}, seed: ({spacing:?}, 0.05, {spacing:?})))]),\n\
         {more} time: (duration: 10.0))",
        -t,
        -t,
        length + t,
        walls.concat(),
    )
}

/// Mean force (N) and moment about y (N m) of the water on the first block between two times (s).
fn mean_load(world: &mut World, [from, until]: [f64; 2]) -> [Vec3; 2] {
    let (mut sums, mut n) = ([Vec3::zeros(); 2], 0.0);
    advance(world, until, DURATION, |world| {
        if from < world.time() {
            let load = world.fluid_load(0);
            sums[0] += load.force;
            sums[1] += load.torque;
            n += 1.0;
        }
    });
    sums.map(|sum| sum / n)
}
