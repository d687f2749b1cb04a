//! Structure of a scene text: its values and their locations. Tolerant: every text has a tree.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;

use super::path::{FieldPath, Step};
use super::token::{Token, TokenKind, tokens};
use super::{Syntax, json, yaml};

/// Depth below which nesting is left flat. A scene needs 8; the limit keeps hostile text off the call stack.
pub(super) const DEEPEST: usize = 64;

/// A value and its location.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Node {
    /// From its first to behind its last byte, the name before a parenthesis included.
    pub span: Range<usize>,
    /// Content.
    pub kind: NodeKind,
}

/// Structure of a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NodeKind {
    /// A number or a bare name.
    Word,
    /// A string or character.
    Text,
    /// `(a: 1, b: 2)` or `Name(a: 1)`; also `()`. In JSON and YAML `{"a": 1, "b": 2}` or `{"Name": {"a": 1}}`.
    Record {
        /// The name before the parenthesis.
        name: Option<Range<usize>>,
        /// The byte behind the opening parenthesis or brace; of a YAML block its first name.
        inside: usize,
        /// In the order of the text.
        fields: Vec<Field>,
    },
    /// `(1, 2)` or `Name(1)`; in JSON and YAML `{"Name": 1}`.
    Tuple {
        /// The name before the parenthesis.
        name: Option<Range<usize>>,
        /// In the order of the text.
        items: Vec<Node>,
    },
    /// `[1, 2]`, in JSON and YAML points, too; in RON also `{...}`, which no scene needs.
    List {
        /// In the order of the text.
        items: Vec<Node>,
    },
}

/// A field of a record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its name in the text.
    pub name: Range<usize>,
    /// Its value.
    pub value: Node,
}

/// First syntax error of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// Fault; lowercase.
    pub message: String,
    /// Location; bytes.
    pub span: Range<usize>,
}

/// A text with its tree.
#[derive(Clone, Debug)]
pub struct Tree<'a> {
    /// The text.
    pub text: &'a str,
    /// The outermost value, if there is one.
    pub root: Option<Node>,
    /// The first flaw of form.
    pub flaw: Option<Flaw>,
    /// Language of the text.
    pub syntax: Syntax,
    /// Texts that are written otherwise than they read, by their first byte; of YAML.
    pub(super) decoded: BTreeMap<usize, String>,
}

impl<'a> Tree<'a> {
    /// Reads `text` in a language.
    pub fn of(text: &'a str, syntax: Syntax) -> Self {
        match syntax {
            Syntax::Ron => Self::new(text),
            Syntax::Json => json::tree(text),
            Syntax::Yaml => yaml::tree(text),
        }
    }

    pub(super) fn empty(text: &'a str, syntax: Syntax) -> Self {
        Self {
            text,
            root: None,
            flaw: None,
            syntax,
            decoded: BTreeMap::new(),
        }
    }

    /// Reads `text` as RON.
    pub fn new(text: &'a str) -> Self {
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
        Self {
            root,
            flaw: reader.flaw,
            ..Self::empty(text, Syntax::Ron)
        }
    }

