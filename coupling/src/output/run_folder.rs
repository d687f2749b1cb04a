//! The run folder: every file name in it, and the only code that makes, empties, fills and reads one.
//!
//! ```text
//! runs/x/  case.ron, inputs of the scene          archive.rs
//!          summary.json, progress.json, accuracy.json, overview.svg, report.html
//!          gauges.csv, energy.csv, ... *.asc      a name each, below; *.tif and *.prj beside *.asc
//!          water_00000.vtp, water.pvd, ...        a stem each, below
//!          checkpoint*.bin                        while a run is incomplete
//!          frames/                                of `riprap render`
//! ```

mod archive;
mod read;

use std::io;
use std::path::{Path, PathBuf};

use super::bodies;
use crate::messages::{Code, Coded, of_writing};
pub use archive::ArchivedScene;
pub use read::{ReadError, RunScene, read_scene, read_summary};

/// The scene as run, every default written out.
pub const CASE: &str = "case.ron";
/// Figures of the whole run.
pub const SUMMARY: &str = "summary.json";
/// Where a run is, for programs that watch it.
pub const PROGRESS: &str = "progress.json";
/// Error and cost of a run that was given a budget.
pub const ACCURACY: &str = "accuracy.json";
/// The run on one page.
pub const OVERVIEW: &str = "overview.svg";
/// Numbers, names and masses of the blocks.
pub const BODIES: &str = bodies::FILE;
/// Page that plays the run.
pub const REPORT: &str = "report.html";
/// Script that opens the run in ParaView.
pub const PARAVIEW: &str = "open_in_paraview.py";
/// Gauge records.
pub const GAUGES: &str = "gauges.csv";
/// Energy ledger.
pub const ENERGY: &str = "energy.csv";
/// Motion of blocks.
pub const BLOCKS: &str = "blocks.csv";
/// The same as a binary table.
pub const BLOCKS_BINARY: &str = "blocks.npy";
/// Contacts of blocks as contact dynamics solved them.
pub const CONTACT_SOLUTION: &str = "contact_solution.csv";
/// Forces of exact joints.
pub const JOINT_FORCES: &str = "joint_forces.csv";
/// Forces on blocks by source.
pub const FORCES: &str = "forces.csv";
/// Forces on blocks by partner.
pub const CONTACTS: &str = "contacts.csv";
/// Paths of blocks.
pub const TRAJECTORIES: &str = "trajectories.csv";
/// One row per block that fell.
pub const ROCKFALL: &str = "rockfall.csv";
/// Slides as bodies.
pub const MASSES: &str = "masses.csv";
/// Blocks that passed planes or are in boxes.
pub const COUNTERS: &str = "counters.csv";
/// Contact forces between blocks.
pub const REACTIONS: &str = "reactions.csv";
/// Flow through the lines of a hand-off.
pub const HANDOFF_LINES: &str = "handoff_lines.csv";
/// Folder of what is handed over to a solver of the far field.
pub const HANDOFF: &str = "handoff";
/// Forces on barriers, their cells, and grains in their openings: what comes before and after the name.
const OF_BARRIERS: [(&str, &str); 3] = [
    ("barrier_", ".csv"),
    ("barrier_", ".vtp"),
    ("clogging_", ".csv"),
];
/// Maps of the water for ParaView.
pub const MAPS: &str = "maps.vtp";
/// Highest water, an ASCII grid.
pub const MAXIMUM_ELEVATION: &str = "maximum_elevation.asc";
/// Arrival times, an ASCII grid.
pub const FIRST_ARRIVAL: &str = "first_arrival.asc";
/// Depth on land, an ASCII grid.
pub const INUNDATION_DEPTH: &str = "inundation_depth.asc";
/// Maps, each also as GeoTIFF (`.tif`) and with its reference system (`.prj`).
const MAP_RASTERS: [&str; 3] = [MAXIMUM_ELEVATION, FIRST_ARRIVAL, INUNDATION_DEPTH];
/// Blocks that never move.
pub const FIXED_BLOCKS: &str = "fixed_blocks.vtp";
/// Paths of what grew first before a run failed.
pub const OFFENDERS: &str = "offenders.vtp";
/// The newest checkpoint.
pub const CHECKPOINT: &str = "checkpoint.bin";
/// The checkpoint before it.
pub const PREVIOUS_CHECKPOINT: &str = "checkpoint.previous.bin";
/// A checkpoint that is not yet complete.
pub const NEW_CHECKPOINT: &str = "checkpoint.new.bin";
/// Folder of rendered frames.
pub const RENDERED: &str = "frames";
/// Folder of inputs that have no other place in the run folder.
pub const INPUTS: &str = "inputs";

