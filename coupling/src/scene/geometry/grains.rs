//! Grains: spheres in bulk.

use std::collections::HashSet;

use riprap_dda::{Random, Vec3};

use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::vec3;
use crate::scene::file::{
    BlockFile, GrainRegionFile, GrainsFile, MaterialFile, MotionFile, PlacementFile, ShapeFile,
};

/// Spheres made of a list of grains.
#[derive(Clone, Debug, PartialEq)]
pub struct GrainsReport {
    /// Its name.
    pub name: String,
    /// Number of spheres.
    pub n_grains: usize,
    /// Mass of all of them; kg.
    pub mass: f64,
    /// Smallest and largest diameter; m.
    pub diameters: [f64; 2],
}

/// Largest number of spheres in a list: millimeters read as meters would otherwise fill the memory.
const MOST: usize = 1_000_000;
/// Share of a spacing that a row may lack, so that a box made for ten spheres takes ten.
const ROUNDING: f64 = 1e-9;

impl GrainsFile {
    /// Smallest spacing without overlap, that of two of the largest spheres offset toward each other; m.
    pub fn least_spacing(&self) -> f64 {
        self.diameter.1 * (1.0 + 2.0 * self.jitter)
    }
}

/// Spheres of lists of grains, named `grains_0001` and so on, and a report of each list. `blocks` are the other blocks;
/// all together are at most `most`.
///
/// # Errors
///
/// Problems of counts that do not fit and of duplicate names, all together.
pub fn blocks_of_grains(
    lists: &[GrainsFile],
    blocks: &[BlockFile],
    materials: &[MaterialFile],
    most: usize,
) -> Result<(Vec<BlockFile>, Vec<GrainsReport>), Vec<Problem>> {
    let mut problems = Vec::new();
    let (mut made, mut reports) = (Vec::<BlockFile>::new(), Vec::new());
    for (index, grains) in lists.iter().enumerate() {
        let refused = |(code, field, what): Refusal| {
            let message = format!("grains `{}`: {what}", grains.name);
            Problem::error(code, format!("grains[{index}].{field}"), message)
        };
        let most = most.saturating_sub(blocks.len() + made.len()).min(MOST);
        let spheres = match spheres_of(grains, most) {
            Ok(spheres) => spheres,
            Err(refusal) => {
                problems.push(refused(refusal));
                continue;
            }
        };
        let names: HashSet<&str> = spheres.iter().map(|one| one.name.as_str()).collect();
        let is_taken = |block: &&BlockFile| names.contains(block.name.as_str());
        if let Some(block) = blocks.iter().chain(&made).find(is_taken) {
            let what = format!("its sphere `{}` has the name of a block", block.name);
            problems.push(refused((Code::UnusableName, "name", what)));
            continue;
        }
        // validation has verified that the name exists
        let material = materials.iter().find(|m| m.name == grains.material);
        let density = material.map_or(0.0, |m| m.density);
        reports.push(report(grains, density, &spheres));
        made.extend(spheres);
    }
    if problems.is_empty() {
        Ok((made, reports))
    } else {
        Err(problems)
    }
}

fn report(grains: &GrainsFile, density: f64, blocks: &[BlockFile]) -> GrainsReport {
    let diameters = blocks.iter().filter_map(|block| match block.shape {
        ShapeFile::Sphere { radius, .. } => Some(2.0 * radius),
        _ => None,
    });
    let cubes: f64 = diameters.clone().map(|d| d.powi(3)).sum();
    GrainsReport {
        name: grains.name.clone(),
        n_grains: blocks.len(),
        mass: density * std::f64::consts::PI / 6.0 * cubes,
        diameters: [
            diameters.clone().fold(f64::INFINITY, f64::min),
            diameters.fold(0.0, f64::max),
        ],
    }
}

