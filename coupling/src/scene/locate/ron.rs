//! Structure of a scene in RON, broken or not.

use std::ops::Range;

use super::token::{Token, TokenKind, tokens};
use super::tree::{DEEPEST, Field, Flaw, Node, NodeKind, Tree};

/// Structure of a RON text; a broken one has as much of it as there is, and its first flaw.
pub(super) fn tree(text: &str) -> Tree<'_> {
    let (tokens, unclosed) = tokens(text);
    let mut reader = Reader {
        text,
        tokens,
        at: 0,
        flaw: unclosed.map(|open| Flaw {
            message: format!("this {} is never closed", open.what),
            span: open.start..open.start + 1,
        }),
    };
    let root = reader.value(0);
    if let Some(token) = reader.peek().cloned() {
        reader.note(token.span, "unexpected text after the end of the value");
    }
    Tree {
        root,
        flaw: reader.flaw,
        ..Tree::empty(text, super::Syntax::Ron)
    }
}

struct Reader<'a> {
    text: &'a str,
    tokens: Vec<Token>,
    at: usize,
    flaw: Option<Flaw>,
}

impl Reader<'_> {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    fn kind_at(&self, at: usize) -> Option<TokenKind> {
        self.tokens.get(at).map(|token| token.kind)
    }

    fn note(&mut self, span: Range<usize>, message: impl Into<String>) {
        let message = message.into();
        self.flaw.get_or_insert(Flaw { message, span });
    }

    fn value(&mut self, depth: usize) -> Option<Node> {
        let token = self.peek()?.clone();
        let followed_by = self.kind_at(self.at + 1);
        match token.kind {
            TokenKind::Word if followed_by == Some(TokenKind::Open('(')) => {
                self.at += 1;
                Some(self.group(Some(token.span), depth))
            }
            TokenKind::Word | TokenKind::Text => {
                self.at += 1;
                let kind = match token.kind {
                    TokenKind::Text => NodeKind::Text,
                    _ => NodeKind::Word,
                };
                let span = token.span;
                Some(Node { span, kind })
            }
            TokenKind::Open(_) => Some(self.group(None, depth)),
            TokenKind::Close(_) | TokenKind::Colon | TokenKind::Comma => {
                let found = self.text.get(token.span.clone()).unwrap_or_default();
                self.note(
                    token.span.clone(),
                    format!("expected a value, found `{found}`"),
                );
                None
            }
        }
    }

    /// From an opening bracket, which is the next token, to its closing one.
    fn group(&mut self, name: Option<Range<usize>>, depth: usize) -> Node {
        let (open, bracket) = match self.peek() {
            Some(token) => (token.span.clone(), token.kind),
            None => (0..0, TokenKind::Open('(')),
        };
        self.at += 1;
        let mut body = Body::default();
        let end = loop {
            match self.kind_at(self.at) {
                None => {
                    let found = self.text.get(open.clone()).unwrap_or_default();
                    self.note(open.clone(), format!("this `{found}` is never closed"));
                    break self.text.len();
                }
                Some(TokenKind::Close(close)) => break self.close(close, bracket, &open),
                Some(TokenKind::Comma) => self.at += 1,
                Some(_) if depth >= DEEPEST => self.at += 1,
                Some(_) => self.element(bracket, &open, depth, &mut body),
            }
        };
        let start = name.as_ref().map_or(open.start, |name| name.start);
        let Body { fields, items } = body;
        let kind = match bracket {
            TokenKind::Open('(') if items.is_empty() => NodeKind::Record {
                name,
                inside: open.end,
                fields,
            },
            TokenKind::Open('(') => NodeKind::Tuple { name, items },
            _ => NodeKind::List { items },
        };
        Node {
            span: start..end,
            kind,
        }
    }

    /// Ends a group at a closing bracket; a wrong one is left to the group outside.
    fn close(&mut self, close: char, bracket: TokenKind, open: &Range<usize>) -> usize {
        let span = self.peek().map_or(0..0, |token| token.span.clone());
        let fits = matches!(
            (bracket, close),
            (TokenKind::Open('('), ')') | (TokenKind::Open('['), ']') | (TokenKind::Open('{'), '}')
        );
        if fits {
            self.at += 1;
            return span.end;
        }
        let line = super::line_column(self.text, span.start).0;
        let found = self.text.get(open.clone()).unwrap_or_default();
        self.note(
            open.clone(),
            format!("this `{found}` is not closed before the `{close}` of line {line}"),
        );
        span.start
    }

    /// One `name: value` or `value`, and the comma behind it.
    fn element(&mut self, bracket: TokenKind, open: &Range<usize>, depth: usize, body: &mut Body) {
        let first = self.at;
        let is_field = self.kind_at(first) == Some(TokenKind::Word)
            && self.kind_at(first + 1) == Some(TokenKind::Colon)
            && bracket == TokenKind::Open('(');
        if is_field {
            let name = self.peek().map_or(0..0, |token| token.span.clone());
            if !body.items.is_empty() {
                let field = self.text.get(name.clone()).unwrap_or_default();
                self.note(
                    open.clone(),
                    format!("this `(` is not closed before the field `{field}`"),
                );
            }
            self.at += 2;
            match self.value(depth + 1) {
                Some(value) => body.fields.push(Field { name, value }),
                None => self.note(name, "a field without a value"),
            }
        } else {
            let start = self.peek().map_or(0..0, |token| token.span.clone());
            match self.value(depth + 1) {
                Some(_) if !body.fields.is_empty() => {
                    let found = self.text.get(start.clone()).unwrap_or_default();
                    self.note(start, format!("expected `field: value`, found `{found}`"));
                }
                Some(item) => body.items.push(item),
                // A stray colon: pass over it, so that the walk always ends.
                None => self.at = (first + 1).max(self.at),
            }
        }
        let more = !matches!(
            self.kind_at(self.at),
            None | Some(TokenKind::Comma | TokenKind::Close(_))
        );
        if more && self.at > first {
            // The place is the end of the value that the comma should follow.
            let end = self.tokens.get(self.at - 1).map_or(0, |t| t.span.end);
            self.note(end.saturating_sub(1)..end, "expected a comma after this");
        }
    }
}

#[derive(Default)]
struct Body {
    fields: Vec<Field>,
    items: Vec<Node>,
}
