//! Values of the tree of a text as the types of the schema: JSON and YAML are read so, and quantities with units found in RON.

mod error;
mod groups;

use std::cell::{OnceCell, RefCell};
use std::ops::Range;

use serde::de::value::BorrowedStrDeserializer;
use serde::de::{DeserializeOwned, Deserializer, Error as _, Visitor};

use super::TextError;
use super::words::kind_of_number;
use crate::files::units;
use crate::scene::locate::Syntax;
use crate::scene::locate::tree::{Node, NodeKind, Tree};
use crate::scene::schema::Units;
use error::ReadError;
use groups::{Fields, Items, Kind};

/// A number that stands in a text as a quantity with its unit.
pub(super) struct Quantity {
    /// Location; bytes.
    pub(super) span: Range<usize>,
    /// In the unit of its field.
    pub(super) value: f64,
}

/// The value of a tree, and its quantities up to the first fault.
pub(super) fn read<T: DeserializeOwned>(tree: &Tree<'_>) -> (Result<T, ReadError>, Vec<Quantity>) {
    let text = Text {
        tree,
        units: OnceCell::new(),
        quantities: RefCell::default(),
    };
    let found = match (&tree.flaw, &tree.root) {
        // its own reader tells the flaws of RON; quantities before them are found all the same
        (Some(flaw), _) if tree.syntax != Syntax::Ron => {
            Err(ReadError::other(&flaw.message).at(&flaw.span))
        }
        (_, None) => Err(ReadError::other("the text is empty").at(&(0..0))),
        (_, Some(root)) => T::deserialize(Reader {
            text: &text,
            node: tree.without_some(root),
            slot: Slot::default(),
        }),
    };
    (found, text.quantities.into_inner())
}

/// As [`read`], with the fault in its place.
pub(super) fn value<T: DeserializeOwned>(tree: &Tree<'_>) -> Result<T, TextError> {
    read(tree).0.map_err(ReadError::into_text_error)
}

/// A text while it is read.
struct Text<'t> {
    tree: &'t Tree<'t>,
    /// Made when the first quantity is met.
    units: OnceCell<Units>,
    quantities: RefCell<Vec<Quantity>>,
}

/// The field that a value belongs to.
#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    /// Its type.
    owner: &'static str,
    /// Its variant, of an enumeration.
    variant: &'static str,
    /// Its name; empty for the value of a variant.
    field: &'static str,
    /// Number in a row.
    item: usize,
}

impl Slot {
    /// Name in messages.
    fn name(&self) -> &'static str {
        match (self.field, self.variant) {
            ("", "") => "the scene",
            ("", variant) => variant,
            (field, _) => field,
        }
    }

    /// Path in the types.
    fn path(&self) -> String {
        let steps = [self.owner, self.variant, self.field];
        let steps: Vec<&str> = steps.into_iter().filter(|step| !step.is_empty()).collect();
        steps.join(".")
    }
}

/// A value of the tree.
#[derive(Clone, Copy)]
struct Reader<'t> {
    text: &'t Text<'t>,
    node: &'t Node,
    slot: Slot,
}

impl<'t> Reader<'t> {
    fn tree(&self) -> &'t Tree<'t> {
        self.text.tree
    }

    /// The value as it is written, or its first sign.
    fn found(&self) -> String {
        let written = self.tree().slice(&self.node.span);
        match self.node.kind {
            NodeKind::Word if written.is_empty() => "nothing".to_owned(),
            NodeKind::Word => format!("`{written}`"),
            NodeKind::Text => format!("{written} in quotes"),
            NodeKind::Record { .. } | NodeKind::Tuple { .. } => "a group of fields".to_owned(),
            NodeKind::List { .. } => "a list".to_owned(),
        }
    }

    /// The error that a value of another kind stands here.
    fn takes(&self, what: &str) -> ReadError {
        let (name, found) = (self.slot.name(), self.found());
        self.refuse(format!("`{name}` takes {what}, found {found}"))
    }

    fn refuse(&self, message: String) -> ReadError {
        ReadError::other(&message).at(&self.node.span)
    }

