//! Detection: pairs that are near, their common plane and the patch between them.

pub(crate) mod broad_phase;
pub(crate) mod common_plane;
pub(crate) mod patch;
