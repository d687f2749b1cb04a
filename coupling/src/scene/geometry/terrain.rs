//! The lie of the land: from rasters, surveys and what was taken out to one surface.

pub mod basin;
pub mod excavation;
pub mod grid;
pub mod outline;
mod plausible;
pub mod sources;
pub mod triangles;

use std::sync::Arc;

use riprap_dda::{Polyhedron, Surface};

use crate::scene::access::Access;
use crate::scene::error::Problem;
use crate::scene::file::vec3;
use crate::scene::file::{
    FailureSurfaceFile, HeightsFile, OutlineFile, ResolutionFile, SceneFile, TerrainFile,
};
use excavation::{Excavated, excavated};
use grid::Grid;
use outline::Outline;
use sources::{Merged, Source, merge};
use triangles::{Triangles, TrianglesError, triangulated};

/// The terrain of a scene.
#[derive(Clone, Debug)]
pub struct Terrain {
    /// Heights before anything was taken out; m.
    pub grid: Grid,
    /// The ground as blocks and water meet it.
    pub surface: Arc<Surface>,
    /// Rock of the slides, in the order of the scene.
    pub rock: Vec<Rock>,
    /// Warnings.
    pub questions: Vec<Problem>,
    /// Points that lay in gaps of the sources.
    pub n_filled: usize,
}

/// Rock taken out of the ground.
#[derive(Clone, Debug)]
pub struct Rock {
    /// Of the slide.
    pub name: String,
    /// Of the slide.
    pub material: String,
    /// Convex bodies that adjoin.
    pub bodies: Vec<Polyhedron>,
    /// Area times mean thickness, triangle by triangle; m³.
    pub volume: f64,
}

/// Triangles are off the points of the grid by no more than this where the scene does not say; × spacing.
const TOLERANCE: f64 = 0.01;
/// Terrain finer than this is lost on the water; × particle spacing.
const FINEST_FOR_WATER: f64 = 0.2;

/// A failure surface.
enum Beneath {
    /// Height at x = y = 0 (m) and slopes along x and y.
    Plane { height: f64, slope: [f64; 2] },
    /// Heights of a raster.
    Raster(Source),
}

impl Beneath {
    /// m.
    fn height(&self, [x, y]: [f64; 2]) -> Option<f64> {
        match self {
            Self::Plane { height, slope } => Some(height + slope[0] * x + slope[1] * y),
            Self::Raster(source) => source.height([x, y]),
        }
    }
}

