//! Checkpoints: files from which a run resumes to bitwise the same result.
//!
//! ```text
//! "riprap checkpoint\n"   the magic, then the number of the format, 4 bytes
//! postcard                Header: the build, the scene, when
//! 8 bytes                 length of the state
//! state                   state of the run, its world and its observers
//! 32 bytes                BLAKE3 of all before
//! ```
//! All numbers are little-endian. The layout of the state depends on the build, so that another build rejects it. The
//! file is written under another name, synced and renamed; the previous one is kept.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::run_folder;
use crate::build_info::COMMIT;
use crate::files::vtk::VtkError;
use crate::files::vtk::replace_file;
use crate::messages::{Code, Coded};
use crate::saved::Saved;

/// The newest checkpoint of a run.
pub const FILE: &str = run_folder::CHECKPOINT;
/// The previous one.
pub const PREVIOUS: &str = run_folder::PREVIOUS_CHECKPOINT;

/// One under construction.
const NEW: &str = run_folder::NEW_CHECKPOINT;

const MAGIC: &[u8] = b"riprap checkpoint\n";
/// Version of the file format around the state.
const FORMAT: u32 = 11;
/// Length of the hash at the end.
const HASH: usize = blake3::OUT_LEN;

/// Header of a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Version and commit of the program.
    pub build: String,
    /// Hash of the scene as run, see [`scene_hash`].
    pub scene: [u8; HASH],
    /// Whether the water was still settling.
    pub is_settling: bool,
    /// Of this stage; s.
    pub time: f64,
    /// Of this stage.
    pub steps: u64,
}

/// Content of a checkpoint.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// The header.
    pub header: Header,
    /// The state of the run.
    pub state: Vec<u8>,
}

/// A checkpoint on disk, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Written {
    /// Whether the water was still settling.
    pub is_settling: bool,
    /// Time of that stage; s.
    #[serde(rename = "time_s")]
    pub time: f64,
    /// Steps of that stage.
    #[serde(rename = "step")]
    pub steps: u64,
    /// Size of the file; bytes.
    #[serde(rename = "size_bytes")]
    pub size: u64,
}

/// Reason why a run cannot resume from a checkpoint.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// Error of the operating system.
    #[error("cannot read {}: {cause}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        cause: io::Error,
    },
    /// Not a checkpoint, or empty.
    #[error("{} is not a checkpoint of riprap", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// Another format version.
    #[error("{} is a checkpoint of format {found}, and this riprap reads format {FORMAT}: continue with the riprap that wrote it, or start over with --force", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Its format version.
        found: u32,
    },
    /// Truncated or altered.
    #[error("{} is damaged: {fault}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Fault.
        fault: &'static str,
    },
    /// Written by another build of the program.
    #[error("{} was written by riprap {found}, and this is riprap {}: the layout of a state depends on the build; continue with that build, or start over with --force", path.display(), build())]
    Build {
        /// The file.
        path: PathBuf,
        /// The build that wrote it.
        found: String,
    },
    /// Written for another scene.
    #[error("{} belongs to another scene than the case.ron beside it; start over with --force", path.display())]
    Scene {
        /// The file.
        path: PathBuf,
    },
}

/// Version and commit of this program.
pub fn build() -> String {
    format!("{} ({COMMIT})", env!("CARGO_PKG_VERSION"))
}

/// Hash of a scene as it is written.
pub fn scene_hash(text: &str) -> [u8; HASH] {
    *blake3::hash(text.as_bytes()).as_bytes()
}

/// Writes a checkpoint into a run folder and keeps the last one as the previous one; returns its size in bytes.
///
/// # Errors
///
/// [`VtkError::Io`] names the file; existing checkpoints are preserved.
pub fn write(folder: &Path, header: &Header, state: &[u8]) -> Result<u64, VtkError> {
    let (path, previous) = (folder.join(FILE), folder.join(PREVIOUS));
    // complete under a third name first: a full disk affects neither of the two existing ones
    let new = folder.join(NEW);
    let size = write_to(&new, header, state)?;
    if path.exists() {
        fs::rename(&path, &previous).map_err(VtkError::io("rename", &path))?;
    }
    fs::rename(&new, &path).map_err(VtkError::io("rename", &new))?;
    Ok(size)
}

