//! Errors of a scene, with their location.

mod condensed;

use crate::messages::{Code, Coded, Message, with_code};

/// A fault or doubtful point of a scene, found after the text was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Cause, as the guide explains it.
    pub code: Code,
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
    pub fn error(code: Code, path: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            code,
            path: path.into(),
            message: message.into(),
            severity: Severity::Error,
        }
    }

    /// Warning.
    pub fn warning(code: Code, path: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            code,
            path: path.into(),
            message: message.into(),
            severity: Severity::Warning,
        }
    }
}

use std::ops::Range;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

use super::locate::tree::Tree;
use super::locate::{Place, Syntax, line_column, locate, path_at};
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
    /// Cause, as the guide explains it.
    pub code: Code,
    /// Path of the field, of a text that cannot be read the one that the fault is in; empty for the scene as a whole.
    pub path: String,
    /// The first line of the text there.
    pub found: String,
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
    /// Problems found in a text that was read, in the language that the name of its file tells. Of many of one kind the first
    /// are told, and the others counted.
    pub fn from_problems(file: &str, text: &str, problems: Vec<Problem>) -> Self {
        let tree = Tree::of(text, Syntax::of(file));
        let located = condensed(problems)
            .into_iter()
            .map(|problem| {
                let Place { span, line, column } = locate(&tree, &problem.path);
                Located {
                    code: problem.code,
                    found: first_line(text, &span),
                    path: problem.path,
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
    pub fn at_span(file: &str, text: &str, span: Range<usize>, message: &Message) -> Self {
        let (line, column) = line_column(text, span.start);
        let located = Located {
            code: message.code(),
            path: path_at(&Tree::of(text, Syntax::of(file)), span.start),
            found: first_line(text, &span),
            message: message.to_string(),
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

    /// The file, as it was named.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The problems in the order they were found.
    pub fn located(&self) -> &[Located] {
        &self.located
    }
}

/// The first line of a span.
fn first_line(text: &str, span: &Range<usize>) -> String {
    let found = text.get(span.clone()).unwrap_or_default();
    found.lines().next().unwrap_or_default().to_owned()
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
                code,
                ..
            } = problem;
            let message = with_code(message, *code);
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
