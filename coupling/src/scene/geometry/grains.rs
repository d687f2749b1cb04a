//! Grains: spheres in bulk.

use std::collections::HashSet;

use riprap_dda::{Random, Shape, Vec3};

use super::shape::solid;
use crate::messages::Code;
use crate::scene::access::Access;
use crate::scene::error::Problem;
use crate::scene::file::vec3;
use crate::scene::file::{
    BlockFile, GrainRegionFile, GrainSizeFile, GrainsFile, MaterialFile, MotionFile, PlacementFile,
    ShapeFile,
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
        self.largest() * (1.0 + 2.0 * self.jitter)
    }

    /// Smallest diameter of all sizes; m.
    pub fn smallest(&self) -> f64 {
        let further = self.mixed_with.iter().map(|size| size.diameter.0);
        further.fold(self.diameter.0, f64::min)
    }

    /// Largest diameter of all sizes; m.
    pub fn largest(&self) -> f64 {
        let further = self.mixed_with.iter().map(|size| size.diameter.1);
        further.fold(self.diameter.1, f64::max)
    }

    /// All sizes; the first has the share that the others leave.
    fn sizes(&self) -> Vec<GrainSizeFile> {
        let further: f64 = self.mixed_with.iter().map(|size| size.volume_share).sum();
        let first = GrainSizeFile {
            diameter: self.diameter,
            volume_share: 1.0 - further,
        };
        std::iter::once(first)
            .chain(self.mixed_with.iter().copied())
            .collect()
    }
}

/// Where spheres are placed.
enum Region {
    Box,
    /// Upright, with the middle and the radius of its base (m).
    Cylinder(Vec3, f64),
    Inside(Shape),
}

/// A region with the corners of the box around it (m).
struct Placed {
    region: Region,
    corners: (Vec3, Vec3),
}

