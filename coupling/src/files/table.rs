//! Tables of numbers over time: gauges, energies, reference records.
//!
//! Comma-separated text with one header line, `time [s],g1 [m]`, and a number per column and line, with enough digits to
//! restore the same bits. A gap is `NaN`. Columns `name` and `partner_name`, the last ones of tables of blocks, are text. Input
//! tables may also have other separators, decimal commas, comment lines, which start with `#`, blank lines, and empty cells, which
//! are gaps. A table of texts has them beside numbers.

mod error;
mod npy;
mod read;
mod text;
mod write;

pub use error::{LineFault, TableError};
pub use npy::{NpyKind, NpyTable, read_npy};
pub use read::{TableData, read_table, table_from};
pub(crate) use text::{TextRow, TextTable, texts};
pub use write::{Cell, Start, Table};

/// Columns of text, without a unit: names of blocks.
pub(crate) const TEXTS: [&str; 2] = ["name", "partner_name"];

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

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use std::fs;
    use std::path::Path;

    use proptest::prelude::*;

    use super::*;

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
    fn one_table_in_every_dialect() {
        for text in [
            "time [s],\"g; 1 [m]\"\n0.5,1.25\n1.0,\n",
            "time [s];\"g; 1 [m]\";\r\n0,5;1,25;\r\n1,0;;\r\n",
            "time [s]\tg; 1 [m]\n0,5\t1.25\n# lost\n1\tnan\n",
            "time [s] \"g; 1\" [m]\n 0.5   1.25\n 1.0\tNaN\n",
        ] {
            let data = parsed(text).unwrap();
            assert_eq!(data.column("time [s]").unwrap(), [0.5, 1.0], "{text}");
            let gauge = data.column("g; 1 [m]").unwrap();
            assert!(gauge[0] == 1.25 && gauge[1].is_nan(), "{text}");
        }
        let one = parsed("wave height [m]\n0.5\n").unwrap();
        assert_eq!(one.column("wave height [m]").unwrap(), [0.5]);
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
            (
                "time [s],g1 [m]\n0,1\n# b\n1,\"2\n2,3\n",
                "x.csv, line 4: a quote opens here and does not close on the line",
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
