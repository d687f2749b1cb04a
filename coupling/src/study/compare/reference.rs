//! A reference as laboratories write it: any separator, a heading or none, columns under names of their own, other units.

use std::fs;
use std::path::{Path, PathBuf};

use super::{CompareError, Series};
use crate::files::rows::{Comments, RowFault, Rows};
use crate::files::units::{Quantity, split};

/// Columns of a reference, each by its name, with or without unit, or by its number from 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReferenceColumns {
    /// Values; when left out, the column of the run's name.
    pub value: Option<String>,
    /// Times; when left out, `time` or `t`, or else the first column.
    pub time: Option<String>,
}

impl ReferenceColumns {
    /// Whether any column is named.
    pub fn are_given(&self) -> bool {
        self.value.is_some() || self.time.is_some()
    }
}

/// A reference that was read.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    path: PathBuf,
    /// Heading of each column; empty without.
    headings: Vec<String>,
    /// Unit of each column from a line of units below the heading; empty without.
    units: Vec<String>,
    /// Values of each column, NaN in a gap.
    values: Vec<Vec<f64>>,
}

/// Cells that stand for a missing value.
const GAPS: [&str; 5] = ["", "-", "na", "n/a", "nan"];

impl Reference {
    /// Reads a table separated by commas, semicolons, tabs or spaces; `#` starts a comment.
    pub(super) fn read(path: &Path) -> Result<Self, CompareError> {
        let text = fs::read(path).map_err(|cause| CompareError::Read {
            path: path.to_owned(),
            cause,
        })?;
        let text = String::from_utf8_lossy(&text);
        let fault = |line: usize, what: String| CompareError::Reference {
            path: path.to_owned(),
            line,
            what,
        };
        let mut rows = Rows::of(&text, Comments::BehindCells);
        let mut above: Vec<Vec<String>> = Vec::new();
        let mut this: Option<Self> = None;
        loop {
            let row = match rows.next() {
                Ok(Some(row)) => row,
                Ok(None) => break,
                Err(RowFault { line, what }) => return Err(fault(line, what)),
            };
            let is_data = row.numbers().flatten().any(f64::is_finite);
            if this.is_none() && !is_data {
                above.push(row.heading());
                continue;
            }
            let found = row.cells().count();
            let this = this.get_or_insert_with(|| Self::headed(path, &above, found));
            let expected = this.values.len();
            if found != expected {
                return Err(fault(
                    row.line,
                    format!("{found} values, expected {expected}"),
                ));
            }
            for ((cell, number), values) in row.cells().zip(row.numbers()).zip(&mut this.values) {
                let is_gap = GAPS.contains(&cell.to_lowercase().as_str());
                let value = number.or(is_gap.then_some(f64::NAN));
                values.push(
                    value.ok_or_else(|| fault(row.line, format!("`{cell}` is not a number")))?,
                );
            }
        }
        this.ok_or_else(|| fault(1, "no line with numbers".to_owned()))
    }

    /// A reference without rows, by the lines above them: a heading, and units below it. In a heading separated by blanks names
    /// may have some, too: then it has another number of cells, and tells nothing.
    fn headed(path: &Path, above: &[Vec<String>], n: usize) -> Self {
        let line = |k: usize| above.get(k).filter(|cells| cells.len() == n).cloned();
        Self {
            path: path.to_owned(),
            headings: line(0).unwrap_or_else(|| vec![String::new(); n]),
            units: line(1).unwrap_or_else(|| vec![String::new(); n]),
            values: vec![Vec::new(); n],
        }
    }

