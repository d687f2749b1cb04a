//! Rendering of a run: a POV-Ray file per frame, and images and a film by POV-Ray and ffmpeg.
//!
//! ```text
//! RUN/case.ron, *.pvd, *.vtp ─recording→ clouds and bodies ─camera, body→ what is seen
//!                                               │ surface                    │
//!                                               └────────────── pov ─────────┘
//!                                     RUN/frames/ *.inc, frame_%05d.pov ─programs→ .png, film.mp4
//! ```
//!
//! The run folder is read-only (except for its `frames/`); a running job is rendered up to its latest
//! frame. Coordinates are single precision, as in the VTK files.

pub mod camera;
pub mod surface;

pub(super) mod body;
mod error;
mod pov;
mod programs;
pub(super) mod recording;
pub(super) mod survey;

pub use error::RenderError;
pub use programs::Film;

use crate::output::run_folder;
use crate::picture::color::ColorMap;
use body::GroundBelow;
use camera::Camera;
use recording::{Cloud, Recording};
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Drawing style of the water.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaterLook {
    /// A smooth surface; needs feature `surface`.
    Surface,
    /// Every particle as a sphere, colored by speed.
    Particles,
}

/// Options of a rendering.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    /// Interval of rendered frames; at least 1.
    pub every: usize,
    /// Range of frames, by the number in their file names; all of them when `None`.
    pub frames: Option<Range<usize>>,
    /// Width and height of the picture; pixels.
    pub size: (u32, u32),
    /// Drawing style of the water.
    pub water: WaterLook,
    /// Colors of the speed of particles.
    pub colors: ColorMap,
    /// Name or path of POV-Ray.
    pub povray: PathBuf,
    /// Name or path of ffmpeg.
    pub ffmpeg: PathBuf,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            every: 1,
            frames: None,
            size: (960, 540),
            colors: ColorMap::Viridis,
            water: if cfg!(feature = "surface") {
                WaterLook::Surface
            } else {
                WaterLook::Particles
            },
            povray: PathBuf::from("povray"),
            ffmpeg: PathBuf::from("ffmpeg"),
        }
    }
}

/// Outcome of a rendering.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSummary {
    /// Output folder.
    pub folder: PathBuf,
    /// POV-Ray files.
    pub scenes: Vec<PathBuf>,
    /// Pictures; empty without POV-Ray.
    pub pictures: Vec<PathBuf>,
    /// The film; `None` without POV-Ray or ffmpeg, or of a single frame.
    pub film: Option<Film>,
    /// Camera of all frames.
    pub camera: Camera,
    /// Speed at the upper end of the particles' colors, the same in all frames; m/s.
    pub speed_range: f64,
    /// Particles left out because a coordinate is not finite, over all frames.
    pub skipped_points: usize,
    /// Faces of blocks left out because a corner is not finite, over all frames.
    pub skipped_faces: usize,
    /// Particles drawn as spray beside the surface, over all frames.
    pub spray: usize,
}

