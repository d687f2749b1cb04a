//! Forces between particles and the surfaces of blocks: the published penalty wall.
//!
//! ```text
//! d = max(0, dp/2 − s),   v_n = (v_a − v_wall)·n
//! F = max(0, K_S d − K_D v_n) n            on the particle; −F on the block at the foot point
//! ```
//! `s` is the distance to the surface and `n` its outward normal. Source: Geraili Mikola & Sitar
//! (2014), Eq. 22, with the wall's own velocity, clamped so that a wall never pulls, and with one
//! force per body instead of one per face, so that edges push no harder than faces. The spring
//! starts half a spacing off the surface, where the first row of a lattice stands; the paper leaves
//! this open.
//!
//! In a periodic slab and in the slice of a 2-D flow a block is a piece of an endless prism:
//! the fluid moves it in the plane of the slab only. Transverse loads are taken by the slab and booked as such.

pub(crate) mod swept;

use nalgebra::{Matrix2, Matrix3, Vector2};
use rayon::prelude::*;
use riprap_dda::{Blocks, Load, SurfacePoint};
use riprap_sph::fluid::ParticleForce;
use riprap_sph::{CellGrid, Dimensions, Fluid, Vec3, pieces_at_once};
use serde::{Deserialize, Serialize};

use crate::saved::{Read, Saved};
use crate::walls::FluidLoad;
use crate::walls::part_table::{PartTable, Placed, Solids};

/// Particles per parallel task; a constant, so that results do not depend on threads.
const CHUNK: usize = 1024;
/// Distance off the surface, in spacings, at which the spring starts: where the first row of a lattice is.
pub const STANDOFF: f64 = 0.5;
/// Damping ratio from which `K_D` follows when it is not given.
pub const DAMPING_RATIO: f64 = 0.5;
/// Axis across a 2-D flow.
const ACROSS: usize = 1;
/// Depth inside a solid, in spacings, beyond which a particle is pushed back.
const PUSH_BACK_DEPTH: f64 = 0.1;
/// Clearance, in spacings, of the position to which it is pushed back from any other solid, if there is such a position.
const LEAST_ROOM: f64 = 0.25;
/// Cosine between the normals of two surfaces below which they face each other.
const FACING: f64 = -0.9;
/// Cosine between the normals of an exit and of a surface near it above which that one does not face the exit.
const ALONG: f64 = -0.5;
/// Distance from the surface, in spacings, to which it is pushed back.
const PUSH_BACK_DISTANCE: f64 = 0.05;
/// Depth, in spacings, to which particles behind a surface of triangles are looked for.
const BEHIND: f64 = 2.0;

/// Numbers of the penalty wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSettings {
    /// `K_S`; N/m.
    pub stiffness: f64,
    /// `K_D`; N s/m.
    pub damping: f64,
    /// Particle spacing `dp`; m.
    pub particle_spacing: f64,
    /// Distance at which the spring starts; m.
    pub standoff: f64,
}

/// A particle within the standoff of a body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WallContact {
    /// Index of the particle in the present order.
    pub particle: u32,
    /// Block that is touched.
    pub block: u32,
    /// Distance to the surface, below zero inside; m.
    pub distance: f64,
    /// Outward unit normal of the surface.
    pub normal: Vec3,
    /// Foot point on the surface; m.
    pub point: Vec3,
}

/// Action of a body on a particle at it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpringForce {
    /// Index of the particle in the present order.
    pub particle: u32,
    /// Block that acts.
    pub block: u32,
    /// Force on the particle; N.
    pub force: Vec3,
    /// Velocity of the wall at the foot point; m/s.
    pub wall_velocity: Vec3,
    /// Energy that the dashpot takes, and the clamp with it; W.
    pub dissipated_power: f64,
}

/// A particle that was found at the surface of a solid, or behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// Index of the particle.
    pub particle: u32,
    /// Block it is in.
    pub block: u32,
    /// Outward unit normal of the surface.
    pub normal: Vec3,
    /// Foot point on the surface; m.
    pub point: Vec3,
    /// Position just off the surface there; m.
    pub clear: Vec3,
    /// Whether it is deeper inside than walls can be trusted to hold.
    pub is_deep: bool,
}

