//! Problems of a scene for programs.

use serde::Serialize;

use crate::scene::error::{Located, SceneError, Severity};

/// A problem of a scene under stable names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Problem<'a> {
    severity: &'static str,
    code: &'static str,
    file: &'a str,
    line: usize,
    column: usize,
    path: &'a str,
    found: &'a str,
    message: &'a str,
}

impl<'a> Problem<'a> {
    fn of(located: &'a Located, file: &'a str) -> Self {
        let Located {
            code,
            path,
            found,
            message,
            line,
            column,
            severity,
            span: _,
        } = located;
        Self {
            severity: match severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
            },
            code: code.as_str(),
            file,
            line: *line,
            column: *column,
            path,
            found,
            message,
        }
    }
}

/// The problems of a scene in the order they were found.
pub(crate) fn problems(error: &SceneError) -> Vec<Problem<'_>> {
    let located = error.located().iter();
    located
        .map(|located| Problem::of(located, error.file()))
        .collect()
}
