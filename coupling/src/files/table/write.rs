//! Writing of tables, row by row.

use std::fs::{self, File};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::{Column, TableError};
use crate::files::rows::{Comments, Rows};

/// A table during writing; each row is on disk before the next one, so that a killed run keeps its data.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    file: File,
    headers: Vec<String>,
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
            headers,
            length: 0,
        };
        if start == Start::New {
            table.line(&table.headers.clone())?;
        }
        Ok(table)
    }

    /// Headers of the columns.
    pub fn headers(&self) -> &[String] {
        &self.headers
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

    /// Continues a file of other columns with those of this table, after the rows until a time in the first column; in these
    /// rows, columns that the file lacks are NaN.
    ///
    /// # Errors
    /// [`TableError::Io`] if reading or writing fails; the file is then as before.
    pub fn take_over(&mut self, until: f64) -> Result<(), TableError> {
        let failed = || TableError::io("continue", &self.path);
        let text = fs::read_to_string(&self.path).map_err(failed())?;
        let kept = under_headers(&self.headers, &text, until);
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        let partial = self.path.with_file_name(format!(".{name}.partial"));
        fs::write(&partial, &kept).map_err(failed())?;
        fs::rename(&partial, &self.path).map_err(failed())?;
        let file = File::options().write(true).open(&self.path);
        self.file = file.map_err(failed())?;
        self.cut(kept.len() as u64)
    }

    /// Writes one row and flushes it.
    ///
    /// # Errors
    /// [`TableError::Count`] if there is not one value per column, [`TableError::Io`] if writing fails.
    pub fn row(&mut self, values: &[f64]) -> Result<(), TableError> {
        if values.len() != self.headers.len() {
            return Err(TableError::Count {
                path: self.path.clone(),
                found: values.len(),
                expected: self.headers.len(),
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

/// The rows of a table until a time, cell by cell under other headers. A last line without an end is dropped.
fn under_headers(headers: &[String], text: &str, until: f64) -> String {
    let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
    let mut rows = Rows::of(whole, Comments::Lines);
    let found = rows.next().ok().flatten();
    let found = found.map_or_else(Vec::new, |head| head.heading());
    let place = |header: &String| found.iter().position(|other| other == header);
    let places: Vec<Option<usize>> = headers.iter().map(place).collect();
    let mut kept = headers.join(",") + "\n";
    while let Ok(Some(row)) = rows.next() {
        let cells: Vec<&str> = row.cells().collect();
        let time = row.numbers().next().flatten();
        if !time.is_some_and(|time| time <= until) {
            break;
        }
        let cell = |place: &Option<usize>| place.and_then(|k| cells.get(k).copied());
        let row: Vec<&str> = places.iter().map(|p| cell(p).unwrap_or("NaN")).collect();
        kept += &row.join(",");
        kept.push('\n');
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_kept_under_more_columns() {
        let text = "time [s],g1 [m]\n0.0,1.5\n0.1,2e-7\n0.2,3.0\n0.3,4";
        let headers = ["time [s]", "new [m]", "g1 [m]"].map(str::to_owned);
        assert_eq!(
            under_headers(&headers, text, 0.1),
            "time [s],new [m],g1 [m]\n0.0,NaN,1.5\n0.1,NaN,2e-7\n"
        );
        assert_eq!(
            under_headers(&headers, text, 9.0).lines().count(),
            4,
            "the last line has no end"
        );
    }
}