/// Penalty walls of all blocks, with the search for their particles.
#[derive(Clone, Debug)]
pub struct Interface {
    settings: WallSettings,
    /// Whether the flow is two-dimensional.
    is_plane: bool,
    /// The one periodic direction of a slab, or that across the plane of a flow.
    slab_axis: Option<usize>,
    /// Parts of blocks that never move, near each cell.
    fixed: PartTable,
    /// Blocks that water flows through, grains whose forces are averages, ascending.
    passed: Vec<usize>,
    /// Sort of the fluid at which particles near them were found, and whether each may come within their standoff before the
    /// next one.
    near_since: Option<u64>,
    is_near_fixed: Vec<bool>,
    /// Parts of blocks that may move, near each cell at present.
    moving: PartTable,
    /// Touches of the chunks of a part; scratch.
    chunks: Vec<Vec<WallContact>>,
    /// In order of particle.
    touches: Vec<WallContact>,
    /// In the same order.
    forces: Vec<SpringForce>,
    loads: Vec<Load>,
    /// Shear part of the loads.
    shears: Vec<Load>,
    /// Straining parts of the moments on blocks.
    stretches: Vec<Matrix3<f64>>,
    /// Compliance of each block summed over its touches; 1/kg.
    compliance: Vec<f64>,
    /// Most bodies that one particle touches, at least one.
    most_touched: f64,
}

impl Interface {
    /// Walls for the blocks at their current positions, but for those that water flows through (ascending).
    pub fn new(
        settings: WallSettings,
        (blocks, passed): (&Blocks, &[usize]),
        fluid: &Fluid,
    ) -> Self {
        let grid = fluid.grid();
        let mut fixed = PartTable::default();
        // particles move on from where they were sorted, on one side and on the other
        let reach = settings.standoff + 2.0 * fluid.farthest_from_sort();
        update(
            &mut fixed,
            blocks.fixed_parts().filter(solid(blocks, passed)),
            (blocks, grid),
            (&settings, reach),
        );
        let periodic = grid.periodic();
        let n_periodic = periodic.iter().filter(|&&p| p).count();
        let is_plane = matches!(fluid.settings().dimensions, Dimensions::Two { .. });
        Self {
            settings,
            is_plane,
            slab_axis: if is_plane {
                Some(ACROSS)
            } else {
                (0..3).find(|&axis| n_periodic == 1 && periodic[axis])
            },
            fixed,
            passed: passed.to_vec(),
            near_since: None,
            is_near_fixed: Vec::new(),
            moving: PartTable::default(),
            chunks: Vec::new(),
            touches: Vec::new(),
            forces: Vec::new(),
            loads: vec![Load::default(); blocks.n_blocks()],
            shears: vec![Load::default(); blocks.n_blocks()],
            stretches: vec![Matrix3::zeros(); blocks.n_blocks()],
            compliance: vec![0.0; blocks.n_blocks()],
            most_touched: 1.0,
        }
    }

    /// Appends the state to a byte buffer.
    pub(crate) fn save(&self, out: Vec<u8>) -> Saved {
        // without forces, what is touched is found anew before anything reads it
        let touches = match self.acts() {
            true => self.touches.as_slice(),
            false => &[],
        };
        let forces = (touches, &self.forces, &self.compliance, self.most_touched);
        let loads = (&self.loads, &self.shears, &self.stretches);
        postcard::to_extend(&(forces, loads), out)
    }

