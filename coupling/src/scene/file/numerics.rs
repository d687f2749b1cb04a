//! Schemes and their numbers, of the fluid and of the blocks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Numerical schemes and parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[derive(Default)]
pub struct NumericsFile {
    /// Fluid scheme whose parameters apply where not given.
    #[serde(default)]
    pub preset: Preset,
    /// Smoothing kernel; that of the preset when left out.
    #[serde(default)]
    pub kernel: Option<KernelFile>,
    /// Computation of density; that of the preset when left out.
    #[serde(default)]
    pub density: Option<DensityFile>,
    /// Pressure from density; that of the preset when left out.
    #[serde(default)]
    pub state_equation: Option<StateEquationFile>,
    /// Density diffusion for `Continuity`; the number is its coefficient, customarily 0.1. That of the preset when left out.
    #[serde(default)]
    pub density_diffusion: Option<DensityDiffusionFile>,
    /// Viscosity model; that of the preset when left out, `Rheological` where there are flow laws.
    #[serde(default)]
    pub viscosity: Option<ViscosityFile>,
    /// Velocities at which a step takes the viscous force.
    #[serde(default)]
    pub viscous_step: ViscousStepFile,
    /// Coefficient of bulk viscosity over `ρ₀ c₀ h`, from 0 to 1, with density by `Continuity`: damps sound and leaves waves
    /// alone. None when left out. The time step is 2, 4, 8 and 37 % shorter at 0.05, 0.1, 0.2 and 1.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "minimum" = 0, "maximum" = 1))]
    pub bulk_viscosity: Option<f64>,
    /// Particle shifting; that of the preset when left out.
    #[serde(default)]
    pub shifting: Option<ShiftingFile>,
    /// Time integration; that of the preset when left out.
    #[serde(default)]
    pub stepping: Option<SteppingFile>,
    /// Floating-point precision of the sums over neighbors; that of the preset when left out.
    #[serde(default)]
    pub precision: Option<PrecisionFile>,
    /// Ratio of smoothing length to particle spacing; the support radius is twice the smoothing length. When left out, 1.3 in
    /// three dimensions and 2.0 in two, with `Reference` 2.0 and with `Mueller2003` 1.5. Work grows with the number of neighbors,
    /// its cube in three dimensions; walls thinner than the support are thin solids, next to which water may keep moving.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-"))]
    pub smoothing_length_ratio: Option<f64>,
    /// Numerical speed of sound; m/s. Seven times the fastest expected speed when left out, five with `Preview`, fourteen with
    /// `Reference`, ten with `Mueller2003`. The time step is proportional to its inverse, and density changes by half to all of
    /// the square of the flow's speed over it.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m/s"))]
    pub sound_speed: Option<f64>,
    /// Fastest expected flow, from which the speed of sound follows; m/s. When left out, the fastest of long waves, falls to the
    /// still water and prescribed blocks that push.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m/s", "exclusiveMinimum" = 0))]
    pub expected_speed: Option<f64>,
    /// Time step over the longest that the scheme takes, which is 0.65 of the fluid's stability limit and with `Mueller2003` all of it;
    /// above 0 and at most 1. When left out, 1.0, with `Mueller2003` 0.5.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "exclusiveMinimum" = 0, "maximum" = 1))]
    pub time_step_factor: Option<f64>,
    /// Treatment of negative pressures; that of the preset when left out.
    #[serde(default)]
    pub negative_pressure: Option<NegativePressure>,
    /// Sleep of water at rest until it is disturbed; all water is computed when left out.
    #[serde(default)]
    pub sleeping: Option<SleepingFile>,
    /// Time integration of the blocks, and how their contacts bear.
    #[serde(default)]
    pub blocks: BlockIntegratorFile,
    /// Sub-step over a bound that is never above the blocks' stability limit, above 0 and at most 1. 0.8 when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "exclusiveMinimum" = 0, "maximum" = 1))]
    pub block_time_step_factor: Option<f64>,
    /// Bound of the blocks' sub-step: `Eigenvalues` in a scene with slides, else `Compliances`.
    #[serde(default)]
    pub block_step_bound: Option<StepBoundFile>,
    /// Detection of the common plane of two blocks.
    #[serde(default)]
    pub contact_detection: ContactDetectionFile,
    /// Normal contact law of spheres.
    #[serde(default)]
    pub normal_law: NormalLawFile,
    /// Angular velocity that rolling resistance of spheres acts on.
    #[serde(default)]
    pub rolling_law: RollingLawFile,
    /// Damping of blocks in the search for a static equilibrium; none in dynamic runs.
    #[serde(default)]
    pub static_damping: Option<StaticDampingFile>,
    /// Sleep of blocks at rest until their load changes; all blocks are computed when left out.
    #[serde(default)]
    pub resting: Option<RestingFile>,
}

