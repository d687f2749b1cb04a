//! Charts: a page in SVG, axes with their marks, and plots of curves and points with legends.
//!
//! The overview of a run and the plots of a study are drawn with these.

pub(crate) mod axis;
pub(crate) mod page;
pub(crate) mod plot;
