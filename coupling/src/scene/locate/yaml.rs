//! Structure of a scene in YAML.
//!
//! One document without anchors, aliases and tags: nothing in it stands for more than is written.

use std::ops::Range;

use saphyr_parser::{Event, Parser, ScalarStyle, ScanError, Span, StrInput};

use super::tree::{DEEPEST, Field, Flaw, Node, NodeKind, Tree, of_kind, too_deep};

/// Structure of a YAML text; of a broken one only the flaw.
pub(super) fn tree(text: &str) -> Tree<'_> {
    let mut tree = Tree::empty(text, super::Syntax::Yaml);
    let body = text.trim_start_matches('\u{feff}');
    let skipped = text.len() - body.len();
    let mut reader = Reader {
        parser: Parser::new_from_str(body),
        starts: (body.char_indices().map(|(at, _)| at + skipped))
            .chain([text.len()])
            .collect(),
        tree: &mut tree,
    };
    match reader.document() {
        Ok(root) => tree.root = root,
        Err(flaw) => tree.flaw = Some(flaw),
    }
    tree
}

struct Reader<'r, 'a> {
    parser: Parser<'a, StrInput<'a>>,
    /// Byte at which each character starts.
    starts: Vec<usize>,
    tree: &'r mut Tree<'a>,
}

impl<'a> Reader<'_, 'a> {
    fn next(&mut self) -> Result<(Event<'a>, Range<usize>), Flaw> {
        match self.parser.next_event() {
            Some(Ok((event, span))) => {
                let span = self.bytes(&span);
                refused(&event, &span).map_or(Ok((event, span)), Err)
            }
            Some(Err(error)) => Err(self.flaw(&error)),
            None => Ok((Event::StreamEnd, self.tree.text.len()..self.tree.text.len())),
        }
    }

    fn byte(&self, index: usize) -> usize {
        self.starts
            .get(index)
            .copied()
            .unwrap_or(self.tree.text.len())
    }

    fn bytes(&self, span: &Span) -> Range<usize> {
        self.byte(span.start.index())..self.byte(span.end.index())
    }

    fn flaw(&self, error: &ScanError) -> Flaw {
        let mut at = self.byte(error.marker().index());
        let mut message = error.info().to_lowercase();
        let (before, behind) = self.tree.text.split_at_checked(at).unwrap_or_default();
        let tab = behind
            .find('\t')
            .map(|tab| at + tab)
            .or_else(|| before.rfind('\t'));
        if message.contains("tab")
            && let Some(tab) = tab
        {
            at = tab;
            "YAML is indented with spaces, found a tab".clone_into(&mut message);
        }
        let rest = self.tree.text.get(at..).unwrap_or_default();
        let length = rest.chars().next().map_or(0, char::len_utf8);
        Flaw {
            message,
            span: at..at + length,
        }
    }

    fn document(&mut self) -> Result<Option<Node>, Flaw> {
        let mut root = None;
        loop {
            let (event, span) = self.next()?;
            match event {
                Event::StreamEnd => return Ok(root),
                Event::Nothing | Event::StreamStart | Event::DocumentEnd => {}
                Event::DocumentStart(_) if root.is_some() => {
                    return Err(Flaw {
                        message: "a scene is one document, found another after `---`".to_owned(),
                        span,
                    });
                }
                Event::DocumentStart(_) => {
                    let (event, span) = self.next()?;
                    root = Some(self.value(event, span, 0)?);
                }
                _ => {}
            }
        }
    }

    fn value(&mut self, event: Event<'a>, span: Range<usize>, depth: usize) -> Result<Node, Flaw> {
        if depth > DEEPEST {
            return Err(too_deep(span));
        }
        match event {
            Event::Scalar(content, style, ..) => Ok(self.scalar(&content, style, span)),
            Event::SequenceStart(..) => self.list(span, depth),
            Event::MappingStart(..) => self.mapping(span, depth),
            _ => Err(Flaw {
                message: "expected a value".to_owned(),
                span,
            }),
        }
    }

    fn scalar(&mut self, content: &str, style: ScalarStyle, span: Range<usize>) -> Node {
        let kind = match style {
            ScalarStyle::Plain => NodeKind::Word,
            _ => NodeKind::Text,
        };
        // what is left out is null, which the parser calls so
        let is_left_out = span.is_empty();
        if !is_left_out && self.tree.slice(&span) != content {
            self.tree.decoded.insert(span.start, content.to_owned());
        }
        Node { span, kind }
    }

    fn list(&mut self, open: Range<usize>, depth: usize) -> Result<Node, Flaw> {
        let mut items = Vec::<Node>::new();
        loop {
            let (event, span) = self.next()?;
            if event == Event::SequenceEnd {
                let last = items.last().map(|item| item.span.end);
                return Ok(Node {
                    span: open.start..self.end(&open, span, last),
                    kind: NodeKind::List { items },
                });
            }
            items.push(self.value(event, span, depth + 1)?);
        }
    }

    fn mapping(&mut self, open: Range<usize>, depth: usize) -> Result<Node, Flaw> {
        let mut fields = Vec::<Field>::new();
        loop {
            let (event, span) = self.next()?;
            match event {
                Event::MappingEnd => {
                    let is_flow = self.tree.slice(&open).starts_with('{');
                    let first = fields.first().map(|field| field.name.start);
                    let inside = match (is_flow, first) {
                        (false, Some(first)) => first,
                        _ => open.start + 1,
                    };
                    let last = fields.last().map(|field| field.value.span.end);
                    let span = open.start.min(inside)..self.end(&open, span, last);
                    return Ok(of_kind(self.tree.text, span, inside, fields));
                }
                Event::Scalar(content, style, ..) => {
                    let name = self.key(&content, style, span);
                    let (event, span) = self.next()?;
                    let value = self.value(event, span, depth + 1)?;
                    fields.push(Field { name, value });
                }
                _ => {
                    return Err(Flaw {
                        message: "the name of a field is a word, found a group".to_owned(),
                        span,
                    });
                }
            }
        }
    }

    /// The name of a field, without the quotes that it may stand in.
    fn key(&mut self, content: &str, style: ScalarStyle, span: Range<usize>) -> Range<usize> {
        let is_quoted = matches!(style, ScalarStyle::SingleQuoted | ScalarStyle::DoubleQuoted);
        let name = match is_quoted && span.len() >= 2 {
            true => span.start + 1..span.end - 1,
            false => span,
        };
        if self.tree.slice(&name) != content {
            self.tree.decoded.insert(name.start, content.to_owned());
        }
        name
    }

    /// End of a group: its bracket, or the end of the last value in a block.
    fn end(&self, open: &Range<usize>, close: Range<usize>, last: Option<usize>) -> usize {
        match self.tree.slice(open) {
            "{" | "[" => close.end,
            _ => last.unwrap_or(open.end),
        }
    }
}

/// Reason why an event has no place in a scene.
fn refused(event: &Event, span: &Range<usize>) -> Option<Flaw> {
    let (anchor, tag) = match event {
        Event::Scalar(_, _, anchor, tag)
        | Event::SequenceStart(anchor, tag)
        | Event::MappingStart(anchor, tag) => (*anchor, tag.is_some()),
        Event::Alias(_) => (1, false),
        _ => (0, false),
    };
    let message = match (anchor, tag) {
        (_, true) => "tags are not read; write the value without `!`",
        (0, false) => return None,
        _ => "anchors and aliases are not read; write the value out",
    };
    Some(Flaw {
        message: message.to_owned(),
        span: span.clone(),
    })
}
