//! Requirements of polygon data, and errors of a file.

use super::{Array, Names, PolyData, Polygons};
use crate::messages::{Code, Coded, of_writing};
use std::io;
use std::path::{Path, PathBuf};

/// Error of writing or reading a VTK file or a collection.
#[derive(Debug, thiserror::Error)]
pub enum VtkError {
    /// Error of the operating system.
    #[error("cannot {operation} {}: {cause}", path.display())]
    Io {
        /// Operation that failed, e.g. `create`.
        operation: &'static str,
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        cause: io::Error,
    },
    /// Inconsistent data, or data in another layout.
    #[error("{}: {fault}", path.display())]
    Data {
        /// The file.
        path: PathBuf,
        /// Fault of the file.
        fault: Fault,
    },
}

impl VtkError {
    /// For `map_err`: an error of the operating system on `path`.
    pub(crate) fn io<'a>(
        operation: &'static str,
        path: &'a Path,
    ) -> impl FnOnce(io::Error) -> Self + 'a {
        move |cause| Self::Io {
            operation,
            path: path.to_owned(),
            cause,
        }
    }

    /// For `map_err`: a fault in the data of `path`.
    pub(super) fn data(path: &Path) -> impl FnOnce(Fault) -> Self + '_ {
        |fault| Self::Data {
            path: path.to_owned(),
            fault,
        }
    }
}

/// Fault of polygon data or of a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// ParaView orders frames by time.
    #[error("time must be finite, got {time}")]
    Time {
        /// The time; s.
        time: f64,
    },
    /// Corner numbers are 32-bit.
    #[error("{found} points or corners exceed the range of 32-bit integers; write fewer per file")]
    TooMany {
        /// Number of points or corners.
        found: usize,
    },
    /// Readers find arrays by name.
    #[error("array name `{}` is empty, used twice or has control characters", name.escape_debug())]
    Name {
        /// The name.
        name: String,
    },
    /// Only scalars, vectors and symmetric tensors are supported.
    #[error("array `{name}` has {components} components, 1, 3 or 6 are possible")]
    Components {
        /// Name of the array.
        name: String,
        /// Its components.
        components: usize,
    },
    /// An array does not match its points or polygons.
    #[error("array `{name}` has {found} values, expected {expected}")]
    Length {
        /// Name of the array.
        name: String,
        /// Number of values.
        found: u64,
        /// Required number of values.
        expected: u64,
    },
    /// An invalid polygon or line.
    #[error(
        "cell {cell} needs {least} or more corners, all among the {n_points} points, and ascending ends"
    )]
    Cell {
        /// Number of the polygon or line.
        cell: usize,
        /// Smallest number of corners: 3 of a polygon, 2 of a line.
        least: usize,
        /// Number of points.
        n_points: usize,
    },
    /// A part of the file is missing or is not text.
    #[error("not a complete file of this program: {part} is missing or damaged")]
    Missing {
        /// The part.
        part: &'static str,
    },
    /// The file may be valid VTK, but has another layout.
    #[error("cannot read `{attribute}` = `{}`", value.escape_debug())]
    Unsupported {
        /// Attribute of the XML header.
        attribute: &'static str,
        /// Its value.
        value: String,
    },
    /// Compressed bytes are damaged or truncated.
    #[error("compressed data of array `{name}` are damaged or truncated")]
    Compressed {
        /// Name of the array.
        name: String,
    },
}

impl PolyData {
    /// Checks that counts agree, corners exist and names are valid.
    ///
    /// # Errors
    /// The first [`Fault`] found.
    pub fn check(&self) -> Result<(), Fault> {
        if !self.time.is_finite() {
            return Err(Fault::Time { time: self.time });
        }
        let cells = [(&self.lines, 2), (&self.polygons, 3)];
        let corners = cells.map(|(cells, _)| cells.connectivity.len());
        let found = self.points.len().max(corners[0]).max(corners[1]);
        if i32::try_from(found).is_err() {
            return Err(Fault::TooMany { found });
        }
        for (k, Names { name, list }) in self.names.iter().enumerate() {
            let is_repeated = self.names[..k].iter().any(|other| other.name == *name);
            let is_broken = list.iter().any(|entry| entry.contains('\0'));
            if name.is_empty() || is_repeated || is_broken || name.contains(char::is_control) {
                return Err(Fault::Name { name: name.clone() });
            }
        }
        let n_cells = self.lines.len() + self.polygons.len();
        check_arrays(&self.point_data, self.points.len())?;
        check_arrays(&self.cell_data, n_cells)?;
        // Readers count the vertex cells of a point cloud as cells, for which an empty polygon array would be too short.
        if let Some(array) = self.cell_data.first()
            && n_cells == 0
            && !self.points.is_empty()
        {
            return Err(Fault::Length {
                name: array.name.clone(),
                found: 0,
                expected: self.points.len() as u64,
            });
        }
        let mut checks = cells.into_iter();
        checks.try_for_each(|(cells, least)| cells.check(least, self.points.len()))
    }
}

impl Polygons {
    /// Checks that each has enough corners, all among the points.
    fn check(&self, least: usize, n_points: usize) -> Result<(), Fault> {
        let Self {
            connectivity,
            offsets,
        } = self;
        let mut start = 0;
        for (cell, &end) in offsets.iter().enumerate() {
            let corners = usize::try_from(end)
                .ok()
                .and_then(|end| connectivity.get(start..end));
            let is_valid = corners.is_some_and(|corners| {
                corners.len() >= least
                    && corners
                        .iter()
                        .all(|&c| usize::try_from(c).is_ok_and(|c| c < n_points))
            });
            if !is_valid {
                return Err(Fault::Cell {
                    cell,
                    least,
                    n_points,
                });
            }
            start = end as usize;
        }
        if start == connectivity.len() {
            Ok(())
        } else {
            Err(Fault::Length {
                name: "connectivity".into(),
                found: connectivity.len() as u64,
                expected: start as u64,
            })
        }
    }
}

fn check_arrays(arrays: &[Array], n_tuples: usize) -> Result<(), Fault> {
    for (i, array) in arrays.iter().enumerate() {
        let Array {
            name,
            components,
            values,
        } = array;
        let is_repeated = arrays[..i].iter().any(|other| other.name == *name);
        if name.is_empty() || is_repeated || name.contains(char::is_control) {
            return Err(Fault::Name { name: name.clone() });
        }
        if ![1, 3, 6].contains(components) {
            return Err(Fault::Components {
                name: name.clone(),
                components: *components,
            });
        }
        if values.len() != components * n_tuples {
            return Err(Fault::Length {
                name: name.clone(),
                found: values.len() as u64,
                expected: (components * n_tuples) as u64,
            });
        }
    }
    Ok(())
}

impl Coded for VtkError {
    fn code(&self) -> Code {
        match self {
            Self::Io {
                operation: "read", ..
            } => Code::FileNotReadable,
            Self::Io { cause, .. } => of_writing(cause),
            Self::Data { .. } => Code::UnusableRunFolder,
        }
    }
}
