//! Contributions of contacts to the stability bound of the step.

use serde::{Deserialize, Serialize};

/// Bound of the stable sub-step, never above the true limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StepBound {
    /// From the compliances of a block in all directions at all its contacts, added up: half the true limit of a single
    /// contact, a quarter of it and less in a pile. What it gives away resolves impacts.
    #[default]
    Compliances,
    /// From the largest eigenvalues of the stiffness and the damping of each block, see `step::eigenvalues`: close to the true
    /// limit in a pile, at the price of impacts resolved less finely.
    Eigenvalues,
}

/// Bounds of the eigenvalues of `M⁻¹K` and `M⁻¹C` that a pair adds at a block,
/// `Σ_k k_n w_n + k_t (w_t1 + w_t2)` and the same with the dashpots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Rates {
    /// 1/s².
    pub stiffness: f64,
    /// 1/s.
    pub damping: f64,
}

impl Rates {
    pub fn times(self, factor: f64) -> Self {
        Self {
            stiffness: factor * self.stiffness,
            damping: factor * self.damping,
        }
    }

    pub fn add(&mut self, other: &Self) {
        self.stiffness += other.stiffness;
        self.damping += other.damping;
    }

    /// The larger of each.
    pub fn larger(self, other: &Self) -> Self {
        Self {
            stiffness: self.stiffness.max(other.stiffness),
            damping: self.damping.max(other.damping),
        }
    }
}

/// Sum of the contacts of a block in the step bound.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct BlockRates {
    /// `Λ_K` (1/s²) and `Λ_C` (1/s) of the contacts that touch.
    pub stiffness: f64,
    pub damping: f64,
    /// The worst of those that do not yet.
    pub next_stiffness: f64,
    pub next_damping: f64,
    /// Share of the stiffest pair, its list and its place there.
    pub stiffest: f64,
    pub contact: Option<(Listed, u32)>,
}

impl BlockRates {
    /// Adds a pair, and notes the stiffest so far.
    pub fn add(&mut self, rates: &Rates, is_touching: bool, contact: (Listed, u32)) {
        if is_touching {
            self.stiffness += rates.stiffness;
            self.damping += rates.damping;
        } else {
            self.next_stiffness = self.next_stiffness.max(rates.stiffness);
            self.next_damping = self.next_damping.max(rates.damping);
        }
        if rates.stiffness > self.stiffest {
            self.stiffest = rates.stiffness;
            self.contact = Some(contact);
        }
    }
}

/// The lists of pairs.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) enum Listed {
    Pair,
    Sphere,
    Surface,
}

/// Bound by the eigenvalues of contacts, once there is one, and the steps since. Saved in checkpoints.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct KeptBound {
    pub bound: Option<Bound>,
    pub age: u32,
}

/// Bound of the step by one block.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Bound {
    /// s.
    pub dt: f64,
    pub block: usize,
    /// False if the speed of the block sets it.
    pub is_by_contact: bool,
}

impl Bound {
    pub const NONE: Self = Self {
        dt: f64::INFINITY,
        block: usize::MAX,
        is_by_contact: false,
    };

    pub fn of_contacts(dt: f64, block: usize) -> Self {
        Self {
            dt,
            block,
            is_by_contact: true,
        }
    }

    pub fn of_speed(dt: f64, block: usize) -> Self {
        Self {
            dt,
            block,
            is_by_contact: false,
        }
    }
}
