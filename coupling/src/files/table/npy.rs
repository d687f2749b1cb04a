//! Binary tables: a structured array of NumPy in a `.npy` file of version 1.0, which grows row by row.
//!
//! ```text
//! \x93NUMPY 1 0 | length of the heading | {'descr': [('time', '<f8'), ...], 'fortran_order': False, 'shape': (rows,), } | rows
//! ```
//! Rows come first, then the heading with their new number, so that the file of a killed run is whole; what follows the rows counted is
//! ignored by readers, and cut off when the run goes on.

use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::{Column, Start, TableData, TableError};

const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";
/// Bytes before the text of the heading: magic and its length.
const BEFORE_TEXT: usize = MAGIC.len() + 2;
/// The data begin at a multiple of it; bytes.
const ALIGNMENT: usize = 64;
/// Digits that the number of rows may have.
const DIGITS: usize = 20;

/// Kind of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NpyKind {
    /// `f64`.
    Double,
    /// `f32`: seven digits.
    Single,
    /// `u32`.
    Whole,
    /// `u8`.
    Flag,
}

impl NpyKind {
    fn code(self) -> &'static str {
        match self {
            Self::Double => "<f8",
            Self::Single => "<f4",
            Self::Whole => "<u4",
            Self::Flag => "|u1",
        }
    }

    fn of(code: &str) -> Option<Self> {
        let all = [Self::Double, Self::Single, Self::Whole, Self::Flag];
        all.into_iter().find(|kind| kind.code() == code)
    }

    fn size(self) -> usize {
        match self {
            Self::Double => 8,
            Self::Single | Self::Whole => 4,
            Self::Flag => 1,
        }
    }

    fn push(self, value: f64, out: &mut Vec<u8>) {
        match self {
            Self::Double => out.extend(value.to_le_bytes()),
            Self::Single => out.extend((value as f32).to_le_bytes()),
            Self::Whole => out.extend((value as u32).to_le_bytes()),
            Self::Flag => out.push(value as u8),
        }
    }

    fn value(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Self::Double, &[a, b, c, d, e, f, g, h]) => {
                f64::from_le_bytes([a, b, c, d, e, f, g, h])
            }
            (Self::Single, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            (Self::Whole, &[a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
            (Self::Flag, &[a]) => f64::from(a),
            _ => f64::NAN,
        }
    }
}

/// A binary table during writing.
#[derive(Debug)]
pub struct NpyTable {
    path: PathBuf,
    file: File,
    columns: Vec<(String, NpyKind)>,
    /// Rows in the file.
    n_rows: u64,
    /// Rows that are not in the file yet.
    pending: Vec<u8>,
}

impl NpyTable {
    /// Creates the file, or opens it to continue.
    ///
    /// # Errors
    /// [`TableError::Io`] if it cannot be created or opened, [`TableError::Foreign`] if a file to continue has other columns.
    pub fn open(
        path: &Path,
        columns: &[(&str, NpyKind)],
        start: Start,
    ) -> Result<Self, TableError> {
        let file = match start {
            Start::New => File::create(path).map_err(TableError::io("create", path))?,
            Start::Resume => File::options()
                .read(true)
                .write(true)
                .open(path)
                .map_err(TableError::io("continue", path))?,
        };
        let columns = columns.iter().map(|&(name, kind)| (name.to_owned(), kind));
        let mut table = Self {
            path: path.to_owned(),
            file,
            columns: columns.collect(),
            n_rows: 0,
            pending: Vec::new(),
        };
        match start {
            Start::New => table.write_heading()?,
            Start::Resume => table.check_columns()?,
        }
        Ok(table)
    }

    /// Number of rows in the file.
    pub fn n_rows(&self) -> u64 {
        self.n_rows
    }

    /// Adds a row, which [`Self::flush`] writes.
    ///
    /// # Errors
    /// [`TableError::Count`] if there is not one value per column.
    pub fn push(&mut self, row: &[f64]) -> Result<(), TableError> {
        if row.len() != self.columns.len() {
            return Err(TableError::Count {
                path: self.path.clone(),
                found: row.len(),
                expected: self.columns.len(),
            });
        }
        for (&value, (_, kind)) in row.iter().zip(&self.columns) {
            kind.push(value, &mut self.pending);
        }
        Ok(())
    }

