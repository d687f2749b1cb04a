//! Tables of the page, and numbers in them.

use std::path::Path;

use crate::files::table::{TableData, read_table};

/// A table of the page.
pub(super) struct Table {
    pub title: &'static str,
    pub head: Vec<String>,
    /// Texts of each row; numbers are right-aligned but for the first column.
    pub rows: Vec<Vec<String>>,
    /// Remark below it; empty without.
    pub note: String,
}

/// A table of the run; `None` if it has none, or none that is readable: a report of the rest is better than none at all.
pub(super) fn table_of(folder: &Path, name: &str) -> Option<TableData> {
    let table = read_table(&folder.join(name)).ok()?;
    (table.values.first())
        .is_some_and(|time| !time.is_empty())
        .then_some(table)
}

/// Heads of columns.
pub(super) fn heads(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// Size of the unit, with a prefix for thousands, in which the largest of some values is told, and its name.
pub(super) fn scaled(values: impl Iterator<Item = f64>, unit: &str) -> (f64, String) {
    let largest = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
    let prefixes = [(1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")];
    let found = prefixes.into_iter().find(|(size, _)| *size <= largest);
    let (size, prefix) = found.unwrap_or((1.0, ""));
    (size, format!("{prefix}{unit}"))
}

/// A number for a reader: four digits.
pub(super) fn figure(value: f64) -> String {
    let size = value.abs();
    if value.is_nan() {
        "dry".to_owned()
    } else if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e6).contains(&size) {
        let digits = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
        format!("{value:.digits$}")
    } else {
        format!("{value:.3e}")
    }
}

/// Name of a block by its number.
pub(super) fn name_of(names: &[String], id: i32) -> String {
    let name = usize::try_from(id).ok().and_then(|id| names.get(id));
    name.filter(|name| !name.is_empty())
        .map_or_else(|| format!("block {id}"), Clone::clone)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_a_prefix_for_thousands() {
        let told = [0.5, 999.0, 1e3, 2.5e7, 3e15].map(|x| scaled([x, f64::NAN].into_iter(), "N"));
        let expected = [
            (1.0, "N"),
            (1.0, "N"),
            (1e3, "kN"),
            (1e6, "MN"),
            (1e12, "TN"),
        ];
        assert_eq!(told, expected.map(|(size, name)| (size, name.to_owned())));
    }

    #[test]
    fn figures_have_four_digits() {
        let told = [0.0, 0.636_12, 12_345.6, -0.001_234, 7.5e8, f64::NAN].map(figure);
        assert_eq!(
            told,
            ["0", "0.6361", "12346", "-0.001234", "7.500e8", "dry"]
        );
    }
}
