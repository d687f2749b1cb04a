//! One grid of elevations from rasters and surveys.

use std::path::Path;

use riprap_dda::{Shape, Vec3};

use super::grid::Grid;
use crate::messages::Code;
use crate::scene::access::Access;
use crate::scene::access::fault::{Fault, MeshError};
use crate::scene::error::Problem;
use crate::scene::file::{GapsFile, HeightsFile, TerrainFile};
use crate::scene::geometry::cloud::{self, CloudReport};
use crate::scene::geometry::crs::{Content, Crs};
use crate::scene::geometry::mesh;
use crate::scene::geometry::raster::{self, refuse_degrees};
use crate::world::ground::Ground;

/// Largest number of points.
const MOST_POINTS: f64 = 4e6;
/// Largest number of points of a source along each axis in the average of a coarser point.
const MOST_SAMPLES: f64 = 16.0;
/// Tolerance of round-off at the edge of a grid; × spacing.
const ROUND_OFF: f64 = 1e-6;
/// Smoothing sweeps of filled gaps: a membrane over some tens of points.
const MEMBRANE_SWEEPS: usize = 200;

/// Elevations of a file, in the coordinates of the scene.
#[derive(Clone, Debug)]
pub struct Source {
    /// The file as the scene names it.
    pub file: String,
    /// Reference system of its map, if known.
    pub crs: Option<Crs>,
    /// Properties of a cloud.
    pub cloud: Option<CloudReport>,
    heights: Heights,
    /// Range outside of which elevations are missing; m.
    range: (f64, f64),
}

#[derive(Clone, Debug)]
enum Heights {
    Raster(Grid),
    Survey {
        ground: Ground,
        /// Smallest and largest x and y; m.
        extent: [[f64; 2]; 2],
    },
}

impl Source {
    /// Reads a file that the scene names; `origin` is the origin of the scene on the map.
    ///
    /// # Errors
    ///
    /// [`MeshError`], which names the file, the location and the remedy.
    pub fn read(
        file: &HeightsFile,
        origin: (f64, f64, f64),
        access: &Access,
    ) -> Result<Self, MeshError> {
        let place = |z: f64| file.height_scale * z + file.height_shift - origin.2;
        let (mut crs, mut cloud) = (None, None);
        let is_cloud = is_cloud(access, &file.file);
        if file.cell.is_some() && !is_cloud {
            let what = "has a `cell`, which is of clouds of points (.xyz, .csv, .txt, .las, .laz); leave it out";
            return Err(refused(&file.file, Fault::Format(what.into())));
        }
        let heights = if is_cloud || is_raster(&file.file) {
            let raster = if is_cloud {
                let points = cloud::read(access, &file.file)?;
                let (raster, report) = points
                    .grid(file.cell)
                    .map_err(|fault| refused(&file.file, fault))?;
                cloud = Some(report);
                raster
            } else {
                raster::read(access, &file.file)?
            };
            crs = raster.crs;
            let mut grid = raster.grid;
            for height in &mut grid.heights {
                *height = place(*height);
            }
            if crs.is_none() {
                let content = if is_cloud {
                    Content::Cloud
                } else {
                    Content::Raster
                };
                refuse_degrees(&grid, content).map_err(|fault| refused(&file.file, fault))?;
            }
            grid.shift([-origin.0, -origin.1]);
            Heights::Raster(grid)
        } else {
            let Shape::Surface(surface) = mesh::surface(access, &file.file, 1.0)? else {
                return Err(refused(&file.file, Fault::Empty));
            };
            let corner = |v: u32| {
                let mut x = surface.vertices()[v as usize];
                (x.x, x.y, x.z) = (x.x - origin.0, x.y - origin.1, place(x.z));
                x
            };
            let triangles = surface.triangles().iter().map(|t| t.map(corner));
            let ground = Ground::over(triangles.collect());
            if ground.is_empty() {
                let what = "no triangle looks up; turn the normals round";
                return Err(refused(&file.file, Fault::Format(what.into())));
            }
            let (low, high) = surface.aabb();
            let extent = [
                [low.x - origin.0, low.y - origin.1],
                [high.x - origin.0, high.y - origin.1],
            ];
            Heights::Survey { ground, extent }
        };
        Ok(Self {
            file: file.file.clone(),
            crs,
            cloud,
            heights,
            range: file
                .heights
                .map_or((f64::NEG_INFINITY, f64::INFINITY), |(low, high)| {
                    (low - origin.2, high - origin.2)
                }),
        })
    }

    /// Reads a file in map coordinates, with its elevations as they are.
    ///
    /// # Errors
    ///
    /// As [`Source::read`].
    pub fn on_map(name: &str, access: &Access) -> Result<Self, MeshError> {
        let file = HeightsFile {
            file: name.to_owned(),
            height_scale: 1.0,
            height_shift: 0.0,
            heights: None,
            cell: None,
        };
        Self::read(&file, (0.0, 0.0, 0.0), access)
    }

