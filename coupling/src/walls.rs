//! Walls based on the kernel support of the fluid particles: wall particles or exact integrals.
//!
//! Both extend the fluid's kernel sums into the solid: the wall's part of every sum over neighbors
//! is added to the fluid's own at the same stage of the step, and moving blocks receive the opposite
//! force.

pub mod added_mass;
mod cutting;
mod endless;
pub mod gap;
pub mod integral;
pub(crate) mod part_table;
pub mod particles;
pub mod penalty;
mod sampler;
mod thin_solids;

use nalgebra::Matrix3;
use riprap_dda::{BlockDefinition, Blocks, Load, Shape};
use riprap_sph::boundary::integral::Face;
use riprap_sph::boundary::wall_particles::Slip;
use riprap_sph::{Dimensions, Fluid, Vec3};
use serde::{Deserialize, Serialize};

use crate::saved::{Read, Saved};
use added_mass::Movers;
pub(crate) use cutting::clipped_by_symmetry;
use integral::IntegralWalls;
use particles::ParticleWalls;

/// Wall method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WallMethod {
    /// A spring and a dashpot between each particle and each surface.
    Penalty,
    /// Particles inside the solids.
    Particles,
    /// Exact integrals of the kernel over polyhedra.
    Integral,
}

/// The walls of all blocks.
#[derive(Clone, Debug)]
pub enum Walls {
    /// Particles inside the solids.
    Particles(ParticleWalls),
    /// Integrals of the kernel over the solids.
    Integral(IntegralWalls),
}

/// Calls a method of whichever walls there are.
macro_rules! of_walls {
    ($walls:expr, $name:ident => $call:expr) => {
        match $walls {
            Walls::Particles($name) => $call,
            Walls::Integral($name) => $call,
        }
    };
}

impl Walls {
    /// Walls at the current position of the blocks; `None` with penalty walls.
    pub fn new(
        method: WallMethod,
        definitions: &[BlockDefinition],
        blocks: &Blocks,
        fluid: &Fluid,
        slip: Slip,
    ) -> Option<Self> {
        match method {
            WallMethod::Penalty => None,
            WallMethod::Particles => Some(Self::Particles(ParticleWalls::new(
                definitions,
                blocks,
                fluid,
                slip,
            ))),
            WallMethod::Integral => Some(Self::Integral(IntegralWalls::new(
                definitions,
                blocks,
                fluid,
                slip,
            ))),
        }
    }

    /// Number of particles in walls.
    pub fn n_points(&self) -> usize {
        match self {
            Self::Particles(walls) => walls.n_points(),
            Self::Integral(_) => 0,
        }
    }

    /// Fluid loads on every moving block.
    pub fn loads(&self) -> &[FluidLoad] {
        of_walls!(self, walls => walls.loads())
    }

    /// Calls `visit` with the block, place (m) and forces of pressure and viscosity (N) of every point of a block that never
    /// moves, at the last evaluation; false if these are unknown, as in integrals, which treat all fixed solids as one body.
    pub fn visit_fixed(
        &mut self,
        fluid: &Fluid,
        visit: impl FnMut(usize, &Vec3, [Vec3; 2]),
    ) -> bool {
        match self {
            Self::Particles(walls) => {
                walls.visit_fixed(fluid, visit);
                true
            }
            Self::Integral(_) => false,
        }
    }

    /// Force and moment of the fluid on a fixed block; N, N m about the centroid. Integrals treat all
    /// fixed solids as one body: the load on a single one is unknown, NaN.
    pub fn load_on_fixed(&self, fluid: &Fluid, blocks: &Blocks, block: usize) -> Load {
        match self {
            Self::Particles(walls) => walls.load_on_fixed(fluid, blocks, block),
            Self::Integral(_) => Load {
                force: Vec3::repeat(f64::NAN),
                torque: Vec3::repeat(f64::NAN),
            },
        }
    }

    /// Force of all walls on the fluid; N.
    pub fn force_on_fluid(&self) -> Vec3 {
        of_walls!(self, walls => walls.force_on_fluid())
    }

    /// Power that blocks which are not free give to the fluid; W.
    pub fn power(&self) -> f64 {
        of_walls!(self, walls => walls.power())
    }

