//! Errors of the fluid.

use crate::ParticleId;

/// Errors of setting up or stepping the fluid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FluidError {
    /// A setting is out of range.
    #[error("fluid setting `{name}` must be {range}, got {value}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// Value found, in SI units.
        value: f64,
        /// Values allowed.
        range: &'static str,
    },
    /// The periodic extent is narrower than the support, so that a particle would meet itself.
    #[error(
        "the periodic extent along axis {axis} is {extent} m, less than the support radius {support_radius} m; widen the slab or lower the smoothing length"
    )]
    NarrowPeriod {
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// m.
        extent: f64,
        /// m.
        support_radius: f64,
    },
    /// A side of the domain cannot be a plane of symmetry.
    #[error(
        "the domain cannot have a plane of symmetry across axis {axis}: {reason}; choose another side"
    )]
    Symmetry {
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// Reason.
        reason: &'static str,
    },
    /// More particles than neighbor ids can number.
    #[error(
        "{count} fluid particles are more than the {limit} that neighbor lists can number; coarsen the spacing"
    )]
    TooManyParticles {
        /// Particles asked for.
        count: usize,
        /// Largest possible number.
        limit: usize,
    },
    /// A stepping that makes every wave of sound grow.
    #[error(
        "symplectic Euler with density from continuity is forward Euler for sound: every wave grows, however small the step; use `KickDriftKick` or `PredictorCorrector`, or density by `Summation`"
    )]
    GrowingSound,
    /// A scheme without implicit viscous steps.
    #[error("a viscous step cannot be implicit with {refused}")]
    ExplicitViscosity {
        /// Option incompatible with it, and a remedy.
        refused: &'static str,
    },
    /// An implicit viscous step that does not converge.
    #[error(
        "the implicit viscous step did not converge in {products} products: velocities are off by {relative:.1e} of their root mean square; lower the largest viscosity, or take the viscous step `Explicit`"
    )]
    ViscousStep {
        /// Products made.
        products: u32,
        /// Residual of the velocities, over their root mean square; –.
        relative: f64,
    },
    /// Water that cannot sleep.
    #[error("water cannot sleep with {refused}")]
    Sleepless {
        /// Option incompatible with sleep, and a remedy.
        refused: &'static str,
    },
    /// Non-finite state of a particle.
    #[error(
        "particle {id} near ({x:.4}, {y:.4}, {z:.4}) m has a non-finite {quantity}; raise `fluid.dynamic_viscosity`"
    )]
    NonFinite {
        /// Number of the particle.
        id: ParticleId,
        /// Non-finite quantity.
        quantity: &'static str,
        /// m.
        x: f64,
        /// m.
        y: f64,
        /// m.
        z: f64,
    },
    /// A particle's density is far from the reference.
    #[error(
        "particle {id} near ({x:.4}, {y:.4}, {z:.4}) m has density {density:.1} kg/m³, more than {limit_percent:.0} % above the reference; raise `numerics.sound_speed`"
    )]
    Compressed {
        /// Number of the particle.
        id: ParticleId,
        /// kg/m³.
        density: f64,
        /// Limit above the reference density; %.
        limit_percent: f64,
        /// m.
        x: f64,
        /// m.
        y: f64,
        /// m.
        z: f64,
    },
}
