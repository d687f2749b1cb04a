//! Digital terrain model: rasters, surveys and excavations as one surface.

pub mod basin;
pub mod excavation;
pub mod grid;
pub mod outline;
mod plausible;
pub mod sources;
mod system;
pub mod tolerance;
pub mod triangles;

use std::sync::Arc;
use std::time::{Duration, Instant};

use riprap_dda::{Polyhedron, Surface};

use crate::messages::Code;
use crate::scene::access::Access;
use crate::scene::error::Problem;
use crate::scene::file::{
    BlockFile, FailureSurfaceFile, FluidFile, HeightsFile, OutlineFile, ResolutionFile, SceneFile,
    ShapeFile, SlideFile, TerrainFile, Triple, vec3,
};
use crate::scene::geometry::cloud::CloudReport;
use crate::scene::geometry::crs::{Content, Crs};
use excavation::{Excavated, excavated};
use grid::Grid;
use outline::Outline;
use sources::{Merged, Source, merge};
use system::Named;
use tolerance::ToleranceOf;
use triangles::{Quality, Triangles, TrianglesError, triangulated};

/// The terrain of a scene.
#[derive(Clone, Debug)]
pub struct Terrain {
    /// Elevations before any excavation; m.
    pub grid: Grid,
    /// The ground.
    pub surface: Arc<Surface>,
    /// Tolerance of the distance of the triangles from the points of the grid; m.
    pub tolerance: f64,
    /// Origin of the tolerance.
    pub tolerance_of: ToleranceOf,
    /// Errors and angles of the triangles before any excavation.
    pub quality: Quality,
    /// Whether rock is taken out of it.
    pub is_excavated: bool,
    /// Time that reading and triangulation took.
    pub making: Making,
    /// Map coordinates of x = y = 0 in the scene, and the elevation of z = 0; m.
    pub origin: Triple,
    /// Reference system of the map, if known.
    pub crs: Option<Crs>,
    /// Number of the material of the ground; `None` if no block has the shape `Terrain`.
    pub material: Option<usize>,
    /// Rock of the slides, in the order of the scene.
    pub rock: Vec<Rock>,
    /// Doubtful points.
    pub warnings: Vec<Problem>,
    /// Mean slopes within the outline of each slide, where points of the grid lie in it.
    pub slopes: Vec<Option<Slopes>>,
    /// Points filled in gaps of the sources.
    pub n_filled: usize,
    /// Clouds among the sources: file and properties.
    pub clouds: Vec<(String, CloudReport)>,
}

/// Wall time of making a terrain.
#[derive(Clone, Copy, Debug)]
pub struct Making {
    /// Files read and merged.
    pub reading: Duration,
    /// Triangles, excavations and surface.
    pub triangles: Duration,
}

/// Slopes along x and y of the planes through the ground and through the failure surface of a slide.
#[derive(Clone, Copy, Debug)]
pub struct Slopes {
    /// Of the ground; –.
    pub ground: [f64; 2],
    /// Of the failure surface; –.
    pub failure: [f64; 2],
}

/// Rock of a slide.
#[derive(Clone, Debug)]
pub struct Rock {
    /// Name of the slide.
    pub name: String,
    /// Number of its material.
    pub material: Option<usize>,
    /// Adjoining convex bodies.
    pub bodies: Vec<Polyhedron>,
    /// Area times mean thickness, triangle by triangle; m³.
    pub volume: f64,
}

/// Finest useful spacing of the terrain; × particle spacing.
const FINEST_FOR_WATER: f64 = 0.2;

/// Base of an excavation.
enum Base {
    /// Plane: elevation at x = y = 0 (m) and slopes along x and y.
    Plane { height: f64, slope: [f64; 2] },
    /// Heights of a raster.
    Raster(Source),
}

impl Base {
    /// Elevation at a point in plan view; m.
    fn height(&self, [x, y]: [f64; 2]) -> Option<f64> {
        match self {
            Self::Plane { height, slope } => Some(height + slope[0] * x + slope[1] * y),
            Self::Raster(source) => source.height([x, y]),
        }
    }
}

