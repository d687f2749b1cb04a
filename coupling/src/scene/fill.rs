//! Initial water: particles on a lattice, in boxes and in basins.

mod amounts;
mod basin;
mod boxes;
mod count;
mod drawn;
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
pub use amounts::{Amount, misfits};
use basin::Poured;
use boxes::Grid;
pub(super) use drawn::depth_at;
pub use gaps::narrow_gaps;
use obstacles::WALL_SLACK;
pub use overlap::{overlaps, overlaps_on};

/// Largest number of lattice nodes that are visited.
const MOST_NODES: f64 = 5e7;
/// Bytes per visited node: its state and the queue of nodes.
const NODE_BYTES: f64 = 8.0;
/// Smallest distance of particles of two regions; closer ones would blow apart; × spacing.
const NEAREST_OF_REGIONS: f64 = 0.9;

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

/// A region and its particles.
struct Filled {
    poured: Poured,
    /// Spacings of its rows; m.
    spacing: [f64; 3],
}

fn at_spacing(
    fluid: &FluidFile,
    domain: &DomainFile,
    solids: &[(String, Shape)],
    pouring: Pouring,
    wanted: f64,
) -> Result<Lattice, Vec<Problem>> {
    let spacing = spacings(fluid, domain, wanted);
    if !spacing.iter().all(|s| s.is_finite() && *s > 0.0) {
        let message = format!("fluid: spacing must be finite and > 0, got {wanted}");
        return Err(vec![Problem::error("fluid.resolution", message)]);
    }
    let (filled, volume) = all_filled((fluid, domain, spacing), solids, pouring);
    let mut lattice = Lattice {
        spacing,
        still_water_level: f64::NEG_INFINITY,
        ..Lattice::default()
    };
    let mut problems = Vec::new();
    let (mut bottom, mut least) = (f64::INFINITY, f64::INFINITY);
    for (index, (region, filled)) in fluid.regions.iter().zip(filled).enumerate() {
        let level = match region.shape {
            RegionShapeFile::Box { max, .. } => max.2,
            RegionShapeFile::Below { level, .. } => level,
        };
        let filled = filled.and_then(|filled| {
            let water = &filled.poured.water;
            (pouring.room).holds((lattice.positions.len() + water.len()) as f64)?;
            least = filled.spacing.into_iter().fold(least, f64::min);
            check_regions(&lattice, (water, least), &fluid.regions).map(|()| filled)
        });
        match filled {
            Ok(Filled {
                poured:
                    Poured {
                        water: positions,
                        mould,
                        drawn,
                    },
                spacing,
            }) => {
                let n = positions.len();
                let is_basin = matches!(region.shape, RegionShapeFile::Below { .. });
                let filled = n as f64 * volume;
                lattice.amounts.push(Amount {
                    drawn: drawn.unwrap_or(filled),
                    filled,
                });
                bottom = positions
                    .iter()
                    .fold(bottom, |low, x| low.min(x.z - 0.5 * spacing[2]));
                lattice.mould.extend(mould);
                lattice.is_packed.push(is_basin && 0 < pouring.n_mould_rows);
                lattice.still_water_level = lattice.still_water_level.max(level);
                lattice.positions.extend(positions);
                lattice
                    .velocities
                    .extend(std::iter::repeat_n(vec3(region.velocity), n));
                lattice.region.extend(std::iter::repeat_n(index as u32, n));
                // rows as they are, where they are the same everywhere
                if fluid.regions.len() == 1 {
                    lattice.spacing = spacing;
                }
            }
            Err(error) => problems.push(region_problem(index, region, &error)),
        }
    }
    lattice.spacing = amounts::stretched(lattice.spacing, volume, domain);
    if lattice.positions.is_empty() && problems.is_empty() {
        problems.push(Problem::error(
            "fluid.regions",
            "no particle fits in any region; refine `fluid.resolution` or enlarge the regions",
        ));
    }
    lattice.depth = lattice.still_water_level - bottom;
    if problems.is_empty() {
        Ok(lattice)
    } else {
        Err(problems)
    }
}

