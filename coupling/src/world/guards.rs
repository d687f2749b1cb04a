//! Guards of a step: its limits, and states that no step may leave behind.

use riprap_dda::Integrator;
use riprap_sph::{ParticleId, Particles, Vec3};

use crate::world::time_step::{Cause, Limits, TimeStep};
use crate::world::{StepError, World};

/// Largest speed of a particle over that of sound.
const LARGEST_MACH: f64 = 1.0;

/// Share of a block's change of velocity that water before it takes within a step of the block.
const LARGEST_RADIATION: f64 = 0.5;

/// The part of the duration below which a step is refused.
const SMALLEST_STEP_SHARE: f64 = 1e-9;

/// A particle or block that sets a limit of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Holder {
    /// A particle, and where it is; m.
    Particle(ParticleId, Vec3),
    /// A block by its number.
    Block(usize),
}

impl World {
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
        let critical = self.blocks.critical_time_step();
        Limits {
            common,
            blocks: critical.dt,
            cause_of_blocks: match self.blocks.settings().integrator {
                Integrator::ContactDynamics(_) => Cause::BlockStep,
                Integrator::CentralDifference if critical.is_by_speed => Cause::BlockSpeed,
                Integrator::CentralDifference => Cause::Contact,
            },
            blocks_in_water: self.longest_step_in_water(),
        }
    }

    /// Longest step of contact dynamics over several of the water, in which water before a block takes only a part of what a kick gives it:
    ///
    /// ```text
    /// T ≤ C m/(ρ₀ c₀ A)               A: both sides of the largest face of the box around a free block               [s]
    /// ```
    /// 0 for springs, between penalty walls, whose springs know no kicks, and with blocks that deform.
    fn longest_step_in_water(&self) -> f64 {
        match &self.water {
            Some(water)
                if water.walls.is_some()
                    && self.bodies.deformable.is_empty()
                    && self.takes_contact_dynamics() =>
            {
                let fluid = water.fluid.settings();
                let impedance = fluid.reference_density * fluid.sound_speed;
                LARGEST_RADIATION / (impedance * self.bodies.largest_area_per_mass)
            }
            _ => 0.0,
        }
    }

    fn takes_contact_dynamics(&self) -> bool {
        let integrator = self.blocks.settings().integrator;
        matches!(integrator, Integrator::ContactDynamics(_))
    }

    /// The particle or block by which a limit is as short as it is now, where it is a single one.
    pub fn holder(&self, cause: Cause) -> Option<Holder> {
        let of_particles = |size: fn(&Particles, usize) -> f64| {
            let particles = self.water.as_ref()?.fluid.particles();
            let sizes = (0..particles.len()).map(|a| (size(particles, a), a));
            let (_, a) = sizes.max_by(|one, other| one.0.total_cmp(&other.0))?;
            Some(Holder::Particle(particles.id[a], particles.position[a]))
        };
        match cause {
            Cause::Sound => of_particles(|particles, a| particles.velocity[a].norm_squared()),
            Cause::Force => of_particles(|particles, a| particles.acceleration[a].norm_squared()),
            Cause::Contact | Cause::BlockSpeed | Cause::BlockStep => {
                self.blocks.critical_time_step().block.map(Holder::Block)
            }
            Cause::Viscosity | Cause::Wall | Cause::Duration | Cause::Growth => None,
        }
    }

    /// Largest stable steps of sound and blocks at the current state, where the limits above are safe; s.
    /// Many times the work of [`Self::limits`].
    pub fn stability(&self) -> Vec<(Cause, f64)> {
        let mut borne = Vec::new();
        if let Some(water) = &self.water {
            let settings = water.fluid.settings();
            let flow = settings.sound_speed + water.fluid.max_speed();
            let sound = settings.sound_stability();
            borne.extend(sound.map(|dt| (Cause::Sound, dt * settings.sound_speed / flow)));
        }
        if !self.takes_contact_dynamics() {
            let blocks = self.blocks.stability_limit();
            borne.extend((blocks < f64::INFINITY).then_some((Cause::Contact, blocks)));
        }
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
        let step = limits.choose(self.water.is_some(), self.progress.clock.last_dt, ceiling);
        if step.dt < SMALLEST_STEP_SHARE * duration || step.dt.is_nan() {
            return Err(StepError::Stalled {
                time: self.progress.clock.time,
                step: self.progress.clock.steps,
                dt: step.dt,
                cause: step.cause,
                remedy: remedy(step.cause),
            });
        }
        Ok(step)
    }

    pub(super) fn record_extremes(&mut self) {
        let Some(water) = &self.water else { return };
        let fluid = &water.fluid;
        let extremes = &mut self.progress.extremes;
        let spacing = water.interface.settings().particle_spacing;
        let mach = fluid.max_speed() / fluid.settings().sound_speed;
        extremes.max_mach = extremes.max_mach.max(mach);
        for touch in water.interface.touches() {
            extremes.max_wall_penetration_over_spacing = extremes
                .max_wall_penetration_over_spacing
                .max(-touch.distance / spacing);
        }
        extremes.pair_interactions += fluid.n_pairs();
        extremes.viscous_products += u64::from(fluid.n_products());
        extremes.particle_steps += fluid.n_receivers();
        extremes.particle_steps_awake += fluid.n_awake() as u64;
        extremes.particle_steps_of_all += fluid.particles().len() as u64;
    }

    /// Refuses velocities that no fluid has: NaN, or above the speed of sound.
    pub(super) fn check_speeds(&self) -> Result<(), StepError> {
        let Some(water) = &self.water else {
            return Ok(());
        };
        let (fluid, particles) = (&water.fluid, water.fluid.particles());
        let (time, step) = (self.progress.clock.time, self.progress.clock.steps);
        // the work of viscosity is a sum over all velocities: one NaN makes it NaN
        if !fluid.viscous_loss().is_finite() {
            let is_bad = |v: &Vec3| !v.norm_squared().is_finite();
            let bad = particles.velocity.iter().position(is_bad);
            return Err(StepError::NoVelocity {
                time,
                step,
                id: bad.map_or_else(ParticleId::default, |a| particles.id[a]),
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
        Cause::BlockSpeed | Cause::BlockStep => "look at the block that moves so fast",
        Cause::Duration | Cause::Growth => "look at the last frame",
    }
}
