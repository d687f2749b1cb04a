//! Tables and comparisons.

use std::path::PathBuf;

use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use riprap::scene::geometry::terrain::sources::is_surface;
use riprap::study::compare::surfaces::{self, compare_surfaces, load};
use riprap::study::compare::{self, Options};
use riprap::study::trade::plan::Study;

use crate::errors::scene_error;
use crate::wait::for_work;

/// A column of a table: name, unit, values.
type Column<'py> = (String, String, Bound<'py, PyArray1<f64>>);

/// Columns of a table of numbers.
#[pyfunction]
pub fn read_table(py: Python<'_>, path: PathBuf) -> PyResult<Vec<Column<'_>>> {
    let table = py.detach(|| riprap::files::table::read_table(&path));
    let table = table.map_err(refused)?;
    let columns = table.columns.into_iter().zip(table.values);
    let columns = columns.map(|(column, values)| {
        let values = PyArray1::from_vec(py, values);
        (column.name, column.unit, values)
    });
    Ok(columns.collect())
}

/// Comparison of two tables over time or of two surfaces, as JSON, and whether it is one of surfaces.
///
/// `window` is the start and the end of a comparison of tables in the time of the reference; `cell` is of surfaces.
#[pyfunction]
pub fn compare_files(
    py: Python<'_>,
    files: (PathBuf, PathBuf),
    column: Option<String>,
    shift: f64,
    window: (Option<f64>, Option<f64>),
    cell: Option<f64>,
) -> PyResult<(bool, String)> {
    let (computed, reference) = files;
    let is_surface = |path: &PathBuf| path.is_dir() || is_surface(&path.to_string_lossy());
    if is_surface(&computed) || is_surface(&reference) {
        let found = for_work(py, move || {
            compare_surfaces(&load(&computed)?, &load(&reference)?, cell)
        })?;
        let text = surfaces::json(&found.map_err(refused)?).map_err(refused)?;
        return Ok((true, text));
    }
    let options = Options {
        shift,
        from: window.0,
        to: window.1,
        ..Options::default()
    };
    let reports = compare::compare_files(&computed, &reference, column.as_deref(), options);
    let text = compare::json(&reports.map_err(refused)?).map_err(refused)?;
    Ok((false, text))
}

/// Reads and checks the file of a study.
#[pyfunction]
pub fn check_study(py: Python<'_>, path: PathBuf) -> PyResult<()> {
    let study = for_work(py, move || Study::load(&path).map(|_| ()))?;
    study.map_err(|error| scene_error(py, &error))
}

fn refused(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}
