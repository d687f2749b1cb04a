//! `riprap.Gauges`: readings by name.

use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyIterator, PyList};
use riprap::output::observe::gauges::Reading;

use crate::world::World;

/// The gauges of a world.
#[pyclass(frozen, module = "riprap", mapping)]
#[derive(Debug)]
pub struct Gauges {
    world: Py<World>,
}

impl Gauges {
    pub fn of(world: Py<World>) -> Self {
        Self { world }
    }

    fn names(&self) -> &[String] {
        &self.world.get().constants.gauge_names
    }

    fn reading(&self, py: Python<'_>, name: &str) -> PyResult<Option<Reading>> {
        let name = name.to_owned();
        self.world.get().engine.ask(py, move |engine| {
            let world = engine.world()?;
            Ok(engine.gauges().read(&name, world))
        })
    }
}

#[pymethods]
impl Gauges {
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let Some(reading) = self.reading(py, name)? else {
            let names: Vec<&str> = self.names().iter().map(String::as_str).collect();
            let close = riprap::scene::parse::suggestion(name, &names);
            return Err(PyKeyError::new_err(format!("no gauge `{name}`{close}")));
        };
        if let [value] = reading.values.as_slice() {
            return Ok(PyFloat::new(py, *value).into_any());
        }
        let values = PyDict::new(py);
        for (column, value) in reading.columns.iter().zip(reading.values) {
            // of `g.vx`, what follows the name of the gauge
            let part = column.name.strip_prefix(name).unwrap_or(&column.name);
            values.set_item(part.trim_start_matches('.'), value)?;
        }
        Ok(values.into_any())
    }

    fn __contains__(&self, name: &str) -> bool {
        self.names().iter().any(|other| other == name)
    }

    fn __len__(&self) -> usize {
        self.names().len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        PyList::new(py, self.names())?.try_iter()
    }

    /// Names of the gauges.
    fn keys(&self) -> Vec<String> {
        self.names().to_vec()
    }
}