/// The cause, the faulty field and the reason.
type Refusal = (Code, &'static str, String);

/// The spheres.
fn spheres_of(grains: &GrainsFile, most: usize) -> Result<Vec<BlockFile>, Refusal> {
    let wanted = grains.count.map(|count| count as usize);
    if wanted.is_some_and(|count| count > most) {
        let what = format!(
            "{} spheres are more than {most}, which is what fits in the memory or in a list",
            wanted.unwrap_or(0)
        );
        return Err((Code::TooManyBlocks, "count", what));
    }
    let (min, max) = bounds(&grains.region);
    let spacing = grains.spacing.unwrap_or(grains.least_spacing());
    let layer = (max - min).xy().product() / (spacing * spacing);
    if !(layer <= most as f64) {
        let what = format!("a layer of the region takes more than {most} spheres; make it smaller");
        return Err((Code::TooManyBlocks, "region", what));
    }
    let places: Vec<Vec3> = places(grains).take(wanted.unwrap_or(most + 1)).collect();
    match wanted {
        Some(count) if places.len() < count => {
            let what = format!(
                "{count} spheres do not fit, only {} do, {spacing} m apart; enlarge the region or lower count",
                places.len()
            );
            return Err((Code::GrainsDoNotFit, "count", what));
        }
        None if places.is_empty() => {
            let what = "the region is too small for a single sphere; enlarge it".to_owned();
            return Err((Code::GrainsDoNotFit, "region", what));
        }
        None if places.len() > most => {
            let what = format!("the region takes more than {most} spheres; give their count");
            return Err((Code::TooManyBlocks, "region", what));
        }
        _ => {}
    }
    let mut random = Random::new(grains.seed);
    let (smallest, largest) = grains.diameter;
    let mut sphere = |number: usize, place: Vec3| {
        let diameter = smallest + (largest - smallest) * random.uniform();
        let mut off = || grains.jitter * largest * (2.0 * random.uniform() - 1.0);
        let center = place + Vec3::new(off(), off(), off());
        BlockFile {
            name: format!("{}_{:04}", grains.name, number + 1),
            material: grains.material.clone(),
            shape: ShapeFile::Sphere {
                center: (center.x, center.y, center.z),
                radius: 0.5 * diameter,
            },
            placement: PlacementFile::default(),
            motion: MotionFile::Free,
            velocity: grains.velocity,
            angular_velocity: (0.0, 0.0, 0.0),
            deformable: None,
            hold: None,
            sealed: false,
            group: Some(grains.name.clone()),
            joint_faces: Vec::new(),
        }
    };
    Ok(places
        .into_iter()
        .enumerate()
        .map(|(number, place)| sphere(number, place))
        .collect())
}

/// Corners of the box around a region; m.
fn bounds(region: &GrainRegionFile) -> (Vec3, Vec3) {
    match *region {
        GrainRegionFile::Box { min, max } => (vec3(min), vec3(max)),
        GrainRegionFile::Cylinder {
            base,
            radius,
            height,
        } => {
            let base = vec3(base);
            (
                base - Vec3::new(radius, radius, 0.0),
                base + Vec3::new(radius, radius, height),
            )
        }
    }
}

/// Sites of the lattice whose spheres stay in the region, layer by layer from below; centered across, and as low as
/// possible.
fn places(grains: &GrainsFile) -> impl Iterator<Item = Vec3> {
    let cell = grains.least_spacing();
    let spacing = grains.spacing.unwrap_or(cell);
    let (min, max) = bounds(&grains.region);
    let counts = (max - min).map(|length| {
        let room = length - cell;
        if room < -ROUNDING * cell {
            0
        } else {
            // saturates where there is room for more than can be counted
            (room / spacing + ROUNDING).floor() as u64 + 1
        }
    });
    let mut first = min.add_scalar(0.5 * cell);
    for axis in 0..2 {
        let row = cell + spacing * counts[axis].saturating_sub(1) as f64;
        first[axis] += 0.5 * (max[axis] - min[axis] - row);
    }
    // horizontal distance that a sphere off its site extends to
    let reach = 0.5 * grains.diameter.1 + grains.jitter * grains.diameter.1 * 2.0_f64.sqrt();
    let region = grains.region;
    let is_inside = move |x: &Vec3| match region {
        GrainRegionFile::Box { .. } => true,
        GrainRegionFile::Cylinder { base, radius, .. } => {
            (x - vec3(base)).xy().norm() + reach <= radius * (1.0 + ROUNDING)
        }
    };
    let layer: Vec<Vec3> = (0..counts.y)
        .flat_map(|j| (0..counts.x).map(move |i| (i, j)))
        .map(|(i, j)| first + Vec3::new(i as f64, j as f64, 0.0) * spacing)
        .filter(is_inside)
        .collect();
    // nothing fits in any layer where nothing fits in one
    let layers = if layer.is_empty() { 0 } else { counts.z };
    (0..layers).flat_map(move |k| {
        let up = Vec3::new(0.0, 0.0, k as f64 * spacing);
        layer.clone().into_iter().map(move |place| place + up)
    })
}

impl std::fmt::Display for GrainsReport {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [smallest, largest] = self.diameters;
        write!(
            f,
            "`{}`: {} spheres of {smallest:.3e} to {largest:.3e} m, {:.3e} kg together",
            self.name, self.n_grains, self.mass
        )
    }
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test may stop where a library may not"
)]
mod tests {
    use super::*;

