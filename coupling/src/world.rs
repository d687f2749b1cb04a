//! Blocks and water at one time, and the step that takes both to the next.

mod checkpoint;
pub mod ground;
mod intruders;
pub mod ledger;
mod stepping;
pub mod time_step;

use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

use nalgebra::Matrix3;
use riprap_dda::{Blocks, Load, Motion, Phase};
use riprap_sph::{Absorber, Fluid, FluidError, Sleeping, Stepping, SymmetryPlane, Vec3};

use crate::joints::JointWater;
use crate::openings::Openings;
use crate::series::Series;
use crate::walls::Walls;
use crate::walls::added_mass::{Acceleration, Movers};
use crate::walls::penalty::{Interface, WallSettings};
use crate::world::ledger::Ledger;
use crate::world::time_step::{Cause, Limits, TimeStep};

/// Distance below which a block touches a plane of symmetry, over the size of the domain: digits that a user types.
pub(crate) const TOUCH: f64 = 1e-9;

/// Everything that changes during a run. Only [`World::step`] and [`World::settle_step`] change it.
#[derive(Debug)]
pub struct World {
    /// The blocks; without any, an empty system that does nothing.
    pub blocks: Blocks,
    /// The fluid and its walls; absent when the scene has no fluid.
    pub water: Option<Water>,
    /// Gravity; m/s².
    pub gravity: Vec3,
    /// Box that blocks may not leave; m.
    pub(crate) domain: (Vec3, Vec3),
    pub(crate) clock: Clock,
    pub(crate) ledger: Ledger,
    pub(crate) held: Held,
    pub(crate) extremes: Extremes,
    pub(crate) phases: PhaseTimes,
    /// Blocks that move and are to stay clear of planes of symmetry.
    kept_clear: Vec<usize>,
    /// Scratch: loads of the fluid at the start of a predictor-corrector step.
    loads_at_start: Vec<Load>,
    /// Generalized strain forces on deformable blocks at the start.
    stretches_at_start: Vec<Matrix3<f64>>,
    /// Blocks that deform.
    deformable: Vec<usize>,
    /// Acceleration of each block without the fluid, over its last sub-steps.
    pub(crate) dry: Vec<Acceleration>,
    out_of_domain: OutOfDomain,
    weakenings: Vec<Weakening>,
    /// Fluid impulses on the blocks with accounts.
    accounts: Vec<(usize, FluidImpulses)>,
}

/// Impulses of the fluid on a block since accounts of it are kept, moments about its centroid; N s, N m s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FluidImpulses {
    /// Of pressure.
    pub pressure: Load,
    /// Of viscosity.
    pub shear: Load,
    /// Of water in joints too narrow for particles.
    pub joint_water: Load,
    /// Of particles that were put back.
    pub pushed_back: Load,
}

/// The fluid with the walls that hold it.
#[derive(Debug)]
pub struct Water {
    /// Particles.
    pub fluid: Fluid,
    /// Penalty walls; where others hold the fluid, only what keeps particles out of solids.
    pub interface: Interface,
    /// Walls of particles or integrals.
    pub walls: Option<Walls>,
    /// Water in joints too narrow for particles.
    pub joints: JointWater,
    /// Inflows and outflows.
    pub openings: Openings,
    /// Layers that damp waves.
    absorbers: Vec<Absorber>,
    /// Criteria of sleep of the fluid, if enabled.
    sleeping: Option<Sleeping>,
}

/// The fluid with what its walls are made of.
#[derive(Debug)]
pub struct WaterAtStart {
    /// Particles.
    pub fluid: Fluid,
    /// Numbers of penalty walls, or of what only keeps particles out of solids.
    pub penalty: WallSettings,
    /// Walls of particles or integrals.
    pub walls: Option<Walls>,
    /// Water in joints too narrow for particles.
    pub joints: JointWater,
    /// Inflows and outflows.
    pub openings: Openings,
    /// Layers that damp waves.
    pub absorbers: Vec<Absorber>,
    /// Criteria of sleep of the fluid, if enabled.
    pub sleeping: Option<Sleeping>,
}

/// Fate of a particle or block that leaves the domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutOfDomain {
    /// It is removed and counted; its mass, momentum and energy are booked as removed.
    Remove,
    /// The step fails with an error that names it.
    Fail,
}

/// A joint that weakens.
#[derive(Clone, Debug, PartialEq)]
pub struct Weakening {
    /// Numbers of its two materials.
    pub materials: (usize, usize),
    /// Share of the tangent of its friction angles over time.
    pub friction: Series,
    /// Share of its cohesions over time.
    pub cohesion: Series,
}

