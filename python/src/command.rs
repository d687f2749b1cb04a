//! The command line.

use std::ffi::OsString;

use pyo3::prelude::*;
use riprap::cli::{Program, execute};

/// Runs the command line with some arguments, the first of which is the name of the program; returns its exit code.
///
/// `program` starts it again, for runs in processes of their own.
#[pyfunction]
pub fn command(py: Python<'_>, arguments: Vec<OsString>, program: Vec<OsString>) -> u8 {
    let mut program = program.into_iter();
    let program = match program.next() {
        Some(interpreter) => Program::Interpreted(interpreter, program.collect()),
        None => Program::ThisExecutable,
    };
    py.detach(|| execute(arguments, &program))
}
