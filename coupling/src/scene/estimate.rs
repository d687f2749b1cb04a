//! Memory required by a run.
//!
//! The estimate uses the checked scene alone, before its world is built. The numbers are measured peaks of short runs
//! (see `tests/coupling/hostile.rs`), each rounded up, so that the sum is an upper bound.
//! The report that follows a run, when most of this is free again, is not in it.

use riprap_dda::{Motion, Polyhedron, Shape};
use riprap_sph::{Dimensions, Vec3, ViscousStep};

use crate::messages::Code;
pub use crate::scene::access::{Available, available};
use crate::scene::error::Problem;
use crate::scene::resolved::{FluidScene, Scene};
use crate::walls::WallMethod;

/// Bytes of the program by itself; with water. The system chooses how much of the program's file (33 MB with the C
/// library's) is resident, 14 to 17 MB where this was measured, so all of it counts; the rest is 4 and 6 MB of its own.
const PROGRAM: [f64; 2] = [37e6, 39e6];
/// Bytes per particle of water, without its list of neighbors: state, packed points and sums, last good state, a frame under way.
pub const PER_PARTICLE: f64 = 650.0;
/// Additional bytes per particle where water may sleep: reference positions, state of sleep, partial sums of rates.
const PER_SLEEPING_PARTICLE: f64 = 110.0;
/// Additional bytes per particle with implicit viscous steps: unknowns, sums, packed points.
const PER_VISCOUS_PARTICLE: f64 = 210.0;
/// Bytes per neighbor in a list, with unused capacity and the end of the last register.
const PER_NEIGHBOR: f64 = 2.25;
/// Bytes per particle of a wall, near water or not, with the lists of both sides.
const PER_WALL_PARTICLE: f64 = 190.0;
/// Smallest number of bytes per block.
pub const PER_BLOCK: f64 = 3000.0;
/// Additional bytes per moving block: contacts, and rows of output.
const PER_MOVING_BLOCK: f64 = 10e3;
/// Bytes per corner of a polyhedron: scene, solver, output.
const PER_CORNER: f64 = 5600.0;
/// Bytes per sphere, which is written as a fine mesh.
const PER_SPHERE: f64 = 17e3;
/// Number of spheres with additional bytes, and those bytes.
const FIRST_SPHERES: (f64, f64) = (500.0, 36e3);
/// Bytes per triangle of a surface.
const PER_TRIANGLE: f64 = 900.0;

/// Memory required by a run; bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Program by itself.
    pub program: f64,
    /// Particles of water, with their lists of neighbors.
    pub water: f64,
    /// Particles of walls.
    pub walls: f64,
    /// Blocks, surfaces and contacts.
    pub blocks: f64,
}

impl Estimate {
    /// Estimate for a resolved scene.
    pub fn of(scene: &Scene) -> Self {
        let program = PROGRAM[usize::from(scene.fluid.is_some())];
        let blocks = blocks(scene);
        match &scene.fluid {
            None => Self {
                program,
                water: 0.0,
                walls: 0.0,
                blocks,
            },
            Some(fluid) => Self {
                program,
                water: water(fluid),
                walls: PER_WALL_PARTICLE * wall_particles(scene, fluid),
                blocks,
            },
        }
    }

    /// Total; bytes.
    pub fn total(&self) -> f64 {
        self.program + self.water + self.walls + self.blocks
    }

    /// Problem if a run does not fit the available memory.
    pub fn refusal(&self, available: Option<Available>) -> Option<Problem> {
        let available = available?.bytes as f64;
        if self.total() <= available {
            return None;
        }
        let (path, remedy) = if self.blocks <= self.water + self.walls {
            ("fluid.resolution", "coarsen `fluid.resolution`")
        } else {
            ("blocks", "take fewer or simpler blocks")
        };
        Some(Problem::error(
            Code::NotEnoughMemory,
            path,
            format!(
                "the run needs {}; the machine has {:.3} GB: {remedy}",
                self,
                available / 1e9
            ),
        ))
    }
}

impl std::fmt::Display for Estimate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let megabytes = |bytes: f64| (bytes / 1e6).ceil();
        write!(f, "up to {:.0} MB", megabytes(self.total()))?;
        let parts = [
            ("water", self.water),
            ("walls", self.walls),
            ("blocks", self.blocks),
        ];
        let mut before = ": ";
        for (what, bytes) in parts.into_iter().filter(|(_, bytes)| *bytes > 0.0) {
            write!(f, "{before}{what} {:.0}", megabytes(bytes))?;
            before = ", ";
        }
        Ok(())
    }
}