/// Time and steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    /// Simulated time; s.
    pub time: f64,
    /// Steps taken.
    pub steps: u64,
    /// Steps of the blocks inside them.
    pub block_substeps: u64,
    /// Size of the last step; s.
    pub last_dt: Option<f64>,
}

/// Selection of blocks held in place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Held {
    /// None: a run.
    NoBlock,
    /// All: settling.
    AllBlocks,
}

/// Running extremes and counts of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Extremes {
    /// Largest particle speed over sound speed.
    pub max_mach: f64,
    /// Deepest particle inside a solid, over the spacing.
    pub max_wall_penetration_over_spacing: f64,
    /// Particles found inside a solid and pushed back.
    pub particles_pushed_back: u64,
    /// Blocks that left the domain.
    pub blocks_removed: u64,
    /// Ordered neighbor pairs summed over all steps.
    pub pair_interactions: u64,
    /// Particles that sums were made for, summed over all steps.
    pub particle_steps: u64,
    /// Particles that were awake, summed over all steps.
    pub particle_steps_awake: u64,
    /// All particles, summed over all steps.
    pub particle_steps_of_all: u64,
}

/// Wall time by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseTimes {
    /// Sorting and neighbor search.
    pub neighbors: Duration,
    /// Densities and pressures.
    pub density: Duration,
    /// Pair forces in the fluid.
    pub forces: Duration,
    /// Blocks: which pairs may touch.
    pub broad_phase: Duration,
    /// Blocks: narrow phase with the contact law, which share a loop, and the sums for each block.
    pub contacts: Duration,
    /// Placement of walls, and search of particles near them.
    pub wall_search: Duration,
    /// Sums and forces between particles and blocks.
    pub coupling: Duration,
    /// Kicks and drifts of both media, step limits.
    pub integration: Duration,
}

/// Failure of a step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// In the fluid.
    #[error("at t = {time:.6} s, step {step}: {source}")]
    Fluid {
        /// s.
        time: f64,
        /// Number of the step.
        step: u64,
        /// Error of the solver.
        source: FluidError,
    },
    /// Among the blocks.
    #[error("at t = {time:.6} s, step {step}: {source}")]
    Blocks {
        /// s.
        time: f64,
        /// Number of the step.
        step: u64,
        /// Error of the solver.
        source: riprap_dda::StepError,
    },
    /// Something left the domain of a scene in which nothing may.
    #[error(
        "at t = {time:.6} s, step {step}: {count} {what} left the domain; enlarge `domain`, close it with walls, or set `domain.leaving` to Removed"
    )]
    Left {
        /// s.
        time: f64,
        /// Number of the step.
        step: u64,
        /// Number.
        count: u64,
        /// Particles or blocks.
        what: &'static str,
    },
    /// A moving block came to a plane of symmetry, where it would meet its mirror image.
    #[error(
        "at t = {time:.6} s, step {step}: block {block} came to the plane of symmetry across axis {axis}, where it \
         would meet its mirror image; move the plane away or model the whole"
    )]
    AtPlane {
        /// s.
        time: f64,
        /// Number of the step.
        step: u64,
        /// Number of the block.
        block: usize,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// A particle has no place or no velocity any more.
    #[error(
        "at t = {time:.6} s, step {step}: particle {id} has a velocity that is no number; look where it was in the last frame, and shorten the step with `numerics.time_step_factor`"
    )]
    NoVelocity {
        /// s.
        time: f64,
        /// Number of the step.
        step: u64,
        /// Id of the particle.
        id: u32,
    },
    /// Faster than sound: the fluid is stiff no longer.
    #[error(
        "at t = {time:.6} s, step {step}: particle {id} near ({:.4}, {:.4}, {:.4}) moves at {speed:.4} m/s, and sound at {sound_speed:.4} m/s; raise `numerics.sound_speed`, shorten the step with `numerics.time_step_factor`, or look what hits the water there",
        at[0], at[1], at[2]
    )]
    Supersonic {
        /// s.
        time: f64,
        /// Number of the step.
        step: u64,
        /// Id of the particle.
        id: u32,
        /// m.
        at: [f64; 3],
        /// m/s.
        speed: f64,
        /// m/s.
        sound_speed: f64,
    },
    /// Energy came from nowhere.
    #[error(
        "at t = {time:.6} s, step {step}: {gained:.4e} J came from nowhere within {steps} steps, where all that moved or was strained had {before:.4e} J; shorten the step with `numerics.time_step_factor`, lower `contact_stiffness` of the materials, or look for blocks and water that start inside each other"
    )]
    EnergyFromNowhere {
        /// s.
        time: f64,
        /// Number of the step.
        step: u64,
        /// J.
        gained: f64,
        /// J.
        before: f64,
        /// Steps that it took.
        steps: u64,
    },
    /// Water left the domain in masses.
    #[error(
        "at t = {time:.6} s, step {step}: {count} particles left the domain within {steps} steps, and {left} are left; close `domain` with walls or enlarge it"
    )]
    Drained {
        /// s.
        time: f64,
        /// Number of the step.
        step: u64,
        /// Number.
        count: u64,
        /// Number remaining.
        left: usize,
        /// Steps that it took.
        steps: u64,
    },
    /// A step too small to get anywhere.
    #[error(
        "at t = {time:.6} s, step {step}: the step fell to {dt:e} s, limited by {cause:?}; {remedy}"
    )]
    Stalled {
        /// s.
        time: f64,
        /// Number of the step.
        step: u64,
        /// s.
        dt: f64,
        /// Governing limit.
        cause: Cause,
        /// Remedy.
        remedy: &'static str,
    },
}

