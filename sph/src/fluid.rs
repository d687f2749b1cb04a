//! The fluid: state, settings and the pieces of a time step.
//!
//! The caller drives the step, so that walls and blocks can act in between. Kick-drift-kick, the
//! density advanced where positions and velocities are those of the middle of the step:
//!
//! ```text
//! kick(dt/2); drift(dt/2); refresh; update_rates; (walls); advance_density(dt)
//! drift(dt/2); refresh; update_pressure; update_accelerations; (walls); kick(dt/2)
//! ```
//! Where viscosity varies, `update_strain; (walls); update_viscosity` go before the accelerations: once a
//! step, from the velocities that the forces see.
//!
//! With summation density there is nothing to advance: the drift is one, and `update_pressure` finds
//! density and pressure together. The density must not be advanced with the old velocities while the
//! velocities use the old density: every sound wave would grow, whatever the step.
//!
//! Predictor-corrector, where `evaluate` is `refresh; update_rates; (walls); update_pressure;
//! update_accelerations; (walls)`, and symplectic Euler:
//!
//! ```text
//! predict(dt/2); evaluate; correct(dt); drift(dt/2); evaluate
//! kick(dt); drift(dt); refresh; update_pressure; update_accelerations; (walls)
//! ```

mod checkpoint;
pub mod energy;
pub mod exchange;
mod packing;
pub mod sample;
pub(crate) mod sleep;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::boundary::screens::{Plane, Screens};
use crate::error::FluidError;
use crate::fluid::energy::fixed_order_sum;
use crate::fluid::sleep::{Sleep, Still};
use crate::kernel::{Dimensions, Kernel, PointKernel};
use crate::neighbors::cells::{CellGrid, Periodicity};
use crate::neighbors::lists::Lists;
use crate::neighbors::sweep::AnyPoints;
use crate::particles::filter;
use crate::scheme::{
    DIFFUSION, DensityDiffusion, DensityMethod, Scheme, Shifting, Stepping, Viscosity,
};
use crate::simd::points::Frame;
use crate::state_equation::State;
use crate::stepping::predictor_corrector::AtStart;
use crate::terms::continuity::Rate;
use crate::terms::disorder::Spread;
use crate::terms::extrapolation::Extrapolated;
use crate::terms::gradient::StrainSums;
use crate::terms::momentum::ForceDensity;
use crate::terms::sums;
use crate::terms::sums::Places;
use crate::{CHUNK, Particles, Rheology, Symmetry, Vec3};

/// Most particles that neighbor ids can number.
pub const MAX_PARTICLES: usize = 1 << 31;
/// Share of the reference density above which a step is not believed.
const LARGEST_COMPRESSION: f64 = 0.3;
/// Cells that a grid may always have, whatever the number of particles.
const FEWEST_CELL_LIMIT: usize = 1 << 16;
/// Cells per particle beyond which the grid is made coarser.
const CELLS_PER_PARTICLE: usize = 8;
/// Share of the support radius by which cells and lists of neighbors are wider than it, so that particles
/// may move before they are sorted anew.
const SKIN: f64 = 0.1;
/// Least share where a period leaves no room for more.
const LEAST_SKIN: f64 = 0.05;
/// Largest step over `h/c₀` of the predictor-corrector with continuity and the usual density diffusion: the
/// same share of the lattice's 0.907 as kick-drift-kick has of its 1.54.
const PREDICTOR_CORRECTOR_SOUND: f64 = 0.59;
/// Fewer neighbors than this make no pressure: a particle by itself keeps the reference density.
const FEWEST_NEIGHBORS: u32 = 5;

/// Settings of the fluid, constant during a run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Particle spacing along x, y, z at the start; m. In two dimensions that along y is the width.
    pub particle_spacing: [f64; 3],
    /// Smoothing length `h`; the support radius is `2h`; m.
    pub smoothing_length: f64,
    /// Reference density; kg/m³.
    pub reference_density: f64,
    /// Numerical sound speed; m/s.
    pub sound_speed: f64,
    /// The choices that make the scheme.
    pub scheme: Scheme,
    /// Dimensions of the flow.
    pub dimensions: Dimensions,
    /// Acceleration of gravity; m/s².
    pub gravity: Vec3,
    /// Share of the stability limits that a step may use, above 0 and at most 1.
    pub time_step_factor: f64,
    /// The modeled box; m.
    pub domain: (Vec3, Vec3),
    /// Periodic directions.
    pub periodic: Periodicity,
    /// Sides of the domain that are planes of symmetry; neither along gravity nor in periodic directions.
    pub symmetry: Symmetry,
}

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

/// Largest steps by cause, the factor of the settings included; s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepLimits {
    /// From pressure waves.
    pub sound: f64,
    /// From viscosity.
    pub viscosity: f64,
    /// From acceleration.
    pub force: f64,
}

impl StepLimits {
    /// The smallest of them; s.
    pub fn smallest(&self) -> f64 {
        self.sound.min(self.viscosity).min(self.force)
    }
}

/// Water that left the domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Removed {
    /// Particles.
    pub count: u64,
    /// Their mass; kg.
    pub mass: f64,
    /// Their momentum; kg m/s.
    pub momentum: Vec3,
    /// Their kinetic, potential and internal energy; J.
    pub energy: f64,
}

