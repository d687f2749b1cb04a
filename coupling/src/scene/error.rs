//! Errors of a scene, with their location.

mod condensed;

/// A fault or doubtful point of a scene, found after the text was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Path of the field, e.g. `blocks[1].shape.min`, as `--set` takes it.
    pub path: String,
    /// Value found and values allowed; lowercase, no full stop.
    pub message: String,
    /// Severity.
    pub severity: Severity,
}

/// Severity of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The scene cannot run.
    Error,
    /// The scene runs, with a warning.
    Warning,
}

impl Problem {
    /// Error, which stops the scene.
    pub fn error(path: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            path: path.into(),
            message: message.into(),
            severity: Severity::Error,
        }
    }

    /// Warning.
    pub fn warning(path: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            path: path.into(),
            message: message.into(),
            severity: Severity::Warning,
        }
    }
}

use std::ops::Range;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

use super::locate::{Place, line_column, locate};
use condensed::condensed;

/// Problems of a scene, located in its text.
#[derive(Debug)]
pub struct SceneError {
    file: String,
    source: NamedSource<String>,
    located: Vec<Located>,
}

/// A located problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Located {
    /// Fault.
    pub message: String,
    /// Location in the text; bytes.
    pub span: Range<usize>,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// Severity.
    pub severity: Severity,
}

impl SceneError {
    /// Problems found in a text that was read. Of many of one kind the first are told, and the others counted.
    pub fn from_problems(file: &str, text: &str, problems: Vec<Problem>) -> Self {
        let located = condensed(problems)
            .into_iter()
            .map(|problem| {
                let Place { span, line, column } = locate(text, &problem.path);
                Located {
                    message: problem.message,
                    span,
                    line,
                    column,
                    severity: problem.severity,
                }
            })
            .collect();
        Self::new(file, text, located)
    }

    /// Error of reading a text.
    pub fn at_span(file: &str, text: &str, span: Range<usize>, message: String) -> Self {
        let (line, column) = line_column(text, span.start);
        let located = Located {
            message,
            span,
            line,
            column,
            severity: Severity::Error,
        };
        Self::new(file, text, vec![located])
    }

    fn new(file: &str, text: &str, located: Vec<Located>) -> Self {
        Self {
            file: file.to_owned(),
            source: NamedSource::new(file, text.to_owned()),
            located,
        }
    }

    /// The problems in the order they were found.
    pub fn located(&self) -> &[Located] {
        &self.located
    }
}

/// A line per problem: `file:line:column: error: what`.
impl std::fmt::Display for SceneError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (index, problem) in self.located.iter().enumerate() {
            let kind = match problem.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
            };
            let Located {
                line,
                column,
                message,
                ..
            } = problem;
            let end = if index == 0 { "" } else { "\n" };
            write!(f, "{end}{}:{line}:{column}: {kind}: {message}", self.file)?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}

impl Diagnostic for SceneError {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.located.iter().map(|problem| {
            // the message is above the frame, with the line
            LabeledSpan::new_with_span(None, problem.span.clone())
        })))
    }
}
