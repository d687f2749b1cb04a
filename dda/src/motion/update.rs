//! Equation of motion of a block in a step.

/// Update of a block in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Update {
    /// Forces do not act: fixed, prescribed or removed.
    Fixed,
    /// Rigid motion under forces, without holds.
    Rigid,
    /// Rigid, and asleep: it keeps its position.
    Asleep,
    /// Deformable, held in some directions, or damped in proportion to its load.
    Constrained,
}