    /// Highest of some triangles (m) at each place, as a source of a name; `None` if none looks up.
    pub fn of_triangles(file: String, triangles: Vec<[Vec3; 3]>, crs: Option<Crs>) -> Option<Self> {
        let corners = triangles.iter().flatten();
        let nothing = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let (low, high) = corners.fold(nothing, |(low, high), x| {
            (
                [low[0].min(x.x), low[1].min(x.y)],
                [high[0].max(x.x), high[1].max(x.y)],
            )
        });
        let ground = Ground::over(triangles);
        (!ground.is_empty()).then_some(Self {
            file,
            crs,
            cloud: None,
            heights: Heights::Survey {
                ground,
                extent: [low, high],
            },
            range: (f64::NEG_INFINITY, f64::INFINITY),
        })
    }

    /// Elevation at a position in plan view, `None` where missing; m.
    pub fn height(&self, place: [f64; 2]) -> Option<f64> {
        let height = match &self.heights {
            Heights::Raster(grid) => grid.height(place),
            Heights::Survey { ground, .. } => ground.height_under_the_sky(place),
        };
        height.filter(|z| self.range.0 <= *z && *z <= self.range.1)
    }

    /// Smallest and largest x and y; m.
    pub fn extent(&self) -> [[f64; 2]; 2] {
        match &self.heights {
            Heights::Raster(grid) => [grid.corner, grid.far_corner()],
            Heights::Survey { extent, .. } => *extent,
        }
    }

    /// Spacing of the points; `None` for surveys; m.
    pub fn spacing(&self) -> Option<f64> {
        match &self.heights {
            Heights::Raster(grid) => Some(grid.spacing),
            Heights::Survey { .. } => None,
        }
    }
}

fn refused(file: &str, fault: Fault) -> MeshError {
    MeshError {
        file: file.to_owned(),
        fault,
    }
}

fn extension(file: &str) -> String {
    let extension = Path::new(file).extension().unwrap_or_default();
    extension.to_string_lossy().to_lowercase()
}

fn is_cloud(access: &Access, file: &str) -> bool {
    cloud::is_cloud(&extension(file), || access.read(file).ok())
}

/// Whether the name of a file is that of elevations and of no table.
pub fn is_surface(file: &str) -> bool {
    let extension = extension(file);
    let others = [
        "xyz", "las", "laz", "stl", "obj", "ply", "vtk", "vtp", "vtu",
    ];
    others.contains(&extension.as_str()) || (is_raster(file) && extension != "txt")
}

fn is_raster(file: &str) -> bool {
    matches!(
        extension(file).as_str(),
        "asc" | "tif" | "tiff" | "txt" | "grd"
    )
}

/// Elevations of a scene.
#[derive(Clone, Debug)]
pub struct Merged {
    /// Grid without gaps.
    pub grid: Grid,
    /// Number of points filled in gaps.
    pub n_filled: usize,
}

/// Samples sources at the points of the scene, `spacing` (m) apart.
///
/// Points of a raster keep their positions if the spacing is the same; a coarser point has the mean over its square.
///
/// # Errors
///
/// A [`Problem`] for an extent without points and for points without an elevation.
pub fn merge(file: &TerrainFile, sources: &[Source], spacing: f64) -> Result<Merged, Problem> {
    let Some(first) = sources.first() else {
        return Err(Problem::error(
            Code::EmptyList,
            "terrain.sources",
            "the terrain has no source; name a raster or a survey",
        ));
    };
    let mut grid = lattice(file, first, spacing)?;
    for point in grid.points() {
        let k = grid.index(point);
        let place = grid.place(point);
        grid.heights[k] = sample(sources, place, spacing).unwrap_or(f64::NAN);
    }
    let n_filled = fill_gaps(&mut grid, file)?;
    Ok(Merged { grid, n_filled })
}

/// Points aligned with the first source, within the clip.
fn lattice(file: &TerrainFile, first: &Source, spacing: f64) -> Result<Grid, Problem> {
    let own = first.extent();
    let [low, high] = file
        .clip
        .map_or(own, |(min, max)| [[min.0, min.1], [max.0, max.1]]);
    let mut n = [0; 2];
    let mut corner = [0.0; 2];
    for axis in 0..2 {
        let start = ((low[axis] - own[0][axis]) / spacing - ROUND_OFF).ceil();
        corner[axis] = own[0][axis] + start * spacing;
        let count = ((high[axis] - corner[axis]) / spacing + ROUND_OFF).floor() + 1.0;
        if !(2.0..=MOST_POINTS).contains(&count) {
            let what = format!(
                "{} m from {} to {} m make {} points at a spacing of {spacing} m, needed are 2 to {MOST_POINTS:.0}",
                high[axis] - low[axis],
                low[axis],
                high[axis],
                count.max(0.0)
            );
            let field = if file.clip.is_some() {
                "clip"
            } else {
                "spacing"
            };
            return Err(Problem::error(
                Code::UnusableTerrainSpacing,
                format!("terrain.{field}"),
                what,
            ));
        }
        n[axis] = count as usize;
    }
    if n[0] as f64 * n[1] as f64 > MOST_POINTS {
        let what = format!(
            "{} x {} points of terrain are more than {MOST_POINTS:.0}; raise the spacing above {spacing} m, or clip what is not needed",
            n[0], n[1]
        );
        return Err(Problem::error(
            Code::UnusableTerrainSpacing,
            "terrain.spacing",
            what,
        ));
    }
    Ok(Grid {
        n,
        corner,
        spacing,
        heights: vec![f64::NAN; n[0] * n[1]],
    })
}