/// All regions on their own, and the volume of a particle (m³): basins set it, and the rows of boxes are stretched to
/// have it too.
fn all_filled(
    (fluid, domain, spacing): (&FluidFile, &DomainFile, [f64; 3]),
    solids: &[(String, Shape)],
    pouring: Pouring,
) -> (Vec<Result<Filled, FillError>>, f64) {
    let own: f64 = spacing.iter().product();
    let basins: Vec<Option<Result<Poured, FillError>>> = fluid
        .regions
        .iter()
        .map(|region| match region.shape {
            RegionShapeFile::Box { .. } => None,
            RegionShapeFile::Below { level, seed } => {
                let rows = (spacing, fluid.lattice);
                let seed = vec3(seed);
                let poured = basin::fill(domain, rows, (level, &seed), solids, pouring);
                Some(poured)
            }
        })
        .collect();
    let poured = || basins.iter().flatten().flatten();
    let n_poured: usize = poured().map(|poured| poured.water.len()).sum();
    let is_plane = domain.dimensions == DimensionsFile::Two;
    let extent = |region: &RegionFile| match region.shape {
        RegionShapeFile::Box { min, max } => vec3(max) - vec3(min),
        RegionShapeFile::Below { .. } => Vec3::zeros(),
    };
    let grid = Grid { spacing, is_plane };
    let boxes: Vec<Vec3> = (fluid.regions.iter())
        .filter(|region| matches!(region.shape, RegionShapeFile::Box { .. }))
        .map(extent)
        .collect();
    let volume = if 0 < n_poured {
        let drawn: f64 = poured().filter_map(|poured| poured.drawn).sum();
        let is_packed = 0 < pouring.n_mould_rows;
        (pouring.is_measured).then(|| amounts::of_basins(own, (drawn, n_poured), is_packed))
    } else {
        grid.common_volume(&boxes)
    };
    let volume = volume.unwrap_or(own);
    let goal = Some(volume).filter(|_| 1 < boxes.len() || 0 < n_poured);
    let filled = fluid.regions.iter().zip(basins).map(|(region, basin)| {
        let RegionShapeFile::Box { min, .. } = region.shape else {
            return basin
                .unwrap_or_else(|| Ok(Poured::default()))
                .map(|poured| Filled { poured, spacing });
        };
        let extent = extent(region);
        let rows = grid.rows(extent, goal);
        let by_thickness = |a: &usize, b: &usize| extent[*a].total_cmp(&extent[*b]);
        let thin = (0..3).filter(|&axis| rows.counts[axis] == 0.0);
        if let Some(thin) = thin.min_by(by_thickness) {
            return Err(FillError::TooThin {
                axis: ['x', 'y', 'z'][thin],
                thickness: extent[thin],
            });
        }
        let water = boxes::fill(vec3(min), rows, solids, pouring.room)?;
        let across = if is_plane { spacing[1] } else { extent.y };
        let poured = Poured {
            water,
            drawn: Some(extent.x * across * extent.z),
            ..Poured::default()
        };
        let spacing = rows.spacing;
        Ok(Filled { poured, spacing })
    });
    (filled.collect(), volume)
}

fn region_problem(index: usize, region: &RegionFile, error: &FillError) -> Problem {
    let path = match error {
        FillError::TooManyNodes { .. } | FillError::NoMemory { .. } => {
            "fluid.resolution".to_owned()
        }
        _ => format!("fluid.regions[{index}].shape{}", blamed(error)),
    };
    Problem::error(path, format!("fluid region `{}` {error}", region.name))
}

/// The field of a region that an error refers to, with its dot.
fn blamed(error: &FillError) -> &'static str {
    match error {
        FillError::LevelAboveDomain { .. } | FillError::NoRow { .. } => ".level",
        FillError::SeedOutside { .. }
        | FillError::SeedInBlock { .. }
        | FillError::SeedTooNarrow { .. } => ".seed",
        _ => "",
    }
}

/// Checks the distance of new particles from those of earlier regions, by the least spacing (m) of all. Only particles in the common part of both are
/// sorted into cells.
fn check_regions(
    earlier: &Lattice,
    (new, least_spacing): (&[Vec3], f64),
    regions: &[RegionFile],
) -> Result<(), FillError> {
    let least = least_spacing * NEAREST_OF_REGIONS;
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
    use crate::scene::file::{OutOfDomainFile, RegionFile};
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
        let volume = lattice.positions.len() as f64 * 0.04_f64.powi(3);
        assert!(
            volume <= exact && exact - volume < 1.94 * 0.04 * 0.4,
            "{volume} of {exact}"
        );
    }
}
