//! Grains in water that are too small for its particles to flow around them: averaged equations.
//!
//! Grains and water share space. Of the water's force per volume each grain takes the part that belongs to its volume, and drag
//! acts between the two; porosity enters the density of the water (`riprap_sph::fluid`):
//!
//! ```text
//! ε = 1 − Σ_j V_j W_ij/D_j,     w_ij = V_i W_ij/D_j,   D_j = Σ_i V_i W_ij         share of water; weights of water i for grain j
//! m_j dv_j/dt = m_j g + contacts + F_j,     F_j = V_j ⟨−∇p + ∇·τ⟩_j + f_d + C_j ds/dt,   C_j = ½ ρ V_j,   s = ⟨u⟩_j − v_j         [N]
//! −w_ij F_j                                                                               on the particles of water
//! ```
//! `⟨·⟩_j` is the mean with the weights. Momentum is exchanged to round-off whatever the force, drag takes energy and never makes any,
//! and a bed at rest carries the weight of its grains less that of the water they displace. Work that the pressure's part does on
//! one side and does not take from the other is booked as an error of the averaging.
//!
//! ```text
//! k_j ds/dt = A_u − A_v − f_d q_j,   q_j = 1/m_j + Σ_i w_ij s_i/m_i,   s_i = Σ_k w_ik,   k_j = 1 + C_j q_j
//! f_d = β_j [ s₀ (1 − e^{−x})/x + (A_u − A_v)/k_j dt (x − 1 + e^{−x})/x² ],   x = dt β_j q_j/k_j,   β_j = f_d/|s|
//! ```
//! Drag is that of a slip which relaxes and is driven by the other accelerations `A` of both over the step: it sets no limit to the
//! step, and the speed of settling does not depend on it. `₀` is the slip before this step's forces.
//!
//! Sources: Anderson & Jackson (1967); Robinson, Ramaioli & Luding (2014), with particles; drag in [`drag`].

pub mod drag;
mod pairs;
mod sight;

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

/// Force of the water on a grain; N.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct OnGrain {
    /// Of pressure, stress and added mass.
    pub pressure: Vec3,
    /// Of drag.
    pub drag: Vec3,
}

/// Opposite forces on a particle of water; N.
type OnWater = [Vec3; 2];

/// Power of the exchange; W.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Power {
    /// That drag takes.
    pub drag: f64,
    /// That the pressure's part makes on both sides together.
    pub pressure: f64,
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
    /// Of each particle of water.
    porosity: Vec<f64>,
    /// Sum of the weights of each particle.
    sums: Vec<f64>,
    on_water: Vec<OnWater>,
    /// Time over which the forces found next act; s.
    dt: f64,
    /// Energy of compression that grains brought in by a change of porosity, not taken yet; J.
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
            porosity: Vec::new(),
            sums: Vec::new(),
            on_water: Vec::new(),
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
        self.find_pairs(fluid, blocks);
        fluid.leave_room(&self.porosity);
    }

    /// Finds the water near each grain and the porosity, for forces that act over `dt` (s), 0 if not known; the fluid is sorted.
    pub(crate) fn find(&mut self, fluid: &mut Fluid, blocks: &Blocks, dt: f64) {
        self.dt = match 0.0 < dt {
            true => dt,
            false => fluid.step_limits().sound,
        };
        self.find_pairs(fluid, blocks);
        self.compressed += fluid.set_porosity(&self.porosity);
    }

    fn find_pairs(&mut self, fluid: &Fluid, blocks: &Blocks) {
        let Self {
            grains,
            sight,
            pairs,
            wet,
            ..
        } = self;
        pairs.find(fluid, grains, (sight, blocks));
        for (wet, filled) in wet.iter_mut().zip(pairs.filled()) {
            let [dry, under_water] = WET_SHARES;
            *wet = ((filled - dry) / (under_water - dry)).clamp(0.0, 1.0);
        }
        let n = fluid.particles().len();
        let (wet, pairs) = (&*wet, &*pairs);
        // both per particle of a grain's sum over its kernel
        let of_grain = |g: usize| {
            let per_sum = 1.0 / pairs.filled_of(g);
            [grains[g].volume * wet[g] * per_sum, per_sum]
        };
        let particles = fluid.particles();
        self.porosity.resize(n, 1.0);
        self.sums.resize(n, 0.0);
        let out = self
            .porosity
            .par_chunks_mut(pairs::RANGE)
            .zip(self.sums.par_chunks_mut(pairs::RANGE));
        out.enumerate().for_each(|(range, (porosity, sums))| {
            porosity.fill(1.0);
            sums.fill(0.0);
            let first = range * pairs::RANGE;
            pairs.for_each_in(
                first..first + porosity.len(),
                of_grain,
                |a, kernel, [volume, one]| {
                    porosity[a - first] -= kernel * volume;
                    sums[a - first] += kernel * one;
                },
            );
            for (k, (share, sum)) in porosity.iter_mut().zip(sums).enumerate() {
                *share = share.max(LEAST_POROSITY);
                *sum *= particles.mass[first + k] / particles.density[first + k];
            }
        });
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
            sums,
            dt,
            ..
        } = self;
        let moving = Moving {
            fluid,
            settings,
            sums,
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
            [on_grains[g].pressure * per_sum, on_grains[g].drag * per_sum]
        };
        let particles = fluid.particles();
        self.on_water.resize(particles.len(), OnWater::default());
        self.on_water
            .par_chunks_mut(pairs::RANGE)
            .enumerate()
            .for_each(|(range, out)| {
                out.fill(OnWater::default());
                let first = range * pairs::RANGE;
                pairs.for_each_in(
                    first..first + out.len(),
                    of_grain,
                    |a, kernel, [pressure, drag]| {
                        out[a - first][0] += pressure * kernel;
                        out[a - first][1] += drag * kernel;
                    },
                );
                for (k, forces) in out.iter_mut().enumerate() {
                    let volume = particles.mass[first + k] / particles.density[first + k];
                    *forces = forces.map(|force| force * volume);
                }
            });
        let is_pushed = |forces: &OnWater| forces != &OnWater::default();
        let given = self.on_water.iter().enumerate();
        fluid.add_forces(given.filter(|(_, forces)| is_pushed(forces)).map(
            |(a, [pressure, drag])| ParticleForce {
                particle: a as u32,
                force: pressure + drag,
            },
        ));
    }

    /// Power of the present forces at the present velocities.
    pub(crate) fn power(&self, fluid: &Fluid, blocks: &Blocks) -> Power {
        let velocity = &fluid.particles().velocity;
        let of_chunk = |(chunk, forces): (usize, &[OnWater])| {
            let mut sums = [0.0; 2];
            for (v, forces) in velocity[chunk * CHUNK..].iter().zip(forces) {
                sums[0] += forces[0].dot(v);
                sums[1] += forces[1].dot(v);
            }
            sums
        };
        // in a fixed order, so that it does not depend on threads
        let parts: Vec<[f64; 2]> = (self.on_water.par_chunks(CHUNK).enumerate())
            .map(of_chunk)
            .collect();
        let mut power = Power::default();
        for [pressure, drag] in parts {
            power.pressure += pressure;
            power.drag -= drag;
        }
        for (block, on_grain) in self.forces() {
            let v = blocks.velocity(block);
            power.pressure += on_grain.pressure.dot(&v);
            power.drag -= on_grain.drag.dot(&v);
            if !blocks.is_free(block) {
                let force = on_grain.pressure + on_grain.drag;
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
        let state = (&self.on_grains, &self.on_water, self.dt, self.compressed);
        postcard::to_extend(&state, out)
    }

    /// Takes it over again.
    pub(crate) fn read<'a>(&mut self, bytes: &'a [u8]) -> Read<'a> {
        let (state, rest) = postcard::take_from_bytes(bytes)?;
        (self.on_grains, self.on_water, self.dt, self.compressed) = state;
        match self.on_grains.len() == self.grains.len() {
            true => Ok(rest),
            false => Err(postcard::Error::DeserializeBadEncoding),
        }
    }
}

