//! The common step of both media and its governing limit.

use serde::{Deserialize, Serialize};

/// Largest growth from one step to the next; drops are immediate.
const LARGEST_GROWTH: f64 = 1.05;

/// Governing limit of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// Pressure waves in the fluid.
    Sound,
    /// Viscosity of the fluid.
    Viscosity,
    /// Acceleration of particles.
    Force,
    /// Penalty springs between particles and blocks.
    Wall,
    /// Contacts between blocks, where no fluid sets a longer common step.
    Contact,
    /// The way of a block in a step, within which contacts are found in time, or its turn; where no fluid sets a longer common step.
    BlockSpeed,
    /// The step of contact dynamics: as given, or by a block that moves far in it, where no fluid sets a shorter common step.
    BlockStep,
    /// Blocks in free flight, which need no step at all: a thousandth of the duration.
    Duration,
    /// The step may grow by no more than 5 % at a time.
    Growth,
}

/// Every cause, in the order of `dt_governed_by`.
pub const CAUSES: [Cause; 9] = [
    Cause::Sound,
    Cause::Viscosity,
    Cause::Force,
    Cause::Wall,
    Cause::Contact,
    Cause::BlockSpeed,
    Cause::BlockStep,
    Cause::Duration,
    Cause::Growth,
];

/// A step and its cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeStep {
    /// s.
    pub dt: f64,
    /// Governing limit.
    pub cause: Cause,
    /// Steps of the blocks.
    pub of_blocks: BlockSteps,
}

/// Steps of the blocks against the common one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BlockSteps {
    /// Equal ones inside it.
    Inside(u32),
    /// Steps of contact dynamics of this length (s), each over several common ones.
    Spanning(f64),
}

impl BlockSteps {
    /// No steps: blocks are held.
    pub const NONE: Self = Self::Inside(0);

    /// Those in half of the step: one at least, where they are inside it.
    #[must_use]
    pub fn in_half(self) -> Self {
        match self {
            Self::Inside(n) => Self::Inside(n.div_ceil(2)),
            Self::Spanning(period) => Self::Spanning(period),
        }
    }
}

/// Limits of the step at the present state, each with its safety factor; s, infinite when absent.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Limits that the common step must obey.
    pub common: Vec<(Cause, f64)>,
    /// Limit of the blocks, obeyed by sub-steps when there is fluid.
    pub blocks: f64,
    /// Its cause.
    pub cause_of_blocks: Cause,
    /// Step of the blocks that the water bears where they take one over several common steps; 0 where they do not.
    pub blocks_in_water: f64,
}

/// Common steps from which on blocks take one step over several.
const FEWEST_SPANNED: f64 = 2.0;

impl Limits {
    /// A share of each.
    #[must_use]
    pub fn within(mut self, share: f64) -> Self {
        for (_, limit) in &mut self.common {
            *limit *= share;
        }
        self.blocks *= share;
        self.blocks_in_water *= share;
        self
    }

    /// The step that obeys the limits after a step of `previous` seconds.
    ///
    /// With fluid, blocks that need a shorter step take several inside the common one, and those that may take a longer one take it over
    /// several. `ceiling`
    /// bounds the step of blocks alone, which in free flight have no limit of their own but that of contact dynamics.
    pub fn choose(&self, has_fluid: bool, previous: Option<f64>, ceiling: f64) -> TimeStep {
        let has_step = has_fluid || self.cause_of_blocks == Cause::BlockStep;
        let ceiling = if has_step { f64::INFINITY } else { ceiling };
        let mut chosen = (Cause::Duration, ceiling);
        let contact = (self.cause_of_blocks, self.blocks);
        let candidates = self.common.iter().chain((!has_fluid).then_some(&contact));
        for &(cause, limit) in candidates {
            if limit < chosen.1 {
                chosen = (cause, limit);
            }
        }
        let (mut cause, mut dt) = chosen;
        if let Some(previous) = previous
            && LARGEST_GROWTH * previous < dt
        {
            (cause, dt) = (Cause::Growth, LARGEST_GROWTH * previous);
        }
        let period = self.blocks.min(self.blocks_in_water);
        let of_blocks = match FEWEST_SPANNED * dt <= period {
            true => BlockSteps::Spanning(period),
            // an infinite limit gives zero sub-steps: one is the least
            false => BlockSteps::Inside(((dt / self.blocks).ceil() as u32).max(1)),
        };
        TimeStep {
            dt,
            cause,
            of_blocks,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits() -> Limits {
        Limits {
            common: vec![(Cause::Sound, 2e-3), (Cause::Wall, 5e-3)],
            blocks: 3e-4,
            cause_of_blocks: Cause::Contact,
            blocks_in_water: 0.0,
        }
    }

    #[test]
    fn fluid_sets_the_step_and_blocks_fit_theirs_inside() {
        let step = limits().choose(true, None, 1.0);
        assert_eq!(
            (step.cause, step.dt, step.of_blocks),
            (Cause::Sound, 2e-3, BlockSteps::Inside(7))
        );
    }

    #[test]
    fn blocks_alone_take_their_own_step() {
        let alone = Limits {
            common: Vec::new(),
            ..limits()
        };
        let step = alone.choose(false, None, 1.0);
        assert_eq!(
            (step.cause, step.dt, step.of_blocks),
            (Cause::Contact, 3e-4, BlockSteps::Inside(1))
        );
    }

    #[test]
    fn free_flight_is_bounded_by_the_duration() {
        let free = Limits {
            common: Vec::new(),
            blocks: f64::INFINITY,
            cause_of_blocks: Cause::Contact,
            blocks_in_water: 0.0,
        };
        let step = free.choose(false, None, 0.01);
        assert_eq!(
            (step.cause, step.dt, step.of_blocks),
            (Cause::Duration, 0.01, BlockSteps::Inside(1))
        );
    }

    #[test]
    fn contact_dynamics_takes_its_step_however_short_the_run() {
        let given = Limits {
            common: Vec::new(),
            blocks: 5e-3,
            cause_of_blocks: Cause::BlockStep,
            blocks_in_water: 0.0,
        };
        let step = given.choose(false, None, 1e-3);
        assert_eq!((step.cause, step.dt), (Cause::BlockStep, 5e-3));
    }

    #[test]
    fn blocks_that_the_water_lets_take_one_step_over_several() {
        let long = |blocks: f64, blocks_in_water: f64| Limits {
            blocks,
            cause_of_blocks: Cause::BlockStep,
            blocks_in_water,
            ..limits()
        };
        let of = |limits: Limits| limits.choose(true, None, 1.0).of_blocks;
        assert_eq!(of(long(2e-2, 9e-3)), BlockSteps::Spanning(9e-3));
        assert_eq!(of(long(5e-3, 9e-3)), BlockSteps::Spanning(5e-3));
        assert_eq!(of(long(2e-2, 3e-3)), BlockSteps::Inside(1));
        assert_eq!(of(long(1e-3, 9e-3)), BlockSteps::Inside(2));
    }

    #[test]
    fn a_short_run_of_fluid_takes_the_steps_of_a_long_one() {
        assert_eq!(
            limits().choose(true, None, 1e-6),
            limits().choose(true, None, 1.0)
        );
    }

    #[test]
    fn a_step_grows_slowly_and_drops_at_once() {
        let grown = limits().choose(true, Some(1e-3), 1.0);
        assert_eq!(grown.cause, Cause::Growth);
        assert!((grown.dt - 1.05e-3).abs() < 1e-15);
        assert_eq!(limits().choose(true, Some(1.0), 1.0).dt, 2e-3);
    }
}
