//! The coupler: blocks, walls, joints and openings as the boundary of the fluid's step.
//!
//! The impulse of a kick on the fluid reaches the blocks with the opposite sign in the same call:
//!
//! ```text
//! kick-drift-kick       dt/2 F(t) before the blocks' sub-steps, dt/2 F(t + dt) after them
//! symplectic Euler      dt F(t) before them
//! predictor-corrector   dt F(t + dt/2) half way through them
//! ```

use riprap_sph::{Boundary, Fluid, FluidError, Part, Phase, Stage};

use crate::grains::AveragedGrains;
use crate::joints::JointWater;
use crate::openings::Openings;
use crate::walls::Walls;
use crate::walls::added_mass::Movers;
use crate::walls::penalty::Interface;
use crate::world::accounts::look_at_fixed;
use crate::world::bodies::{BlockPhase, InWalls, movable};
use crate::world::ledger::Holding;
use crate::world::progress::Stopwatch;
use crate::world::time_step::BlockSteps;
use crate::world::{OutOfDomain, StepError, Water, World};

/// Everything that holds the fluid, for the time of a step.
#[derive(Debug)]
pub(super) struct Coupler<'a> {
    pub(super) rock: BlockPhase<'a>,
    pub(super) interface: &'a mut Interface,
    pub(super) walls: &'a mut Option<Walls>,
    joints: &'a mut JointWater,
    grains: &'a mut Option<AveragedGrains>,
    pub(super) openings: &'a mut Openings,
    /// Steps of the blocks in a whole step, and the number of those taken.
    of_blocks: BlockSteps,
    block_steps_taken: u32,
    /// Time over which blocks have the loads at the start in advance, in a predicted middle; s.
    in_advance: Option<f64>,
}

/// End of a step without a new state.
#[derive(Debug)]
pub(super) enum Stopped {
    /// By the fluid.
    Fluid(FluidError),
    /// By anything else.
    Step(StepError),
}

impl From<FluidError> for Stopped {
    fn from(error: FluidError) -> Self {
        Self::Fluid(error)
    }
}

impl World {
    /// Runs a part of the fluid's step with blocks and walls as its boundary, where there is a fluid; returns the steps that
    /// blocks took.
    pub(super) fn coupled(
        &mut self,
        of_blocks: BlockSteps,
        part: impl FnOnce(&mut Fluid, &mut Coupler) -> Result<(), Stopped>,
    ) -> Result<u32, StepError> {
        let Self {
            blocks,
            water,
            bodies,
            progress,
            ..
        } = self;
        let Some(water) = water else { return Ok(0) };
        let Water {
            fluid,
            interface,
            walls,
            joints,
            grains,
            openings,
            absorbers: _,
            sleeping: _,
        } = water;
        let (time, step) = (progress.clock.time, progress.clock.steps);
        let mut coupler = Coupler {
            rock: BlockPhase {
                blocks,
                bodies,
                progress,
                watch: Stopwatch::start(),
            },
            interface,
            walls,
            joints,
            grains,
            openings,
            of_blocks,
            block_steps_taken: 0,
            in_advance: None,
        };
        match part(fluid, &mut coupler) {
            Ok(()) => Ok(coupler.block_steps_taken),
            Err(Stopped::Step(error)) => Err(error),
            Err(Stopped::Fluid(source)) => Err(StepError::Fluid { time, step, source }),
        }
    }
}

impl Coupler<'_> {
    fn time(&self) -> f64 {
        self.rock.progress.clock.time
    }

    fn searched(&mut self) {
        self.rock.progress.phases.wall_search += self.rock.watch.lap();
    }

    fn summed(&mut self) {
        self.rock.progress.phases.coupling += self.rock.watch.lap();
    }

    /// Gives the blocks the impulse of the loads at the start of the step over `dt` (s).
    fn apply_loads_at_start(&mut self, dt: f64) {
        if self.rock.are_held() {
            return;
        }
        let (blocks, bodies) = (&mut *self.rock.blocks, &*self.rock.bodies);
        blocks.apply_impulse(&bodies.loads_at_start, dt);
        for &b in &bodies.deformable {
            blocks.apply_stretch(b, bodies.stretches_at_start[b], dt);
        }
    }

    /// Finds water around grains, its porosity and their flux, `over` (s) after the last time at the end of a step.
    fn find_grains(&mut self, fluid: &mut Fluid, over: f64) {
        let Some(grains) = &mut *self.grains else {
            return;
        };
        grains.find(fluid, (self.rock.blocks, self.rock.are_held()), over);
        self.rock.progress.ledger.compress(grains.take_compressed());
        self.summed();
    }

    fn book_walls(&mut self, fluid: &Fluid, dt: f64) {
        if self.rock.are_held() {
            return;
        }
        let (blocks, ledger) = (&*self.rock.blocks, &mut self.rock.progress.ledger);
        if let Some(walls) = &*self.walls {
            ledger.book_walls(walls, blocks, dt);
        }
        ledger.book_joints(self.joints, blocks, dt);
        if let Some(grains) = &*self.grains {
            ledger.book_grains(grains, fluid, blocks, dt);
        }
    }
}