/// A grain as it moves.
struct Body {
    /// With the forces of this step's contacts and gravity; m/s.
    velocity: Vec3,
    /// Acceleration by these; m/s².
    dry: Vec3,
    is_free: bool,
}

/// Means of the water around a grain.
#[derive(Default)]
struct Around {
    /// m/s.
    velocity: Vec3,
    /// Force per volume of pressure and stress; N/m³.
    stress: Vec3,
    /// Acceleration without drag; m/s².
    acceleration: Vec3,
    /// Share of water, with that of the grain itself as its neighbors let it count; –.
    porosity: f64,
    /// `Σ_i w_ij s_i/m_i`; 1/kg.
    inverse_mass: f64,
}

/// The water, and the step over which it moves.
struct Moving<'a> {
    fluid: &'a Fluid,
    settings: &'a Settings,
    sums: &'a [f64],
    dt: f64,
}

impl Moving<'_> {
    fn around(&self, grain: &Grain, wet: f64, (pairs, g): (&Pairs, usize)) -> Around {
        let particles = self.fluid.particles();
        let gravity = self.fluid.settings().gravity;
        let mut around = Around::default();
        let (mut filled, mut own) = (0.0, 0.0);
        let sum = pairs.filled_of(g);
        let per_sum = grain.volume * wet / sum;
        pairs.for_each_of(g, |a, kernel| {
            let (mass, density) = (particles.mass[a], particles.density[a]);
            let weight = mass / density * kernel / sum;
            let porosity = particles.porosity_of(a);
            let by_water = particles.acceleration[a] - gravity;
            around.velocity += particles.velocity[a] * weight;
            around.stress += by_water * (density * weight);
            around.acceleration += (gravity + by_water * porosity) * weight;
            around.inverse_mass += weight * self.sums[a] / mass;
            filled += (1.0 - porosity) * weight;
            own += weight * kernel * per_sum;
        });
        around.porosity = 1.0 - unbiased(filled, own);
        around
    }

    fn force(&self, grain: &Grain, wet: f64, around: &Around, body: &Body) -> OnGrain {
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
        let stress = around.stress * (grain.volume * wet);
        let (start, driven, inverse_mass) = match body.is_free {
            true => (
                body.velocity - body.dry * dt,
                body.dry + stress / grain.mass,
                1.0 / grain.mass,
            ),
            false => (body.velocity, Vec3::zeros(), 0.0),
        };
        // of the slip: a force on the grain and its opposite on the water
        let inverse_mass = inverse_mass + around.inverse_mass;
        let inertia = 1.0 + added * inverse_mass;
        let slip = around.velocity - start;
        let drive = (around.acceleration - driven) / inertia;
        let speed = (slip + drive * (0.5 * dt)).norm();
        let resistance =
            wet * (settings.drag).resistance(&water, grain.diameter, around.porosity, speed);
        let [relaxed, followed] = relaxation(dt * resistance * inverse_mass / inertia);
        let drag = (slip * relaxed + drive * (dt * followed)) * resistance;
        // half the water of the grain's volume has the mean acceleration of the slip over the step
        let of_slip = drive - drag * (inverse_mass / inertia);
        OnGrain {
            pressure: stress + of_slip * added,
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
