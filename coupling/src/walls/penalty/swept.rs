//! Paths of particles in a step: what passes through a solid, or goes into an opening too narrow for it, stops there.
//!
//! A particle is seen again at the end of a step only. In it, it may have passed a plate thinner than its displacement, and in
//! a crack it is outside of all solids, where nothing that acts on particles inside holds it. But it stands for a spacing
//! of water: where the distances to two solids that face each other add up to less than half of one it has no room.
//!
//! ```text
//! x(s) = x₁ − (1 − s) (v_a − v_wall) dt     path relative to a solid, 0 ≤ s ≤ 1; x₁ at the end of the step
//! d_i + d_j < dp/2,   n_i·n_j < −0.9        no room at x, outside of all solids
//! ```
//! It stops at the first such `s`, 10⁻³ dp in front. Paths that begin behind a surface go on: what holds particles inside
//! solids holds them. What begins without room was closed in by moving blocks: it only goes no deeper where the opening widens,
//! and on where its sides are parallel.

use std::collections::BTreeSet;

use rayon::prelude::*;
use riprap_dda::Blocks;
use riprap_sph::{Fluid, Vec3};

use super::{ACROSS, BEHIND, CHUNK, FACING, Interface, Penetration, WallContact};

/// Width of an opening, in spacings, that is closed to a particle, and thickness of a solid that no particle may be inside of.
const ROOM: f64 = 0.5;
/// Clearance at which a particle stops, in spacings.
const CLEARANCE: f64 = 1e-3;
/// Distance between the points of a path at which room is looked for, in spacings.
const STRIDE: f64 = 0.04;
/// Halvings of the part of a path on which room ends.
const HALVINGS: u32 = 40;
/// Cosine between the normals of the surfaces where a path enters and leaves, above which it only cuts an edge.
const OPPOSED: f64 = -0.1;
/// Length of the mean of two normals below which it has no direction.
const NO_DIRECTION: f64 = 0.05;

/// Motion of a step.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// s.
    pub dt: f64,
    /// Whether blocks are held in place.
    pub are_held: bool,
}

/// A step with what moves in it.
struct Sweep<'a> {
    walls: &'a Interface,
    fluid: &'a Fluid,
    blocks: &'a Blocks,
    motion: Motion,
}

/// Place where a path ends early.
#[derive(Clone, Copy, Debug)]
struct Halt {
    /// Share of the path.
    share: f64,
    block: u32,
    normal: Vec3,
    /// Foot point on the surface; m.
    point: Vec3,
    /// m.
    clear: Vec3,
}

/// Surface nearest to a point.
#[derive(Clone, Copy, Debug)]
struct Side {
    part: usize,
    distance: f64,
    normal: Vec3,
    point: Vec3,
}

impl Interface {
    /// Particles that the step just made took through a solid or into an opening too narrow for them, each with the place on
    /// its path where it stops; in order of particle. The touches must be found.
    pub fn stops_on_the_way(
        &self,
        fluid: &Fluid,
        blocks: &Blocks,
        motion: Motion,
    ) -> Vec<Penetration> {
        if motion.dt <= 0.0 {
            return Vec::new();
        }
        let sweep = Sweep {
            walls: self,
            fluid,
            blocks,
            motion,
        };
        let n_chunks = fluid.particles().len().div_ceil(CHUNK);
        let of_chunks: Vec<Vec<Penetration>> = (0..n_chunks)
            .into_par_iter()
            .map(|chunk| sweep.of_chunk(chunk))
            .collect();
        of_chunks.concat()
    }
}

