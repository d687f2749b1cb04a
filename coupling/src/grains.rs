//! Grains in water that are too small for its particles to flow around them: averaged equations.
//!
//! Grains and water share space. Of the water's force on a place each takes the part that belongs to its share of it, and drag acts between
//! the two; the flux of both compresses the water (`riprap_sph::fluid`, where `S` is the force per volume):
//!
//! ```text
//! φ_ij = V_j W_ij/D_j,   ε_i = 1 − Σ_j φ_ij,   w_ij = V_i W_ij/D_j,   D_j = Σ_i V_i W_ij      shares of grain j and of the water at
//!                                                                                          particle i; weights of i for j          [–]
//! m_j dv_j/dt = m_j g + contacts + Σ_i φ_ij V_i S_i + G_j,     G_j = f_d + C_j ds/dt,   C_j = ½ ρ V_j,   s = ⟨u⟩_j − v_j         [N]
//! m_i du_i/dt = m_i g + ε_i V_i S_i − Σ_j w_ij G_j                                                                            [N]
//! ```
//! `⟨·⟩_j` is the mean with the weights: the force of pressure and stress on a grain is `V_j ⟨S⟩_j`. Momentum is exchanged to round-off whatever
//! the force, pressure takes from one side what it gives to the other, drag takes energy and never makes any, and a bed at rest carries the
//! weight of its grains less that of the water they displace.
//!
//! ```text
//! k_j ds/dt = A_u − A_v − f_d q_j,   q_j = 1/m_j + Σ_i w_ij s_i/m_i,   s_i = Σ_k w_ik,   k_j = 1 + C_j q_j
//! f_d = β_j [ s₀ (1 − e^{−x})/x + (A_u − A_v)/k_j dt (x − 1 + e^{−x})/x² ],   x = dt β_j q_j/k_j,   β_j = f_d/|s|
//! ```
//! Drag is that of a slip which relaxes and is driven by the other accelerations `A` of both over the step: it sets no limit to the
//! step, and the speed of settling does not depend on it. `₀` is the slip before this step's forces.
//!
//! Sources: Anderson & Jackson (1967); Robinson, Ramaioli & Luding (2014), with particles; drag in [`drag`].

mod cells;
pub mod drag;
mod nearby;
mod packing;
mod pairs;
mod sight;
mod sums;

use rayon::prelude::*;
use riprap_dda::Blocks;
use riprap_sph::fluid::ParticleForce;
use riprap_sph::{Fluid, Vec3};
use serde::{Deserialize, Serialize};

use crate::saved::{Read, Saved};
use crate::walls::added_mass::Acceleration;
use drag::DragLaw;
use pairs::Pairs;
use sight::Sight;

/// Particles per parallel task; a constant, so that results do not depend on threads.
const CHUNK: usize = 1024;
/// Shares of the kernel around a grain, with its images in walls, that water fills where the grain is dry, and where it is under water; in
/// between it has a part of its volume in the water. Spray in a cloud of grains has room.
const WET_SHARES: [f64; 2] = [0.3, 0.9];
/// Time in which the density of water among grains is drawn to that which its flow carries; × time of sound over the smoothing length.
const DRAWN_OVER: f64 = 10.0;
/// Evaluations of the mean slip over a step and of the resistance at it.
const N_SLIPS: usize = 3;
/// Porosity below which grains are taken to overlap; –.
const LEAST_POROSITY: f64 = 0.2;

/// Numbers of the exchange.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Drag law.
    pub drag: DragLaw,
    /// Radius of the averaging kernel; × diameter of the grain.
    pub kernel_radius: f64,
    /// Viscosity of the water, of mud the plastic one; Pa s.
    pub dynamic_viscosity: f64,
    /// Yield stress; Pa.
    pub yield_stress: f64,
    /// Whether water that is accelerated with a grain adds to its inertia.
    pub has_added_mass: bool,
}

/// A grain.
#[derive(Clone, Copy, Debug)]
struct Grain {
    block: usize,
    /// m.
    diameter: f64,
    /// m³.
    volume: f64,
    /// kg.
    mass: f64,
    /// Radius of its kernel; m.
    reach: f64,
}

