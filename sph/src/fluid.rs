//! The fluid: state, settings and the pieces of a time step.
//!
//! A step is kick-drift-kick. The caller drives it, so that walls and blocks can act in between:
//!
//! ```text
//! kick(dt/2); drift(dt); sort; find_neighbors; update_density; update_accelerations;
//! add_forces(walls); kick(dt/2)
//! ```

use rayon::prelude::*;

use crate::cells::{CellGrid, Periodicity};
use crate::energy::fixed_order_sum;
use crate::error::FluidError;
use crate::mueller::{Mueller, Record};
use crate::neighbors::{MAX_PARTICLES, NeighborLists};
use crate::state_equation::{LinearState, NegativePressure};
use crate::{CHUNK, Particles, Vec3};

/// Share of the reference density above which a step is not believed.
const LARGEST_COMPRESSION: f64 = 0.3;
/// Cells that a grid may always have, whatever the number of particles.
const FEWEST_CELL_LIMIT: usize = 1 << 16;
/// Cells per particle beyond which the grid is made coarser.
const CELLS_PER_PARTICLE: usize = 8;

/// What the fluid needs to know; nothing here changes during a run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Particle spacing along x, y, z at the start; m.
    pub particle_spacing: [f64; 3],
    /// Smoothing length `h`; the support radius is `2h`; m.
    pub smoothing_length: f64,
    /// Reference density; kg/m³.
    pub reference_density: f64,
    /// Numerical sound speed; m/s.
    pub sound_speed: f64,
    /// Dynamic viscosity; Pa s.
    pub dynamic_viscosity: f64,
    /// What is done with pressures below zero.
    pub negative_pressure: NegativePressure,
    /// Acceleration of gravity; m/s².
    pub gravity: Vec3,
    /// Share of the stability limits that a step may use, above 0 and at most 1.
    pub time_step_factor: f64,
    /// The modelled box; m.
    pub domain: (Vec3, Vec3),
    /// Which directions repeat.
    pub periodic: Periodicity,
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

/// What left the domain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Removed {
    /// Particles.
    pub count: u64,
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
    settings: Settings,
    particles: Particles,
    grid: CellGrid,
    scheme: Mueller,
    lists: NeighborLists,
    /// Work of the viscous force on the fluid since the ledger was opened, negated; J.
    viscous_loss: f64,
    removed: Removed,
    scratch: Scratch,
}

/// Memory that is written before it is read in every step.
#[derive(Clone, Debug, Default)]
struct Scratch {
    cell: Vec<u32>,
    order: Vec<u32>,
    ids: Vec<u32>,
    vectors: Vec<Vec3>,
    records: Vec<Record>,
    partial: Vec<f64>,
    keep: Vec<bool>,
}

impl Fluid {
    /// Fluid at the given positions and velocities.
    ///
    /// # Errors
    ///
    /// [`FluidError::Setting`] for a setting out of range, [`FluidError::NarrowPeriod`] for a slab
    /// narrower than the support, [`FluidError::TooManyParticles`].
    pub fn new(
        positions: Vec<Vec3>,
        velocities: Vec<Vec3>,
        settings: Settings,
    ) -> Result<Self, FluidError> {
        settings.check()?;
        if positions.len() >= MAX_PARTICLES {
            return Err(FluidError::TooManyParticles {
                count: positions.len(),
                limit: MAX_PARTICLES,
            });
        }
        let max_cells = (positions.len() * CELLS_PER_PARTICLE).max(FEWEST_CELL_LIMIT);
        let grid = CellGrid::new(
            settings.domain,
            settings.periodic,
            settings.support_radius(),
            max_cells,
        )?;
        let scheme = Mueller::new(
            settings.support_radius(),
            settings.particle_spacing,
            LinearState {
                reference_density: settings.reference_density,
                sound_speed: settings.sound_speed,
                negative: settings.negative_pressure,
            },
            settings.dynamic_viscosity,
            settings.periodic.contains(&true),
        );
        Ok(Self {
            particles: Particles::new(positions, velocities),
            grid,
            scheme,
            lists: NeighborLists::default(),
            viscous_loss: 0.0,
            removed: Removed::default(),
            scratch: Scratch::default(),
            settings,
        })
    }

