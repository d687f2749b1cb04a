//! Walls of exact kernel integrals over the blocks' polyhedra.
//!
//! The integrals over a solid are `λ = ∫ W dV`, `∇λ = ∫ ∇W dV` and `Q = ∫ (y − x) ⊗ ∇W dV`, corrected for
//! rows of particles; the wall's pressure is that of the particle, extrapolated along gravity minus the
//! wall's acceleration:
//!
//! ```text
//! dρ_a/dt += ρ_a (v_a − v_w)·∇λ                                                 [kg/(m³ s)]
//! F_a = −V_a [ (p_a + max(p_a, 0)) ∇λ + ρ_a Qᵀ (g − a_w) ]                               [N]
//! no slip   F_a += m_a ν 2 (v_a − v_w)_t φ(d) λ/λ_plane(d)      φ of `viscous_factor`
//! rough     F_a −= m_a ω τ/(ρ δ) (v_a − v_w)_t/|(v_a − v_w)_t|   of `riprap_sph::boundary::wall_law`
//! approach  F_a += V_a² ρ_0 α c_0 h (v_ab·x_ab)/(r² + 0.01 h²) ∇W      mirror particle at r = 2d
//! ```
//!
//! The second force is that of a wall that moves as `2 v_w − v_a`, by the share that the solid has of a
//! plane's. The last one, on particles that approach only, takes the noise of particles that jump
//! against a wall that has no particles to meet. Each force is felt by the block in reverse, at the
//! particle: a sum of central forces has the same moment there as inside the wall.
//!
//! Integrals are additive over disjoint solids. Fixed solids are cut to be disjoint; the overlap of a
//! moving block with another solid counts twice. Along a straining wall, `v_w` varies over the kernel
//! support: `dρ_a/dt −= ρ_a tr(L Q)`, with `L` the velocity gradient of the block.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use rayon::prelude::*;
use riprap_dda::{BlockDefinition, Blocks};
use riprap_sph::boundary::integral::{
    LayerTable, WallIntegral, integrate, plane_share, viscous_factor,
};
use riprap_sph::boundary::wall_integrals::WallForce;
use riprap_sph::boundary::wall_law::WallLaw;
use riprap_sph::boundary::wall_particles::Slip;
use riprap_sph::kernel::{Kernel, PointKernel};
use riprap_sph::scheme::{ALPHA, Viscosity};
use riprap_sph::{Dimensions, Fluid, Vec3};

use super::added_mass::{Acceleration, AddedMass, Movers, largest_ratio};
use super::cutting::disjoint;
use super::endless::Endless;
use super::{FluidLoad, Part, face_lattice, parts};
use crate::saved::{Read, Saved};
use crate::walls::part_table::{PartTable, Placed, Solids};

/// Smallest distance from a surface, in spacings, used in the integrals: closer they hardly
/// increase, so that a spring has to stop the particle.
pub const CLOSEST: f64 = 0.05;
/// Particles per parallel task; a constant, so that results do not depend on threads.
const CHUNK: usize = 256;
/// Stands for all fixed solids, which are one body to the fluid.
const FIXED: u32 = u32::MAX;

/// The walls of all blocks.
#[derive(Clone, Debug)]
pub struct IntegralWalls {
    support_radius: f64,
    particle_spacing: f64,
    dimensions: Dimensions,
    layers: LayerTable,
    slip: Slip,
    fixed: Vec<Part>,
    near_fixed: PartTable,
    /// Solids of the blocks that move.
    moving: Vec<MovingPart>,
    near_moving: PartTable,
    /// Position of each block at the start of the step.
    start: Vec<Place>,
    /// Current motion of each block.
    motions: Vec<BodyMotion>,
    added: Vec<AddedMass>,
    chunks: Vec<Vec<Sight>>,
    sights: Vec<Sight>,
    forces: Vec<WallForce>,
    loads: Vec<FluidLoad>,
    force_on_fluid: Vec3,
    power: f64,
}

/// A solid of a block that moves.
#[derive(Clone, Debug)]
struct MovingPart {
    block: u32,
    /// In the frame of the block; m.
    local: Part,
    /// Its current placement; no faces if its block was removed; m.
    placed: Part,
    /// Placement of its block.
    at: Place,
}

