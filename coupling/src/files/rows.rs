//! Rows of tables in text: one reading of separators, quotes, comments and decimal commas for every table.
//!
//! Columns are separated by commas, semicolons, tabs or blanks, found out from the first two lines; beside semicolons and
//! tabs numbers may have a decimal comma. A cell in quotes may contain separators. Blank lines, lines that start
//! with `#`, a byte-order mark, either end of lines and empty cells behind the last column are of no account.

mod separator;

use csv::{Reader, ReaderBuilder, StringRecord};

pub(crate) use separator::Separator;

/// Places of comments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Comments {
    /// Whole lines; in other lines `#` is part of a text.
    Lines,
    /// Also behind the cells of a line, which are numbers.
    BehindCells,
}

impl Comments {
    /// A line up to its comment.
    fn cut(self, line: &str) -> &str {
        match self {
            Self::Lines => line,
            Self::BehindCells => line.split('#').next().unwrap_or_default(),
        }
    }
}

/// A line that is no row.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {what}")]
pub(crate) struct RowFault {
    /// Number of the line, from 1.
    pub line: usize,
    /// The fault.
    pub what: String,
}

/// Rows of a text, one after the other.
pub(crate) struct Rows<'t> {
    text: &'t str,
    reader: Reader<&'t [u8]>,
    record: StringRecord,
    separator: Separator,
    comments: Comments,
    /// Number of the line at `counted`, from 1.
    line: usize,
    /// Place in the text up to which lines are counted; bytes.
    counted: usize,
    /// Cells of the first row.
    width: usize,
}

/// A row, which has at least one cell that is not empty.
pub(crate) struct Row<'r> {
    /// Number of its line, from 1.
    pub line: usize,
    /// The line, without comment.
    pub text: &'r str,
    separator: Separator,
    comments: Comments,
    record: &'r StringRecord,
    n: usize,
}

impl<'t> Rows<'t> {
    /// Rows of a text.
    pub fn of(text: &'t str, comments: Comments) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = text.lines().filter(|line| is_content(line));
        let mut line = || comments.cut(lines.next().unwrap_or_default()).trim();
        let separator = Separator::of(line(), line());
        let reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .delimiter(separator.byte())
            .from_reader(text.as_bytes());
        Self {
            text,
            reader,
            record: StringRecord::new(),
            separator,
            comments,
            line: 1,
            counted: 0,
            width: 0,
        }
    }

    /// Separator of the columns.
    pub fn separator(&self) -> Separator {
        self.separator
    }

    /// The next row; `None` behind the last one.
    ///
    /// # Errors
    ///
    /// [`RowFault`] for a quote that does not close on its line.
    pub fn next(&mut self) -> Result<Option<Row<'_>>, RowFault> {
        let (line, text, n) = loop {
            let start = self.reader.position().byte() as usize;
            let read = self.reader.read_record(&mut self.record);
            let end = self.reader.position().byte() as usize;
            let text = self.content(start, end);
            match read {
                Ok(false) => return Ok(None),
                Ok(true) if self.record.as_slice().contains('\n') => {
                    return Err(self.fault("a quote opens here and does not close on the line"));
                }
                Ok(true) => {}
                Err(error) => return Err(self.fault(&error.to_string())),
            }
            let n = self.n_cells();
            if !text.is_empty() && 0 < n {
                break (self.line, text, n);
            }
        };
        self.width = if self.width == 0 { n } else { self.width };
        Ok(Some(Row {
            line,
            text: self.comments.cut(text).trim(),
            separator: self.separator,
            comments: self.comments,
            record: &self.record,
            n,
        }))
    }

    fn fault(&self, what: &str) -> RowFault {
        RowFault {
            line: self.line,
            what: what.to_owned(),
        }
    }

    /// What stands between two places of the text behind blank lines and comments, and counts its lines.
    fn content(&mut self, start: usize, end: usize) -> &'t str {
        let mut place = start;
        let rest = loop {
            let rest = &self.text[place..end];
            let blank = rest.len() - rest.trim_start().len();
            place += blank;
            match rest[blank..].strip_prefix('#') {
                Some(_) => place += rest[blank..].find('\n').unwrap_or(rest.len() - blank),
                None => break &rest[blank..],
            }
        };
        let breaks = |text: &str| text.bytes().filter(|&byte| byte == b'\n').count();
        self.line += breaks(&self.text[self.counted..place]);
        self.counted = place;
        rest.trim_end()
    }

    /// Cells of the record without empty ones behind the last column.
    fn n_cells(&self) -> usize {
        let is_empty = |cell: Option<&str>| cell.is_none_or(|cell| cell.trim().is_empty());
        let all_empty = self.record.iter().all(|cell| is_empty(Some(cell)));
        let mut n = if all_empty { 0 } else { self.record.len() };
        while self.width < n && is_empty(self.record.get(n - 1)) {
            n -= 1;
        }
        n
    }
}