/// Renders a run. `report` receives a line of text per event for the user.
///
/// # Errors
///
/// [`RenderError`] if a file cannot be read, drawn or written.
pub fn render(
    folder: &Path,
    options: &RenderOptions,
    report: &mut dyn FnMut(&str),
) -> Result<RenderSummary, RenderError> {
    check(options)?;
    let run = recording::open(folder)?;
    let numbers = chosen(&run, folder, options)?;
    let survey = survey::survey(&run, folder, &numbers, options)?;
    report(&survey.description);

    let frames = folder.join(run_folder::RENDERED);
    prepare(&frames, options, report)?;
    let has_povray = programs::is_present(&options.povray, "--version");
    let mut summary = RenderSummary {
        folder: frames.clone(),
        scenes: Vec::new(),
        pictures: Vec::new(),
        film: None,
        camera: survey.camera.clone(),
        speed_range: survey.speed_range,
        skipped_points: 0,
        skipped_faces: run.skipped_faces,
        spray: 0,
    };
    let mut names = Vec::new();
    for &number in &numbers {
        let name = format!("frame_{number:05}");
        let text = scene_text(&run, &survey, number, options, &mut summary)?;
        let path = frames.join(format!("{name}.pov"));
        write(&path, &text)?;
        summary.scenes.push(path);
        if has_povray {
            summary.pictures.push(programs::picture(
                &options.povray,
                &frames,
                &name,
                options.size,
            )?);
        }
        report(&format!("{name}: {} of {}", names.len() + 1, numbers.len()));
        names.push(name);
    }
    if has_povray {
        if let Some(interval) = frame_interval(&run, &numbers) {
            summary.film = film(interval, &names, &frames, options, report)?;
        }
    } else {
        report(&without_povray(&names, options));
    }
    report_skipped(&summary, report);
    Ok(summary)
}

fn check(options: &RenderOptions) -> Result<(), RenderError> {
    if options.every == 0 {
        return Err(RenderError::BadOption {
            option: "every",
            value: "0".to_owned(),
            limit: "at least 1",
        });
    }
    let (width, height) = options.size;
    if !(16..=16_384).contains(&width) || !(16..=16_384).contains(&height) {
        return Err(RenderError::BadOption {
            option: "size",
            value: format!("{width}x{height}"),
            limit: "16 to 16384 pixels either way",
        });
    }
    if options.water == WaterLook::Surface && !cfg!(feature = "surface") {
        return Err(RenderError::BadOption {
            option: "water",
            value: "surface".to_owned(),
            limit: "particles in a build without feature `surface`",
        });
    }
    Ok(())
}

/// Numbers of the frames that are drawn.
fn chosen(
    run: &Recording,
    folder: &Path,
    options: &RenderOptions,
) -> Result<Vec<usize>, RenderError> {
    let available = run.frames().len();
    let frames = options.frames.clone().unwrap_or(0..available);
    let numbers: Vec<usize> = (frames.start..frames.end.min(available))
        .step_by(options.every)
        .collect();
    if numbers.is_empty() {
        return Err(RenderError::NoSuchFrames {
            frames,
            available,
            folder: folder.to_owned(),
        });
    }
    Ok(numbers)
}

/// Creates the folder with the includes; edited ones are kept.
fn prepare(
    frames: &Path,
    options: &RenderOptions,
    report: &mut dyn FnMut(&str),
) -> Result<(), RenderError> {
    fs::create_dir_all(frames).map_err(|source| RenderError::Write {
        path: frames.to_owned(),
        source,
    })?;
    for (name, text) in pov::INCLUDES {
        let path = frames.join(name);
        match fs::read_to_string(&path) {
            Ok(present) if present == text => {}
            Ok(_) => report(&format!(
                "{} differs from riprap's own and is kept; delete it to restore the default",
                path.display()
            )),
            Err(_) => write(&path, text)?,
        }
    }
    // POV-Ray reads this file from its working folder, so that `povray frame_00000.pov` alone gives
    // the same picture.
    let (width, height) = options.size;
    let ini = format!(
        "Width={width}\nHeight={height}\nAntialias=on\nAntialias_Threshold=0.2\nDisplay=off\nOutput_File_Type=N8\n"
    );
    write(&frames.join("povray.ini"), &ini)
}

fn write(path: &Path, text: &str) -> Result<(), RenderError> {
    fs::write(path, text).map_err(|source| RenderError::Write {
        path: path.to_owned(),
        source,
    })
}