/// Writes a checkpoint to a file, which is replaced as a whole; returns its size in bytes.
///
/// # Errors
///
/// [`VtkError::Io`] names the file.
pub fn write_to(path: &Path, header: &Header, state: &[u8]) -> Result<u64, VtkError> {
    let head =
        head(header).map_err(|_| VtkError::io("write", path)(io::ErrorKind::Other.into()))?;
    let length = (state.len() as u64).to_le_bytes();
    let mut hasher = blake3::Hasher::new();
    for part in [&head, length.as_slice(), state] {
        hasher.update(part);
    }
    let hash = hasher.finalize();
    let parts = [&head, length.as_slice(), state, hash.as_bytes()];
    replace_file(path, &parts)?;
    Ok(parts.iter().map(|part| part.len() as u64).sum())
}

fn head(header: &Header) -> Saved {
    let mut head = MAGIC.to_vec();
    head.extend(FORMAT.to_le_bytes());
    postcard::to_extend(header, head)
}

/// Removes the previous checkpoint of a run folder, since a completed run does not need it.
///
/// # Errors
///
/// The error of the operating system.
pub fn remove_previous(folder: &Path) -> io::Result<()> {
    match fs::remove_file(folder.join(PREVIOUS)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// The newest valid checkpoint of a run folder, if any was written, and the reason why a newer one
/// is invalid.
///
/// # Errors
///
/// [`CheckpointError`] of the newest if none is valid.
pub fn newest(
    folder: &Path,
    scene: &[u8; HASH],
) -> Result<Option<(Checkpoint, Option<CheckpointError>)>, CheckpointError> {
    let mut refused = None;
    for name in [FILE, PREVIOUS] {
        let path = folder.join(name);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            Err(cause) => {
                refused.get_or_insert(CheckpointError::Io { path, cause });
                continue;
            }
        };
        match read(&path, &bytes, scene) {
            Ok(checkpoint) => return Ok(Some((checkpoint, refused))),
            Err(error) => {
                refused.get_or_insert(error);
            }
        }
    }
    match refused {
        Some(error) => Err(error),
        None => Ok(None),
    }
}

/// Reads a checkpoint of a scene from the bytes of a file.
///
/// # Errors
///
/// [`CheckpointError`] if it is invalid.
pub fn read(path: &Path, bytes: &[u8], scene: &[u8; HASH]) -> Result<Checkpoint, CheckpointError> {
    let path = || path.to_owned();
    let damaged = |fault| CheckpointError::Damaged {
        path: path(),
        fault,
    };
    let Some(rest) = bytes.strip_prefix(MAGIC) else {
        return Err(CheckpointError::Foreign { path: path() });
    };
    let Some((format, _)) = rest.split_first_chunk() else {
        return Err(damaged("it ends in its first line"));
    };
    let found = u32::from_le_bytes(*format);
    if found != FORMAT {
        return Err(CheckpointError::Format {
            path: path(),
            found,
        });
    }
    let Some((hashed, hash)) = bytes.split_last_chunk::<HASH>() else {
        return Err(damaged("it ends in its head"));
    };
    if blake3::hash(hashed) != *hash {
        return Err(damaged(
            "its bytes are not those that were written, or not all of them",
        ));
    }
    let body = hashed.get(MAGIC.len() + format.len()..).unwrap_or_default();
    let (header, body) =
        postcard::take_from_bytes::<Header>(body).map_err(|_| damaged("its head means nothing"))?;
    if header.build != build() {
        return Err(CheckpointError::Build {
            path: path(),
            found: header.build,
        });
    }
    if header.scene != *scene {
        return Err(CheckpointError::Scene { path: path() });
    }
    match body.split_first_chunk() {
        Some((length, state)) if u64::from_le_bytes(*length) == state.len() as u64 => {
            Ok(Checkpoint {
                header,
                state: state.to_vec(),
            })
        }
        _ => Err(damaged("its state is not as long as it says")),
    }
}

impl Coded for CheckpointError {
    fn code(&self) -> Code {
        match self {
            Self::Scene { .. } => Code::CheckpointMismatch,
            Self::Io { .. }
            | Self::Foreign { .. }
            | Self::Format { .. }
            | Self::Damaged { .. }
            | Self::Build { .. } => Code::CheckpointUnusable,
        }
    }
}
