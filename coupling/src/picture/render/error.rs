//! Errors of rendering, with remedies.

use std::io;
use std::ops::Range;
use std::path::PathBuf;

use crate::messages::{Code, Coded, of_writing};
use crate::output::run_folder::ReadError;

/// Error of rendering.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A file of the run cannot be read.
    #[error("cannot read {}; is its folder a run folder, with case.ron and *.pvd in it?", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A file of the run is invalid.
    #[error("{}: {reason}; rerun with this version of riprap", path.display())]
    BadFile {
        /// The file.
        path: PathBuf,
        /// Cause.
        reason: String,
    },
    /// The run has written no frame.
    #[error("no frames in {}: neither water.pvd nor blocks.pvd lists a file; wait for the run's first output, or lower `output.frame_interval`", folder.display())]
    NoFrames {
        /// The run folder.
        folder: PathBuf,
    },
    /// No frame matches the request.
    #[error("frames {}..{} are not among the {available} frames in {}; choose from 0..{available}", frames.start, frames.end, folder.display())]
    NoSuchFrames {
        /// Requested frames.
        frames: Range<usize>,
        /// Available frames.
        available: usize,
        /// The run folder.
        folder: PathBuf,
    },
    /// Nothing in the chosen frames can be drawn.
    #[error("{} frames of {} have neither a finite particle nor a moving block; set `camera` in its case.ron to draw walls alone", frames, folder.display())]
    NothingToSee {
        /// Frames searched.
        frames: usize,
        /// The run folder.
        folder: PathBuf,
    },
    /// An option is out of range.
    #[error("{option} must be {limit}, got {value}")]
    BadOption {
        /// Option.
        option: &'static str,
        /// Given value.
        value: String,
        /// Allowed values.
        limit: &'static str,
    },
    /// The camera of the scene has no direction.
    #[error("camera in {} must have distinct position and look_at, and an angle of view above 0 and below 180 degrees", path.display())]
    BadCamera {
        /// The scene.
        path: PathBuf,
    },
    /// The surface reconstruction failed.
    #[error("no water surface in frame {frame}: {reason}; draw particles instead (--particles)")]
    Surface {
        /// Number of the frame.
        frame: usize,
        /// Message of the surface reconstruction.
        reason: String,
    },
    /// A file cannot be written.
    #[error("cannot write {}; check space and permissions", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// POV-Ray or ffmpeg failed.
    #[error("`{command}` failed in {}: {reason}", folder.display())]
    Program {
        /// The command line.
        command: String,
        /// Working folder.
        folder: PathBuf,
        /// End of its output.
        reason: String,
    },
}

impl From<ReadError> for RenderError {
    fn from(error: ReadError) -> Self {
        match error {
            ReadError::Io { path, source } => Self::Read { path, source },
            ReadError::BadFile { path, reason } => Self::BadFile { path, reason },
        }
    }
}

impl Coded for RenderError {
    fn code(&self) -> Code {
        match self {
            Self::Read { .. } | Self::BadFile { .. } => Code::UnusableRunFolder,
            Self::NoFrames { .. } | Self::NothingToSee { .. } | Self::Surface { .. } => {
                Code::NothingToDraw
            }
            Self::NoSuchFrames { .. } | Self::BadOption { .. } => Code::UnusableArgument,
            Self::BadCamera { .. } => Code::UnusableDirection,
            Self::Write { source, .. } => of_writing(source),
            Self::Program { .. } => Code::ProgramFailed,
        }
    }
}