    fn grains(region: GrainRegionFile, count: Option<u32>) -> GrainsFile {
        GrainsFile {
            name: "bead".into(),
            material: "glass".into(),
            region,
            diameter: (0.05, 0.1),
            count,
            spacing: None,
            jitter: 0.1,
            seed: 7,
            velocity: (0.0, 0.0, 0.0),
        }
    }

    /// Centers and radii.
    fn spheres(grains: &GrainsFile) -> Vec<(Vec3, f64)> {
        let blocks = spheres_of(grains, MOST).unwrap();
        blocks
            .iter()
            .map(|block| match block.shape {
                ShapeFile::Sphere { center, radius } => (vec3(center), radius),
                _ => (Vec3::zeros(), f64::NAN),
            })
            .collect()
    }

    const BOX: GrainRegionFile = GrainRegionFile::Box {
        min: (-0.6, 0.0, 1.0),
        max: (0.6, 0.6, 1.8),
    };
    const CYLINDER: GrainRegionFile = GrainRegionFile::Cylinder {
        base: (1.0, 2.0, 3.0),
        radius: 0.6,
        height: 0.5,
    };

    #[test]
    fn a_box_takes_whole_cells() {
        // cells of 0.1 (1 + 0.2) = 0.12 m: 10 x 5 x 6
        assert_eq!(spheres(&grains(BOX, None)).len(), 300);
        // twice as far apart: 1 + floor((1.2 − 0.12)/0.24) = 5, 3, 3
        let wide = GrainsFile {
            spacing: Some(0.24),
            ..grains(BOX, None)
        };
        assert_eq!(spheres(&wide).len(), 45);
    }

    #[test]
    fn spheres_do_not_overlap_nor_leave_their_region() {
        for region in [BOX, CYLINDER] {
            let spheres = spheres(&grains(region, None));
            assert!(spheres.len() > 100, "{}", spheres.len());
            for (k, (x, r)) in spheres.iter().enumerate() {
                match region {
                    GrainRegionFile::Box { min, max } => {
                        let (low, high) = (x.add_scalar(-r) - vec3(min), vec3(max) - x);
                        assert!(low.min() >= -1e-12 && high.min() >= r - 1e-12);
                    }
                    GrainRegionFile::Cylinder { base, radius, .. } => {
                        assert!((x - vec3(base)).xy().norm() + r <= radius + 1e-12);
                        assert!(x.z - r >= 3.0 - 1e-12 && x.z + r <= 3.5 + 1e-12);
                    }
                }
                for (y, s) in &spheres[..k] {
                    assert!((x - y).norm() >= r + s - 1e-12);
                }
            }
        }
    }

    #[test]
    fn sizes_are_spread_evenly_and_repeat_with_the_seed() {
        let region = GrainRegionFile::Box {
            min: (0.0, 0.0, 0.0),
            max: (3.0, 3.0, 3.0),
        };
        let many = spheres(&grains(region, Some(10_000)));
        assert_eq!(many, spheres(&grains(region, Some(10_000))));
        let other = GrainsFile {
            seed: 8,
            ..grains(region, Some(10_000))
        };
        assert_ne!(many, spheres(&other));
        // mean 0.0375 m, standard deviation 0.025/√12 m: that of the mean is 7e-5 m
        let mean = many.iter().map(|(_, r)| r).sum::<f64>() / 1e4;
        assert!((mean - 0.0375).abs() < 3.0 * 7.2e-5, "{mean}");
        let quarter = many.iter().filter(|(_, r)| *r < 0.025 + 0.25 * 0.025);
        assert!((quarter.count() as f64 - 2500.0).abs() < 3.0 * 43.3);
    }

    #[test]
    fn a_count_that_does_not_fit_says_how_many_do() {
        let (code, field, what) = spheres_of(&grains(BOX, Some(301)), MOST).unwrap_err();
        assert_eq!((code, field), (Code::GrainsDoNotFit, "count"));
        assert!(
            what.contains("301 spheres do not fit, only 300 do"),
            "{what}"
        );
        let tiny = GrainRegionFile::Box {
            min: (0.0, 0.0, 0.0),
            max: (0.1, 0.1, 0.1),
        };
        let (_, _, what) = spheres_of(&grains(tiny, None), MOST).unwrap_err();
        assert!(what.contains("too small for a single sphere"), "{what}");
        let huge = GrainRegionFile::Cylinder {
            base: (0.0, 0.0, 0.0),
            radius: 1e9,
            height: 1e9,
        };
        let (_, _, what) = spheres_of(&grains(BOX, Some(2_000_000)), MOST).unwrap_err();
        assert!(what.contains("more than 1000000"), "{what}");
        let (_, _, what) = spheres_of(&grains(huge, Some(10)), MOST).unwrap_err();
        assert!(what.contains("a layer of the region takes more"), "{what}");
    }
}
