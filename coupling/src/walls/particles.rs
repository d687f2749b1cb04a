//! Walls of particles on blocks: sampled once in each block's frame, carried along with it.
//!
//! Points of fixed blocks are a constant set; those of moving blocks are another, placed twice
//! per step: half way, where the density is advanced, and at its end. In between a point moves on a straight
//! line at constant speed, so that the points sweep the same volume as the wall.
//!
//! Solids end at planes of symmetry, and their points are mirrored there: loads are those on the part in front of the
//! planes.
//!
//! Where a moving block is inside a fixed one, such as a block drawn on into its bed, the wall is that of the fixed
//! one: of its points only what is outside counts, and thin solids are inactive. Otherwise the bed beside the block would appear to move with
//! it, and drag water along.

mod buried;
mod points;
mod surface;

use nalgebra::Matrix3;
use riprap_dda::{BlockDefinition, Blocks, Load};
use riprap_sph::boundary::wall_particles::{Slip, WallParticles};
use riprap_sph::{Fluid, Vec3, ViscousStep};

use super::FluidLoad;
use super::added_mass::{Acceleration, AddedMass, Movers, largest_ratio};
use super::sampler::Sampler;
use super::thin_solids::ThinSolids;
use crate::saved::{Read, Saved};
use buried::Buried;
use points::Solids;
use surface::FacesAbove;

/// The walls of all blocks.
#[derive(Clone, Debug)]
pub struct ParticleWalls {
    fixed: WallParticles,
    /// Block of each fixed point.
    fixed_block: Box<[u32]>,
    moving: WallParticles,
    thin_solids: ThinSolids,
    /// Block of each moving point.
    block: Vec<u32>,
    /// Position of each moving point relative to the centroid of its block, in the axes and the shape of the start; m.
    local: Vec<Vec3>,
    buried: Buried,
    above: FacesAbove,
    /// Present centroid and gradient of each block; m.
    frames: Vec<Frame>,
    /// Position and velocity of each moving point at the start of the step; m, m/s.
    start: Vec<[Vec3; 2]>,
    loads: Vec<FluidLoad>,
    /// Part of the loads that an implicit viscous step added.
    drags: Vec<FluidLoad>,
    added: Vec<AddedMass>,
    accelerations: Vec<Acceleration>,
    /// Force of all walls on the fluid; N.
    force_on_fluid: Vec3,
    /// Power that blocks which are not free give to the fluid; W.
    power: f64,
}

/// Frame of a block's material.
#[derive(Clone, Copy, Debug)]
struct Frame {
    /// m.
    centroid: Vec3,
    gradient: Matrix3<f64>,
}

impl Frame {
    fn of(blocks: &Blocks, block: usize) -> Self {
        Self {
            centroid: blocks.centroid(block),
            gradient: blocks.gradient(block),
        }
    }

    fn place(&self, local: &Vec3) -> Vec3 {
        self.centroid + self.gradient * local
    }

    /// From the centroid to where a point acts; m.
    fn arm(&self, (local, buried): (&Vec<Vec3>, &Buried), point: usize) -> Vec3 {
        self.gradient * local[point] + buried.shift(point)
    }
}

impl ParticleWalls {
    /// Walls for the fluid at the current position of the blocks.
    pub fn new(
        definitions: &[BlockDefinition],
        blocks: &Blocks,
        fluid: &Fluid,
        slip: Slip,
    ) -> Self {
        let sampler = Sampler::new(fluid);
        let solids = Solids {
            definitions,
            blocks,
            sampler: &sampler,
        };
        let standing = solids.standing();
        let spacing = sampler.lattice.particle_spacing;
        let mut thin_solids = ThinSolids::new(
            &standing.inside,
            |part| sampler.seeming_ends(part),
            (spacing, sampler.lattice.support_radius),
        );
        let fixed_points = solids.fixed_points(&standing, &mut thin_solids);
        let points = solids.moving_points(&mut thin_solids);
        let mut fixed = fixed_points.walls(fluid, slip);
        fixed.place(|w| {
            let position = fixed_points.samples[w].position;
            [position, Vec3::zeros(), Vec3::zeros()]
        });
        let frames: Vec<Frame> = (0..definitions.len())
            .map(|b| Frame::of(blocks, b))
            .collect();
        // blocks are undeformed at the start
        let turned_back = |b: u32, x: &Vec3| {
            let frame = &frames[b as usize];
            frame.gradient.transpose() * (x - frame.centroid)
        };
        let axes = |b: u32, v: &Vec3| frames[b as usize].gradient.transpose() * v;
        let reach = sampler.lattice.support_radius;
        let placed = points.blocks.iter().zip(&points.samples);
        let mut walls = Self {
            above: FacesAbove::new(&points, (definitions, blocks), reach, axes),
            buried: Buried::new(&points, (definitions, blocks), (&standing.inside, &sampler)),
            fixed,
            fixed_block: fixed_points.blocks.into_boxed_slice(),
            moving: points.walls(fluid, slip),
            thin_solids,
            start: vec![[Vec3::zeros(); 2]; points.blocks.len()],
            local: placed.map(|(&b, s)| turned_back(b, &s.position)).collect(),
            block: points.blocks,
            frames,
            loads: vec![FluidLoad::default(); definitions.len()],
            drags: vec![FluidLoad::default(); definitions.len()],
            added: vec![AddedMass::default(); definitions.len()],
            accelerations: vec![Acceleration::default(); definitions.len()],
            force_on_fluid: Vec3::zeros(),
            power: 0.0,
        };
        walls.place_at_end(blocks, None);
        walls
    }

