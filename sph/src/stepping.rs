//! Time integration of the fluid.

pub(crate) mod predictor_corrector;
