//! State of the blocks: everything that a run changes and a restart needs, except the contacts.

use super::accounts::Accounts;
use super::attachments::Attachments;
use super::rest::Rest;
use super::spanned::Spanned;
use super::steered::Steered;
use super::totals::Totals;
use crate::contact::dynamics::kept::{ContactSolution, KeptBond, KeptImpulse};
use crate::contact::rates::{BlockRates, KeptBound};
use crate::geometry::bounds::Bounds;
use crate::material::Joint;
use crate::motion::deformation::Deformable;
use crate::motion::kinematics::Kinematics;
use crate::{Load, Vec3};
use nalgebra::{Matrix3, UnitQuaternion};
use serde::{Deserialize, Serialize};

/// State of a system of blocks. Columns are one per block unless noted; velocities are those of full steps.
///
/// Everything in it is saved in a checkpoint, in the order of the fields.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct State {
    /// Centroid; m.
    pub centroid: Vec<Vec3>,
    /// Velocity of the centroid; m/s.
    pub velocity: Vec<Vec3>,
    /// World from principal axes.
    pub attitude: Vec<UnitQuaternion<f64>>,
    /// Angular momentum in principal axes; N m s.
    pub angular_momentum: Vec<Vec3>,
    /// True of a removed block.
    pub is_removed: Vec<bool>,
    /// Strain and stress; one per deformable block.
    pub deformables: Vec<Deformable>,
    /// Loads, supports and bolts.
    pub attachments: Attachments,
    /// Sleep of blocks at rest.
    pub rest: Rest,
    /// Impulses on chosen blocks, by source.
    pub accounts: Accounts,
    /// Motions added to prescribed ones; one per block that was ever steered.
    pub steered: Vec<Steered>,
    /// True while prescribed blocks are held at their places of t = 0.
    pub are_paths_held: bool,
    /// Energies, impulses and counts since t = 0.
    pub totals: Totals,
    /// Contact constants of every pair of materials, row by row; changed by `weaken`.
    pub joints: Vec<Joint>,
    /// Rigid motion at the last evaluation; written by the step.
    pub kinematics: Vec<Kinematics>,
    /// Sum of contact forces at the last evaluation; N, N m.
    pub contact_load: Vec<Load>,
    /// Contact loads one sub-step before; N, N m.
    pub contact_load_before: Vec<Load>,
    /// Way of the farthest point of a rigid block since the start, or more; m.
    pub travel: Vec<f64>,
    /// Straining moment of the contacts at the last evaluation; one per deformable block; N m.
    pub contact_stretch: Vec<Matrix3<f64>>,
    /// Share of the contacts in the step bound at the last evaluation.
    pub rates: Vec<BlockRates>,
    /// Bound of the step by the eigenvalues of the contacts, of some steps ago.
    pub bound: KeptBound,
    /// Deepest overlap at the last evaluation, × the overlap allowed, with its parts.
    pub worst_overlap: (f64, (u32, u32)),
    /// Impulses from outside that the next step of contact dynamics gives; one per block, empty of central differences; N s, N m s.
    pub outside: Vec<Load>,
    /// Place among the steps of contact dynamics, where they span several of the caller's.
    pub spanned: Spanned,
    /// Straining moments of these impulses; one per deformable block, empty of central differences; N m s.
    pub outside_stretch: Vec<Matrix3<f64>>,
    /// Impulses of the last step of contact dynamics, by parts and key.
    pub impulses: Vec<KeptImpulse>,
    /// Bonds of contact dynamics that hold, by parts.
    pub bonds: Vec<KeptBond>,
    /// Contacts of that step.
    pub solution: ContactSolution,
    /// Axis-aligned boxes around the parts; one per part; m.
    pub boxes: Vec<Bounds>,
    /// Boxes with their margin, with which the candidate pairs were found; one per part; m.
    pub fat_boxes: Vec<Bounds>,
}
