//! Sleep of water and blocks: default parameters, and incompatible options.

use riprap_dda::{BlockDefinition, Motion, Resting};
use riprap_sph::{Settings, Sleeping};

use super::error::Problem;
use super::file::{SceneFile, WallMethodFile};

/// Mean displacement at which neighbors wake, over the spacing. At 0.01 the crest near a block that falls into six rows of
/// water is 2.5 % off, at less than 0.003 no nearer than there; on a solitary wave 0.01 would do.
const DISPLACEMENT: f64 = 0.003;
/// Speed up to which water is at rest, over that of long waves: still water that has settled has a third of it.
const SPEED: f64 = 1e-3;
/// Time of rest over that in which long waves go a depth: standing waves up to ten depths long, which pause as they turn,
/// do not do so for as long.
const TIME: f64 = 10.0;

/// Way of a block at rest, over its size: a boulder of a meter may creep by a millimeter in half a second.
const RESTING_WAY: f64 = 1e-3;
/// Time of rest over that in which a block falls half its size.
const RESTING_TIME: f64 = 2.0;
/// Change of load that wakes, over the weight: of a block under water what pushes it in kicks is a tenth.
const RESTING_LOAD: f64 = 0.2;

/// Fills in when blocks sleep, if the file wants them to.
pub(super) fn resting(
    file: &mut SceneFile,
    blocks: &[BlockDefinition],
    problems: &mut Vec<Problem>,
) -> Option<Resting> {
    let gravity = super::file::vec3(file.gravity).norm();
    let resting = file.numerics.resting.as_mut()?;
    if gravity == 0.0 {
        let what = "blocks cannot rest without gravity; leave `numerics.resting` out";
        problems.push(Problem::error("numerics.resting", what));
    }
    let free = blocks.iter().filter(|b| matches!(b.motion, Motion::Free));
    let largest = free.map(|b| b.shape.volume().cbrt()).fold(0.0, f64::max);
    let time = RESTING_TIME * (largest / gravity).sqrt();
    Some(Resting {
        displacement: *resting.displacement.get_or_insert(RESTING_WAY),
        // without any free block it is of no use, but is still a number
        time: *resting
            .time
            .get_or_insert(if time > 0.0 { time } else { 1.0 }),
        load: *resting.load.get_or_insert(RESTING_LOAD),
    })
}

/// Fills in when the water sleeps, if the file wants it to.
pub(super) fn sleeping(
    file: &mut SceneFile,
    settings: &Settings,
    depth: f64,
    problems: &mut Vec<Problem>,
) -> Option<Sleeping> {
    let mut refuse = |found: &str| {
        problems.push(Problem::error(
            "numerics.sleeping",
            format!("water cannot sleep with {found}"),
        ));
    };
    let sleeping = file.numerics.sleeping.as_mut()?;
    if file.interface.walls != Some(WallMethodFile::Particles) {
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
        displacement: *sleeping.displacement.get_or_insert(DISPLACEMENT),
        speed: *sleeping.speed.get_or_insert(SPEED * wave_speed),
        time: *sleeping.time.get_or_insert(TIME * depth / wave_speed),
    };
    if let Err(error) = settings.check_sleep() {
        problems.push(Problem::error("numerics.sleeping", error.to_string()));
    }
    Some(chosen)
}