impl StepError {
    /// Whether a shorter step may help.
    pub fn is_of_the_step(&self) -> bool {
        match self {
            Self::Fluid { .. }
            | Self::Blocks { .. }
            | Self::NoVelocity { .. }
            | Self::Supersonic { .. }
            | Self::EnergyFromNowhere { .. } => true,
            Self::Drained { .. }
            | Self::Left { .. }
            | Self::AtPlane { .. }
            | Self::Stalled { .. } => false,
        }
    }
}

/// Largest speed of a particle over that of sound.
const LARGEST_MACH: f64 = 1.0;

/// The part of the duration below which a step is refused.
const SMALLEST_STEP_SHARE: f64 = 1e-9;

impl World {
    /// A world at time zero, with all forces evaluated.
    ///
    /// # Errors
    ///
    /// [`StepError`] when the very first evaluation fails.
    pub fn new(
        blocks: Blocks,
        fluid: Option<WaterAtStart>,
        gravity: Vec3,
        domain: (Vec3, Vec3),
    ) -> Result<Self, StepError> {
        let water = match fluid {
            None => None,
            Some(start) => {
                let WaterAtStart {
                    mut fluid,
                    penalty,
                    walls,
                    joints,
                    openings,
                    absorbers,
                    sleeping,
                } = start;
                openings
                    .fill(&mut fluid)
                    .map_err(|source| StepError::Fluid {
                        time: 0.0,
                        step: 0,
                        source,
                    })?;
                fluid.refresh();
                Some(Water {
                    interface: Interface::new(penalty, &blocks, &fluid),
                    fluid,
                    walls,
                    joints,
                    openings,
                    absorbers,
                    sleeping,
                })
            }
        };
        let n_blocks = blocks.n_blocks();
        let mut world = Self {
            blocks,
            water,
            gravity,
            domain,
            clock: Clock::default(),
            ledger: Ledger::default(),
            held: Held::NoBlock,
            extremes: Extremes::default(),
            phases: PhaseTimes::default(),
            kept_clear: Vec::new(),
            loads_at_start: vec![Load::default(); n_blocks],
            stretches_at_start: vec![Matrix3::zeros(); n_blocks],
            deformable: Vec::new(),
            dry: Vec::new(),
            out_of_domain: OutOfDomain::Remove,
            weakenings: Vec::new(),
            accounts: Vec::new(),
        };
        if world.symmetry_planes().next().is_some() {
            // what touches a plane from the start was found to move along it
            let touch = TOUCH * (world.domain.1 - world.domain.0).norm();
            world.kept_clear = (0..n_blocks)
                .filter(|&b| !world.is_fixed(b) && world.plane_within(b, touch).is_none())
                .collect();
        }
        world.deformable = (0..n_blocks)
            .filter(|&b| world.blocks.is_free(b) && world.blocks.is_deformable(b))
            .collect();
        let starting = |b: usize| Acceleration {
            linear: gravity + world.blocks.contact_force(b).force / world.blocks.mass(b),
            angular: Vec3::zeros(),
        };
        world.dry = (0..n_blocks).map(starting).collect();
        world.evaluate_fluid(0.0)?;
        world.open_ledger();
        Ok(world)
    }

