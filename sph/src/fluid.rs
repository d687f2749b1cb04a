//! The fluid: particles with their settings, and the pieces of which `stepping` makes a step.
//!
//! ```text
//! sort        sort by cell, particles that leave            energy      energies, momentum, accounts
//! advance     kicks, drifts, densities                      exchange    particles in and out, imposed flow
//! evaluate    rates, pressures, accelerations               sleep       water at rest
//! viscosity   flow laws, rates of shear                     sample      fields at points of probes
//! bulk        viscosity against compression                 continued_pressure   at points of walls
//! porosity    water that shares its volume with grains
//! viscous_step   implicit viscosity
//! shifting    towards where particles are sparse            symmetry    reflection by planes, their force
//! ```

mod advance;
mod at_start;
mod bulk;
mod checkpoint;
mod continued_pressure;
pub mod energy;
mod evaluate;
pub mod exchange;
mod packing;
pub(crate) mod porosity;
pub(crate) mod rates;
pub mod sample;
pub(crate) mod scratch;
mod shifting;
mod skin;
pub(crate) mod sleep;
mod sort;
mod speeds;
pub(crate) mod sums;
mod surface;
mod symmetry;
mod viscosity;
mod viscous_step;
mod viscous_unknowns;
pub(crate) mod wall_sums;

use crate::error::FluidError;
use crate::kernel::{Kernel, PointKernel};
use crate::neighbors::cells::CellGrid;
use crate::neighbors::lists::Lists;
use crate::neighbors::points::Frame;
use crate::neighbors::thin_solids::{Plane, ThinSolids};
use crate::scheme::{DensityMethod, Viscosity};
use crate::state_equation::State;
use crate::{Particles, Rheology, Vec3};

use at_start::AtStart;
use scratch::Scratch;
use skin::Skin;
use sleep::Sleep;

pub use crate::settings::{Settings, StepLimits};
pub use continued_pressure::ContinuedPressure;
pub use energy::Removed;
pub use evaluate::ParticleForce;

/// Most particles that neighbor ids can number.
pub const MAX_PARTICLES: usize = 1 << 31;
/// Cells that a grid may always have, whatever the number of particles.
const FEWEST_CELL_LIMIT: usize = 1 << 16;
/// Cells per particle beyond which the grid is made coarser.
const CELLS_PER_PARTICLE: usize = 8;

/// Particles at the start, one slot each.
#[derive(Clone, Debug, Default)]
pub struct Start {
    /// m.
    pub positions: Vec<Vec3>,
    /// m/s.
    pub velocities: Vec<Vec3>,
    /// Pressure, from which density and mass follow; zero everywhere when empty. Summation density
    /// takes no notice of it; Pa.
    pub pressures: Vec<f64>,
}

/// Water as particles.
#[derive(Clone, Debug)]
pub struct Fluid {
    pub(crate) settings: Settings,
    pub(crate) state: State,
    pub(crate) particles: Particles,
    pub(crate) grid: CellGrid,
    pub(crate) frame: Frame,
    pub(crate) lists: Lists,
    pub(crate) thin_solids: ThinSolids,
    pub(crate) at_start: AtStart,
    /// Sleeping water, if enabled.
    pub(crate) sleep: Option<Box<Sleep>>,
    /// Flow laws by [`Particles::kind`].
    rheologies: Vec<Rheology>,
    /// Volume of a particle at the reference density; m³.
    particle_volume: f64,
    /// Kernel sum over the undisturbed lattice, by which summation density is divided.
    lattice_sum: f64,
    /// Approach of two particles that requires a new sort.
    skin: Skin,
    /// Widest that it may become: what cells allow; m.
    widest_skin: f64,
    /// Sorts since it was made or read.
    sorts: u64,
    /// Farthest that particles may have moved since the last sort; m.
    pub(crate) moved: f64,
    /// Most that the distance of two particles may have changed since the last sort; m.
    pub(crate) approached: f64,
    /// Largest speed at the last kick; m/s.
    max_speed: f64,
    /// Bound on the relative speed of two particles at the last kick; m/s.
    closing_speed: f64,
    /// Ordered pairs of the last sum.
    n_pairs: u64,
    /// Products of the last implicit viscous step.
    n_products: u32,
    /// Work of the viscous force on the fluid since the ledger was opened, negated; J.
    viscous_loss: f64,
    /// Energy taken by bulk viscosity since the ledger was opened; J.
    bulk_loss: f64,
    /// Energy that the pressure of walls gave since the ledger was opened; J.
    from_walls: f64,
    /// Energy of compression taken by density diffusion since the ledger was opened; J.
    pub(crate) diffusive_loss: f64,
    /// Energy of compression withheld from crowded particles since the ledger was opened; J.
    withheld_loss: f64,
    /// Energy from the pressure of walls through grains that share the volume of the fluid since the ledger was opened; J.
    from_walls_by_grains: f64,
    removed: Removed,
    /// Force of the planes of symmetry at the last evaluation; N.
    pub(crate) plane_force: Vec3,
    /// Momentum of particles reflected by the planes of symmetry since the ledger was opened; kg m/s.
    pub(crate) reflected: Vec3,
    pub(crate) scratch: Scratch,
}

