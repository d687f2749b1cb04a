//! Tables of numbers over time: gauges, energies, reference records.
//!
//! Comma-separated text with one header line, `time [s],g1 [m]`, and a number per column and line, with enough digits to
//! restore the same bits. A gap is `NaN`. Input tables may also have comment lines, which start with `#`, blank
//! lines, and empty cells, which are gaps.

use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Header of a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name, e.g. `g1`.
    pub name: String,
    /// Unit, e.g. `m`; empty if not stated.
    pub unit: String,
}

impl Column {
    /// A column called `name`, in `unit`.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
        }
    }

    /// Reads `name [unit]` or `name`.
    fn parse(header: &str) -> Self {
        match header
            .strip_suffix(']')
            .and_then(|rest| rest.rsplit_once('['))
        {
            Some((name, unit)) => Self::new(name.trim(), unit.trim()),
            None => Self::new(header, ""),
        }
    }

    /// `name [unit]`, as in the header line.
    pub fn header(&self) -> String {
        if self.unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} [{}]", self.name, self.unit)
        }
    }
}

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
                .map_err(TableError::io("go on with", path))?,
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
        let failed = || TableError::io("go on with", &self.path);
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

/// A table read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct TableData {
    /// Its file, for messages.
    pub path: PathBuf,
    /// The columns, in the order of the file.
    pub columns: Vec<Column>,
    /// Values of each column; all of the same length.
    pub values: Vec<Vec<f64>>,
}

impl TableData {
    /// Values of the column `name`; with its unit, `g1 [m]`, or without, `g1`.
    ///
    /// # Errors
    /// [`TableError::NoColumn`] if there is none or, without unit, more than one.
    pub fn column(&self, name: &str) -> Result<&[f64], TableError> {
        let index = self.index(name)?;
        Ok(&self.values[index])
    }

    /// Unit of the column `name`; empty if not stated.
    ///
    /// # Errors
    /// As for [`Self::column`].
    pub fn unit(&self, name: &str) -> Result<&str, TableError> {
        let index = self.index(name)?;
        Ok(&self.columns[index].unit)
    }

    fn index(&self, name: &str) -> Result<usize, TableError> {
        let wanted = Column::parse(name.trim());
        let fits = |column: &Column| {
            present_name(&column.name) == present_name(&wanted.name)
                && (wanted.unit.is_empty() || column.unit == wanted.unit)
        };
        let mut found = self
            .columns
            .iter()
            .enumerate()
            .filter(|(_, column)| fits(column));
        match (found.next(), found.next()) {
            (Some((index, _)), None) => Ok(index),
            _ => Err(TableError::NoColumn {
                path: self.path.clone(),
                name: name.to_owned(),
                present: self
                    .columns
                    .iter()
                    .map(Column::header)
                    .collect::<Vec<_>>()
                    .join(", "),
            }),
        }
    }
}

/// Renamed columns, old and new name; each is found under both for one release.
const RENAMED: [(&str, &str); 1] = [("laid_to_rest", "sleep_loss")];

fn present_name(name: &str) -> &str {
    let renamed = RENAMED.iter().find(|(old, _)| *old == name);
    renamed.map_or(name, |(_, new)| new)
}

/// Reads a whole table.
///
/// # Errors
/// [`TableError::Io`] if the file cannot be read, [`TableError::Line`] for the first invalid line.
pub fn read_table(path: &Path) -> Result<TableData, TableError> {
    let text = fs::read_to_string(path).map_err(TableError::io("read", path))?;
    table_from(path, &text)
}

/// The table of the text of a file; `path` is for messages.
///
/// # Errors
/// [`TableError::Line`] for the first invalid line.
pub fn table_from(path: &Path, text: &str) -> Result<TableData, TableError> {
    parse(path, text).map_err(|(line, fault)| TableError::Line {
        path: path.to_owned(),
        line,
        fault,
    })
}

fn parse(path: &Path, text: &str) -> Result<TableData, (usize, LineFault)> {
    // Spreadsheets put a byte-order mark before the first name.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = (1..)
        .zip(text.lines().map(str::trim))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));

    let (number, header) = lines.next().ok_or((1, LineFault::NoHeader))?;
    let columns: Vec<Column> = cells(header).map(Column::parse).collect();
    for (i, column) in columns.iter().enumerate() {
        let is_number = column.header().parse::<f64>().is_ok();
        if column.name.is_empty() || is_number || columns[..i].contains(column) {
            let name = column.header();
            return Err((number, LineFault::Header { name }));
        }
    }

    let mut values = vec![Vec::new(); columns.len()];
    for (number, line) in lines {
        let found = cells(line).count();
        if found != columns.len() {
            let expected = columns.len();
            return Err((number, LineFault::Count { found, expected }));
        }
        for ((cell, column), values) in cells(line).zip(&columns).zip(&mut values) {
            let value = if cell.is_empty() {
                Ok(f64::NAN)
            } else {
                cell.parse()
            };
            values.push(value.map_err(|_| {
                let fault = LineFault::Number {
                    column: column.header(),
                    text: cell.to_owned(),
                };
                (number, fault)
            })?);
        }
    }
    Ok(TableData {
        path: path.to_owned(),
        columns,
        values,
    })
}