    /// Appends the state to a byte buffer.
    pub(crate) fn save(&self, out: Vec<u8>) -> Saved {
        of_walls!(self, walls => walls.save(out))
    }

    /// Takes it over again, for blocks and a fluid that were read before.
    pub(crate) fn read<'a>(
        &mut self,
        bytes: &'a [u8],
        fluid: &mut Fluid,
        blocks: &Blocks,
    ) -> Read<'a> {
        let rest = of_walls!(self, walls => walls.read(bytes))?;
        self.place_at_end(blocks, None);
        self.find(fluid);
        Ok(rest)
    }

    /// Remembers where the blocks are: before they move.
    pub fn record_start(&mut self, blocks: &Blocks) {
        of_walls!(self, walls => walls.record_start(blocks));
    }

    /// Places the walls at half of the step of `dt` (s) just taken by the blocks.
    pub fn place_half_way(&mut self, blocks: &Blocks, dt: f64) {
        of_walls!(self, walls => walls.place_half_way(blocks, dt));
    }

    /// Places the walls at the blocks, with their motion after a step of `dt` (s), 0 before the first;
    /// at rest without a step, where blocks are held. The wall's own acceleration is that of the step; for free blocks
    /// only the part due to their spin, as the rest is still unknown.
    pub fn place_at_end(&mut self, blocks: &Blocks, dt: Option<f64>) {
        of_walls!(self, walls => walls.place_at_end(blocks, dt));
    }

    /// Finds the walls near each particle, after each sort of the fluid and placement.
    pub fn find(&mut self, fluid: &mut Fluid) {
        of_walls!(self, walls => walls.find(fluid));
    }

    /// Adds the walls' part to the rates of density.
    pub fn add_rates(&mut self, fluid: &mut Fluid) {
        of_walls!(self, walls => walls.add_rates(fluid));
    }

    /// Adds the walls' part to the spread of the particles.
    pub fn add_concentrations(&mut self, fluid: &mut Fluid) {
        of_walls!(self, walls => walls.add_concentrations(fluid));
    }

    /// Adds the walls' part to the velocity gradient; zero for integrals.
    pub fn add_strains(&mut self, fluid: &mut Fluid) {
        if let Self::Particles(walls) = self {
            walls.add_strains(fluid);
        }
    }

    /// Continues the fluid's pressure into walls that carry one; where forces move blocks [`Self::solve_added_mass`] comes next.
    pub fn extrapolate(&mut self, fluid: &Fluid, movers: Option<Movers>) {
        if let Self::Particles(walls) = self {
            walls.extrapolate(fluid, movers);
        }
    }

    /// Solves the acceleration of the free blocks and updates the fluid pressure extrapolated into their walls, once
    /// viscosities are known.
    pub fn solve_added_mass(&mut self, fluid: &Fluid, movers: Movers) {
        match self {
            Self::Particles(walls) => walls.solve_added_mass(fluid, movers),
            Self::Integral(walls) => walls.accelerate(fluid, movers),
        }
    }

    /// Largest ratio of the inertia that walls add to a block, by the kernel, to the block's own mass.
    pub fn largest_added_mass_ratio(&self, blocks: &Blocks) -> f64 {
        of_walls!(self, walls => walls.largest_added_mass_ratio(blocks))
    }

    /// Adds the walls' resistance to an implicit viscous step; integrals have none.
    pub fn add_resistance(&mut self, fluid: &mut Fluid) {
        if let Self::Particles(walls) = self {
            walls.add_resistance(fluid);
        }
    }

    /// Adds the reactions of an implicit viscous step to those on the moving blocks; returns what was added.
    pub fn add_drag(&mut self, fluid: &Fluid, blocks: &Blocks) -> &[FluidLoad] {
        match self {
            Self::Particles(walls) => walls.add_drag(fluid, blocks),
            Self::Integral(_) => &[],
        }
    }

    /// Adds the walls' forces to the accelerations, and sums the reactions on the moving blocks.
    pub fn add_forces(&mut self, fluid: &mut Fluid, blocks: &Blocks) {
        of_walls!(self, walls => walls.add_forces(fluid, blocks));
    }
}

