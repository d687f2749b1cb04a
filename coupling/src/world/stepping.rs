//! The steppings: how blocks and fluid get from one time to the next together.
//!
//! In each, what the fluid's forces give the fluid over a step they give the blocks too, with the opposite
//! sign:
//!
//! ```text
//! kick-drift-kick       dt/2 F(t) before the blocks' sub-steps, dt/2 F(t + dt) after them
//! symplectic Euler      dt F(t) before them
//! predictor-corrector   dt F(t + dt/2) half way through them
//! ```

use riprap_sph::{Fluid, Stepping};

use super::{Held, StepError, Stopwatch, World};

impl World {
    /// That of the fluid; blocks by themselves take kick-drift-kick.
    pub fn stepping(&self) -> Stepping {
        self.water
            .as_ref()
            .map_or(Stepping::KickDriftKick, |water| {
                water.fluid.settings().scheme.stepping
            })
    }

    /// Takes blocks and fluid on by `dt` and evaluates what follows; returns the sub-steps that blocks took.
    pub(super) fn advance(&mut self, dt: f64, block_substeps: u32) -> Result<u32, StepError> {
        match self.stepping() {
            Stepping::KickDriftKick => {
                self.kick(0.5 * dt, Fluid::kick);
                self.drift(dt, block_substeps)?;
                self.kick(0.5 * dt, Fluid::kick);
                Ok(block_substeps)
            }
            Stepping::SymplecticEuler => {
                self.kick(dt, Fluid::kick);
                self.drift(dt, block_substeps)?;
                Ok(block_substeps)
            }
            Stepping::PredictorCorrector => self.predict_and_correct(dt, block_substeps),
        }
    }

    /// Blocks by their sub-steps, fluid with its density, and the evaluation at the end.
    fn drift(&mut self, dt: f64, block_substeps: u32) -> Result<(), StepError> {
        self.note_walls();
        self.advance_blocks(self.clock.time, dt, block_substeps)?;
        self.advance_fluid(dt)?;
        self.evaluate_fluid(dt)
    }

    /// Blocks take half of their sub-steps, one at least, to the half step, where the fluid meets them, and
    /// the others from there.
    fn predict_and_correct(&mut self, dt: f64, block_substeps: u32) -> Result<u32, StepError> {
        let (half, substeps) = (0.5 * dt, block_substeps.div_ceil(2));
        let middle = self.clock.time + half;
        self.predict(half);
        self.note_walls();
        self.advance_blocks(self.clock.time, half, substeps)?;
        // the fluid half way feels the impulse of half a step: so do the blocks that it meets there, or a
        // light block in water would be a wall of forward Euler
        self.apply_loads_at_start(half);
        self.evaluate_half_way(half)?;
        self.apply_loads_at_start(-half);
        self.kick(dt, Fluid::correct);
        self.advance_blocks(middle, half, substeps)?;
        if let Some(water) = &mut self.water {
            water.fluid.drift(half);
        }
        self.evaluate_fluid(dt)?;
        Ok(2 * substeps)
    }

    fn predict(&mut self, half: f64) {
        let mut watch = Stopwatch::start();
        let Some(water) = &mut self.water else { return };
        self.loads_at_start.clear();
        self.loads_at_start
            .extend_from_slice(water.interface.loads());
        self.stretches_at_start.clear();
        self.stretches_at_start
            .extend_from_slice(water.interface.stretches());
        water.fluid.predict(half);
        // not booked: the corrector starts again from the start
        water.openings.hold_velocities(&mut water.fluid);
        self.phases.integration += watch.lap();
    }

    /// Gives the blocks the impulse of the loads at the start of the step over `dt`.
    fn apply_loads_at_start(&mut self, dt: f64) {
        if self.held == Held::NoBlock {
            self.blocks.apply_impulse(&self.loads_at_start, dt);
            for &b in &self.deformable {
                self.blocks.apply_stretch(b, self.stretches_at_start[b], dt);
            }
        }
    }

    /// Evaluates the fluid half way through a step, `half` after its start, without inflow, outflow,
    /// push-back or shifting, which the corrector would undo.
    fn evaluate_half_way(&mut self, half: f64) -> Result<(), StepError> {
        let mut watch = Stopwatch::start();
        self.refresh_fluid()?;
        self.phases.neighbors += watch.lap();
        let middle = self.clock.time + half;
        let is_free = self.held == Held::NoBlock;
        let Some(water) = &mut self.water else {
            return Ok(());
        };
        water.interface.find(&water.fluid, &self.blocks);
        if let Some(walls) = &mut water.walls {
            walls.place_at_end(&self.blocks, is_free.then_some(half));
            walls.find(&mut water.fluid);
        }
        water.openings.hold(&mut water.fluid, middle);
        self.phases.wall_search += watch.lap();
        self.evaluate_forces()
    }
}
