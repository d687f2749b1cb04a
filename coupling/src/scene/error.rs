//! What is wrong with a scene, and where.

/// One thing wrong with (or doubtful in) a scene, found after the text was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Path of the field, e.g. `blocks[1].shape.min`, as `--set` takes it.
    pub path: String,
    /// What was found and what would be right; lowercase, no full stop.
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
