//! Reading of tables.

use std::fs;
use std::path::{Path, PathBuf};

use super::{Column, LineFault, TEXTS, TableError, read_npy};
use crate::files::rows::{Comments, Row, RowFault, Rows};

/// A table read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct TableData {
    /// Its file, for messages.
    pub path: PathBuf,
    /// The columns, in the order of the file.
    pub columns: Vec<Column>,
    /// Values of each column; all of the same length.
    pub values: Vec<Vec<f64>>,
    /// Columns of text by their names, which are not among the others.
    pub texts: Vec<(String, Vec<String>)>,
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

    /// Name of the column `name`, without its unit.
    ///
    /// # Errors
    /// As for [`Self::column`].
    pub fn name(&self, name: &str) -> Result<&str, TableError> {
        let index = self.index(name)?;
        Ok(&self.columns[index].name)
    }

    /// Text of the column `name`, if there is one.
    pub fn text(&self, name: &str) -> Option<&[String]> {
        let found = self.texts.iter().find(|(other, _)| other == name);
        found.map(|(_, cells)| cells.as_slice())
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

pub(super) fn present_name(name: &str) -> &str {
    let renamed = RENAMED.iter().find(|(old, _)| *old == name);
    renamed.map_or(name, |(_, new)| new)
}

/// Reads a whole table; where there is only a binary one of its name, that.
///
/// # Errors
/// [`TableError::Io`] if the file cannot be read, [`TableError::Line`] for the first invalid line, [`TableError::Binary`] for an
/// unknown binary table.
pub fn read_table(path: &Path) -> Result<TableData, TableError> {
    let binary = path.with_extension("npy");
    if !path.exists() && binary.exists() {
        return read_npy(&binary);
    }
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
    let told = |RowFault { line, what }| (line, LineFault::Cells { what });
    let mut rows = Rows::of(text, Comments::Lines);
    let head = rows.next().map_err(told)?;
    let head = head.ok_or((1, LineFault::NoHeader))?;
    let columns = columns_of(&head).map_err(|fault| (head.line, fault))?;
    let mut values = vec![Vec::new(); columns.len()];
    let mut texts: Vec<Option<Vec<String>>> = (columns.iter())
        .map(|column| is_text(column).then(Vec::new))
        .collect();
    while let Some(row) = rows.next().map_err(told)? {
        let (found, expected) = (row.cells().count(), columns.len());
        if found != expected {
            return Err((row.line, LineFault::Count { found, expected }));
        }
        let cells = row.cells().zip(row.numbers());
        let places = columns.iter().zip(&mut values).zip(&mut texts);
        for ((cell, number), ((column, values), text)) in cells.zip(places) {
            if let Some(text) = text {
                text.push(cell.to_owned());
                continue;
            }
            let gap = cell.is_empty().then_some(f64::NAN);
            values.push(number.or(gap).ok_or_else(|| {
                let fault = LineFault::Number {
                    column: column.header(),
                    text: cell.to_owned(),
                };
                (row.line, fault)
            })?);
        }
    }
    let mut table = TableData {
        path: path.to_owned(),
        columns: Vec::new(),
        values: Vec::new(),
        texts: Vec::new(),
    };
    for ((column, values), text) in columns.into_iter().zip(values).zip(texts) {
        match text {
            Some(text) => table.texts.push((column.name, text)),
            None => {
                table.columns.push(column);
                table.values.push(values);
            }
        }
    }
    Ok(table)
}

/// Whether the cells of a column are names.
fn is_text(column: &Column) -> bool {
    column.unit.is_empty() && TEXTS.contains(&column.name.as_str())
}

fn columns_of(head: &Row<'_>) -> Result<Vec<Column>, LineFault> {
    let names = head.heading();
    let columns: Vec<Column> = names.iter().map(|name| Column::parse(name)).collect();
    for (i, column) in columns.iter().enumerate() {
        let is_number = column.header().parse::<f64>().is_ok();
        if column.name.is_empty() || is_number || columns[..i].contains(column) {
            let name = column.header();
            return Err(LineFault::Header { name });
        }
    }
    Ok(columns)
}
