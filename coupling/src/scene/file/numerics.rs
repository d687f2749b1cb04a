//! Schemes and their numbers, of the fluid and of the blocks.

use serde::{Deserialize, Serialize};

/// Schemes and their numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[derive(Default)]
pub struct NumericsFile {
    /// The fluid scheme whose numbers hold where none is given.
    #[serde(default)]
    pub preset: Preset,
    /// Smoothing kernel.
    #[serde(default)]
    pub kernel: Option<KernelFile>,
    /// How density is found.
    #[serde(default)]
    pub density: Option<DensityFile>,
    /// Pressure from density.
    #[serde(default)]
    pub state_equation: Option<StateEquationFile>,
    /// What smooths the density of `Continuity`; the number is its coefficient, customarily 0.1. `Some(None)` for nothing: `None` by itself leaves it chosen.
    #[serde(default)]
    pub density_diffusion: Option<DensityDiffusionFile>,
    /// What resists shear. `Some(None)` for nothing: `None` by itself leaves it chosen.
    #[serde(default)]
    pub viscosity: Option<ViscosityFile>,
    /// What keeps particles evenly spread. `Some(None)` for nothing: `None` by itself leaves it chosen.
    #[serde(default)]
    pub shifting: Option<ShiftingFile>,
    /// How a step is taken.
    #[serde(default)]
    pub stepping: Option<SteppingFile>,
    /// Width of numbers in the sums over neighbours.
    #[serde(default)]
    pub precision: Option<PrecisionFile>,
    /// Smoothing length over particle spacing; the support radius is twice the smoothing length.
    #[serde(default)]
    pub smoothing_length_ratio: Option<f64>,
    /// Numerical sound speed; m/s. Chosen as ten times the fastest expected speed when left out.
    #[serde(default)]
    pub sound_speed: Option<f64>,
    /// Fastest flow expected, from which the sound speed follows; m/s.
    #[serde(default)]
    pub expected_speed: Option<f64>,
    /// Share of the fluid's stability limit that a step may use, above 0 and at most 1.
    #[serde(default)]
    pub time_step_factor: Option<f64>,
    /// What is done with pressures below zero.
    #[serde(default)]
    pub negative_pressure: Option<NegativePressure>,
    /// When water at rest is left out until it is disturbed; all of it is computed when left out.
    #[serde(default)]
    pub sleeping: Option<SleepingFile>,
    /// Share of the blocks' stability limit that a sub-step may use, above 0 and at most 1.
    #[serde(default)]
    pub block_time_step_factor: Option<f64>,
    /// How the common plane of two blocks is found.
    #[serde(default)]
    pub contact_detection: ContactDetectionFile,
    /// How balls answer to being pressed.
    #[serde(default)]
    pub normal_law: NormalLawFile,
    /// Which turning the rolling resistance of balls opposes.
    #[serde(default)]
    pub rolling_law: RollingLawFile,
    /// Damping of blocks in a search for a state of rest; none for blocks that move.
    #[serde(default)]
    pub static_damping: Option<StaticDampingFile>,
    /// When blocks that lie still are left out until their load changes; all are computed when left out.
    #[serde(default)]
    pub resting: Option<RestingFile>,
}

/// A fluid scheme with its numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Preset {
    /// Density by summation and Mueller's kernels, as published, misprints corrected.
    Mueller2003,
    /// A first look: `Standard` with the longest step that the scheme allows and a sound speed of seven instead of ten times
    /// the fastest expected speed.
    Preview,
    /// What coastal engineers use: Wendland's kernel, density from continuity with diffusion, particles in walls.
    #[default]
    Standard,
    /// Accuracy first, by what studies show to buy it: a wide kernel in space too, water's own viscosity, a sound speed of
    /// fourteen times the fastest expected speed.
    Reference,
}

/// A smoothing kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum KernelFile {
    /// Poly6 for density, spiky for pressure.
    Mueller,
    /// Wendland's C2.
    WendlandC2,
    /// The cubic spline, for comparison: particles pair above some 60 neighbours.
    CubicSpline,
}

/// How density is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DensityFile {
    /// By a sum over neighbours: low near surfaces and walls.
    Summation,
    /// By integrating the equation of continuity.
    Continuity,
}

/// Pressure from density.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StateEquationFile {
    /// `p = c₀² (ρ − ρ₀)`.
    Linear,
    /// `p = c₀² ρ₀/7 ((ρ/ρ₀)⁷ − 1)`.
    Tait,
}

