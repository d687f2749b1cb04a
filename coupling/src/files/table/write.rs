//! Writing of tables, row by row.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::{Column, TableError};

/// A table during writing; each row is on disk before the next one, so that a killed run keeps its data.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    file: File,
    n_columns: usize,
    /// Length written so far; bytes.
    length: u64,
}

/// Start or continuation of the files of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Start: previous content is discarded.
    New,
    /// Continuation: the content stays until it is [cut](Table::cut) to the length at the checkpoint.
    Resume,
}

impl Table {
    /// Creates the file, or empties it, and writes the header.
    ///
    /// # Errors
    /// [`TableError::Name`] for a name or unit that would break the header, [`TableError::Io`] if writing fails.
    pub fn create(path: &Path, columns: &[Column]) -> Result<Self, TableError> {
        Self::open(path, columns, Start::New)
    }

    /// Creates the file, or opens it to continue.
    ///
    /// # Errors
    /// As for [`Self::create`]; also [`TableError::Io`] if there is no file to continue.
    pub fn open(path: &Path, columns: &[Column], start: Start) -> Result<Self, TableError> {
        let headers: Vec<String> = columns.iter().map(Column::header).collect();
        let breaks = |header: &&String| {
            header.is_empty() || header.starts_with('#') || header.contains([',', '"', '\n', '\r'])
        };
        if let Some(header) = headers.iter().find(breaks) {
            return Err(TableError::Name {
                path: path.to_owned(),
                name: header.clone(),
            });
        }
        let file = match start {
            Start::New => File::create(path).map_err(TableError::io("create", path))?,
            Start::Resume => File::options()
                .write(true)
                .open(path)
                .map_err(TableError::io("continue", path))?,
        };
        let mut table = Self {
            path: path.to_owned(),
            file,
            n_columns: columns.len(),
            length: 0,
        };
        if start == Start::New {
            table.line(&headers)?;
        }
        Ok(table)
    }

    /// Length written so far; bytes.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Flushes the file to disk, so that it survives a power failure.
    ///
    /// # Errors
    /// [`TableError::Io`] if writing fails.
    pub fn sync(&self) -> Result<(), TableError> {
        (self.file.sync_data()).map_err(TableError::io("write", &self.path))
    }

    /// Truncates the file to its first `length` bytes and continues after them.
    ///
    /// # Errors
    /// [`TableError::Short`] if the file has become shorter, [`TableError::Io`] if writing fails.
    pub fn cut(&mut self, length: u64) -> Result<(), TableError> {
        let failed = || TableError::io("continue", &self.path);
        let found = self.file.metadata().map_err(failed())?.len();
        if found < length {
            return Err(TableError::Short {
                path: self.path.clone(),
                found,
                expected: length,
            });
        }
        self.file.set_len(length).map_err(failed())?;
        self.file.seek(SeekFrom::Start(length)).map_err(failed())?;
        self.length = length;
        Ok(())
    }

    /// Writes one row and flushes it.
    ///
    /// # Errors
    /// [`TableError::Count`] if there is not one value per column, [`TableError::Io`] if writing fails.
    pub fn row(&mut self, values: &[f64]) -> Result<(), TableError> {
        if values.len() != self.n_columns {
            return Err(TableError::Count {
                path: self.path.clone(),
                found: values.len(),
                expected: self.n_columns,
            });
        }
        // `{:?}`: the shortest digits that restore the same bits, with an exponent where that is shorter.
        let cells: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
        self.line(&cells)
    }

    /// One write per line, directly to the file: a killed run loses no buffer.
    fn line(&mut self, cells: &[String]) -> Result<(), TableError> {
        let line = cells.join(",") + "\n";
        self.file
            .write_all(line.as_bytes())
            .map_err(TableError::io("write", &self.path))?;
        self.length += line.len() as u64;
        Ok(())
    }
}
