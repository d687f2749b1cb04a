//! Values of Python as text of a scene.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

/// A value as it is written in a scene. Text stands as it is.
pub fn written(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if value.is_none() {
        return Ok("None".to_owned());
    }
    if let Ok(text) = value.cast::<PyString>() {
        return text.extract();
    }
    if let Ok(truth) = value.cast::<PyBool>() {
        return Ok(truth.is_true().to_string());
    }
    if value.is_instance_of::<PyInt>() {
        return Ok(value.str()?.to_string());
    }
    if let Ok(number) = value.cast::<PyFloat>() {
        return number_written(number.value());
    }
    if let Ok(fields) = value.cast::<PyDict>() {
        let fields: Vec<String> = fields
            .iter()
            .map(|(name, value)| Ok(format!("{}: {}", name.str()?, written(&value)?)))
            .collect::<PyResult<_>>()?;
        return Ok(format!("({})", fields.join(", ")));
    }
    if value.is_instance_of::<PyTuple>() {
        return Ok(format!("({})", elements(value)?));
    }
    if value.is_instance_of::<PyList>() {
        return Ok(format!("[{}]", elements(value)?));
    }
    if value.hasattr("__fspath__")? {
        let path: String = value.call_method0("__fspath__")?.extract()?;
        return Ok(format!("{path:?}"));
    }
    // a number of numpy
    if value.hasattr("item")? && value.getattr("ndim")?.extract::<usize>()? == 0 {
        return written(&value.call_method0("item")?);
    }
    Err(PyTypeError::new_err(format!(
        "a field of a scene is text, a number, a truth value, a path, or a tuple, list or dict of these; found {}",
        value.get_type().name()?
    )))
}

fn elements(values: &Bound<'_, PyAny>) -> PyResult<String> {
    let values: Vec<String> = values
        .try_iter()?
        .map(|value| written(&value?))
        .collect::<PyResult<_>>()?;
    Ok(values.join(", "))
}

fn number_written(number: f64) -> PyResult<String> {
    if number.is_finite() {
        // as many digits as restore the same bits
        Ok(format!("{number:?}"))
    } else {
        Err(PyValueError::new_err(format!(
            "a number of a scene must be finite, found {number}"
        )))
    }
}
