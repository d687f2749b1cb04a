//! Sums since t = 0: energies lost, work, impulses, counts.

use super::energy::Account;
use crate::Vec3;
use crate::contact::dynamics::kept::SolvedSteps;
use serde::{Deserialize, Serialize};

/// Sums over the steps since t = 0.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Totals {
    /// Lost to friction; J.
    pub friction: Account,
    /// Lost to contact dashpots; J.
    pub damping: Account,
    /// Lost to the viscosity of deformable blocks; J.
    pub strain_damping: Account,
    /// Lost to the damping of a search for equilibrium; J.
    pub static_damping: Account,
    /// Kinetic energy of blocks when they were put to sleep; J.
    pub sleep_loss: Account,
    /// Given by the removal of overlap that contact dynamics leaves; J.
    pub overlap_removal: Account,
    /// Work of prescribed blocks; J.
    pub external_work: Account,
    /// Impulse of gravity and of fixed and prescribed blocks on free ones; N s.
    pub support_impulse: Vec3,
    /// Sum of the magnitudes of gravity's and the supports' impulses; N s.
    pub impulse_exchanged: f64,
    /// Angular impulse of rolling resistance that no second body took up; N m s.
    pub rolling_impulse: Vec3,
    /// Force evaluations of pairs of parts.
    pub n_contact_updates: u64,
    /// Contacts of all steps of contact dynamics.
    pub solved: SolvedSteps,
    /// Bonds broken.
    pub n_broken_bonds: u64,
    /// Full separating-axis tests.
    pub n_axis_searches: u64,
    /// Deepest overlap, × size of the smaller part; –.
    pub max_overlap_over_size: f64,
}