/// Place and motion of a block.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// m.
    center: Vec3,
    /// Of the placement, from that of the start.
    gradient: Matrix3<f64>,
    /// m/s.
    velocity: Vec3,
    /// Gradient of the velocity; 1/s.
    rate: Matrix3<f64>,
}

impl Place {
    fn of(blocks: &Blocks, block: usize) -> Self {
        Self {
            center: blocks.centroid(block),
            gradient: blocks.gradient(block),
            velocity: blocks.velocity(block),
            rate: blocks.velocity_gradient(block),
        }
    }

    /// Midpoint to another placement: by half of the rotation, or of the deformation.
    fn half_way(&self, end: &Self, is_rigid: bool) -> Self {
        let gradient = if is_rigid {
            // by quaternions: for a matrix whose trace exceeds 3 by round-off the angle is NaN
            let turn = Rotation3::from_matrix_unchecked(end.gradient * self.gradient.transpose());
            let turn = UnitQuaternion::from_rotation_matrix(&turn);
            let half = UnitQuaternion::identity().nlerp(&turn, 0.5);
            half.to_rotation_matrix() * self.gradient
        } else {
            (self.gradient + end.gradient) * 0.5
        };
        Self {
            center: (self.center + end.center) * 0.5,
            gradient,
            ..*self
        }
    }
}

/// Velocities and accelerations of a body.
#[derive(Clone, Copy, Debug, Default)]
struct BodyMotion {
    /// m.
    center: Vec3,
    /// m/s.
    velocity: Vec3,
    /// Gradient of the velocity; 1/s.
    rate: Matrix3<f64>,
    /// m/s².
    acceleration: Vec3,
    /// Gradient of the acceleration; 1/s².
    growth: Matrix3<f64>,
}

impl BodyMotion {
    fn velocity_at(&self, x: &Vec3) -> Vec3 {
        self.velocity + self.rate * (x - self.center)
    }

    fn acceleration_at(&self, x: &Vec3) -> Vec3 {
        self.acceleration + self.growth * (x - self.center)
    }

    fn accelerate(&mut self, more: &Acceleration) {
        self.acceleration += more.linear;
        self.growth += more.angular.cross_matrix();
    }
}

/// A body within the support of a particle.
#[derive(Clone, Copy, Debug)]
struct Sight {
    particle: u32,
    /// Number of a block that moves, or [`FIXED`].
    body: u32,
    integral: WallIntegral,
    /// From the nearest plane; m.
    distance: f64,
}

impl IntegralWalls {
    /// Walls for the fluid at the current position of the blocks.
    pub fn new(
        definitions: &[BlockDefinition],
        blocks: &Blocks,
        fluid: &Fluid,
        slip: Slip,
    ) -> Self {
        let support_radius = fluid.settings().support_radius();
        let (particle_spacing, _) = face_lattice(fluid);
        let dimensions = fluid.settings().dimensions;
        let endless = Endless::of(fluid);
        let (mut standing, mut moving) = (Vec::new(), Vec::new());
        for (b, definition) in definitions.iter().enumerate() {
            let parts: Vec<Part> = parts(&definition.shape)
                .iter()
                .map(|part| endless.ending_beyond(part, 2.0 * support_radius))
                .collect();
            if blocks.is_fixed(b) {
                standing.extend(parts);
                continue;
            }
            // blocks are undeformed at the start
            let turned_back = blocks.gradient(b).transpose();
            let at = Place::of(blocks, b);
            moving.extend(parts.into_iter().map(|placed| MovingPart {
                block: b as u32,
                local: placed.moved(&turned_back, &-(turned_back * at.center)),
                placed,
                at,
            }));
        }
        let fixed = disjoint(standing);
        let mut near_fixed = PartTable::default();
        let unmoved = (0..fixed.len()).map(|k| Placed {
            number: k as u32,
            center: Vec3::zeros(),
            gradient: Matrix3::identity(),
        });
        near_fixed.update(unmoved, &fixed, fluid.grid(), support_radius);
        let n_blocks = definitions.len();
        Self {
            support_radius,
            particle_spacing,
            dimensions,
            layers: LayerTable::new(particle_spacing, support_radius, dimensions),
            slip,
            fixed,
            near_fixed,
            moving,
            near_moving: PartTable::default(),
            start: (0..n_blocks).map(|b| Place::of(blocks, b)).collect(),
            motions: vec![BodyMotion::default(); n_blocks],
            added: vec![AddedMass::default(); n_blocks],
            chunks: Vec::new(),
            sights: Vec::new(),
            forces: Vec::new(),
            loads: vec![FluidLoad::default(); n_blocks],
            force_on_fluid: Vec3::zeros(),
            power: 0.0,
        }
    }