    /// The settings it was made with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The particles, sorted by cell since the last [`Self::sort`].
    pub fn particles(&self) -> &Particles {
        &self.particles
    }

    /// The cells of the last [`Self::sort`].
    pub fn grid(&self) -> &CellGrid {
        &self.grid
    }

    /// Mass of every particle; kg.
    pub fn particle_mass(&self) -> f64 {
        self.scheme.particle_mass()
    }

    /// The equation of state.
    pub fn state_equation(&self) -> &LinearState {
        self.scheme.state()
    }

    /// Ordered pairs of the last [`Self::find_neighbors`].
    pub fn n_pairs(&self) -> u64 {
        self.lists.n_pairs()
    }

    /// What left the domain since the ledger was opened.
    pub fn removed(&self) -> Removed {
        self.removed
    }

    /// Energy taken by viscosity since the ledger was opened; J.
    pub fn viscous_loss(&self) -> f64 {
        self.viscous_loss
    }

    /// Forgets what the ledger holds: a run starts here.
    pub fn open_ledger(&mut self) {
        self.viscous_loss = 0.0;
        self.removed = Removed::default();
    }

    /// Adds `dt` times the acceleration to the velocities, and books the work of viscosity.
    pub fn kick(&mut self, dt: f64) {
        let Particles {
            velocity,
            acceleration,
            viscous_acceleration,
            ..
        } = &mut self.particles;
        let partial = &mut self.scratch.partial;
        partial.resize(velocity.len().div_ceil(CHUNK), 0.0);
        velocity
            .par_chunks_mut(CHUNK)
            .zip(acceleration.par_chunks(CHUNK))
            .zip(viscous_acceleration.par_chunks(CHUNK))
            .zip(partial.par_iter_mut())
            .for_each(|(((velocity, acceleration), viscous), work)| {
                *work = 0.0;
                for ((v, a), viscous) in velocity.iter_mut().zip(acceleration).zip(viscous) {
                    let before = *v;
                    *v += a * dt;
                    // with the mean of the velocities before and after, the works of all forces
                    // add up to the change of kinetic energy exactly
                    *work += viscous.dot(&(before + *v)) * (0.5 * dt);
                }
            });
        self.viscous_loss -= self.scheme.particle_mass() * partial.iter().sum::<f64>();
    }

    /// Moves the particles by `dt` times their velocities, round the periodic directions.
    pub fn drift(&mut self, dt: f64) {
        let grid = &self.grid;
        let periodic = self.settings.periodic.contains(&true);
        self.particles
            .position
            .par_chunks_mut(CHUNK)
            .zip(self.particles.velocity.par_chunks(CHUNK))
            .for_each(|(position, velocity)| {
                for (x, v) in position.iter_mut().zip(velocity) {
                    *x += v * dt;
                    if periodic {
                        *x = grid.wrapped(*x);
                    }
                }
            });
    }

    /// Multiplies all velocities by a factor: settling only.
    pub fn damp(&mut self, factor: f64) {
        for v in &mut self.particles.velocity {
            *v *= factor;
        }
    }

    /// Removes the particles that left the domain and counts them; returns how many.
    pub fn remove_escaped(&mut self) -> u64 {
        let mass = self.particle_mass();
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
        let mut gone = 0;
        for (a, _) in keep.iter().enumerate().filter(|(_, inside)| !**inside) {
            let (x, v) = (self.particles.position[a], self.particles.velocity[a]);
            let specific = 0.5 * v.norm_squared() - self.settings.gravity.dot(&x)
                + self
                    .scheme
                    .state()
                    .specific_energy(self.particles.density[a]);
            self.removed.momentum += v * mass;
            self.removed.energy += mass * specific;
            gone += 1;
        }
        self.removed.count += gone;
        self.particles.retain(keep);
        gone
    }

    /// Sorts the particles by cell. Densities and accelerations are stale afterwards.
    pub fn sort(&mut self) {
        let Scratch {
            cell,
            order,
            ids,
            vectors,
            ..
        } = &mut self.scratch;
        self.grid.sort(&self.particles.position, cell, order);
        fn reorder<T: Copy + Send + Sync>(column: &mut Vec<T>, order: &[u32], spare: &mut Vec<T>) {
            spare.clear();
            spare.extend(order.iter().map(|&a| column[a as usize]));
            std::mem::swap(column, spare);
        }
        reorder(&mut self.particles.id, order, ids);
        reorder(&mut self.particles.position, order, vectors);
        reorder(&mut self.particles.velocity, order, vectors);
    }

