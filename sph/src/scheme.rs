//! Choices that make a scheme; [`crate::preset`] names combinations.
//!
//! Sources: Mueller, Charypar & Gross (2003) with Geraili Mikola & Sitar (2014); Molteni & Colagrossi
//! (2009), Fourtakas et al. (2019) and Antuono et al. (2010, 2012) for the diffusions and their 0.1;
//! Monaghan (1994) for the artificial viscosity; Domínguez et al. (2022) for the predictor-corrector; Lind et al. (2012) for shifting.

use crate::kernel::KernelChoice;
use crate::rheology::Rheology;
use crate::state_equation::{NegativePressure, StateEquation};

/// Width of the numbers in pair sums. Positions, velocities and densities are `f64` always.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Single: differences of positions and the sums themselves to 7 digits; twice as fast.
    #[default]
    Single,
    /// Double.
    Double,
}

/// Computation of density.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DensityMethod {
    /// `ρ_a = Σ m_b W_ab / S`, S the sum over the undisturbed lattice: low near surfaces and walls.
    Summation,
    /// `dρ_a/dt = ρ_a Σ V_b v_ab·∇W`, integrated.
    Continuity,
}

/// Density diffusion, with its coefficient δ, customarily 0.1.
///
/// ```text
/// D_a = δ h c₀ Σ V_b ψ_ab·∇W                                                 [kg/(m³ s)]
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DensityDiffusion {
    /// None.
    None,
    /// `ψ = 2 (ρ_b − ρ_a)(x_b − x_a)/r²`: wrong near free surfaces, where it works on the
    /// hydrostatic gradient. Molteni & Colagrossi (2009).
    MolteniColagrossi(f64),
    /// Diffusion of the density minus its hydrostatic part. Fourtakas et al. (2019), with the linear
    /// equation of state.
    Fourtakas(f64),
    /// Diffusion of the density minus the mean of the renormalized density gradients: third order. Antuono et al.
    /// (2010).
    Antuono(f64),
}

/// Viscosity model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Viscosity {
    /// Nothing.
    None,
    /// `μ Σ V_b (v_b − v_a) ∇²W/ρ_a`, Mueller's viscous kernel; Pa s.
    Published {
        /// Dynamic viscosity; Pa s.
        dynamic_viscosity: f64,
    },
    /// Monaghan's: on approaching pairs only, `Π = −α c₀ h (v·x)/(ρ (r² + 0.01 h²))`.
    Artificial {
        /// Coefficient α, 0.01 to 0.1.
        alpha: f64,
    },
    /// `2(d+2) ν Σ m_b/ρ (v·x)/(r² + 0.01 h²) ∇W`: conserves angular momentum.
    Laminar {
        /// Kinematic viscosity; m²/s.
        kinematic_viscosity: f64,
    },
    /// `2 ν Σ m_b/ρ (x·∇W)/(r² + 0.01 h²) v`, Morris, Fox & Zhu (1997): better in shear.
    Morris {
        /// Kinematic viscosity; m²/s.
        kinematic_viscosity: f64,
    },
    /// Morris's form with a viscosity of each particle from its rate of shear, pairs sharing the
    /// harmonic mean.
    Rheological {
        /// Flow law of all particles without their own, see
        /// [`crate::Fluid::set_rheologies`].
        rheology: Rheology,
    },
    /// Eddies smaller than the spacing: the same with `ν + (C dp)² γ̇`, Smagorinsky's model as in
    /// Gotoh et al. (2001). The isotropic part, `0.0066 ρ dp² γ̇²`, is left in the pressure. Only where the
    /// spacing resolves the flow.
    SubParticleScale {
        /// Kinematic viscosity; m²/s.
        kinematic_viscosity: f64,
        /// Smagorinsky's `C`, customarily [`SMAGORINSKY`].
        smagorinsky: f64,
    },
}

impl Viscosity {
    /// Whether each particle has its own viscosity.
    pub fn varies(&self) -> bool {
        matches!(
            self,
            Self::Rheological { .. } | Self::SubParticleScale { .. }
        )
    }

    /// Whether it is Morris's form, with any viscosity: its force is linear in the velocities and along their differences, as
    /// implicit steps require.
    pub fn is_after_morris(&self) -> bool {
        self.varies() || matches!(self, Self::Morris { .. })
    }
}

/// Velocities at which a step takes the viscous force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ViscousStep {
    /// Those at the evaluation: viscosity limits the step.
    #[default]
    Explicit,
    /// Those after the kicks, solved for: viscosity does not limit the step. With the viscosities [`Viscosity::is_after_morris`]
    /// names, and not with [`Stepping::PredictorCorrector`]; see the module of that name of the fluid.
    Implicit,
}

/// Particle shifting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shifting {
    /// Nothing.
    None,
    /// `δx = −A h |v| dt ∇C`, none at the free surface. Lind et al. (2012), coefficients as in
    /// common use.
    Fickian {
        /// Coefficient A, customarily 2.
        coefficient: f64,
    },
}