/// A fluid scheme with its parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Preset {
    /// Density by summation and Mueller's kernels, as published, misprints corrected.
    Mueller2003,
    /// For a first look: `Standard` with a speed of sound of five instead of seven times the fastest expected speed.
    Preview,
    /// Wendland kernel, density from continuity with diffusion, the viscosity of the fluid, walls of particles; the longest
    /// step that the scheme allows.
    #[default]
    Standard,
    /// For accuracy, with the settings that studies show to improve it: a wide kernel in three dimensions, too, and a speed
    /// of sound of fourteen times the fastest expected speed.
    Reference,
}

/// A smoothing kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum KernelFile {
    /// Poly6 for density, spiky for pressure.
    Mueller,
    /// Wendland's C2.
    WendlandC2,
    /// The cubic spline, for comparison: particles pair above some 60 neighbors.
    CubicSpline,
}

/// Computation of density.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum DensityFile {
    /// By a sum over neighbors: underestimated near surfaces and walls.
    Summation,
    /// By integration of the continuity equation.
    Continuity,
}

/// Pressure from density.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum StateEquationFile {
    /// `p = c₀² (ρ − ρ₀)`.
    Linear,
    /// `p = c₀² ρ₀/7 ((ρ/ρ₀)⁷ − 1)`.
    Tait,
}

/// Density diffusion, with its coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum DensityDiffusionFile {
    /// None.
    #[serde(alias = "None")]
    Off,
    /// Acts on the hydrostatic gradient, too: wrong near free surfaces.
    #[schemars(extend("x-unit" = "-"))]
    MolteniColagrossi(f64),
    /// Preserves the hydrostatic gradient.
    #[schemars(extend("x-unit" = "-"))]
    Fourtakas(f64),
    /// Preserves every linear gradient; requires one more sum.
    #[schemars(extend("x-unit" = "-"))]
    Antuono(f64),
}

/// Viscosity model. All but the artificial one use the viscosity of the fluid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum ViscosityFile {
    /// None.
    #[serde(alias = "None")]
    Off,
    /// The published form.
    Published,
    /// Monaghan's artificial viscosity, with its coefficient, 0.01 to 0.1.
    #[schemars(extend("x-unit" = "-"))]
    Artificial(f64),
    /// Along the line of centers: conserves angular momentum.
    Laminar,
    /// Along the velocity difference: better in shear.
    Morris,
    /// Form of Morris with the viscosity of each particle from the flow laws of the fluid and its regions; chosen if
    /// there are any.
    Rheological,
    /// Smagorinsky's model of eddies smaller than the spacing, with its coefficient, customarily 0.12, in addition to
    /// the viscosity of the fluid; only where the spacing resolves the flow.
    #[schemars(extend("x-unit" = "-"))]
    SubParticleScale(f64),
}

/// Velocities at which a step takes the viscous force, with the viscosities `Rheological`, `Morris` and `SubParticleScale`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum ViscousStepFile {
    /// `Implicit` where explicit steps at the largest viscosity, that at rest, would be shorter than half of those of sound and
    /// where the other options allow it, else `Explicit`.
    #[default]
    Auto,
    /// Those at hand: the step is proportional to the inverse of the largest viscosity.
    Explicit,
    /// Those after the step, solved for by conjugate gradients in some sums over neighbors: 5 a step in a slump of mud. Viscosity does not
    /// limit the step. Not with sleeping water, `PredictorCorrector`, `slip: Friction`, walls of `Integral` that do not slip, and free
    /// blocks of less than twice the mass `ρ A √(ν dt)` of what sticks to them in a step.
    Implicit,
}

/// Particle shifting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum ShiftingFile {
    /// None.
    #[serde(alias = "None")]
    Off,
    /// Toward lower particle concentration, with its coefficient, customarily 2.
    #[schemars(extend("x-unit" = "-"))]
    Fickian(f64),
}

/// Time integration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum SteppingFile {
    /// Half kick, drift with the density advanced half way, half kick: second order, one evaluation per step.
    KickDriftKick,
    /// Scheme of DualSPHysics: second order, two evaluations and shorter steps; requires density diffusion.
    PredictorCorrector,
    /// As published: velocities first, then positions from them; one evaluation per step, `Summation` only.
    SymplecticEuler,
}

/// Floating-point precision of the sums over neighbors; everything else is in double precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum PrecisionFile {
    /// 7 digits, twice as fast.
    Single,
    /// 16 digits.
    Double,
}

/// Treatment of negative pressures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum NegativePressure {
    /// Set to zero: water carries no tension.
    Clamped,
    /// Kept.
    Kept,
}

