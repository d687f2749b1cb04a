//! Writing of tables, row by row.

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::read::present_name;
use super::{Column, TableError};
use crate::files::rows::{Comments, Rows};

/// A table during writing; each row is on disk before the next one, so that a killed run keeps its data.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    file: File,
    headers: Vec<String>,
    /// Columns of the file, by their places in a row, where it is continued and has fewer: of an earlier version.
    kept: Option<Vec<usize>>,
    /// Length written so far; bytes.
    length: u64,
}

/// Cell of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell<'a> {
    /// A quantity, with all of its bits.
    Number(f64),
    /// A number of an object.
    Whole(usize),
    /// A name, in a column whose values are text.
    Text(&'a str),
}

impl Cell<'_> {
    fn written(&self) -> String {
        match self {
            // `{:?}`: the shortest digits that restore the same bits, with an exponent where that is shorter.
            Self::Number(value) => format!("{value:?}"),
            Self::Whole(number) => number.to_string(),
            Self::Text(text) => (*text).to_owned(),
        }
    }
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
    /// As for [`Self::create`]; also [`TableError::Io`] if there is no file to continue, [`TableError::Foreign`] if it has columns
    /// of which this program knows nothing.
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
        let (file, kept) = match start {
            Start::New => (
                File::create(path).map_err(TableError::io("create", path))?,
                None,
            ),
            Start::Resume => {
                let kept = kept_columns(path, &headers)?;
                let file = File::options().write(true).open(path);
                (file.map_err(TableError::io("continue", path))?, kept)
            }
        };
        let mut table = Self {
            path: path.to_owned(),
            file,
            headers,
            kept,
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
        self.kept = None;
        self.cut(kept.len() as u64)
    }

    /// Writes one row and flushes it.
    ///
    /// # Errors
    /// [`TableError::Count`] if there is not one value per column, [`TableError::Io`] if writing fails.
    pub fn row(&mut self, values: &[f64]) -> Result<(), TableError> {
        let cells: Vec<Cell> = values.iter().copied().map(Cell::Number).collect();
        self.cells(&cells)
    }

    /// Writes one row of cells and flushes it; of a file of an earlier version, those of its columns.
    ///
    /// # Errors
    /// As for [`Self::row`].
    pub fn cells(&mut self, cells: &[Cell]) -> Result<(), TableError> {
        if cells.len() != self.headers.len() {
            return Err(TableError::Count {
                path: self.path.clone(),
                found: cells.len(),
                expected: self.headers.len(),
            });
        }
        let written: Vec<String> = match &self.kept {
            None => cells.iter().map(Cell::written).collect(),
            Some(places) => places.iter().map(|&k| cells[k].written()).collect(),
        };
        self.line(&written)
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

/// Places of the columns of a file among headers, where it does not have them all; in the order of the file.
fn kept_columns(path: &Path, headers: &[String]) -> Result<Option<Vec<usize>>, TableError> {
    let failed = || TableError::io("continue", path);
    let mut first = String::new();
    let file = File::open(path).map_err(failed())?;
    BufReader::new(file)
        .read_line(&mut first)
        .map_err(failed())?;
    // a heading that was cut off is found by the length of the file
    if !first.ends_with('\n') {
        return Ok(None);
    }
    let found: Vec<&str> = first.trim_end().split(',').collect();
    if found.iter().eq(headers.iter()) {
        return Ok(None);
    }
    let present = |header: &str| {
        let Column { name, unit } = Column::parse(header);
        (present_name(&name).to_owned(), unit)
    };
    let present_headers: Vec<_> = headers.iter().map(|header| present(header)).collect();
    let place = |header: &&str| {
        let wanted = present(header);
        present_headers.iter().position(|other| *other == wanted)
    };
    match found.iter().find(|header| place(header).is_none()) {
        Some(header) => Err(TableError::Foreign {
            path: path.to_owned(),
            column: (*header).to_owned(),
        }),
        None => Ok(Some(found.iter().filter_map(place).collect())),
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

    /// A table of an earlier version is continued under its own columns; one of a later version is not.
    #[test]
    fn a_table_is_continued_under_its_own_columns() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("blocks.csv");
        let [time, block, x, name] = [("time", "s"), ("block", "-"), ("x", "m"), ("name", "")]
            .map(|(name, unit)| Column::new(name, unit));
        let mut old = Table::create(&path, &[time.clone(), x.clone(), block.clone()])?;
        old.row(&[0.0, 2.5, 7.0])?;
        let length = old.length();
        old.row(&[1.0, 3.5, 7.0])?;
        let columns = [time, block, x, name];
        let mut new = Table::open(&path, &columns, Start::Resume)?;
        new.cut(length)?;
        let row = [
            Cell::Number(1.0),
            Cell::Whole(7),
            Cell::Number(4.5),
            Cell::Text("slide.0007"),
        ];
        new.cells(&row)?;
        assert_eq!(
            fs::read_to_string(&path)?,
            "time [s],x [m],block [-]\n0.0,2.5,7.0\n1.0,4.5,7\n"
        );
        let foreign = Table::open(&path, &columns[..2], Start::Resume);
        let told = foreign.err().map(|error| error.to_string());
        assert!(
            told.as_ref()
                .is_some_and(|told| told.contains("column `x [m]` is not one of this version")),
            "{told:?}"
        );
        Ok(())
    }

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