/// Forces of the water on a grain; N.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct OnGrain {
    /// Its share of that of pressure.
    pub pressure: Vec3,
    /// Its share of that of viscosity.
    pub viscous: Vec3,
    /// Of water that is accelerated with it.
    pub added: Vec3,
    /// Kinetic energy of this water; J.
    pub added_energy: f64,
    /// Of drag.
    pub drag: Vec3,
}

impl OnGrain {
    /// All of it; N.
    pub fn total(&self) -> Vec3 {
        self.pressure + self.viscous + self.added + self.drag
    }
}

/// Opposites of the forces of added mass and of drag on a particle of water; N, three each.
type OnWater = [f64; 6];

/// Sums over the grains whose kernels reach a particle of water: volume per sum over the kernel (–), one over this sum (1/m³), and the
/// flux (m/s).
type OfGrains = [f64; 5];

/// Quantities of [`Seen`].
const SEEN: usize = 15;

/// Power of the exchange; W.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Power {
    /// That drag takes.
    pub drag: f64,
    /// That viscosity takes from grains.
    pub viscous: f64,
    /// That added mass gives to both sides together.
    pub added: f64,
    /// That grains which are not free give.
    pub by_prescribed: f64,
    /// Force that grains which are not free exert on the water; N.
    pub held: Vec3,
}

/// All grains that exchange forces with the water by averages.
#[derive(Clone, Debug)]
pub struct AveragedGrains {
    settings: Settings,
    grains: Vec<Grain>,
    sight: Sight,
    pairs: Pairs,
    /// Water of the kernel around each grain that counts, 0 to 1; of each grain.
    wet: Vec<f64>,
    /// Of each grain.
    on_grains: Vec<OnGrain>,
    /// Volume of each grain per sum over its kernel, dry 0; m³.
    room: Vec<f64>,
    /// Of each particle of water.
    porosity: Vec<f64>,
    /// Part of the grains in each particle that fits beside the least porosity; –.
    fits: Vec<f64>,
    /// Flux of grains in each particle; m/s.
    flux: Vec<Vec3>,
    /// That they had as the weights were found; m³.
    volume: Vec<f64>,
    /// Sum of the weights of each particle.
    sums: Vec<f64>,
    on_water: Vec<OnWater>,
    /// Of each particle, as just summed.
    of_grains: Vec<OfGrains>,
    /// Of each particle, as the weights see it.
    seen: Vec<[f64; SEEN]>,
    /// Time over which the forces found next act; s.
    dt: f64,
    /// Energy of compression that grains brought in as they got wet, not taken yet; J.
    compressed: f64,
}

impl AveragedGrains {
    /// Exchange of some blocks, all spheres, with a fluid.
    pub fn new(settings: Settings, chosen: &[usize], blocks: &Blocks) -> Self {
        let grain = |&block: &usize| {
            let diameter = 2.0 * blocks.radius(block);
            Grain {
                block,
                diameter,
                volume: blocks.volume(block),
                mass: blocks.mass(block),
                reach: settings.kernel_radius * diameter,
            }
        };
        let grains: Vec<Grain> = chosen.iter().map(grain).collect();
        Self {
            sight: Sight::new(chosen, blocks),
            pairs: Pairs::default(),
            wet: vec![0.0; grains.len()],
            on_grains: vec![OnGrain::default(); grains.len()],
            room: Vec::new(),
            porosity: Vec::new(),
            fits: Vec::new(),
            volume: Vec::new(),
            flux: Vec::new(),
            sums: Vec::new(),
            on_water: Vec::new(),
            of_grains: Vec::new(),
            seen: Vec::new(),
            dt: 0.0,
            compressed: 0.0,
            settings,
            grains,
        }
    }

    /// Numbers of the exchange.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Number of grains.
    pub fn n_grains(&self) -> usize {
        self.grains.len()
    }

    /// Pairs of a grain and a particle of water within its kernel.
    pub fn n_pairs(&self) -> usize {
        self.pairs.len()
    }

