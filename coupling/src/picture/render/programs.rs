//! Calls of POV-Ray and ffmpeg, as from the command line.

use super::RenderError;
use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Color difference above which POV-Ray supersamples a pixel.
const ANTIALIASING: &str = "+A0.2";

/// A film made of frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Path.
    pub path: PathBuf,
    /// Frames per second of playing time.
    pub frames_per_second: f64,
    /// Simulated over playing time; 1 is real time.
    pub speed: f64,
}

/// Whether a program can be started.
pub(crate) fn is_present(program: &Path, argument: &str) -> bool {
    Command::new(program)
        .arg(argument)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok()
}

/// Arguments that turn `pov` into `png`.
pub(crate) fn povray_arguments(pov: &str, png: &str, size: (u32, u32)) -> Vec<String> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    vec![
        format!("+I{pov}"),
        format!("+O{png}"),
        format!("+W{}", size.0),
        format!("+H{}", size.1),
        ANTIALIASING.to_owned(),
        format!("+WT{threads}"),
        "+FN8".to_owned(),
        // No window, and no console output. Not -GA: it also suppresses the line of a parse error.
        "-D".to_owned(),
        "-GD".to_owned(),
        "-GR".to_owned(),
        "-GS".to_owned(),
    ]
}

/// Renders `frame.pov` in `frames` to `frame.png`, under another name until it is complete.
pub(crate) fn picture(
    povray: &Path,
    frames: &Path,
    name: &str,
    size: (u32, u32),
) -> Result<PathBuf, RenderError> {
    let part = format!("{name}.part.png");
    let arguments = povray_arguments(&format!("{name}.pov"), &part, size);
    call(
        povray,
        &arguments.iter().map(OsString::from).collect::<Vec<_>>(),
        frames,
    )?;
    let png = frames.join(format!("{name}.png"));
    rename(&frames.join(part), &png)?;
    Ok(png)
}

/// Encodes images as a film; `interval` is the simulated time between two; s.
///
/// Real time where that is between 8 and 60 frames per second, else 25 frames per second.
pub(crate) fn film(
    ffmpeg: &Path,
    frames: &Path,
    names: &[String],
    interval: f64,
) -> Result<Film, RenderError> {
    let real_time = 1.0 / interval;
    let frames_per_second = if (8.0..=60.0).contains(&real_time) {
        real_time
    } else {
        25.0
    };
    let list: String = names
        .iter()
        .map(|name| {
            format!(
                "file '{name}.png'\nduration {:.6}\n",
                1.0 / frames_per_second
            )
        })
        .collect();
    let list_path = frames.join("film.txt");
    fs::write(&list_path, list).map_err(|source| RenderError::Write {
        path: list_path,
        source,
    })?;
    let rate = format!("{frames_per_second:.4}");
    let part = "film.part.mp4";
    // Players reject odd sizes and chroma finer than 4:2:0.
    let arguments = [
        "-y",
        "-loglevel",
        "error",
        "-f",
        "concat",
        "-i",
        "film.txt",
        "-vf",
        "pad=ceil(iw/2)*2:ceil(ih/2)*2",
        "-r",
        &rate,
        "-c:v",
        "libx264",
        "-crf",
        "18",
        "-pix_fmt",
        "yuv420p",
        "-movflags",
        "+faststart",
        part,
    ];
    call(ffmpeg, &arguments.map(OsString::from), frames)?;
    let path = frames.join("film.mp4");
    rename(&frames.join(part), &path)?;
    Ok(Film {
        path,
        frames_per_second,
        speed: frames_per_second * interval,
    })
}

fn rename(from: &Path, to: &Path) -> Result<(), RenderError> {
    fs::rename(from, to).map_err(|source| RenderError::Write {
        path: to.to_owned(),
        source,
    })
}

/// Runs a program in `folder`; its output is kept for the error.
fn call(program: &Path, arguments: &[OsString], folder: &Path) -> Result<(), RenderError> {
    let failed = |reason: String| RenderError::Program {
        command: std::iter::once(program.as_os_str())
            .chain(arguments.iter().map(OsString::as_os_str))
            .map(|word| word.to_string_lossy())
            .collect::<Vec<_>>()
            .join(" "),
        folder: folder.to_owned(),
        reason,
    };
    let output = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .map_err(|error: io::Error| failed(error.to_string()))?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let lines: Vec<&str> = said
        .lines()
        .filter(|line| !line.trim().is_empty())
        .collect();
    // All but the last few lines is a list of settings.
    let last = &lines[lines.len().saturating_sub(5)..];
    Err(failed(
        last.iter()
            .map(|line| line.trim())
            .collect::<Vec<_>>()
            .join("; "),
    ))
}
