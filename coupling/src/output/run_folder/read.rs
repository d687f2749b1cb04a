//! Reading a run folder, while the run is under way, too.

use std::io;
use std::path::{Path, PathBuf};

use super::{CASE, SUMMARY};
use crate::messages::{Code, Coded};
use riprap_dda::Vec3;

use crate::output::bodies;
use crate::scene::file::{Axis, DimensionsFile, ResolutionFile, SceneFile, ShapeFile, Triple};
use crate::scene::resolved::recording::Viewpoint;

/// Failure to read a file of a run folder.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// Unreadable file.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Unexpected contents.
    #[error("{} is not readable: {reason}", path.display())]
    BadFile {
        /// The file.
        path: PathBuf,
        /// Fault of the contents.
        reason: String,
    },
}

/// Width of a slab that repeats, over its length, below which it is thin.
const THIN: f64 = 0.05;

/// Parts of the archived scene that a picture needs.
#[derive(Clone, Debug)]
pub struct RunScene {
    /// Title.
    pub title: String,
    /// Camera, if the scene sets one.
    pub camera: Option<Viewpoint>,
    /// Whether each block that the scene lists is terrain; blocks of slides, rock masses and grains follow and are not.
    pub is_terrain: Vec<bool>,
    /// Particle spacing as written, if it is; m.
    pub particle_spacing: Option<f64>,
    /// Mean distance of the particles in frames over the spacing: above 1 where they are thinned out; –.
    pub thinning: f64,
    /// Corners of the domain; m.
    pub domain: (Vec3, Vec3),
    /// Whether the flow is in a plane.
    pub is_plane: bool,
    /// Whether it is seen from the side as a whole: a plane, or a thin slab that repeats.
    pub is_thin: bool,
    /// Name of each block; empty without.
    pub block_names: Vec<String>,
    /// Group of each block; empty without one.
    pub groups: Vec<String>,
    /// Name of the material of each block.
    pub materials: Vec<String>,
    /// Size of the acceleration of gravity; m/s².
    pub gravity: f64,
    /// Map coordinates of (0, 0, 0) in the scene, and the reference system as written; m.
    pub map: (Triple, Option<String>),
}

/// Reads `case.ron`.
///
/// # Errors
///
/// [`ReadError`] names the file.
pub fn read_scene(folder: &Path) -> Result<RunScene, ReadError> {
    let path = folder.join(CASE);
    let options =
        ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let file: SceneFile =
        options
            .from_str(&text_of(&path)?)
            .map_err(|error| ReadError::BadFile {
                path,
                reason: error.to_string(),
            })?;
    let is_terrain =
        |shape: &ShapeFile| matches!(shape, ShapeFile::Raster { .. } | ShapeFile::Terrain);
    let corner = |(x, y, z): Triple| Vec3::new(x, y, z);
    let is_plane = file.domain.dimensions == DimensionsFile::Two;
    let (width, length) = (
        file.domain.max.1 - file.domain.min.1,
        file.domain.max.0 - file.domain.min.0,
    );
    let bodies = bodies_of(folder, &file);
    let map = file.terrain.as_ref().map(|t| (t.origin, t.crs.clone()));
    Ok(RunScene {
        map: map.unwrap_or_default(),
        domain: (corner(file.domain.min), corner(file.domain.max)),
        is_plane,
        thinning: {
            let stride = file.output.water.stride.unwrap_or(1).max(1);
            f64::from(stride).powf(if is_plane { 1.0 / 2.0 } else { 1.0 / 3.0 })
        },
        is_thin: is_plane || (file.domain.periodic.contains(&Axis::Y) && width < THIN * length),
        block_names: bodies.iter().map(|row| row.name.clone()).collect(),
        groups: bodies.iter().map(|row| row.group.clone()).collect(),
        materials: bodies.into_iter().map(|row| row.material).collect(),
        gravity: corner(file.gravity).norm(),
        title: file.title,
        camera: file.camera.as_ref().map(Viewpoint::from),
        is_terrain: file.blocks.iter().map(|b| is_terrain(&b.shape)).collect(),
        particle_spacing: file.fluid.and_then(|fluid| match fluid.resolution {
            ResolutionFile::Spacing(spacing) => Some(spacing),
            ResolutionFile::Count(_) => None,
        }),
    })
}

/// Name, group and material of each block.
struct Label {
    name: String,
    group: String,
    material: String,
}

/// Labels of all blocks; without `bodies.csv`, as in older folders, of those that the scene lists, which were all then.
fn bodies_of(folder: &Path, file: &SceneFile) -> Vec<Label> {
    let bodies = bodies::read(folder).unwrap_or_default();
    if bodies.is_empty() {
        let listed = file.blocks.iter().map(|block| Label {
            name: block.name.clone(),
            group: block.group.clone().unwrap_or_default(),
            material: block.material.clone(),
        });
        return listed.collect();
    }
    let labels = bodies.into_iter().map(|row| Label {
        name: row.name,
        group: row.group,
        material: row.material,
    });
    labels.collect()
}

/// Reads `summary.json`; absent before the end of a run.
///
/// # Errors
///
/// [`ReadError`] names the file.
pub fn read_summary(folder: &Path) -> Result<Option<serde_json::Value>, ReadError> {
    let path = folder.join(SUMMARY);
    if !path.exists() {
        return Ok(None);
    }
    let summary = serde_json::from_str(&text_of(&path)?);
    summary.map(Some).map_err(|error| ReadError::BadFile {
        path,
        reason: error.to_string(),
    })
}

fn text_of(path: &Path) -> Result<String, ReadError> {
    std::fs::read_to_string(path).map_err(|source| ReadError::Io {
        path: path.to_owned(),
        source,
    })
}

impl Coded for ReadError {
    fn code(&self) -> Code {
        match self {
            Self::Io { .. } => Code::FileNotReadable,
            Self::BadFile { .. } => Code::UnusableRunFolder,
        }
    }
}
