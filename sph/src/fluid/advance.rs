//! Advance in time: kicks, drifts, densities, and their accounts.

use nalgebra::Vector2;
use rayon::prelude::*;

use crate::fluid::energy::fixed_order_sum;
use crate::fluid::speeds::Speeds;
use crate::neighbors::rest::Still;
use crate::scheme::DensityMethod;
use crate::{CHUNK, Dimensions, Fluid, Particles, Vec3};

/// Smallest number of neighbors for a pressure: an isolated particle keeps the reference density.
pub(super) const FEWEST_NEIGHBORS: u32 = 5;

/// Concentration of neighbors, those in walls of particles included, above which a particle is crowded; 1 in open water and in front
/// of such a wall, a half at other walls and at the surface.
const CROWDED: f64 = 1.25;

/// Sound speed of a particle over that of the water, at a concentration `C` of its neighbors.
///
/// Where bodies close in on water, in the pores of a pile on the bed, there is in the end less room than its particles need. Some
/// are put back in front of walls again and again, and density, which follows the flow, does not notice: twice the water is in a
/// place at the density at rest. Particles so close together answer each other faster than those of the lattice for which the
/// step is made; density then alternates from step to step, and they rattle with growing speed. So their sound slows down:
///
/// ```text
/// ω ∝ c C,   c = c₀ (1.25/C)^(3/2)        C > 1.25
/// dρ/dt = (c/c₀)² (dρ/dt)_flow + c/c₀ (dρ/dt)_diffusion
/// ```
/// below that of the lattice by the margin of the step. Forces remain equal and opposite.
pub(super) fn slowed_sound(concentration: f64) -> f64 {
    if CROWDED < concentration {
        (CROWDED / concentration).powf(1.5)
    } else {
        1.0
    }
}

/// Change of the compression energy by a density step; J.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Compression {
    /// Taken by diffusion.
    pub diffusive_loss: f64,
    /// Brought in by walls.
    pub by_walls: f64,
    /// The same through grains.
    pub by_walls_on_grains: f64,
    /// Of the flow, and withheld from crowded particles.
    pub withheld: f64,
}