impl Sweep<'_> {
    fn of_chunk(&self, chunk: usize) -> Vec<Penetration> {
        let velocity = &self.fluid.particles().velocity;
        let particles = chunk * CHUNK..velocity.len().min((chunk + 1) * CHUNK);
        let touches = &self.walls.touches;
        let [first, end] = [particles.start, particles.end]
            .map(|a| touches.partition_point(|touch| (touch.particle as usize) < a));
        let touches = &touches[first..end];
        let standoff = self.walls.settings.standoff;
        let mut found = Vec::new();
        for of_one in touches.chunk_by(|a, b| a.particle == b.particle) {
            if of_one.iter().any(|touch| self.may_reach(touch)) {
                found.extend(self.stop(of_one[0].particle as usize));
            }
        }
        // faster ones may be past a wall by more than the standoff
        if self.fluid.drift_speed() * self.motion.dt <= standoff {
            return found;
        }
        let is_fast = |&a: &usize| standoff < velocity[a].norm() * self.motion.dt;
        for a in particles.filter(is_fast) {
            if touches
                .binary_search_by_key(&(a as u32), |t| t.particle)
                .is_err()
            {
                found.extend(self.stop(a));
            }
        }
        found.sort_by_key(|stop| stop.particle);
        found
    }

    /// Whether a surface or an opening beside it may be on the path of the particle at it.
    fn may_reach(&self, touch: &WallContact) -> bool {
        let velocity = self.fluid.particles().velocity[touch.particle as usize];
        let wall = self.wall_velocity(touch.block as usize, &touch.point);
        let length = (velocity - wall).norm() * self.motion.dt;
        touch.distance < length + 0.5 * ROOM * self.walls.settings.particle_spacing
    }

    fn wall_velocity(&self, block: usize, point: &Vec3) -> Vec3 {
        match self.motion.are_held {
            true => Vec3::zeros(),
            false => self.blocks.velocity_at(block, point),
        }
    }

    /// Start of a particle's path relative to a block; m.
    fn start(&self, a: usize, block: usize) -> Vec3 {
        let particles = self.fluid.particles();
        let x = particles.position[a];
        x - (particles.velocity[a] - self.wall_velocity(block, &x)) * self.motion.dt
    }

    fn stop(&self, a: usize) -> Option<Penetration> {
        let particles = self.fluid.particles();
        let (x, v) = (particles.position[a], particles.velocity[a]);
        let grid = self.fluid.grid();
        let from = grid.wrapped(x - v * self.motion.dt);
        // in order, each once
        let parts: BTreeSet<usize> = (self
            .walls
            .near(&x, grid)
            .chain(self.walls.near(&from, grid)))
        .collect();
        let at_solid = self.first_passage(a, &parts);
        let at_opening = self.first_narrow_place(a, &parts);
        let halt = [at_solid, at_opening]
            .into_iter()
            .flatten()
            .reduce(|one, other| match other.share < one.share {
                true => other,
                false => one,
            })?;
        Some(Penetration {
            particle: a as u32,
            block: halt.block,
            normal: halt.normal,
            point: halt.point,
            clear: halt.clear,
            is_deep: true,
        })
    }

    /// The first solid that the path passes through, or ends in if it is thin.
    fn first_passage(&self, a: usize, parts: &BTreeSet<usize>) -> Option<Halt> {
        let dp = self.walls.settings.particle_spacing;
        let x = self.fluid.particles().position[a];
        let mut first: Option<Halt> = None;
        for &part in parts {
            let block = self.blocks.block_of_part(part);
            let from = self.start(a, block);
            let Some(passage) = self.blocks.passage(part, &from, &x) else {
                continue;
            };
            let is_through = match passage.exit {
                Some(exit) => exit.dot(&passage.normal) < OPPOSED,
                None => self.blocks.part_thickness(part) < ROOM * dp,
            };
            if !is_through || first.is_some_and(|first| first.share <= passage.share) {
                continue;
            }
            let point = from + (x - from) * passage.share;
            let clear = point + passage.normal * (CLEARANCE * dp);
            // inside of another solid it is not the surface of this one that counts
            if parts.iter().all(|&other| !self.is_inside(other, &clear)) {
                first = Some(Halt {
                    share: passage.share,
                    block: block as u32,
                    normal: passage.normal,
                    point,
                    clear,
                });
            }
        }
        first
    }

    fn is_inside(&self, part: usize, x: &Vec3) -> bool {
        let reach = match self.blocks.is_surface(part) {
            true => BEHIND * self.walls.settings.particle_spacing,
            false => 0.0,
        };
        let surface = self.blocks.surface_point_within(part, x, reach);
        surface.is_some_and(|surface| surface.distance < 0.0)
    }

    /// The first place on the path where there is no room. Springs keep particles out of
    /// openings themselves.
    fn first_narrow_place(&self, a: usize, parts: &BTreeSet<usize>) -> Option<Halt> {
        if parts.len() < 2 || 0.0 < self.walls.settings.stiffness {
            return None;
        }
        let dp = self.walls.settings.particle_spacing;
        let x = self.fluid.particles().position[a];
        let nearest = self.nearest(&x, parts)?;
        let from = self.start(a, self.blocks.block_of_part(nearest));
        let path = x - from;
        let pieces = (path.norm() / (STRIDE * dp)).ceil().max(1.0);
        let at = |share: f64| from + path * share;
        let halt = |share: f64, sides: &[Side; 2], normal: Vec3| Halt {
            share,
            block: self.blocks.block_of_part(sides[0].part) as u32,
            normal,
            point: sides[0].point,
            clear: at(share) + normal * (CLEARANCE * dp),
        };
        if let Some(sides) = self.without_room(&from, parts) {
            let outward = outward(&sides).filter(|normal| path.dot(normal) < 0.0)?;
            return Some(halt(0.0, &sides, outward));
        }
        let share = |k: u32| f64::from(k) / pieces;
        let (k, mut sides) = (1..=pieces as u32)
            .find_map(|k| Some((k, self.without_room(&at(share(k)), parts)?)))?;
        let (mut before, mut after) = (share(k - 1), share(k));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (before + after);
            match self.without_room(&at(middle), parts) {
                Some(found) => (after, sides) = (middle, found),
                None => before = middle,
            }
        }
        // between parallel surfaces only the path tells where it came from
        let normal = outward(&sides).or_else(|| (-path).try_normalize(0.0))?;
        Some(halt(before, &sides, normal))
    }

    /// The part nearest to a point; m.
    fn nearest(&self, x: &Vec3, parts: &BTreeSet<usize>) -> Option<usize> {
        let distance = |&part: &usize| {
            let surface = self.blocks.surface_point_within(part, x, f64::INFINITY)?;
            Some((part, surface.distance))
        };
        let all = parts.iter().filter_map(distance);
        all.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(part, _)| part)
    }

    /// The two surfaces between which a point outside of all solids has no room, the nearer one first.
    fn without_room(&self, x: &Vec3, parts: &BTreeSet<usize>) -> Option<[Side; 2]> {
        let room = ROOM * self.walls.settings.particle_spacing;
        let mut sides: Vec<Side> = Vec::new();
        for &part in parts {
            let Some(surface) = self.blocks.surface_point_within(part, x, room) else {
                continue;
            };
            if surface.distance < 0.0 {
                return None;
            }
            // a slice is cut from prisms without ends
            if !(self.walls.is_plane && 0.5 < surface.normal[ACROSS].abs()) {
                sides.push(Side {
                    part,
                    distance: surface.distance,
                    normal: surface.normal,
                    point: surface.point,
                });
            }
        }
        let mut narrowest: Option<(f64, [Side; 2])> = None;
        for (k, one) in sides.iter().enumerate() {
            for other in &sides[..k] {
                let width = one.distance + other.distance;
                if room <= width
                    || FACING <= one.normal.dot(&other.normal)
                    || narrowest.is_some_and(|(least, _)| least <= width)
                {
                    continue;
                }
                let pair = match one.distance < other.distance {
                    true => [*one, *other],
                    false => [*other, *one],
                };
                narrowest = Some((width, pair));
            }
        }
        narrowest.map(|(_, pair)| pair)
    }
}

/// The way out of an opening between two surfaces that do not run parallel.
fn outward(sides: &[Side; 2]) -> Option<Vec3> {
    let mean = 0.5 * (sides[0].normal + sides[1].normal);
    mean.try_normalize(NO_DIRECTION)
}