/// A force on a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleForce {
    /// Index in the present order.
    pub particle: u32,
    /// N.
    pub force: Vec3,
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
    pub(crate) screens: Screens,
    pub(crate) at_start: AtStart,
    /// Sleeping water, if enabled.
    pub(crate) sleep: Option<Box<Sleep>>,
    /// Flow laws by [`Particles::kind`].
    rheologies: Vec<Rheology>,
    /// Volume of a particle at the reference density; m³.
    particle_volume: f64,
    /// Kernel sum over the undisturbed lattice, by which summation density is divided.
    lattice_sum: f64,
    /// By how much two particles may approach each other before they are sorted anew; m.
    skin: f64,
    /// Farthest that particles may have moved since the last sort; m.
    pub(crate) moved: f64,
    /// Largest speed at the last kick; m/s.
    max_speed: f64,
    /// Ordered pairs of the last sum.
    n_pairs: u64,
    /// Work of the viscous force on the fluid since the ledger was opened, negated; J.
    viscous_loss: f64,
    /// Energy that the pressure of walls gave since the ledger was opened; J.
    from_walls: f64,
    /// Energy of compression taken by density diffusion since the ledger was opened; J.
    pub(crate) diffusive_loss: f64,
    removed: Removed,
    /// Force of the planes of symmetry at the last evaluation; N.
    pub(crate) plane_force: Vec3,
    /// Momentum of what the planes of symmetry sent back since the ledger was opened; kg m/s.
    pub(crate) reflected: Vec3,
    pub(crate) scratch: Scratch,
}

/// Memory that is written before it is read in every step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    cell: Vec<u32>,
    order: Vec<u32>,
    ids: Vec<u32>,
    vectors: Vec<Vec3>,
    numbers: Vec<f64>,
    kinds: Vec<u8>,
    pub(crate) points: AnyPoints,
    /// Packed points for the sums of rates, if water may sleep: kept from step to step, apart from those for forces.
    pub(crate) flow: AnyPoints,
    pub(crate) rates: Vec<Rate>,
    pub(crate) forces: Vec<ForceDensity>,
    pub(crate) gradients: Vec<[f64; 3]>,
    pub(crate) strains: Vec<StrainSums>,
    pub(crate) spreads: Vec<Spread>,
    pub(crate) extra: AnyPoints,
    /// Apparent viscosities, where they vary.
    pub(crate) viscosities: AnyPoints,
    pub(crate) partial: Vec<f64>,
    changes: Vec<Compression>,
    /// Accelerations by the pressure of walls, of the particles that have any; m/s².
    pub(crate) pushes: Vec<(u32, Vec3)>,
    keep: Vec<bool>,
    /// Tiles that wake or fall asleep.
    pub(crate) changing: Vec<bool>,
}

/// Change of the compression energy by a density step; J.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Compression {
    /// Taken by diffusion.
    pub diffusive_loss: f64,
    /// Brought in by walls.
    pub by_walls: f64,
}

/// The fluid's pressure continued along gravity to places that are not of its particles.
#[derive(Clone, Debug, Default)]
pub struct ContinuedPressure {
    chosen: Vec<u32>,
    sums: Vec<Extrapolated>,
    gravity: Vec3,
}

impl ContinuedPressure {
    /// Looks at the fluid from some places (m); after [`Fluid::update_pressure`].
    pub fn find(&mut self, fluid: &Fluid, places: &[Vec3]) {
        self.chosen.clear();
        self.chosen.extend(0..places.len() as u32);
        self.sums.clear();
        self.sums.resize(places.len(), Extrapolated::default());
        self.gravity = fluid.settings.gravity;
        let places = Places {
            positions: places,
            facets: &[],
        };
        sums::extrapolation(fluid, places, &self.chosen, false, &mut self.sums);
    }

