//! Settling before t = 0: of the water among held blocks, or of blocks among walls and gates. The clock stands still, and the ledger
//! opens at its end.

use super::progress::{Extremes, Held};
use super::time_step::{BlockSteps, TimeStep};
use super::{StepError, World};

impl World {
    /// A step of the fluid alone, blocks held, velocities damped by `exp(−rate · dt)`.
    ///
    /// # Errors
    ///
    /// As [`Self::step`].
    pub fn settle_step(&mut self, dt: f64, rate: f64) -> Result<(), StepError> {
        self.progress.held = Held::AllBlocks;
        self.advance(self.time(), dt, BlockSteps::NONE)?;
        if let Some(water) = &mut self.water {
            water.fluid.damp((-rate * dt).exp());
        }
        self.progress.clock.last_dt = Some(dt);
        self.check_speeds()
    }

    /// Ends settling of the water: blocks are let go, the ledger and all counts start here.
    ///
    /// # Errors
    ///
    /// As [`Self::step`].
    pub fn release(&mut self) -> Result<(), StepError> {
        self.progress.held = Held::NoBlock;
        self.progress.extremes = Extremes::default();
        if let Some(water) = &mut self.water
            && water.sleeping.is_some()
        {
            // sleeping water is at rest, and residual motion of settling is not part of the run
            water.fluid.damp(0.0);
        }
        self.evaluate()?;
        self.open_ledger();
        Ok(())
    }

    /// A step of the free blocks, prescribed ones held, `since` the start of settling (s). Of a world without water.
    ///
    /// # Errors
    ///
    /// As [`Self::step`].
    pub fn settle_blocks_step(&mut self, step: TimeStep, since: f64) -> Result<(), StepError> {
        if self.progress.held != Held::Paths {
            self.progress.held = Held::Paths;
            self.blocks.hold_paths(true);
        }
        self.advance(since, step.dt, step.of_blocks)?;
        self.progress.clock.last_dt = Some(step.dt);
        self.check_speeds()
    }

    /// Ends settling of the blocks: gates are gone, prescribed blocks are let go, the ledger, all accounts and counts start here.
    ///
    /// # Errors
    ///
    /// As [`Self::step`].
    pub fn release_blocks(&mut self, gates: &[usize]) -> Result<(), StepError> {
        for &gate in gates {
            self.blocks.remove(gate);
        }
        self.blocks.hold_paths(false);
        self.blocks.begin_sums();
        self.release()
    }
}