    /// The text of a span.
    pub fn slice(&self, span: &Range<usize>) -> &'a str {
        self.text.get(span.clone()).unwrap_or_default()
    }

    /// Name of a field.
    pub fn key(&self, field: &Field) -> Cow<'_, str> {
        self.name(&field.name)
    }

    /// A name at a place of the text.
    pub fn name(&self, span: &Range<usize>) -> Cow<'_, str> {
        let written = self.slice(span);
        match self.syntax {
            Syntax::Ron => plain_name(written).into(),
            Syntax::Json if written.contains('\\') => {
                let read = serde_json::from_str(&format!("\"{written}\""));
                read.map_or(written.into(), Cow::Owned)
            }
            Syntax::Json => written.into(),
            Syntax::Yaml => self.as_decoded(span),
        }
    }

    /// Content of a word or a text in quotes, `None` for a group.
    pub fn content(&self, node: &Node) -> Option<Cow<'_, str>> {
        let written = self.slice(&node.span);
        match (&node.kind, self.syntax) {
            (NodeKind::Word, Syntax::Ron | Syntax::Json) => Some(written.into()),
            // escapes are rare: the readers of each language resolve them
            (NodeKind::Text, Syntax::Ron) => ron::from_str(written).ok().map(Cow::Owned),
            (NodeKind::Text, Syntax::Json) => serde_json::from_str(written).ok().map(Cow::Owned),
            (NodeKind::Word | NodeKind::Text, Syntax::Yaml) => Some(self.as_decoded(&node.span)),
            _ => None,
        }
    }

    fn as_decoded(&self, span: &Range<usize>) -> Cow<'_, str> {
        match self.decoded.get(&span.start) {
            // a value that is left out stands where the next one begins
            Some(text) if !span.is_empty() => text.into(),
            _ => self.slice(span).into(),
        }
    }

    /// Follows `path`. `Err` holds the last value reached and the number of steps to it.
    pub fn walk(&self, path: &FieldPath) -> Result<&Node, (Option<&Node>, usize)> {
        let mut node = match &self.root {
            Some(root) => self.without_some(root),
            None => return Err((None, 0)),
        };
        for (i, step) in path.steps().iter().enumerate() {
            match self.child(node, step) {
                Some(child) => node = self.without_some(child),
                None => return Err((Some(node), i)),
            }
        }
        Ok(node)
    }

    /// The value one step below `node`.
    fn child<'n>(&self, node: &'n Node, step: &Step) -> Option<&'n Node> {
        match (&node.kind, step) {
            (NodeKind::Record { fields, .. }, Step::Name(name)) => fields
                .iter()
                .find(|field| self.key(field) == name.as_str())
                .map(|field| &field.value),
            (NodeKind::List { items }, Step::Name(name)) => items
                .iter()
                .find(|item| self.name_of(item).as_deref() == Some(name)),
            (NodeKind::List { items } | NodeKind::Tuple { items, .. }, Step::Index(index)) => {
                items.get(*index)
            }
            _ => None,
        }
    }

    /// Value of the field `name` of a record, for list elements that have one.
    pub fn name_of(&self, node: &Node) -> Option<String> {
        let node = self.child(self.without_some(node), &Step::Name("name".to_owned()))?;
        self.content(node).map(Cow::into_owned)
    }

    /// `Some(x)` stands for `x`, as everywhere in a scene.
    pub fn without_some<'n>(&self, node: &'n Node) -> &'n Node {
        match &node.kind {
            NodeKind::Tuple {
                name: Some(name),
                items,
            } if self.slice(name) == "Some" && items.len() == 1 => {
                items.first().map_or(node, |item| self.without_some(item))
            }
            _ => node,
        }
    }

    /// Every path of the tree with its value, outermost first.
    pub fn paths(&self) -> Vec<(FieldPath, &Node)> {
        let mut all = Vec::new();
        if let Some(root) = &self.root {
            self.collect(self.without_some(root), &mut Vec::new(), &mut all);
        }
        all
    }

    fn collect<'n>(
        &self,
        node: &'n Node,
        steps: &mut Vec<Step>,
        all: &mut Vec<(FieldPath, &'n Node)>,
    ) {
        all.push((steps.iter().cloned().collect(), node));
        let children: Vec<(Step, &Node)> = match &node.kind {
            NodeKind::Word | NodeKind::Text => Vec::new(),
            NodeKind::Record { fields, .. } => fields
                .iter()
                .map(|field| (Step::Name(self.key(field).into_owned()), &field.value))
                .collect(),
            NodeKind::Tuple { items, .. } | NodeKind::List { items } => {
                let indices = (0..).map(Step::Index);
                indices.zip(items).collect()
            }
        };
        for (step, child) in children {
            steps.push(step);
            self.collect(self.without_some(child), steps, all);
            steps.pop();
        }
    }
}

/// A record of JSON or YAML: of one field in capitals it is the kind that the field names.
pub(super) fn of_kind(text: &str, span: Range<usize>, inside: usize, fields: Vec<Field>) -> Node {
    let is_kind = |name: &Range<usize>| {
        let name = text.get(name.clone()).unwrap_or_default();
        name.starts_with(|c: char| c.is_ascii_uppercase())
    };
    let kind = match <[Field; 1]>::try_from(fields) {
        Ok([Field { name, value }]) if is_kind(&name) => match value.kind {
            NodeKind::Record {
                name: None,
                inside,
                fields,
            } => NodeKind::Record {
                name: Some(name),
                inside,
                fields,
            },
            _ => NodeKind::Tuple {
                name: Some(name),
                items: vec![value],
            },
        },
        Ok([field]) => NodeKind::Record {
            name: None,
            inside,
            fields: vec![field],
        },
        Err(fields) => NodeKind::Record {
            name: None,
            inside,
            fields,
        },
    };
    Node { span, kind }
}

/// The flaw of a text that is nested deeper than any scene.
pub(super) fn too_deep(span: Range<usize>) -> Flaw {
    Flaw {
        message: format!("nested more than {DEEPEST} deep; a scene needs 8"),
        span,
    }
}

/// `r#type` names the field `type`.
fn plain_name(name: &str) -> &str {
    name.strip_prefix("r#").unwrap_or(name)
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