    /// Whether a value is left out on purpose.
    fn is_null(&self) -> bool {
        let word = self.tree().slice(&self.node.span);
        matches!(self.node.kind, NodeKind::Word)
            && match self.tree().syntax {
                Syntax::Ron => word == "None",
                Syntax::Json => word == "null",
                Syntax::Yaml => matches!(word, "" | "~" | "null"),
            }
    }

    /// As in RON, `None` is nothing where something is optional, and a kind elsewhere.
    fn is_none(&self) -> bool {
        let content = self.tree().content(self.node);
        self.is_null() || content.is_some_and(|content| content == "None")
    }

    /// A number, or a quantity with its unit.
    fn number(&self) -> Result<f64, ReadError> {
        let content = self.tree().content(self.node);
        let content = content.ok_or_else(|| self.takes("a number"))?;
        let is_word = matches!(self.node.kind, NodeKind::Word);
        let number = content.parse::<f64>().ok();
        match number {
            // its own reader judges the numbers of RON
            _ if is_word && self.tree().syntax == Syntax::Ron => Ok(number.unwrap_or_default()),
            Some(number) if is_word && number.is_finite() => Ok(number),
            Some(_) if is_word => Err(self.refuse(format!(
                "`{}` is {content}; a number must be finite",
                self.slot.name()
            ))),
            Some(_) => Err(self.refuse(format!(
                "`{}` takes a number, found \"{content}\" in quotes; write {content}",
                self.slot.name()
            ))),
            None if units::is_quantity(&content) => self.quantity(&content),
            None if matches!(&*content, ".inf" | "-.inf" | ".nan" | ".NaN" | ".Inf") => Err(self
                .refuse(format!(
                    "`{}` is {content}; a number must be finite",
                    self.slot.name()
                ))),
            None => Err(self.takes("a number")),
        }
    }

    fn quantity(&self, content: &str) -> Result<f64, ReadError> {
        let units = self.text.units.get_or_init(Units::of_scenes);
        let unit = units.get(&self.slot.path(), self.slot.item);
        let unit = unit.ok_or_else(|| self.takes("a number"))?;
        let value = units::value(content, unit).map_err(|error| {
            ReadError::quantity(format!("`{}`: {error}", self.slot.name())).at(&self.node.span)
        })?;
        self.text.quantities.borrow_mut().push(Quantity {
            span: self.node.span.clone(),
            value,
        });
        Ok(value)
    }

    /// A whole number from 0.
    fn whole(&self) -> Result<u64, ReadError> {
        let content = self.tree().content(self.node);
        match (&self.node.kind, content) {
            (NodeKind::Word, Some(word)) => {
                let number = word.parse();
                match self.tree().syntax {
                    Syntax::Ron => Ok(number.unwrap_or_default()),
                    _ => number.map_err(|_| self.takes("a whole number from 0")),
                }
            }
            _ => Err(self.takes("a whole number from 0")),
        }
    }

    fn string(&self) -> Result<String, ReadError> {
        let content = self
            .tree()
            .content(self.node)
            .map(|content| content.into_owned());
        let is_text = match self.tree().syntax {
            Syntax::Ron | Syntax::Json => matches!(self.node.kind, NodeKind::Text),
            // a text without quotes
            Syntax::Yaml => !self.is_null(),
        };
        content
            .filter(|_| is_text)
            .ok_or_else(|| self.takes("a text"))
    }

    /// The values of a list or a point.
    fn items(&self) -> Option<&'t [Node]> {
        match &self.node.kind {
            NodeKind::List { items } | NodeKind::Tuple { name: None, items } => Some(items),
            _ => None,
        }
    }

    /// The error where one of several kinds must be named.
    fn without_kind(&self, variants: &[&str]) -> ReadError {
        let (name, found) = (self.slot.name(), self.tree().slice(&self.node.span));
        let is_number = found.parse::<f64>().is_ok();
        let message = match kind_of_number(self.slot.field) {
            Some(kind) if is_number => {
                format!("`{name}` does not say what {found} is; write {{\"{kind}\": {found}}}")
            }
            _ => format!(
                "`{name}` takes one kind, found {}; write {{\"KIND\": ...}}, with one of {}",
                self.found(),
                variants.join(", ")
            ),
        };
        self.refuse(message)
    }
}