impl Placed {
    /// Whether a sphere of a radius (m) lies in the region, in the box around it as it is.
    fn has(&self, x: &Vec3, radius: f64) -> bool {
        let slack = ROUNDING * radius;
        match &self.region {
            Region::Box => true,
            Region::Cylinder(base, of_base) => (x - base).xy().norm() + radius <= of_base + slack,
            Region::Inside(shape) => shape.signed_distance(x).distance <= slack - radius,
        }
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
    (most, access): (usize, &Access),
) -> Result<(Vec<BlockFile>, Vec<GrainsReport>), Vec<Problem>> {
    let mut problems = Vec::new();
    let (mut made, mut reports) = (Vec::<BlockFile>::new(), Vec::new());
    for (index, grains) in lists.iter().enumerate() {
        let refused = |(code, field, what): Refusal| {
            let message = format!("grains `{}`: {what}", grains.name);
            Problem::error(code, format!("grains[{index}].{field}"), message)
        };
        let most = most.saturating_sub(blocks.len() + made.len()).min(MOST);
        let made_of = placed(grains, access).and_then(|region| spheres_of(grains, &region, most));
        let spheres = match made_of {
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
fn spheres_of(
    grains: &GrainsFile,
    region: &Placed,
    most: usize,
) -> Result<Vec<BlockFile>, Refusal> {
    let wanted = grains.count.map(|count| count as usize);
    if wanted.is_some_and(|count| count > most) {
        let what = format!(
            "{} spheres are more than {most}, which is what fits in the memory or in a list",
            wanted.unwrap_or(0)
        );
        return Err((Code::TooManyBlocks, "count", what));
    }
    let (min, max) = region.corners;
    let spacing = grains.spacing.unwrap_or(grains.least_spacing());
    let layer = (max - min).xy().product() / (spacing * spacing);
    if !(layer <= most as f64) {
        let what = format!("a layer of the region takes more than {most} spheres; make it smaller");
        return Err((Code::TooManyBlocks, "region", what));
    }
    let places = places(grains, region).take(wanted.unwrap_or(most + 1));
    let places: Vec<Vec3> = places.collect();
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
    let largest = grains.largest();
    let mixture = match grains.mixed_with.is_empty() {
        true => Vec::new(),
        false => mixed(&grains.sizes(), places.len(), &mut random),
    };
    let (least, most) = grains.diameter;
    let mut sphere = |number: usize, place: Vec3| {
        let diameter = match mixture.get(number) {
            Some(&diameter) => diameter,
            None => least + (most - least) * random.uniform(),
        };
        let mut off = || grains.jitter * largest * (2.0 * random.uniform() - 1.0);
        let center = place + Vec3::new(off(), off(), off());
        let shape = ShapeFile::Sphere {
            center: (center.x, center.y, center.z),
            radius: 0.5 * diameter,
        };
        free_block(grains, format!("{}_{:04}", grains.name, number + 1), shape)
    };
    Ok(places
        .into_iter()
        .enumerate()
        .map(|(number, place)| sphere(number, place))
        .collect())
}

/// A free block of the grains.
fn free_block(grains: &GrainsFile, name: String, shape: ShapeFile) -> BlockFile {
    BlockFile {
        name,
        material: grains.material.clone(),
        shape,
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
}

/// Diameters of a number of spheres whose sizes have their shares of the volume to within a sphere, in random order; m.
fn mixed(sizes: &[GrainSizeFile], n: usize, random: &mut Random) -> Vec<f64> {
    let mut volumes = vec![0.0; sizes.len()];
    let mut diameters: Vec<f64> = (0..n)
        .map(|_| {
            let all: f64 = volumes.iter().sum();
            // mean of d³ between a and b
            let mean = |(a, b): (f64, f64)| 0.25 * (a + b) * (a * a + b * b);
            let lacks = |k: usize| {
                let one = mean(sizes[k].diameter);
                (sizes[k].volume_share * (all + one) - volumes[k]) / one
            };
            let next = (0..sizes.len()).max_by(|&a, &b| lacks(a).total_cmp(&lacks(b)));
            let k = next.unwrap_or(0);
            let (least, most) = sizes[k].diameter;
            let diameter = least + (most - least) * random.uniform();
            volumes[k] += diameter.powi(3);
            diameter
        })
        .collect();
    for last in (1..n).rev() {
        let other = (random.uniform() * (last + 1) as f64) as usize;
        diameters.swap(last, other.min(last));
    }
    diameters
}

/// The region of some grains.
fn placed(grains: &GrainsFile, access: &Access) -> Result<Placed, Refusal> {
    match &grains.region {
        &GrainRegionFile::Box { min, max } => Ok(Placed {
            region: Region::Box,
            corners: (vec3(min), vec3(max)),
        }),
        &GrainRegionFile::Cylinder {
            base,
            radius,
            height,
        } => {
            let base = vec3(base);
            Ok(Placed {
                region: Region::Cylinder(base, radius),
                corners: (
                    base - Vec3::new(radius, radius, 0.0),
                    base + Vec3::new(radius, radius, height),
                ),
            })
        }
        GrainRegionFile::Inside(shape) => {
            let body = free_block(grains, grains.name.clone(), shape.clone());
            let refused = |problems: Vec<Problem>| {
                let found = problems.into_iter().next();
                let (code, what) = found.map_or_else(
                    || (Code::InvalidShape, "no solid".to_owned()),
                    |problem| (problem.code, problem.message),
                );
                (code, "region", what)
            };
            let shape = solid(&body, 0, access).map_err(refused)?;
            if matches!(shape, Shape::Surface(_)) {
                let what = "an open surface has no inside; take a closed shape".to_owned();
                return Err((Code::InvalidShape, "region", what));
            }
            Ok(Placed {
                corners: shape.aabb(),
                region: Region::Inside(shape),
            })
        }
    }
}

/// Sites of the lattice whose spheres stay in the region, layer by layer from below; centered across, and as low as
/// possible.
fn places<'a>(grains: &GrainsFile, region: &'a Placed) -> impl Iterator<Item = Vec3> + 'a {
    let cell = grains.least_spacing();
    let spacing = grains.spacing.unwrap_or(cell);
    let (min, max) = region.corners;
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
    // distance that a sphere off its site extends to: across in a cylinder, to all sides in a shape
    let largest = grains.largest();
    let reach = match region.region {
        Region::Inside(_) => 0.5 * largest + grains.jitter * largest * 3.0_f64.sqrt(),
        Region::Box | Region::Cylinder(..) => {
            0.5 * largest + grains.jitter * largest * 2.0_f64.sqrt()
        }
    };
    let layer: Vec<Vec3> = (0..counts.y)
        .flat_map(|j| (0..counts.x).map(move |i| (i, j)))
        .map(|(i, j)| first + Vec3::new(i as f64, j as f64, 0.0) * spacing)
        .collect();
    (0..counts.z).flat_map(move |k| {
        let up = Vec3::new(0.0, 0.0, k as f64 * spacing);
        let places = layer.clone().into_iter().map(move |place| place + up);
        places.filter(move |x| region.has(x, reach))
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
    use crate::scene::file::InWaterFile;

    fn grains(region: GrainRegionFile, count: Option<u32>) -> GrainsFile {
        GrainsFile {
            name: "bead".into(),
            material: "glass".into(),
            region,
            diameter: (0.05, 0.1),
            mixed_with: Vec::new(),
            count,
            spacing: None,
            jitter: 0.1,
            seed: 7,
            velocity: (0.0, 0.0, 0.0),
            in_water: InWaterFile::Auto,
        }
    }

    fn made(grains: &GrainsFile) -> Result<Vec<BlockFile>, Refusal> {
        let access = Access::of(std::path::Path::new("."));
        spheres_of(grains, &placed(grains, &access)?, MOST)
    }

    /// Centers and radii.
    fn spheres(grains: &GrainsFile) -> Vec<(Vec3, f64)> {
        let blocks = made(grains).unwrap();
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

    /// A closed shape that is no box.
    fn ball() -> GrainRegionFile {
        GrainRegionFile::Inside(ShapeFile::Sphere {
            center: (1.0, 0.0, 2.0),
            radius: 0.6,
        })
    }

    /// G17: two sizes, of which one has 0.3 of the volume, to within a sphere of it; no sphere of another size, none in order.
    #[test]
    fn sizes_have_their_shares_of_the_volume() {
        let region = GrainRegionFile::Box {
            min: (0.0, 0.0, 0.0),
            max: (3.0, 3.0, 3.0),
        };
        for (coarse, fine) in [((0.1, 0.1), (0.05, 0.05)), ((0.08, 0.1), (0.03, 0.05))] {
            let mixture = GrainsFile {
                diameter: coarse,
                mixed_with: vec![GrainSizeFile {
                    diameter: fine,
                    volume_share: 0.3,
                }],
                ..grains(region.clone(), Some(5000))
            };
            let spheres = spheres(&mixture);
            let volume = |r: f64| 8.0 * r.powi(3);
            let is_fine = |r: f64| 2.0 * r <= fine.1;
            let all: f64 = spheres.iter().map(|(_, r)| volume(*r)).sum();
            let fines = spheres.iter().filter(|(_, r)| is_fine(*r));
            let share = fines.map(|(_, r)| volume(*r)).sum::<f64>() / all;
            assert!((share - 0.3).abs() * all <= coarse.1.powi(3), "{share}");
            let counts = spheres.chunks(1000).map(|part| {
                let fines = part.iter().filter(|(_, r)| is_fine(*r));
                fines.count() as f64 / 1000.0
            });
            let counts: Vec<f64> = counts.collect();
            let mean = counts.iter().sum::<f64>() / 5.0;
            // standard deviation of a thousand draws, three times
            let spread = 3.0 * (mean * (1.0 - mean) / 1000.0).sqrt();
            assert!(
                counts.iter().all(|c| (c - mean).abs() < spread),
                "{counts:?}"
            );
            assert_eq!(spheres, self::spheres(&mixture));
        }
    }

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
        for region in [BOX, CYLINDER, ball()] {
            let spheres = spheres(&grains(region.clone(), None));
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
                    GrainRegionFile::Inside(_) => {
                        let off = x - Vec3::new(1.0, 0.0, 2.0);
                        assert!(off.norm() + r <= 0.6 + 1e-12);
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
        let many = spheres(&grains(region.clone(), Some(10_000)));
        assert_eq!(many, spheres(&grains(region.clone(), Some(10_000))));
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
        let (code, field, what) = made(&grains(BOX, Some(301))).unwrap_err();
        assert_eq!((code, field), (Code::GrainsDoNotFit, "count"));
        assert!(
            what.contains("301 spheres do not fit, only 300 do"),
            "{what}"
        );
        let tiny = GrainRegionFile::Box {
            min: (0.0, 0.0, 0.0),
            max: (0.1, 0.1, 0.1),
        };
        let (_, _, what) = made(&grains(tiny, None)).unwrap_err();
        assert!(what.contains("too small for a single sphere"), "{what}");
        let huge = GrainRegionFile::Cylinder {
            base: (0.0, 0.0, 0.0),
            radius: 1e9,
            height: 1e9,
        };
        let (_, _, what) = made(&grains(BOX, Some(2_000_000))).unwrap_err();
        assert!(what.contains("more than 1000000"), "{what}");
        let (_, _, what) = made(&grains(huge, Some(10))).unwrap_err();
        assert!(what.contains("a layer of the region takes more"), "{what}");
    }
}