    /// Sets the fate of particles and blocks that leave the domain.
    pub fn set_out_of_domain(&mut self, fate: OutOfDomain) {
        self.out_of_domain = fate;
    }

    /// Lets joints weaken as time goes on.
    pub fn set_weakenings(&mut self, weakenings: Vec<Weakening>) {
        self.weakenings = weakenings;
        self.weaken();
    }

    pub(crate) fn weaken(&mut self) {
        let time = self.clock.time;
        for weakening in &self.weakenings {
            let shares = (weakening.friction.at(time), weakening.cohesion.at(time));
            self.blocks.weaken(weakening.materials, shares.0, shares.1);
        }
    }

    /// Keeps accounts of what moves some blocks, source by source, from now on.
    pub fn keep_accounts(&mut self, blocks: &[usize]) {
        self.blocks.keep_accounts(blocks);
        self.accounts = blocks
            .iter()
            .map(|&b| (b, FluidImpulses::default()))
            .collect();
    }

    /// Fluid impulse on a block since its accounts were opened; zero without accounts.
    pub fn fluid_impulses(&self, block: usize) -> FluidImpulses {
        let found = self.accounts.iter().find(|(b, _)| *b == block);
        found.map_or_else(FluidImpulses::default, |(_, impulses)| *impulses)
    }

    /// Simulated time; s.
    pub fn time(&self) -> f64 {
        self.clock.time
    }

    /// Time and steps.
    pub fn clock(&self) -> Clock {
        self.clock
    }

    /// Running extremes and counts.
    pub fn extremes(&self) -> Extremes {
        self.extremes
    }

    /// Wall time by phase.
    pub fn phases(&self) -> PhaseTimes {
        self.phases
    }

    /// Limits of the step at the present state.
    pub fn limits(&self) -> Limits {
        let mut common = Vec::with_capacity(4);
        if let Some(water) = &self.water {
            let fluid = water.fluid.step_limits();
            common.push((Cause::Sound, fluid.sound));
            common.push((Cause::Viscosity, fluid.viscosity));
            common.push((Cause::Force, fluid.force));
            let wall = water
                .interface
                .critical_time_step(water.fluid.particle_mass());
            common.push((Cause::Wall, wall));
        }
        Limits {
            common,
            blocks: self.blocks.critical_time_step().dt,
        }
    }

    /// Steps that sound and blocks would bear at the present state before they grow, where the limits above are safe; s.
    /// Many times the work of [`Self::limits`].
    pub fn stability(&self) -> Vec<(Cause, f64)> {
        let mut borne = Vec::new();
        if let Some(water) = &self.water {
            let settings = water.fluid.settings();
            let flow = settings.sound_speed + water.fluid.max_speed();
            let sound = settings.sound_stability();
            borne.extend(sound.map(|dt| (Cause::Sound, dt * settings.sound_speed / flow)));
        }
        let blocks = self.blocks.stability_limit();
        borne.extend((blocks < f64::INFINITY).then_some((Cause::Contact, blocks)));
        borne
    }

    /// The step that the state asks for; without fluid at most a thousandth of `duration` (s).
    ///
    /// # Errors
    ///
    /// [`StepError::Stalled`] when it is too small to get anywhere.
    pub fn next_step(&self, duration: f64) -> Result<TimeStep, StepError> {
        self.next_step_within(duration, 1.0)
    }

    /// The same, within a share of the limits of blocks and water.
    ///
    /// # Errors
    ///
    /// As [`Self::next_step`].
    pub fn next_step_within(&self, duration: f64, share: f64) -> Result<TimeStep, StepError> {
        let limits = self.limits().within(share);
        let ceiling = 1e-3 * duration * share;
        let step = limits.choose(self.water.is_some(), self.clock.last_dt, ceiling);
        if step.dt < SMALLEST_STEP_SHARE * duration || step.dt.is_nan() {
            return Err(StepError::Stalled {
                time: self.clock.time,
                step: self.clock.steps,
                dt: step.dt,
                cause: step.cause,
                remedy: remedy(step.cause),
            });
        }
        Ok(step)
    }

    /// Takes blocks and fluid from `t` to `t + dt`.
    ///
    /// By the scheme's stepping; the blocks take their sub-steps across the step, and the fluid's forces
    /// reach them as impulses.
    ///
    /// # Errors
    ///
    /// [`StepError`] with the cause and what to change; the state is then that of the failed step.
    pub fn step(&mut self, step: TimeStep) -> Result<(), StepError> {
        let dt = step.dt;
        self.weaken();
        self.let_sleep()?;
        let block_substeps = self.advance(dt, step.block_substeps)?;
        if let Some(water) = &mut self.water {
            let absorbed = water.fluid.absorb(&water.absorbers, dt);
            self.ledger.absorb(&absorbed);
        }
        self.clock.time += dt;
        self.clock.steps += 1;
        self.clock.block_substeps += u64::from(block_substeps);
        self.clock.last_dt = Some(dt);
        self.note_extremes();
        self.check_speeds()
    }