/// What smooths the density, with its coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum DensityDiffusionFile {
    /// Nothing.
    None,
    /// Works on the hydrostatic gradient too: wrong near free surfaces.
    MolteniColagrossi(f64),
    /// Spares the hydrostatic gradient.
    Fourtakas(f64),
    /// Spares every linear gradient; one more sum.
    Antuono(f64),
}

/// What resists shear. All but the artificial one use the viscosity of the fluid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ViscosityFile {
    /// Nothing.
    None,
    /// The published form.
    Published,
    /// Monaghan's, with its coefficient, 0.01 to 0.1.
    Artificial(f64),
    /// Along the line of centres: conserves angular momentum.
    Laminar,
    /// Along the difference of velocities: better in shear.
    Morris,
    /// That of Morris with a viscosity of each particle from the flow laws of the fluid and its regions; chosen
    /// where there are any.
    Rheological,
    /// Smagorinsky's eddies smaller than the spacing, with its coefficient, customarily 0.12, on top of the
    /// viscosity of the fluid; only where the spacing resolves the flow.
    SubParticleScale(f64),
}

/// What keeps particles evenly spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ShiftingFile {
    /// Nothing.
    None,
    /// Towards where particles are sparse, with its coefficient, customarily 2.
    Fickian(f64),
}

/// How a step is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SteppingFile {
    /// Half kick, drift with density half way, half kick: second order, one evaluation a step.
    KickDriftKick,
    /// That of DualSPHysics: second order, two evaluations and shorter steps; wants density diffusion.
    PredictorCorrector,
    /// As published: velocities, then positions with them; one evaluation a step, `Summation` only.
    SymplecticEuler,
}

/// Width of numbers in the sums over neighbours; everything else is in double precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PrecisionFile {
    /// 7 digits, twice as fast.
    Single,
    /// 16 digits.
    Double,
}

/// What is done with pressures below zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NegativePressure {
    /// Set to zero: water does not pull.
    Clamped,
    /// Kept.
    Kept,
}

/// Water at rest sleeps: it is held as it is, tile by tile of three support radii, until water beside it has moved or a block comes near.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SleepingFile {
    /// Mean horizontal displacement of the water in a tile, over the particle spacing, from which on the tiles around it are awake.
    #[serde(default)]
    pub displacement: Option<f64>,
    /// Root mean square of the speed in a tile up to which it is at rest; m/s. A thousandth of the speed of long waves when left out.
    #[serde(default)]
    pub speed: Option<f64>,
    /// How long it is to be no faster before it sleeps; s. Ten times `√(depth/g)` when left out.
    #[serde(default)]
    pub time: Option<f64>,
}

/// Blocks that lie still sleep, with their contacts, until their load changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RestingFile {
    /// Farthest way within `time` of a block at rest, over its size. 0.001 when left out.
    #[serde(default)]
    pub displacement: Option<f64>,
    /// How long it has to be at rest; s. Twice `√(size/g)` of the largest free block when left out.
    #[serde(default)]
    pub time: Option<f64>,
    /// Change of its load that wakes it, over its weight. 0.2 when left out.
    #[serde(default)]
    pub load: Option<f64>,
}

/// How the common plane of two blocks is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ContactDetectionFile {
    /// Verified by the separating-axis test: no overlap is missed.
    #[default]
    Verified,
    /// By the fast common plane alone, as published; for comparison.
    FastCommonPlane,
}

/// How balls answer to being pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum NormalLawFile {
    /// Spring of the material's `contact_stiffness`.
    #[default]
    Linear,
    /// Hertz's, from the elastic moduli, which every material then needs.
    Hertz,
}

/// Which turning the rolling resistance of balls opposes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum RollingLawFile {
    /// That of one against the other: equal and opposite torques.
    #[default]
    Relative,
    /// That of each ball on its own, as published by Zhou et al. (1999); angular momentum is lost.
    OwnSpin,
}

/// Damping for statics. What it takes stands in the ledger.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum StaticDampingFile {
    /// Force against velocity, per mass; 1/s.
    MassProportional(f64),
    /// Share of each component of force and torque, against its velocity, in [0, 1).
    Local(f64),
    /// Factor on velocities after each block step, above 0 and at most 1.
    Kinetic(f64),
}