#[cfg(test)]
impl Walls {
    fn acceleration(&self, block: usize) -> added_mass::Acceleration {
        of_walls!(self, walls => walls.acceleration(block))
    }
}

/// Fluid load on a block, moments about the centroid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FluidLoad {
    /// Of pressure; N, N m.
    pub pressure: Load,
    /// Of viscosity; N, N m.
    pub shear: Load,
    /// Straining part of the moment, `Σ (f ⊗ r + r ⊗ f)/2`; N m.
    pub stretch: Matrix3<f64>,
}

impl FluidLoad {
    /// Adds forces of pressure and viscosity (N) at a point, given from the centroid (m).
    pub fn add(&mut self, pressure: &Vec3, viscous: &Vec3, arm: &Vec3) {
        self.pressure.add(pressure, arm);
        self.shear.add(viscous, arm);
        let moment = (pressure + viscous) * arm.transpose();
        self.stretch += (moment + moment.transpose()) * 0.5;
    }

    /// Adds another.
    pub fn add_load(&mut self, other: &Self) {
        self.pressure += other.pressure;
        self.shear += other.shear;
        self.stretch += other.stretch;
    }

    /// All of it as force and moment; N, N m.
    pub fn total(&self) -> Load {
        let mut total = self.pressure;
        total += self.shear;
        total
    }
}

/// Spacing of points on faces (m), and the position of the plane of a 2-D flow, along y (m).
pub(crate) fn face_lattice(fluid: &Fluid) -> (f64, Option<f64>) {
    let settings = fluid.settings();
    let (min, max) = settings.domain;
    let middle = match settings.dimensions {
        Dimensions::Two { .. } => Some(0.5 * (min.y + max.y)),
        Dimensions::Three => None,
    };
    (settings.mean_spacing(), middle)
}

/// A convex part: outward normal and corners of each face, counter-clockwise seen from outside; m.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Part {
    faces: Vec<(Vec3, Vec<Vec3>)>,
}

impl Part {
    pub(crate) fn faces(&self) -> Vec<Face<'_>> {
        self.faces
            .iter()
            .map(|(normal, corners)| Face {
                normal: *normal,
                vertices: corners,
            })
            .collect()
    }

    /// With its normals and corners mapped, by a motion.
    fn mapped(&self, turn: impl Fn(&Vec3) -> Vec3, place: impl Fn(&Vec3) -> Vec3) -> Self {
        let faces = self.faces.iter().map(|(normal, corners)| {
            let corners = corners.iter().map(&place).collect();
            (turn(normal), corners)
        });
        Self {
            faces: faces.collect(),
        }
    }

    fn corners(&self) -> impl Iterator<Item = &Vec3> {
        self.faces.iter().flat_map(|(_, corners)| corners)
    }

    /// The box round it; m.
    fn aabb(&self) -> (Vec3, Vec3) {
        let none = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        self.corners()
            .fold(none, |(min, max), x| (min.inf(x), max.sup(x)))
    }

    /// Whether it may be within a distance (m) of a point.
    fn may_be_within(&self, x: &Vec3, distance: f64) -> bool {
        self.nearest_plane(x)
            .is_some_and(|(_, height)| height < distance)
    }

    /// The face whose plane a point is farthest outside of, with that distance (m): below zero inside.
    pub(crate) fn nearest_plane(&self, x: &Vec3) -> Option<(Vec3, f64)> {
        self.faces
            .iter()
            .filter_map(|(normal, corners)| Some((*normal, normal.dot(&(x - corners.first()?)))))
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The convex parts of a shape.
pub(crate) fn parts(shape: &Shape) -> Vec<Part> {
    match shape {
        Shape::Polyhedra(polyhedra) => polyhedra
            .iter()
            .map(|p| Part {
                faces: (0..p.n_faces())
                    .map(|face| {
                        let corners = p.face_vertices(face).map(|v| p.vertices()[v as usize]);
                        (p.face_normal(face), corners.collect())
                    })
                    .collect(),
            })
            .collect(),
        // spheres and surfaces of triangles have their own wall particles; the scene rejects them for other wall methods
        Shape::Sphere { .. } | Shape::Surface(_) => Vec::new(),
    }
}
