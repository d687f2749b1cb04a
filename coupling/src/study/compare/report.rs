//! Comparison of two tables, as text and as JSON.

use super::reference::{Reference, ReferenceColumns};
use super::{Comparison, Options, Series, compare};
use crate::files::rows::{Comments, Rows};
use crate::files::table::{Column, TableData, TableError, read_table};
use crate::messages::{Code, Coded};
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// One column of two files, compared.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Name of the column.
    pub column: String,
    /// Unit of the column, if either file states one.
    pub unit: String,
    /// The result.
    #[serde(flatten)]
    pub comparison: Comparison,
}

/// Compares the table `computed` with the table `reference`: the requested column, or all columns with common names.
///
/// # Errors
/// [`CompareError`] if a file cannot be read, a column is missing or differs in unit, or times do not ascend.
pub fn compare_files(
    computed: &Path,
    reference: &Path,
    column: Option<&str>,
    options: Options,
) -> Result<Vec<Report>, CompareError> {
    let computed = read_table(computed)?;
    if let (Some(name), Some(series)) = (column, two_columns(reference)) {
        return Ok(vec![Report {
            column: name.to_owned(),
            unit: computed.unit(name)?.to_owned(),
            comparison: compare(&Series::from_table(&computed, name)?, &series, options),
        }]);
    }
    let reference = read_table(reference)?;
    let names = match column {
        Some(name) => vec![name.to_owned()],
        None => shared_columns(&computed, &reference),
    };
    if names.is_empty() {
        return Err(CompareError::NothingShared {
            computed: headers(&computed),
            reference: headers(&reference),
        });
    }
    names
        .into_iter()
        .map(|name| {
            let unit = shared_unit(&computed, &reference, &name)?;
            let (c, r) = (
                Series::from_table(&computed, &name)?,
                Series::from_table(&reference, &name)?,
            );
            Ok(Report {
                column: name,
                unit,
                comparison: compare(&c, &r, options),
            })
        })
        .collect()
}

/// Compares a column of the table `computed` with columns of a reference that has names of its own, or none.
///
/// Units of the reference are converted by its headings. Without `column` the table must have one column beside the time.
///
/// # Errors
/// [`CompareError`] if a file cannot be read, a column is missing, a unit is unknown, or times do not ascend.
pub fn compare_with(
    computed: &Path,
    reference: &Path,
    (column, columns): (Option<&str>, &ReferenceColumns),
    options: Options,
) -> Result<Vec<Report>, CompareError> {
    let computed = read_table(computed)?;
    let values: Vec<&Column> = (computed.columns.iter())
        .filter(|column| !is_time(&column.name))
        .collect();
    let name = match (column, values.as_slice()) {
        (Some(name), _) => name.to_owned(),
        (None, [only]) => only.header(),
        _ => {
            return Err(CompareError::WhichColumn {
                path: computed.path.clone(),
                present: headers(&computed),
            });
        }
    };
    let unit = computed.unit(&name)?.to_owned();
    let series = Reference::read(reference)?.series((&name, &unit), columns)?;
    let comparison = compare(&Series::from_table(&computed, &name)?, &series, options);
    Ok(vec![Report {
        column: computed.name(&name)?.to_owned(),
        unit,
        comparison,
    }])
}

fn is_time(name: &str) -> bool {
    matches!(name, "time" | "t")
}

/// The series of a file with two columns, time and value, of any name; the heading is optional,
/// `#` starts a comment. `None` for any other file, which is then read as a table,
/// with the errors of a table.
fn two_columns(path: &Path) -> Option<Series> {
    let text = std::fs::read_to_string(path).ok()?;
    let mut series = Series::default();
    let mut heading_allowed = true;
    let mut rows = Rows::of(&text, Comments::BehindCells);
    while let Some(row) = rows.next().ok()? {
        let numbers: Vec<Option<f64>> = row.numbers().collect();
        match numbers[..] {
            [Some(time), Some(value)] if series.time.last().is_none_or(|&last| last < time) => {
                series.time.push(time);
                series.value.push(value);
            }
            [None, None] if heading_allowed => {}
            _ => return None,
        }
        heading_allowed = false;
    }
    (series.time.len() > 1).then_some(series)
}

impl Series {
    /// The time column and the column `name` of a table; the time column is called `time` or `t`.
    ///
    /// # Errors
    /// [`CompareError::Table`] if a column is missing, [`CompareError::Time`] if the times do not ascend.
    pub fn from_table(table: &TableData, name: &str) -> Result<Self, CompareError> {
        let time = table
            .column("time")
            .or_else(|error| table.column("t").map_err(|_| error))?;
        let ascends = time.iter().all(|time| time.is_finite())
            && time.windows(2).all(|pair| pair[0] < pair[1]);
        if !ascends {
            return Err(CompareError::Time {
                path: table.path.clone(),
            });
        }
        Ok(Self {
            time: time.to_vec(),
            value: table.column(name)?.to_vec(),
        })
    }
}

