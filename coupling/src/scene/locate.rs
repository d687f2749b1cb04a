//! Location of a field in the text, from its path.
//!
//! RON keeps no locations once a scene is read, and its own errors end at the first. So the text is read a second time by
//! a small reader that minds only brackets, names and commas, and therefore works on broken text, too. JSON and YAML become the same
//! tree, which paths, checks and overrides then treat alike.

mod json;
pub mod path;
mod ron;
mod syntax;
mod token;
pub mod tree;
mod yaml;

use std::ops::Range;

use path::FieldPath;
pub use syntax::Syntax;
use tree::Tree;

/// A location in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Bytes of the text.
    pub span: Range<usize>,
    /// Line of its start, from 1.
    pub line: usize,
    /// Character of its start in that line, from 1.
    pub column: usize,
}

/// Location of the value of `path` in a text. A value without text, such as a default, is
/// located at the nearest enclosing value with text.
pub fn locate(tree: &Tree<'_>, path: &str) -> Place {
    let text = tree.text;
    let span = span_of(tree, path);
    let (line, column) = line_column(text, span.start);
    Place { span, line, column }
}

/// Location as [`locate`] finds it, in a text whose tree is known; bytes.
pub fn span_of(tree: &Tree<'_>, path: &str) -> Range<usize> {
    // A broken path is no reason to lose the message it came with: it is placed at the start.
    let path = FieldPath::parse(path).unwrap_or_default();
    match tree.walk(&path) {
        Ok(node) | Err((Some(node), _)) => node.span.clone(),
        Err((None, _)) => 0..0,
    }
}

/// Path of the innermost value that has a byte of the text; empty outside of all.
pub fn path_at(tree: &Tree<'_>, at: usize) -> String {
    let around = (tree.paths().into_iter()).filter(|(_, node)| node.span.contains(&at));
    let innermost = around.min_by_key(|(_, node)| node.span.len());
    innermost.map_or_else(String::new, |(path, _)| path.to_string())
}

/// Line and column, both from 1, of the byte `at`; columns count characters.
pub fn line_column(text: &str, at: usize) -> (usize, usize) {
    let before = text.get(..at).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.matches('\n').count() + 1;
    let column = before.get(line_start..).unwrap_or_default();
    // A byte order mark takes no column on any screen.
    let column = column.trim_start_matches('\u{feff}').chars().count() + 1;
    (line, column)
}

/// The byte at a line and column, both from 1; the end of the text when it is shorter.
pub fn offset(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text
        .split_inclusive('\n')
        .take(line.saturating_sub(1))
        .map(str::len)
        .sum();
    let rest = text.get(start..).unwrap_or_default();
    let within = rest.char_indices().nth(column.saturating_sub(1));
    start + within.map_or(rest.len(), |(at, _)| at)
}
