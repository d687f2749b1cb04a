//! Fields set from the command line, spliced into the text of a scene.

use super::json_of::json_of;
use crate::files::units;
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::locate::path::FieldPath;
use crate::scene::locate::tree::{Node, NodeKind, Tree};
use crate::scene::locate::{Syntax, line_column};

/// A field set from the command line: `PATH=VALUE`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    /// Path of the field, e.g. `numerics.smoothing_length_ratio` or `blocks.wedge.material`.
    pub path: String,
    /// Its value as RON, in scenes of every language.
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

/// The text with all overrides.
///
/// # Errors
///
/// A [`Problem`] for a path that leads to no possible field.
pub fn overridden(text: &str, syntax: Syntax, overrides: &[Override]) -> Result<String, Problem> {
    let mut text = text.to_owned();
    for change in overrides {
        text = with_field(&text, syntax, change)?;
    }
    Ok(text)
}

fn with_field(text: &str, syntax: Syntax, change: &Override) -> Result<String, Problem> {
    let refuse = |message: String| {
        let message = format!("--set {}: {message}", change.path);
        Problem::error(Code::UnusableOverride, "", message)
    };
    let path = FieldPath::parse(&change.path).map_err(|error| refuse(error.to_string()))?;
    let tree = Tree::of(text, syntax);
    if syntax != Syntax::Ron && tree.flaw.is_some() {
        // the reader tells the flaw in its place
        return Ok(text.to_owned());
    }
    let value = value_in(syntax, &change.value)
        .ok_or_else(|| refuse(format!("`{}` is no value", change.value)))?;
    match tree.walk(&path) {
        Ok(node) => {
            let mut changed = text.to_owned();
            changed.replace_range(node.span.clone(), &value);
            Ok(changed)
        }
        // the last step is a field that the text leaves to its default: it is written in
        Err((Some(parent), reached)) if reached + 1 == path.steps().len() => {
            let field = change.path.rsplit('.').next().unwrap_or_default();
            with_new(&tree, parent, field, &value)
                .ok_or_else(|| refuse("there is no such element".to_owned()))
        }
        // a whole struct is left to its default: it is written with this one field
        Err((Some(parent), reached)) if reached + 2 == path.steps().len() => {
            let mut names = change.path.rsplit('.');
            let (field, group) = (
                names.next().unwrap_or_default(),
                names.next().unwrap_or_default(),
            );
            let value = match syntax {
                Syntax::Ron => format!("({field}: {value})"),
                Syntax::Json | Syntax::Yaml => format!("{{\"{field}\": {value}}}"),
            };
            with_new(&tree, parent, group, &value)
                .ok_or_else(|| refuse("there is no such element".to_owned()))
        }
        Err(_) => Err(refuse(
            "no such field; see docs/reference/scene for all paths".to_owned(),
        )),
    }
}

/// A value in the language of the scene. A quantity needs no quotes here, which a shell takes away.
fn value_in(syntax: Syntax, value: &str) -> Option<String> {
    let is_digits = value.starts_with("0x") || value.starts_with("0b") || value.starts_with("0o");
    let value = match units::is_quantity(value) && !is_digits {
        true => format!("\"{value}\""),
        false => value.to_owned(),
    };
    match syntax {
        Syntax::Ron => Some(value),
        Syntax::Json | Syntax::Yaml => json_of(&value),
    }
}

/// The text with a field that a record of it does not have yet; `None` where `parent` is no record.
fn with_new(tree: &Tree<'_>, parent: &Node, field: &str, value: &str) -> Option<String> {
    let NodeKind::Record { inside, fields, .. } = &parent.kind else {
        return None;
    };
    let before = tree.text.get(..*inside).unwrap_or_default();
    let written = match tree.syntax {
        Syntax::Ron => format!("{field}: {value}, "),
        Syntax::Json | Syntax::Yaml if before.ends_with('{') => {
            let comma = if fields.is_empty() { "" } else { ", " };
            format!("\"{field}\": {value}{comma}")
        }
        // a line of its own above the first field of a block, as far in
        Syntax::Json | Syntax::Yaml => {
            let (_, column) = line_column(tree.text, *inside);
            format!("{field}: {value}\n{}", " ".repeat(column - 1))
        }
    };
    let mut changed = tree.text.to_owned();
    changed.insert_str(*inside, &written);
    Some(changed)
}