fn water(fluid: &FluidScene) -> f64 {
    let settings = &fluid.settings;
    let reach = settings.support_radius() + settings.widest_skin();
    let [dx, dy, dz] = settings.particle_spacing;
    let neighbors = match settings.dimensions {
        Dimensions::Three => 4.0 / 3.0 * std::f64::consts::PI * reach.powi(3) / (dx * dy * dz),
        Dimensions::Two { .. } => std::f64::consts::PI * reach.powi(2) / (dx * dz),
    };
    // what holds the surface while water is packed against its walls is given back before the run
    let particles = (fluid.lattice.positions.len() + fluid.lattice.mould.len()) as f64;
    let sleeping = fluid.sleeping.map_or(0.0, |_| PER_SLEEPING_PARTICLE);
    let viscous = match settings.scheme.viscous_step {
        ViscousStep::Implicit => PER_VISCOUS_PARTICLE,
        ViscousStep::Explicit => 0.0,
    };
    particles * (PER_PARTICLE + sleeping + viscous + PER_NEIGHBOR * neighbors)
}

/// Upper bound of the number of wall particles: those of a solid are within the support of the domain, and not deeper
/// in it than the support.
///
/// ```text
/// n = min(V, A R)/s³
/// ```
fn wall_particles(scene: &Scene, fluid: &FluidScene) -> f64 {
    if fluid.wall_method != WallMethod::Particles {
        return 0.0;
    }
    let settings = &fluid.settings;
    let support = settings.support_radius();
    let (mut min, mut max) = settings.domain;
    (min, max) = (min.add_scalar(-support), max.add_scalar(support));
    let spacing = fluid.walls.particle_spacing;
    let is_plane = matches!(settings.dimensions, Dimensions::Two { .. });
    if is_plane {
        // one row across
        let middle = 0.5 * (min.y + max.y);
        (min.y, max.y) = (middle - 0.5 * spacing, middle + 0.5 * spacing);
    }
    let layer = |(low, high): (Vec3, Vec3), (volume, area): (f64, f64)| {
        let extent = (high.inf(&max) - low.sup(&min)).map(|length| length.max(0.0));
        let (x, y, z) = (extent.x, extent.y, extent.z);
        // a convex body has less surface than one around it
        let (across, around) = (x * z, (x + z) * y);
        let area = if is_plane {
            2.0 * around
        } else {
            area.min(2.0 * (across + around))
        };
        // a row more where a wall begins
        volume.min(extent.product()).min(area * (support + spacing))
    };
    let of_shape = |shape: &Shape| match shape {
        Shape::Polyhedra(parts) => {
            let of_part = |part: &Polyhedron| {
                layer(part.aabb(), (riprap_dda::volume(part), surface_area(part)))
            };
            parts.iter().map(of_part).sum()
        }
        Shape::Sphere { radius, .. } => layer(
            shape.aabb(),
            (shape.volume(), 4.0 * std::f64::consts::PI * radius * radius),
        ),
        Shape::Surface(surface) => {
            let corner = |v: u32| surface.vertices()[v as usize];
            let triangles = surface.triangles().iter();
            let near = triangles.filter_map(|&[a, b, c]| {
                let (a, b, c) = (corner(a), corner(b), corner(c));
                let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
                let meets = (0..3).all(|k| low[k] <= max[k] && min[k] <= high[k]);
                meets.then(|| 0.5 * (b - a).cross(&(c - a)).norm())
            });
            near.sum::<f64>() * (support + spacing)
        }
    };
    let volume: f64 = scene
        .blocks
        .iter()
        .map(|block| of_shape(&block.shape))
        .sum();
    volume / spacing.powi(3)
}

/// Surface area of a body; m².
fn surface_area(body: &Polyhedron) -> f64 {
    (0..body.n_faces())
        .map(|face| riprap_dda::face_area(body, face))
        .sum()
}

fn blocks(scene: &Scene) -> f64 {
    let of_shape = |shape: &Shape| match shape {
        Shape::Polyhedra(parts) => {
            let corners: usize = parts.iter().map(|part| part.vertices().len()).sum();
            PER_CORNER * corners as f64
        }
        Shape::Sphere { .. } => PER_SPHERE,
        Shape::Surface(surface) => PER_TRIANGLE * surface.triangles().len() as f64,
    };
    let is_sphere = |shape: &Shape| matches!(shape, Shape::Sphere { .. });
    let spheres = (scene.blocks.iter()).filter(|block| is_sphere(&block.shape));
    let (first, each) = FIRST_SPHERES;
    let all: f64 = scene
        .blocks
        .iter()
        .map(|block| {
            let moving = match block.motion {
                Motion::Fixed => 0.0,
                Motion::Free | Motion::Prescribed(_) => PER_MOVING_BLOCK,
            };
            PER_BLOCK + moving + of_shape(&block.shape)
        })
        .sum();
    all + (spheres.count() as f64).min(first) * each
}