/// Cells of a line, without enclosing quotes; commas inside quotes are not supported.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    line.split(',')
        .map(|cell| cell.trim().trim_matches('"').trim())
}

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
    fn io<'a>(operation: &'static str, path: &'a Path) -> impl FnOnce(io::Error) -> Self + 'a {
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

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parsed(text: &str) -> Result<TableData, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), text).unwrap();
        let name = file.path().display().to_string();
        read_table(file.path()).map_err(|error| error.to_string().replace(&name, "x.csv"))
    }

    #[test]
    fn a_renamed_column_is_found_under_both_names() {
        for header in ["laid_to_rest", "sleep_loss"] {
            let table = parsed(&format!("time [s],{header} [J]\n0,1\n")).unwrap();
            for name in ["laid_to_rest", "sleep_loss [J]"] {
                assert_eq!(table.column(name).unwrap(), [1.0], "{header} {name}");
            }
        }
    }

    #[test]
    fn the_file_looks_as_promised() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gauges.csv");
        let columns = [
            Column::new("time", "s"),
            Column::new("g1", "m"),
            Column::new("wet", ""),
        ];
        let mut table = Table::create(&path, &columns).unwrap();
        table.row(&[0.0, 0.1 + 0.2, 1.0]).unwrap();
        // No drop, no flush: the row is already on disk.
        let text = fs::read_to_string(&path).unwrap();
        assert_eq!(text, "time [s],g1 [m],wet\n0.0,0.30000000000000004,1.0\n");
        table.row(&[1e-7, f64::NAN, 0.0]).unwrap();
        let data = read_table(&path).unwrap();
        assert_eq!(data.columns, columns);
        assert_eq!(data.column("time").unwrap(), [0.0, 1e-7]);
        assert!(data.column("g1 [m]").unwrap()[1].is_nan());
        assert_eq!(data.unit("g1").unwrap(), "m");
        let message = table.row(&[1.0]).unwrap_err().to_string();
        assert_eq!(
            message,
            format!("{}: a row of 1 values for 3 columns", path.display())
        );
    }

    #[test]
    fn comments_gaps_and_spreadsheet_habits_are_read() {
        let text = "\u{feff}# digitised from figure 7\r\n\"time [s]\" , \"eta [m]\"\r\n\r\n0, 0.5\r\n# lost\r\n1,\r\n2,nan\r\n";
        let data = parsed(text).unwrap();
        assert_eq!(data.column("time").unwrap(), [0.0, 1.0, 2.0]);
        assert!(
            data.column("eta").unwrap()[1..]
                .iter()
                .all(|value| value.is_nan())
        );
    }

    #[test]
    fn errors_name_file_line_and_column() {
        let cases = [
            (
                "# only this\n",
                "x.csv, line 1: no header; the first line must name the columns, e.g. `time [s],g1 [m]`",
            ),
            (
                "0.0,1.0\n",
                "x.csv, line 1: `0.0` is not a column name, or is a duplicate; the first line must name the columns, \
                 e.g. `time [s],g1 [m]`",
            ),
            (
                "# a\ntime [s],g1 [m]\n0,1\n\n1,2,3\n",
                "x.csv, line 5: 3 values, expected 2",
            ),
            (
                "time [s],g1 [m]\n0,1;5\n",
                "x.csv, line 2: `1;5` in column `g1 [m]` is not a number",
            ),
        ];
        for (text, message) in cases {
            assert_eq!(parsed(text), Err(message.to_owned()));
        }
        let data = parsed("time [s],p [Pa],p [kPa]\n0,1,2\n").unwrap();
        assert_eq!(data.column("p [kPa]").unwrap(), [2.0]);
        for name in ["p", "q", "time [ms]"] {
            let message = data.column(name).unwrap_err().to_string();
            let end = format!(
                "column `{name}` missing or not unique; available: time [s], p [Pa], p [kPa]"
            );
            assert!(message.ends_with(&end), "{message}");
        }
        let message = Table::create(Path::new("x.csv"), &[Column::new("a,b", "")])
            .unwrap_err()
            .to_string();
        assert!(
            message.starts_with("x.csv: column `a,b` must not"),
            "{message}"
        );
    }

    proptest! {
        #[test]
        fn numbers_come_back_with_all_bits(values in proptest::collection::vec(any::<f64>(), 1..20)) {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("x.csv");
            let mut table = Table::create(&path, &[Column::new("a", "m")]).unwrap();
            for &value in &values {
                table.row(&[value]).unwrap();
            }
            let data = read_table(&path).unwrap();
            for (&wrote, &read) in values.iter().zip(data.column("a").unwrap()) {
                // A NaN stays NaN, without its payload.
                prop_assert!(wrote.to_bits() == read.to_bits() || (wrote.is_nan() && read.is_nan()));
            }
        }

        #[test]
        fn no_text_panics(text: String) {
            let _ = parsed(&text);
        }
    }
}
