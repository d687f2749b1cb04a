//! State that contact dynamics keeps from step to step.

use super::UNSOLVED;
use crate::contact::bond::Bond;
use crate::contact::report::{Contact, ContactState};
use crate::{BlockId, PartId, Vec3};
use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};

/// Impulse at a point of two parts, from which the next step starts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptImpulse {
    pub parts: (u32, u32),
    pub blocks: (u32, u32),
    /// World; m.
    pub position: Vec3,
    /// Unit, from the first to the second.
    pub normal: Vec3,
    /// Below 0 for overlap; m.
    pub gap: f64,
    /// On the second; N s.
    pub impulse: Vec3,
    /// Of rolling and twisting resistance, on the second; N m s.
    pub torque: Vec3,
    /// Of the step; s.
    pub dt: f64,
    pub state: ContactState,
    /// Whether the residual friction holds from now on; without a bond that broke false where it is not lower.
    pub has_slipped: bool,
}

impl KeptImpulse {
    /// The point as reported, with its mean force in the step; `key` names it among those of its parts.
    pub fn contact(&self, key: u32) -> Contact {
        let force = self.impulse / self.dt;
        let normal_force = force.dot(&self.normal);
        Contact {
            blocks: (BlockId::from(self.blocks.0), BlockId::from(self.blocks.1)),
            parts: (PartId::from(self.parts.0), PartId::from(self.parts.1)),
            key,
            point: self.position,
            normal: self.normal,
            normal_force,
            shear_force: force - self.normal * normal_force,
            overlap: -self.gap,
            state: self.state,
        }
    }
}

/// A bond that is rigid until it breaks. Lengths and directions are those of the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptBond {
    pub parts: (u32, u32),
    pub blocks: (u32, u32),
    pub bond: Bond,
    /// Middle of the patch from the centroid of each block, in its principal axes; m.
    pub anchors: [Vec3; 2],
    /// Principal axes of the second in those of the first.
    pub attitude: UnitQuaternion<f64>,
    /// Unit, from the first to the second, in the principal axes of the first.
    pub normal: Vec3,
    /// Corners of the patch from its middle, in the principal axes of the first; m.
    pub outline: Vec<Vec3>,
}

/// Contacts of the last step of contact dynamics, and how far their impulses are from the laws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactSolution {
    /// Points at which parts touched or were near.
    pub n_contacts: usize,
    /// Sweeps and iterations.
    pub n_iterations: usize,
    /// Residual of the laws; –.
    pub residual: f64,
    /// Spurious over available energy; –.
    pub energy_error: f64,
    /// Points that bear with a friction above Painlevé's limit, see [`super::ContactProblem::is_above_painleve`].
    pub n_above_painleve: usize,
}

/// Contacts of all steps of contact dynamics so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolvedSteps {
    /// Steps.
    pub n_steps: u64,
    /// Steps left with a residual above [`UNSOLVED`], or with a joint open.
    pub n_unsolved: u64,
    /// Of these, the last ones running.
    pub n_unsolved_running: u32,
    /// Sweeps and iterations of all steps.
    pub n_iterations: u64,
    /// Most sweeps and iterations of a step.
    pub most_iterations: usize,
    /// Most points of a step.
    pub most_contacts: usize,
    /// Largest residual of a step; –.
    pub largest_residual: f64,
    /// Largest spurious over available energy of a step; –.
    pub largest_energy_error: f64,
    /// Most points of a step that bear with a friction above Painlevé's limit.
    pub most_above_painleve: usize,
}

impl SolvedSteps {
    /// Counts a step, with whether it left a joint open.
    pub(crate) fn count(&mut self, solution: &ContactSolution, has_open_joint: bool) {
        let is_unsolved = UNSOLVED < solution.residual || has_open_joint;
        self.n_steps += 1;
        self.n_unsolved += u64::from(is_unsolved);
        self.n_unsolved_running = match is_unsolved {
            true => self.n_unsolved_running + 1,
            false => 0,
        };
        self.n_iterations += solution.n_iterations as u64;
        self.most_iterations = self.most_iterations.max(solution.n_iterations);
        self.most_contacts = self.most_contacts.max(solution.n_contacts);
        self.largest_residual = self.largest_residual.max(solution.residual);
        self.largest_energy_error = self.largest_energy_error.max(solution.energy_error);
        self.most_above_painleve = self.most_above_painleve.max(solution.n_above_painleve);
    }
}