    /// Blocks of the grains, ascending.
    pub fn blocks(&self) -> impl Iterator<Item = usize> + '_ {
        self.grains.iter().map(|grain| grain.block)
    }

    /// Blocks of the grains, with the force of the water on each.
    pub fn forces(&self) -> impl Iterator<Item = (usize, &OnGrain)> {
        self.grains
            .iter()
            .map(|grain| grain.block)
            .zip(&self.on_grains)
    }

    /// Leaves room for the grains in water that was placed as if there were none.
    pub(crate) fn leave_room(&mut self, fluid: &mut Fluid, blocks: &Blocks) {
        self.find_pairs(fluid, blocks, true);
        fluid.leave_room(&self.porosity);
    }

    /// Finds the water near each grain, the porosity and the flux of grains, which may be held; the fluid is sorted.
    /// `over` (s) is the time since the density was last drawn to what the flow of the water carries.
    pub(crate) fn find(
        &mut self,
        fluid: &mut Fluid,
        (blocks, are_held): (&Blocks, bool),
        over: f64,
    ) {
        self.find_pairs(fluid, blocks, are_held);
        let settings = fluid.settings();
        let sound = settings.smoothing_length / settings.sound_speed;
        let drawn = -(-over / (DRAWN_OVER * sound)).exp_m1();
        self.compressed += fluid.share_with_grains((&self.porosity, &self.flux), drawn);
    }

    /// Sets the time over which the forces found next act, 0 if not known; s.
    pub(crate) fn set_step(&mut self, fluid: &Fluid, dt: f64) {
        self.dt = match 0.0 < dt {
            true => dt,
            false => fluid.step_limits().sound,
        };
    }

    /// Pairs, and what follows from them for each particle; grains may be held.
    fn find_pairs(&mut self, fluid: &Fluid, blocks: &Blocks, are_held: bool) {
        let Self {
            grains,
            sight,
            pairs,
            wet,
            room,
            volume,
            ..
        } = self;
        let particles = fluid.particles();
        let n = particles.len();
        // of what the flow carries: that of the density follows the porosity, which would follow it
        let volumes = (0..n).into_par_iter().with_min_len(CHUNK);
        volumes
            .map(|a| particles.volume_with_grains(a))
            .collect_into_vec(volume);
        pairs.find((fluid, volume), grains, (sight, blocks));
        room.clear();
        for (g, (wet, filled)) in wet.iter_mut().zip(pairs.filled()).enumerate() {
            let [dry, under_water] = WET_SHARES;
            *wet = ((filled - dry) / (under_water - dry)).clamp(0.0, 1.0);
            room.push(match *wet == 0.0 {
                true => 0.0,
                false => grains[g].volume * *wet / filled,
            });
        }
        let (grains, room, pairs) = (&*grains, &*room, &*pairs);
        // all per particle of a grain's sum over its kernel
        let of_grain = |g: usize| {
            let flux = match are_held {
                true => Vec3::zeros(),
                false => blocks.velocity(grains[g].block) * room[g],
            };
            [room[g], 1.0 / pairs.filled_of(g), flux.x, flux.y, flux.z]
        };
        for column in [&mut self.porosity, &mut self.fits, &mut self.sums] {
            column.resize(n, 1.0);
        }
        self.flux.resize(n, Vec3::zeros());
        self.of_grains.resize(n, OfGrains::default());
        let volume = &self.volume;
        let columns = (
            self.porosity.par_chunks_mut(pairs::RANGE),
            self.fits.par_chunks_mut(pairs::RANGE),
            self.sums.par_chunks_mut(pairs::RANGE),
            self.flux.par_chunks_mut(pairs::RANGE),
            self.of_grains.par_chunks_mut(pairs::RANGE),
        );
        columns.into_par_iter().enumerate().for_each(
            |(range, (porosity, fits, sums, flux, of_grains))| {
                pairs.sums_of_grains(range, of_grain, of_grains);
                let volume = &volume[range * pairs::RANGE..];
                for (k, &[room, per_sum, x, y, z]) in of_grains.iter().enumerate() {
                    let share = 1.0 - room;
                    porosity[k] = share.max(LEAST_POROSITY);
                    fits[k] = match share < LEAST_POROSITY {
                        true => (1.0 - LEAST_POROSITY) / room,
                        false => 1.0,
                    };
                    flux[k] = Vec3::new(x, y, z) * fits[k];
                    sums[k] = per_sum * volume[k];
                }
            },
        );
    }

    /// Forces on both, from the accelerations of the water by everything else; `dry` is that of the blocks.
    pub(crate) fn update(
        &mut self,
        fluid: &mut Fluid,
        blocks: &Blocks,
        (dry, are_held): (&[Acceleration], bool),
    ) {
        let Self {
            settings,
            grains,
            pairs,
            wet,
            on_grains,
            fits,
            volume,
            sums,
            seen,
            dt,
            ..
        } = self;
        let particles = (0..volume.len()).into_par_iter().with_min_len(CHUNK);
        particles
            .map(|a| Seen::of(fluid, a, volume[a], fits[a], sums[a]).quantities())
            .collect_into_vec(seen);
        let moving = Moving {
            fluid,
            settings,
            seen,
            dt: *dt,
        };
        on_grains
            .par_iter_mut()
            .enumerate()
            .for_each(|(g, on_grain)| {
                let (grain, block) = (&grains[g], grains[g].block);
                *on_grain = OnGrain::default();
                if wet[g] <= 0.0 {
                    return;
                }
                let velocity = match are_held {
                    true => Vec3::zeros(),
                    false => blocks.velocity_with_outside(block)[0],
                };
                let body = Body {
                    velocity,
                    dry: dry[block].linear,
                    is_free: blocks.is_free(block) && !are_held,
                };
                let around = moving.around(grain, wet[g], (pairs, g));
                *on_grain = moving.force(grain, wet[g], &around, &body);
            });
        let (pairs, on_grains) = (&*pairs, &*on_grains);
        let of_grain = |g: usize| {
            let per_sum = -1.0 / pairs.filled_of(g);
            let [added, drag] =
                [on_grains[g].added, on_grains[g].drag].map(|force| force * per_sum);
            [added.x, added.y, added.z, drag.x, drag.y, drag.z]
        };
        self.on_water.resize(volume.len(), OnWater::default());
        self.on_water
            .par_chunks_mut(pairs::RANGE)
            .enumerate()
            .for_each(|(range, out)| {
                pairs.sums_of_grains(range, of_grain, out);
                for (forces, volume) in out.iter_mut().zip(&volume[range * pairs::RANGE..]) {
                    *forces = forces.map(|force| force * volume);
                }
            });
        fluid.leave_grains_their_share();
        let given = self.on_water.iter().enumerate();
        let pushed = given.filter(|(_, forces)| **forces != OnWater::default());
        fluid.add_forces(pushed.map(|(a, forces)| {
            let [added, drag] = vectors(forces);
            ParticleForce {
                particle: a as u32,
                force: added + drag,
            }
        }));
    }

    /// Kinetic energy of the water that is accelerated with the grains; J.
    pub(crate) fn added_energy(&self) -> f64 {
        self.on_grains.iter().map(|on| on.added_energy).sum()
    }

    /// Power of the present forces at the present velocities.
    pub(crate) fn power(&self, fluid: &Fluid, blocks: &Blocks) -> Power {
        let velocity = &fluid.particles().velocity;
        let of_chunk = |(chunk, forces): (usize, &[OnWater])| {
            let mut sums = [0.0; 2];
            for (v, forces) in velocity[chunk * CHUNK..].iter().zip(forces) {
                let [added, drag] = vectors(forces);
                sums[0] += added.dot(v);
                sums[1] += drag.dot(v);
            }
            sums
        };
        // in a fixed order, so that it does not depend on threads
        let parts: Vec<[f64; 2]> = (self.on_water.par_chunks(CHUNK).enumerate())
            .map(of_chunk)
            .collect();
        let mut power = Power::default();
        for [added, drag] in parts {
            power.added += added;
            power.drag -= drag;
        }
        for (block, on_grain) in self.forces() {
            let v = blocks.velocity(block);
            power.added += on_grain.added.dot(&v);
            power.viscous -= on_grain.viscous.dot(&v);
            power.drag -= on_grain.drag.dot(&v);
            if !blocks.is_free(block) {
                let force = on_grain.total();
                power.by_prescribed -= force.dot(&v);
                power.held -= force;
            }
        }
        power
    }

    /// Takes the energy of compression that grains brought in since the last call; J.
    pub(crate) fn take_compressed(&mut self) -> f64 {
        std::mem::take(&mut self.compressed)
    }

    /// Appends the state to a byte buffer.
    pub(crate) fn save(&self, out: Vec<u8>) -> Saved {
        let forces = (&self.on_grains, &self.on_water);
        let state = (forces, self.dt, self.compressed);
        postcard::to_extend(&state, out)
    }

    /// Takes it over again.
    pub(crate) fn read<'a>(&mut self, bytes: &'a [u8]) -> Read<'a> {
        let (state, rest) = postcard::take_from_bytes(bytes)?;
        let forces;
        (forces, self.dt, self.compressed) = state;
        (self.on_grains, self.on_water) = forces;
        match self.on_grains.len() == self.grains.len() {
            true => Ok(rest),
            false => Err(postcard::Error::DeserializeBadEncoding),
        }
    }
}