    /// Lets the fluid sleep from the first step of a run on: settling is for all of it.
    fn let_sleep(&mut self) -> Result<(), StepError> {
        let Some(water) = &mut self.water else {
            return Ok(());
        };
        let Some(sleeping) = water.sleeping.filter(|_| !water.fluid.may_sleep()) else {
            return Ok(());
        };
        let laid = water.fluid.let_sleep(sleeping, movable(&self.blocks));
        let laid = laid.map_err(|source| StepError::Fluid {
            time: self.clock.time,
            step: self.clock.steps,
            source,
        })?;
        self.ledger.lay_to_rest(&laid);
        // what is awake feels what sleeps
        self.evaluate_fluid(0.0)
    }

    /// A step of the fluid alone, blocks held, velocities damped by `exp(−rate · dt)`.
    ///
    /// # Errors
    ///
    /// As [`Self::step`].
    pub fn settle_step(&mut self, dt: f64, rate: f64) -> Result<(), StepError> {
        self.held = Held::AllBlocks;
        self.advance(dt, 0)?;
        if let Some(water) = &mut self.water {
            water.fluid.damp((-rate * dt).exp());
        }
        self.clock.last_dt = Some(dt);
        self.check_speeds()
    }

    /// Ends settling: blocks are let go, the ledger and all counts start here.
    ///
    /// # Errors
    ///
    /// As [`Self::step`].
    pub fn release(&mut self) -> Result<(), StepError> {
        self.held = Held::NoBlock;
        self.extremes = Extremes::default();
        if let Some(water) = &mut self.water
            && water.sleeping.is_some()
        {
            // what sleeps is at rest, and what is left of settling is no part of the run
            water.fluid.damp(0.0);
        }
        self.evaluate_fluid(0.0)?;
        self.open_ledger();
        Ok(())
    }

    /// A kick of everything, of the fluid by `kick`, and its entries in the ledger.
    fn kick(&mut self, dt: f64, kick: impl FnOnce(&mut Fluid, f64)) {
        let start = Instant::now();
        let mut ledger = std::mem::take(&mut self.ledger);
        ledger.book(self, dt);
        self.ledger = ledger;
        self.book_walls(0.5 * dt);
        if let Some(water) = &mut self.water {
            kick(&mut water.fluid, dt);
            let imposed = water.openings.hold_velocities(&mut water.fluid);
            self.ledger.exchange(&imposed);
            if self.held == Held::NoBlock {
                self.blocks.apply_impulse(water.interface.loads(), dt);
                for &b in &self.deformable {
                    let stretch = water.interface.stretches()[b];
                    self.blocks.apply_stretch(b, stretch, dt);
                }
                for (b, impulses) in &mut self.accounts {
                    if !self.blocks.is_free(*b) {
                        continue;
                    }
                    let (all, shear) = (water.interface.loads()[*b], water.interface.shears()[*b]);
                    let joint = water.interface.in_plane(water.joints.loads()[*b]);
                    let pressure = Load {
                        force: all.force - shear.force - joint.force,
                        torque: all.torque - shear.torque - joint.torque,
                    };
                    impulses.pressure += pressure.times(dt);
                    impulses.shear += shear.times(dt);
                    impulses.joint_water += joint.times(dt);
                }
            }
        }
        self.book_walls(0.5 * dt);
        self.phases.integration += start.elapsed();
    }

    fn book_walls(&mut self, dt: f64) {
        let Some(water) = self.water.as_ref().filter(|_| self.held == Held::NoBlock) else {
            return;
        };
        if let Some(walls) = &water.walls {
            self.ledger.book_walls(walls, &self.blocks, dt);
        }
        self.ledger.book_joints(&water.joints, &self.blocks, dt);
    }

    fn note_walls(&mut self) {
        let mut watch = Stopwatch::start();
        if let Some(walls) = self.water.as_mut().and_then(|water| water.walls.as_mut()) {
            walls.note_start(&self.blocks);
        }
        self.phases.wall_search += watch.lap();
    }