/// The terrain that a scene asks for, with the rock of its slides; what is chosen is written into the file.
///
/// # Errors
///
/// Problems of the sources, the outlines and the failure surfaces.
pub fn resolve(file: &mut SceneFile, access: &Access) -> Result<Option<Terrain>, Vec<Problem>> {
    let water_spacing = match file.fluid.as_ref().map(|fluid| &fluid.resolution) {
        Some(ResolutionFile::Spacing(spacing)) => Some(*spacing),
        _ => None,
    };
    let slides = file.slides.clone();
    let Some(terrain) = &mut file.terrain else {
        return Ok(None);
    };
    let mut problems = Vec::new();
    let mut sources = Vec::new();
    for (k, source) in terrain.sources.iter().enumerate() {
        match Source::read(source, terrain.origin, access) {
            Ok(source) => sources.push(source),
            Err(error) => problems.push(Problem::error(
                format!("terrain.sources[{k}].file"),
                error.to_string(),
            )),
        }
    }
    let asked = terrain
        .excavations
        .iter()
        .map(|e| (&e.outline, &e.failure_surface));
    let asked = asked
        .enumerate()
        .map(|(k, of)| (format!("terrain.excavations[{k}]"), of));
    let of_slides = slides.iter().map(|s| (&s.outline, &s.failure_surface));
    let of_slides = of_slides
        .enumerate()
        .map(|(k, of)| (format!("slides[{k}]"), of));
    let mut holes = Vec::new();
    for (path, (outline, beneath)) in asked.chain(of_slides) {
        match hole(&path, (outline, beneath), terrain, access) {
            Ok((outline, beneath)) => holes.push((path, outline, beneath)),
            Err(problem) => problems.push(problem),
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let spacing = *terrain
        .spacing
        .get_or_insert_with(|| chosen_spacing(&sources, water_spacing));
    let tolerance = *terrain.tolerance.get_or_insert(TOLERANCE * spacing);
    if !(spacing.is_finite() && spacing > 0.0) {
        let what =
            "a survey has no points at a distance of its own; give the spacing of the terrain";
        return Err(vec![Problem::error("terrain.spacing", what)]);
    }
    let Merged { grid, n_filled } = merge(terrain, &sources, spacing).map_err(|p| vec![p])?;
    let questions = plausible::questions(&grid, terrain);
    let n_excavations = terrain.excavations.len();
    let (surface, rock) = dug(&grid, &holes, tolerance)?;
    let of_slides = rock.into_iter().skip(n_excavations).zip(slides);
    Ok(Some(Terrain {
        grid,
        surface: Arc::new(surface),
        rock: of_slides
            .map(|((bodies, volume), slide)| Rock {
                name: slide.name,
                material: slide.material,
                bodies,
                volume,
            })
            .collect(),
        questions,
        n_filled,
    }))
}

/// That of the first raster; not much finer than the water.
fn chosen_spacing(sources: &[Source], water_spacing: Option<f64>) -> f64 {
    let own = sources.iter().find_map(Source::spacing);
    let finest = water_spacing.map_or(0.0, |spacing| FINEST_FOR_WATER * spacing);
    own.map_or(f64::NAN, |own| own.max(finest))
}

fn hole(
    path: &str,
    (outline, beneath): (&OutlineFile, &FailureSurfaceFile),
    terrain: &TerrainFile,
    access: &Access,
) -> Result<(Outline, Beneath), Problem> {
    let origin = terrain.origin;
    let outline = Outline::read(outline, (origin.0, origin.1), access)
        .map_err(|what| Problem::error(format!("{path}.outline"), what))?;
    let beneath = match beneath {
        FailureSurfaceFile::Plane {
            point,
            dip_deg,
            dip_direction_deg,
        } => {
            let steepness = dip_deg.to_radians().tan();
            let direction = dip_direction_deg.to_radians();
            let slope = [-steepness * direction.sin(), -steepness * direction.cos()];
            let point = vec3(*point);
            Beneath::Plane {
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
            };
            let source = Source::read(&heights, origin, access).map_err(|error| {
                Problem::error(format!("{path}.failure_surface.file"), error.to_string())
            })?;
            Beneath::Raster(source)
        }
    };
    Ok((outline, beneath))
}

/// Rock in convex bodies, and its volume; m³.
type Piece = (Vec<Polyhedron>, f64);

/// The ground without what is above the failure surfaces, and what that is.
fn dug(
    grid: &Grid,
    holes: &[(String, Outline, Beneath)],
    tolerance: f64,
) -> Result<(Surface, Vec<Piece>), Vec<Problem>> {
    let outlines: Vec<Outline> = holes
        .iter()
        .map(|(_, outline, _)| outline.clone())
        .collect();
    let height = |hole: usize, place| holes[hole].2.height(place).unwrap_or(f64::NAN);
    let of_outline = |outline: usize, error: &TrianglesError| {
        Problem::error(format!("{}.outline", holes[outline].0), error.to_string())
    };
    let triangles: Triangles =
        triangulated(grid, &outlines, height, tolerance).map_err(|error| {
            vec![match &error {
                TrianglesError::Crossing { outline, .. }
                | TrianglesError::Overlap { outline, .. }
                | TrianglesError::Outside { outline, .. } => of_outline(*outline, &error),
                TrianglesError::Place(_) => Problem::error("terrain", error.to_string()),
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
                return Err(vec![Problem::error(path, what)]);
            }
        }
    }
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
            problems.push(Problem::error(format!("{path}.failure_surface"), what));
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let surface = Surface::new(points, triangles).map_err(|error| {
        vec![Problem::error(
            "terrain",
            format!("is not a valid surface: {error}"),
        )]
    })?;
    Ok((surface, rock.into_iter().zip(volumes).collect()))
}