impl Fluid {
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
        let speeds = velocity
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
                        return Speeds::STILL;
                    }
                    let mut speeds = Speeds::NOTHING;
                    for (((v, a), viscous), m) in
                        velocity.iter_mut().zip(acceleration).zip(viscous).zip(mass)
                    {
                        let before = *v;
                        *v += a * dt;
                        if is_plane {
                            // pressure drives apart particles off the plane by no more than round-off
                            v.y = 0.0;
                        }
                        // with the mean of the velocities before and after, the works of all forces
                        // add up to the change of kinetic energy exactly
                        let viscous = Vec3::from(viscous.map(f64::from));
                        *work += m * viscous.dot(&(before + *v)) * (0.5 * dt);
                        speeds.include(v);
                    }
                    speeds
                },
            )
            .reduce(|| Speeds::NOTHING, Speeds::and);
        self.max_speed = speeds.largest();
        self.closing_speed = speeds.closing(self.settings.symmetry);
        self.viscous_loss -= partial.iter().sum::<f64>();
        self.book_pushes(dt);
    }

    /// Books the work of the pressure of walls in the kick of `dt` just made.
    fn book_pushes(&mut self, dt: f64) {
        if !self.advances_density() {
            return;
        }
        let particles = &self.particles;
        let pushes = &self.scratch.pushes;
        // on the flow of the water, and what grains in it add
        let power = fixed_order_sum(pushes.len(), |k| {
            let (a, push) = (pushes[k].0 as usize, &pushes[k].1);
            let change = particles.acceleration[a] * (0.5 * dt);
            let of_water = particles.mass[a] * push.dot(&(particles.velocity[a] - change));
            let mean = particles.flux(a) - change * particles.porosity_of(a);
            Vector2::new(of_water, particles.mass[a] * push.dot(&mean) - of_water)
        });
        self.from_walls += power.x * dt;
        self.from_walls_by_grains += power.y * dt;
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
        self.approached += self.closing_speed * dt.abs();
    }

    /// Multiplies all velocities by a factor: settling only.
    pub fn damp(&mut self, factor: f64) {
        for v in &mut self.particles.velocity {
            *v *= factor;
        }
    }

    /// Advances the density by `dt` at the rates found, and books what diffusion did to the energy of
    /// compression. A particle with hardly any neighbors gets the reference density.
    pub fn advance_density(&mut self, dt: f64) {
        let change = self.integrate_density(|_, _, _| dt);
        self.book_compression(change);
        self.carry(dt);
    }

    pub(crate) fn book_compression(&mut self, change: Compression) {
        self.diffusive_loss += change.diffusive_loss;
        self.from_walls += change.by_walls;
        self.from_walls_by_grains += change.by_walls_on_grains;
        self.withheld_loss += change.withheld;
    }

    /// Advances the density, each particle by the time that `time` makes of its index, density and rate; returns the
    /// changes of energy to be booked.
    pub(crate) fn integrate_density(
        &mut self,
        time: impl Fn(usize, f64, f64) -> f64 + Sync,
    ) -> Compression {
        let Particles {
            density,
            mass,
            porosity,
            ..
        } = &mut self.particles;
        if self.scratch.rates.len() != density.len() {
            // a run continued with another stepping has none before its first evaluation
            return Compression::default();
        }
        let state = &self.state;
        let porosity = |a: usize| porosity.get(a).copied().unwrap_or(1.0);
        let n_dimensions = self.settings.dimensions.count();
        let still = Still::of(self.sleep.as_deref());
        let (rates, alone) = (&self.scratch.rates, &self.scratch.water_alone);
        let changes = &mut self.scratch.changes;
        changes.resize(density.len().div_ceil(CHUNK), Compression::default());
        density
            .par_chunks_mut(CHUNK)
            .zip(mass.par_chunks(CHUNK))
            .zip(changes.par_iter_mut())
            .enumerate()
            .for_each(|(chunk, ((density, mass), booked))| {
                *booked = Compression::default();
                if still.has(chunk) {
                    return;
                }
                let each = density.iter_mut().zip(mass);
                for (a, (density, mass)) in (chunk * CHUNK..).zip(each) {
                    let (rate, porosity) = (rates.of(a), porosity(a));
                    if rate.n_found <= FEWEST_NEIGHBORS {
                        booked.diffusive_loss += mass * state.specific_energy(*density / porosity);
                        *density = state.reference_density * porosity;
                        continue;
                    }
                    let sound = slowed_sound(rate.crowding / n_dimensions);
                    // what comes in compresses the water alone
                    let flow = rate.flow / porosity;
                    let withheld = (1.0 - sound * sound) * flow;
                    let diffusion = sound * rate.diffusion;
                    let total = flow - withheld + diffusion;
                    let dt = time(a, *density, total);
                    let change = total * dt;
                    // de = p/ρ² dρ, at the middle of the change
                    let middle = *density + 0.5 * change;
                    let slope =
                        mass * state.pressure(middle / porosity) * porosity / (middle * middle);
                    booked.diffusive_loss -= slope * diffusion * dt;
                    let by_all_walls = rates.by_walls(a);
                    let by_walls = alone.get(a).map_or(by_all_walls, |alone| alone.by_walls);
                    booked.by_walls += slope * by_walls / porosity * dt;
                    booked.by_walls_on_grains += slope * (by_all_walls - by_walls) / porosity * dt;
                    booked.withheld += slope * withheld * dt;
                    *density += change;
                }
            });
        let none = Compression::default();
        changes.iter().fold(none, |sum, change| Compression {
            diffusive_loss: sum.diffusive_loss + change.diffusive_loss,
            by_walls: sum.by_walls + change.by_walls,
            by_walls_on_grains: sum.by_walls_on_grains + change.by_walls_on_grains,
            withheld: sum.withheld + change.withheld,
        })
    }

    /// Moves a particle and resets its velocity; returns the energy it lost, J.
    ///
    /// For a particle found inside a solid; the caller counts it.
    pub fn relocate(&mut self, particle: usize, mut position: Vec3, mut velocity: Vec3) -> f64 {
        if self.is_plane() {
            (position.y, velocity.y) = (self.particles.position[particle].y, 0.0);
        }
        let x = &mut self.particles.position[particle];
        let v = &mut self.particles.velocity[particle];
        let lost = 0.5 * (v.norm_squared() - velocity.norm_squared())
            - self.settings.gravity.dot(&(*x - position));
        *x = position;
        *v = velocity;
        // it jumped: bounds on its displacement are invalid
        self.forget_order();
        lost * self.particles.mass[particle]
    }

    /// Gives a particle another velocity (m/s) at once; returns the energy it lost, J.
    pub fn set_velocity(&mut self, particle: usize, mut velocity: Vec3) -> f64 {
        if self.is_plane() {
            velocity.y = 0.0;
        }
        self.record_speed(velocity.norm());
        let v = &mut self.particles.velocity[particle];
        let lost = 0.5 * (v.norm_squared() - velocity.norm_squared());
        *v = velocity;
        lost * self.particles.mass[particle]
    }

    /// Lowers the density of a particle to a limit (kg/m³) if it is above, where densities are integrated; returns the energy
    /// that goes with what leaks, J, or `None` if nothing changed.
    ///
    /// ```text
    /// p(limit) m (1/limit − 1/ρ)     the work of its surroundings, which feel the pressure of the limit        [J]
    /// ```
    pub fn relieve(&mut self, particle: usize, limit: f64) -> Option<f64> {
        let density = self.particles.water_density(particle);
        if density <= limit || self.settings.scheme.density != DensityMethod::Continuity {
            return None;
        }
        self.particles.set_water_density(particle, limit);
        let shrunk = 1.0 / limit - 1.0 / density;
        Some(self.state.pressure(limit) * shrunk * self.particles.mass[particle])
    }

    /// Whether all particles are in one plane across y.
    fn is_plane(&self) -> bool {
        matches!(self.settings.dimensions, Dimensions::Two { .. })
    }

    /// Records a speed set outside of [`Self::kick`]; keeps the bound on drifts valid.
    pub(crate) fn record_speed(&mut self, speed: f64) {
        self.closing_speed = self.closing_speed.max(self.max_speed + speed);
        self.max_speed = self.max_speed.max(speed);
    }
}