    /// Takes the fluid's positions to the end of the step, and its density too where that is advanced: half
    /// way, with the walls where they are then.
    fn advance_fluid(&mut self, dt: f64) -> Result<(), StepError> {
        let mut watch = Stopwatch::start();
        let Some(water) = &mut self.water else {
            return Ok(());
        };
        if !water.fluid.advances_density() {
            water.fluid.drift(dt);
            self.phases.integration += watch.lap();
            return Ok(());
        }
        water.fluid.drift(0.5 * dt);
        self.phases.integration += watch.lap();
        self.refresh_fluid()?;
        self.phases.neighbors += watch.lap();
        let Some(water) = &mut self.water else {
            return Ok(());
        };
        if let Some(walls) = &mut water.walls {
            if self.held == Held::NoBlock {
                walls.place_half_way(&self.blocks, dt);
            }
            walls.find(&mut water.fluid);
        }
        self.phases.wall_search += watch.lap();
        water.fluid.update_rates();
        self.phases.density += watch.lap();
        if let Some(walls) = &mut water.walls {
            walls.add_rates(&mut water.fluid);
        }
        self.phases.coupling += watch.lap();
        water.fluid.advance_density(dt);
        self.phases.density += watch.lap();
        water.fluid.drift(0.5 * dt);
        self.phases.integration += watch.lap();
        Ok(())
    }

    /// Sorts the fluid where it has moved far enough; what left the domain is removed.
    fn refresh_fluid(&mut self) -> Result<(), StepError> {
        let Some(water) = &mut self.water else {
            return Ok(());
        };
        let escaped = water.fluid.refresh();
        if escaped > 0 && self.out_of_domain == OutOfDomain::Fail {
            return Err(StepError::Left {
                time: self.clock.time,
                step: self.clock.steps,
                count: escaped,
                what: "particles",
            });
        }
        Ok(())
    }

    /// Takes the blocks on by `dt` from a time, where they are not held.
    fn advance_blocks(&mut self, from: f64, dt: f64, n_substeps: u32) -> Result<(), StepError> {
        if self.held == Held::AllBlocks {
            return Ok(());
        }
        let mut watch = Stopwatch::start();
        let with_walls = self.water.as_ref().is_some_and(|w| w.walls.is_some());
        if with_walls {
            for (b, dry) in self.dry.iter_mut().enumerate() {
                *dry = Acceleration {
                    linear: self.blocks.velocity(b),
                    angular: self.blocks.angular_velocity(b),
                };
            }
        }
        let Self { blocks, phases, .. } = self;
        let mut ended = |phase| {
            let time = match phase {
                Phase::Motion => &mut phases.integration,
                Phase::BroadPhase => &mut phases.broad_phase,
                Phase::Contacts | Phase::Sums => &mut phases.contacts,
            };
            *time += watch.lap();
        };
        let advanced = blocks.advance_watched(from, dt, n_substeps, &mut ended);
        advanced.map_err(|source| StepError::Blocks {
            time: self.clock.time,
            step: self.clock.steps,
            source,
        })?;
        if with_walls {
            for (b, dry) in self.dry.iter_mut().enumerate() {
                *dry = Acceleration {
                    linear: (self.blocks.velocity(b) - dry.linear) / dt,
                    angular: (self.blocks.angular_velocity(b) - dry.angular) / dt,
                };
            }
        }
        let before = self.extremes.blocks_removed;
        self.remove_escaped_blocks();
        let count = self.extremes.blocks_removed - before;
        if count > 0 && self.out_of_domain == OutOfDomain::Fail {
            return Err(StepError::Left {
                time: self.clock.time,
                step: self.clock.steps,
                count,
                what: "blocks",
            });
        }
        self.check_planes()
    }

    fn symmetry_planes(&self) -> impl Iterator<Item = SymmetryPlane> + use<> {
        let water = self.water.as_ref();
        water
            .map(|water| water.fluid.settings().symmetry_planes())
            .into_iter()
            .flatten()
    }

    /// A plane of symmetry from which a block is less than a distance (m).
    fn plane_within(&self, block: usize, distance: f64) -> Option<SymmetryPlane> {
        self.symmetry_planes().find(|plane| {
            self.blocks.parts_of(block).any(|part| {
                let (min, max) = self.blocks.part_aabb(part);
                plane.distance(if plane.is_upper { &max } else { &min }) < distance
            })
        })
    }

    fn check_planes(&self) -> Result<(), StepError> {
        for &block in &self.kept_clear {
            if self.blocks.is_removed(block) {
                continue;
            }
            if let Some(plane) = self.plane_within(block, 0.0) {
                return Err(StepError::AtPlane {
                    time: self.clock.time,
                    step: self.clock.steps,
                    block,
                    axis: plane.axis,
                });
            }
        }
        Ok(())
    }