    /// For each place the share of its support that is fluid, `Σ V W`, and the pressure, 0 without fluid; –, Pa.
    pub fn found(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.sums.iter().map(|sum| {
            let pull = self.gravity.dot(&Vec3::from(sum.moment));
            let pressure = (sum.pressure + pull) / sum.weight;
            [sum.weight, if 0.0 < sum.weight { pressure } else { 0.0 }]
        })
    }
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
        let skin = settings.skin();
        let grid = CellGrid::new(
            settings.domain,
            settings.periodic,
            (support, skin),
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
            screens: Screens::default(),
            at_start: AtStart::default(),
            sleep: None,
            particle_volume,
            lattice_sum,
            skin,
            // nothing is sorted yet
            moved: f64::INFINITY,
            max_speed: 0.0,
            n_pairs: 0,
            viscous_loss: 0.0,
            from_walls: 0.0,
            diffusive_loss: 0.0,
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

    /// Number of screens.
    pub fn n_screens(&self) -> usize {
        self.screens.len()
    }

    /// Takes all screens away.
    pub fn clear_screens(&mut self) {
        self.screens.clear();
    }

    /// Adds a screen where it is at present: a convex solid by the planes of its faces, each with the number of the side it
    /// is of, with a box round it (m).
    /// Particles do not see each other through it. Planes of symmetry do not mirror it: one that touches them has to go on
    /// beyond them as it is before them, with planes of infinite offset for its ends there.
    pub fn add_screen(&mut self, planes: impl Iterator<Item = (Plane, u32)>, bounds: (Vec3, Vec3)) {
        // particles may have left the cells that they were sorted into
        let reach = self.settings.support_radius() + self.skin();
        self.screens.add(planes, bounds, &self.grid, reach);
    }

    /// Adds a convex solid with walls of its own that the last screen reaches into: there the screen is none.
    pub fn cover_screen(&mut self, planes: impl Iterator<Item = Plane>) {
        self.screens.cover(planes);
    }

    /// Farthest that a particle may be from where it was when it was sorted; m.
    pub fn moved(&self) -> f64 {
        self.moved
    }

    /// By how much two particles may approach each other before [`Self::refresh`] sorts them anew; m.
    pub fn skin(&self) -> f64 {
        self.skin
    }

    /// Whether the last sort still holds.
    pub(crate) fn is_sorted(&self) -> bool {
        // both of a pair may have moved
        2.0 * self.moved <= self.skin
    }

    /// Memory of the lists of neighbors; bytes.
    pub fn list_memory(&self) -> usize {
        self.lists.memory()
    }

    /// Mass of a particle at the reference density; kg.
    pub fn particle_mass(&self) -> f64 {
        self.settings.reference_density * self.particle_volume
    }

    /// Mass of all particles; kg.
    pub fn mass(&self) -> f64 {
        let mass = &self.particles.mass;
        fixed_order_sum(mass.len(), |a| mass[a])
    }

    /// Volume of a particle at the reference density; m³.
    pub fn particle_volume(&self) -> f64 {
        self.particle_volume
    }

    /// The equation of state.
    pub fn state_equation(&self) -> &State {
        &self.state
    }

    /// Gives particles flow laws of their own: `kinds` has the number of the law of every particle, in order
    /// of id; particles beyond its end keep theirs. Where the viscosity of the scheme is not
    /// [`Viscosity::Rheological`] the laws take no part.
    ///
    /// # Errors
    ///
    /// [`FluidError::Setting`] for a law out of range or a number that has no law.
    pub fn set_rheologies(
        &mut self,
        rheologies: Vec<Rheology>,
        kinds: &[u8],
    ) -> Result<(), FluidError> {
        rheologies.iter().try_for_each(Rheology::check)?;
        let particles = &mut self.particles;
        for (kind, &id) in particles.kind.iter_mut().zip(&particles.id) {
            *kind = kinds.get(id as usize).copied().unwrap_or(*kind);
            if rheologies.len() <= usize::from(*kind) {
                return Err(FluidError::Setting {
                    name: "kind",
                    value: f64::from(*kind),
                    range: "the number of a flow law",
                });
            }
        }
        self.rheologies = rheologies;
        Ok(())
    }

    /// Whether each particle has a viscosity of its own.
    pub fn varies_viscosity(&self) -> bool {
        self.settings.scheme.viscosity.varies()
    }

    /// Apparent viscosity of a particle, by its place in the present order; Pa s.
    pub fn apparent_viscosity(&self, particle: usize) -> f64 {
        let constant = || self.settings.kinematic_viscosity() * self.settings.reference_density;
        let viscosity = self.particles.viscosity.get(particle);
        viscosity.copied().unwrap_or_else(constant)
    }

    /// Whether a particle flows, by its place in the present order: what has no yield stress always does.
    pub fn is_yielded(&self, particle: usize) -> bool {
        let p = &self.particles;
        match (p.shear_rate.get(particle), p.kind.get(particle)) {
            (Some(&rate), Some(&kind)) => {
                let rheology = self.rheologies.get(usize::from(kind));
                rheology.is_none_or(|rheology| rheology.is_yielded(rate))
            }
            _ => true,
        }
    }

    /// Whether the density is advanced in time, by [`Self::update_rates`] and [`Self::advance_density`].
    pub fn advances_density(&self) -> bool {
        self.settings.scheme.density == DensityMethod::Continuity
    }

    /// Ordered pairs of the last sum over neighbors, the particle itself not counted.
    pub fn n_pairs(&self) -> u64 {
        self.n_pairs
    }

    /// Water that left the domain since the ledger was opened.
    pub fn removed(&self) -> Removed {
        self.removed
    }

    /// Energy taken by viscosity since the ledger was opened; J.
    pub fn viscous_loss(&self) -> f64 {
        self.viscous_loss
    }

    /// Energy of compression taken by density diffusion since the ledger was opened; J.
    pub fn diffusive_loss(&self) -> f64 {
        self.diffusive_loss
    }

    /// Energy that the fluid has from the pressure of walls since the ledger was opened, where density is advanced: of
    /// motion by their forces and of compression by their part of the rates; J.
    pub fn energy_from_walls(&self) -> f64 {
        self.from_walls
    }

    /// Forgets what the ledger holds: a run starts here.
    pub fn open_ledger(&mut self) {
        self.viscous_loss = 0.0;
        self.from_walls = 0.0;
        self.diffusive_loss = 0.0;
        self.removed = Removed::default();
        self.reflected = Vec3::zeros();
    }

    /// Adds `dt` times the acceleration to the velocities, and books the work of viscosity.
    pub fn kick(&mut self, dt: f64) {
        let is_plane = self.is_plane();
        let Particles {
            velocity,
            acceleration,
            viscous_acceleration,
            mass,
            ..
        } = &mut self.particles;
        let partial = &mut self.scratch.partial;
        partial.resize(velocity.len().div_ceil(CHUNK), 0.0);
        let still = Still::of(self.sleep.as_deref());
        let max_square = velocity
            .par_chunks_mut(CHUNK)
            .zip(acceleration.par_chunks(CHUNK))
            .zip(viscous_acceleration.par_chunks(CHUNK))
            .zip(mass.par_chunks(CHUNK))
            .zip(partial.par_iter_mut())
            .enumerate()
            .map(
                |(chunk, ((((velocity, acceleration), viscous), mass), work))| {
                    *work = 0.0;
                    if still.has(chunk) {
                        return 0.0;
                    }
                    let mut largest = 0.0_f64;
                    for (((v, a), viscous), m) in
                        velocity.iter_mut().zip(acceleration).zip(viscous).zip(mass)
                    {
                        let before = *v;
                        *v += a * dt;
                        if is_plane {
                            // pressure drives apart what is off the plane by no more than round-off
                            v.y = 0.0;
                        }
                        // with the mean of the velocities before and after, the works of all forces
                        // add up to the change of kinetic energy exactly
                        let viscous = Vec3::from(viscous.map(f64::from));
                        *work += m * viscous.dot(&(before + *v)) * (0.5 * dt);
                        largest = largest.max(v.norm_squared());
                    }
                    largest
                },
            )
            .reduce(|| 0.0, f64::max);
        self.max_speed = max_square.sqrt();
        self.viscous_loss -= partial.iter().sum::<f64>();
        self.book_pushes(dt);
    }

    /// Books what the pressure of walls did in a kick of `dt` that has just been.
    fn book_pushes(&mut self, dt: f64) {
        if !self.advances_density() {
            return;
        }
        let Particles {
            velocity,
            acceleration,
            mass,
            ..
        } = &self.particles;
        let pushes = &self.scratch.pushes;
        let power = fixed_order_sum(pushes.len(), |k| {
            let (a, push) = (pushes[k].0 as usize, &pushes[k].1);
            let mean = velocity[a] - acceleration[a] * (0.5 * dt);
            mass[a] * push.dot(&mean)
        });
        self.from_walls += power * dt;
    }

    /// Moves the particles by `dt` times their velocities.
    pub fn drift(&mut self, dt: f64) {
        let still = Still::of(self.sleep.as_deref());
        self.particles
            .position
            .par_chunks_mut(CHUNK)
            .zip(self.particles.velocity.par_chunks(CHUNK))
            .enumerate()
            .filter(|(chunk, _)| !still.has(*chunk))
            .for_each(|(_, (position, velocity))| {
                for (x, v) in position.iter_mut().zip(velocity) {
                    *x += v * dt;
                }
            });
        self.moved += self.max_speed * dt.abs();
    }

    /// Multiplies all velocities by a factor: settling only.
    pub fn damp(&mut self, factor: f64) {
        for v in &mut self.particles.velocity {
            *v *= factor;
        }
    }

    /// Sorts the particles by cell if they have moved far enough since the last time: then sends back those that
    /// passed a plane of symmetry, removes those that left the domain, and takes those that left through a
    /// periodic side to the other one.
    /// Returns how many were removed. Accelerations are stale after a sort.
    pub fn refresh(&mut self) -> u64 {
        if self.is_sorted() {
            return 0;
        }
        if self.settings.has_symmetry() {
            self.reflect();
        }
        let gone = self.remove_escaped();
        self.sort();
        gone
    }

    fn remove_escaped(&mut self) -> u64 {
        let keep = &mut self.scratch.keep;
        keep.clear();
        keep.extend(
            self.particles
                .position
                .iter()
                .map(|x| self.grid.contains(x)),
        );
        if keep.iter().all(|&inside| inside) {
            return 0;
        }
        let keep = std::mem::take(keep);
        let mut gone = 0;
        for (a, _) in keep.iter().enumerate().filter(|(_, inside)| !**inside) {
            let content = self.content(a);
            self.removed.mass += content.mass;
            self.removed.momentum += content.momentum;
            self.removed.energy += content.energy;
            gone += 1;
        }
        self.removed.count += gone;
        self.particles.retain(&keep);
        self.at_start.retain(&keep);
        if let Some(sleep) = &mut self.sleep {
            filter(&mut sleep.home, &keep);
        }
        self.scratch.keep = keep;
        gone
    }

    fn sort(&mut self) {
        if self.settings.periodic.contains(&true) {
            let grid = &self.grid;
            if let Some(sleep) = &mut self.sleep {
                // the way from home is the same when a particle goes on at the other side
                for (home, x) in sleep.home.iter_mut().zip(&self.particles.position) {
                    *home += grid.wrapped(*x) - x;
                }
            }
            self.particles
                .position
                .par_chunks_mut(CHUNK)
                .for_each(|chunk| chunk.iter_mut().for_each(|x| *x = grid.wrapped(*x)));
        }
        let Scratch {
            cell,
            order,
            ids,
            vectors,
            numbers,
            kinds,
            ..
        } = &mut self.scratch;
        self.grid.sort(&self.particles.position, cell, order);
        fn reorder<T: Copy + Send + Sync + Default>(
            column: &mut Vec<T>,
            order: &[u32],
            spare: &mut Vec<T>,
        ) {
            spare.resize(order.len(), T::default());
            spare
                .par_chunks_mut(CHUNK)
                .zip(order.par_chunks(CHUNK))
                .for_each(|(spare, order)| {
                    for (slot, &a) in spare.iter_mut().zip(order) {
                        *slot = column[a as usize];
                    }
                });
            std::mem::swap(column, spare);
        }
        let particles = &mut self.particles;
        reorder(&mut particles.id, order, ids);
        reorder(&mut particles.position, order, vectors);
        reorder(&mut particles.velocity, order, vectors);
        reorder(&mut particles.density, order, numbers);
        reorder(&mut particles.mass, order, numbers);
        reorder(&mut particles.kind, order, kinds);
        let AtStart { velocity, density } = &mut self.at_start;
        if !velocity.is_empty() {
            reorder(velocity, order, vectors);
        }
        if !density.is_empty() {
            reorder(density, order, numbers);
        }
        if let Some(sleep) = &mut self.sleep {
            reorder(&mut sleep.home, order, vectors);
        }
        self.lists.forget();
        self.moved = 0.0;
        self.find_rests();
    }

    /// Rates of density from neighbors in the fluid, at the present positions and velocities.
    pub fn update_rates(&mut self) {
        if let DensityDiffusion::Antuono(_) = self.settings.scheme.diffusion {
            sums::density_gradients(self);
        }
        self.n_pairs = sums::rates(self);
        self.hold_rates();
    }

    /// Adds rates of density; kg/(m³ s), one per particle named.
    pub fn add_density_rates(&mut self, rates: impl Iterator<Item = (u32, f64)>) {
        for (particle, rate) in rates {
            let sum = &mut self.scratch.rates[particle as usize];
            sum.flow += rate;
            sum.by_walls += rate;
        }
    }

    /// Takes the density on by `dt` at the rates found, and books what diffusion did to the energy of
    /// compression. A particle with hardly any neighbors gets the reference density.
    pub fn advance_density(&mut self, dt: f64) {
        let change = self.take_density_on(|_, _, _| dt);
        self.book_compression(change);
    }

    pub(crate) fn book_compression(&mut self, change: Compression) {
        self.diffusive_loss += change.diffusive_loss;
        self.from_walls += change.by_walls;
    }

    /// The same, each particle by the time that `time` makes of its index, density and rate; returns what is
    /// to be booked.
    pub(crate) fn take_density_on(
        &mut self,
        time: impl Fn(usize, f64, f64) -> f64 + Sync,
    ) -> Compression {
        let Particles { density, mass, .. } = &mut self.particles;
        let state = &self.state;
        let still = Still::of(self.sleep.as_deref());
        let changes = &mut self.scratch.changes;
        changes.resize(density.len().div_ceil(CHUNK), Compression::default());
        density
            .par_chunks_mut(CHUNK)
            .zip(mass.par_chunks(CHUNK))
            .zip(self.scratch.rates.par_chunks(CHUNK))
            .zip(changes.par_iter_mut())
            .enumerate()
            .for_each(|(chunk, (((density, mass), rates), booked))| {
                *booked = Compression::default();
                if still.has(chunk) {
                    return;
                }
                let each = density.iter_mut().zip(mass).zip(rates);
                for (a, ((density, mass), rate)) in (chunk * CHUNK..).zip(each) {
                    if rate.n_found <= FEWEST_NEIGHBORS {
                        booked.diffusive_loss += mass * state.specific_energy(*density);
                        *density = state.reference_density;
                        continue;
                    }
                    let dt = time(a, *density, rate.flow + rate.diffusion);
                    let change = (rate.flow + rate.diffusion) * dt;
                    // de = p/ρ² dρ, at the middle of the change
                    let middle = *density + 0.5 * change;
                    let slope = mass * state.pressure(middle) / (middle * middle);
                    booked.diffusive_loss -= slope * rate.diffusion * dt;
                    booked.by_walls += slope * rate.by_walls * dt;
                    *density += change;
                }
            });
        let none = Compression::default();
        changes.iter().fold(none, |sum, change| Compression {
            diffusive_loss: sum.diffusive_loss + change.diffusive_loss,
            by_walls: sum.by_walls + change.by_walls,
        })
    }

    /// Pressures, and with summation the densities, at the current positions.
    ///
    /// # Errors
    ///
    /// [`FluidError::NonFinite`] and [`FluidError::Compressed`] name the first bad particle.
    pub fn update_pressure(&mut self) -> Result<(), FluidError> {
        if !self.advances_density() {
            self.n_pairs = sums::summation(self, 1.0 / self.lattice_sum);
        }
        let Particles {
            density, pressure, ..
        } = &mut self.particles;
        let state = &self.state;
        let still = Still::kept(self.sleep.as_deref(), |kept| kept.pressure);
        pressure
            .par_chunks_mut(CHUNK)
            .zip(density.par_chunks(CHUNK))
            .enumerate()
            .with_min_len(16)
            .filter(|(chunk, _)| !still.has(*chunk))
            .for_each(|(_, (pressure, density))| {
                for (p, rho) in pressure.iter_mut().zip(density) {
                    *p = state.pressure(*rho);
                }
            });
        if let Some(sleep) = &mut self.sleep {
            sleep.kept.pressure = true;
        }
        let limit = (1.0 + LARGEST_COMPRESSION) * self.settings.reference_density;
        // a NaN density is not below the limit either
        let first_bad = density
            .par_iter()
            .with_min_len(4096)
            .position_first(|&rho| !(0.0 < rho && rho < limit));
        match first_bad {
            None => {
                self.pack_forces();
                Ok(())
            }
            Some(a) => Err(self.bad_density(a)),
        }
    }

    fn bad_density(&self, a: usize) -> FluidError {
        let (id, at) = (self.particles.id[a], self.particles.position[a]);
        let density = self.particles.density[a];
        if density.is_finite() && 0.0 < density {
            FluidError::Compressed {
                id,
                density,
                limit_percent: 100.0 * LARGEST_COMPRESSION,
                x: at.x,
                y: at.y,
                z: at.z,
            }
        } else {
            FluidError::NonFinite {
                id,
                quantity: "density",
                x: at.x,
                y: at.y,
                z: at.z,
            }
        }
    }

    /// Finds how unevenly the particles are spread; walls are added afterward, and [`Self::shift`]
    /// evens it out. Only where the scheme shifts.
    pub fn update_spread(&mut self) {
        sums::spreads(self);
    }

    /// Whether the scheme shifts particles.
    pub fn shifts(&self) -> bool {
        self.settings.scheme.shifting != Shifting::None
    }

    /// Moves particles towards where they are sparse, after a step of `dt`.
    ///
    /// ```text
    /// δx = −A h |v| dt ∇C,   at most 0.1 dp along each axis; fading out at the free surface
    /// ```
    /// Lind et al. (2012). The mass moves and the momentum does not: potential energy and angular
    /// momentum drift a little.
    pub fn shift(&mut self, dt: f64) {
        let Shifting::Fickian { coefficient } = self.settings.scheme.shifting else {
            return;
        };
        let inside = self.settings.dimensions.count();
        let none = match self.settings.dimensions {
            Dimensions::Two { .. } => 1.5,
            Dimensions::Three => 2.75,
        };
        let fade = |divergence: f64| ((divergence - none) / (inside - none)).clamp(0.0, 1.0);
        let most = 0.1
            * self
                .settings
                .particle_spacing
                .iter()
                .copied()
                .fold(f64::INFINITY, f64::min);
        let factor = -coefficient * self.settings.smoothing_length * dt;
        let Particles {
            position, velocity, ..
        } = &mut self.particles;
        let still = Still::of(self.sleep.as_deref());
        position
            .par_chunks_mut(CHUNK)
            .zip(velocity.par_chunks(CHUNK))
            .zip(self.scratch.spreads.par_chunks(CHUNK))
            .enumerate()
            .filter(|(chunk, _)| !still.has(*chunk))
            .for_each(|(_, ((position, velocity), spreads))| {
                for ((x, v), spread) in position.iter_mut().zip(velocity).zip(spreads) {
                    let by = factor * v.norm() * fade(spread.divergence);
                    *x += Vec3::from(spread.concentration_gradient)
                        .map(|g| (by * g).clamp(-most, most));
                }
            });
        self.moved += 3.0_f64.sqrt() * most;
    }

    /// Sums the gradient of velocity over the fluid; walls are added afterward, then
    /// [`Self::update_viscosity`]. After [`Self::update_pressure`], and only where viscosity varies.
    pub fn update_strain(&mut self) {
        sums::strains(self);
    }

    /// Rates of shear and apparent viscosities, which the forces of this step share.
    pub fn update_viscosity(&mut self) {
        let Particles {
            kind,
            shear_rate,
            viscosity,
            ..
        } = &mut self.particles;
        let (settings, rheologies) = (&self.settings, &self.rheologies);
        let reference = settings.reference_density;
        let mixing_length = settings.mixing_length();
        let of = |kind: u8, rate: f64| match settings.scheme.viscosity {
            Viscosity::SubParticleScale {
                kinematic_viscosity,
                ..
            } => reference * (kinematic_viscosity + mixing_length * mixing_length * rate),
            // a number without a law was refused
            _ => rheologies
                .get(usize::from(kind))
                .map_or(0.0, |rheology| rheology.apparent_viscosity(rate)),
        };
        shear_rate.resize(kind.len(), 0.0);
        viscosity.resize(kind.len(), 0.0);
        shear_rate
            .par_chunks_mut(CHUNK)
            .zip(viscosity.par_chunks_mut(CHUNK))
            .zip(kind.par_chunks(CHUNK))
            .zip(self.scratch.strains.par_chunks(CHUNK))
            .for_each(|(((rates, viscosities), kinds), strains)| {
                for (((rate, viscosity), kind), strain) in
                    rates.iter_mut().zip(viscosities).zip(kinds).zip(strains)
                {
                    *rate = strain.shear_rate(settings.dimensions);
                    *viscosity = of(*kind, *rate);
                }
            });
        let precision = settings.scheme.precision;
        let packed = &mut self.scratch.viscosities;
        packed.pack_values(precision, viscosity.len(), |a| {
            [viscosity[a], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        });
    }

    /// Accelerations from pressure, viscosity and gravity; walls are added afterward.
    pub fn update_accelerations(&mut self) {
        self.scratch.pushes.clear();
        sums::forces(self);
        self.hold_forces();
        if self.settings.has_symmetry() || self.may_sleep() {
            self.sum_plane_force();
        }
        let Particles {
            density,
            acceleration,
            viscous_acceleration,
            ..
        } = &mut self.particles;
        let gravity = self.settings.gravity;
        let still = Still::of(self.sleep.as_deref());
        acceleration
            .par_chunks_mut(CHUNK)
            .zip(viscous_acceleration.par_chunks_mut(CHUNK))
            .zip(self.scratch.forces.par_chunks(CHUNK))
            .zip(density.par_chunks(CHUNK))
            .enumerate()
            .filter(|(chunk, _)| !still.has(*chunk))
            .for_each(|(_, (((acceleration, viscous), forces), density))| {
                for (((acceleration, viscous), force), density) in acceleration
                    .iter_mut()
                    .zip(viscous)
                    .zip(forces)
                    .zip(density)
                {
                    let specific_volume = 1.0 / density;
                    let by_viscosity = Vec3::from(force.viscous) * specific_volume;
                    *viscous = by_viscosity.map(|v| v as f32).into();
                    *acceleration =
                        gravity + Vec3::from(force.pressure) * specific_volume + by_viscosity;
                }
            });
        self.hold_accelerations();
    }

    /// Adds forces, of walls and blocks, to the accelerations.
    pub fn add_forces(&mut self, forces: impl Iterator<Item = ParticleForce>) {
        for f in forces {
            let a = f.particle as usize;
            self.particles.acceleration[a] += f.force / self.particles.mass[a];
        }
    }

    /// Puts a particle elsewhere with another velocity; returns the energy it lost, J.
    ///
    /// For a particle found inside a solid; the caller counts it.
    pub fn replace(&mut self, particle: usize, mut position: Vec3, mut velocity: Vec3) -> f64 {
        if self.is_plane() {
            (position.y, velocity.y) = (self.particles.position[particle].y, 0.0);
        }
        let x = &mut self.particles.position[particle];
        let v = &mut self.particles.velocity[particle];
        let lost = 0.5 * (v.norm_squared() - velocity.norm_squared())
            - self.settings.gravity.dot(&(*x - position));
        *x = position;
        *v = velocity;
        // it jumped: no bound on its way holds any more
        self.moved = f64::INFINITY;
        lost * self.particles.mass[particle]
    }

    /// Gives a particle another velocity (m/s) at once; returns the energy it lost, J.
    pub fn set_velocity(&mut self, particle: usize, mut velocity: Vec3) -> f64 {
        if self.is_plane() {
            velocity.y = 0.0;
        }
        self.note_speed(velocity.norm());
        let v = &mut self.particles.velocity[particle];
        let lost = 0.5 * (v.norm_squared() - velocity.norm_squared());
        *v = velocity;
        lost * self.particles.mass[particle]
    }

    /// Whether all particles are in one plane across y.
    fn is_plane(&self) -> bool {
        matches!(self.settings.dimensions, Dimensions::Two { .. })
    }

    /// Notes a speed that no kick gave.
    pub(crate) fn note_speed(&mut self, speed: f64) {
        self.max_speed = self.max_speed.max(speed);
    }

    /// Makes the next [`Self::refresh`] sort.
    pub(crate) fn forget_order(&mut self) {
        self.moved = f64::INFINITY;
    }

    /// Largest steps by cause at the present state; s.
    ///
    /// ```text
    /// summation    sound 0.95 H/(c₀ + max|v|)   viscosity 0.127 H² ρ₀/μ   force 0.5 √(h/max|a|)
    /// continuity   sound h/(c₀ + max|v|)        viscosity 0.10 h²/ν       force 0.5 √(h/max|a|)
    ///   predictor-corrector   0.59 ∛(δ/0.1) h/(c₀ + max|v|)
    /// ```
    /// each times the time-step factor; viscosity after Morris has 0.25 h²/ν. The limits of sound and
    /// viscosity of summation are those of a lattice; those of continuity are a share of them: on a
    /// lattice sound allows 1.75 h/c₀ without and 1.54 with the usual density diffusion. Viscosity
    /// allows 0.112 to 0.128 h²/ν along lines of centers, where one wave has all of the 2(d + 2), and
    /// 0.29 to 0.32 after Morris; a wall that does not slip mirrors velocities and takes some of that.
    /// That of the force is the customary one at a factor of 0.5. Where viscosity varies ν is the largest of
    /// any particle over ρ₀.
    pub fn step_limits(&self) -> StepLimits {
        let s = &self.settings;
        let (h, support) = (s.smoothing_length, s.support_radius());
        let (sound, viscous_share) = match s.scheme.density {
            DensityMethod::Summation => (0.95 * support, 0.127 * support * support),
            DensityMethod::Continuity => {
                let sound = match s.scheme.stepping {
                    Stepping::PredictorCorrector => {
                        predictor_corrector_sound(s.scheme.diffusion) * h
                    }
                    Stepping::KickDriftKick | Stepping::SymplecticEuler => h,
                };
                match s.scheme.viscosity {
                    Viscosity::Morris { .. }
                    | Viscosity::Rheological { .. }
                    | Viscosity::SubParticleScale { .. } => (sound, 0.25 * h * h),
                    _ => (sound, 0.10 * h * h),
                }
            }
        };
        StepLimits {
            sound: s.time_step_factor * sound / (s.sound_speed + self.max_speed()),
            viscosity: s.time_step_factor * viscous_share / self.largest_kinematic_viscosity(),
            force: s.time_step_factor
                * 0.5
                * (h / largest_norm(&self.particles.acceleration)).sqrt(),
        }
    }

    /// Largest kinematic viscosity of any particle; m²/s.
    fn largest_kinematic_viscosity(&self) -> f64 {
        if !self.varies_viscosity() {
            return self.settings.kinematic_viscosity();
        }
        let viscosity = self.particles.viscosity.par_iter().with_min_len(4096);
        viscosity.copied().reduce(|| 0.0, f64::max) / self.settings.reference_density
    }

    /// Largest particle speed; m/s.
    pub fn max_speed(&self) -> f64 {
        largest_norm(&self.particles.velocity)
    }

    /// Root mean square of `ρ/ρ₀ − 1` over the compressed particles, those not at a free surface.
    pub fn density_error_rms(&self) -> f64 {
        let (density, reference) = (&self.particles.density, self.settings.reference_density);
        let excess = |a: usize| (density[a] / reference - 1.0).max(0.0);
        let sum = fixed_order_sum(density.len(), |a| excess(a).powi(2));
        let count = fixed_order_sum(density.len(), |a| u64::from(reference < density[a]));
        if count == 0 {
            0.0
        } else {
            (sum / count as f64).sqrt()
        }
    }

    /// Calls `visit` with every number of the state, particle by particle in order of id.
    pub fn visit_state(&self, mut visit: impl FnMut(f64)) {
        let mut order: Vec<usize> = (0..self.particles.len()).collect();
        order.sort_unstable_by_key(|&a| self.particles.id[a]);
        for a in order {
            visit(f64::from(self.particles.id[a]));
            self.particles.position[a].iter().for_each(|&x| visit(x));
            self.particles.velocity[a].iter().for_each(|&v| visit(v));
            visit(self.particles.density[a]);
        }
    }
}

/// Largest step of the predictor-corrector with continuity over `h/c₀`.
///
/// A wave grows by `(ω dt)⁴/8` a step and diffusion takes `D dt/2`, `D ∝ δ`: the limit goes with the cube root of
/// δ. Without diffusion there is none, and viscosity has to take what grows; more than the usual does not help.
fn predictor_corrector_sound(diffusion: DensityDiffusion) -> f64 {
    let delta = match diffusion {
        DensityDiffusion::None => DIFFUSION,
        DensityDiffusion::MolteniColagrossi(delta)
        | DensityDiffusion::Fourtakas(delta)
        | DensityDiffusion::Antuono(delta) => delta,
    };
    PREDICTOR_CORRECTOR_SOUND * (delta / DIFFUSION).min(1.0).cbrt()
}

/// Largest length of a list of vectors. A maximum is the same in any order.
fn largest_norm(vectors: &[Vec3]) -> f64 {
    vectors
        .par_iter()
        .with_min_len(4096)
        .map(|v| v.norm_squared())
        .reduce(|| 0.0, f64::max)
        .sqrt()
}

impl Settings {
    /// Support radius `H = 2h` of every kernel; m.
    pub fn support_radius(&self) -> f64 {
        2.0 * self.smoothing_length
    }

    /// Length over which eddies smaller than the spacing mix: Smagorinsky's `C` times the spacing; m.
    fn mixing_length(&self) -> f64 {
        let Viscosity::SubParticleScale { smagorinsky, .. } = self.scheme.viscosity else {
            return 0.0;
        };
        let [dx, dy, dz] = self.particle_spacing;
        smagorinsky
            * match self.dimensions {
                Dimensions::Two { .. } => (dx * dz).sqrt(),
                Dimensions::Three => (dx * dy * dz).cbrt(),
            }
    }

    /// Kinematic viscosity that the viscous force amounts to; m²/s.
    ///
    /// The artificial one is `α c₀ h/(2(d+2))` where all pairs take part. Where viscosity varies it is that
    /// at rest.
    pub fn kinematic_viscosity(&self) -> f64 {
        let neighbors_factor = match self.dimensions {
            Dimensions::Two { .. } => 8.0,
            Dimensions::Three => 10.0,
        };
        match self.scheme.viscosity {
            Viscosity::None => 0.0,
            Viscosity::Published { dynamic_viscosity } => {
                dynamic_viscosity / self.reference_density
            }
            Viscosity::Artificial { alpha } => {
                alpha * self.sound_speed * self.smoothing_length / neighbors_factor
            }
            Viscosity::Laminar {
                kinematic_viscosity,
            }
            | Viscosity::Morris {
                kinematic_viscosity,
            }
            | Viscosity::SubParticleScale {
                kinematic_viscosity,
                ..
            } => kinematic_viscosity,
            Viscosity::Rheological { rheology } => {
                rheology.viscosity_at_rest() / self.reference_density
            }
        }
    }

    fn check(&self) -> Result<(), FluidError> {
        let positive = [
            ("particle_spacing x", self.particle_spacing[0]),
            ("particle_spacing y", self.particle_spacing[1]),
            ("particle_spacing z", self.particle_spacing[2]),
            ("smoothing_length", self.smoothing_length),
            ("reference_density", self.reference_density),
            ("sound_speed", self.sound_speed),
            ("time_step_factor", self.time_step_factor),
        ];
        for (name, value) in positive {
            if !(value.is_finite() && 0.0 < value) {
                return Err(FluidError::Setting {
                    name,
                    value,
                    range: "finite and > 0",
                });
            }
        }
        if let Viscosity::Rheological { rheology } = self.scheme.viscosity {
            rheology.check()?;
        }
        let mixing_length = self.mixing_length();
        if !(mixing_length.is_finite() && 0.0 <= mixing_length) {
            return Err(FluidError::Setting {
                name: "mixing length",
                value: mixing_length,
                range: "finite and >= 0",
            });
        }
        let viscosity = self.kinematic_viscosity();
        if !(viscosity.is_finite() && 0.0 <= viscosity) {
            return Err(FluidError::Setting {
                name: "viscosity",
                value: viscosity,
                range: "finite and >= 0",
            });
        }
        let Scheme {
            density, stepping, ..
        } = self.scheme;
        if (density, stepping) == (DensityMethod::Continuity, Stepping::SymplecticEuler) {
            return Err(FluidError::GrowingSound);
        }
        if 1.0 < self.time_step_factor {
            return Err(FluidError::Setting {
                name: "time_step_factor",
                value: self.time_step_factor,
                range: "at most 1",
            });
        }
        self.check_symmetry(self.support_radius() + self.skin())
    }

    /// By how much two particles may approach each other before they are sorted anew; m.
    ///
    /// Two that leave a domain by both of its periodic sides see each other through two periods, and no sum
    /// looks that far: a period should be no shorter than support and skin.
    fn skin(&self) -> f64 {
        let support = self.support_radius();
        let extent = self.domain.1 - self.domain.0;
        let room = (0..3)
            .filter(|&axis| self.periodic[axis])
            .fold(f64::INFINITY, |room, axis| room.min(extent[axis] - support));
        room.clamp(LEAST_SKIN * support, SKIN * support)
    }
}
