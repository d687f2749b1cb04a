//! Weakly compressible smoothed particle hydrodynamics (SPH) for water with a free surface.
//!
//! # Theory
//!
//! Water is a set of particles of equal mass `m` that carry position, velocity, density and
//! pressure. Fields are sums over neighbours `b` of a particle `a` within the support radius `H`
//! of a kernel `W`. The published scheme (Mueller, Charypar & Gross 2003, as used by Geraili
//! Mikola & Sitar 2014) reads, with the misprints of the latter corrected:
//!
//! ```text
//! ρ_a   = Σ_b m W_poly6(r_ab) / S                       density, b = a included      [kg/m³]
//! p_a   = c₀² (ρ_a − ρ₀)                                equation of state            [Pa]
//! a_a^p = − Σ_b m (p_a + p_b)/(ρ_a ρ_b) ∇W_spiky       pressure                     [m/s²]
//! a_a^v = μ Σ_b m (v_b − v_a)/(ρ_a ρ_b) ∇²W_visc        viscosity                    [m/s²]
//! ```
//!
//! `S` is the kernel's sum over the undisturbed lattice, so that water at rest on a lattice has
//! exactly the reference density. Density and pressure use different kernels; the scheme conserves
//! momentum to round-off but has no exact discrete energy, and its ledger shows that.
//!
//! Time stepping is kick-drift-kick, algebraically the published symplectic Euler with velocities
//! stored half a step apart. Stability limits on a lattice: `dt ≤ 0.95 H/c₀` and
//! `dt ≤ 0.127 H² ρ₀/μ`.
//!
//! # Signs and names
//!
//! `a` receives, `b` is the neighbour; vectors between them point from `b` to `a`. Pressure is
//! positive in compression. `h` is always the smoothing length; the support radius of every kernel
//! here is `H = 2h`. Units are SI.
//!
//! # Reading order
//!
//! [`kernel`], [`particles`], [`cells`], [`neighbors`], [`state_equation`], [`mueller`], [`fluid`],
//! [`sample`], [`energy`].
//!
//! # References
//!
//! Monaghan (1994, 2005); Mueller, Charypar & Gross (2003); Geraili Mikola & Sitar (2014).

pub mod boundary;
pub mod cells;
pub mod energy;
pub mod error;
pub mod exchange;
pub mod fluid;
pub mod kernel;
mod lanes;
pub mod particles;
mod points;
pub mod sample;
pub mod scheme;
pub mod state_equation;
mod sums;
mod sweep;
mod terms;

pub use cells::{CellGrid, Periodicity};
pub use energy::Energies;
pub use error::FluidError;
pub use exchange::{Absorber, Exchange};
pub use fluid::{Fluid, ParticleForce, Settings, Start, StepLimits};
pub use kernel::{Dimensions, KernelChoice};
pub use particles::Particles;
pub use scheme::Scheme;
pub use state_equation::{NegativePressure, StateEquation};
pub use sweep::Precision;

/// A vector or point, m, m/s, ...
pub type Vec3 = nalgebra::Vector3<f64>;

/// Particles per parallel task. A constant, so that sums do not depend on the number of threads.
pub(crate) const CHUNK: usize = 256;