/// Elevation of a point that represents a square, from the first source with a value there, averaged where the source is
/// finer; m.
fn sample(sources: &[Source], place: [f64; 2], spacing: f64) -> Option<f64> {
    let (source, middle) = sources
        .iter()
        .find_map(|source| Some((source, source.height(place)?)))?;
    let finer = spacing / source.spacing().unwrap_or(spacing);
    let n = finer.min(MOST_SAMPLES).round() as u32;
    if n < 2 {
        return Some(middle);
    }
    let offset = |k: u32| ((f64::from(k) + 0.5) / f64::from(n) - 0.5) * spacing;
    let (mut sum, mut count) = (0.0, 0.0);
    for j in 0..n {
        for i in 0..n {
            if let Some(z) = source.height([place[0] + offset(i), place[1] + offset(j)]) {
                sum += z;
                count += 1.0;
            }
        }
    }
    Some(if count > 0.0 { sum / count } else { middle })
}

/// Fills missing elevations from those around them, or refuses; returns their number.
fn fill_gaps(grid: &mut Grid, file: &TerrainFile) -> Result<usize, Problem> {
    let missing: Vec<[usize; 2]> = grid
        .points()
        .filter(|&point| grid.heights[grid.index(point)].is_nan())
        .collect();
    let Some(&first) = missing.first() else {
        return Ok(0);
    };
    let described = |grid: &Grid, point: [usize; 2]| {
        let [x, y] = grid.place(point);
        format!(
            "({x:.2}, {y:.2}) m, on the map ({:.2}, {:.2})",
            x + file.origin.0,
            y + file.origin.1
        )
    };
    let GapsFile::Filled(width) = file.gaps else {
        let others = match missing.len() - 1 {
            0 => String::new(),
            n => format!(", nor at {n} more of {} points", grid.heights.len()),
        };
        let what = format!(
            "no source has a height at {}{others}; clip them off, add a source that covers them, or fill gaps with \
             `gaps: Filled(width)`",
            described(grid, first)
        );
        return Err(Problem::error(Code::TerrainGap, "terrain.sources", what));
    };
    // from the rim inward, each the mean of those beside it that are known
    let mut rounds = 0.0;
    let mut open = missing.clone();
    while let Some(&point) = open.first() {
        rounds += 1.0;
        if rounds * grid.spacing > width.max(grid.spacing) {
            let what = format!(
                "the gap at {} is wider than {width} m from its rim; cover it with a source, or allow wider gaps",
                described(grid, point)
            );
            return Err(Problem::error(Code::TerrainGap, "terrain.gaps", what));
        }
        let found: Vec<Option<f64>> = open.iter().map(|&p| mean_beside(grid, p)).collect();
        for (&point, height) in open.iter().zip(&found) {
            let k = grid.index(point);
            grid.heights[k] = height.unwrap_or(f64::NAN);
        }
        let mut is_open = found.iter().map(Option::is_none);
        open.retain(|_| is_open.next() == Some(true));
    }
    for _ in 0..MEMBRANE_SWEEPS {
        for &point in &missing {
            let k = grid.index(point);
            grid.heights[k] = mean_beside(grid, point).unwrap_or(grid.heights[k]);
        }
    }
    Ok(missing.len())
}

/// Mean of the known elevations of the four neighbors of a point; m.
fn mean_beside(grid: &Grid, [i, j]: [usize; 2]) -> Option<f64> {
    let beside = [
        (0 < i).then(|| [i.wrapping_sub(1), j]),
        (i + 1 < grid.n[0]).then_some([i + 1, j]),
        (0 < j).then(|| [i, j.wrapping_sub(1)]),
        (j + 1 < grid.n[1]).then_some([i, j + 1]),
    ];
    let known = beside
        .into_iter()
        .flatten()
        .map(|point| grid.heights[grid.index(point)])
        .filter(|z| z.is_finite());
    let (sum, count) = known.fold((0.0, 0.0), |(sum, count), z| (sum + z, count + 1.0));
    (count > 0.0).then(|| sum / count)
}
