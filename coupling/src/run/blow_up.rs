//! Faults that no single step shows: spurious energy, mass outflow of water.
//!
//! ```text
//! (E_residual − E_residual,before)/(E_motion + E_springs + E_compression, before, or a little) ≤ 3
//! ```
//! from one check to the next. Schemes that lose or gain some percent pass: the check is for explosive growth.

use serde::{Deserialize, Serialize};

use crate::world::ledger::Energy;
use crate::world::{StepError, World};

/// Steps between two checks, at a cost of less than a hundredth of the run time: with water, and for blocks
/// alone.
const INTERVALS: [u64; 2] = [10, 50];
/// Largest unexplained energy gain between two checks, over the kinetic and strain energy.
const LARGEST_GAIN: f64 = 3.0;
/// Largest fraction of the water that may leave between two checks.
const LARGEST_LOSS: f64 = 0.2;
/// Particles that may always leave at once.
const FEW: u64 = 100;
/// Speed, over that of sound, of water considered at rest.
const STILL: f64 = 0.01;

/// The world at the last check.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct BlowUpDetector {
    /// J.
    residual: f64,
    /// Energy scale of a gain; J.
    scale: f64,
    /// Particles that had left.
    escaped: u64,
    /// Largest gain so far, over its scale.
    largest_gain: f64,
}

/// Steps between two checks.
fn interval(world: &World) -> u64 {
    INTERVALS[usize::from(world.water.is_none())]
}

impl BlowUpDetector {
    /// Whether a check is due.
    pub fn is_due(world: &World) -> bool {
        world.clock().steps.is_multiple_of(interval(world))
    }

    /// Starts from the current state.
    pub fn of(world: &World) -> Self {
        let energy = world.energy();
        Self {
            residual: energy.residual,
            scale: scale(&energy, world),
            escaped: escaped(world),
            largest_gain: 0.0,
        }
    }

    /// Compares the world with that of the last check.
    pub fn check(&mut self, world: &World) -> Result<(), StepError> {
        let energy = world.energy();
        let now = Self {
            residual: energy.residual,
            scale: scale(&energy, world),
            escaped: escaped(world),
            largest_gain: self.largest_gain,
        };
        let before = std::mem::replace(self, now);
        let (time, step) = (world.time(), world.clock().steps);
        let gained = energy.residual - before.residual;
        // a comparison with NaN is false
        if !(gained <= LARGEST_GAIN * before.scale) {
            return Err(StepError::EnergyFromNowhere {
                time,
                step,
                gained,
                before: before.scale,
                steps: interval(world),
            });
        }
        if 0.0 < before.scale {
            self.largest_gain = self.largest_gain.max(gained / before.scale);
        }
        let count = now.escaped - before.escaped;
        let left = world
            .water
            .as_ref()
            .map_or(0, |w| w.fluid.particles().len());
        if FEW < count && LARGEST_LOSS * (left as f64 + count as f64) < count as f64 {
            return Err(StepError::Drained {
                time,
                step,
                count,
                left,
                steps: interval(world),
            });
        }
        Ok(())
    }

    /// Largest unexplained energy gain, over the kinetic and strain energy.
    pub fn largest_gain(&self) -> f64 {
        self.largest_gain
    }
}

/// Kinetic and strain energy, at least that of a state close to rest: water moving at a hundredth of the speed of sound,
/// blocks falling by a thousandth of their size.
fn scale(energy: &Energy, world: &World) -> f64 {
    let water = world.water.as_ref().map_or(0.0, |water| {
        let speed = STILL * water.fluid.settings().sound_speed;
        0.5 * water.fluid.mass() * speed * speed
    });
    let blocks = &world.blocks;
    let fall = |b: usize| 1e-3 * blocks.mass(b) * blocks.volume(b).cbrt();
    let falls: f64 = (0..blocks.n_blocks())
        .filter(|&b| blocks.is_free(b))
        .map(fall)
        .sum();
    let moved = energy.kinetic + energy.elastic + energy.strain + energy.internal.abs();
    moved + water + world.gravity.norm() * falls
}

fn escaped(world: &World) -> u64 {
    world
        .water
        .as_ref()
        .map_or(0, |water| water.fluid.removed().count)
}