    /// Takes blocks whose centroid left the domain out of the run.
    fn remove_escaped_blocks(&mut self) {
        for block in 0..self.blocks.n_blocks() {
            if !self.blocks.is_free(block) {
                continue;
            }
            let x = self.blocks.centroid(block);
            let inside =
                (0..3).all(|axis| self.domain.0[axis] <= x[axis] && x[axis] <= self.domain.1[axis]);
            if !inside {
                let before = self.blocks.energies();
                let momentum = self.blocks.momentum();
                self.blocks.remove(block);
                let after = self.blocks.energies();
                self.ledger.removed_momentum += momentum - self.blocks.momentum();
                self.ledger.removed_energy += before.kinetic + before.potential + before.elastic
                    - after.kinetic
                    - after.potential
                    - after.elastic;
                self.extremes.blocks_removed += 1;
            }
        }
    }

    /// Everything that follows from the fluid's positions at the end of a step of `dt`: cells, walls,
    /// densities and pressures, accelerations.
    fn evaluate_fluid(&mut self, dt: f64) -> Result<(), StepError> {
        let (time, step) = (self.clock.time, self.clock.steps);
        let failed = |source| StepError::Fluid { time, step, source };
        let mut watch = Stopwatch::start();
        let end = time + dt;
        if let Some(water) = &mut self.water {
            let passed = water.openings.exchange(&mut water.fluid, end, dt);
            self.ledger.exchange(&passed.map_err(failed)?);
        }
        self.phases.integration += watch.lap();
        self.refresh_fluid()?;
        let held = self.held == Held::AllBlocks;
        let Some(water) = &mut self.water else {
            return Ok(());
        };
        let laid = water.fluid.watch_rest(dt, movable(&self.blocks));
        self.ledger.lay_to_rest(&laid);
        self.phases.neighbors += watch.lap();

        water.interface.find(&water.fluid, &self.blocks);
        self.hold_off_intruders();
        let Some(water) = &mut self.water else {
            return Ok(());
        };
        if let Some(walls) = &mut water.walls {
            walls.place_at_end(&self.blocks, (!held).then_some(dt));
            walls.find(&mut water.fluid);
        }
        self.phases.wall_search += watch.lap();

        if water.fluid.shifts() && 0.0 < dt {
            water.fluid.update_spread();
            if let Some(walls) = &mut water.walls {
                walls.add_spreads(&mut water.fluid);
            }
            water.fluid.shift(dt);
            water.fluid.refresh();
            self.phases.density += watch.lap();
            water.interface.find(&water.fluid, &self.blocks);
            if let Some(walls) = &mut water.walls {
                walls.find(&mut water.fluid);
            }
            self.phases.wall_search += watch.lap();
        }
        let imposed = water.openings.hold(&mut water.fluid, end);
        self.ledger.exchange(&imposed);
        self.phases.density += watch.lap();
        self.evaluate_forces()
    }

    /// Evaluates, from positions, velocities and densities with known neighbors, the rates of density if
    /// the stepping needs them here, pressures, accelerations and wall forces.
    fn evaluate_forces(&mut self) -> Result<(), StepError> {
        let (time, step) = (self.clock.time, self.clock.steps);
        let failed = |source| StepError::Fluid { time, step, source };
        let predicts = self.stepping() == Stepping::PredictorCorrector;
        let held = self.held == Held::AllBlocks;
        let mut watch = Stopwatch::start();
        let Some(water) = &mut self.water else {
            return Ok(());
        };
        if predicts && water.fluid.advances_density() {
            water.fluid.update_rates();
            if let Some(walls) = &mut water.walls {
                walls.add_rates(&mut water.fluid);
            }
        }
        water.fluid.update_pressure().map_err(failed)?;
        self.phases.density += watch.lap();
        let movers = (!held).then_some(Movers {
            blocks: &self.blocks,
            dry: &self.dry,
            slab_axis: water.interface.slab_axis(),
        });
        if let Some(walls) = &mut water.walls {
            walls.extrapolate(&water.fluid, movers);
        }
        self.phases.coupling += watch.lap();
        if water.fluid.varies_viscosity() {
            water.fluid.update_strain();
            if let Some(walls) = &mut water.walls {
                walls.add_strains(&mut water.fluid);
            }
            water.fluid.update_viscosity();
        }
        self.phases.forces += watch.lap();
        if let (Some(walls), Some(movers)) = (&mut water.walls, movers) {
            walls.let_move(&water.fluid, movers);
        }
        self.phases.coupling += watch.lap();
        water.fluid.update_accelerations();
        self.phases.forces += watch.lap();

        water
            .interface
            .update_forces(&water.fluid, &self.blocks, held);
        water.fluid.add_forces(water.interface.particle_forces());
        if let Some(walls) = &mut water.walls {
            walls.add_forces(&mut water.fluid, &self.blocks);
            water.interface.add_loads(walls.loads());
        }
        if !held {
            let time = self.clock.time;
            water.joints.update(&water.fluid, &self.blocks, time);
            water.interface.add_pressures(water.joints.loads());
        }
        self.phases.coupling += watch.lap();
        Ok(())
    }