/// Forces of added mass and of drag; N.
fn vectors(&[a, b, c, d, e, f]: &OnWater) -> [Vec3; 2] {
    [Vec3::new(a, b, c), Vec3::new(d, e, f)]
}

/// A grain as it moves.
struct Body {
    /// With the forces of this step's contacts and gravity; m/s.
    velocity: Vec3,
    /// Acceleration by these; m/s².
    dry: Vec3,
    is_free: bool,
}

/// Quantities of a particle times its volume, or of the water around a grain as their means.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// m/s.
    velocity: Vec3,
    /// Force per volume of pressure, of what fits; N/m³.
    pressure: Vec3,
    /// That of viscosity; N/m³.
    viscous: Vec3,
    /// Acceleration without drag; m/s².
    acceleration: Vec3,
    /// Share of grains; –.
    solid: f64,
    /// `s_i/m_i`; 1/kg.
    inverse_mass: f64,
    /// One; –.
    volume: f64,
}

impl Seen {
    /// A particle, of its volume (m³), what fits of its grains, and the sum of its weights.
    fn of(fluid: &Fluid, a: usize, volume: f64, fits: f64, sums: f64) -> Self {
        let (particles, gravity) = (fluid.particles(), fluid.settings().gravity);
        let porosity = particles.porosity_of(a);
        let by_water = particles.acceleration[a] - gravity;
        let by_viscosity = Vec3::from(particles.viscous_acceleration[a].map(f64::from));
        let fitting = particles.mass[a] * fits;
        Self {
            velocity: particles.velocity[a] * volume,
            pressure: (by_water - by_viscosity) * fitting,
            viscous: by_viscosity * fitting,
            acceleration: (gravity + by_water * porosity) * volume,
            solid: (1.0 - porosity) * volume,
            inverse_mass: sums / particles.mass[a] * volume,
            volume,
        }
    }