    /// Appends the state to a byte buffer.
    pub(crate) fn save(&self, out: Vec<u8>) -> Saved {
        postcard::to_extend(&(&self.loads, self.force_on_fluid, self.power), out)
    }

    /// Takes it over again.
    pub(crate) fn read<'a>(&mut self, bytes: &'a [u8]) -> Read<'a> {
        let n = self.loads.len();
        let rest;
        ((self.loads, self.force_on_fluid, self.power), rest) = postcard::take_from_bytes(bytes)?;
        match self.loads.len() == n {
            true => Ok(rest),
            false => Err(postcard::Error::DeserializeBadEncoding),
        }
    }

    /// Fluid loads on every moving block.
    pub fn loads(&self) -> &[FluidLoad] {
        &self.loads
    }

    /// Force of all walls on the fluid; N.
    pub fn force_on_fluid(&self) -> Vec3 {
        self.force_on_fluid
    }

    /// Power that blocks which are not free give to the fluid; W.
    pub fn power(&self) -> f64 {
        self.power
    }

    /// Remembers where the blocks are: before they move.
    pub fn record_start(&mut self, blocks: &Blocks) {
        for (block, start) in self.start.iter_mut().enumerate() {
            *start = Place::of(blocks, block);
        }
    }

    /// Places the solids at half of the step of `dt` (s) just taken by the blocks, with the velocity that leads
    /// from its start to its end.
    pub fn place_half_way(&mut self, blocks: &Blocks, dt: f64) {
        let mut middle = self.start.clone();
        for part in &self.moving {
            let b = part.block as usize;
            let (start, end) = (&self.start[b], Place::of(blocks, b));
            middle[b] = start.half_way(&end, !blocks.is_deformable(b));
            let inverse = middle[b].gradient.try_inverse();
            let inverse = inverse.unwrap_or_else(Matrix3::identity);
            self.motions[b] = BodyMotion {
                center: middle[b].center,
                velocity: (end.center - start.center) / dt,
                rate: (end.gradient - start.gradient) * inverse / dt,
                ..BodyMotion::default()
            };
        }
        self.place(blocks, |b| middle[b]);
    }

    /// Places the solids at the blocks, with their motion after a step of `dt` (s), or at rest without a step, where
    /// blocks are held. Their acceleration is that of the step; zero before the first, and for free
    /// blocks only the part due to their spin, as the rest depends on the forces to be computed.
    pub fn place_at_end(&mut self, blocks: &Blocks, dt: Option<f64>) {
        for part in &self.moving {
            let b = part.block as usize;
            let (start, end) = (&self.start[b], Place::of(blocks, b));
            let at_rest = BodyMotion {
                center: end.center,
                ..BodyMotion::default()
            };
            self.motions[b] = match dt {
                None => at_rest,
                Some(dt) => {
                    let is_known = 0.0 < dt && !blocks.is_free(b);
                    let per_time = if is_known { 1.0 / dt } else { 0.0 };
                    BodyMotion {
                        velocity: end.velocity,
                        rate: end.rate,
                        acceleration: (end.velocity - start.velocity) * per_time,
                        growth: (end.rate - start.rate) * per_time + end.rate * end.rate,
                        ..at_rest
                    }
                }
            };
        }
        self.place(blocks, |b| Place::of(blocks, b));
    }

    fn place(&mut self, blocks: &Blocks, place: impl Fn(usize) -> Place) {
        for part in &mut self.moving {
            let b = part.block as usize;
            part.placed = if blocks.is_removed(b) {
                Part::default()
            } else {
                part.at = place(b);
                part.local.moved(&part.at.gradient, &part.at.center)
            };
        }
    }

    /// Computes the integrals of the particles over the solids, after each sort of the fluid and placement.
    pub fn find(&mut self, fluid: &mut Fluid) {
        let present = self.moving.iter().enumerate();
        let present = present.filter(|(_, part)| !part.placed.faces.is_empty());
        let placed = present.map(|(k, part)| Placed {
            number: k as u32,
            center: part.at.center,
            gradient: part.at.gradient,
        });
        self.near_moving
            .update(placed, &self.moving, fluid.grid(), self.support_radius);
        let positions = &fluid.particles().position;
        let mut chunks = std::mem::take(&mut self.chunks);
        chunks.resize_with(positions.len().div_ceil(CHUNK), Vec::new);
        chunks
            .par_iter_mut()
            .zip(positions.par_chunks(CHUNK))
            .enumerate()
            .for_each(|(chunk, (sights, positions))| {
                sights.clear();
                for (a, x) in positions.iter().enumerate() {
                    let cell = fluid.grid().cell_of(x);
                    let (first, particle) = (sights.len(), (chunk * CHUNK + a) as u32);
                    for &part in self.near_fixed.near(cell) {
                        let seen = self.seen(&self.fixed[part as usize], x);
                        add(sights, first, (particle, FIXED), seen);
                    }
                    for &part in self.near_moving.near(cell) {
                        let part = &self.moving[part as usize];
                        let seen = self.seen(&part.placed, x);
                        add(sights, first, (particle, part.block), seen);
                    }
                }
            });
        self.sights.clear();
        for chunk in &chunks {
            self.sights.extend_from_slice(chunk);
        }
        self.chunks = chunks;
    }

    /// Wall integral of a solid at a point, and the distance to the nearest plane; m.
    fn seen(&self, part: &Part, x: &Vec3) -> Option<(WallIntegral, f64)> {
        let (normal, distance) = part.nearest_plane(x)?;
        if self.support_radius <= distance {
            return None;
        }
        let closest = CLOSEST * self.particle_spacing;
        let from = x + normal * (closest - distance).max(0.0);
        let layers = Some(&self.layers);
        let integral = integrate(
            &part.faces(),
            &from,
            self.support_radius,
            self.dimensions,
            layers,
        );
        Some((integral, distance.max(closest)))
    }

    fn motion(&self, body: u32) -> BodyMotion {
        // fixed solids are past the end of the list
        let motion = self.motions.get(body as usize);
        motion.copied().unwrap_or_default()
    }

    /// Adds the walls' part to the rates of density.
    pub fn add_rates(&mut self, fluid: &mut Fluid) {
        let rates: Vec<(u32, f64)> = {
            let particles = fluid.particles();
            let rate = |sight: &Sight| {
                let a = sight.particle as usize;
                let wall = self.motion(sight.body).velocity_at(&particles.position[a]);
                // of a rigid spin Q makes nothing: it is symmetric
                let strained = (self.motion(sight.body).rate * sight.integral.moment).trace();
                let flow = (particles.velocity[a] - wall).dot(&sight.integral.gradient) - strained;
                (sight.particle, particles.density[a] * flow)
            };
            self.sights.iter().map(rate).collect()
        };
        fluid.add_density_rates(rates.into_iter());
    }

    /// Adds the walls' part to the spread of the particles.
    pub fn add_concentrations(&mut self, fluid: &mut Fluid) {
        let seen = self.sights.iter().map(|s| (s.particle, &s.integral));
        fluid.add_wall_spreads(seen);
    }

    /// Solves the acceleration of the free blocks under the fluid loads.
    pub fn accelerate(&mut self, fluid: &Fluid, movers: Movers) {
        let blocks = movers.blocks;
        self.added.fill(AddedMass::default());
        let mut is_any = false;
        let particles = fluid.particles();
        for sight in &self.sights {
            let b = sight.body as usize;
            if sight.body == FIXED || !blocks.is_free(b) {
                continue;
            }
            is_any = true;
            let a = sight.particle as usize;
            let arm = particles.position[a] - self.motions[b].center;
            // F = V ρ Qᵀ (g − a) on the block
            self.added[b].add_inertia(
                &arm,
                &(sight.integral.moment.transpose() * particles.mass[a]),
            );
        }
        if !is_any {
            return;
        }
        self.sum_loads(fluid, blocks);
        for b in (0..self.motions.len()).filter(|&b| blocks.is_free(b)) {
            let found = movers.solve(b, &self.loads[b].total(), &self.added[b]);
            self.motions[b].accelerate(&found);
        }
    }

    /// The acceleration of a block that its wall was given at last.
    #[cfg(test)]
    pub(super) fn acceleration(&self, block: usize) -> Acceleration {
        Acceleration {
            linear: self.motions[block].acceleration,
            angular: Vec3::zeros(),
        }
    }

    /// Loads under the same acceleration of all free blocks.
    #[cfg(test)]
    pub(super) fn accelerate_all(&mut self, fluid: &Fluid, blocks: &Blocks, all: &Acceleration) {
        for b in (0..self.motions.len()).filter(|&b| blocks.is_free(b)) {
            self.motions[b].accelerate(all);
        }
        self.sum_loads(fluid, blocks);
    }

    /// Largest ratio of the inertia that its wall adds to a block to its own mass.
    pub fn largest_added_mass_ratio(&self, blocks: &Blocks) -> f64 {
        largest_ratio(&self.added, blocks)
    }

    /// Adds the walls' forces to the accelerations, and sums the reactions on the moving blocks.
    pub fn add_forces(&mut self, fluid: &mut Fluid, blocks: &Blocks) {
        self.sum_loads(fluid, blocks);
        fluid.add_wall_forces(self.forces.iter().copied());
    }

    /// Forces on all particles, and the reactions on the moving blocks.
    fn sum_loads(&mut self, fluid: &Fluid, blocks: &Blocks) {
        self.loads.fill(FluidLoad::default());
        self.power = 0.0;
        self.force_on_fluid = Vec3::zeros();
        let mut forces = std::mem::take(&mut self.forces);
        forces.clear();
        forces.extend(self.sights.iter().map(|sight| self.force(sight, fluid)));
        for (sight, wall) in self.sights.iter().zip(&forces) {
            self.force_on_fluid += wall.force;
            if sight.body == FIXED {
                continue;
            }
            let b = sight.body as usize;
            let x = fluid.particles().position[wall.particle as usize];
            let arm = x - blocks.centroid(b);
            self.loads[b].add(&(wall.viscous - wall.force), &-wall.viscous, &arm);
            if !blocks.is_free(b) {
                self.power += wall.force.dot(&self.motions[b].velocity_at(&x));
            }
        }
        self.forces = forces;
    }

    fn force(&self, sight: &Sight, fluid: &Fluid) -> WallForce {
        let (particles, settings) = (fluid.particles(), fluid.settings());
        let a = sight.particle as usize;
        let (x, rho, p) = (
            &particles.position[a],
            particles.density[a],
            particles.pressure[a],
        );
        let volume = particles.mass[a] / rho;
        let motion = self.motion(sight.body);
        let integral = &sight.integral;
        let pull = settings.gravity - motion.acceleration_at(x);
        // a wall does not pull
        let joint = p + p.max(0.0);
        let pressure = (integral.gradient * joint + integral.moment.tr_mul(&pull) * rho) * -volume;
        let jump = particles.velocity[a] - motion.velocity_at(x);
        let viscous = match integral.gradient.try_normalize(0.0) {
            None => Vec3::zeros(),
            Some(inward) => {
                let approach = jump.dot(&inward);
                let mut force = inward * -self.damping(approach, sight.distance, volume, fluid);
                let along = jump - inward * approach;
                force += match self.slip {
                    Slip::None => {
                        let (distance, radius) = (sight.distance, self.support_radius);
                        let share =
                            integral.lambda / plane_share(distance, radius, self.dimensions);
                        let factor = 2.0
                            * settings.kinematic_viscosity()
                            * viscous_factor(distance, radius, self.dimensions)
                            * share;
                        along * (particles.mass[a] * factor)
                    }
                    Slip::Rough {
                        roughness,
                        kinematic_viscosity,
                    } => {
                        let law = WallLaw {
                            height: settings.mean_spacing(),
                            kinematic_viscosity,
                            roughness,
                        };
                        let deceleration = law.deceleration(along.norm(), sight.distance);
                        along.try_normalize(0.0).unwrap_or_default()
                            * (-particles.mass[a] * deceleration)
                    }
                    Slip::Free | Slip::Friction(_) => Vec3::zeros(),
                };
                force
            }
        };
        WallForce {
            particle: sight.particle,
            force: pressure + viscous,
            viscous,
        }
    }

    /// Artificial viscosity, with its mirror image as the only neighbor, of a particle that approaches a
    /// wall at a speed (m/s) from a distance (m); N.
    fn damping(&self, approach: f64, distance: f64, volume: f64, fluid: &Fluid) -> f64 {
        if approach <= 0.0 {
            return 0.0;
        }
        let settings = fluid.settings();
        let h = settings.smoothing_length;
        let alpha = match settings.scheme.viscosity {
            Viscosity::Artificial { alpha } => alpha,
            _ => ALPHA,
        };
        let kernel = PointKernel::new(
            settings.scheme.kernel,
            self.support_radius,
            settings.dimensions,
        );
        let r = 2.0 * distance;
        let slope = -r * kernel.gradient_factor(r);
        let strength = settings.reference_density * alpha * settings.sound_speed * h;
        volume * volume * strength * (2.0 * approach * r) / (r * r + 0.01 * h * h) * slope
    }
}

