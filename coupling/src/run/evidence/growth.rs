//! Search for what grew first: speeds and densities of particles, speeds and overlaps of blocks.
//!
//! ```text
//! q/max(q_before, q_little) ≥ 2        or q not finite
//! ```
//! with the largest value of all particles or blocks at the start of the search.

use riprap_sph::{FluidError, ParticleId};

use crate::world::{StepError, World};

/// Growth over the largest value before from which a quantity counts as grown.
const GROWN: f64 = 2.0;
/// Largest number of offenders: a blow-up soon takes everything with it.
const MOST: usize = 20;
/// Speed of water at rest, over that of sound.
const STILL: f64 = 0.01;
/// Deviation of density of water at rest.
const INCOMPRESSIBLE: f64 = 0.01;
/// Overlap of blocks at rest, and their fall, over their size.
const TOUCHING: f64 = 1e-3;

/// Particle or block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Object {
    Particle(ParticleId),
    Block(usize),
}

/// Quantity that grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    Speed,
    Density,
    Overlap,
}

/// Object of which a quantity grew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grown {
    pub object: Object,
    pub quantity: Quantity,
    /// Step after which it was first seen so large.
    pub step: u64,
    /// Over the largest before; infinite where it is not finite.
    pub by: f64,
}

impl Grown {
    /// Whether it counts as grown.
    pub fn is_large(&self) -> bool {
        GROWN <= self.by
    }
}

/// Largest values before, or a little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Of particles; m/s.
    pub speed: f64,
    /// Of particles: deviation from the reference density, relative; –.
    pub density: f64,
    /// Of free blocks; m/s.
    pub block_speed: f64,
    /// Of blocks, over their size; –.
    pub overlap: f64,
}

/// Search in progress.
#[derive(Debug)]
pub struct Growth {
    scales: Scales,
    grown: Vec<Grown>,
    step: u64,
}

impl Growth {
    /// Starts from the present state.
    pub fn of(world: &World) -> Self {
        let (blocks, gravity) = (&world.blocks, world.gravity.norm());
        let still = world
            .water
            .as_ref()
            .map_or(0.0, |water| STILL * water.fluid.settings().sound_speed);
        let falls = (0..blocks.n_blocks())
            .filter(|&b| blocks.is_free(b))
            .map(|b| (2.0 * gravity * TOUCHING * blocks.volume(b).cbrt()).sqrt());
        let mut scales = Scales {
            speed: still,
            density: INCOMPRESSIBLE,
            block_speed: falls.fold(f64::MIN_POSITIVE, f64::max),
            overlap: TOUCHING,
        };
        visit(world, &mut |object, quantity, value| {
            let scale = scales.of(object, quantity);
            *scale = scale.max(value);
        });
        Self {
            scales,
            grown: Vec::new(),
            step: 0,
        }
    }

    /// Largest values at the start.
    pub fn scales(&self) -> Scales {
        self.scales
    }

    /// Notes what has grown since the last look, the most grown first.
    pub fn look(&mut self, world: &World, step: u64) {
        self.step = step;
        for grown in &self.growths(world, GROWN) {
            let is_known = |old: &Grown| old.object == grown.object;
            if self.grown.len() < MOST && !self.grown.iter().any(is_known) {
                self.grown.push(*grown);
            }
        }
    }

    /// What grew first, in order, with what the error names; what grew most where nothing has grown much.
    pub fn most_suspect(&mut self, error: Option<&StepError>, world: &World) -> Vec<Grown> {
        let growths = self.growths(world, 0.0);
        for object in error.map_or(Vec::new(), named_by) {
            if self.grown.iter().all(|grown| grown.object != object) {
                self.grown
                    .extend(growths.iter().find(|grown| grown.object == object));
            }
        }
        if self.grown.is_empty() {
            self.grown.extend(growths.first());
        }
        std::mem::take(&mut self.grown)
    }

    /// Quantities of all objects that grew by more than `least`, the most grown first.
    fn growths(&self, world: &World, least: f64) -> Vec<Grown> {
        let (mut scales, step) = (self.scales, self.step);
        let mut growths = Vec::new();
        visit(world, &mut |object, quantity, value| {
            let by = value / *scales.of(object, quantity);
            let by = if by.is_finite() { by } else { f64::INFINITY };
            if least <= by {
                growths.push(Grown {
                    object,
                    quantity,
                    step,
                    by,
                });
            }
        });
        // stable: equals stay in the order of the visit
        growths.sort_by(|a, b| b.by.total_cmp(&a.by));
        growths
    }
}

impl Scales {
    fn of(&mut self, object: Object, quantity: Quantity) -> &mut f64 {
        match (object, quantity) {
            (Object::Particle(_), Quantity::Speed) => &mut self.speed,
            (_, Quantity::Density) => &mut self.density,
            (Object::Block(_), Quantity::Speed) => &mut self.block_speed,
            (_, Quantity::Overlap) => &mut self.overlap,
        }
    }
}

/// Visits the quantities of all particles and of all blocks that move.
fn visit(world: &World, see: &mut impl FnMut(Object, Quantity, f64)) {
    if let Some(water) = &world.water {
        let particles = water.fluid.particles();
        let reference = water.fluid.settings().reference_density;
        for (a, &id) in particles.id.iter().enumerate() {
            let object = Object::Particle(id);
            see(object, Quantity::Speed, particles.velocity[a].norm());
            let deviation = (particles.water_density(a) / reference - 1.0).abs();
            see(object, Quantity::Density, deviation);
        }
    }
    let blocks = &world.blocks;
    let is_present = |b: &usize| blocks.is_free(*b) && !blocks.is_removed(*b);
    for b in (0..blocks.n_blocks()).filter(is_present) {
        let spin = blocks.angular_velocity(b).norm() * blocks.radius(b);
        let speed = blocks.velocity(b).norm() + spin;
        see(Object::Block(b), Quantity::Speed, speed);
    }
    for contact in blocks.contacts() {
        for block in [contact.blocks.0, contact.blocks.1] {
            let b = block.index();
            if is_present(&b) {
                let size = blocks.volume(b).cbrt();
                see(Object::Block(b), Quantity::Overlap, contact.overlap / size);
            }
        }
    }
}

/// Particles and blocks that an error names.
fn named_by(error: &StepError) -> Vec<Object> {
    match error {
        StepError::Fluid {
            source: FluidError::NonFinite { id, .. } | FluidError::Compressed { id, .. },
            ..
        }
        | StepError::NoVelocity { id, .. }
        | StepError::Supersonic { id, .. } => vec![Object::Particle(*id)],
        StepError::AtPlane { block, .. } => vec![Object::Block(block.index())],
        StepError::Blocks { source, .. } => match source {
            riprap_dda::StepError::NotFinite { block, .. }
            | riprap_dda::StepError::Crushed { block, .. } => vec![Object::Block(block.index())],
            riprap_dda::StepError::Overlap { overlap, .. } => {
                let (a, b) = overlap.blocks;
                [a, b].map(|block| Object::Block(block.index())).to_vec()
            }
            riprap_dda::StepError::Unsolved { .. } | riprap_dda::StepError::TimeStep { .. } => {
                Vec::new()
            }
        },
        StepError::Named { error, .. } => named_by(error),
        StepError::Fluid { .. }
        | StepError::Overlap { .. }
        | StepError::Left { .. }
        | StepError::EnergyFromNowhere { .. }
        | StepError::Drained { .. }
        | StepError::Stalled { .. } => Vec::new(),
    }
}
