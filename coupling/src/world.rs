//! Blocks and water at one time, and the step that takes both to the next.

pub mod accounts;
mod bodies;
mod checkpoint;
mod coupler;
mod error;
pub mod ground;
mod guards;
pub mod ledger;
mod penetrations;
pub(crate) mod pistons;
mod progress;
mod settling;
pub mod time_step;
mod water;
mod weakening;

use riprap_dda::{Blocks, Load};
use riprap_sph::{Stepping, Vec3};

use crate::world::bodies::{BlockPhase, Bodies, InWalls, movable};
use crate::world::pistons::AbsorbingPiston;
use crate::world::progress::{Progress, Stopwatch};
use crate::world::time_step::{BlockSteps, TimeStep};

pub use accounts::FluidImpulses;
pub use error::StepError;
pub use guards::Holder;
pub use progress::{Clock, Extremes, PhaseTimes};
pub use water::{Water, WaterBoundaries};
pub use weakening::Weakening;

/// Distance below which a block touches a plane of symmetry, over the size of the domain: digits that a user types.
pub(crate) const TOUCH: f64 = 1e-9;

/// Everything that changes during a run. Only [`World::step`] and the steps of settling change it.
#[derive(Debug)]
pub struct World {
    /// The blocks; without any, an empty system that does nothing.
    pub blocks: Blocks,
    /// The fluid and its walls; absent when the scene has no fluid.
    pub water: Option<Water>,
    /// Gravity; m/s².
    pub gravity: Vec3,
    pub(crate) progress: Progress,
    pub(crate) bodies: Bodies,
    weakenings: Vec<Weakening>,
    pistons: Vec<AbsorbingPiston>,
}

/// Numbers of a world that never change.
#[derive(Clone, Debug)]
pub struct WorldSettings {
    /// Acceleration of gravity; m/s².
    pub gravity: Vec3,
    /// Box that blocks may not leave; m.
    pub domain: (Vec3, Vec3),
    /// Treatment of particles and blocks that leave it.
    pub out_of_domain: OutOfDomain,
    /// Joints whose strength degrades with time.
    pub weakenings: Vec<Weakening>,
    /// Wave makers that absorb what comes back.
    pub pistons: Vec<AbsorbingPiston>,
}

/// Fate of a particle or block that leaves the domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutOfDomain {
    /// It is removed and counted; its mass, momentum and energy are booked as removed.
    Remove,
    /// The step fails with an error that names it.
    Fail,
}

impl World {
    /// A world at time zero, with all forces evaluated.
    ///
    /// # Errors
    ///
    /// [`StepError`] when the very first evaluation fails.
    pub fn new(
        blocks: Blocks,
        water: Option<Water>,
        settings: WorldSettings,
    ) -> Result<Self, StepError> {
        let WorldSettings {
            gravity,
            domain,
            out_of_domain,
            weakenings,
            pistons,
        } = settings;
        let planes = water
            .iter()
            .flat_map(|water| water.fluid.settings().symmetry_planes())
            .collect();
        let mut world = Self {
            bodies: Bodies::new(&blocks, planes, &gravity, (domain, out_of_domain)),
            blocks,
            water,
            gravity,
            progress: Progress::default(),
            weakenings,
            pistons,
        };
        world.evaluate()?;
        world.open_ledger();
        world.weaken();
        Ok(world)
    }

    /// Advances blocks and fluid by a step.
    ///
    /// ```text
    /// 1  joints weaken as their series say; water that is calm may fall asleep, from the first step of a run on; pistons that
    ///    absorb are steered by the surface before them
    /// 2  the fluid's step by its stepping (the list of its phases heads each file of `riprap_sph::stepping`); at its
    ///    places the coupler moves the blocks by their sub-steps, places walls, adds the walls' parts of rates and
    ///    forces, and gives the blocks the opposite of each kick. Without fluid: the blocks' sub-steps alone
    /// 3  absorbing layers damp waves
    /// 4  the clock ticks
    /// 5  guards: extremes are recorded, NaN and supersonic speeds refused
    /// ```
    ///
    /// # Errors
    ///
    /// [`StepError`] with the cause and what to change; the state is then that of the failed step.
    pub fn step(&mut self, step: TimeStep) -> Result<(), StepError> {
        let dt = step.dt;
        self.weaken();
        self.begin_sleep()?;
        self.steer_pistons(dt);
        let block_substeps = self.advance(self.time(), dt, step.of_blocks)?;
        if let Some(water) = &mut self.water {
            let absorbed = water.absorb(dt);
            self.progress.ledger.absorb(&absorbed);
        }
        self.progress.clock.tick(dt, block_substeps);
        self.record_extremes();
        self.check_speeds()
    }