    /// Number of points.
    pub fn n_points(&self) -> usize {
        self.fixed.len() + self.moving.len()
    }

    /// Appends the state to a byte buffer.
    pub(crate) fn save(&self, out: Vec<u8>) -> Saved {
        let forces = (&self.loads, self.force_on_fluid, self.power);
        let buried = (&self.buried.cells, self.buried.is_any);
        let of_moving = (buried, self.moving.sorted_at());
        let out = postcard::to_extend(&(forces, &self.accelerations, of_moving), out)?;
        self.thin_solids.save(out)
    }

    /// Takes it over again.
    pub(crate) fn read<'a>(&mut self, bytes: &'a [u8]) -> Read<'a> {
        let lengths = (self.loads.len(), self.block.len());
        let (forces, buried, sorted_at, rest): (_, _, Vec<Vec3>, _);
        ((forces, self.accelerations, (buried, sorted_at)), rest) =
            postcard::take_from_bytes(bytes)?;
        (self.loads, self.force_on_fluid, self.power) = forces;
        (self.buried.cells, self.buried.is_any) = buried;
        self.fixed.forget();
        self.moving.sort_again(&sorted_at);
        if (self.loads.len(), self.buried.cells.len()) != lengths
            || self.accelerations.len() != lengths.0
        {
            return Err(postcard::Error::DeserializeBadEncoding);
        }
        self.thin_solids.read(rest)
    }

    /// Force and moment of the fluid on every block that moves; N, N m about the centroid.
    pub fn loads(&self) -> &[FluidLoad] {
        &self.loads
    }

    /// Force and moment of the fluid on a block that never moves; N, N m about the centroid. Each point of
    /// bodies that overlap belongs to the first of them.
    pub fn load_on_fixed(&self, fluid: &Fluid, blocks: &Blocks, block: usize) -> Load {
        let points: Vec<u32> = self
            .fixed
            .wet()
            .iter()
            .copied()
            .filter(|&w| self.fixed_block[w as usize] as usize == block)
            .collect();
        let mut load = Load::default();
        for (&w, [pressure, viscous]) in points.iter().zip(self.fixed.reactions(fluid, &points)) {
            let force = pressure + viscous;
            let arm = self.fixed.positions()[w as usize] - blocks.centroid(block);
            load.force += force;
            load.torque += arm.cross(&force);
        }
        load
    }

    /// Calls `visit` with the block, place (m) and forces of pressure and viscosity (N) of every wet fixed point.
    pub fn visit_fixed(&mut self, fluid: &Fluid, mut visit: impl FnMut(usize, &Vec3, [Vec3; 2])) {
        let block_of = &self.fixed_block;
        self.fixed.visit_reactions(fluid, |w, x, forces| {
            visit(block_of[w] as usize, x, forces);
        });
    }

    /// Force of all walls on the fluid; N.
    pub fn force_on_fluid(&self) -> Vec3 {
        self.force_on_fluid
    }

    /// Power that blocks which are not free give to the fluid; W.
    pub fn power(&self) -> f64 {
        self.power
    }

    /// Remembers where the moving points are: before the blocks move.
    pub fn record_start(&mut self, blocks: &Blocks) {
        self.thin_solids.record_start(blocks);
        self.find_frames(blocks);
        for ((start, &block), local) in self.start.iter_mut().zip(&self.block).zip(&self.local) {
            let x = self.frames[block as usize].place(local);
            *start = [x, blocks.velocity_at(block as usize, &x)];
        }
    }

    fn find_frames(&mut self, blocks: &Blocks) {
        for (b, frame) in self.frames.iter_mut().enumerate() {
            if !blocks.is_fixed(b) {
                *frame = Frame::of(blocks, b);
            }
        }
    }

    fn find_buried(&mut self, blocks: &Blocks) {
        let buried = &mut self.buried;
        buried.find(&self.block, &self.local, (&self.frames, blocks));
        if buried.is_any {
            self.moving.set_volumes(|w| buried.volume(w));
        }
    }

    /// Places the moving points at half of the step just taken by the blocks.
    pub fn place_half_way(&mut self, blocks: &Blocks, dt: f64) {
        if self.block.is_empty() {
            return;
        }
        self.find_frames(blocks);
        self.find_buried(blocks);
        let (start, block, local, frames) = (&self.start, &self.block, &self.local, &self.frames);
        let buried = &self.buried;
        self.moving.place(|w| {
            let end = frames[block[w] as usize].place(&local[w]);
            let from = start[w][0];
            let middle = (from + end) * 0.5 + buried.shift(w);
            [middle, (end - from) / dt, Vec3::zeros()]
        });
        self.thin_solids.place_half_way(blocks);
    }

    /// Places the moving points at the blocks, at rest without a step, where blocks are held. The
    /// wall's own acceleration is that of the step of `dt` (s) just taken; zero before the first.
    pub fn place_at_end(&mut self, blocks: &Blocks, dt: Option<f64>) {
        if self.block.is_empty() {
            return;
        }
        self.find_frames(blocks);
        self.find_buried(blocks);
        let (start, block, local, frames) = (&self.start, &self.block, &self.local, &self.frames);
        let buried = &self.buried;
        self.moving.place(|w| {
            let b = block[w] as usize;
            let x = frames[b].place(&local[w]);
            let place = x + buried.shift(w);
            let Some(dt) = dt else {
                return [place, Vec3::zeros(), Vec3::zeros()];
            };
            let v = blocks.velocity_at(b, &x);
            let a = if blocks.is_free(b) {
                // the rest follows from the very forces that are to be found
                let rate = blocks.velocity_gradient(b);
                rate * rate * (x - frames[b].centroid)
            } else if dt == 0.0 {
                Vec3::zeros()
            } else {
                (v - start[w][1]) / dt
            };
            [place, v, a]
        });
        self.thin_solids.place_at_end(blocks);
    }

    /// Finds which particles and points are near each other; after each sort of the fluid and placing.
    pub fn find(&mut self, fluid: &mut Fluid) {
        self.thin_solids.set_up(fluid);
        self.fixed.find_wet(fluid);
        self.moving.find_wet(fluid);
    }

    /// Adds the walls' part to the rates of density.
    pub fn add_rates(&mut self, fluid: &mut Fluid) {
        self.fixed.add_rates(fluid);
        self.moving.add_rates(fluid);
    }

    /// Adds the walls' part to the spread of the particles.
    pub fn add_concentrations(&mut self, fluid: &mut Fluid) {
        self.fixed.add_concentrations(fluid);
        self.moving.add_concentrations(fluid);
    }

    /// Adds the walls' part to the gradient of velocity.
    pub fn add_strains(&mut self, fluid: &mut Fluid) {
        self.fixed.add_strains(fluid);
        self.moving.add_strains(fluid);
    }

    /// Continues the fluid's pressure into the walls; where there are movers [`Self::solve_added_mass`] comes next.
    pub fn extrapolate(&mut self, fluid: &Fluid, movers: Option<Movers>) {
        self.fixed.extrapolate(fluid);
        match movers {
            Some(_) => self.moving.extrapolate_with_added_mass(fluid),
            None => self.moving.extrapolate(fluid),
        }
    }

    /// Continues the pressure into the walls of blocks that are free to move with the acceleration that the fluid gives
    /// them; once viscosities are known.
    pub fn solve_added_mass(&mut self, fluid: &Fluid, movers: Movers) {
        if !self.find_added_mass(movers.blocks) {
            return;
        }
        self.moving.stick(fluid);
        self.sum_loads(fluid, movers.blocks);
        let is_implicit = fluid.settings().scheme.viscous_step == ViscousStep::Implicit;
        for (b, load) in self.loads.iter().enumerate() {
            // shear at the present velocities may be many times that of an implicit viscous step
            let felt = match is_implicit {
                true => load.pressure,
                false => load.total(),
            };
            self.accelerations[b] = if movers.blocks.is_free(b) {
                movers.solve(b, &felt, &self.added[b])
            } else {
                Acceleration::default()
            };
        }
        self.follow(fluid);
    }

    /// Continues the pressure into points that take part in the accelerations of their blocks.
    fn follow(&mut self, fluid: &Fluid) {
        let (block, places) = (&self.block, (&self.local, &self.buried));
        let (frames, accelerations) = (&self.frames, &self.accelerations);
        self.moving.accelerate(fluid, |w| {
            let b = block[w] as usize;
            accelerations[b].at(&frames[b].arm(places, w))
        });
    }

    /// The acceleration of a block that its wall was given at last.
    #[cfg(test)]
    pub(super) fn acceleration(&self, block: usize) -> Acceleration {
        self.accelerations[block]
    }

    /// Loads under the same acceleration of all free blocks.
    #[cfg(test)]
    pub(super) fn accelerate_all(&mut self, fluid: &Fluid, blocks: &Blocks, all: &Acceleration) {
        self.accelerations.fill(*all);
        self.follow(fluid);
        self.sum_loads(fluid, blocks);
    }

    /// Finds the added mass of wet free blocks; returns whether there are any.
    fn find_added_mass(&mut self, blocks: &Blocks) -> bool {
        self.added.fill(AddedMass::default());
        let mut is_any = false;
        let (block, places, frames) = (&self.block, (&self.local, &self.buried), &self.frames);
        let added = &mut self.added;
        self.moving.visit_added_mass(
            |w| blocks.is_free(block[w] as usize),
            |w, answer| {
                is_any = true;
                let b = block[w] as usize;
                let arm = frames[b].arm(places, w);
                added[b].add_point(&arm, &answer.lever, &answer.slope);
            },
        );
        is_any
    }

    /// Largest ratio of the inertia that its wall adds to a block to its own mass.
    pub fn largest_added_mass_ratio(&self, blocks: &Blocks) -> f64 {
        largest_ratio(&self.added, blocks)
    }

    /// Adds the walls' forces to the accelerations, and sums the reactions on the moving blocks.
    pub fn add_forces(&mut self, fluid: &mut Fluid, blocks: &Blocks) {
        self.force_on_fluid = self.fixed.add_forces(fluid) + self.moving.add_forces(fluid);
        self.sum_loads(fluid, blocks);
    }

    /// Adds the walls' resistance to an implicit viscous step.
    pub fn add_resistance(&mut self, fluid: &mut Fluid) {
        self.fixed.add_resistance(fluid);
        self.moving.add_resistance(fluid);
    }

    /// Adds the reactions of an implicit viscous step to those on the moving blocks; returns what was added.
    pub fn add_drag(&mut self, fluid: &Fluid, blocks: &Blocks) -> &[FluidLoad] {
        self.drags.fill(FluidLoad::default());
        let mut on_walls = Vec3::zeros();
        self.fixed.visit_drag(fluid, |_, force| on_walls += force);
        let (drags, block, power) = (&mut self.drags, &self.block, &mut self.power);
        let (places, frames) = ((&self.local, &self.buried), &self.frames);
        self.moving.visit_drag(fluid, |w, force| {
            let b = block[w] as usize;
            let arm = frames[b].arm(places, w);
            drags[b].add(&Vec3::zeros(), force, &arm);
            if !blocks.is_free(b) {
                *power -= force.dot(&blocks.velocity_at(b, &(frames[b].centroid + arm)));
            }
            on_walls += force;
        });
        self.force_on_fluid -= on_walls;
        for (load, drag) in self.loads.iter_mut().zip(&self.drags) {
            load.add_load(drag);
        }
        &self.drags
    }

    fn sum_loads(&mut self, fluid: &Fluid, blocks: &Blocks) {
        self.loads.fill(FluidLoad::default());
        self.power = 0.0;
        let (loads, block, power) = (&mut self.loads, &self.block, &mut self.power);
        let (places, frames, above) = ((&self.local, &self.buried), &self.frames, &self.above);
        self.moving
            .visit_reactions(fluid, |w, _, [pressure, viscous]| {
                let b = block[w] as usize;
                let arm = frames[b].arm(places, w);
                loads[b].add(&pressure, &viscous, &arm);
                loads[b].stretch += above.more_stretch(w, &pressure, &frames[b].gradient);
                if !blocks.is_free(b) {
                    let x = frames[b].centroid + arm;
                    *power -= (pressure + viscous).dot(&blocks.velocity_at(b, &x));
                }
            });
    }
}
