//! A value in RON as JSON, which is YAML, too: what `--set` writes into scenes of these languages.

use crate::scene::locate::tree::{Node, NodeKind, Tree};

/// The value as JSON; `None` for a text that is no value.
pub(super) fn json_of(value: &str) -> Option<String> {
    if value.starts_with('{') {
        return Some(value.to_owned());
    }
    let tree = Tree::new(value);
    match (&tree.flaw, &tree.root) {
        (None, Some(root)) => Some(node(&tree, root)),
        _ => None,
    }
}

fn node(tree: &Tree<'_>, of: &Node) -> String {
    let of = tree.without_some(of);
    match &of.kind {
        NodeKind::Word => word(tree.slice(&of.span)),
        NodeKind::Text => quoted(&tree.content(of).unwrap_or_default()),
        NodeKind::List { items } | NodeKind::Tuple { name: None, items } => list(tree, items),
        NodeKind::Record {
            name: None, fields, ..
        } => {
            let fields = fields
                .iter()
                .map(|field| format!("{}: {}", quoted(&tree.key(field)), node(tree, &field.value)));
            format!("{{{}}}", fields.collect::<Vec<_>>().join(", "))
        }
        NodeKind::Tuple {
            name: Some(name),
            items,
        } => {
            let value = match items.as_slice() {
                [item] => node(tree, item),
                items => list(tree, items),
            };
            format!("{{{}: {value}}}", quoted(tree.slice(name)))
        }
        NodeKind::Record {
            name: Some(name),
            inside,
            fields,
        } => {
            let inner = Node {
                span: of.span.clone(),
                kind: NodeKind::Record {
                    name: None,
                    inside: *inside,
                    fields: fields.clone(),
                },
            };
            format!("{{{}: {}}}", quoted(tree.slice(name)), node(tree, &inner))
        }
    }
}

fn list(tree: &Tree<'_>, items: &[Node]) -> String {
    let items: Vec<String> = items.iter().map(|item| node(tree, item)).collect();
    format!("[{}]", items.join(", "))
}

/// A number, `true`, or the name of a kind.
fn word(word: &str) -> String {
    let number = word.replace('_', "");
    let number = number.strip_prefix('+').unwrap_or(&number);
    match word {
        "true" | "false" | "null" => word.to_owned(),
        _ if serde_json::from_str::<serde_json::Number>(number).is_ok() => number.to_owned(),
        _ => number.parse::<f64>().map_or_else(
            |_| quoted(word),
            // such as 1. and .5, which JSON does not know
            |value| {
                if value.is_finite() {
                    format!("{value:?}")
                } else {
                    word.to_owned()
                }
            },
        ),
    }
}

fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
