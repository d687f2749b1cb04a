//! Weakly compressible smoothed particle hydrodynamics (SPH) for water with a free surface.
//!
//! # Theory
//!
//! Water is a set of particles of mass `m` that carry position, velocity, density and pressure.
//! Fields are sums over neighbors `b` of a particle `a` within the support radius `H = 2h` of a
//! kernel `W`; `V = m/ρ`. Density follows from continuity, or from a sum:
//!
//! ```text
//! dρ_a/dt = ρ_a Σ_b V_b v_ab·∇W + δ h c₀ Σ_b V_b ψ_ab·∇W                          [kg/(m³ s)]
//! ρ_a     = Σ_b m_b W_ab / S,   b = a included                                       [kg/m³]
//! p_a     = c₀² (ρ_a − ρ₀)      or Tait's law, and bulk viscosity ζ/ρ_a dρ_a/dt           [Pa]
//! m_a dv_a/dt = −V_a Σ_b V_b (p_a + p_b) ∇W + viscous + m_a g + walls                    [N]
//! ```
//!
//! `S` is the kernel's sum over the undisturbed lattice. Each pair force is written once, with
//! volumes, and is equal and opposite: momentum is conserved to round-off, also angular momentum if
//! the force is central. With continuity and without diffusion and viscosity the scheme has an exact
//! discrete energy; the losses by diffusion, viscosity and walls are booked.
//!
//! [`scheme`] lists the choices (kernel, density, equation of state, diffusion, viscosity, shifting,
//! width of numbers) and the presets. The published scheme of Mueller, Charypar & Gross (2003), as
//! used by Geraili Mikola & Sitar (2014), is one of them: density and pressure by different kernels,
//! so it has no discrete energy, and its ledger shows that.
//!
//! # Steps
//!
//! Kick-drift-kick, with the density advanced in the middle of the drift: second order, and
//! reversible without losses. Density advanced with the old velocities would be forward Euler for
//! sound: every wave would grow, however small the step. On a lattice sound allows `dt ≤ 1.75 h/c₀`
//! (1.54 with the usual diffusion), the published scheme `0.95 H/c₀`. [`scheme::Stepping`] has two
//! more: the predictor-corrector of DualSPHysics, and the published symplectic Euler.
//!
//! Viscosity limits the step by `h²/ν`, which in mud with a yield stress is far below the limit of sound. [`scheme::ViscousStep`] has
//! implicit steps, in which it does not.
//!
//! # How sums are made
//!
//! Particles are sorted by cell. The candidates of a particle are nine runs of the sorted order;
//! eight at a time are tested on integer coordinates, whose differences are exact anywhere in the
//! domain, and the neighbors found are packed without a branch. They are summed in registers of
//! eight `f32` or four `f64`, each particle its own neighbors in the order of the cells: the same
//! bits for any number of threads. State is `f64` throughout; [`Precision`] is that of the sums.
//!
//! There are many sums of the fluid over itself between two sorts: the first lists the neighbors within the support
//! and a skin, and all use the lists, also across periodic sides and planes of symmetry (`lists`), as sums between fluid and
//! walls do; each sum has its own search (`sweep`) only where lists do not hold. The skin follows the speed of the flow (`skin`).
//!
//! # Walls
//!
//! [`boundary`]: particles inside solids with pressures continued from the fluid, and exact integrals
//! of the kernel over polyhedra. Penalty walls belong to whoever owns the solids.
//!
//! # Symmetry
//!
//! A side of the domain can be a plane of symmetry, which mirrors water and walls:
//! [`mirror`].
//!
//! # Sleep
//!
//! Water at rest may be left out until it is disturbed, tile by tile: `sleep`.
//!
//! # Signs and names
//!
//! `a` receives, `b` is the neighbor; vectors between them point from `b` to `a`. Pressure is
//! positive in compression. `h` is always the smoothing length. Units are SI.
//!
//! # Reading order
//!
//! [`kernel`], [`particles`], [`scheme`], [`state_equation`], `neighbors` ([`cells`], `lists`, `sweep`,
//! [`mirror`]), `simd`, `terms`, [`fluid`] ([`sample`], [`energy`], `sleep`), [`boundary`], `stepping`.
//!
//! # References
//!
//! Monaghan (1994, 2005); Morris, Fox & Zhu (1997); Mueller, Charypar & Gross (2003); Molteni &
//! Colagrossi (2009); Antuono et al. (2010); Lind et al. (2012); Adami, Hu & Adams (2012); Fourtakas
//! et al. (2019); Domínguez et al. (2022); Geraili Mikola & Sitar (2014).

pub mod boundary;
pub mod error;
pub mod exact_sum;
pub mod fluid;
mod id;
pub mod kernel;
pub mod neighbors;
pub mod particles;
pub mod preset;
mod repeated;
pub mod rheology;
pub mod scheme;
pub mod settings;
mod simd;
mod stability;
pub mod state_equation;
mod stepping;
mod terms;

pub use boundary::{Boundary, NoBoundary, Part, Phase, Stage};
pub use error::FluidError;
pub use fluid::energy::Energies;
pub use fluid::exchange::{Absorber, Exchange};
pub use fluid::sleep::Sleeping;
pub use fluid::{Fluid, ParticleForce, Start};
pub use fluid::{energy, exchange, sample};
pub use id::ParticleId;
pub use kernel::{Dimensions, KernelChoice};
pub use neighbors::cells::{CellGrid, Periodicity};
pub use neighbors::mirror::{Symmetry, SymmetryPlane};
pub use neighbors::{cells, mirror};
pub use particles::Particles;
pub use preset::{Preset, PresetParameters};
pub use rheology::{Regularization, Rheology};
pub use scheme::{Precision, Scheme, Stepping, ViscousStep};
pub use settings::{Settings, StepLimits};
pub use state_equation::{NegativePressure, StateEquation};

/// A vector or point, m, m/s, ...
pub type Vec3 = nalgebra::Vector3<f64>;

/// Particles per parallel task. A constant, so that sums do not depend on the number of threads.
pub(crate) const CHUNK: usize = 256;

/// Pieces of an array, in order, that are worked on before what was found is put to use, where each is found on its own:
/// memory for these only, and enough that threads seldom wait for each other.
pub fn pieces_at_once() -> usize {
    match rayon::current_num_threads() {
        1 => 16,
        n => 64 * n,
    }
}