    /// Takes it over again.
    pub(crate) fn read<'a>(&mut self, bytes: &'a [u8]) -> Read<'a> {
        let n = self.loads.len();
        let (forces, loads, rest);
        ((forces, loads), rest) = postcard::take_from_bytes(bytes)?;
        (
            self.touches,
            self.forces,
            self.compliance,
            self.most_touched,
        ) = forces;
        (self.loads, self.shears, self.stretches) = loads;
        let lengths = [
            self.compliance.len(),
            self.loads.len(),
            self.shears.len(),
            self.stretches.len(),
        ];
        let mut named = self.touches.iter().map(|touch| touch.block);
        let mut acting = self.forces.iter().map(|force| force.block);
        let is_known = |block: u32| (block as usize) < n;
        let are_known = named.all(is_known) && acting.all(is_known);
        match lengths.iter().all(|&length| length == n) && are_known {
            true => Ok(rest),
            false => Err(postcard::Error::DeserializeBadEncoding),
        }
    }

    /// Whether there are springs or dashpots.
    fn acts(&self) -> bool {
        0.0 < self.settings.stiffness || 0.0 < self.settings.damping
    }

    /// Numbers of the wall.
    pub fn settings(&self) -> &WallSettings {
        &self.settings
    }

    /// The part of a load that moves a block: in a slab, the in-plane part.
    pub fn in_plane(&self, mut load: Load) -> Load {
        if let Some(axis) = self.slab_axis {
            load.force[axis] = 0.0;
            let turning = load.torque[axis];
            load.torque = Vec3::zeros();
            load.torque[axis] = turning;
        }
        load
    }

    /// Particles within the standoff of a body.
    pub fn touches(&self) -> &[WallContact] {
        &self.touches
    }

    /// Forces on them since [`Self::update_forces`]; empty without springs and dashpots.
    pub fn forces(&self) -> &[SpringForce] {
        &self.forces
    }

    /// Force and moment of the fluid on every block; N, N m about the centroid.
    pub fn loads(&self) -> &[Load] {
        &self.loads
    }

    /// Viscous part of these loads; N, N m about the centroid.
    pub fn shears(&self) -> &[Load] {
        &self.shears
    }

    /// Straining part of the fluid's moment on every block, `Σ (f ⊗ r + r ⊗ f)/2`; N m.
    pub fn stretches(&self) -> &[Matrix3<f64>] {
        &self.stretches
    }

    /// The one direction in which a slab repeats.
    pub fn slab_axis(&self) -> Option<usize> {
        self.slab_axis
    }

    /// Whether a surface with this normal closes a plane flow at its sides.
    pub fn is_across_plane(&self, normal: &Vec3) -> bool {
        self.is_plane && 0.5 < normal[ACROSS].abs()
    }

    /// Finds the particles near bodies; the fluid must be sorted.
    pub fn find(&mut self, fluid: &Fluid, blocks: &Blocks) {
        update(
            &mut self.moving,
            blocks.movable_parts().filter(solid(blocks, &self.passed)),
            (blocks, fluid.grid()),
            (&self.settings, self.settings.standoff),
        );
        self.find_near_fixed(fluid, blocks);
        let positions = &fluid.particles().position;
        let (settings, fixed, moving) = (&self.settings, &self.fixed, &self.moving);
        let is_near_fixed = &self.is_near_fixed;
        self.touches.clear();
        let n_at_once = pieces_at_once();
        self.chunks.resize_with(n_at_once, Vec::new);
        for (part, positions) in positions.chunks(n_at_once * CHUNK).enumerate() {
            let chunks = positions.par_chunks(CHUNK).enumerate();
            self.chunks
                .par_iter_mut()
                .zip(chunks)
                .for_each(|(touches, (chunk, positions))| {
                    touches.clear();
                    let first = (part * n_at_once + chunk) * CHUNK;
                    // sleeping particles approach nothing
                    if fluid.is_still(first..first + positions.len()) {
                        return;
                    }
                    for (a, x) in (first..).zip(positions) {
                        let cell = fluid.grid().cell_of(x);
                        let first = touches.len();
                        let fixed = match is_near_fixed[a] {
                            true => fixed.near(cell),
                            false => &[],
                        };
                        for &part in fixed.iter().chain(moving.near(cell)) {
                            add_nearest(
                                touches,
                                first,
                                (a as u32, x),
                                (part as usize, blocks),
                                settings,
                            );
                        }
                    }
                });
            let n_chunks = positions.len().div_ceil(CHUNK);
            for chunk in &self.chunks[..n_chunks] {
                self.touches.extend_from_slice(chunk);
            }
        }
    }

    /// Finds the particles that may come within the standoff of a fixed part before the fluid is sorted again, once for each
    /// sort.
    fn find_near_fixed(&mut self, fluid: &Fluid, blocks: &Blocks) {
        let positions = &fluid.particles().position;
        let is_known = self.near_since == Some(fluid.sorts());
        if is_known && self.is_near_fixed.len() == positions.len() {
            return;
        }
        self.near_since = Some(fluid.sorts());
        self.is_near_fixed.resize(positions.len(), false);
        let (settings, fixed) = (&self.settings, &self.fixed);
        let way = fluid.farthest_from_sort() + fluid.moved();
        self.is_near_fixed
            .par_iter_mut()
            .zip(positions.par_iter())
            .with_min_len(CHUNK)
            .for_each(|(is_near, x)| {
                let parts = fixed.near(fluid.grid().cell_of(x));
                *is_near = parts.iter().any(|&part| {
                    let part = part as usize;
                    let reach = settings.reach(part, blocks) + way;
                    let surface = blocks.surface_point_within(part, x, reach);
                    surface.is_some_and(|surface| surface.distance <= settings.standoff + way)
                });
            });
    }

    /// Particles at or behind a surface where no spring holds them, those deeper inside than walls can be trusted to
    /// hold, springs or not, and those that springs hold between two solids with no room between them: in the seam of a
    /// floor and a wall they would not come back. One that is inside several solids is there once if it is deep.
    pub fn penetrations(&self, fluid: &Fluid, blocks: &Blocks) -> Vec<Penetration> {
        let dp = self.settings.particle_spacing;
        let has_springs = 0.0 < self.settings.stiffness;
        let mut found: Vec<Penetration> = Vec::new();
        for (k, touch) in self.touches.iter().enumerate() {
            let is_deep = touch.distance < -PUSH_BACK_DEPTH * dp;
            let is_known = found
                .last()
                .is_some_and(|last| last.particle == touch.particle && last.is_deep);
            if is_known {
                continue;
            }
            let a = touch.particle as usize;
            let (position, velocity) =
                (fluid.particles().position[a], fluid.particles().velocity[a]);
            let is_in_seam = has_springs && !is_deep && self.is_in_seam(&self.touches[k..]);
            let way = if is_deep || (!has_springs && touch.distance < 0.0) {
                // the face nearest to it may be one that two solids share
                Some(self.way_out((&position, &velocity), (fluid.grid(), blocks), touch))
            } else if is_in_seam {
                let near = self.near(&position, fluid.grid());
                self.way_out_of_a_corner(&position, near, blocks, touch)
            } else {
                None
            };
            let Some((block, way)) = way else {
                continue;
            };
            found.push(Penetration {
                particle: touch.particle,
                block,
                normal: way.normal,
                point: way.point,
                clear: way.point + way.normal * (PUSH_BACK_DISTANCE * dp),
                is_deep: is_deep || is_in_seam,
            });
        }
        found
    }

    /// Does the particle of the first touch lie between it and another, with no room between the two?
    fn is_in_seam(&self, touches: &[WallContact]) -> bool {
        let room = PUSH_BACK_DISTANCE * self.settings.particle_spacing;
        let Some((first, others)) = touches.split_first() else {
            return false;
        };
        others
            .iter()
            .take_while(|other| other.particle == first.particle)
            .any(|other| {
                other.distance + first.distance < room && other.normal.dot(&first.normal) < FACING
            })
    }

    /// Parts near a point.
    fn near<'a>(&'a self, x: &Vec3, grid: &CellGrid) -> impl Iterator<Item = usize> + use<'a> {
        let cell = grid.cell_of(x);
        let parts = self.fixed.near(cell).iter().chain(self.moving.near(cell));
        parts.map(|&part| part as usize)
    }

    /// The shortest exit from all solids straight through a face, with its block; that of the touch if there
    /// is none.
    fn way_out(
        &self,
        (x, velocity): (&Vec3, &Vec3),
        (grid, blocks): (&CellGrid, &Blocks),
        touch: &WallContact,
    ) -> (u32, SurfacePoint) {
        let near = |x: &Vec3| self.near(x, grid);
        let clearance = PUSH_BACK_DISTANCE * self.settings.particle_spacing;
        let stands_clear = |way: &SurfacePoint, by: f64| {
            // past a side that repeats it comes in again at the other
            let to = grid.wrapped(way.point + way.normal * clearance);
            !near(&to).any(|part| {
                let surface = blocks.surface_point_within(part, &to, by);
                // solids below the exit face do not obstruct it, even across a crack
                let lies_below = || {
                    let planes = blocks.planes_within(part, &to, by);
                    let is_level =
                        |(n, height): &(Vec3, f64)| 0.9 < n.dot(&way.normal) && 0.0 <= *height;
                    planes.iter().any(is_level)
                };
                // one that stands across leaves the room beside it: else the exit would be the far side of a plate
                let stands_across = |surface: &SurfacePoint| {
                    clearance <= surface.distance && ALONG < surface.normal.dot(&way.normal)
                };
                surface.is_some_and(|s| s.distance < by && !stands_across(&s)) && !lies_below()
            })
        };
        // a slice is cut from prisms without ends: nothing leaves a plane flow across it
        let leads_out = |way: &SurfacePoint| !self.is_across_plane(&way.normal);
        let mut ways: Vec<(u32, SurfacePoint)> = near(x)
            .flat_map(|part| {
                let block = blocks.block_of_part(part) as u32;
                let ways = blocks.ways_out(part, x).into_iter().filter(leads_out);
                ways.map(move |way| (block, way))
            })
            .collect();
        ways.sort_by(|a, b| b.1.distance.total_cmp(&a.1.distance));
        // a crack too narrow for a particle is not an exit while there is another
        let room = LEAST_ROOM * self.settings.particle_spacing;
        // and a particle passing through a plate is returned to its side
        let came_in = |(block, way): &&(u32, SurfacePoint)| {
            let wall = blocks.velocity_at(*block as usize, &way.point);
            (velocity - wall).dot(&way.normal) <= 0.0
        };
        // but not far: a particle squeezed between two solids would be moved behind one of them
        let near_by = self.settings.particle_spacing;
        let roomy =
            |(_, way): &&(u32, SurfacePoint)| -way.distance < near_by && stands_clear(way, room);
        let short =
            |(_, way): &&(u32, SurfacePoint)| -way.distance < near_by && stands_clear(way, 0.0);
        let free = (ways.iter().filter(came_in).find(roomy))
            .or_else(|| ways.iter().find(roomy))
            .or_else(|| ways.iter().find(short))
            .copied()
            .or_else(|| self.way_out_of_a_corner(x, near(x), blocks, touch))
            .or_else(|| ways.into_iter().find(|(_, way)| stands_clear(way, 0.0)));
        free.unwrap_or((
            touch.block,
            SurfacePoint {
                distance: touch.distance,
                normal: touch.normal,
                point: touch.point,
            },
        ))
    }

    /// The shortest exit from all solids along the edge or to the corner in which they meet, for the case that the straight exit
    /// through a face of one ends in another. `None` if not within a spacing.
    fn way_out_of_a_corner(
        &self,
        x: &Vec3,
        near: impl Iterator<Item = usize>,
        blocks: &Blocks,
        touch: &WallContact,
    ) -> Option<(u32, SurfacePoint)> {
        let dp = self.settings.particle_spacing;
        let clearance = PUSH_BACK_DISTANCE * dp;
        let parts: Vec<usize> = near.collect();
        let planes: Vec<(Vec3, f64)> = parts
            .iter()
            .flat_map(|&part| blocks.planes_within(part, x, dp))
            .filter(|(normal, _)| !self.is_across_plane(normal))
            .collect();
        let stands_clear = |to: &Vec3| {
            !parts.iter().any(|&part| {
                let surface = blocks.surface_point_within(part, to, dp);
                surface.is_some_and(|surface| surface.distance < 0.5 * clearance)
            })
        };
        let mut shortest: Option<Vec3> = None;
        let mut offer = |way: Option<Vec3>| {
            let Some(way) = way else { return };
            let limit = shortest.map_or(dp, |other| other.norm());
            if way.norm() < limit && stands_clear(&(x + way)) {
                shortest = Some(way);
            }
        };
        for (k, &(n, n_height)) in planes.iter().enumerate() {
            for (l, &(m, m_height)) in planes[..k].iter().enumerate() {
                // to where both heights are the clearance
                let rise = Vector2::new(clearance - n_height, clearance - m_height);
                let cos = n.dot(&m);
                let shares = Matrix2::new(1.0, cos, cos, 1.0).try_inverse();
                offer(
                    shares
                        .map(|inverse| inverse * rise)
                        .map(|s| n * s.x + m * s.y),
                );
                for &(o, o_height) in &planes[..l] {
                    let normals = Matrix3::from_columns(&[n, m, o]).transpose();
                    let rise = Vec3::new(rise.x, rise.y, clearance - o_height);
                    offer(normals.try_inverse().map(|inverse| inverse * rise));
                }
            }
        }
        let way = shortest?;
        let normal = way.try_normalize(0.0)?;
        let surface = SurfacePoint {
            distance: clearance - way.norm(),
            normal,
            point: x + way - normal * clearance,
        };
        Some((touch.block, surface))
    }

    /// Forces of the touching pairs and their sums on the blocks.
    ///
    /// `held` stands for walls at rest whatever the blocks' velocities: settling.
    pub fn update_forces(&mut self, fluid: &Fluid, blocks: &Blocks, held: bool) {
        let WallSettings {
            stiffness, damping, ..
        } = self.settings;
        let standoff = self.settings.standoff;
        self.loads.fill(Load::default());
        self.shears.fill(Load::default());
        self.stretches.fill(Matrix3::zeros());
        self.compliance.fill(0.0);
        let of_one = self.touches.chunk_by(|a, b| a.particle == b.particle);
        self.most_touched = of_one.map(<[WallContact]>::len).max().unwrap_or(1) as f64;
        self.forces.clear();
        let acts = self.acts();
        for touch in &self.touches {
            let block = touch.block as usize;
            self.compliance[block] += blocks.compliance(block, &touch.point, &touch.normal);
            if !acts {
                continue;
            }
            let wall_velocity = match held {
                true => Vec3::zeros(),
                false => blocks.velocity_at(block, &touch.point),
            };
            let velocity = fluid.particles().velocity[touch.particle as usize];
            let approach = (velocity - wall_velocity).dot(&touch.normal);
            let spring = stiffness * (standoff - touch.distance);
            let size = (spring - damping * approach).max(0.0);
            let force = touch.normal * size;
            self.forces.push(SpringForce {
                particle: touch.particle,
                block: touch.block,
                force,
                wall_velocity,
                // the spring stores −K d v_n; the rest of the power of the force is dissipated
                dissipated_power: (spring - size) * approach,
            });
            let arm = touch.point - blocks.centroid(block);
            self.loads[block].add(&-force, &arm);
            let moment = force * arm.transpose();
            self.stretches[block] -= (moment + moment.transpose()) * 0.5;
        }
        for block in 0..self.loads.len() {
            self.loads[block] = self.in_plane(self.loads[block]);
            self.hold_across(block);
        }
    }

    /// Adds the fluid loads on blocks by another wall method.
    pub fn add_loads(&mut self, loads: &[FluidLoad]) {
        for (block, load) in loads.iter().enumerate() {
            let (pressure, shear) = (self.in_plane(load.pressure), self.in_plane(load.shear));
            self.loads[block] += pressure;
            self.loads[block] += shear;
            self.shears[block] += shear;
            self.stretches[block] += load.stretch;
            self.hold_across(block);
        }
    }

    /// Adds pressures on blocks that are not of the fluid's particles; N, N m.
    pub fn add_pressures(&mut self, loads: &[Load]) {
        for (block, load) in loads.iter().enumerate() {
            let felt = self.in_plane(*load);
            self.loads[block] += felt;
        }
    }

    /// Adds a force of the fluid on a block, with the part of it that is drag; N.
    pub fn add_force(&mut self, block: usize, force: Vec3, drag: Vec3) {
        let load = |force: Vec3| Load {
            force,
            ..Load::default()
        };
        let (all, shear) = (self.in_plane(load(force)), self.in_plane(load(drag)));
        self.loads[block] += all;
        self.shears[block] += shear;
    }

    /// A slab does not let a block strain across its plane.
    fn hold_across(&mut self, block: usize) {
        if let Some(axis) = self.slab_axis {
            self.stretches[block].row_mut(axis).fill(0.0);
            self.stretches[block].column_mut(axis).fill(0.0);
        }
    }

    /// The forces on particles, in order of particle.
    pub fn particle_forces(&self) -> impl Iterator<Item = ParticleForce> {
        self.forces.iter().map(|on| ParticleForce {
            particle: on.particle,
            force: on.force,
        })
    }

    /// Energy in the penalty springs; J.
    pub fn elastic_energy(&self) -> f64 {
        let standoff = self.settings.standoff;
        let squares: f64 = self
            .touches
            .iter()
            .map(|touch| (standoff - touch.distance).powi(2))
            .sum();
        0.5 * self.settings.stiffness * squares
    }

    /// Largest step that the penalty springs allow; s.
    ///
    /// ```text
    /// ω² = K_S (k/m + Σ w),   dt ≤ 0.8 (2/ω) (√(1 + ξ²) − ξ),   ξ = k K_D/(2 √(k K_S m))
    /// ```
    /// `Σ w` sums the compliances of a body over its touching particles, `k` is the largest number of bodies touched by a particle:
    /// a bound for equal springs along one direction, for the body with the most touching particles per mass, and
    /// exact for `k = 1`. A predictor-corrector
    /// allows the same: `ξ ω dt ≤ 1` and `ω² dt² ≤ 4 (1 − ξ ω dt + ξ² ω² dt²)`.
    pub fn critical_time_step(&self, particle_mass: f64) -> f64 {
        let WallSettings {
            stiffness, damping, ..
        } = self.settings;
        if stiffness == 0.0 {
            return f64::INFINITY;
        }
        let largest = self.compliance.iter().copied().fold(0.0, f64::max);
        let omega = (stiffness * (self.most_touched / particle_mass + largest)).sqrt();
        let ratio = damping * (self.most_touched / (stiffness * particle_mass)).sqrt() / 2.0;
        0.8 * 2.0 / omega * ((1.0 + ratio * ratio).sqrt() - ratio)
    }
}

