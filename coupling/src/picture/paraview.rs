//! A Python script that opens a run in ParaView: particles as spheres, scales of the whole run, time, camera, shaded terrain.
//!
//! A script, not a `.pvsm` state: that has absolute paths and belongs to one version of ParaView. The script finds the run folder
//! from its own place, also after both were moved.

use std::fs;
use std::path::{Component, Path, PathBuf};

use nalgebra::Vector3;
use serde_json::{Value, json};

use super::render::camera::Lens;
use super::render::recording::{self, Recording};
use super::render::survey::{Survey, survey, upper_end};
use super::render::{RenderError, RenderOptions};
use crate::files::vtk::{Values, VtkError, replace_file};
use crate::messages::{Code, Coded};

/// The part that is the same for every run.
const STATE: &str = include_str!("paraview/state.py");
/// Width and height of the view; pixels.
const SIZE: (u32, u32) = (1280, 720);
/// Frames that the scale of speeds of blocks is taken from.
const FRAMES: usize = 16;

/// Quantity that colors the water.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coloring {
    /// Speed.
    #[default]
    Speed,
    /// Elevation.
    Elevation,
}

/// Error of writing the script.
#[derive(Debug, thiserror::Error)]
pub enum ParaviewError {
    /// A run that cannot be drawn.
    #[error(transparent)]
    Run(#[from] RenderError),
    /// A folder that does not exist.
    #[error("cannot open {}: {cause}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Error of the operating system.
        cause: std::io::Error,
    },
    /// The script cannot be written.
    #[error(transparent)]
    Write(#[from] VtkError),
}

impl Coded for ParaviewError {
    fn code(&self) -> Code {
        match self {
            Self::Run(error) => error.code(),
            Self::Folder { .. } => Code::FileNotReadable,
            Self::Write(error) => error.code(),
        }
    }
}

/// Writes the script for a run folder into a file; the run may be under way.
///
/// # Errors
///
/// [`ParaviewError`] names the file or folder.
pub fn paraview(folder: &Path, file: &Path, coloring: Coloring) -> Result<(), ParaviewError> {
    let run = recording::open(folder)?;
    let options = RenderOptions {
        size: SIZE,
        ..RenderOptions::default()
    };
    let numbers: Vec<usize> = (0..run.frames().len()).collect();
    let seen = survey(&run, folder, &numbers, &options)?;
    let whole = |path: &Path| {
        fs::canonicalize(path).map_err(|cause| ParaviewError::Folder {
            path: path.to_owned(),
            cause,
        })
    };
    let beside = file.parent().filter(|path| !path.as_os_str().is_empty());
    let (run_place, script_place) = (whole(folder)?, whole(beside.unwrap_or(Path::new(".")))?);
    let mut values = vec![
        ("TITLE", json!(run.scene.title)),
        ("RUN", json!(run_place.to_string_lossy())),
        (
            "RUN_BESIDE",
            json!(relative(&script_place, &run_place).to_string_lossy()),
        ),
        ("N_BLOCKS", json!(run.scene.block_names.len())),
    ];
    values.extend(scales(&run, &seen, coloring)?);
    values.extend(fixed_blocks(&run));
    values.extend(camera(&run, &seen));
    values.extend(colors());
    let head: String = values
        .iter()
        .map(|(name, value)| format!("{name} = {}\n", in_python(value)))
        .collect();
    let text = format!(
        "# Opens this run in ParaView 5.9 or newer: File > Load State, or paraview --script={}\n{head}\n{STATE}",
        file.file_name().unwrap_or_default().to_string_lossy()
    );
    Ok(replace_file(file, &[text.as_bytes()])?)
}

/// A value as Python writes it.
fn in_python(value: &Value) -> String {
    match value {
        Value::Null => "None".to_owned(),
        other => other.to_string(),
    }
}

type Setting = (&'static str, Value);

/// Spacing of the particles, scales of colors, digits of the time.
fn scales(
    run: &Recording,
    seen: &Survey,
    coloring: Coloring,
) -> Result<Vec<Setting>, ParaviewError> {
    let fastest = match run.water.is_empty() {
        true => fastest_block(run)?,
        false => seen.speed_range,
    };
    let frames = run.frames();
    let interval = match frames {
        [first, .., last] => (last.time - first.time) / (frames.len() - 1) as f64,
        _ => 0.1,
    };
    let digits = (1.0 - interval.max(1e-6).log10().floor()).clamp(0.0, 6.0);
    Ok(vec![
        ("SPACING", json!(seen.spacing)),
        ("SPEEDS", json!([0.0, fastest])),
        ("ELEVATIONS", json!(seen.elevations)),
        (
            "COLOR",
            json!(match coloring {
                Coloring::Speed => "Speed",
                Coloring::Elevation => "Elevation",
            }),
        ),
        ("DIGITS", json!(digits as u32)),
    ])
}

/// Round number that the speed of few faces of blocks exceeds; m/s.
fn fastest_block(run: &Recording) -> Result<f64, ParaviewError> {
    let stride = run.blocks.len().div_ceil(FRAMES).max(1);
    let mut speeds = Vec::new();
    for file in run.blocks.iter().rev().step_by(stride) {
        let data = recording::read(&file.path)?;
        let velocity = data.cell_data.iter().find(|array| array.name == "Velocity");
        if let Some(Values::F32(values)) = velocity.map(|array| &array.values) {
            let size = |v: &[f32; 3]| v.iter().map(|x| x * x).sum::<f32>().sqrt();
            speeds.extend(values.as_chunks().0.iter().map(size));
        }
    }
    Ok(upper_end(&mut speeds))
}

/// Numbers of the terrain and of other fixed blocks, as ranges.
fn fixed_blocks(run: &Recording) -> Vec<Setting> {
    let mut fixed: Vec<(i32, bool)> = (run.fixed.iter())
        .map(|body| (body.id, body.is_terrain))
        .collect();
    fixed.sort_unstable();
    let ranges = |is_terrain: bool| -> Vec<[i32; 2]> {
        let runs = fixed.chunk_by(|a, b| a.1 == b.1);
        runs.filter(|run| run[0].1 == is_terrain)
            .map(|run| [run[0].0, run[run.len() - 1].0])
            .collect()
    };
    vec![
        ("TERRAIN", json!(ranges(true))),
        ("OTHERS", json!(ranges(false))),
    ]
}

fn camera(run: &Recording, seen: &Survey) -> Vec<Setting> {
    let axes = seen.camera.axes();
    let aspect = seen.camera.aspect;
    let three = |v: Vector3<f64>| json!([v.x, v.y, v.z]);
    let (eye, look_at, view_angle, scale) = match seen.camera.lens {
        // across the picture here, up and down in ParaView
        Lens::Perspective { field_of_view_deg } => {
            let half = (0.5 * field_of_view_deg).to_radians().tan() / aspect;
            let angle = 2.0 * half.atan().to_degrees();
            (
                seen.camera.eye,
                seen.camera.look_at,
                json!(angle),
                Value::Null,
            )
        }
        // a long flume in one piece
        Lens::Strips { .. } => {
            let (low, high) = run.scene.domain;
            let (middle, extent) = (0.5 * (low + high), high - low);
            let length = extent.x.max(extent.y);
            let scale = 0.52 * length / aspect;
            (
                middle - axes.forward * length,
                middle,
                json!(30.0),
                json!(scale),
            )
        }
    };
    vec![
        ("EYE", three(eye)),
        ("LOOK_AT", three(look_at)),
        ("UP", three(axes.up)),
        ("VIEW_ANGLE", view_angle),
        ("PARALLEL_SCALE", scale),
        ("SIZE", json!([SIZE.0, SIZE.1])),
    ]
}

fn colors() -> Vec<Setting> {
    vec![
        ("INK", json!([0.1, 0.1, 0.1])),
        ("PAPER", json!([1.0, 1.0, 1.0])),
        ("STONE", json!([0.62, 0.52, 0.42])),
        ("WALL", json!([0.7, 0.7, 0.7])),
        ("GROUND", json!([0.72, 0.68, 0.58])),
        ("WALL_OPACITY", json!(0.25)),
    ]
}

/// Way from one folder to another, both without links.
fn relative(from: &Path, to: &Path) -> PathBuf {
    let (from, to): (Vec<Component>, Vec<Component>) =
        (from.components().collect(), to.components().collect());
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = from[shared..].iter().map(|_| Component::ParentDir);
    let way: PathBuf = up.chain(to[shared..].iter().copied()).collect();
    match way.as_os_str().is_empty() {
        true => PathBuf::from("."),
        false => way,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_between_folders() {
        for (from, to, expected) in [
            ("/a/b", "/a/b", "."),
            ("/a/b", "/a/b/c", "c"),
            ("/a/scripts", "/a/runs/x", "../runs/x"),
        ] {
            assert_eq!(
                relative(Path::new(from), Path::new(to)),
                Path::new(expected)
            );
        }
    }
}
