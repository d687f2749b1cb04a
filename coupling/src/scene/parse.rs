//! Scene text ↔ [`SceneFile`], with overrides from the command line spliced into the text so that
//! they pass the same reader and the same checks.

mod words;

use std::ops::Range;

use ron::extensions::Extensions;
use serde::de::DeserializeOwned;

use super::error::Problem;
use super::file::SceneFile;
use super::locate::offset;
use super::locate::path::FieldPath;
use super::locate::tree::{NodeKind, Tree};
use crate::messages::Code;

/// A field set from the command line: `PATH=VALUE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    /// Path of the field, e.g. `numerics.smoothing_length_ratio` or `blocks.wedge.material`.
    pub path: String,
    /// Its value as RON.
    pub value: String,
}

impl std::str::FromStr for Override {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            Some((path, value)) if !path.trim().is_empty() && !value.trim().is_empty() => {
                Ok(Self {
                    path: path.trim().to_owned(),
                    value: value.trim().to_owned(),
                })
            }
            _ => Err(format!(
                "`{text}` is not PATH=VALUE, such as time.duration=2"
            )),
        }
    }
}

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

/// Reads a scene.
///
/// # Errors
///
/// The first deviation from the schema, with a suggestion if a name is close.
pub fn read(text: &str) -> Result<SceneFile, TextError> {
    read_as(text)
}

/// Reads anything of the same dialect.
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

/// The text with all overrides.
///
/// # Errors
///
/// A [`Problem`] for a path that leads to no possible field.
pub fn overridden(text: &str, overrides: &[Override]) -> Result<String, Problem> {
    let mut text = text.to_owned();
    for change in overrides {
        text = with_field(&text, change)?;
    }
    Ok(text)
}

fn with_field(text: &str, change: &Override) -> Result<String, Problem> {
    let refuse = |message: String| {
        Problem::error(
            Code::UnusableOverride,
            "",
            format!("--set {}: {message}", change.path),
        )
    };
    let path = FieldPath::parse(&change.path).map_err(|error| refuse(error.to_string()))?;
    let tree = Tree::new(text);
    match tree.walk(&path) {
        Ok(node) => {
            let mut changed = text.to_owned();
            changed.replace_range(node.span.clone(), &change.value);
            Ok(changed)
        }
        // the last step is a field that the text leaves to its default: it is written in
        Err((Some(parent), reached)) if reached + 1 == path.steps().len() => match &parent.kind {
            NodeKind::Record { inside, .. } => {
                let field = change.path.rsplit('.').next().unwrap_or_default();
                let mut changed = text.to_owned();
                changed.insert_str(*inside, &format!("{field}: {}, ", change.value));
                Ok(changed)
            }
            _ => Err(refuse("there is no such element".to_owned())),
        },
        // a whole struct is left to its default: it is written with this one field
        Err((Some(parent), reached)) if reached + 2 == path.steps().len() => {
            let mut names = change.path.rsplit('.');
            let (field, group) = (
                names.next().unwrap_or_default(),
                names.next().unwrap_or_default(),
            );
            match &parent.kind {
                NodeKind::Record { inside, .. } => {
                    let mut changed = text.to_owned();
                    changed.insert_str(*inside, &format!("{group}: ({field}: {}), ", change.value));
                    Ok(changed)
                }
                _ => Err(refuse("there is no such element".to_owned())),
            }
        }
        Err(_) => Err(refuse(
            "no such field; see cases/README.md for all paths".to_owned(),
        )),
    }
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
        } => format!(
            "unknown field `{found}`{}{}",
            outer
                .as_ref()
                .map_or(String::new(), |outer| format!(" in {outer}")),
            suggestion(found, expected)
        ),
        ron::Error::NoSuchEnumVariant {
            expected,
            found,
            outer,
            ..
        } => format!(
            "unknown variant `{found}`{}{}",
            outer
                .as_ref()
                .map_or(String::new(), |outer| format!(" of {outer}")),
            suggestion(found, expected)
        ),
        ron::Error::MissingStructField { field, outer } => format!(
            "missing field `{field}`{}",
            outer
                .as_ref()
                .map_or(String::new(), |outer| format!(" in {outer}"))
        ),
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

/// Longest list of valid names that is written out; characters.
const LONGEST_LIST: usize = 120;
/// Number of names of a longer list, the closest ones.
const CLOSEST: usize = 6;
/// Shortest beginning of a name that stands for it; bytes.
const SHORTEST_BEGINNING: usize = 4;

/// ", did you mean ...?", or the valid names.
pub fn suggestion(found: &str, expected: &[&str]) -> String {
    let nearest = expected
        .iter()
        .map(|name| (strsim::damerau_levenshtein(found, name), name))
        .min();
    match nearest {
        Some((distance, name)) if distance <= 2.max(found.len() / 3) => {
            format!(", did you mean `{name}`?")
        }
        _ if expected.is_empty() => String::new(),
        _ => match expected.iter().find(|name| begins(name, found)) {
            Some(name) => format!(", did you mean `{name}`?"),
            None => format!("; expected one of {}", listed(found, expected)),
        },
    }
}

fn begins(name: &str, found: &str) -> bool {
    found.len() >= SHORTEST_BEGINNING && name.starts_with(found)
}

/// Valid names, of a long list the closest.
fn listed(found: &str, expected: &[&str]) -> String {
    let all = expected.join(", ");
    if all.len() <= LONGEST_LIST {
        return all;
    }
    let mut names = expected.to_vec();
    names.sort_by_key(|name| strsim::damerau_levenshtein(found, name));
    names.truncate(CLOSEST);
    format!("{}, ... (cases/README.md)", names.join(", "))
}

/// The scene as text that [`read`] reads back to the same scene.
///
/// # Errors
///
/// None in practice: every scene can be written.
pub fn write(scene: &SceneFile) -> Result<String, ron::Error> {
    let style = ron::ser::PrettyConfig::new()
        .extensions(Extensions::IMPLICIT_SOME)
        .depth_limit(6);
    Ok(format!(
        "// {} as riprap {} ran it, every default written out.\n{}\n",
        scene.title.replace('\n', " "),
        env!("CARGO_PKG_VERSION"),
        dialect().to_string_pretty(scene, style)?
    ))
}
