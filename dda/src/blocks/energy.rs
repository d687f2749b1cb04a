//! Energy terms of a system of blocks.

use serde::{Deserialize, Serialize};

/// Energies and works; J. For blocks alone
///
/// ```text
/// kinetic + potential + elastic + strain
///     + friction + damping + strain_damping + static_damping + sleep_loss + plastic
///     − overlap_removal − joint_correction − external_work = constant
/// ```
/// up to the error of the time step and of contact patches that change shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Of the free blocks, with `added_kinetic`.
    pub kinetic: f64,
    /// The part of `kinetic` that exists by mass scaling of strain modes only.
    pub added_kinetic: f64,
    /// `−Σ m g·x_c` of the free blocks, zero at the world's origin.
    pub potential: f64,
    /// Of the contact springs, normal and shear, of bolts and of elastic supports.
    pub elastic: f64,
    /// Elastic energy inside deformable blocks.
    pub strain: f64,
    /// Lost to slip; cumulative.
    pub friction: f64,
    /// Lost to contact dashpots, to broken bonds and where a contact changed to other features; cumulative.
    pub damping: f64,
    /// Lost to the viscosity of deformable blocks; cumulative.
    pub strain_damping: f64,
    /// Lost to the damping in the search for a static equilibrium; cumulative.
    pub static_damping: f64,
    /// Kinetic energy removed when blocks were put to sleep; cumulative.
    pub sleep_loss: f64,
    /// Lost in bolts that yield and rods that break; cumulative.
    pub plastic: f64,
    /// Given by the removal of overlap in contact dynamics; cumulative.
    pub overlap_removal: f64,
    /// Given by exact joints as they restore the positions of their points, of either sign; cumulative. Zero in the mean over a smooth
    /// motion.
    pub joint_correction: f64,
    /// Work of prescribed blocks and of given loads on free blocks; cumulative. The work of impulses of
    /// `apply_impulse` is booked by the caller.
    pub external_work: f64,
}

impl Energies {
    /// Conserved energy balance: stored and dissipated energy minus external work; J.
    pub fn balance(&self) -> f64 {
        let Self {
            kinetic,
            added_kinetic: _,
            potential,
            elastic,
            strain,
            friction,
            damping,
            strain_damping,
            static_damping,
            sleep_loss,
            plastic,
            overlap_removal,
            joint_correction,
            external_work,
        } = *self;
        kinetic
            + potential
            + elastic
            + strain
            + friction
            + damping
            + strain_damping
            + static_damping
            + sleep_loss
            + plastic
            - overlap_removal
            - joint_correction
            - external_work
    }
}

/// Compensated sum.
///
/// Source: Neumaier (1974).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Account {
    sum: f64,
    lost: f64,
}

impl Account {
    pub fn book(&mut self, amount: f64) {
        let total = self.sum + amount;
        self.lost += if self.sum.abs() >= amount.abs() {
            (self.sum - total) + amount
        } else {
            (amount - total) + self.sum
        };
        self.sum = total;
    }

    pub fn total(&self) -> f64 {
        self.sum + self.lost
    }
}