impl Fluid {
    /// Fluid in the state `start`.
    ///
    /// # Errors
    ///
    /// [`FluidError::Setting`] for a setting out of range, [`FluidError::NarrowPeriod`] for a slab
    /// narrower than the support, [`FluidError::Symmetry`] for a plane in which nothing can be mirrored,
    /// [`FluidError::TooManyParticles`].
    pub fn new(start: Start, settings: Settings) -> Result<Self, FluidError> {
        settings.check()?;
        let n = start.positions.len();
        if n >= MAX_PARTICLES {
            return Err(FluidError::TooManyParticles {
                count: n,
                limit: MAX_PARTICLES,
            });
        }
        let max_cells = (n * CELLS_PER_PARTICLE).max(FEWEST_CELL_LIMIT);
        let support = settings.support_radius();
        let widest_skin = settings.widest_skin();
        let grid = CellGrid::new(
            settings.domain,
            settings.periodic,
            (support, widest_skin),
            max_cells,
        )?;
        let scheme = &settings.scheme;
        let state = State {
            equation: scheme.state_equation,
            reference_density: settings.reference_density,
            sound_speed: settings.sound_speed,
            negative: scheme.negative_pressure,
        };
        let kernel = PointKernel::new(scheme.kernel, support, settings.dimensions);
        let lattice_sum = kernel.lattice_sum(settings.particle_spacing);
        let particle_volume = settings.particle_spacing.iter().product::<f64>();
        let mut particles = Particles::new(start.positions, start.velocities);
        for a in 0..n {
            let pressure = match scheme.density {
                DensityMethod::Continuity => start.pressures.get(a).copied().unwrap_or(0.0),
                DensityMethod::Summation => 0.0,
            };
            particles.density[a] = state.density(pressure);
            particles.mass[a] = particles.density[a] * particle_volume;
        }
        Ok(Self {
            frame: Frame::new(&grid, support),
            lists: Lists::default(),
            rheologies: match scheme.viscosity {
                Viscosity::Rheological { rheology } => vec![rheology],
                _ => Vec::new(),
            },
            grid,
            state,
            particles,
            thin_solids: ThinSolids::default(),
            at_start: AtStart::default(),
            sleep: None,
            particle_volume,
            lattice_sum,
            skin: Skin::new(support, widest_skin),
            widest_skin,
            sorts: 0,
            // nothing is sorted yet
            moved: f64::INFINITY,
            approached: f64::INFINITY,
            max_speed: 0.0,
            closing_speed: 0.0,
            n_pairs: 0,
            n_products: 0,
            viscous_loss: 0.0,
            bulk_loss: 0.0,
            from_walls: 0.0,
            diffusive_loss: 0.0,
            withheld_loss: 0.0,
            from_walls_by_grains: 0.0,
            removed: Removed::default(),
            plane_force: Vec3::zeros(),
            reflected: Vec3::zeros(),
            scratch: Scratch::default(),
            settings,
        })
    }

    /// The settings it was made with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The particles, sorted by cell at the last [`Self::refresh`] that found it necessary.
    pub fn particles(&self) -> &Particles {
        &self.particles
    }

    /// The cells of the last sort.
    pub fn grid(&self) -> &CellGrid {
        &self.grid
    }

    /// Number of thin solids.
    pub fn n_thin_solids(&self) -> usize {
        self.thin_solids.len()
    }

    /// Removes all thin solids.
    pub fn clear_thin_solids(&mut self) {
        self.thin_solids.clear();
    }

    /// Adds a thin solid at its current position: a convex solid by the planes of its faces, each with the number of its
    /// side, with a bounding box (m).
    /// Particles do not interact through it. Planes of symmetry do not mirror it: one that touches them has to continue
    /// beyond them unchanged, with planes of infinite offset for its ends there.
    pub fn add_thin_solid(
        &mut self,
        planes: impl Iterator<Item = (Plane, u32)>,
        bounds: (Vec3, Vec3),
    ) {
        // particles may have left the cells that they were sorted into
        let reach = self.settings.support_radius() + self.widest_skin;
        self.thin_solids.add(planes, bounds, &self.grid, reach);
    }

    /// Adds a convex solid with its own walls that the last thin solid extends into, where the latter is inactive.
    pub fn cover_thin_solid(&mut self, planes: impl Iterator<Item = Plane>) {
        self.thin_solids.cover(planes);
    }

    /// Memory of the lists of neighbors; bytes.
    pub fn list_memory(&self) -> usize {
        self.lists.memory()
    }

    /// Mass of a particle at the reference density; kg.
    pub fn particle_mass(&self) -> f64 {
        self.settings.reference_density * self.particle_volume
    }

    /// Volume of a particle at the reference density; m³.
    pub fn particle_volume(&self) -> f64 {
        self.particle_volume
    }

    /// The equation of state.
    pub fn state_equation(&self) -> &State {
        &self.state
    }

    /// Ordered pairs of the last sum over neighbors, the particle itself not counted.
    pub fn n_pairs(&self) -> u64 {
        self.n_pairs
    }

    /// Calls `visit` with every number of the state, particle by particle in order of id.
    pub fn visit_state(&self, mut visit: impl FnMut(f64)) {
        let mut order: Vec<usize> = (0..self.particles.len()).collect();
        order.sort_unstable_by_key(|&a| self.particles.id[a]);
        for a in order {
            visit(f64::from(u32::from(self.particles.id[a])));
            self.particles.position[a].iter().for_each(|&x| visit(x));
            self.particles.velocity[a].iter().for_each(|&v| visit(v));
            visit(self.particles.density[a]);
        }
    }
}
