//! Input of `render` from a run folder: read-only, and without blocking the run.

use super::RenderError;
use super::body::{Body, bodies};
use crate::files::vtk::{self, PolyData, Values};
use crate::output::run_folder::{self, RunScene};
use std::fs;
use std::path::{Path, PathBuf};

/// A run folder that can be drawn.
pub(crate) struct Recording {
    /// The frozen scene.
    pub scene: RunScene,
    /// Water files; empty without water.
    pub water: Vec<Timed>,
    /// Files of moving blocks; empty without.
    pub blocks: Vec<Timed>,
    /// Walls and slopes.
    pub fixed: Vec<Body>,
    /// Mean distance of the particles in the frames, from the spacing in `summary.json` or the scene; m.
    pub spacing: Option<f64>,
    /// Faces left out because a corner is not finite.
    pub skipped_faces: usize,
}

/// A file and its simulated time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Timed {
    /// s.
    pub time: f64,
    /// Path.
    pub path: PathBuf,
}

/// Particles at one time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cloud {
    /// Finite points; m.
    pub points: Vec<[f32; 3]>,
    /// One per point; m/s. `None` where the run did not write velocities.
    pub speeds: Option<Vec<f32>>,
    /// Points left out because a coordinate is not finite.
    pub skipped: usize,
}

/// Reads the data shared by all frames, and the list of frames.
pub(crate) fn open(folder: &Path) -> Result<Recording, RenderError> {
    let scene = run_folder::read_scene(folder)?;
    let frames = |stem: &str| collection(&folder.join(format!("{stem}.pvd")));
    let water = frames(run_folder::WATER_FRAMES)?;
    let blocks = frames(run_folder::BLOCK_FRAMES)?;
    if water.is_empty() && blocks.is_empty() {
        return Err(RenderError::NoFrames {
            folder: folder.to_owned(),
        });
    }
    let fixed_path = folder.join(run_folder::FIXED_BLOCKS);
    let (mut fixed, skipped_faces) = if fixed_path.exists() {
        bodies(&read(&fixed_path)?)
    } else {
        (Vec::new(), 0)
    };
    for body in &mut fixed {
        let block = usize::try_from(body.id).ok();
        body.is_terrain = block.is_some_and(|b| scene.is_terrain.get(b) == Some(&true));
    }
    let spacing = spacing(folder, &scene)?.map(|spacing| scene.thinning * spacing);
    Ok(Recording {
        scene,
        water,
        blocks,
        fixed,
        spacing,
        skipped_faces,
    })
}

impl Recording {
    /// Time of the last file of any kind; s.
    pub fn end(&self) -> f64 {
        let last = |files: &[Timed]| files.last().map_or(0.0, |file| file.time);
        last(&self.water).max(last(&self.blocks))
    }

    /// The files that define the frame numbers: the water, or without it the blocks.
    pub fn frames(&self) -> &[Timed] {
        if self.water.is_empty() {
            &self.blocks
        } else {
            &self.water
        }
    }

    /// The particles of a frame.
    pub fn cloud(&self, frame: usize) -> Result<Cloud, RenderError> {
        match self.water.get(frame) {
            Some(file) => Ok(cloud(&read(&file.path)?)),
            None => Ok(Cloud::default()),
        }
    }

    /// The moving blocks at the time nearest to `time`, and the faces left out.
    pub fn blocks_at(&self, time: f64) -> Result<(Vec<Body>, usize), RenderError> {
        let distance = |file: &&Timed| (file.time - time).abs();
        match self
            .blocks
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        {
            Some(file) => Ok(bodies(&read(&file.path)?)),
            None => Ok((Vec::new(), 0)),
        }
    }
}

fn read_text(path: &Path) -> Result<String, RenderError> {
    fs::read_to_string(path).map_err(|source| RenderError::Read {
        path: path.to_owned(),
        source,
    })
}

/// Points and polygons of a file.
pub(crate) fn read(path: &Path) -> Result<PolyData, RenderError> {
    vtk::read(path).map_err(|error| RenderError::BadFile {
        path: path.to_owned(),
        reason: error.to_string(),
    })
}

/// Particle spacing of the summary, which a running job does not have yet, or of the scene; m.
fn spacing(folder: &Path, scene: &RunScene) -> Result<Option<f64>, RenderError> {
    let summary = run_folder::read_summary(folder)?;
    let of_summary = summary.and_then(|summary| summary.get("particle_spacing")?.as_f64());
    let is_usable = |s: &f64| s.is_finite() && 0.0 < *s;
    Ok(of_summary
        .filter(is_usable)
        .or(scene.particle_spacing)
        .filter(is_usable))
}

fn cloud(data: &PolyData) -> Cloud {
    let velocity = data
        .point_data
        .iter()
        .find(|a| a.name == "Velocity" && a.components == 3);
    let speed = |values: &Values, i: usize| -> Option<f32> {
        let norm = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt() as f32;
        let at = 3 * i..3 * i + 3;
        match values {
            Values::F32(v) => <[f32; 3]>::try_from(v.get(at)?)
                .ok()
                .map(|v| norm(v.map(f64::from))),
            Values::F64(v) => <[f64; 3]>::try_from(v.get(at)?).ok().map(norm),
            Values::I32(_) => None,
        }
    };
    let is_finite: Vec<bool> = data
        .points
        .iter()
        .map(|p| p.iter().all(|x| x.is_finite()))
        .collect();
    let kept = || (0..data.points.len()).filter(|&i| is_finite[i]);
    Cloud {
        points: kept().map(|i| data.points[i]).collect(),
        // A non-finite speed is drawn as still water, since the position of the particle is valid.
        speeds: velocity.map(|a| {
            let finite = |s: &f32| s.is_finite();
            kept()
                .map(|i| speed(&a.values, i).filter(finite).unwrap_or(0.0))
                .collect()
        }),
        skipped: is_finite.iter().filter(|&&f| !f).count(),
    }
}

/// The files of a ParaView collection; empty when it does not exist.
///
/// Supports only the format of riprap's own writer: one `DataSet` element per file.
pub(crate) fn collection(path: &Path) -> Result<Vec<Timed>, RenderError> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let text = read_text(path)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let bad = |element: &str| RenderError::BadFile {
        path: path.to_owned(),
        reason: format!("no time or file in <DataSet{element}"),
    };
    text.split("<DataSet")
        .skip(1)
        .map(|rest| {
            let element = rest.split_inclusive('>').next().unwrap_or(rest);
            let time = attribute(element, "timestep").and_then(|t| t.parse::<f64>().ok());
            let file = attribute(element, "file");
            let (Some(time), Some(file)) = (time.filter(|t| t.is_finite()), file) else {
                return Err(bad(element));
            };
            Ok(Timed {
                time,
                path: folder.join(file),
            })
        })
        .collect()
}

/// The value of `name="value"`.
fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = element.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}
