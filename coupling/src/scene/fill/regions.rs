//! The regions of water one by one, and all together.

use riprap_dda::{Shape, Vec3};

use super::basin::Poured;
use super::boxes::Grid;
use super::{Amount, FillError, Lattice, Pouring, amounts, basin, boxes, spacings};
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{
    DimensionsFile, DomainFile, FluidFile, RegionFile, RegionShapeFile, ResolutionFile, vec3,
};

/// Smallest distance of particles of two regions; closer ones would blow apart; × spacing.
const NEAREST_OF_REGIONS: f64 = 0.9;

/// A region and its particles.
struct Filled {
    poured: Poured,
    /// Spacings of its rows; m.
    spacing: [f64; 3],
}

/// Initial water at a spacing (m), which directions with a period or a plane of symmetry change.
pub(super) fn at_spacing(
    fluid: &FluidFile,
    domain: &DomainFile,
    solids: &[(String, Shape)],
    pouring: Pouring,
    wanted: f64,
) -> Result<Lattice, Vec<Problem>> {
    let spacing = spacings(fluid, domain, wanted);
    if !spacing.iter().all(|s| s.is_finite() && *s > 0.0) {
        let message = format!("fluid: spacing must be finite and > 0, got {wanted}");
        return Err(vec![Problem::error(
            Code::ValueOutOfRange,
            "fluid.resolution",
            message,
        )]);
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
                        ..
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
            Code::NoParticleFits,
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

/// Regions that are basins, each filled with rows of a spacing (m).
fn basins_at(
    (fluid, domain, spacing): (&FluidFile, &DomainFile, [f64; 3]),
    solids: &[(String, Shape)],
    pouring: Pouring,
) -> Vec<Option<Result<Poured, FillError>>> {
    let poured = |region: &RegionFile| match region.shape {
        RegionShapeFile::Box { .. } => None,
        RegionShapeFile::Below { level, seed } => {
            let rows = (spacing, fluid.lattice);
            let seed = vec3(seed);
            Some(basin::fill(domain, rows, (level, &seed), solids, pouring))
        }
    };
    fluid.regions.iter().map(poured).collect()
}

/// All regions on their own, and the volume of a particle (m³): basins set it, and the rows of boxes are stretched to
/// have it too.
fn all_filled(
    (fluid, domain, mut spacing): (&FluidFile, &DomainFile, [f64; 3]),
    solids: &[(String, Shape)],
    pouring: Pouring,
) -> (Vec<Result<Filled, FillError>>, f64) {
    let basins = basins_at((fluid, domain, spacing), solids, pouring);
    let fitting = basins.iter().flatten().flatten();
    let fitting = fitting.filter_map(|poured| poured.fitting_height).next();
    let basins = match fitting {
        // a wanted number of particles comes before rows that fit
        Some(height)
            if basins.len() == 1 && !matches!(fluid.resolution, ResolutionFile::Count(_)) =>
        {
            spacing[2] = height;
            basins_at((fluid, domain, spacing), solids, pouring)
        }
        _ => basins,
    };
    let own: f64 = spacing.iter().product();
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
    Problem::error(
        error.code(),
        path,
        format!("fluid region `{}` {error}", region.name),
    )
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