/// Stem of the frames of the water.
pub const WATER_FRAMES: &str = "water";
/// Stem of the frames of blocks that move.
pub const BLOCK_FRAMES: &str = "blocks";
/// Stem of the frames of contacts.
pub const CONTACT_FRAMES: &str = "contacts";
/// Stem of the frames of pressures on faces.
pub const FACE_FRAMES: &str = "faces";

/// Stems of all frames: `water_00000.vtp`, ..., with the collections `water.pvd` and `water.vtp.series`.
pub const FRAMES: [&str; 4] = [WATER_FRAMES, BLOCK_FRAMES, CONTACT_FRAMES, FACE_FRAMES];

/// All files with a name of their own.
const FILES: [&str; 30] = [
    CASE,
    SUMMARY,
    PROGRESS,
    ACCURACY,
    OVERVIEW,
    REPORT,
    PARAVIEW,
    BODIES,
    GAUGES,
    ENERGY,
    BLOCKS,
    CONTACT_SOLUTION,
    JOINT_FORCES,
    FORCES,
    CONTACTS,
    TRAJECTORIES,
    ROCKFALL,
    MASSES,
    COUNTERS,
    REACTIONS,
    HANDOFF_LINES,
    MAPS,
    MAXIMUM_ELEVATION,
    FIRST_ARRIVAL,
    INUNDATION_DEPTH,
    FIXED_BLOCKS,
    OFFENDERS,
    CHECKPOINT,
    PREVIOUS_CHECKPOINT,
    NEW_CHECKPOINT,
];

/// Table of a barrier.
pub fn barrier_table(name: &str) -> String {
    format!("barrier_{name}.csv")
}

/// Cells of a barrier.
pub fn barrier_cells(name: &str) -> String {
    format!("barrier_{name}.vtp")
}

/// Table of the openings of a barrier.
pub fn clogging(name: &str) -> String {
    format!("clogging_{name}.csv")
}

/// Name of a frame.
pub fn frame(stem: &str, number: u32) -> String {
    format!("{stem}_{number:05}.vtp")
}