/// Methods that read a word as it is.
macro_rules! from_word {
    ($($method:ident => $visit:ident($read:ident);)+) => {$(
        fn $method<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, ReadError> {
            let value = self.$read()?;
            visitor.$visit(value).map_err(|error: ReadError| error.at(&self.node.span))
        }
    )+};
}

impl<'t> Deserializer<'t> for Reader<'t> {
    type Error = ReadError;

    from_word! {
        deserialize_f64 => visit_f64(number);
        deserialize_f32 => visit_f64(number);
        deserialize_u8 => visit_u64(whole);
        deserialize_u16 => visit_u64(whole);
        deserialize_u32 => visit_u64(whole);
        deserialize_u64 => visit_u64(whole);
        deserialize_i8 => visit_u64(whole);
        deserialize_i16 => visit_u64(whole);
        deserialize_i32 => visit_u64(whole);
        deserialize_i64 => visit_u64(whole);
        deserialize_str => visit_string(string);
        deserialize_string => visit_string(string);
        deserialize_char => visit_string(string);
    }

    fn deserialize_bool<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, ReadError> {
        match (&self.node.kind, self.tree().slice(&self.node.span)) {
            (NodeKind::Word, "true") => visitor.visit_bool(true),
            (NodeKind::Word, "false") => visitor.visit_bool(false),
            _ => Err(self.takes("true or false")),
        }
    }

    fn deserialize_option<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, ReadError> {
        match self.is_none() {
            true => visitor.visit_none(),
            false => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'t>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, ReadError> {
        let items = self
            .items()
            .ok_or_else(|| self.takes("a list in brackets, [...]"))?;
        visitor.visit_seq(Items::of_list(&self, items))
    }

    fn deserialize_tuple<V: Visitor<'t>>(
        self,
        n: usize,
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let several = || {
            self.takes(&format!(
                "{n} values, [{}]",
                ["..."; 6][..n.min(6)].join(", ")
            ))
        };
        let items = self.items().ok_or_else(several)?;
        // quantities of a row that is too long or too short are found before its reader of RON refuses it
        if items.len() != n && self.tree().syntax != Syntax::Ron {
            let (found, n_found) = (self.tree().slice(&self.node.span), items.len());
            let fault = if n_found < n {
                "are missing"
            } else {
                "are too many"
            };
            return Err(self.refuse(format!(
                "found {n_found} values in `{found}`, one or more {fault}"
            )));
        }
        visitor.visit_seq(Items::of_row(&self, items))
    }

    fn deserialize_tuple_struct<V: Visitor<'t>>(
        self,
        _: &'static str,
        n: usize,
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        self.deserialize_tuple(n, visitor)
    }

    fn deserialize_struct<V: Visitor<'t>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let NodeKind::Record { fields: found, .. } = &self.node.kind else {
            return Err(self.takes("fields, {\"name\": value, ...}"));
        };
        let slot = Slot {
            owner: name,
            ..Slot::default()
        };
        visitor
            .visit_map(Fields::new(Reader { slot, ..self }, found, fields))
            .map_err(|error| error.within(name).at(&self.node.span))
    }

    fn deserialize_enum<V: Visitor<'t>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let kind = Kind::of(&self, name, variants)?;
        let place = kind.place();
        visitor
            .visit_enum(kind)
            .map_err(|error| error.within(name).at(&place))
    }

    fn deserialize_identifier<V: Visitor<'t>>(self, visitor: V) -> Result<V::Value, ReadError> {
        BorrowedStrDeserializer::new(self.tree().slice(&self.node.span)).deserialize_str(visitor)
    }

    fn deserialize_any<V: Visitor<'t>>(self, _: V) -> Result<V::Value, ReadError> {
        Err(ReadError::custom("a value of no stated type"))
    }

    serde::forward_to_deserialize_any! {
        <W: Visitor<'t>>
        i128 u128 bytes byte_buf unit unit_struct map ignored_any
    }
}