    fn note_extremes(&mut self) {
        let Some(water) = &self.water else { return };
        let fluid = &water.fluid;
        let extremes = &mut self.extremes;
        let spacing = water.interface.settings().particle_spacing;
        let mach = fluid.max_speed() / fluid.settings().sound_speed;
        extremes.max_mach = extremes.max_mach.max(mach);
        for touch in water.interface.touches() {
            extremes.max_wall_penetration_over_spacing = extremes
                .max_wall_penetration_over_spacing
                .max(-touch.distance / spacing);
        }
        extremes.pair_interactions += fluid.n_pairs();
        extremes.particle_steps += fluid.n_receivers();
        extremes.particle_steps_awake += fluid.n_awake() as u64;
        extremes.particle_steps_of_all += fluid.particles().len() as u64;
    }

    /// Refuses velocities that no fluid has.
    fn check_speeds(&self) -> Result<(), StepError> {
        let Some(water) = &self.water else {
            return Ok(());
        };
        let (fluid, particles) = (&water.fluid, water.fluid.particles());
        let (time, step) = (self.clock.time, self.clock.steps);
        // the work of viscosity is a sum over all velocities: one that is no number makes it none
        if !fluid.viscous_loss().is_finite() {
            let is_bad = |v: &Vec3| !v.norm_squared().is_finite();
            let bad = particles.velocity.iter().position(is_bad);
            return Err(StepError::NoVelocity {
                time,
                step,
                id: bad.map_or(0, |a| particles.id[a]),
            });
        }
        let sound_speed = fluid.settings().sound_speed;
        if fluid.max_speed() <= LARGEST_MACH * sound_speed {
            return Ok(());
        }
        let speeds = particles.velocity.iter().map(|v| v.norm()).enumerate();
        let fastest = speeds.max_by(|a, b| a.1.total_cmp(&b.1));
        let (a, speed) = fastest.unwrap_or_default();
        Err(StepError::Supersonic {
            time,
            step,
            id: particles.id[a],
            at: particles.position[a].into(),
            speed,
            sound_speed,
        })
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
        matches!(self.blocks.motion(block), Motion::Fixed)
    }

    /// A hash of every number of the state: equal hashes, equal runs.
    pub fn state_hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&self.clock.time.to_le_bytes());
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

/// Boxes round the parts of blocks that may move; m.
fn movable(blocks: &Blocks) -> impl Iterator<Item = (Vec3, Vec3)> {
    let may_move = |&part: &usize| {
        let block = blocks.block_of_part(part);
        !matches!(blocks.motion(block), Motion::Fixed) && !blocks.is_removed(block)
    };
    (0..blocks.n_parts())
        .filter(may_move)
        .map(|part| blocks.part_aabb(part))
}

fn remedy(cause: Cause) -> &'static str {
    match cause {
        Cause::Sound => "lower `numerics.sound_speed` or coarsen `fluid.resolution`",
        Cause::Viscosity => {
            "lower `fluid.dynamic_viscosity`, `numerics.viscosity` or the regularization of `fluid.rheology`, or coarsen `fluid.resolution`"
        }
        Cause::Force => "something hits the water too hard: look at the last frame",
        Cause::Wall => "lower `interface.penalty_stiffness`",
        Cause::Contact => "lower `contact_stiffness` of the materials or remove slivers",
        Cause::Duration | Cause::Growth => "look at the last frame",
    }
}

/// Laps of wall time.
struct Stopwatch(Instant);

impl Stopwatch {
    fn start() -> Self {
        Self(Instant::now())
    }

    fn lap(&mut self) -> Duration {
        let now = Instant::now();
        let lap = now - self.0;
        self.0 = now;
        lap
    }
}