/// Failure to make, empty or fill a run folder.
#[derive(Debug, thiserror::Error)]
pub enum RunFolderError {
    /// The folder is not empty.
    #[error(
        "{} already contains a run; choose another folder with -o or overwrite it with --force",
        folder.display()
    )]
    Used {
        /// The folder.
        folder: PathBuf,
    },
    /// Failed operation of the file system.
    #[error("cannot {operation} {}: {source}", path.display())]
    Io {
        /// The operation.
        operation: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// An input of the scene that cannot be copied.
    #[error("cannot copy `{file}` to {}: {source}", to.display())]
    Copy {
        /// The file as the scene names it.
        file: String,
        /// Its place in the folder.
        to: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A scene without a text.
    #[error("cannot write {CASE}: {0}")]
    Scene(#[from] ron::Error),
}

impl RunFolderError {
    fn io(operation: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io {
            operation,
            path,
            source,
        }
    }
}

/// Treatment of a run that is in the folder already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// The new run is refused.
    Keep,
    /// Its files are removed, those of the user are not.
    Replace,
}

/// Makes a run folder.
///
/// # Errors
///
/// [`RunFolderError`] when it contains files that are to be kept, or the file system fails.
pub fn create(folder: &Path, existing: Existing) -> Result<(), RunFolderError> {
    let is_used = folder
        .read_dir()
        .is_ok_and(|mut entries| entries.next().is_some());
    match existing {
        Existing::Keep if is_used => {
            return Err(RunFolderError::Used {
                folder: folder.to_owned(),
            });
        }
        Existing::Replace if is_used => clean(folder)?,
        Existing::Keep | Existing::Replace => {}
    }
    std::fs::create_dir_all(folder).map_err(RunFolderError::io("create", folder))
}

/// Copies tables and frames of a run into the folder of another one, which continues it.
///
/// # Errors
///
/// [`RunFolderError::Io`] names the file that cannot be read or written.
pub fn copy_records(from: &Path, to: &Path) -> Result<(), RunFolderError> {
    let of_that_run = [
        CASE,
        SUMMARY,
        PROGRESS,
        ACCURACY,
        OVERVIEW,
        REPORT,
        OFFENDERS,
        CHECKPOINT,
        PREVIOUS_CHECKPOINT,
        NEW_CHECKPOINT,
    ];
    let entries = from.read_dir().map_err(RunFolderError::io("read", from))?;
    for path in entries.flatten().map(|entry| entry.path()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let is_partial = name.starts_with('.');
        if is_written_by_runs(&name) && !is_partial && !of_that_run.contains(&name.as_ref()) {
            std::fs::copy(&path, to.join(name.as_ref()))
                .map_err(RunFolderError::io("copy", &path))?;
        }
    }
    Ok(())
}

/// Removes the files of an earlier run only.
fn clean(folder: &Path) -> Result<(), RunFolderError> {
    let entries = folder
        .read_dir()
        .map_err(RunFolderError::io("read", folder))?;
    for path in entries.flatten().map(|entry| entry.path()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let removed = if [RENDERED, HANDOFF].contains(&name.as_ref()) && path.is_dir() {
            std::fs::remove_dir_all(&path)
        } else if is_written_by_runs(&name) {
            std::fs::remove_file(&path)
        } else {
            Ok(())
        };
        removed.map_err(RunFolderError::io("remove", &path))?;
    }
    Ok(())
}

/// Whether a run writes a file of this name into its folder.
fn is_written_by_runs(name: &str) -> bool {
    let is_frame = |stem: &str| {
        let Some(rest) = name.strip_prefix(stem) else {
            return false;
        };
        let number = rest.strip_prefix('_').and_then(|r| r.strip_suffix(".vtp"));
        [".pvd", ".vtp.series"].contains(&rest)
            || number.is_some_and(|n| 5 <= n.len() && n.bytes().all(|b| b.is_ascii_digit()))
    };
    let is_map = |grid: &str| {
        let stem = grid.strip_suffix(".asc").unwrap_or(grid);
        let extension = name.strip_prefix(stem);
        extension.is_some_and(|e| [".tif", ".prj"].contains(&e))
    };
    let is_of_barrier = |(stem, extension): &(&str, &str)| {
        let barrier = name
            .strip_prefix(stem)
            .and_then(|n| n.strip_suffix(extension));
        barrier.is_some_and(|barrier| !barrier.is_empty())
    };
    // a program that is killed leaves a file under its temporary name
    let hidden = name
        .strip_prefix('.')
        .and_then(|n| n.strip_suffix(".partial"));
    hidden.is_some_and(is_written_by_runs)
        || FRAMES.iter().any(|stem| is_frame(stem))
        || MAP_RASTERS.iter().any(|grid| is_map(grid))
        || OF_BARRIERS.iter().any(is_of_barrier)
        || FILES.contains(&name)
}

impl Coded for RunFolderError {
    fn code(&self) -> Code {
        match self {
            Self::Used { .. } => Code::WouldOverwrite,
            Self::Io { source, .. } | Self::Copy { source, .. } => of_writing(source),
            Self::Scene(_) => Code::CannotWrite,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_runs_are_told_from_those_of_the_user() {
        for name in [
            "water_00012.vtp",
            "blocks_100000.vtp",
            "faces.pvd",
            "contacts.vtp.series",
            "masses.csv",
            "barrier_dam.csv",
            "clogging_dam.csv",
            "offenders.vtp",
            ".maps.vtp.partial",
            "first_arrival.tif",
            "maximum_elevation.prj",
        ] {
            assert!(is_written_by_runs(name), "{name}");
        }
        for name in [
            "water.csv",
            "water_depth.vtp",
            "blocks_old.csv",
            "arrival.tif",
            "waterfall.pvd",
            ".notes.partial",
            "notes.md",
        ] {
            assert!(!is_written_by_runs(name), "{name}");
        }
    }
}