/// One frame, from files to text.
fn scene_text(
    run: &Recording,
    survey: &survey::Survey,
    number: usize,
    options: &RenderOptions,
    summary: &mut RenderSummary,
) -> Result<String, RenderError> {
    let time = run.frames().get(number).map_or(0.0, |f| f.time);
    let Cloud {
        points,
        speeds,
        skipped,
    } = run.cloud(number)?;
    let (bodies, skipped_faces) = run.blocks_at(time)?;
    summary.skipped_points += skipped;
    summary.skipped_faces += skipped_faces;
    let water = match options.water {
        WaterLook::Particles => pov::Water::Particles(points, speeds),
        WaterLook::Surface => {
            let spacing = survey.spacing as f32;
            let is_stray = surface::strays(&points, spacing);
            let of_water = points.iter().zip(&is_stray).filter(|&(_, &stray)| !stray);
            let of_water: Vec<[f32; 3]> = of_water.map(|(p, _)| *p).collect();
            let terrain = &survey.stage.terrain;
            let ground = GroundBelow::new(terrain, f64::max(survey.spacing, 1e-3 * survey.size));
            // what is left behind on a shore wets it; drawn as spheres it would be a string of pearls
            let is_left = |a: usize| {
                let is_slow = speeds
                    .as_ref()
                    .is_some_and(|speeds| speeds[a] < slow(spacing));
                is_slow && ground.is_near(&points[a], survey.spacing)
            };
            let strays = (0..points.len()).filter(|&a| is_stray[a] && !is_left(a));
            let spray: Vec<[f32; 3]> = strays.map(|a| points[a]).collect();
            summary.spray += spray.len();
            let surface =
                surface::surface(&of_water, spacing).map_err(|reason| RenderError::Surface {
                    frame: number,
                    reason,
                })?;
            pov::Water::Surface(surface, spray)
        }
    };
    Ok(pov::frame(
        &survey.setting(&run.scene.title),
        time,
        &water,
        &bodies,
    ))
}

/// Speed of water that is left behind on a shore: up to half of that of waves as shallow as a particle; m/s.
fn slow(spacing: f32) -> f32 {
    0.5 * (9.81 * spacing).sqrt()
}

/// Mean time between frames; `None` for a single one.
fn frame_interval(run: &Recording, numbers: &[usize]) -> Option<f64> {
    let time = |number: Option<&usize>| {
        number
            .and_then(|&n| run.frames().get(n))
            .map_or(0.0, |f| f.time)
    };
    let interval =
        (time(numbers.last()) - time(numbers.first())) / (numbers.len().max(2) - 1) as f64;
    (2 <= numbers.len() && 0.0 < interval).then_some(interval)
}

fn film(
    interval: f64,
    names: &[String],
    frames: &Path,
    options: &RenderOptions,
    report: &mut dyn FnMut(&str),
) -> Result<Option<Film>, RenderError> {
    if !programs::is_present(&options.ffmpeg, "-version") {
        report(
            "no film: ffmpeg was not found; the pictures are in frames/, see render/README.md for the command",
        );
        return Ok(None);
    }
    let film = programs::film(&options.ffmpeg, frames, names, interval)?;
    report(&format!(
        "{}: {:.3} frames per second, {:.3} times real time",
        film.path.display(),
        film.frames_per_second,
        film.speed
    ));
    Ok(Some(film))
}

fn without_povray(names: &[String], options: &RenderOptions) -> String {
    let first = names.first().map_or("frame_00000", String::as_str);
    let arguments = programs::povray_arguments(
        &format!("{first}.pov"),
        &format!("{first}.png"),
        options.size,
    );
    format!(
        "no pictures: `{}` is not on this machine; install POV-Ray 3.7 (Debian: apt install povray) \
         here or copy frames/ to a machine that has it, and there, in frames/: povray {}",
        options.povray.display(),
        arguments.join(" ")
    )
}

fn report_skipped(summary: &RenderSummary, report: &mut dyn FnMut(&str)) {
    if 0 < summary.skipped_points + summary.skipped_faces {
        report(&format!(
            "omitted as not finite: {} particles and {} block faces over all frames",
            summary.skipped_points, summary.skipped_faces
        ));
    }
}
