//! Initial water: particles on a lattice, in boxes and in basins.

mod amounts;
mod basin;
mod boxes;
mod columns;
mod count;
mod drawn;
mod gaps;
mod obstacles;
mod overlap;
mod regions;

use riprap_dda::{Shape, Vec3};
use riprap_sph::Dimensions;

use super::error::Problem;
use super::file::vec3;
use super::file::{Axis, DimensionsFile, DomainFile, FluidFile, LatticeFile, ResolutionFile};
use crate::messages::Code;
pub use amounts::{Amount, misfits};
pub(super) use drawn::depth_at;
pub use gaps::{PASSABLE, gaps, narrow_gaps};
use obstacles::WALL_SLACK;
pub use overlap::{overlaps, overlaps_on};
use regions::at_spacing;

/// Largest number of lattice nodes that are visited.
const MOST_NODES: f64 = 5e7;
/// Bytes per visited node: its state and the queue of nodes.
const NODE_BYTES: f64 = 8.0;

/// Initial particles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lattice {
    /// Spacings along x, y, z, whose product is the volume of a particle; a periodic direction holds a whole number of
    /// spacings, and so does one that ends at a plane of symmetry; m.
    pub spacing: [f64; 3],
    /// Position of each particle; m.
    pub positions: Vec<Vec3>,
    /// Velocity of each particle; m/s.
    pub velocities: Vec<Vec3>,
    /// Number of the region of each particle.
    pub region: Vec<u32>,
    /// Packing against walls, for each region.
    pub is_packed: Vec<bool>,
    /// Volume of each region.
    pub amounts: Vec<Amount>,
    /// Particles above the levels, which hold the surfaces of packed regions in place; m.
    pub mould: Vec<Vec3>,
    /// Highest surface of any region; m.
    pub still_water_level: f64,
    /// Depth from there to the bottom of the lowest particle; m.
    pub depth: f64,
}

impl Lattice {
    /// Volume of a particle; m³.
    pub fn particle_volume(&self) -> f64 {
        self.spacing.iter().product()
    }

    /// Spacing of a cubic or square lattice of the same volume; m.
    pub fn particle_spacing(&self, dimensions: Dimensions) -> f64 {
        match dimensions {
            Dimensions::Three => self.particle_volume().cbrt(),
            Dimensions::Two { .. } => (self.spacing[0] * self.spacing[2]).sqrt(),
        }
    }
}

/// Way of filling.
#[derive(Clone, Copy)]
struct Pouring {
    /// Rows of the mould above the level of packed regions.
    n_mould_rows: usize,
    room: Room,
    /// Whether volumes are measured and matched; those of trials are not.
    is_measured: bool,
}

/// Amount of water that fits the memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// Available memory, infinite where the system does not tell; bytes.
    pub bytes: f64,
    /// Smallest memory per particle of a run; bytes.
    pub bytes_per_particle: f64,
}

impl Room {
    /// No bounds.
    pub const ENDLESS: Self = Self {
        bytes: f64::INFINITY,
        bytes_per_particle: 0.0,
    };

    /// Checks that a number of particles fits, before there are any.
    fn holds(&self, particles: f64) -> Result<(), FillError> {
        let needed = particles * self.bytes_per_particle;
        if needed <= self.bytes {
            return Ok(());
        }
        Err(FillError::NoMemory {
            particles,
            needed: needed / 1e9,
            available: self.bytes / 1e9,
        })
    }

    /// Largest number of nodes that may be visited.
    fn nodes(&self) -> f64 {
        MOST_NODES.min(self.bytes / NODE_BYTES)
    }

    /// Checks a number of nodes to be visited; NaN is refused.
    fn look_at(&self, nodes: f64) -> Result<(), FillError> {
        let most = self.nodes();
        if nodes <= most {
            Ok(())
        } else {
            Err(FillError::TooManyNodes { nodes, most })
        }
    }
}

