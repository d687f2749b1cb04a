//! Detection: pairs that are near, and the manifolds where they touch. No law stands here.

pub(crate) mod common_plane;
pub(crate) mod manifold;
pub(crate) mod patch;
pub(crate) mod polyhedra;
pub(crate) mod spheres;
pub(crate) mod terrain;

/// Broad phase: pairs of parts whose boxes, grown by a margin, overlap.
pub(crate) use crate::geometry::bounds as broad_phase;