impl Boundary for Coupler<'_> {
    type Error = Stopped;

    fn advance(&mut self, part: Part, dt: f64) -> Result<(), Stopped> {
        let (from, of_blocks) = match part {
            Part::Whole => (self.time(), self.of_blocks),
            Part::FirstHalf => (self.time(), self.of_blocks.in_half()),
            Part::SecondHalf => (self.time() + dt, self.of_blocks.in_half()),
        };
        if part != Part::SecondHalf
            && let Some(walls) = &mut *self.walls
        {
            walls.record_start(self.rock.blocks);
        }
        self.searched();
        let in_walls = match (&self.walls, &self.grains) {
            (None, None) => InWalls::No,
            _ => InWalls::Yes,
        };
        let advanced = self.rock.advance(from, dt, of_blocks, in_walls);
        self.block_steps_taken += advanced.map_err(Stopped::Step)?;
        if part == Part::FirstHalf {
            // the fluid half way has received the impulse of half a step, and so must the blocks there, or a
            // light block in water would be integrated by forward Euler
            self.apply_loads_at_start(dt);
            self.in_advance = Some(dt);
        }
        Ok(())
    }

    fn exchange(&mut self, fluid: &mut Fluid, dt: f64) -> Result<(), Stopped> {
        let passed = self.openings.exchange(fluid, self.time() + dt, dt)?;
        self.rock.progress.ledger.exchange(&passed);
        Ok(())
    }

    fn escaped(&mut self, count: u64) -> Result<(), Stopped> {
        match self.rock.bodies.out_of_domain {
            OutOfDomain::Remove => Ok(()),
            OutOfDomain::Fail => Err(Stopped::Step(StepError::Left {
                time: self.time(),
                step: self.rock.progress.clock.steps,
                count,
                what: "particles",
            })),
        }
    }

    fn place(&mut self, fluid: &mut Fluid, stage: Stage, dt: f64) {
        let is_free = !self.rock.are_held();
        if stage == Stage::End {
            let lost = fluid.watch_rest(dt, movable(self.rock.blocks));
            self.rock.progress.ledger.put_to_sleep(&lost);
            self.ended(Phase::Neighbors);
        }
        if stage != Stage::Midpoint {
            self.interface.find(fluid, self.rock.blocks);
        }
        if stage == Stage::End {
            self.stop_on_the_way(fluid, dt);
            self.stop_penetrations(fluid);
            self.relieve_crushed(fluid);
        }
        if let Some(walls) = &mut *self.walls {
            match stage {
                Stage::Midpoint if is_free => walls.place_half_way(self.rock.blocks, dt),
                Stage::Midpoint => {}
                Stage::Predicted | Stage::End => {
                    walls.place_at_end(self.rock.blocks, is_free.then_some(dt));
                }
            }
            walls.find(fluid);
        }
        self.searched();
        if stage == Stage::Midpoint {
            self.find_grains(fluid, 0.0);
        }
    }

    fn find(&mut self, fluid: &mut Fluid) {
        self.interface.find(fluid, self.rock.blocks);
        if let Some(walls) = &mut *self.walls {
            walls.find(fluid);
        }
        self.searched();
    }

    fn hold(&mut self, fluid: &mut Fluid, stage: Stage, dt: f64) {
        if let Some(grains) = &mut *self.grains {
            grains.set_step(fluid, dt);
            self.find_grains(fluid, dt);
        }
        let imposed = self.openings.hold(fluid, self.time() + dt);
        // not booked half way: the corrector starts again from the start
        if stage == Stage::End {
            self.rock.progress.ledger.exchange(&imposed);
        }
    }

    fn density_rates(&mut self, fluid: &mut Fluid) {
        if let Some(walls) = &mut *self.walls {
            walls.add_rates(fluid);
        }
        self.summed();
    }

    fn concentration(&mut self, fluid: &mut Fluid) {
        if let Some(walls) = &mut *self.walls {
            walls.add_concentrations(fluid);
        }
    }

    fn continue_pressure(&mut self, fluid: &mut Fluid) {
        if let Some(walls) = &mut *self.walls {
            walls.extrapolate(fluid, movers(&self.rock, self.interface));
        }
        self.summed();
    }

    fn strain_rates(&mut self, fluid: &mut Fluid) {
        if let Some(walls) = &mut *self.walls {
            walls.add_strains(fluid);
        }
    }

    fn solve_motion(&mut self, fluid: &mut Fluid) {
        if let (Some(walls), Some(movers)) = (&mut *self.walls, movers(&self.rock, self.interface))
        {
            walls.solve_added_mass(fluid, movers);
        }
        self.summed();
    }

    fn forces(&mut self, fluid: &mut Fluid) {
        let (held, time) = (self.rock.are_held(), self.time());
        let blocks = &*self.rock.blocks;
        self.interface.update_forces(fluid, blocks, held);
        fluid.add_forces(self.interface.particle_forces());
        if let Some(walls) = &mut *self.walls {
            walls.add_forces(fluid, blocks);
            self.interface.add_loads(walls.loads());
            let accounts = &mut self.rock.bodies.accounts;
            look_at_fixed(accounts, walls, (fluid, blocks));
        }
        if !held {
            self.joints.update(fluid, blocks, time);
            self.interface.add_pressures(self.joints.loads());
        }
        self.summed();
    }

    fn share(&mut self, fluid: &mut Fluid) {
        let Some(grains) = &mut *self.grains else {
            return;
        };
        let held = self.rock.are_held();
        grains.update(fluid, self.rock.blocks, (&self.rock.bodies.dry, held));
        for (block, on_grain) in grains.forces() {
            self.interface
                .add_force(block, on_grain.total(), on_grain.drag);
        }
        self.summed();
    }

    fn resistance(&mut self, fluid: &mut Fluid) {
        if let Some(walls) = &mut *self.walls {
            walls.add_resistance(fluid);
        }
        fluid.hold_in_viscous_step(self.openings.held());
    }

    fn drag(&mut self, fluid: &mut Fluid) {
        if let Some(walls) = &mut *self.walls {
            let blocks = &*self.rock.blocks;
            self.interface.add_loads(walls.add_drag(fluid, blocks));
            let accounts = &mut self.rock.bodies.accounts;
            look_at_fixed(accounts, walls, (fluid, blocks));
        }
        self.summed();
    }

    fn begin_kick(&mut self, fluid: &mut Fluid, dt: f64) {
        if let Some(half) = self.in_advance.take() {
            self.apply_loads_at_start(-half);
        }
        let holding = Holding {
            interface: &*self.interface,
            walls: self.walls.as_ref(),
            joints: &*self.joints,
            blocks: &*self.rock.blocks,
        };
        self.rock.progress.ledger.book(fluid, &holding, dt);
        self.book_walls(fluid, 0.5 * dt);
    }

    fn end_kick(&mut self, fluid: &mut Fluid, dt: f64) {
        let imposed = self.openings.hold_velocities(fluid);
        self.rock.progress.ledger.exchange(&imposed);
        if !self.rock.are_held() {
            let BlockPhase { blocks, bodies, .. } = &mut self.rock;
            blocks.apply_impulse(self.interface.loads(), dt);
            for &b in &bodies.deformable {
                blocks.apply_stretch(b, self.interface.stretches()[b], dt);
            }
            for account in &mut bodies.accounts {
                account.book(self.interface, self.joints, dt);
            }
        }
        self.book_walls(fluid, 0.5 * dt);
    }

    fn predicted(&mut self, fluid: &mut Fluid) {
        let bodies = &mut *self.rock.bodies;
        bodies.loads_at_start.clear();
        bodies
            .loads_at_start
            .extend_from_slice(self.interface.loads());
        bodies.stretches_at_start.clear();
        bodies
            .stretches_at_start
            .extend_from_slice(self.interface.stretches());
        // not booked: the corrector starts again from the start
        self.openings.hold_velocities(fluid);
    }

    fn ended(&mut self, phase: Phase) {
        let phases = &mut self.rock.progress.phases;
        let time = match phase {
            Phase::Neighbors => &mut phases.neighbors,
            Phase::Density => &mut phases.density,
            Phase::Forces => &mut phases.forces,
            Phase::Integration => &mut phases.integration,
        };
        *time += self.rock.watch.lap();
    }
}

/// Blocks that the fluid may move; empty while they are held.
fn movers<'a>(rock: &'a BlockPhase, interface: &Interface) -> Option<Movers<'a>> {
    (!rock.are_held()).then_some(Movers {
        blocks: &*rock.blocks,
        dry: &rock.bodies.dry,
        slab_axis: interface.slab_axis(),
    })
}