/// Reason for a region without water.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
enum FillError {
    #[error(
        "needs {nodes:.1e} lattice nodes, more than {most:.1e}; coarsen `fluid.resolution` or shrink the domain"
    )]
    TooManyNodes { nodes: f64, most: f64 },
    #[error(
        "makes {particles:.3e} particles or more, which need at least {needed:.3} GB of memory; the machine has \
         {available:.3} GB: coarsen `fluid.resolution`"
    )]
    NoMemory {
        particles: f64,
        needed: f64,
        available: f64,
    },
    #[error(
        "overlaps block `{block}` by {depth:.3} m; shrink the box, or use Below(level, seed), which fills \
         round blocks"
    )]
    InBlock { block: String, depth: f64 },
    #[error(
        "is too thin: no particle fits in {thickness} m along {axis}; let fluid.resolution be Spacing({thickness}) or \
         finer, or enlarge the region"
    )]
    TooThin { axis: char, thickness: f64 },
    #[error("has its level, {level} m, above the domain, which ends at {top} m; raise domain.max")]
    LevelAboveDomain { level: f64, top: f64 },
    #[error(
        "is too shallow: no row of particles fits between the bottom of the domain at {bottom} m and the level"
    )]
    NoRow { bottom: f64 },
    #[error("has its seed {seed:?} m above the level or out of the domain")]
    SeedOutside { seed: [f64; 3] },
    #[error("has its seed {seed:?} m inside block `{block}`; move it into the water")]
    SeedInBlock { seed: [f64; 3], block: String },
    #[error(
        "has no room for a particle at the seed {seed:?} m: block `{block}` is nearer than half a spacing; move the \
         seed or refine `fluid.resolution`"
    )]
    SeedTooNarrow { seed: [f64; 3], block: String },
    #[error(
        "leaks out of the domain at ({:.3}, {:.3}, {:.3}) m; blocks must close the basin below its level",
        .at.x, .at.y, .at.z
    )]
    Leak { at: Vec3 },
    #[error(
        "overlaps fluid region `{other}` at ({:.3}, {:.3}, {:.3}) m; let regions adjoin or leave one out",
        .at.x, .at.y, .at.z
    )]
    InRegion { other: String, at: Vec3 },
}

impl FillError {
    fn code(&self) -> Code {
        match self {
            Self::TooManyNodes { .. } | Self::NoMemory { .. } => Code::NotEnoughMemory,
            Self::InBlock { .. } | Self::InRegion { .. } => Code::OverlappingRegion,
            Self::TooThin { .. } | Self::NoRow { .. } => Code::NoParticleFits,
            Self::LevelAboveDomain { .. } => Code::OutsideDomain,
            Self::SeedOutside { .. } | Self::SeedInBlock { .. } | Self::SeedTooNarrow { .. } => {
                Code::SeedMisplaced
            }
            Self::Leak { .. } => Code::LeakingBasin,
        }
    }
}

/// Initial water among the given solids. Regions in basins are to be packed against the walls, with a mould of
/// `n_mould_rows` rows above each level; without rows they are left as they are.
///
/// # Errors
///
/// All [`Problem`]s: overlaps, leaks, a count that cannot be met.
pub fn lattice(
    fluid: &FluidFile,
    domain: &DomainFile,
    solids: &[(String, Shape)],
    n_mould_rows: usize,
) -> Result<Lattice, Vec<Problem>> {
    lattice_within(fluid, domain, solids, n_mould_rows, Room::ENDLESS)
}

/// Initial water as [`lattice`], limited by the memory: more particles are refused before they are made.
///
/// # Errors
///
/// As [`lattice`].
pub fn lattice_within(
    fluid: &FluidFile,
    domain: &DomainFile,
    solids: &[(String, Shape)],
    n_mould_rows: usize,
    room: Room,
) -> Result<Lattice, Vec<Problem>> {
    let at = |spacing, is_measured| {
        let pouring = Pouring {
            n_mould_rows,
            room,
            is_measured,
        };
        at_spacing(fluid, domain, solids, pouring, spacing)
    };
    match fluid.resolution {
        ResolutionFile::Spacing(wanted) => at(wanted, true),
        ResolutionFile::Count(wanted) => {
            let spacing = count::spacing(fluid, domain, (wanted, room), |s| at(s, false))?;
            at(spacing, true)
        }
    }
}

