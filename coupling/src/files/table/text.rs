//! Tables with texts in them: who is who among the blocks, the runs of a study.

use std::fs;
use std::path::{Path, PathBuf};

use super::{LineFault, TableError};
use crate::files::rows::{Comments, RowFault, Rows, Separator};

/// A table of texts and numbers that was read.
pub(crate) struct TextTable {
    path: PathBuf,
    heads: Vec<String>,
    separator: Separator,
    rows: Vec<(usize, Vec<String>)>,
}

/// A row of a [`TextTable`].
pub(crate) struct TextRow<'t> {
    table: &'t TextTable,
    line: usize,
    cells: &'t [String],
}

impl TextTable {
    /// Reads a whole table.
    ///
    /// # Errors
    /// [`TableError::Io`] if the file cannot be read, [`TableError::Line`] for the first invalid line.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let text = fs::read_to_string(path).map_err(TableError::io("read", path))?;
        let at = |line: usize, fault: LineFault| TableError::Line {
            path: path.to_owned(),
            line,
            fault,
        };
        let told = |RowFault { line, what }| at(line, LineFault::Cells { what });
        let mut rows = Rows::of(&text, Comments::Lines);
        let separator = rows.separator();
        let head = rows.next().map_err(told)?;
        let heads = head.ok_or_else(|| at(1, LineFault::NoHeader))?.heading();
        let mut found = Vec::new();
        while let Some(row) = rows.next().map_err(told)? {
            let cells: Vec<String> = row.cells().map(str::to_owned).collect();
            if cells.len() != heads.len() {
                let (found, expected) = (cells.len(), heads.len());
                return Err(at(row.line, LineFault::Count { found, expected }));
            }
            found.push((row.line, cells));
        }
        Ok(Self {
            path: path.to_owned(),
            heads,
            separator,
            rows: found,
        })
    }

    /// Place of the column with a header.
    ///
    /// # Errors
    /// [`TableError::NoColumn`] if there is none.
    pub fn place(&self, head: &str) -> Result<usize, TableError> {
        let found = self.heads.iter().position(|other| other == head);
        found.ok_or_else(|| TableError::NoColumn {
            path: self.path.clone(),
            name: head.to_owned(),
            present: self.heads.join(", "),
        })
    }

    /// The rows, from the first to the last.
    pub fn rows(&self) -> impl Iterator<Item = TextRow<'_>> {
        self.rows.iter().map(|(line, cells)| TextRow {
            table: self,
            line: *line,
            cells,
        })
    }
}

impl<'t> TextRow<'t> {
    /// Text in the column with a header.
    ///
    /// # Errors
    /// [`TableError::NoColumn`] if there is none.
    pub fn text(&self, head: &str) -> Result<&'t str, TableError> {
        let place = self.table.place(head)?;
        Ok(self.cells.get(place).map_or("", String::as_str))
    }

    /// Number in the column with a header; NaN in an empty cell.
    ///
    /// # Errors
    /// [`TableError::NoColumn`] if there is none, [`TableError::Line`] for another text.
    pub fn number(&self, head: &str) -> Result<f64, TableError> {
        let text = self.text(head)?;
        let gap = text.is_empty().then_some(f64::NAN);
        let number = self.table.separator.number(text).or(gap);
        number.ok_or_else(|| TableError::Line {
            path: self.table.path.clone(),
            line: self.line,
            fault: LineFault::Number {
                column: head.to_owned(),
                text: text.to_owned(),
            },
        })
    }
}

/// A table of texts to be written, with quotes where they are needed; breaks of lines in texts become blanks.
pub(crate) fn texts(heads: &[String], rows: &[Vec<String>]) -> String {
    let mut writer = csv::WriterBuilder::new()
        .flexible(true)
        .from_writer(Vec::new());
    for row in std::iter::once(heads).chain(rows.iter().map(Vec::as_slice)) {
        let cells = row.iter().map(|cell| cell.replace(['\n', '\r'], " "));
        // writing to memory does not fail
        let _ = writer.write_record(cells.collect::<Vec<_>>());
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    #[test]
    fn texts_come_back_and_numbers_name_their_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.csv");
        let heads = ["name", "mass [kg]"].map(str::to_owned);
        let rows =
            [["a, \"b\"\nc", "1.5"], ["d", "many"]].map(|row| row.map(str::to_owned).to_vec());
        fs::write(&path, texts(&heads, &rows)).unwrap();
        let table = TextTable::read(&path).unwrap();
        let found: Vec<TextRow<'_>> = table.rows().collect();
        assert_eq!(found[0].text("name").unwrap(), "a, \"b\" c");
        assert_eq!(found[0].number("mass [kg]").unwrap(), 1.5);
        let message = found[1].number("mass [kg]").unwrap_err().to_string();
        assert!(
            message.ends_with("line 3: `many` in column `mass [kg]` is not a number"),
            "{message}"
        );
        let message = found[1].text("mass").unwrap_err().to_string();
        assert!(message.ends_with("available: name, mass [kg]"), "{message}");
    }
}