impl WallSettings {
    /// Search distance of particles from the surface of a part; m.
    fn reach(&self, part: usize, blocks: &Blocks) -> f64 {
        if blocks.is_surface(part) {
            self.standoff.max(BEHIND * self.particle_spacing)
        } else {
            self.standoff
        }
    }
}

/// Parts of blocks, with the search distance beyond their standoff.
struct Reaching<'a> {
    blocks: &'a Blocks,
    settings: &'a WallSettings,
}

impl Solids for Reaching<'_> {
    fn aabb(&self, part: u32) -> (Vec3, Vec3) {
        let (min, max) = self.blocks.part_aabb(part as usize);
        let more = self.settings.reach(part as usize, self.blocks) - self.settings.standoff;
        (min.add_scalar(-more), max.add_scalar(more))
    }

    fn is_within(&self, part: u32, x: &Vec3, distance: f64) -> bool {
        let part = part as usize;
        let more = self.settings.reach(part, self.blocks) - self.settings.standoff;
        let surface = self.blocks.surface_point_within(part, x, distance + more);
        surface.is_some()
    }
}

/// Brings up to date which parts of blocks are near each cell.
/// Whether a part is of a block that water does not flow through.
fn solid<'a>(blocks: &'a Blocks, passed: &'a [usize]) -> impl Fn(&usize) -> bool + 'a {
    |&part| passed.binary_search(&blocks.block_of_part(part)).is_err()
}