    /// All of them, the volume at the end.
    fn quantities(&self) -> [f64; SEEN] {
        let vectors = [
            &self.velocity,
            &self.pressure,
            &self.viscous,
            &self.acceleration,
        ];
        let mut all = [0.0; SEEN];
        for (three, vector) in all.chunks_exact_mut(3).zip(vectors) {
            three.copy_from_slice(vector.as_slice());
        }
        all[12..].copy_from_slice(&[self.solid, self.inverse_mass, self.volume]);
        all
    }

    fn from_quantities(of: [f64; SEEN]) -> Self {
        let vector = |first: usize| Vec3::new(of[first], of[first + 1], of[first + 2]);
        Self {
            velocity: vector(0),
            pressure: vector(3),
            viscous: vector(6),
            acceleration: vector(9),
            solid: of[12],
            inverse_mass: of[13],
            volume: of[14],
        }
    }
}

/// The water, and the step over which it moves.
struct Moving<'a> {
    fluid: &'a Fluid,
    settings: &'a Settings,
    seen: &'a [[f64; SEEN]],
    dt: f64,
}

impl Moving<'_> {
    /// Means of the water around a grain, and the share of water at it, with that of the grain itself as its neighbors let it count.
    fn around(&self, grain: &Grain, wet: f64, (pairs, g): (&Pairs, usize)) -> (Seen, f64) {
        let per_sum = 1.0 / pairs.filled_of(g);
        let (sums, own) = pairs.sums_of_water(g, self.seen);
        let around = Seen::from_quantities(sums.map(|sum| sum * per_sum));
        let of_itself = own * grain.volume * wet * per_sum * per_sum;
        (around, 1.0 - unbiased(around.solid, of_itself))
    }

    fn force(
        &self,
        grain: &Grain,
        wet: f64,
        (around, porosity): &(Seen, f64),
        body: &Body,
    ) -> OnGrain {
        let settings = self.settings;
        let water = drag::Water {
            density: self.fluid.settings().reference_density,
            dynamic_viscosity: settings.dynamic_viscosity,
            yield_stress: settings.yield_stress,
        };
        let dt = self.dt;
        let added = match settings.has_added_mass {
            true => 0.5 * water.density * grain.volume * wet,
            false => 0.0,
        };
        let [pressure, viscous] =
            [around.pressure, around.viscous].map(|force| force * (grain.volume * wet));
        let (start, driven, inverse_mass) = match body.is_free {
            true => (
                body.velocity - body.dry * dt,
                body.dry + (pressure + viscous) / grain.mass,
                1.0 / grain.mass,
            ),
            false => (body.velocity, Vec3::zeros(), 0.0),
        };
        // of the slip: a force on the grain and its opposite on the water
        let inverse_mass = inverse_mass + around.inverse_mass;
        let inertia = 1.0 + added * inverse_mass;
        let slip = around.velocity - start;
        let drive = (around.acceleration - driven) / inertia;
        // of the mean slip over the step, which follows from the resistance at it
        let (mut mean, mut resistance) = (slip, 0.0);
        for _ in 0..N_SLIPS {
            let speed = mean.norm();
            resistance = wet * (settings.drag).resistance(&water, grain.diameter, *porosity, speed);
            let [relaxed, followed] = relaxation(dt * resistance * inverse_mass / inertia);
            mean = slip * relaxed + drive * (dt * followed);
        }
        let drag = mean * resistance;
        // half the water of the grain's volume has the mean acceleration of the slip over the step
        let of_slip = drive - drag * (inverse_mass / inertia);
        OnGrain {
            pressure,
            viscous,
            added: of_slip * added,
            added_energy: 0.5 * added * (around.velocity - body.velocity).norm_squared(),
            drag,
        }
    }
}