    /// Writes the rows added since the last time, then their number.
    ///
    /// # Errors
    /// [`TableError::Io`] if writing fails.
    pub fn flush(&mut self) -> Result<(), TableError> {
        let end = self.length_of(self.n_rows);
        self.seek_to(end)?;
        (self.file.write_all(&self.pending)).map_err(TableError::io("write", &self.path))?;
        self.n_rows += (self.pending.len() / self.row_size()) as u64;
        self.pending.clear();
        self.write_heading()
    }

    /// Flushes the file to disk, so that it survives a power failure.
    ///
    /// # Errors
    /// [`TableError::Io`] if writing fails.
    pub fn sync(&self) -> Result<(), TableError> {
        (self.file.sync_data()).map_err(TableError::io("write", &self.path))
    }

    /// Keeps the first rows and continues after them.
    ///
    /// # Errors
    /// [`TableError::Short`] if the file has become shorter, [`TableError::Io`] if writing fails.
    pub fn cut(&mut self, n_rows: u64) -> Result<(), TableError> {
        let length = self.length_of(n_rows);
        let found = self.file.metadata();
        let found = found.map_err(TableError::io("continue", &self.path))?.len();
        if found < length {
            return Err(TableError::Short {
                path: self.path.clone(),
                found,
                expected: length,
            });
        }
        (self.file.set_len(length)).map_err(TableError::io("continue", &self.path))?;
        self.pending.clear();
        self.n_rows = n_rows;
        self.write_heading()
    }

    fn row_size(&self) -> usize {
        self.columns.iter().map(|(_, kind)| kind.size()).sum()
    }

    /// Length of the file with some rows; bytes.
    fn length_of(&self, n_rows: u64) -> u64 {
        self.heading(0).len() as u64 + n_rows * self.row_size() as u64
    }

    /// Heading of a number of rows, as long for any number.
    fn heading(&self, n_rows: u64) -> Vec<u8> {
        let columns = self.columns.iter();
        let fields: Vec<String> = columns
            .map(|(name, kind)| format!("('{name}', '{}')", kind.code()))
            .collect();
        let of = |n_rows: &str| {
            format!(
                "{{'descr': [{}], 'fortran_order': False, 'shape': ({n_rows},), }}",
                fields.join(", ")
            )
        };
        let longest = BEFORE_TEXT + of(&"9".repeat(DIGITS)).len() + 1;
        let length = longest.next_multiple_of(ALIGNMENT) - BEFORE_TEXT;
        let text = format!("{:<width$}\n", of(&n_rows.to_string()), width = length - 1);
        let mut heading = MAGIC.to_vec();
        heading.extend((length as u16).to_le_bytes());
        heading.extend(text.as_bytes());
        heading
    }

    fn write_heading(&mut self) -> Result<(), TableError> {
        let heading = self.heading(self.n_rows);
        self.seek_to(0)?;
        (self.file.write_all(&heading)).map_err(TableError::io("write", &self.path))
    }

    fn check_columns(&mut self) -> Result<(), TableError> {
        let expected = self.heading(0);
        let mut found = vec![0; expected.len()];
        self.seek_to(0)?;
        (self.file.read_exact(&mut found)).map_err(TableError::io("continue", &self.path))?;
        let fields = |heading: &[u8]| fields(heading).unwrap_or_default();
        let (found, expected) = (fields(&found), fields(&expected));
        let mut foreign = found.iter().filter(|field| !expected.contains(field));
        match (found == expected, foreign.next()) {
            (true, _) => Ok(()),
            (false, field) => Err(TableError::Foreign {
                path: self.path.clone(),
                column: field.map_or_else(String::new, |(name, _)| name.clone()),
            }),
        }
    }

    fn seek_to(&mut self, place: u64) -> Result<(), TableError> {
        let sought = self.file.seek(SeekFrom::Start(place));
        sought
            .map(|_| ())
            .map_err(TableError::io("write", &self.path))
    }
}

/// Columns of a heading; `None` where it is of another kind.
fn fields(heading: &[u8]) -> Option<Vec<(String, NpyKind)>> {
    let text = std::str::from_utf8(heading.get(BEFORE_TEXT..)?).ok()?;
    let list = text.split_once("'descr': [")?.1.split_once(']')?.0;
    let pairs = list.split("('").skip(1);
    pairs
        .map(|pair| {
            let (name, rest) = pair.split_once("', '")?;
            let kind = NpyKind::of(rest.split_once('\'')?.0)?;
            Some((name.to_owned(), kind))
        })
        .collect()
}