fn update(
    table: &mut PartTable,
    parts: impl Iterator<Item = usize>,
    (blocks, grid): (&Blocks, &CellGrid),
    (settings, reach): (&WallSettings, f64),
) {
    let placed = parts.map(|part| {
        let block = blocks.block_of_part(part);
        Placed {
            number: part as u32,
            center: blocks.centroid(block),
            gradient: blocks.gradient(block),
        }
    });
    let parts = Reaching { blocks, settings };
    table.update(placed, &parts, grid, reach);
}

/// Adds the touch of a particle and a part, or replaces that of another part of the same block if
/// this one is nearer: one force per body.
fn add_nearest(
    touches: &mut Vec<WallContact>,
    first: usize,
    (particle, position): (u32, &Vec3),
    (part, blocks): (usize, &Blocks),
    settings: &WallSettings,
) {
    let reach = settings.reach(part, blocks);
    let surface = blocks.surface_point_within(part, position, reach);
    let Some(surface) = surface.filter(|surface| surface.distance <= settings.standoff) else {
        return;
    };
    let block = blocks.block_of_part(part) as u32;
    let touch = WallContact {
        particle,
        block,
        distance: surface.distance,
        normal: surface.normal,
        point: surface.point,
    };
    match touches[first..]
        .iter_mut()
        .find(|other| other.block == block)
    {
        None => touches.push(touch),
        Some(other) if surface.distance < other.distance => *other = touch,
        Some(_) => {}
    }
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;
    use crate::run::world_of;

    /// At the toe of a slope on a floor two spacings thick the way through either face ends in the other solid, and the
    /// next one leads out below the floor.
    #[test]
    fn out_of_a_corner_between_solids_the_way_is_up() {
        let text = "(title: \"toe\", domain: (min: (0, 0, -0.2), max: (2, 1, 1)),
            materials: [(name: \"m\", density: 2000, friction_angle_deg: 30)],
            blocks: [(name: \"floor\", material: \"m\", motion: Fixed,
                      shape: Box(min: (0, 0, -0.1), max: (2, 1, 0))),
                     (name: \"side\", material: \"m\", motion: Fixed,
                      shape: Box(min: (0, -0.1, -0.1), max: (2, 0, 1))),
                     (name: \"slope\", material: \"m\", motion: Fixed,
                      shape: Extrusion(polygon: [(0.8, 0), (2, 0), (2, 0.84)], axis: Y, from: 0, to: 1))],
            fluid: (resolution: Spacing(0.05),
                    regions: [(name: \"water\", shape: Box(min: (0, 0, 0), max: (0.4, 0.4, 0.4)))]),
            time: (duration: 1))";
        let world = world_of(text);
        let water = world.water.as_ref().unwrap();
        let clearance = PUSH_BACK_DISTANCE * 0.05;
        for y in [0.5, 0.001] {
            let x = Vec3::new(0.806, y, -0.002);
            let touch = WallContact {
                particle: 0,
                block: 0,
                distance: -0.002,
                normal: Vec3::z(),
                point: Vec3::new(0.806, y, 0.0),
            };
            let at = (&x, &Vec3::zeros());
            let (_, way) =
                (water.interface).way_out(at, (water.fluid.grid(), &world.blocks), &touch);
            let to = way.point + way.normal * clearance;
            for part in 0..world.blocks.n_parts() {
                let surface = world.blocks.surface_point_within(part, &to, 1.0).unwrap();
                assert!(0.5 * clearance <= surface.distance, "{to:?} {surface:?}");
            }
            // the toe's edge is no farther than this
            assert!((to - x).norm() < 0.2 * 0.05, "{to:?}");
        }
    }
}
