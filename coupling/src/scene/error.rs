//! Errors of a scene, with their location.

/// One thing wrong with (or doubtful in) a scene, found after the text was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Path of the field, e.g. `blocks[1].shape.min`, as `--set` takes it.
    pub path: String,
    /// Value found and values allowed; lowercase, no full stop.
    pub message: String,
    /// Whether the scene can run all the same.
    pub severity: Severity,
}

/// Whether a problem stops a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The scene cannot run.
    Error,
    /// The scene runs; the user should know.
    Warning,
}

impl Problem {
    /// A problem that stops the scene.
    pub fn error(path: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            path: path.into(),
            message: message.into(),
            severity: Severity::Error,
        }
    }

    /// A problem that the user should know of.
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

/// Problems of a scene in their places.
#[derive(Debug)]
pub struct SceneError {
    file: String,
    source: NamedSource<String>,
    located: Vec<Located>,
}

/// A problem with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Located {
    /// Fault.
    pub message: String,
    /// Bytes of the text.
    pub span: Range<usize>,
    /// From 1.
    pub line: usize,
    /// From 1.
    pub column: usize,
    /// Whether it stops the scene.
    pub severity: Severity,
}

impl SceneError {
    /// Problems found in a text that was read.
    pub fn from_problems(file: &str, text: &str, problems: Vec<Problem>) -> Self {
        let located = problems
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

    /// The one thing that keeps a text from being read.
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
            LabeledSpan::new_with_span(Some(problem.message.clone()), problem.span.clone())
        })))
    }
}
