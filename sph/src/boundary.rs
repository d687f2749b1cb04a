//! Boundaries of the fluid: the trait by which a step asks whatever holds the fluid, and two kinds of walls, of particles
//! inside solids and of exact kernel integrals over polyhedra.

pub mod integral;
pub mod sampling;
pub mod wall_integrals;
pub mod wall_law;
pub mod wall_particles;

#[cfg(test)]
mod solids;

pub use crate::neighbors::thin_solids;

use crate::{Fluid, FluidError};

/// Part of a step over which bodies move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of it.
    Whole,
    /// From the start to the middle.
    FirstHalf,
    /// From the middle to the end.
    SecondHalf,
}

/// State of the fluid for which boundaries are placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The middle of a step whose bodies are at its end already: rates of density only.
    Midpoint,
    /// The predicted middle, bodies half way: rates and forces.
    Predicted,
    /// The end of a step.
    End,
}

/// Phase of a step that has ended, for the caller's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Sort and neighbor search.
    Neighbors,
    /// Densities, pressures, shifting.
    Density,
    /// Pair forces in the fluid, and the viscosities that they need.
    Forces,
    /// Kicks and drifts.
    Integration,
}

/// Boundary of the fluid: walls, bodies, openings. A step calls it at fixed stages, see `stepping`; each call
/// may read the fluid, and changes it only by the fluid's own functions, which keep its accounts.
///
/// All methods have an empty default, so that a boundary implements only those it needs.
pub trait Boundary {
    /// Ends a step without a new state.
    type Error: From<FluidError>;

    /// Moves the bodies over a part of the step that takes `dt` (s).
    ///
    /// # Errors
    ///
    /// Failure of the motion of the bodies.
    fn advance(&mut self, _part: Part, _dt: f64) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Lets particles enter and leave through openings, at the end of a step of `dt` (s).
    ///
    /// # Errors
    ///
    /// Failure of the inflow.
    fn exchange(&mut self, _fluid: &mut Fluid, _dt: f64) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Accepts that particles left the domain.
    ///
    /// # Errors
    ///
    /// If particles may not leave.
    fn escaped(&mut self, _count: u64) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Places the walls for a stage after `dt` (s) and finds which particles are near; the fluid is sorted.
    fn place(&mut self, _fluid: &mut Fluid, _stage: Stage, _dt: f64) {}

    /// Finds again which particles are near: the fluid was shifted and is sorted.
    fn find(&mut self, _fluid: &mut Fluid) {}

    /// Imposes the flow in openings at a stage after `dt` (s).
    fn hold(&mut self, _fluid: &mut Fluid, _stage: Stage, _dt: f64) {}

    /// Adds the walls' part of the rates of density.
    fn density_rates(&mut self, _fluid: &mut Fluid) {}

    /// Adds the walls' part of the concentration of particles, from which shifting follows.
    fn concentration(&mut self, _fluid: &mut Fluid) {}

    /// Continues the fluid's pressure into the walls.
    fn continue_pressure(&mut self, _fluid: &mut Fluid) {}

    /// Adds the walls' part of the gradient of velocity, from which viscosities follow.
    fn strain_rates(&mut self, _fluid: &mut Fluid) {}

    /// Finds how bodies that the fluid moves accelerate, viscosities known.
    fn solve_motion(&mut self, _fluid: &mut Fluid) {}

    /// Adds the walls' forces to the accelerations, and keeps the reactions on the bodies.
    fn forces(&mut self, _fluid: &mut Fluid) {}

    /// Adds the walls' resistance to the velocities of the fluid, and names particles whose velocities are imposed, before an implicit viscous
    /// step; see [`Fluid::resist`] and [`Fluid::hold_in_viscous_step`].
    fn resistance(&mut self, _fluid: &mut Fluid) {}

    /// Gives the walls the opposite of their forces in an implicit viscous step just solved.
    fn drag(&mut self, _fluid: &mut Fluid) {}

    /// Shares forces with bodies in the volume of the fluid, which follow from its accelerations by all else.
    fn share(&mut self, _fluid: &mut Fluid) {}

    /// Books the effect of the next kick over `dt` (s).
    fn begin_kick(&mut self, _fluid: &mut Fluid, _dt: f64) {}

    /// Gives the bodies the equal and opposite of a kick over `dt` (s).
    fn end_kick(&mut self, _fluid: &mut Fluid, _dt: f64) {}

    /// Stores the forces at the start of a step after the prediction of the fluid to the middle.
    fn predicted(&mut self, _fluid: &mut Fluid) {}

    /// Stops the time of a phase.
    fn ended(&mut self, _phase: Phase) {}
}

/// No boundary: a fluid in a periodic or unbounded domain.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoBoundary;

impl Boundary for NoBoundary {
    type Error = FluidError;
}