/// Terrain of a scene, with the rock of its slides.
///
/// # Errors
///
/// Problems of the sources, the outlines and the failure surfaces.
pub fn resolve(file: &SceneFile, access: &Access) -> Result<Option<Terrain>, Vec<Problem>> {
    let Some(terrain) = &file.terrain else {
        return Ok(None);
    };
    let start = Instant::now();
    let sources = sources_of(terrain, access);
    let holes = holes_of(terrain, &file.slides, access);
    let (sources, (holes, drawn)) = match (sources, holes) {
        (Ok(sources), Ok(holes)) => (sources, holes),
        (sources, holes) => {
            let found = sources.err().into_iter().chain(holes.err());
            return Err(found.flatten().collect());
        }
    };
    let mut named = named(&sources, &holes);
    named.extend(drawn);
    let crs = system::common(terrain, &named).map_err(|problem| vec![problem])?;
    let spacing =
        (terrain.spacing).unwrap_or_else(|| chosen_spacing(&sources, file.fluid.as_ref()));
    if !(spacing.is_finite() && spacing > 0.0) {
        let what = "a survey has no points at a regular distance; give the spacing of the terrain";
        return Err(vec![Problem::error(
            Code::UnusableTerrainSpacing,
            "terrain.spacing",
            what,
        )]);
    }
    let Merged { grid, n_filled } = merge(terrain, &sources, spacing).map_err(|p| vec![p])?;
    let mut warnings = plausible::warnings(&grid, terrain);
    warnings.extend(steps(&sources));
    let clouds = (sources.iter()).filter_map(|s| Some((s.file.clone(), s.cloud.clone()?)));
    let of_tolerance = ToleranceOf::of(file, &grid);
    let tolerance = of_tolerance.tolerance();
    let read = Instant::now();
    let Ground {
        surface,
        quality,
        pieces,
    } = excavate(&grid, &holes, tolerance)?;
    let making = Making {
        reading: read - start,
        triangles: read.elapsed(),
    };
    let material = |name: &str| file.materials.iter().position(|m| m.name == name);
    let is_ground = |block: &&BlockFile| matches!(block.shape, ShapeFile::Terrain);
    let n_excavations = terrain.excavations.len();
    let slopes = holes[n_excavations..].iter().map(|(_, outline, base)| {
        let ground = |point| Some(grid.heights[grid.index(point)]);
        Some(Slopes {
            ground: grid.mean_slope(outline, ground)?,
            failure: grid.mean_slope(outline, |point| base.height(grid.place(point)))?,
        })
    });
    let slopes = slopes.collect();
    let of_slides = pieces.into_iter().skip(n_excavations);
    let rock = of_slides.zip(&file.slides);
    Ok(Some(Terrain {
        grid,
        tolerance,
        tolerance_of: of_tolerance,
        quality,
        is_excavated: !holes.is_empty(),
        making,
        origin: terrain.origin,
        crs,
        material: (file.blocks.iter().find(is_ground)).and_then(|block| material(&block.material)),
        surface: Arc::new(surface),
        rock: rock
            .map(|((bodies, volume), slide)| Rock {
                name: slide.name.clone(),
                material: material(&slide.material),
                bodies,
                volume,
            })
            .collect(),
        warnings,
        slopes,
        n_filled,
        clouds: clouds.collect(),
    }))
}

fn sources_of(terrain: &TerrainFile, access: &Access) -> Result<Vec<Source>, Vec<Problem>> {
    let mut problems = Vec::new();
    let mut sources = Vec::new();
    for (k, source) in terrain.sources.iter().enumerate() {
        match Source::read(source, terrain.origin, access) {
            Ok(source) => sources.push(source),
            Err(error) => problems.push(Problem::error(
                error.fault.code(),
                format!("terrain.sources[{k}].file"),
                error.to_string(),
            )),
        }
    }
    if problems.is_empty() {
        Ok(sources)
    } else {
        Err(problems)
    }
}

