//! Errors of a step, each with its time, its place and a remedy. A shorter step is none: a run tries it by itself before it
//! ends.

use riprap_dda::BlockId;
use riprap_sph::{FluidError, ParticleId};

use crate::messages::{Code, Coded};
use crate::world::time_step::Cause;

/// Failure of a step: there is no new state.
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
    /// Overlap of two blocks beyond what a step allows, with their names.
    #[error(
        "at t = {time:.6} s, step {step}: {words}; raise the contact stiffness, or part them at the start"
    )]
    Overlap {
        /// s.
        time: f64,
        /// Number of the step.
        step: u64,
        /// Names, place and depth.
        words: String,
    },
    /// Another error of a block, with its name.
    #[error("{words}")]
    Named {
        /// The error.
        error: Box<StepError>,
        /// Its text with the name.
        words: String,
    },
    /// Something left the domain of a scene in which nothing may.
    #[error(
        "at t = {time:.6} s, step {step}: {count} {what} left the domain; enlarge `domain`, close it with walls, or set `domain.leaving` to Remove"
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
        block: BlockId,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
    /// The position or velocity of a particle is not finite.
    #[error(
        "at t = {time:.6} s, step {step}: velocity of particle {id} is NaN; raise `fluid.dynamic_viscosity`, or look what hits the water there"
    )]
    NoVelocity {
        /// s.
        time: f64,
        /// Number of the step.
        step: u64,
        /// Id of the particle.
        id: ParticleId,
    },
    /// Faster than sound: the fluid is stiff no longer.
    #[error(
        "at t = {time:.6} s, step {step}: particle {id} near ({:.4}, {:.4}, {:.4}) moves at {speed:.4} m/s, and sound at {sound_speed:.4} m/s; raise `numerics.sound_speed`, or look what hits the water there",
        at[0], at[1], at[2]
    )]
    Supersonic {
        /// s.
        time: f64,
        /// Number of the step.
        step: u64,
        /// Id of the particle.
        id: ParticleId,
        /// m.
        at: [f64; 3],
        /// m/s.
        speed: f64,
        /// m/s.
        sound_speed: f64,
    },
    /// Energy rose without a source.
    #[error(
        "at t = {time:.6} s, step {step}: energy rose by {gained:.4e} J in {steps} steps without a source (kinetic + elastic before: {before:.4e} J); reduce `contact_stiffness` of the materials, or check for blocks and water that start inside each other"
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
        "at t = {time:.6} s, step {step}: {count} particles left the domain within {steps} steps; {left} remain; close `domain` with walls or enlarge it"
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
            Self::Named { error, .. } => error.is_of_the_step(),
            Self::Fluid { .. }
            | Self::Blocks { .. }
            | Self::Overlap { .. }
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

impl Coded for StepError {
    fn code(&self) -> Code {
        match self {
            Self::Fluid { source, .. } => source.code(),
            Self::Blocks { source, .. } => source.code(),
            Self::Named { error, .. } => error.code(),
            Self::Overlap { .. } => Code::PenetrationTooDeep,
            Self::Left { .. } | Self::Drained { .. } => Code::LeftDomain,
            Self::AtPlane { .. } => Code::BlockAtSymmetryPlane,
            Self::NoVelocity { .. } => Code::ParticleNan,
            Self::Supersonic { .. } => Code::FasterThanSound,
            Self::EnergyFromNowhere { .. } => Code::EnergyFromNowhere,
            Self::Stalled { .. } => Code::TimeStepCollapsed,
        }
    }
}
