//! Input of a system of blocks: block definitions and solver settings.

use crate::{
    BlockError, ContactDetection, ContactSolver, Deformability, Motion, NormalLaw, RollingLaw,
    Shape, StepBound, Vec3,
};

/// Definition of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockDefinition {
    /// Geometry in its world placement at t = 0.
    pub shape: Shape,
    /// Position in the list of materials.
    pub material: usize,
    /// Motion.
    pub motion: Motion,
    /// Initial velocity of the centroid, free blocks only; m/s.
    pub velocity: Vec3,
    /// Initial angular velocity, free blocks only; world; rad/s.
    pub angular_velocity: Vec3,
    /// Makes a free block of polyhedra deformable; rigid if none.
    pub deformability: Option<Deformability>,
}

/// Settings of the solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Acceleration of gravity; m/s².
    pub gravity: Vec3,
    /// Time integrator. Default: central differences.
    pub integrator: Integrator,
    /// Share `C_b` of the stability bound that a step may use, 0 < C_b ≤ 1. Default 0.8.
    pub time_step_factor: f64,
    /// Bound of the stable step. Default: compliances.
    pub step_bound: StepBound,
    /// Deepest overlap allowed, × size of the smaller part; never more than half the mean thickness of
    /// both, or of what lies on a surface. Default 0.2.
    pub overlap_limit: f64,
    /// Normal contact law of spheres. Default: linear spring; Hertz's law needs elastic moduli.
    pub normal_law: NormalLaw,
    /// Angular velocity that rolling resistance acts on. Default: the relative one.
    pub rolling_law: RollingLaw,
    /// Detection of common planes. Default: verified.
    pub contact_detection: ContactDetection,
    /// Damping in the search for a static equilibrium. Default: off, for dynamic runs.
    pub static_damping: Option<StaticDamping>,
    /// Criteria of sleep of blocks at rest. Default: off.
    pub resting: Option<Resting>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            gravity: Vec3::new(0.0, 0.0, -9.81),
            integrator: Integrator::default(),
            time_step_factor: 0.8,
            step_bound: StepBound::default(),
            overlap_limit: 0.2,
            normal_law: NormalLaw::default(),
            rolling_law: RollingLaw::default(),
            contact_detection: ContactDetection::default(),
            static_damping: None,
            resting: None,
        }
    }
}

/// Time integrator of the blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Integrator {
    /// Explicit central differences with penalty contact, see `step::central_difference`.
    #[default]
    CentralDifference,
    /// Drift, kick with all contacts and exact joints solved together, drift: steps limited by motion alone, see `step::mid_step`. For
    /// rigid and affine blocks without residual cohesion or static damping; spheres resist rolling by [`RollingLaw::Relative`] only.
    ContactDynamics(ContactDynamics),
}

/// Parameters of contact dynamics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactDynamics {
    /// Step, above 0. Shorter where a block moves by more than a fifth of its size in it, turns by more than 0.1 rad, or hangs on a
    /// stiff support or bolt. Default 5e-3; s.
    pub time_step: f64,
    /// Residual of the laws of contact at which a step is solved, above 0. Default 1e-4; –.
    pub tolerance: f64,
    /// Sweeps and iterations of a step at most, at least 1. Default 300.
    pub n_iterations: usize,
    /// Solver of all contacts. Default: chosen in each step.
    pub solver: ContactSolver,
}

impl Default for ContactDynamics {
    fn default() -> Self {
        Self {
            time_step: 5e-3,
            tolerance: 1e-4,
            n_iterations: 300,
            solver: ContactSolver::default(),
        }
    }
}

/// Criteria for putting blocks to sleep and waking them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resting {
    /// Largest displacement within `time` of a block at rest, of its centroid and of its corners by rotation, above 0; × size.
    pub displacement: f64,
    /// Time at rest before sleep, above 0; s.
    pub time: f64,
    /// Change of load that wakes a block, above 0; × weight.
    pub load: f64,
}

/// Damping for statics; its dissipation is a separate term of the ledger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StaticDamping {
    /// `f −= α m v`, α ≥ 0; 1/s.
    MassProportional(f64),
    /// `f −= α |f| sign(v)` for each component of force and torque, 0 ≤ α < 1. Source: Cundall (1987).
    Local(f64),
    /// `v := κ v` after each sub-step, 0 < κ ≤ 1: the dynamic coefficient of DDA, whose effect depends
    /// on the step.
    Kinetic(f64),
}

fn check_dynamics(dynamics: &ContactDynamics, settings: &Settings) -> Result<(), BlockError> {
    let refuse = |field, value, rule| Err(BlockError::Setting { field, value, rule });
    let ContactDynamics {
        time_step,
        tolerance,
        n_iterations,
        solver: _,
    } = *dynamics;
    if !(time_step > 0.0 && time_step.is_finite()) {
        return refuse("integrator.time_step", time_step, "must be above 0 s");
    }
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return refuse("integrator.tolerance", tolerance, "must be above 0");
    }
    if n_iterations == 0 {
        return refuse("integrator.n_iterations", 0.0, "must be at least 1");
    }
    if settings.static_damping.is_some() {
        return refuse("static_damping", f64::NAN, "contact dynamics has none");
    }
    Ok(())
}

pub(super) fn check_settings(settings: &Settings) -> Result<(), BlockError> {
    let refuse = |field, value, rule| Err(BlockError::Setting { field, value, rule });
    let Settings {
        gravity,
        integrator,
        time_step_factor,
        step_bound: _,
        overlap_limit,
        contact_detection: _,
        normal_law: _,
        rolling_law: _,
        static_damping,
        resting,
    } = *settings;
    if let Some(&value) = gravity.iter().find(|c| !c.is_finite()) {
        return refuse("gravity", value, "must be finite");
    }
    if let Integrator::ContactDynamics(dynamics) = integrator {
        check_dynamics(&dynamics, settings)?;
    }
    if !(time_step_factor > 0.0 && time_step_factor <= 1.0) {
        return refuse(
            "time_step_factor",
            time_step_factor,
            "must be above 0 and at most 1",
        );
    }
    if !(overlap_limit > 0.0 && overlap_limit <= 1.0) {
        return refuse(
            "overlap_limit",
            overlap_limit,
            "must be above 0 and at most 1",
        );
    }
    if let Some(Resting {
        displacement,
        time,
        load,
    }) = resting
    {
        for (field, value) in [
            ("resting.displacement", displacement),
            ("resting.time", time),
            ("resting.load", load),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return refuse(field, value, "must be above 0");
            }
        }
    }
    match static_damping {
        Some(StaticDamping::MassProportional(value)) if !(value >= 0.0 && value.is_finite()) => {
            refuse("static_damping", value, "must be >= 0 1/s")
        }
        Some(StaticDamping::Local(value)) if !(0.0..1.0).contains(&value) => {
            refuse("static_damping", value, "must be in [0, 1)")
        }
        Some(StaticDamping::Kinetic(value)) if !(value > 0.0 && value <= 1.0) => {
            refuse("static_damping", value, "must be above 0 and at most 1")
        }
        _ => Ok(()),
    }
}
