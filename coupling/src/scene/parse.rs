//! Scene text ↔ [`SceneFile`], with overrides from the command line spliced into the text so that
//! they pass the same reader and the same checks.
//!
//! RON is read by its own crate, whose errors `words` explains; JSON and YAML are read from the tree that locates fields, by
//! `typed`. Quantities with units are found by the latter in all three.

mod json_of;
mod overrides;
mod quantities;
mod suggest;
mod typed;
mod words;

use std::ops::Range;

use ron::extensions::Extensions;
use serde::de::DeserializeOwned;

use super::file::SceneFile;
use super::locate::tree::{NodeKind, Tree};
use super::locate::{Syntax, offset};
use crate::messages::Code;
pub use overrides::{Override, overridden};
pub use suggest::suggestion;
use suggest::{missing_field, unknown_field, unknown_variant};

/// Error of parsing a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextError {
    /// Cause, as the guide explains it.
    pub code: Code,
    /// Value found and values allowed.
    pub message: String,
    /// Location in the text; bytes.
    pub span: Range<usize>,
}

fn dialect() -> ron::Options {
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

/// Reads a scene in RON.
///
/// # Errors
///
/// The first deviation from the schema, with a suggestion if a name is close.
pub fn read(text: &str) -> Result<SceneFile, TextError> {
    read_in(text, Syntax::Ron)
}

/// Reads a scene in a language.
///
/// # Errors
///
/// As [`read`].
pub fn read_in(text: &str, syntax: Syntax) -> Result<SceneFile, TextError> {
    let tree = Tree::of(text, syntax);
    if syntax != Syntax::Ron {
        return typed::value(&tree);
    }
    let plain = quantities::plain(&tree)?;
    read_as(&plain.text).map_err(|error| TextError {
        span: plain.written(error.span.start)..plain.written(error.span.end),
        ..error
    })
}

/// Reads anything of the same dialect, without quantities.
///
/// # Errors
///
/// [`TextError`], as for [`read`].
pub fn read_as<T: DeserializeOwned>(text: &str) -> Result<T, TextError> {
    let scene: T = dialect().from_str(text).map_err(|error| {
        let start = offset(text, error.span.start.line, error.span.start.col);
        let end = offset(text, error.span.end.line, error.span.end.col).max(start);
        let (message, span) = words::mistake(text, &error.code, start)
            .unwrap_or_else(|| (explain(&error.code), start..end));
        TextError {
            code: code(&error.code),
            message,
            span,
        }
    })?;
    // RON reads inf and NaN as numbers; a scene has no use for either
    let tree = Tree::new(text);
    for (path, node) in tree.paths() {
        let word = tree.slice(&node.span);
        if matches!(node.kind, NodeKind::Word)
            && matches!(word.trim_start_matches(['-', '+']), "inf" | "NaN")
        {
            return Err(TextError {
                code: Code::NumberNotFinite,
                message: format!("`{path}` is {word}; a number must be finite"),
                span: node.span.clone(),
            });
        }
        // a literal such as 1e999 reads as infinity too
        if matches!(node.kind, NodeKind::Word) && word.parse::<f64>().is_ok_and(f64::is_infinite) {
            return Err(TextError {
                code: Code::NumberNotFinite,
                message: format!("`{path}` is {word}, more than a number can hold"),
                span: node.span.clone(),
            });
        }
    }
    Ok(scene)
}

/// Cause of an error of RON.
fn code(error: &ron::Error) -> Code {
    match error {
        ron::Error::NoSuchStructField { .. } => Code::UnknownField,
        ron::Error::NoSuchEnumVariant { .. } => Code::UnknownKind,
        ron::Error::MissingStructField { .. } => Code::MissingField,
        ron::Error::DuplicateStructField { .. } => Code::WrittenTwice,
        _ => Code::SceneSyntax,
    }
}

/// Error of RON in the words of the other messages, with the closest name.
fn explain(error: &ron::Error) -> String {
    match error {
        ron::Error::NoSuchStructField {
            expected,
            found,
            outer,
            ..
        } => unknown_field(found, outer.as_deref(), expected),
        ron::Error::NoSuchEnumVariant {
            expected,
            found,
            outer,
            ..
        } => unknown_variant(found, outer.as_deref(), expected),
        ron::Error::MissingStructField { field, outer } => missing_field(field, outer.as_deref()),
        other => {
            let message = other.to_string();
            let mut letters = message.chars();
            letters
                .next()
                .map(|first| first.to_lowercase().collect::<String>() + letters.as_str())
                .unwrap_or_default()
        }
    }
}

/// The scene as text that [`read`] reads back to the same scene.
///
/// # Errors
///
/// None in practice: every scene can be written.
pub fn write(scene: &SceneFile) -> Result<String, ron::Error> {
    write_noted(scene, "")
}

/// As [`write`](fn@write), with comment lines under the title.
///
/// # Errors
///
/// Those of [`write`](fn@write).
pub fn write_noted(scene: &SceneFile, note: &str) -> Result<String, ron::Error> {
    let style = ron::ser::PrettyConfig::new()
        .extensions(Extensions::IMPLICIT_SOME)
        .depth_limit(6);
    Ok(format!(
        "// {} as riprap {} ran it, every default written out.\n{note}{}\n",
        scene.title.replace('\n', " "),
        env!("CARGO_PKG_VERSION"),
        dialect().to_string_pretty(scene, style)?
    ))
}

/// Comment lines under the title of a text that [`write_noted`] wrote.
pub(crate) fn note(text: &str) -> String {
    let lines = text.split_inclusive('\n').skip(1);
    lines.take_while(|line| line.starts_with("//")).collect()
}