    /// The series of a run's column, which has a unit, in that unit and in seconds.
    pub(super) fn series(
        &self,
        (name, unit): (&str, &str),
        columns: &ReferenceColumns,
    ) -> Result<Series, CompareError> {
        let time = match &columns.time {
            Some(time) => self.column(time)?,
            None => (["time", "t"].iter())
                .find_map(|name| self.place(name))
                .unwrap_or(0),
        };
        let value = self.column(columns.value.as_deref().unwrap_or(name))?;
        let (seconds, size) = (self.factor(time, "s")?, self.factor(value, unit)?);
        let times: Vec<f64> = self.values[time].iter().map(|t| t * seconds).collect();
        let ascends = times.iter().all(|t| t.is_finite()) && times.is_sorted_by(|a, b| a < b);
        if !ascends {
            return Err(CompareError::Time {
                path: self.path.clone(),
            });
        }
        Ok(Series {
            time: times,
            value: self.values[value].iter().map(|v| v * size).collect(),
        })
    }

    /// Place of a column by its name or its number from 1.
    fn column(&self, name: &str) -> Result<usize, CompareError> {
        let number = name.parse::<usize>().ok();
        let by_number = number
            .and_then(|number| number.checked_sub(1))
            .filter(|place| *place < self.headings.len());
        let found = self.place(name).or(by_number);
        found.ok_or_else(|| CompareError::NoReferenceColumn {
            path: self.path.clone(),
            name: name.to_owned(),
            present: self.described(),
        })
    }

    /// Place of the only column with a heading, with or without its unit, in whatever case.
    fn place(&self, name: &str) -> Option<usize> {
        let wanted = name.trim().to_lowercase();
        let with = |fits: &dyn Fn(&String) -> bool| {
            let mut places = (0..self.headings.len()).filter(|&k| fits(&self.headings[k]));
            match (places.next(), places.next()) {
                (Some(place), None) => Some(place),
                _ => None,
            }
        };
        if wanted.is_empty() {
            return None;
        }
        with(&|heading| heading.to_lowercase() == wanted)
            .or_else(|| with(&|heading| bare(heading).to_lowercase() == wanted))
    }

    /// Columns with their numbers, for messages.
    fn described(&self) -> String {
        let told = (1..)
            .zip(&self.headings)
            .map(|(number, heading)| match heading.as_str() {
                "" => number.to_string(),
                heading => format!("{number} `{heading}`"),
            });
        told.collect::<Vec<_>>().join(", ")
    }

    /// Units of the run per unit of a column; 1 where either states none.
    fn factor(&self, column: usize, to: &str) -> Result<f64, CompareError> {
        let from = match self.units[column].as_str() {
            "" => Quantity::of(to).map_or("", |quantity| split(&self.headings[column], quantity).1),
            unit => unit.trim_matches(['[', ']', '(', ')']).trim(),
        };
        let from = if from.is_empty() {
            in_brackets(&self.headings[column])
        } else {
            from
        };
        if from.is_empty()
            || to.is_empty()
            || from == to
            || matches!((from, to), ("-" | "1", "-" | "1"))
        {
            return Ok(1.0);
        }
        let quantities = Quantity::ALL.iter();
        let sizes = |quantity: &Quantity| Some(quantity.unit(from)? / quantity.unit(to)?);
        quantities
            .copied()
            .find_map(|quantity| sizes(&quantity))
            .ok_or_else(|| CompareError::ReferenceUnit {
                path: self.path.clone(),
                column: match self.headings[column].as_str() {
                    "" => (column + 1).to_string(),
                    heading => heading.to_owned(),
                },
                found: from.to_owned(),
                wanted: to.to_owned(),
                known: Quantity::of(to)
                    .map_or_else(|| to.to_owned(), |quantity| quantity.known().to_owned()),
            })
    }
}

/// A heading without the unit in its brackets.
fn bare(heading: &str) -> &str {
    let unit = in_brackets(heading);
    if unit.is_empty() {
        return heading;
    }
    heading
        .rsplit_once(['[', '('])
        .map_or(heading, |(name, _)| name.trim())
}

/// Unit in the brackets of a heading; empty without.
fn in_brackets(heading: &str) -> &str {
    // any quantity will do: brackets hold a unit of whatever it is
    let is_bracketed = heading.ends_with([']', ')']);
    if is_bracketed {
        split(heading, Quantity::Length).1
    } else {
        ""
    }
}
