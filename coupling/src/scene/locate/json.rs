//! Structure of a scene in JSON.

use std::ops::Range;

use serde::de::IgnoredAny;

use super::token::{Token, TokenKind, tokens};
use super::tree::{DEEPEST, Field, Flaw, Node, NodeKind, Tree, of_kind, too_deep};

/// Name of the field by which editors find the schema of a text.
const SCHEMA: &str = "$schema";

/// Structure of a JSON text; of a broken one only the flaw.
pub(super) fn tree(text: &str) -> Tree<'_> {
    let mut tree = Tree::empty(text, super::Syntax::Json);
    // a byte order mark is no part of the text
    let body = text.trim_start_matches('\u{feff}');
    if let Err(error) = serde_json::from_str::<IgnoredAny>(body) {
        tree.flaw = Some(flaw(body, text.len() - body.len(), &error));
        return tree;
    }
    let mut reader = Reader {
        text,
        tokens: tokens(text).0,
        at: 0,
        flaw: None,
    };
    tree.root = reader.value(0);
    tree.flaw = reader.flaw;
    tree
}

/// The fault that a reader of JSON found, in its place.
fn flaw(body: &str, skipped: usize, error: &serde_json::Error) -> Flaw {
    let lines = body
        .split_inclusive('\n')
        .take(error.line().saturating_sub(1));
    let start: usize = lines.map(str::len).sum();
    let mut at = (start + error.column().saturating_sub(1)).min(body.len());
    while !body.is_char_boundary(at) {
        at -= 1;
    }
    let rest = body.get(at..).unwrap_or_default();
    let said = error.to_string();
    let said = said.split(" at line ").next().unwrap_or_default();
    if matches!(said, "expected ident" | "expected value") {
        return no_value(body, skipped, at);
    }
    let found = match rest.chars().next() {
        _ if error.is_eof() => String::new(),
        Some('/' | '#') => "; JSON has no comments".to_owned(),
        Some(c) if !c.is_whitespace() => format!(", found `{c}`"),
        _ => String::new(),
    };
    let said = match rest.chars().next() {
        Some('}') if said == "key must be a string" => "trailing comma",
        _ => said,
    };
    let length = rest.chars().next().map_or(0, char::len_utf8);
    Flaw {
        message: format!("{}{found}", said.replace("EOF", "end of the text")),
        span: skipped + at..skipped + at + length,
    }
}

/// A word, a sign or a comment in place of a value.
fn no_value(body: &str, skipped: usize, at: usize) -> Flaw {
    let is_of_word = |c: char| c.is_alphanumeric() || "_.+-".contains(c);
    let before = body.get(..at).unwrap_or_default();
    let start = before.trim_end_matches(is_of_word).len();
    let rest = body.get(start..).unwrap_or_default();
    let word = rest.get(..rest.find(|c| !is_of_word(c)).unwrap_or(rest.len()));
    let sign = rest.chars().next().map_or(0, char::len_utf8);
    let found = word
        .filter(|word| !word.is_empty())
        .or(rest.get(..sign))
        .unwrap_or_default();
    let advice = match found.chars().next() {
        Some('/' | '#') => "; JSON has no comments",
        Some(c) if c.is_alphabetic() => "; a text stands in double quotes",
        _ => "",
    };
    Flaw {
        message: format!("expected a value, found `{found}`{advice}"),
        span: skipped + start..skipped + start + found.len(),
    }
}

/// A text that is known to be JSON, as a tree.
struct Reader<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    at: usize,
    flaw: Option<Flaw>,
}

impl Reader<'_> {
    fn next(&mut self) -> Option<Token> {
        let token = self.tokens.get(self.at).cloned();
        self.at += 1;
        token
    }

    fn peek(&self) -> Option<TokenKind> {
        self.tokens.get(self.at).map(|token| token.kind)
    }

    fn value(&mut self, depth: usize) -> Option<Node> {
        let token = self.next()?;
        if depth > DEEPEST {
            self.flaw.get_or_insert(too_deep(token.span));
            return None;
        }
        match token.kind {
            TokenKind::Text => Some(Node {
                span: token.span,
                kind: NodeKind::Text,
            }),
            TokenKind::Open('{') => self.object(token.span, depth),
            TokenKind::Open(_) => self.list(token.span.start, depth),
            _ => Some(Node {
                span: token.span,
                kind: NodeKind::Word,
            }),
        }
    }

    fn list(&mut self, start: usize, depth: usize) -> Option<Node> {
        let mut items = Vec::new();
        loop {
            match self.peek()? {
                TokenKind::Close(_) => break,
                TokenKind::Comma => self.at += 1,
                _ => items.push(self.value(depth + 1)?),
            }
        }
        let end = self.next()?.span.end;
        Some(Node {
            span: start..end,
            kind: NodeKind::List { items },
        })
    }

    fn object(&mut self, open: Range<usize>, depth: usize) -> Option<Node> {
        let mut fields = Vec::new();
        loop {
            let token = self.next()?;
            match token.kind {
                TokenKind::Close(_) => {
                    let span = open.start..token.span.end;
                    return Some(of_kind(self.text, span, open.end, fields));
                }
                TokenKind::Comma => {}
                _ => {
                    // the colon behind the name
                    self.at += 1;
                    let name = token.span.start + 1..token.span.end - 1;
                    let value = self.value(depth + 1)?;
                    // for editors, which find the schema by it
                    let is_for_editors = depth == 0 && self.text.get(name.clone()) == Some(SCHEMA);
                    if !is_for_editors {
                        fields.push(Field { name, value });
                    }
                }
            }
        }
    }
}