    /// Finds the neighbours of the sorted particles.
    pub fn find_neighbors(&mut self) {
        self.lists.build(
            &self.grid,
            &self.particles.position,
            self.settings.support_radius(),
        );
    }

    /// Densities and pressures at the current positions.
    ///
    /// # Errors
    ///
    /// [`FluidError::NonFinite`] and [`FluidError::Compressed`] name the first bad particle.
    pub fn update_density(&mut self) -> Result<(), FluidError> {
        let Particles {
            position,
            density,
            pressure,
            ..
        } = &mut self.particles;
        self.scheme
            .densities(&self.lists, position, (density, pressure));
        let limit = (1.0 + LARGEST_COMPRESSION) * self.settings.reference_density;
        // a NaN density is not below the limit either
        let first_bad = density
            .par_iter()
            .with_min_len(4096)
            .position_first(|&rho| !(0.0 < rho && rho < limit));
        match first_bad {
            None => Ok(()),
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

    /// Accelerations from pressure, viscosity and gravity; walls are added afterwards.
    pub fn update_accelerations(&mut self) {
        let Particles {
            position,
            velocity,
            density,
            pressure,
            acceleration,
            viscous_acceleration,
            ..
        } = &mut self.particles;
        let records = &mut self.scratch.records;
        self.scheme
            .pack(position, velocity, (density, pressure), records);
        self.scheme.accelerations(
            &self.lists,
            records,
            &self.settings.gravity,
            (acceleration, viscous_acceleration),
        );
    }

    /// Adds forces, of walls and blocks, to the accelerations.
    pub fn add_forces(&mut self, forces: impl Iterator<Item = ParticleForce>) {
        let inverse_mass = 1.0 / self.scheme.particle_mass();
        for f in forces {
            self.particles.acceleration[f.particle as usize] += f.force * inverse_mass;
        }
    }

    /// Puts a particle elsewhere with another velocity; returns the energy it lost, J.
    ///
    /// For a particle found inside a solid; the caller counts it.
    pub fn replace(&mut self, particle: usize, position: Vec3, velocity: Vec3) -> f64 {
        let x = &mut self.particles.position[particle];
        let v = &mut self.particles.velocity[particle];
        let lost = 0.5 * (v.norm_squared() - velocity.norm_squared())
            - self.settings.gravity.dot(&(*x - position));
        *x = self.grid.wrapped(position);
        *v = velocity;
        lost * self.scheme.particle_mass()
    }

    /// Largest steps by cause at the present state; s.
    ///
    /// ```text
    /// sound      0.95 H/(c₀ + max|v|)          viscosity   0.127 H² ρ₀/μ
    /// force      0.25 √(h/max|a|) / 0.5        each times the time-step factor
    /// ```
    /// The first two are the limits of the scheme on a lattice; the third is the customary one at
    /// the default factor of 0.5.
    pub fn step_limits(&self) -> StepLimits {
        let s = &self.settings;
        let support = s.support_radius();
        let viscosity = if 0.0 < s.dynamic_viscosity {
            0.127 * support * support * s.reference_density / s.dynamic_viscosity
        } else {
            f64::INFINITY
        };
        StepLimits {
            sound: s.time_step_factor * 0.95 * support / (s.sound_speed + self.max_speed()),
            viscosity: s.time_step_factor * viscosity,
            force: s.time_step_factor
                * 0.5
                * (s.smoothing_length / largest_norm(&self.particles.acceleration)).sqrt(),
        }
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
        }
    }
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
        if !(self.dynamic_viscosity.is_finite() && 0.0 <= self.dynamic_viscosity) {
            return Err(FluidError::Setting {
                name: "dynamic_viscosity",
                value: self.dynamic_viscosity,
                range: "finite and >= 0",
            });
        }
        if 1.0 < self.time_step_factor {
            return Err(FluidError::Setting {
                name: "time_step_factor",
                value: self.time_step_factor,
                range: "at most 1",
            });
        }
        Ok(())
    }
}
