//! Quantities with units in RON, written as plain numbers before the text is read.

use std::ops::Range;

use super::{TextError, typed};
use crate::files::units;
use crate::scene::file::SceneFile;
use crate::scene::locate::tree::{NodeKind, Tree};

/// A text whose quantities are plain numbers.
pub(super) struct Plain {
    pub(super) text: String,
    /// Quantities as written, and the end of each number in the new text; in the order of the text.
    replaced: Vec<(Range<usize>, usize)>,
}

impl Plain {
    /// The byte of the text as written that stands for a byte of the new one.
    pub(super) fn written(&self, at: usize) -> usize {
        let before = self.replaced.iter().take_while(|(_, end)| *end <= at);
        match before.last() {
            Some((span, end)) => span.end + (at - end),
            None => at,
        }
    }
}

/// The text with plain numbers in the units of their fields.
///
/// # Errors
///
/// The first quantity in a unit that its field does not take.
pub(super) fn plain(tree: &Tree<'_>) -> Result<Plain, TextError> {
    let mut plain = Plain {
        text: tree.text.to_owned(),
        replaced: Vec::new(),
    };
    let is_quantity = |content: &str| units::is_quantity(content);
    let has_any = tree.paths().iter().any(|(_, node)| {
        matches!(node.kind, NodeKind::Text)
            && tree
                .content(node)
                .is_some_and(|content| is_quantity(&content))
    });
    if !has_any {
        return Ok(plain);
    }
    let (found, mut quantities) = typed::read::<SceneFile>(tree);
    // any other fault is answered by the reader of RON
    if let Err(error) = found
        && error.is_of_quantity()
    {
        return Err(error.into_text_error());
    }
    quantities.sort_by_key(|quantity| quantity.span.start);
    let (mut text, mut at) = (String::with_capacity(tree.text.len()), 0);
    for typed::Quantity { span, value } in quantities {
        text.push_str(tree.slice(&(at..span.start)));
        text.push_str(&format!("{value:?}"));
        at = span.end;
        plain.replaced.push((span, text.len()));
    }
    text.push_str(tree.slice(&(at..tree.text.len())));
    plain.text = text;
    Ok(plain)
}
