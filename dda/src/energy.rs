//! Energy terms of a system of blocks.

/// Energies and works; J. For blocks alone
///
/// ```text
/// kinetic + potential + elastic + friction + damping − external_work = constant
/// ```
/// up to the error of the time step and of contact patches that change shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Of the free blocks.
    pub kinetic: f64,
    /// `−Σ m g·x_c` of the free blocks, zero at the world's origin.
    pub potential: f64,
    /// Of the contact springs, normal and shear.
    pub elastic: f64,
    /// Lost to slip; cumulative.
    pub friction: f64,
    /// Lost to contact dashpots and broken bonds; cumulative.
    pub damping: f64,
    /// Work of prescribed blocks on free ones; cumulative. The work of impulses given with
    /// `apply_impulse` is their giver's to book.
    pub external_work: f64,
}

/// Sum that keeps the digits that a plain sum loses.
///
/// Source: Neumaier (1974).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