/// Spacings along x, y, z over that of a cubic lattice of the same volume. A staggered lattice is face-centered cubic,
/// with square layers; in a plane it is hexagonal.
pub(super) fn proportions(lattice: LatticeFile, dimensions: DimensionsFile) -> [f64; 3] {
    match (lattice, dimensions) {
        (LatticeFile::Cubic, _) => [1.0; 3],
        (LatticeFile::Staggered, DimensionsFile::Two) => {
            let side = (4.0_f64 / 3.0).powf(0.25);
            [side, 1.0, 1.0 / side]
        }
        (LatticeFile::Staggered, DimensionsFile::Three) => {
            let side = 2.0_f64.powf(1.0 / 6.0);
            [side, side, side / 2.0_f64.sqrt()]
        }
    }
}

/// Spacings along x, y, z: in a periodic direction the nearest that divides the period, in one that ends at a plane
/// of symmetry the nearest that ends half a spacing from it; a flow in a plane has one row across.
fn spacings(fluid: &FluidFile, domain: &DomainFile, wanted: f64) -> [f64; 3] {
    let extent = vec3(domain.max) - vec3(domain.min);
    let mut spacing = proportions(fluid.lattice, domain.dimensions).map(|share| share * wanted);
    let periodic = domain.periodic.iter().map(|axis: &Axis| axis.index());
    let mirrored = domain.symmetry.iter().map(|side| side.axis());
    // rows are counted from the lower side
    let mirrored = mirrored.filter_map(|(axis, is_upper)| is_upper.then_some(axis));
    for axis in periodic.chain(mirrored) {
        spacing[axis] = extent[axis] / (extent[axis] / spacing[axis]).round().max(1.0);
    }
    if domain.dimensions == DimensionsFile::Two {
        spacing[1] = extent.y;
    }
    spacing
}

/// Rows that fit an extent, with a tolerance for the rounding of typed digits.
fn rows(extent: f64, spacing: f64) -> f64 {
    (extent / spacing + WALL_SLACK).floor().max(0.0)
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test may stop where a library may not"
)]
mod tests {
    use super::*;
    use crate::scene::file::{OutOfDomainFile, RegionFile, RegionShapeFile};
    use riprap_dda::Polyhedron;

    fn domain(periodic: Vec<Axis>) -> DomainFile {
        DomainFile {
            min: (0.0, 0.0, -0.5),
            max: (4.0, 0.4, 2.0),
            periodic,
            symmetry: Vec::new(),
            leaving: OutOfDomainFile::Remove,
            dimensions: DimensionsFile::Three,
        }
    }

    fn fluid(shape: RegionShapeFile, resolution: ResolutionFile) -> FluidFile {
        FluidFile {
            density: 1000.0,
            dynamic_viscosity: Some(1.0),
            lattice: LatticeFile::Cubic,
            rheology: None,
            resolution,
            grains: crate::scene::file::GrainExchangeFile::default(),
            regions: vec![RegionFile {
                name: "lake".into(),
                shape,
                velocity: (0.0, 0.0, 0.0),
                flow: None,
                rheology: None,
            }],
        }
    }

    fn cuboid(name: &str, min: [f64; 3], max: [f64; 3]) -> (String, Shape) {
        let solid = Polyhedron::cuboid(Vec3::from(min), Vec3::from(max)).unwrap();
        (name.into(), Shape::Polyhedra(vec![solid]))
    }

    /// A trough from x = 0.5 to 3.5 with its floor at z = 0, open to y.
    fn trough() -> Vec<(String, Shape)> {
        vec![
            cuboid("floor", [-1.0, -1.0, -1.0], [5.0, 1.4, 0.0]),
            cuboid("left", [-1.0, -1.0, -1.0], [0.5, 1.4, 3.0]),
            cuboid("right", [3.5, -1.0, -1.0], [5.0, 1.4, 3.0]),
        ]
    }

