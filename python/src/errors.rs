//! Errors of riprap as exceptions, which are classes of `riprap._errors`.

use pyo3::prelude::*;
use riprap::scene::error::{SceneError, Severity};

/// Line, column, severity, message and code of a problem.
type ProblemRow = (usize, usize, &'static str, String, &'static str);

/// `riprap.SceneError` with its problems.
pub fn scene_error(py: Python<'_>, error: &SceneError) -> PyErr {
    made(py, "SceneError", (error.to_string(), rows(error)))
}

/// `riprap.RunError` with its code.
pub fn run_error(py: Python<'_>, message: &str, code: &str) -> PyErr {
    made(py, "RunError", (message, code))
}

/// Problems of a scene as `riprap.Problem`.
pub fn problems(py: Python<'_>, error: &SceneError) -> PyResult<Vec<Py<PyAny>>> {
    let class = py.import("riprap._errors")?.getattr("Problem")?;
    let made = rows(error)
        .into_iter()
        .map(|row| Ok(class.call1(row)?.unbind()));
    made.collect()
}

/// Problems in the order they were found.
fn rows(error: &SceneError) -> Vec<ProblemRow> {
    let row = |problem: &riprap::scene::error::Located| {
        let severity = match problem.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        (
            problem.line,
            problem.column,
            severity,
            problem.message.clone(),
            problem.code.as_str(),
        )
    };
    error.located().iter().map(row).collect()
}

fn made<'py>(py: Python<'py>, class: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let exception = py
        .import("riprap._errors")
        .and_then(|module| module.getattr(class))
        .and_then(|class| class.call1(arguments));
    match exception {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}
