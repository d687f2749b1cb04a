//! Faults that no single step shows: spurious energy, mass outflow of water.
//!
//! ```text
//! (E_residual − E_residual,before)/(E_motion + E_springs + E_compression, before, or a little) ≤ 3
//! ```
//! from one look to the next. Schemes that lose or gain some percent pass: this is for what explodes.

use serde::{Deserialize, Serialize};

use crate::world::ledger::Energy;
use crate::world::{StepError, World};

/// Steps from one look to the next, so that looking takes less than a hundredth of the time: with water, and of blocks by
/// themselves.
const INTERVALS: [u64; 2] = [10, 50];
/// Largest gain of energy that nothing explains between two looks, over all that moves or is strained.
const LARGEST_GAIN: f64 = 3.0;
/// Largest share of the water that may leave between two looks.
const LARGEST_LOSS: f64 = 0.2;
/// Particles that may leave at once however few there are.
const FEW: u64 = 100;
/// Speed, over that of sound, of water that is as good as at rest.
const STILL: f64 = 0.01;

/// The world at the last look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct BlowUpDetector {
    /// J.
    residual: f64,
    /// Energy that a gain is measured by; J.
    scale: f64,
    /// Particles that had left.
    escaped: u64,
    /// Largest gain that was seen, over its scale.
    largest_gain: f64,
}

/// Steps from one look to the next.
fn interval(world: &World) -> u64 {
    INTERVALS[usize::from(world.water.is_none())]
}

impl BlowUpDetector {
    /// Whether it is time to look.
    pub fn is_due(world: &World) -> bool {
        world.clock().steps.is_multiple_of(interval(world))
    }

    /// From now on.
    pub fn of(world: &World) -> Self {
        let energy = world.energy();
        Self {
            residual: energy.residual,
            scale: scale(&energy, world),
            escaped: escaped(world),
            largest_gain: 0.0,
        }
    }

    /// Compares the world with that of the last look.
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
        // NaN is no less than the limit either
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

    /// Largest gain of energy that nothing explains, over all that moved or was strained.
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
