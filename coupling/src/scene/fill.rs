//! Water at the start: particles on a lattice, in boxes and in basins.

mod basin;
mod boxes;
mod count;
mod gaps;
mod obstacles;
mod overlap;

use riprap_dda::{Shape, Vec3};
use riprap_sph::Dimensions;

use super::error::Problem;
use super::file::vec3;
use super::file::{
    Axis, DimensionsFile, DomainFile, FluidFile, LatticeFile, RegionFile, RegionShapeFile,
    ResolutionFile,
};
use basin::Poured;
pub use gaps::narrow_gaps;
use obstacles::WALL_SLACK;
pub use overlap::overlaps;

/// Most lattice nodes that are looked at.
const MOST_NODES: f64 = 5e7;
/// Bytes for each node that is looked at: what is known of it, and of those still to be visited.
const NODE_BYTES: f64 = 8.0;
/// Particles of two regions nearer than this are an overlap: they would blow apart; × spacing.
const NEAREST_OF_REGIONS: f64 = 0.9;

/// Particles at the start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lattice {
    /// Along x, y, z; a periodic direction holds a whole number of spacings, and so does one that ends at a plane
    /// of symmetry; m.
    pub spacing: [f64; 3],
    /// m.
    pub positions: Vec<Vec3>,
    /// m/s.
    pub velocities: Vec<Vec3>,
    /// Number of the region in the file; one per particle.
    pub region: Vec<u32>,
    /// Whether each region is to be packed against its walls.
    pub is_packed: Vec<bool>,
    /// More water above the levels, which holds the surfaces of what is packed in place; m.
    pub mould: Vec<Vec3>,
    /// Highest surface of any region; m.
    pub still_water_level: f64,
    /// From there to the bottom of the lowest particle; m.
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

/// Amount of water that fits the memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// Most bytes that may be taken; infinite where the system does not tell.
    pub bytes: f64,
    /// Bytes that a run needs for each particle, at least.
    pub bytes_per_particle: f64,
}

impl Room {
    /// No bounds.
    pub const ENDLESS: Self = Self {
        bytes: f64::INFINITY,
        bytes_per_particle: 0.0,
    };

    /// Whether so many particles fit, before there are any.
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

    /// Most nodes that may be looked at.
    fn nodes(&self) -> f64 {
        MOST_NODES.min(self.bytes / NODE_BYTES)
    }

    /// Whether so many nodes may be looked at; NaN may not.
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

/// The water of the file among the given solids. Where walls take it to fill its basins, its lattice is to be
/// packed against them, in a mould of so many rows above each level: none leaves it as it is.
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

/// As [`lattice`], with no more particles than there is room for; more are refused before they are made.
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
    let at = |spacing| at_spacing(fluid, domain, solids, (n_mould_rows, room), spacing);
    match fluid.resolution {
        ResolutionFile::Spacing(wanted) => at(wanted),
        ResolutionFile::Count(wanted) => count::lattice(fluid, domain, (wanted, room), at),
    }
}

/// Spacings along x, y, z over that of a cubic lattice of the same volume. The layers of a staggered lattice are
/// squares that are face-centered cubic one over the other, in a plane rows that are hexagonal.
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

/// Spacings along x, y, z: a periodic direction takes the nearest one that closes on itself, one that ends at a
/// plane of symmetry the nearest one that does so half a spacing off; a flow in a plane has one row across.
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

/// Rows that fit an extent; the slack lets in those that fit by the digits a user types.
fn rows(extent: f64, spacing: f64) -> f64 {
    (extent / spacing + WALL_SLACK).floor().max(0.0)
}

