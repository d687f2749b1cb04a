//! Reasons why a file that the scene names cannot be used.

use std::path::PathBuf;

use riprap_dda::{PolyhedronError, SurfaceError, Vec3};

use crate::messages::Code;

/// Most triangles of one shell: the checks of a hull cost faces × corners.
pub(in crate::scene) const MOST_TRIANGLES_OF_A_SHELL: usize = 20_000;

/// Most triangles of a shell that is not convex: each of its cuts costs planes × triangles.
pub(in crate::scene) const MOST_TRIANGLES_OF_A_SPLIT: usize = 5_000;

/// Largest error of the volume of convex parts; –.
pub(in crate::scene) const LARGEST_VOLUME_ERROR: f64 = 0.1;

/// Most triangles of a file; a binary STL of the largest size has 4 million.
pub(in crate::scene) const MOST_TRIANGLES: usize = 5_000_000;

/// Largest file that is read; bytes.
pub(in crate::scene) const LARGEST_FILE: u64 = 200_000_000;

/// A file that the scene cannot use, and the reason.
#[derive(Debug, thiserror::Error)]
#[error("`{file}`: {fault}")]
pub struct MeshError {
    /// The file as the scene names it.
    pub file: String,
    /// The reason.
    pub fault: Fault,
}

/// Reason why a file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// The path is absolute, has `..`, or leads through a link.
    #[error(
        "leads out of the scene's folder, to {}; put the file beside the scene and name it from there, \
         or allow it with --allow-outside", .to.display()
    )]
    LeavesFolder {
        /// Target of the link.
        to: PathBuf,
    },
    /// A file that the system cannot read.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] std::io::Error),
    /// A folder, a device, a pipe.
    #[error("is not a regular file")]
    NoFile,
    /// Too many bytes.
    #[error("has {bytes} bytes, more than {LARGEST_FILE}; simplify the mesh")]
    TooLarge {
        /// Size of the file.
        bytes: u64,
    },
    /// Too many triangles.
    #[error("has more than {MOST_TRIANGLES} triangles; simplify the mesh")]
    TooManyTriangles,
    /// Unknown extension.
    #[error("unknown kind of mesh; use .stl, .obj, .ply, .vtk, .vtp or .vtu")]
    UnknownKind,
    /// Violation of the format.
    #[error("{0}")]
    Format(String),
    /// Longitude and latitude instead of easting and northing.
    #[error("is in degrees{system}, terrain is in meters; project it: {command}")]
    Degrees {
        /// ` of ` and the reference system, if the file names it.
        system: String,
        /// Command that projects it.
        command: String,
    },
    /// NaN or infinity.
    #[error("corner {corner} of triangle {triangle} is not finite; export the mesh again")]
    NotFinite {
        /// 1, 2 or 3.
        corner: usize,
        /// Counted from 1, polygons cut into fans.
        triangle: usize,
    },
    /// No triangles.
    #[error("has no triangles with an area; export the surface, not points or lines")]
    Empty,
    /// Holes.
    #[error(
        "the surface is open: {n_edges} edges have one side only, first at ({:.6}, {:.6}, {:.6}) m; \
         a block needs a watertight mesh: fill the holes", .at.x, .at.y, .at.z
    )]
    Open {
        /// Edges with a triangle on one side only.
        n_edges: usize,
        /// Middle of the first; m.
        at: Vec3,
    },
    /// Neighbors that disagree about the outside.
    #[error(
        "neighboring triangles at ({:.6}, {:.6}, {:.6}) m are turned opposite ways; make the normals \
         consistent, outward", .at.x, .at.y, .at.z
    )]
    Unoriented {
        /// Middle of their edge; m.
        at: Vec3,
    },
    /// A cavity, or a shell turned inside out.
    #[error(
        "shell {shell} of {n_shells} is inside out, as the wall of a cavity would be; blocks are solid: \
         remove it, or reverse its triangles"
    )]
    InsideOut {
        /// Counted from 1 in the order of the file.
        shell: usize,
        /// Shells in the file.
        n_shells: usize,
    },
    /// A shell that few convex parts do not resemble.
    #[error(
        "shell {shell} of {n_shells} is not convex, and {n_parts} convex parts have {:.1} % more volume; \
         raise split.most_parts, or draw parts that are convex, one closed shell each", 100.0 * .error
    )]
    NotConvex {
        /// Counted from 1 in the order of the file.
        shell: usize,
        /// Shells in the file.
        n_shells: usize,
        /// Parts that it was split into.
        n_parts: usize,
        /// Volume that the parts have more, over that of the shell; –.
        error: f64,
    },
    /// Shells that share space.
    #[error(
        "shells {} and {} of {n_shells} overlap by {depth:.3e} m: mass and buoyancy of what they share would count twice; \
         unite them, or move them apart", .shells[0], .shells[1]
    )]
    Overlapping {
        /// The two, counted from 1 in the order of the file.
        shells: [usize; 2],
        /// Shells in the file.
        n_shells: usize,
        /// Depth of the overlap; m.
        depth: f64,
    },
    /// Triangles that do not form a surface, numbered from 0 without those of no area.
    #[error("is not a valid surface: {0}")]
    NoSurface(#[from] SurfaceError),
    /// A shell too fine to be a block.
    #[error(
        "shell {shell} has {n} triangles, more than {most}{}; simplify it: a block's contacts \
         cost time by the face", if *most == MOST_TRIANGLES_OF_A_SPLIT { " for a shell that is not convex" } else { "" }
    )]
    TooFine {
        /// Counted from 1 in the order of the file.
        shell: usize,
        /// Its triangles.
        n: usize,
        /// Most allowed.
        most: usize,
    },
    /// The hull routine refuses a shell.
    #[error("shell {shell}: {source}")]
    NoHull {
        /// Counted from 1 in the order of the file.
        shell: usize,
        /// Its reason.
        source: PolyhedronError,
    },
}

impl Fault {
    /// Cause, as the guide explains it.
    pub(in crate::scene) fn code(&self) -> Code {
        match self {
            Self::LeavesFolder { .. } => Code::FileOutsideFolder,
            Self::Unreadable(_) | Self::NoFile => Code::FileNotReadable,
            Self::TooLarge { .. } | Self::TooManyTriangles | Self::TooFine { .. } => {
                Code::FileTooLarge
            }
            Self::UnknownKind | Self::Format(_) | Self::NotFinite { .. } | Self::Empty => {
                Code::UnusableFile
            }
            Self::Degrees { .. } => Code::UnusableMapSystem,
            Self::Open { .. } | Self::Unoriented { .. } | Self::InsideOut { .. } => {
                Code::MeshNotClosed
            }
            Self::NotConvex { .. } => Code::MeshNotConvex,
            Self::Overlapping { .. } => Code::OverlappingShells,
            Self::NoSurface(_) | Self::NoHull { .. } => Code::InvalidShape,
        }
    }
}