fn shared_columns(computed: &TableData, reference: &TableData) -> Vec<String> {
    let names = reference.columns.iter().map(|column| &column.name);
    names
        .filter(|name| !is_time(name))
        .filter(|name| computed.columns.iter().any(|column| column.name == **name))
        .cloned()
        .collect()
}

fn shared_unit(
    computed: &TableData,
    reference: &TableData,
    name: &str,
) -> Result<String, CompareError> {
    match (computed.unit(name)?, reference.unit(name)?) {
        ("", unit) | (unit, "") => Ok(unit.to_owned()),
        (c, r) if c == r => Ok(c.to_owned()),
        (c, r) => Err(CompareError::Unit {
            column: name.to_owned(),
            computed: c.to_owned(),
            reference: r.to_owned(),
        }),
    }
}

fn headers(table: &TableData) -> String {
    table
        .columns
        .iter()
        .map(Column::header)
        .collect::<Vec<_>>()
        .join(", ")
}

/// The reports as text: a paragraph per column.
pub fn text(reports: &[Report]) -> String {
    let mut text = String::new();
    for Report {
        column,
        unit,
        comparison,
    } in reports
    {
        let Comparison {
            normalized_rms_error,
            peak_error,
            trough_error,
            arrival_time_error,
            correlation,
            reference_range,
            n,
            window,
        } = comparison;
        let with_unit = |value: f64| format!("{} {unit}", short(value)).trim_end().to_owned();
        let extreme = |error: Option<f64>| {
            let share = error.zip(reference_range.filter(|&range| range > 0.0));
            let share = share.map_or(String::new(), |(error, range)| {
                format!("  ({:+.1} % of range)", 100.0 * error / range)
            });
            defined(error, with_unit) + &share
        };
        let window = window.map_or("no common samples".to_owned(), |(from, to)| {
            format!("{from:.4} to {to:.4} s")
        });
        let rows = [
            ("window", format!("{window}, n = {n}")),
            (
                "rms error",
                defined(*normalized_rms_error, |e| {
                    format!("{:.2} % of the reference's range", 100.0 * e)
                }),
            ),
            ("peak error", extreme(*peak_error)),
            ("trough error", extreme(*trough_error)),
            (
                "arrival time error",
                defined(*arrival_time_error, |e| format!("{e:+.4} s")),
            ),
            ("correlation", defined(*correlation, |r| format!("{r:.4}"))),
        ];
        text += &Column::new(column, unit).header();
        text += "\n";
        for (label, value) in rows {
            // Writing to a `String` cannot fail.
            let _ = writeln!(text, "  {label:<20}{value}");
        }
    }
    text
}

fn defined(value: Option<f64>, print: impl Fn(f64) -> String) -> String {
    value.map_or("undefined".to_owned(), print)
}

/// With sign and four decimals, or with an exponent where four decimals would hide the number.
fn short(value: f64) -> String {
    if value == 0.0 || (1e-2..1e6).contains(&value.abs()) {
        format!("{value:+.4}")
    } else {
        format!("{value:+.3e}")
    }
}

/// The reports as JSON: an array of objects, `null` where undefined.
///
/// # Errors
/// As of `serde_json`; not expected for numbers and names.
pub fn json(reports: &[Report]) -> Result<String, serde_json::Error> {
    serde_json::to_string_pretty(reports)
}

/// Error of a comparison.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// A table cannot be read, or a column is missing.
    #[error(transparent)]
    Table(#[from] TableError),
    /// Times are missing or do not ascend.
    #[error("{}: times must be finite and ascend from line to line", path.display())]
    Time {
        /// The file.
        path: PathBuf,
    },
    /// A common name with two units.
    #[error(
        "column `{column}` has unit {computed} here and {reference} in the reference; convert one of them"
    )]
    Unit {
        /// The column.
        column: String,
        /// Its unit in the computed table.
        computed: String,
        /// Its unit in the reference.
        reference: String,
    },
    /// A reference that cannot be opened.
    #[error("cannot read {}: {cause}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        cause: std::io::Error,
    },
    /// A faulty line of a reference.
    #[error("{}, line {line}: {what}", path.display())]
    Reference {
        /// The file.
        path: PathBuf,
        /// Number of the line; the first is 1.
        line: usize,
        /// Value found and what is expected.
        what: String,
    },
    /// A named column that a reference does not have.
    #[error("{}: no column `{name}`, or several; its columns: {present}; name one with --reference-column, by its heading or its number, and the times with --reference-time", path.display())]
    NoReferenceColumn {
        /// The file.
        path: PathBuf,
        /// Name asked for.
        name: String,
        /// Columns that it has.
        present: String,
    },
    /// A unit that cannot be converted to that of the run.
    #[error("{}: column `{column}` is in {found}, and the run in {wanted}; convertible are {known}", path.display())]
    ReferenceUnit {
        /// The file.
        path: PathBuf,
        /// Its column.
        column: String,
        /// Its unit.
        found: String,
        /// Unit of the run.
        wanted: String,
        /// Units of the same quantity.
        known: String,
    },
    /// A table with several columns, of which none was named.
    #[error("{}: name a column of the run with --column; its columns: {present}", path.display())]
    WhichColumn {
        /// The file.
        path: PathBuf,
        /// Columns that it has.
        present: String,
    },
    /// No common column.
    #[error("no column common to both tables; computed: {computed}; reference: {reference}")]
    NothingShared {
        /// Columns of the computed table.
        computed: String,
        /// Columns of the reference.
        reference: String,
    },
}

