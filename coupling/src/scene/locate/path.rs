//! Paths of fields: `blocks[2].velocity`, `blocks.wedge.shape.length`.

use std::fmt;
use std::ops::Range;

/// A path as written, with the location of each step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FieldPath {
    steps: Vec<Step>,
    spans: Vec<Range<usize>>,
}

/// One step into the scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// Into a field, or into the list element of this name.
    Name(String),
    /// Into an element of a list or tuple, counted from 0.
    Index(usize),
}

/// Reason why a text is not a path.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct PathError {
    /// Fault; lowercase.
    pub message: String,
    /// Location in the path; bytes.
    pub span: Range<usize>,
}

impl FieldPath {
    /// Reads a path. Names stand between dots, numbers in brackets; a name that holds a dot or a
    /// bracket is quoted in brackets, `blocks["no. 3"]`.
    ///
    /// # Errors
    /// When a bracket is not closed or a step is empty.
    pub fn parse(text: &str) -> Result<Self, PathError> {
        let mut path = Self::default();
        let mut at = 0;
        while at < text.len() {
            let rest = text.get(at..).unwrap_or_default();
            let (step, length) = if rest.starts_with('[') {
                bracket_step(rest)
            } else {
                let dot = usize::from(at > 0);
                if dot == 1 && !rest.starts_with('.') {
                    return Err(wrong("expected `.` or `[`", at..text.len()));
                }
                name_step(rest, dot)
            }
            .map_err(|message| wrong(message, at..text.len()))?;
            path.steps.push(step);
            path.spans.push(at..at + length);
            at += length;
        }
        Ok(path)
    }

    /// The steps, outermost first.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Location of step `i` in the parsed text; bytes.
    pub fn span(&self, i: usize) -> Range<usize> {
        self.spans.get(i).cloned().unwrap_or(0..0)
    }

    /// The first `n` steps.
    #[must_use]
    pub fn first(&self, n: usize) -> Self {
        Self {
            steps: self.steps.iter().take(n).cloned().collect(),
            spans: self.spans.iter().take(n).cloned().collect(),
        }
    }
}

impl FromIterator<Step> for FieldPath {
    fn from_iter<I: IntoIterator<Item = Step>>(steps: I) -> Self {
        Self {
            steps: steps.into_iter().collect(),
            spans: Vec::new(),
        }
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, step) in self.steps.iter().enumerate() {
            match step {
                Step::Index(index) => write!(f, "[{index}]")?,
                Step::Name(name) if name.contains(['.', '[', ']']) => write!(f, "[\"{name}\"]")?,
                Step::Name(name) if i == 0 => write!(f, "{name}")?,
                Step::Name(name) => write!(f, ".{name}")?,
            }
        }
        Ok(())
    }
}

fn wrong(message: impl Into<String>, span: Range<usize>) -> PathError {
    PathError {
        message: message.into(),
        span,
    }
}

fn bracket_step(rest: &str) -> Result<(Step, usize), String> {
    if let Some(quoted) = rest.strip_prefix("[\"") {
        let end = quoted.find("\"]").ok_or("`[\"` is not closed")?;
        let name = quoted.get(..end).unwrap_or_default();
        return Ok((Step::Name(name.to_owned()), end + 4));
    }
    let end = rest.find(']').ok_or("`[` is not closed")?;
    let inside = rest.get(1..end).unwrap_or_default();
    let index = inside
        .trim()
        .parse()
        .map_err(|_| format!("expected a number from 0 in brackets, found `{inside}`"))?;
    Ok((Step::Index(index), end + 1))
}

fn name_step(rest: &str, dot: usize) -> Result<(Step, usize), String> {
    let name = rest.get(dot..).unwrap_or_default();
    let name = name.split(['.', '[']).next().unwrap_or_default();
    if name.trim().is_empty() {
        return Err("expected the name of a field".to_owned());
    }
    Ok((Step::Name(name.trim().to_owned()), dot + name.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_written_as_it_was_read() -> Result<(), PathError> {
        for text in [
            "",
            "time.duration",
            "blocks[2].velocity",
            "blocks.west wall.shape.min[0]",
            "gauges[\"p.1\"].x",
        ] {
            assert_eq!(FieldPath::parse(text)?.to_string(), text);
        }
        Ok(())
    }

    #[test]
    fn broken_paths_are_refused() {
        for text in [".a", "a..b", "a[", "a[x]", "a[-1]", "a[0]b", "a.", "a[\"b"] {
            assert!(FieldPath::parse(text).is_err(), "{text}");
        }
    }
}