/// Warnings of clouds with several heights at one place.
fn steps(sources: &[Source]) -> Vec<Problem> {
    let told = sources.iter().enumerate().filter_map(|(k, source)| {
        let steps = source.cloud.as_ref()?.steps;
        (steps.n > 0).then(|| {
            let what = format!(
                "`{}`: has points one above the other at {} places, at ({:.2}, {:.2}) {:.3} m apart; the median is taken: are all points of the ground?",
                source.file, steps.n, steps.at[0], steps.at[1], steps.largest
            );
            Problem::warning(Code::SuspiciousTerrain, format!("terrain.sources[{k}].file"), what)
        })
    });
    told.collect()
}

/// An excavation: its path in the file, its outline and its base.
type Hole = (String, Outline, Base);

/// Reference systems of the rasters.
fn named(sources: &[Source], holes: &[Hole]) -> Vec<Named> {
    let raster = |path: String, source: &Source| {
        let of_cloud = source.cloud.as_ref().map(|_| Content::Cloud);
        Some(Named {
            path,
            file: source.file.clone(),
            content: of_cloud.unwrap_or(Content::Raster),
            crs: source.crs.clone()?,
        })
    };
    let of_sources = (sources.iter().enumerate())
        .filter_map(|(k, source)| raster(format!("terrain.sources[{k}].file"), source));
    let of_bases = holes.iter().filter_map(|(path, _, base)| match base {
        Base::Raster(source) => raster(format!("{path}.failure_surface.file"), source),
        Base::Plane { .. } => None,
    });
    of_sources.chain(of_bases).collect()
}

/// Excavations of the terrain, then those of the slides; and the systems of their outlines.
fn holes_of(
    terrain: &TerrainFile,
    slides: &[SlideFile],
    access: &Access,
) -> Result<(Vec<Hole>, Vec<Named>), Vec<Problem>> {
    let excavations = (terrain.excavations.iter().enumerate()).map(|(k, e)| {
        let path = format!("terrain.excavations[{k}]");
        (path, (&e.outline, &e.failure_surface))
    });
    let of_slides = (slides.iter().enumerate())
        .map(|(k, s)| (format!("slides[{k}]"), (&s.outline, &s.failure_surface)));
    let mut problems = Vec::new();
    let (mut holes, mut drawn) = (Vec::new(), Vec::new());
    for (path, (outline, base)) in excavations.chain(of_slides) {
        match hole(&path, (outline, base), terrain, access) {
            Ok((outline, base, system)) => {
                holes.push((path, outline, base));
                drawn.extend(system);
            }
            Err(problem) => problems.push(problem),
        }
    }
    if problems.is_empty() {
        Ok((holes, drawn))
    } else {
        Err(problems)
    }
}

/// Spacing of the first raster, but not much finer than the water; m.
fn chosen_spacing(sources: &[Source], fluid: Option<&FluidFile>) -> f64 {
    let own = sources.iter().find_map(Source::spacing);
    let finest = match fluid.map(|fluid| fluid.resolution) {
        Some(ResolutionFile::Spacing(spacing)) => FINEST_FOR_WATER * spacing,
        Some(ResolutionFile::Count(_)) | None => 0.0,
    };
    own.map_or(f64::NAN, |own| own.max(finest))
}