    fn below(level: f64) -> RegionShapeFile {
        RegionShapeFile::Below {
            level,
            seed: (0.8, 0.2, 0.5),
        }
    }

    #[test]
    fn a_periodic_trough_fills_to_its_volume() {
        let fluid = fluid(below(1.0), ResolutionFile::Spacing(0.1));
        let lattice = lattice(&fluid, &domain(vec![Axis::Y]), &trough(), 0).unwrap();
        // 3 m x 0.4 m x 1 m in cubes of 0.1 m, which fit exactly
        assert_eq!(lattice.positions.len(), 30 * 4 * 10);
        assert!((lattice.depth - 1.0).abs() < 1e-12);
    }

    #[test]
    fn an_open_basin_names_its_leak() {
        let fluid = fluid(below(1.0), ResolutionFile::Spacing(0.1));
        let problems = lattice(&fluid, &domain(vec![]), &trough(), 0).unwrap_err();
        assert!(
            problems[0].message.contains("leaks out of the domain at ("),
            "{problems:?}"
        );
    }

    #[test]
    fn a_plate_thinner_than_a_spacing_keeps_water_out() {
        let mut solids = trough();
        solids.push(cuboid("plate", [2.49, -1.0, -1.0], [2.51, 1.4, 3.0]));
        let fluid = fluid(below(1.0), ResolutionFile::Spacing(0.1));
        let lattice = lattice(&fluid, &domain(vec![Axis::Y]), &solids, 0).unwrap();
        assert!(lattice.positions.iter().all(|x| x.x < 2.5));
    }

    #[test]
    fn a_wanted_count_is_met_as_rows_allow() {
        for count in [1000, 5000, 24_000] {
            let fluid = fluid(below(1.03), ResolutionFile::Count(count));
            let lattice = lattice(&fluid, &domain(vec![Axis::Y]), &trough(), 0).unwrap();
            let share = lattice.positions.len() as f64 / f64::from(count);
            // a trough of right angles takes whole rows in x, y and z only
            assert!((share - 1.0).abs() <= 0.06, "{count}: {share}");
        }
    }

    #[test]
    fn a_box_that_overlaps_a_block_says_by_how_much() {
        let shape = RegionShapeFile::Box {
            min: (0.0, 0.0, 0.0),
            max: (2.0, 0.4, 1.0),
        };
        let fluid = fluid(shape, ResolutionFile::Spacing(0.1));
        let problems = lattice(&fluid, &domain(vec![Axis::Y]), &trough(), 0).unwrap_err();
        // the deepest node stands 0.45 m inside the left wall
        let expected = "fluid region `lake` overlaps block `left` by 0.450 m";
        assert!(problems[0].message.contains(expected), "{problems:?}");
    }

    #[test]
    fn no_particle_is_nearer_to_a_slope_than_half_a_spacing() {
        let mut solids = trough();
        let beach =
            Polyhedron::extrusion(&[[1.0, 0.0], [3.5, 1.5], [3.5, 0.0]], 1, -1.0, 1.4).unwrap();
        solids.push(("beach".into(), Shape::Polyhedra(beach)));
        let fluid = fluid(below(1.0), ResolutionFile::Spacing(0.04));
        let lattice = lattice(&fluid, &domain(vec![Axis::Y]), &solids, 0).unwrap();
        let nearest = lattice
            .positions
            .iter()
            .flat_map(|x| solids.iter().map(|(_, s)| s.signed_distance(x).distance))
            .fold(f64::INFINITY, f64::min);
        assert!(
            nearest >= 0.02 * (1.0 - 2.0 * obstacles::WALL_SLACK),
            "{nearest}"
        );
        // trough 3 m x 1 m less the beach's wedge under the level; a row is lost at most on the
        // 1.94 m of wetted slope
        let exact = (3.0 - 0.5 * (1.0 / 0.6) - (2.5 - 1.0 / 0.6)) * 0.4;
        let volume = lattice.positions.len() as f64 * 0.04_f64.powi(3);
        assert!(
            volume <= exact && exact - volume < 1.94 * 0.04 * 0.4,
            "{volume} of {exact}"
        );
    }
}