impl<'r> Row<'r> {
    /// Its cells, without quotes and blanks around them.
    pub fn cells(&self) -> impl Iterator<Item = &'r str> + use<'r> {
        let is_spaced = self.separator == Separator::Space;
        let comments = self.comments;
        let mut is_over = false;
        let cells = self.record.iter().take(self.n);
        // beside blanks a tab is one of them
        let cells = cells.flat_map(move |cell| cell.split(move |c| is_spaced && c == '\t'));
        let cells = cells.map_while(move |cell| {
            let kept = comments.cut(cell);
            let now = (!is_over).then(|| bare(kept));
            is_over |= kept.len() < cell.len();
            now
        });
        cells.filter(move |cell| !(is_spaced && cell.is_empty()))
    }

    /// Its cells as names of columns; a unit in brackets belongs to the name before it.
    pub fn heading(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for cell in self.cells() {
            let is_unit = cell.starts_with(['[', '(']) && cell.ends_with([']', ')']);
            match names.last_mut() {
                Some(name) if is_unit && self.separator == Separator::Space => {
                    *name = format!("{name} {cell}");
                }
                _ => names.push(cell.to_owned()),
            }
        }
        names
    }

    /// Its cells as numbers, `None` for those that are none.
    pub fn numbers(&self) -> impl Iterator<Item = Option<f64>> + use<'r> {
        let separator = self.separator;
        self.cells().map(move |cell| separator.number(cell))
    }
}

/// A cell without what spreadsheets put around it: a quote behind a blank opens no cell for the reader.
fn bare(cell: &str) -> &str {
    let cell = cell.trim();
    let inside = cell
        .strip_prefix('"')
        .and_then(|rest| rest.strip_suffix('"'));
    inside.unwrap_or(cell).trim()
}

fn is_content(line: &str) -> bool {
    let line = line.trim_start();
    !line.is_empty() && !line.starts_with('#')
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    fn all(text: &str, comments: Comments) -> Vec<(usize, Vec<String>)> {
        let mut rows = Rows::of(text, comments);
        let mut found = Vec::new();
        while let Some(row) = rows.next().unwrap() {
            found.push((row.line, row.cells().map(str::to_owned).collect()));
        }
        found
    }

    #[test]
    fn lines_keep_their_numbers_among_comments_blanks_and_either_end() {
        for end in ["\n", "\r\n"] {
            let text = [
                "\u{feff}# first",
                "",
                "a,b",
                "  # in; between",
                "  ",
                "1,2",
                ",,",
                "3,\"x, y\"",
                "# last, \"",
                "",
            ];
            let found = all(&text.join(end), Comments::Lines);
            let lines: Vec<usize> = found.iter().map(|(line, _)| *line).collect();
            assert_eq!(lines, [3, 6, 8], "{end:?}");
            assert_eq!(found[2].1, ["3", "x, y"]);
        }
    }

    #[test]
    fn quoted_cells_hold_separators_and_quotes() {
        for text in [
            "n;v\n\"a; \"\"b\"\"\";1,5\n",
            "n\tv\n\"a; \"\"b\"\"\"\t1,5\n",
            "n v\n\"a; \"\"b\"\"\"   1.5\n",
        ] {
            let mut rows = Rows::of(text, Comments::Lines);
            rows.next().unwrap();
            let row = rows.next().unwrap().unwrap();
            assert_eq!(row.cells().next(), Some("a; \"b\""), "{text}");
            assert_eq!(
                row.numbers().collect::<Vec<_>>(),
                [None, Some(1.5)],
                "{text}"
            );
        }
    }

    #[test]
    fn an_open_quote_names_its_line() {
        let mut rows = Rows::of("a,b\n1,2\n3,\"4\n5,6\n", Comments::Lines);
        rows.next().unwrap();
        rows.next().unwrap();
        let fault = rows.next().err().unwrap();
        assert_eq!(
            fault.to_string(),
            "line 3: a quote opens here and does not close on the line"
        );
    }

    #[test]
    fn comments_behind_numbers_end_a_row() {
        let text = "t, x # time; way\n0, 1 # at rest, or so\n1, 2\n";
        let found = all(text, Comments::BehindCells);
        assert_eq!(found[0].1, ["t", "x"]);
        assert_eq!(found[1].1, ["0", "1"]);
        assert_eq!(all("g #1,x\na,2\n", Comments::Lines)[0].1, ["g #1", "x"]);
        let blanks = all("0 1 # at rest\n1 2\n", Comments::BehindCells);
        assert_eq!(blanks[0].1, ["0", "1"]);
    }

    #[test]
    fn units_between_blanks_belong_to_their_names() {
        let mut rows = Rows::of("time [s]  g1 (m)\n 0\t1\n", Comments::Lines);
        assert_eq!(
            rows.next().unwrap().unwrap().heading(),
            ["time [s]", "g1 (m)"]
        );
        assert_eq!(rows.next().unwrap().unwrap().cells().count(), 2);
    }
}