fn hole(
    path: &str,
    (outline, base): (&OutlineFile, &FailureSurfaceFile),
    terrain: &TerrainFile,
    access: &Access,
) -> Result<(Outline, Base, Option<Named>), Problem> {
    let origin = terrain.origin;
    let drawn = outline;
    let (outline, crs) = Outline::read(drawn, origin, access)
        .map_err(|what| Problem::error(Code::UnusableOutline, format!("{path}.outline"), what))?;
    let system = match (drawn, crs) {
        (OutlineFile::File(file), Some(crs)) => Some(Named {
            path: format!("{path}.outline"),
            file: file.clone(),
            content: Content::Features,
            crs,
        }),
        _ => None,
    };
    let base = match base {
        FailureSurfaceFile::Plane {
            point,
            dip_deg,
            dip_direction_deg,
        } => {
            let steepness = dip_deg.to_radians().tan();
            let direction = dip_direction_deg.to_radians();
            let slope = [-steepness * direction.sin(), -steepness * direction.cos()];
            let point = vec3(*point);
            Base::Plane {
                height: point.z - slope[0] * point.x - slope[1] * point.y,
                slope,
            }
        }
        FailureSurfaceFile::Raster {
            file,
            height_scale,
            height_shift,
        } => {
            let heights = HeightsFile {
                file: file.clone(),
                height_scale: *height_scale,
                height_shift: *height_shift,
                heights: None,
                cell: None,
            };
            let source = Source::read(&heights, origin, access).map_err(|error| {
                Problem::error(
                    error.fault.code(),
                    format!("{path}.failure_surface.file"),
                    error.to_string(),
                )
            })?;
            Base::Raster(source)
        }
    };
    Ok((outline, base, system))
}

/// Rock as convex bodies, and its volume; m³.
type Piece = (Vec<Polyhedron>, f64);

/// The ground without the rock above the failure surfaces, and that rock.
struct Ground {
    surface: Surface,
    quality: Quality,
    pieces: Vec<Piece>,
}

/// Triangulates a grid and excavates the rock above the failure surfaces.
fn excavate(grid: &Grid, holes: &[Hole], tolerance: f64) -> Result<Ground, Vec<Problem>> {
    let outlines: Vec<Outline> = holes
        .iter()
        .map(|(_, outline, _)| outline.clone())
        .collect();
    let height = |hole: usize, place| holes[hole].2.height(place).unwrap_or(f64::NAN);
    let of_outline = |outline: usize, error: &TrianglesError| {
        Problem::error(
            Code::UnusableOutline,
            format!("{}.outline", holes[outline].0),
            error.to_string(),
        )
    };
    let triangles: Triangles =
        triangulated(grid, &outlines, height, tolerance).map_err(|error| {
            vec![match &error {
                TrianglesError::Crossing { outline, .. }
                | TrianglesError::Overlap { outline, .. }
                | TrianglesError::Outside { outline, .. } => of_outline(*outline, &error),
                TrianglesError::Place(_) => {
                    Problem::error(Code::UnusableFile, "terrain", error.to_string())
                }
            }]
        })?;
    for (corners, outline) in triangles.corners.iter().zip(&triangles.outline) {
        for (hole, corner) in outline
            .iter()
            .flat_map(|&o| corners.map(|corner| (o, corner)))
        {
            let x = triangles.points[corner as usize];
            if height(hole, [x.x, x.y]).is_nan() {
                let what = format!(
                    "the failure surface has no height at ({:.2}, {:.2}) m, within the outline",
                    x.x, x.y
                );
                let path = format!("{}.failure_surface", holes[hole].0);
                return Err(vec![Problem::error(
                    Code::FailureSurfaceMisplaced,
                    path,
                    what,
                )]);
            }
        }
    }
    let quality = triangles.quality;
    let Excavated {
        points,
        triangles,
        rock,
        volumes,
        lost,
    } = excavated(&triangles, holes.len(), height);
    let mut problems = Vec::new();
    for (((path, ..), volume), lost) in holes.iter().zip(&volumes).zip(&lost) {
        if !(*volume > *lost) {
            let what = "the failure surface is nowhere below the terrain within the outline; lower it, or move the outline";
            problems.push(Problem::error(
                Code::FailureSurfaceMisplaced,
                format!("{path}.failure_surface"),
                what,
            ));
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let surface = Surface::new(points, triangles).map_err(|error| {
        vec![Problem::error(
            Code::UnusableFile,
            "terrain",
            format!("is not a valid surface: {error}"),
        )]
    })?;
    Ok(Ground {
        surface,
        quality,
        pieces: rock.into_iter().zip(volumes).collect(),
    })
}
