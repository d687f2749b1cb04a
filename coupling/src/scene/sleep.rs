//! Sleep of water and blocks: parameters where the file has none, and refusals.

use riprap_dda::{BlockDefinition, Motion, Resting};
use riprap_sph::{Settings, Sleeping};

use super::error::Problem;
use super::file::{SceneFile, vec3};
use crate::messages::Code;
use crate::walls::WallMethod;

/// Mean displacement that wakes the tiles around, over the spacing. At 0.01 the crest near a block that falls into six rows of
/// water is 2.5 % off, below 0.003 no closer than there; on a solitary wave 0.01 would do.
const DISPLACEMENT: f64 = 0.003;
/// Speed of water at rest, over that of long waves: still water that has settled has a third of it.
const SPEED: f64 = 1e-3;
/// Time at rest over that in which long waves travel a depth: standing waves up to ten depths long, which pause at their
/// turning points, do not do so for as long.
const TIME: f64 = 10.0;

/// Displacement of a block at rest, over its size: a boulder of a meter may creep by a millimeter in half a second.
const RESTING_DISPLACEMENT: f64 = 1e-3;
/// Time at rest over that in which a block falls half its size.
const RESTING_TIME: f64 = 2.0;
/// Change of load that wakes a block, over its weight: the fluctuating load on a block under water is a tenth.
const RESTING_LOAD: f64 = 0.2;

/// Sleep of blocks, if the file asks for it.
pub(super) fn resting(
    file: &SceneFile,
    blocks: &[BlockDefinition],
    problems: &mut Vec<Problem>,
) -> Option<Resting> {
    let gravity = vec3(file.gravity).norm();
    let resting = file.numerics.resting?;
    if gravity == 0.0 {
        let what = "blocks cannot rest without gravity; leave `numerics.resting` out";
        problems.push(Problem::error(
            Code::IncompatibleOptions,
            "numerics.resting",
            what,
        ));
    }
    let free = blocks.iter().filter(|b| matches!(b.motion, Motion::Free));
    let largest = free.map(|b| b.shape.volume().cbrt()).fold(0.0, f64::max);
    let time = RESTING_TIME * (largest / gravity).sqrt();
    Some(Resting {
        displacement: resting.displacement.unwrap_or(RESTING_DISPLACEMENT),
        // without any free block it has no effect, but is still a number
        time: resting.time.unwrap_or(if time > 0.0 { time } else { 1.0 }),
        load: resting.load.unwrap_or(RESTING_LOAD),
    })
}

/// Sleep of the water, if the file asks for it.
pub(super) fn sleeping(
    file: &SceneFile,
    settings: &Settings,
    (wall_method, depth): (WallMethod, f64),
    problems: &mut Vec<Problem>,
) -> Option<Sleeping> {
    let mut refuse = |found: &str| {
        problems.push(Problem::error(
            Code::WaterCannotSleep,
            "numerics.sleeping",
            format!("water cannot sleep with {found}"),
        ));
    };
    let sleeping = file.numerics.sleeping?;
    if wall_method != WallMethod::Particles {
        refuse("penalty or integral walls, which press on it; set `interface.walls` to Particles");
    }
    if !(file.inflows.is_empty() && file.outflows.is_empty()) {
        refuse("inflows or outflows, where it comes and goes all the time; leave one of them out");
    }
    let wave_speed = (settings.gravity.norm() * depth).sqrt();
    let is_chosen = sleeping.speed.is_none() || sleeping.time.is_none();
    if is_chosen && wave_speed == 0.0 {
        refuse("no gravity, from which its speed and time of rest would follow; give both");
    }
    let chosen = Sleeping {
        displacement: sleeping.displacement.unwrap_or(DISPLACEMENT),
        speed: sleeping.speed.unwrap_or(SPEED * wave_speed),
        time: sleeping.time.unwrap_or(TIME * depth / wave_speed),
    };
    if let Err(error) = settings.check_sleep() {
        problems.push(Problem::error(
            Code::WaterCannotSleep,
            "numerics.sleeping",
            error.to_string(),
        ));
    }
    Some(chosen)
}