/// Time integration. The cost is given in sums over all pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stepping {
    /// Half kick, half drift, density, half drift, forces, half kick: second order, and reversible where
    /// nothing is lost. One sum of rates and one of forces.
    KickDriftKick,
    /// Rates and forces at the start advance the state to the middle; those at the middle advance it from the start to
    /// the end. Second order. Two sums of rates and two of forces.
    ///
    /// ```text
    /// v½ = v + dt/2 a        x½ = x + dt/2 v                 ρ½ = ρ + dt/2 ρ'
    /// v₁ = v + dt a½         x₁ = x + dt/2 (v + v₁)          ρ₁ = ρ (2 − ε)/(2 + ε),   ε = −(ρ'/ρ)½ dt
    /// ```
    /// Domínguez et al. (2022). To sound this is the explicit midpoint rule: a wave that nothing damps grows
    /// by `(ω dt)⁴/8` a step, so that density from continuity wants diffusion. With summation it is
    /// drift-kick-drift, and nothing grows.
    PredictorCorrector,
    /// Forces, then velocities, then positions with the new velocities: kick-drift-kick with velocities half a
    /// step behind. One sum of densities and one of forces. Only with summation: with continuity it is
    /// forward Euler for sound. Geraili Mikola & Sitar (2014).
    SymplecticEuler,
}

impl Stepping {
    /// Whether rates of density are taken from the same state as forces.
    pub(crate) fn rates_with_forces(self) -> bool {
        self == Self::PredictorCorrector
    }
}

/// A scheme: one choice per part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scheme {
    /// Kernel.
    pub kernel: KernelChoice,
    /// Density.
    pub density: DensityMethod,
    /// Equation of state.
    pub state_equation: StateEquation,
    /// Treatment of negative pressures.
    pub negative_pressure: NegativePressure,
    /// Density diffusion; off with summation.
    pub diffusion: DensityDiffusion,
    /// Viscosity.
    pub viscosity: Viscosity,
    /// Velocities at which a step takes the viscous force.
    pub viscous_step: ViscousStep,
    /// Coefficient `α₂` of bulk viscosity, `ζ = α₂ ρ₀ c₀ h`, 0 to [`LARGEST_BULK_VISCOSITY`]: damps sound, and no flow
    /// that keeps its volume. Of density from continuity only.
    pub bulk_viscosity: f64,
    /// Shifting.
    pub shifting: Shifting,
    /// Stepping.
    pub stepping: Stepping,
    /// Width of numbers in pair sums.
    pub precision: Precision,
}

/// δ of the presets: the value of every code in common use.
pub const DIFFUSION: f64 = 0.1;
/// α of `Standard`: within Monaghan's 0.01 to 0.1 for water; with δ = 0.1 it keeps a still tank still.
pub const ALPHA: f64 = 0.02;
/// Largest `α₂`: above it the shortest sound would no longer oscillate, and the step falls as its inverse, see
/// [`crate::Fluid::step_limits`].
pub const LARGEST_BULK_VISCOSITY: f64 = 1.0;
/// A of shifting. Lind et al. (2012).
pub const SHIFTING: f64 = 2.0;
/// `C` of the sub-particle-scale viscosity. Dalrymple & Rogers (2006).
pub const SMAGORINSKY: f64 = 0.12;

impl Scheme {
    /// The published scheme, misprints corrected.
    pub fn mueller2003(dynamic_viscosity: f64) -> Self {
        Self {
            kernel: KernelChoice::Mueller,
            density: DensityMethod::Summation,
            state_equation: StateEquation::Linear,
            negative_pressure: NegativePressure::Clamped,
            diffusion: DensityDiffusion::None,
            viscosity: Viscosity::Published { dynamic_viscosity },
            viscous_step: ViscousStep::Explicit,
            bulk_viscosity: 0.0,
            shifting: Shifting::None,
            stepping: Stepping::SymplecticEuler,
            precision: Precision::Double,
        }
    }

    /// Common practice in coastal engineering, with artificial viscosity: in every wave it takes much more than water's own
    /// does.
    pub fn artificial() -> Self {
        Self {
            kernel: KernelChoice::WendlandC2,
            density: DensityMethod::Continuity,
            state_equation: StateEquation::Linear,
            negative_pressure: NegativePressure::Kept,
            diffusion: DensityDiffusion::Fourtakas(DIFFUSION),
            viscosity: Viscosity::Artificial { alpha: ALPHA },
            viscous_step: ViscousStep::Explicit,
            bulk_viscosity: 0.0,
            shifting: Shifting::None,
            stepping: Stepping::KickDriftKick,
            precision: Precision::Single,
        }
    }

    /// The same with the viscosity of the fluid (m²/s).
    pub fn laminar(kinematic_viscosity: f64) -> Self {
        Self {
            viscosity: Viscosity::Laminar {
                kinematic_viscosity,
            },
            ..Self::artificial()
        }
    }
}