    /// Advances the media from a time by `dt` (s); returns the steps that blocks took.
    fn advance(&mut self, from: f64, dt: f64, of_blocks: BlockSteps) -> Result<u32, StepError> {
        if self.water.is_some() {
            return self.coupled(of_blocks, |fluid, coupler| fluid.step(coupler, dt));
        }
        let mut rock = BlockPhase {
            blocks: &mut self.blocks,
            bodies: &mut self.bodies,
            progress: &mut self.progress,
            watch: Stopwatch::start(),
        };
        rock.advance(from, dt, of_blocks, InWalls::No)
    }

    fn steer_pistons(&mut self, dt: f64) {
        let Some(water) = &self.water else { return };
        for piston in &mut self.pistons {
            piston.steer(
                &water.fluid,
                &mut self.blocks,
                (self.progress.clock.time, dt),
            );
        }
    }

    /// Everything that follows from where fluid and blocks are now.
    fn evaluate(&mut self) -> Result<(), StepError> {
        self.coupled(BlockSteps::NONE, |fluid, coupler| {
            fluid.evaluate(coupler, 0.0)
        })?;
        Ok(())
    }

    /// Lets the fluid sleep from the first step of a run on: settling is for all of it.
    fn begin_sleep(&mut self) -> Result<(), StepError> {
        let Some(water) = &mut self.water else {
            return Ok(());
        };
        let Some(sleeping) = water.sleep_to_begin() else {
            return Ok(());
        };
        let lost = water.fluid.let_sleep(sleeping, movable(&self.blocks));
        let lost = lost.map_err(|source| StepError::Fluid {
            time: self.progress.clock.time,
            step: self.progress.clock.steps,
            source,
        })?;
        self.progress.ledger.put_to_sleep(&lost);
        // sleeping water acts on awake water
        self.evaluate()
    }

    /// Stepping of the fluid; kick-drift-kick for blocks alone.
    pub fn stepping(&self) -> Stepping {
        self.water
            .as_ref()
            .map_or(Stepping::KickDriftKick, |water| {
                water.fluid.settings().scheme.stepping
            })
    }

    /// Records the impulses on some blocks by source, from now on or from before.
    pub fn keep_accounts(&mut self, blocks: &[usize]) {
        self.blocks.keep_accounts(blocks);
        self.bodies.keep_accounts(blocks);
    }

    /// Impulses of the fluid on a block since its accounts were opened; zero without accounts.
    pub fn fluid_impulses(&self, block: usize) -> FluidImpulses {
        let accounts = &self.bodies.accounts;
        let found = accounts.binary_search_by_key(&block, |account| account.block);
        found.map_or_else(|_| FluidImpulses::default(), |k| accounts[k].impulses)
    }

    /// Simulated time; s.
    pub fn time(&self) -> f64 {
        self.progress.clock.time
    }

    /// Box that blocks may not leave; m.
    pub fn domain(&self) -> (Vec3, Vec3) {
        self.bodies.domain
    }

    /// Time and steps.
    pub fn clock(&self) -> Clock {
        self.progress.clock
    }

    /// Running extremes and counts.
    pub fn extremes(&self) -> Extremes {
        self.progress.extremes
    }

    /// Wall time by phase.
    pub fn phases(&self) -> PhaseTimes {
        self.progress.phases
    }

    /// Force and moment of the fluid on a block; N, N m about the centroid. That on a fixed block in walls of
    /// particles is summed when asked for.
    pub fn fluid_load(&self, block: usize) -> Load {
        let Some(water) = &self.water else {
            return Load::default();
        };
        let mut load = water.interface.loads()[block];
        if let Some(walls) = &water.walls
            && self.is_fixed(block)
        {
            let more = walls.load_on_fixed(&water.fluid, &self.blocks, block);
            let more = water.interface.in_plane(more);
            load.force += more.force;
            load.torque += more.torque;
        }
        load
    }

    /// Whether a block never moves.
    pub fn is_fixed(&self, block: usize) -> bool {
        self.blocks.is_fixed(block)
    }

    /// A hash of every number of the state: equal hashes, equal runs.
    pub fn state_hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&self.progress.clock.time.to_le_bytes());
        if let Some(water) = &self.water {
            water.fluid.visit_state(|x| {
                hasher.update(&x.to_le_bytes());
            });
        }
        self.blocks.for_each_state_f64(&mut |x| {
            hasher.update(&x.to_le_bytes());
        });
        hasher.finalize().to_hex()[..16].to_string()
    }
}
