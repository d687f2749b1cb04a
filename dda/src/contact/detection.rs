//! Detection: pairs that are near, their common plane and the patch between them.

pub(crate) mod common_plane;
pub(crate) mod patch;

/// Broad phase: pairs of parts whose boxes, grown by a margin, overlap.
pub(crate) use crate::geometry::bounds as broad_phase;
