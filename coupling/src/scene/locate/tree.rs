//! Structure of a scene text: its values and their locations. Tolerant: every text has a tree.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;

use super::path::{FieldPath, Step};
use super::{Syntax, json, ron, yaml};

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
        ron::tree(text)
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
            (NodeKind::Text, Syntax::Ron) => ::ron::from_str(written).ok().map(Cow::Owned),
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
