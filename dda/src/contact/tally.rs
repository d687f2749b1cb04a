//! Sums over the pairs of contacts.

use crate::Vec3;
use crate::contact::penalty::history::PairLoads;

/// Pairs of polyhedra that one thread takes at a time.
pub(crate) const PAIR_CHUNK: usize = 16;

/// Sums over the pairs of a chunk in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    /// Lost; J.
    pub friction: f64,
    pub damping: f64,
    /// Angular impulse that rolling resistance took out of both sides together; N m s.
    pub rolling_impulse: Vec3,
    pub n_touching: u64,
    pub n_broken: u64,
    /// Pairs that have met or parted.
    pub n_cut: u64,
    /// Full separating-axis tests.
    pub n_searches: u64,
    /// Deepest overlap, × size of the smaller part.
    pub deepest_over_size: f64,
    /// Largest overlap, × the allowed one, with its parts.
    pub worst: (f64, (u32, u32)),
}

impl Tally {
    pub fn with(self, other: Self) -> Self {
        Self {
            friction: self.friction + other.friction,
            damping: self.damping + other.damping,
            rolling_impulse: self.rolling_impulse + other.rolling_impulse,
            n_touching: self.n_touching + other.n_touching,
            n_broken: self.n_broken + other.n_broken,
            n_cut: self.n_cut + other.n_cut,
            n_searches: self.n_searches + other.n_searches,
            deepest_over_size: self.deepest_over_size.max(other.deepest_over_size),
            worst: if other.worst.0 > self.worst.0 {
                other.worst
            } else {
                self.worst
            },
        }
    }

    /// Adds the account of a pair.
    pub fn add(&mut self, loads: &PairLoads) {
        self.friction += loads.losses.friction;
        self.damping += loads.losses.damping;
        self.rolling_impulse += loads.rolling_impulse;
        self.n_broken += u64::from(loads.has_broken);
        self.n_cut += u64::from(!loads.half_kick_corrections.is_empty());
    }

    /// Records the overlap of two parts; × the allowed one and × size.
    pub fn note_overlap(&mut self, parts: (u32, u32), over_allowed: f64, over_size: f64) {
        self.n_touching += 1;
        self.deepest_over_size = self.deepest_over_size.max(over_size);
        if over_allowed > self.worst.0 {
            self.worst = (over_allowed, parts);
        }
    }
}
