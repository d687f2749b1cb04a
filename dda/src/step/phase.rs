//! Phases of a step, for the timing of the caller.

/// Phase of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Kicks, drifts, placement of the parts, attachments, checks.
    Motion,
    /// Broad phase.
    BroadPhase,
    /// Narrow phase and contact law: pair by pair, in one loop, so that a pair's patch never leaves the cache
    /// between the two.
    Contacts,
    /// Sums over the pairs of each block.
    Sums,
}
