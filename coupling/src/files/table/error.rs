//! Errors of tables.

use std::io;
use std::path::{Path, PathBuf};

use crate::messages::{Code, Coded, of_writing};

/// Error of writing or reading a table.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// Error of the operating system.
    #[error("cannot {operation} {}: {cause}", path.display())]
    Io {
        /// Operation that failed.
        operation: &'static str,
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        cause: io::Error,
    },
    /// A name that would break the header line.
    #[error("{}: column `{}` must not be empty, start with # or contain commas, quotes or line breaks", path.display(), name.escape_debug())]
    Name {
        /// The file.
        path: PathBuf,
        /// The name, with its unit.
        name: String,
    },
    /// A row does not fit the header.
    #[error("{}: a row of {found} values for {expected} columns", path.display())]
    Count {
        /// The file.
        path: PathBuf,
        /// Values given.
        found: usize,
        /// Columns of the table.
        expected: usize,
    },
    /// A table to be continued has a column that this program does not write.
    #[error("{}: column `{column}` is not one of this version: the run was made by another one, and cannot be continued by this; start over with --force", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// Header of the column.
        column: String,
    },
    /// A table to be continued is shorter than it was.
    #[error("{}: {found} bytes, but the run had written {expected}: it was changed since and cannot be continued", path.display())]
    Short {
        /// The file.
        path: PathBuf,
        /// Length found; bytes.
        found: u64,
        /// Length written; bytes.
        expected: u64,
    },
    /// A binary table that cannot be read.
    #[error("{} is no table in the binary format of NumPy that riprap writes", path.display())]
    Binary {
        /// The file.
        path: PathBuf,
    },
    /// An invalid line.
    #[error("{}, line {line}: {fault}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Number of the line; the first is 1.
        line: usize,
        /// Fault of the line.
        fault: LineFault,
    },
    /// A requested column is missing or not unique.
    #[error("{}: column `{name}` missing or not unique; available: {present}", path.display())]
    NoColumn {
        /// The file.
        path: PathBuf,
        /// The requested name.
        name: String,
        /// The available names.
        present: String,
    },
}

impl TableError {
    pub(super) fn io<'a>(
        operation: &'static str,
        path: &'a Path,
    ) -> impl FnOnce(io::Error) -> Self + 'a {
        move |cause| Self::Io {
            operation,
            path: path.to_owned(),
            cause,
        }
    }
}

/// Fault of a line of a table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LineFault {
    /// The file is empty.
    #[error("no header; the first line must name the columns, e.g. `time [s],g1 [m]`")]
    NoHeader,
    /// Cells cannot be told apart.
    #[error("{what}")]
    Cells {
        /// The fault.
        what: String,
    },
    /// A header cell is empty, a number, or a duplicate.
    #[error(
        "`{name}` is not a column name, or is a duplicate; the first line must name the columns, e.g. `time [s],g1 [m]`"
    )]
    Header {
        /// The cell.
        name: String,
    },
    /// Cells are missing or too many.
    #[error("{found} values, expected {expected}")]
    Count {
        /// Cells of the line.
        found: usize,
        /// Cells of the header.
        expected: usize,
    },
    /// A cell is not a number.
    #[error("`{text}` in column `{column}` is not a number")]
    Number {
        /// The column.
        column: String,
        /// The cell.
        text: String,
    },
}

impl Coded for TableError {
    fn code(&self) -> Code {
        match self {
            Self::Io {
                operation: "read", ..
            } => Code::FileNotReadable,
            Self::Io { cause, .. } => of_writing(cause),
            Self::Count { .. } | Self::Line { .. } | Self::Binary { .. } => Code::UnusableRunFolder,
            Self::Name { .. } => Code::UnusableName,
            Self::Foreign { .. } | Self::Short { .. } => Code::CheckpointMismatch,
            Self::NoColumn { .. } => Code::NothingToCompare,
        }
    }
}