/// Reads a binary table; its columns have no units.
///
/// # Errors
/// [`TableError::Io`] if the file cannot be read, [`TableError::Binary`] if it is no table of this kind.
pub fn read_npy(path: &Path) -> Result<TableData, TableError> {
    let bytes = fs::read(path).map_err(TableError::io("read", path))?;
    table_of(path, &bytes).ok_or_else(|| TableError::Binary {
        path: path.to_owned(),
    })
}

fn table_of(path: &Path, bytes: &[u8]) -> Option<TableData> {
    let length = bytes.strip_prefix(MAGIC)?.first_chunk()?;
    let length = BEFORE_TEXT + usize::from(u16::from_le_bytes(*length));
    let (heading, data) = bytes.split_at_checked(length)?;
    let fields = fields(heading)?;
    let text = std::str::from_utf8(heading.get(BEFORE_TEXT..)?).ok()?;
    let shape = text.split_once("'shape': (")?.1.split_once(',')?.0;
    let n_rows: usize = shape.parse().ok()?;
    let size: usize = fields.iter().map(|(_, kind)| kind.size()).sum();
    let data = data.get(..n_rows.checked_mul(size)?)?;
    let mut values = vec![Vec::with_capacity(n_rows); fields.len()];
    for row in data.chunks_exact(size) {
        let mut rest = row;
        for ((_, kind), values) in fields.iter().zip(&mut values) {
            let (cell, after) = rest.split_at_checked(kind.size())?;
            values.push(kind.value(cell));
            rest = after;
        }
    }
    Some(TableData {
        path: path.to_owned(),
        columns: (fields.into_iter())
            .map(|(name, _)| Column::new(name, ""))
            .collect(),
        values,
        texts: Vec::new(),
    })
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;

    const COLUMNS: [(&str, NpyKind); 4] = [
        ("time", NpyKind::Double),
        ("block", NpyKind::Whole),
        ("vx", NpyKind::Single),
        ("asleep", NpyKind::Flag),
    ];

    /// The bytes of a file of one row, by the format's definition: data begin at a multiple of 64, in the order of the columns.
    #[test]
    fn the_file_is_as_numpy_defines_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("blocks.npy");
        let mut table = NpyTable::open(&path, &COLUMNS, Start::New).unwrap();
        table.push(&[0.1, 7.0, -1.5, 1.0]).unwrap();
        table.flush().unwrap();
        let bytes = fs::read(&path).unwrap();
        assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
        let length = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        assert_eq!(length % 64, 0);
        let text = std::str::from_utf8(&bytes[10..length]).unwrap();
        assert!(text.starts_with(
            "{'descr': [('time', '<f8'), ('block', '<u4'), ('vx', '<f4'), ('asleep', '|u1')], 'fortran_order': False, 'shape': (1,), } "
        ));
        assert!(text.ends_with(" \n"));
        let mut row = 0.1_f64.to_le_bytes().to_vec();
        row.extend(7_u32.to_le_bytes());
        row.extend((-1.5_f32).to_le_bytes());
        row.push(1);
        assert_eq!(&bytes[length..], row);
    }

    /// Rows that the heading does not count, as of a killed run, are not read, and are cut off when the run goes on.
    #[test]
    fn a_table_that_was_cut_off_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("blocks.npy");
        let row = |k: u32| [f64::from(k), 2.0, 0.5, 0.0];
        let mut table = NpyTable::open(&path, &COLUMNS, Start::New).unwrap();
        for k in 0..3 {
            table.push(&row(k)).unwrap();
            table.flush().unwrap();
        }
        let mut torn = fs::read(&path).unwrap();
        torn.extend([9; 10]);
        fs::write(&path, &torn).unwrap();
        assert_eq!(
            read_npy(&path).unwrap().column("time").unwrap(),
            [0.0, 1.0, 2.0]
        );
        let mut table = NpyTable::open(&path, &COLUMNS, Start::Resume).unwrap();
        table.cut(2).unwrap();
        table.push(&row(5)).unwrap();
        table.push(&row(6)).unwrap();
        table.flush().unwrap();
        let found = read_npy(&path).unwrap();
        assert_eq!(found.column("time").unwrap(), [0.0, 1.0, 5.0, 6.0]);
        assert_eq!(found.column("vx").unwrap(), [0.5; 4]);
        assert_eq!(fs::metadata(&path).unwrap().len(), table.length_of(4));
        assert!(matches!(table.cut(5), Err(TableError::Short { .. })));
        let other = NpyTable::open(&path, &COLUMNS[..3], Start::Resume);
        assert!(matches!(other, Err(TableError::Foreign { .. })));
    }
}