fn at_spacing(
    fluid: &FluidFile,
    domain: &DomainFile,
    solids: &[(String, Shape)],
    (n_mould_rows, room): (usize, Room),
    wanted: f64,
) -> Result<Lattice, Vec<Problem>> {
    let spacing = spacings(fluid, domain, wanted);
    if !spacing.iter().all(|s| s.is_finite() && *s > 0.0) {
        let message = format!("fluid: spacing must be finite and > 0, got {wanted}");
        return Err(vec![Problem::error("fluid.resolution", message)]);
    }
    let mut lattice = Lattice {
        spacing,
        still_water_level: f64::NEG_INFINITY,
        ..Lattice::default()
    };
    let mut problems = Vec::new();
    for (index, region) in fluid.regions.iter().enumerate() {
        let (level, is_packed, filled) = match &region.shape {
            RegionShapeFile::Box { min, max } => {
                let water = boxes::fill((vec3(*min), vec3(*max)), spacing, solids, room);
                let mould = Vec::new();
                (max.2, false, water.map(|water| Poured { water, mould }))
            }
            RegionShapeFile::Below { level, seed } => {
                let seed = vec3(*seed);
                let poured = basin::fill(
                    domain,
                    (spacing, fluid.lattice),
                    (*level, &seed),
                    solids,
                    (n_mould_rows, room),
                );
                (*level, 0 < n_mould_rows, poured)
            }
        };
        let filled = filled.and_then(|poured| {
            room.holds((lattice.positions.len() + poured.water.len()) as f64)?;
            check_regions(&lattice, &poured.water, &fluid.regions).map(|()| poured)
        });
        match filled {
            Ok(Poured {
                water: positions,
                mould,
            }) => {
                let n = positions.len();
                lattice.mould.extend(mould);
                lattice.is_packed.push(is_packed);
                lattice.still_water_level = lattice.still_water_level.max(level);
                lattice.positions.extend(positions);
                lattice
                    .velocities
                    .extend(std::iter::repeat_n(vec3(region.velocity), n));
                lattice.region.extend(std::iter::repeat_n(index as u32, n));
            }
            Err(error) => {
                let path = match &error {
                    FillError::TooManyNodes { .. } | FillError::NoMemory { .. } => {
                        "fluid.resolution".to_owned()
                    }
                    _ => format!("fluid.regions[{index}].shape{}", blamed(&error)),
                };
                let message = format!("fluid region `{}` {error}", region.name);
                problems.push(Problem::error(path, message));
            }
        }
    }
    if lattice.positions.is_empty() && problems.is_empty() {
        problems.push(Problem::error(
            "fluid.regions",
            "no particle fits in any region; refine `fluid.resolution` or enlarge the regions",
        ));
    }
    let lowest = lattice
        .positions
        .iter()
        .fold(f64::INFINITY, |low, x| low.min(x.z));
    lattice.depth = lattice.still_water_level - (lowest - 0.5 * spacing[2]);
    if problems.is_empty() {
        Ok(lattice)
    } else {
        Err(problems)
    }
}

/// The field of a region that an error speaks of, with its dot.
fn blamed(error: &FillError) -> &'static str {
    match error {
        FillError::LevelAboveDomain { .. } | FillError::NoRow { .. } => ".level",
        FillError::SeedOutside { .. }
        | FillError::SeedInBlock { .. }
        | FillError::SeedTooNarrow { .. } => ".seed",
        _ => "",
    }
}

/// New particles must keep clear of those of earlier regions. Only the part of the lattice where
/// both can be is sorted into cells.
fn check_regions(earlier: &Lattice, new: &[Vec3], regions: &[RegionFile]) -> Result<(), FillError> {
    let least = earlier
        .spacing
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min)
        * NEAREST_OF_REGIONS;
    let nothing = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let around = |points: &[Vec3]| {
        points
            .iter()
            .fold(nothing, |(min, max), x| (min.inf(x), max.sup(x)))
    };
    let (a, b) = (around(&earlier.positions), around(new));
    let (min, max) = (
        a.0.sup(&b.0).add_scalar(-least),
        a.1.inf(&b.1).add_scalar(least),
    );
    let is_common = |x: &Vec3| (0..3).all(|axis| min[axis] <= x[axis] && x[axis] <= max[axis]);
    let cell = |x: &Vec3| [2, 1, 0].map(|axis| ((x[axis] - min[axis]) / least).floor() as i64);
    let mut sorted: Vec<([i64; 3], usize)> = (0..earlier.positions.len())
        .filter(|&k| is_common(&earlier.positions[k]))
        .map(|k| (cell(&earlier.positions[k]), k))
        .collect();
    sorted.sort_unstable();
    for x in new.iter().filter(|x| is_common(x)) {
        let home = cell(x);
        // three neighboring cells in x follow each other in the list
        for row in (-1..=1).flat_map(|k| (-1..=1).map(move |j| (k, j))) {
            let first = [home[0] + row.0, home[1] + row.1, home[2] - 1];
            let last = [first[0], first[1], home[2] + 1];
            let start = sorted.partition_point(|(cell, _)| *cell < first);
            let near = sorted[start..].iter().take_while(|(cell, _)| *cell <= last);
            for &(_, k) in near {
                if (earlier.positions[k] - x).norm() < least {
                    let other = regions.get(earlier.region[k] as usize);
                    return Err(FillError::InRegion {
                        other: other.map_or_else(String::new, |region| region.name.clone()),
                        at: *x,
                    });
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test may stop where a library may not"
)]
mod tests {
    use super::*;
    use crate::scene::file::{Leaving, RegionFile};
    use riprap_dda::Polyhedron;

    fn domain(periodic: Vec<Axis>) -> DomainFile {
        DomainFile {
            min: (0.0, 0.0, -0.5),
            max: (4.0, 0.4, 2.0),
            periodic,
            symmetry: Vec::new(),
            leaving: Leaving::Removed,
            dimensions: DimensionsFile::Three,
        }
    }

    fn fluid(shape: RegionShapeFile, resolution: ResolutionFile) -> FluidFile {
        FluidFile {
            density: 1000.0,
            dynamic_viscosity: 1.0,
            lattice: LatticeFile::Cubic,
            rheology: None,
            resolution,
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
        let volume = lattice.positions.len() as f64 * lattice.particle_volume();
        assert!(
            volume <= exact && exact - volume < 1.94 * 0.04 * 0.4,
            "{volume} of {exact}"
        );
    }
}
