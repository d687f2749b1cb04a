//! Words and signs around the place where reading a scene stopped.

use std::ops::Range;

/// The place where reading stopped.
pub(super) struct Here<'a> {
    pub(super) text: &'a str,
    /// Start of the word or sign there; byte.
    pub(super) at: usize,
}

pub(super) fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-')
}

pub(super) fn is_number(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        && word.parse::<f64>().is_ok()
}

impl<'a> Here<'a> {
    pub(super) fn new(text: &'a str, at: usize) -> Self {
        let rest = text.get(at..).unwrap_or_default();
        let skipped = at + rest.len() - rest.trim_start().len();
        // within a word, or behind the quote that opens a text, its start is the place
        let before = text.get(..skipped).unwrap_or_default();
        let start = before.trim_end_matches(is_of_word).len();
        let is_within = text
            .get(skipped..)
            .is_some_and(|r| r.starts_with(is_of_word));
        Self {
            text,
            at: if is_within { start } else { skipped },
        }
    }

    pub(super) fn before(&self) -> &'a str {
        self.text.get(..self.at).unwrap_or_default()
    }

    pub(super) fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or_default()
    }

    /// The word here, empty at a sign.
    pub(super) fn word(&self) -> &'a str {
        let rest = self.rest();
        let end = rest.find(|c| !is_of_word(c)).unwrap_or(rest.len());
        rest.get(..end).unwrap_or_default()
    }

    pub(super) fn word_span(&self) -> Range<usize> {
        self.at..self.at + self.word().len()
    }

    /// The word or sign here, for messages.
    pub(super) fn found(&self) -> &'a str {
        let word = self.word();
        let sign = self.rest().chars().next().map_or(0, char::len_utf8);
        self.rest().get(..word.len().max(sign)).unwrap_or_default()
    }

    pub(super) fn found_span(&self) -> Range<usize> {
        self.at..self.at + self.found().len()
    }

    /// The content of a text in quotes here.
    pub(super) fn text_in_quotes(&self) -> Option<&'a str> {
        let quote = self.rest().chars().next().filter(|c| "\"'".contains(*c))?;
        self.rest().get(1..)?.split([quote, '\n']).next()
    }

    /// The field whose value begins here.
    pub(super) fn field(&self) -> Option<&'a str> {
        let before = self.before().trim_end().strip_suffix(':')?.trim_end();
        let name = before.rsplit(|c| !is_of_word(c)).next()?;
        (!name.is_empty()).then_some(name)
    }

    /// The field, or the kind before the parenthesis, whose value begins here.
    pub(super) fn owner(&self) -> &'a str {
        let before = self.before().trim_end();
        let kind = before
            .strip_suffix('(')
            .and_then(|before| before.rsplit(|c| !is_of_word(c)).next());
        self.field()
            .or(kind)
            .filter(|name| !name.is_empty())
            .unwrap_or("the value")
    }

    /// The list, parenthesis or field around this place that has a name.
    pub(super) fn list(&self) -> Option<&'a str> {
        let mut depth = 0;
        for (k, c) in self.before().char_indices().rev() {
            match c {
                ')' | ']' | '}' => depth += 1,
                '[' if depth == 0 => {
                    return Here {
                        text: self.text,
                        at: k,
                    }
                    .field();
                }
                '(' | '{' if depth == 0 => return None,
                '(' | '[' | '{' => depth -= 1,
                _ => {}
            }
        }
        None
    }
}