/// `(1 − e^{−x})/x` and `(x − 1 + e^{−x})/x²`, for x ≥ 0.
fn relaxation(x: f64) -> [f64; 2] {
    if x < 1e-4 {
        // the series: differences of nearly equal numbers lose their digits
        return [1.0 - x * (0.5 - x / 6.0), 0.5 - x * (1.0 / 6.0 - x / 24.0)];
    }
    let relaxed = -(-x).exp_m1() / x;
    [relaxed, (1.0 - relaxed) / x]
}

/// Solid fraction at a grain from the averages with all grains and of it alone: that of the others, without bias.
///
/// Grains at random add their own share to a mean that should be of others; grains in a packing leave a hole in the others where each
/// is, by as much. Between the two the share that counts is `1 − S₀`, with the structure factor of hard spheres at long waves:
///
/// ```text
/// S₀ = (1 − φ)⁴/((1 + 2φ)² − 4φ³ + φ⁴)
/// ```
/// Source: Carnahan & Starling (1969).
fn unbiased(all: f64, own: f64) -> f64 {
    let mut solid = all - own;
    for _ in 0..4 {
        let phi = solid.max(0.0);
        let open = (1.0 - phi).powi(4);
        let factor = open / ((1.0 + 2.0 * phi).powi(2) - 4.0 * phi.powi(3) + phi.powi(4));
        solid = all - own * factor;
    }
    solid.clamp(0.0, 1.0 - LEAST_POROSITY)
}