/// Water at rest sleeps in tiles of three support radii: it is not updated until water beside it has moved or a block
/// approaches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SleepingFile {
    /// Mean horizontal displacement of the water in a tile, over the particle spacing, that wakes the tiles around it. 0.003 when
    /// left out: crests of a solitary wave ten rows deep are then within 0.4 % of those of water that is all awake, at 0.01 0.5
    /// %, at 0.03 1.8 %, at 0.1 12 %.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "exclusiveMinimum" = 0))]
    pub displacement: Option<f64>,
    /// Root mean square speed in a tile below which it is at rest; m/s. A thousandth of the speed of long waves when
    /// left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "m/s"))]
    pub speed: Option<f64>,
    /// Time at rest before it is put to sleep; s. Ten times `√(depth/g)` when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub time: Option<f64>,
}

/// Blocks at rest sleep, with their contacts, until their load changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RestingFile {
    /// Largest displacement within `time` of a block at rest, over its size. 0.001 when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "exclusiveMinimum" = 0))]
    pub displacement: Option<f64>,
    /// Time at rest before it is put to sleep; s. Twice `√(size/g)` of the largest free block when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
    pub time: Option<f64>,
    /// Change of its load that wakes it, over its weight. 0.2 when left out.
    #[serde(default)]
    #[schemars(extend("x-unit" = "-", "exclusiveMinimum" = 0))]
    pub load: Option<f64>,
}

/// Time integration of the blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum BlockIntegratorFile {
    /// Explicit, with springs and dashpots at contacts: for impacts and loads of water. Steps are short fractions of the time of a contact.
    #[default]
    CentralDifference,
    /// Contact dynamics: all contacts of a step are solved together, without springs, in steps of milliseconds. For walls and arches, piles
    /// that come to rest and long runs; `contact_stiffness` has no effect. Impacts and changes between sticking and sliding are good
    /// to the first order of the step. Deformable blocks take the same steps as rigid ones; their oscillations are damped where a step does
    /// not resolve them.
    ContactDynamics {
        /// Step of the blocks; s. When left out, 0.03 `√(size/g)` of the smallest free block. Shorter where a block would move by more than a
        /// fifth of its size in it, or turn or strain by more than 0.1.
        #[serde(default)]
        #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
        time_step: Option<f64>,
        /// Residual of the laws of contact at which a step is solved. 0.0001 when left out; where reactions matter, as in arches,
        /// 0.000001.
        #[serde(default)]
        #[schemars(extend("x-unit" = "-", "exclusiveMinimum" = 0))]
        tolerance: Option<f64>,
        /// Sweeps and iterations over the contacts of a step at most. 300 when left out.
        #[serde(default)]
        #[schemars(extend("minimum" = 1))]
        sweeps: Option<u32>,
        /// Solver of all contacts.
        #[serde(default)]
        solver: ContactSolverFile,
    },
}

/// Solver of all contacts in contact dynamics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum ContactSolverFile {
    /// Gauss-Seidel, and the gradient in steps where it is slow or the tolerance is tight.
    #[default]
    Chosen,
    /// Gauss-Seidel sweeps alone.
    GaussSeidel,
    /// The accelerated projected gradient alone.
    Gradient,
}

/// Bound of the blocks' sub-step, never above the stability limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum StepBoundFile {
    /// From the compliances of a block in all directions at all its contacts, added up: two to four times below the limit, which
    /// resolves impacts.
    Compliances,
    /// From the largest eigenvalues of the stiffness and the damping of each block: close to the limit in a pile, where the long
    /// contacts of sliding blocks matter and single hits do not.
    Eigenvalues,
}

/// Detection of the common plane of two blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum ContactDetectionFile {
    /// Verified by the separating-axis test: every overlap is found.
    #[default]
    Verified,
    /// By the fast common plane alone, as published; for comparison.
    FastCommonPlane,
}

/// Normal contact law of spheres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum NormalLawFile {
    /// Linear spring with the material's `contact_stiffness`.
    #[default]
    Linear,
    /// Hertz's law, from the elastic moduli, which every material must then have.
    Hertz,
}

/// Angular velocity that rolling resistance of spheres acts on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum RollingLawFile {
    /// Relative angular velocity of the two: equal and opposite torques.
    #[default]
    Relative,
    /// Angular velocity of each sphere by itself, as published by Zhou et al. (1999); angular momentum is not
    /// conserved.
    OwnSpin,
}

/// Damping for statics. The energy it dissipates is in the ledger.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum StaticDampingFile {
    /// Force per mass opposite to the velocity; 1/s.
    #[schemars(extend("x-unit" = "1/s"))]
    MassProportional(f64),
    /// Fraction of each component of force and torque, opposite to its velocity, in [0, 1).
    #[schemars(extend("x-unit" = "-"))]
    Local(f64),
    /// Factor on velocities after each block step, above 0 and at most 1.
    #[schemars(extend("x-unit" = "-"))]
    Kinetic(f64),
}