impl Coded for CompareError {
    fn code(&self) -> Code {
        match self {
            Self::Table(error) => error.code(),
            Self::Read { .. } => Code::FileNotReadable,
            Self::Reference { .. } => Code::UnusableFile,
            Self::Time { .. } => Code::ValuesOutOfOrder,
            Self::Unit { .. }
            | Self::NoReferenceColumn { .. }
            | Self::ReferenceUnit { .. }
            | Self::WhichColumn { .. }
            | Self::NothingShared { .. } => Code::NothingToCompare,
        }
    }
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;

    /// Reports on two tables given as text, or the message.
    fn compared(
        computed: &str,
        reference: &str,
        column: Option<&str>,
    ) -> Result<Vec<Report>, String> {
        let folder = tempfile::tempdir().unwrap();
        let [c, r] = ["gauges.csv", "reference.csv"].map(|name| folder.path().join(name));
        std::fs::write(&c, computed).unwrap();
        std::fs::write(&r, reference).unwrap();
        let prefix = format!("{}/", folder.path().display());
        compare_files(&c, &r, column, Options::default())
            .map_err(|error| error.to_string().replace(&prefix, ""))
    }

    const COMPUTED: &str = "time [s],g1 [m],g2 [m]\n0,0,1\n1,1.1,1\n2,0,1\n";

    #[test]
    fn a_report_for_people() {
        let reports = compared(
            COMPUTED,
            "# figure 3\nt [s],g2,g1 [m]\n0,1,0\n1,1,1\n2,1,0\n",
            None,
        )
        .unwrap();
        let expected = "\
g2 [m]
  window              0.0000 to 2.0000 s, n = 3
  rms error           undefined
  peak error          +0.0000 m
  trough error        +0.0000 m
  arrival time error  undefined
  correlation         undefined
g1 [m]
  window              0.0000 to 2.0000 s, n = 3
  rms error           5.77 % of the reference's range
  peak error          +0.1000 m  (+10.0 % of range)
  trough error        +0.0000 m  (+0.0 % of range)
  arrival time error  -0.0091 s
  correlation         1.0000
";
        assert_eq!(text(&reports), expected);
    }

    #[test]
    fn a_report_for_programs() {
        let reports = compared(COMPUTED, "time [s],g2 [m]\n0,1\n1,1\n", Some("g2")).unwrap();
        let found: serde_json::Value = serde_json::from_str(&json(&reports).unwrap()).unwrap();
        let expected = serde_json::json!([{
            "column": "g2", "unit": "m", "normalized_rms_error": null, "peak_error": 0.0, "trough_error": 0.0,
            "arrival_time_error": null, "correlation": null, "reference_range": 0.0, "n": 2, "window": [0.0, 1.0],
        }]);
        assert_eq!(found, expected);
    }

    #[test]
    fn errors_say_what_to_do() {
        let cases = [
            (
                "time [s],g1 [mm]\n0,1\n",
                "column `g1` has unit m here and mm in the reference; convert one of them",
            ),
            (
                "time [s],g7 [m]\n0,1\n",
                "no column common to both tables; computed: time [s], g1 [m], g2 [m]; reference: time [s], g7 [m]",
            ),
            (
                "time [s],g1 [m]\n0,1\n0,1\n",
                "reference.csv: times must be finite and ascend from line to line",
            ),
            (
                "x [m],g1 [m]\n0,1\n",
                "reference.csv: column `time` missing or not unique; available: x [m], g1 [m]",
            ),
        ];
        for (reference, message) in cases {
            assert_eq!(compared(COMPUTED, reference, None), Err(message.to_owned()));
        }
    }
}