impl Part {
    /// Mapped about the origin, then shifted (m).
    fn moved(&self, gradient: &Matrix3<f64>, shift: &Vec3) -> Self {
        let inverse = gradient.try_inverse().unwrap_or_else(Matrix3::identity);
        self.mapped(
            |normal| inverse.tr_mul(normal).normalize(),
            |x| gradient * x + shift,
        )
    }
}

/// Adds the integral of a particle over a part to that over other parts of the same body.
fn add(
    sights: &mut Vec<Sight>,
    first: usize,
    (particle, body): (u32, u32),
    seen: Option<(WallIntegral, f64)>,
) {
    let Some((integral, distance)) = seen else {
        return;
    };
    match sights[first..].iter_mut().find(|other| other.body == body) {
        None => sights.push(Sight {
            particle,
            body,
            integral,
            distance,
        }),
        Some(other) => {
            other.integral.lambda += integral.lambda;
            other.integral.gradient += integral.gradient;
            other.integral.moment += integral.moment;
            other.distance = other.distance.min(distance);
        }
    }
}

impl Solids for Vec<Part> {
    fn aabb(&self, solid: u32) -> (Vec3, Vec3) {
        self[solid as usize].aabb()
    }

    fn is_within(&self, solid: u32, x: &Vec3, distance: f64) -> bool {
        self[solid as usize].may_be_within(x, distance)
    }
}

impl Solids for Vec<MovingPart> {
    fn aabb(&self, solid: u32) -> (Vec3, Vec3) {
        self[solid as usize].placed.aabb()
    }

    fn is_within(&self, solid: u32, x: &Vec3, distance: f64) -> bool {
        self[solid as usize].placed.may_be_within(x, distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_a_turn_twice_is_the_turn_however_small() {
        let place = |turn: &Rotation3<f64>| Place {
            center: Vec3::zeros(),
            gradient: *turn.matrix(),
            velocity: Vec3::zeros(),
            rate: Matrix3::zeros(),
        };
        let axis = Vec3::new(0.3, -0.5, 0.8);
        for k in 0..2000 {
            let start = Rotation3::from_scaled_axis(axis * (0.001 * f64::from(k)));
            for angle in [0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.5] {
                let turn = Rotation3::from_scaled_axis(Vec3::y() * angle);
                let end = turn * start;
                let half = place(&start).half_way(&place(&end), true).gradient;
                let found = half * start.matrix().transpose() * half;
                // round-off of a few products
                assert!((found - end.matrix()).norm() < 1e-14, "{k} {angle}: {half}");
            }
        }
    }
}
