//! Geometry of scenes.
