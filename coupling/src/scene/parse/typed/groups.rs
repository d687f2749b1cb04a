//! Lists, points, groups of fields and kinds of a tree.

use std::ops::Range;

use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer as _, EnumAccess, IntoDeserializer, MapAccess, SeqAccess,
    VariantAccess, Visitor,
};

use super::error::ReadError;
use super::{Reader, Slot};
use crate::scene::locate::tree::{Field, Node, NodeKind};

/// Values of a list or a point, one after the other.
pub(super) struct Items<'t> {
    reader: Reader<'t>,
    items: &'t [Node],
    next: usize,
    /// Whether the values are numbers of one row, each with its unit.
    is_row: bool,
}

impl<'t> Items<'t> {
    pub(super) fn of_list(reader: &Reader<'t>, items: &'t [Node]) -> Self {
        Self {
            reader: *reader,
            items,
            next: 0,
            is_row: false,
        }
    }

    pub(super) fn of_row(reader: &Reader<'t>, items: &'t [Node]) -> Self {
        Self {
            is_row: true,
            ..Self::of_list(reader, items)
        }
    }
}

impl<'t> SeqAccess<'t> for Items<'t> {
    type Error = ReadError;

    fn next_element_seed<S: DeserializeSeed<'t>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, ReadError> {
        let Some(node) = self.items.get(self.next) else {
            return Ok(None);
        };
        let mut slot = self.reader.slot;
        if self.is_row {
            slot.item = self.next;
        }
        self.next += 1;
        let node = self.reader.tree().without_some(node);
        let reader = Reader {
            node,
            slot,
            ..self.reader
        };
        seed.deserialize(reader)
            .map(Some)
            .map_err(|error| error.at(&node.span))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.items.len() - self.next)
    }
}

/// Fields of a group, one after the other.
pub(super) struct Fields<'t> {
    reader: Reader<'t>,
    found: &'t [Field],
    next: usize,
    names: &'static [&'static str],
}

impl<'t> Fields<'t> {
    pub(super) fn new(
        reader: Reader<'t>,
        found: &'t [Field],
        names: &'static [&'static str],
    ) -> Self {
        Self {
            reader,
            found,
            next: 0,
            names,
        }
    }
}

impl<'t> MapAccess<'t> for Fields<'t> {
    type Error = ReadError;

    fn next_key_seed<S: DeserializeSeed<'t>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, ReadError> {
        let Some(field) = self.found.get(self.next) else {
            return Ok(None);
        };
        let key = self.reader.tree().key(field);
        // a field written twice is told when its value is asked for, without its place
        let is_again = self.found.get(..self.next).is_some_and(|before| {
            before
                .iter()
                .any(|other| self.reader.tree().key(other) == key)
        });
        if is_again {
            let message = format!("`{key}` is written twice; keep one");
            return Err(ReadError::other(&message).at(&field.name));
        }
        let name: StrDeserializer<ReadError> = (*key).into_deserializer();
        seed.deserialize(name)
            .map(Some)
            .map_err(|error| error.at(&field.name))
    }

    fn next_value_seed<S: DeserializeSeed<'t>>(&mut self, seed: S) -> Result<S::Value, ReadError> {
        let Some(field) = self.found.get(self.next) else {
            return Err(ReadError::other("a field without a value"));
        };
        self.next += 1;
        let key = self.reader.tree().key(field);
        let name = self.names.iter().find(|name| **name == key);
        let slot = Slot {
            field: name.copied().unwrap_or_default(),
            item: 0,
            ..self.reader.slot
        };
        let node = self.reader.tree().without_some(&field.value);
        let reader = Reader {
            node,
            slot,
            ..self.reader
        };
        seed.deserialize(reader)
            .map_err(|error| error.at(&node.span))
    }
}

/// One of several kinds: its name, and its value or fields.
pub(super) struct Kind<'t> {
    reader: Reader<'t>,
    name: &'static str,
    written: &'t Node,
    /// Location of the name; bytes.
    place: Range<usize>,
    kind: String,
    variants: &'static [&'static str],
}

impl<'t> Kind<'t> {
    pub(super) fn of(
        reader: &Reader<'t>,
        name: &'static str,
        variants: &'static [&'static str],
    ) -> Result<Self, ReadError> {
        let (tree, node) = (reader.tree(), reader.node);
        let (place, kind) = match &node.kind {
            NodeKind::Record { name: Some(n), .. } | NodeKind::Tuple { name: Some(n), .. } => {
                (n.clone(), tree.name(n))
            }
            NodeKind::Word | NodeKind::Text => {
                let content = tree.content(node).unwrap_or_default();
                (node.span.clone(), content)
            }
            _ => return Err(reader.without_kind(variants)),
        };
        if !kind.starts_with(|c: char| c.is_alphabetic()) {
            return Err(reader.without_kind(variants));
        }
        Ok(Self {
            reader: *reader,
            name,
            written: node,
            kind: kind.into_owned(),
            place,
            variants,
        })
    }

    pub(super) fn place(&self) -> Range<usize> {
        self.place.clone()
    }

    fn slot(&self) -> Slot {
        let variant = self.variants.iter().find(|one| **one == self.kind);
        Slot {
            owner: self.name,
            variant: variant.copied().unwrap_or_default(),
            ..Slot::default()
        }
    }

    fn without_value(&self) -> ReadError {
        let kind = &self.kind;
        let message =
            format!("`{kind}` takes a value or fields, found none; write {{\"{kind}\": ...}}");
        ReadError::other(&message).at(&self.place)
    }
}

impl<'t> EnumAccess<'t> for Kind<'t> {
    type Error = ReadError;
    type Variant = Self;

    fn variant_seed<S: DeserializeSeed<'t>>(self, seed: S) -> Result<(S::Value, Self), ReadError> {
        let name: StrDeserializer<ReadError> = self.kind.as_str().into_deserializer();
        let value = seed
            .deserialize(name)
            .map_err(|error| error.at(&self.place))?;
        Ok((value, self))
    }
}

impl<'t> VariantAccess<'t> for Kind<'t> {
    type Error = ReadError;

    fn unit_variant(self) -> Result<(), ReadError> {
        match self.written.kind {
            NodeKind::Word | NodeKind::Text => Ok(()),
            _ => {
                let message = format!("`{0}` takes no value; write \"{0}\"", self.kind);
                Err(ReadError::other(&message).at(&self.place))
            }
        }
    }

    fn newtype_variant_seed<S: DeserializeSeed<'t>>(self, seed: S) -> Result<S::Value, ReadError> {
        let NodeKind::Tuple { items, .. } = &self.written.kind else {
            return Err(self.without_value());
        };
        let [item] = items.as_slice() else {
            let message = format!("`{}` takes one value, found {}", self.kind, items.len());
            return Err(ReadError::other(&message).at(&self.written.span));
        };
        let reader = Reader {
            node: self.reader.tree().without_some(item),
            slot: self.slot(),
            ..self.reader
        };
        seed.deserialize(reader)
            .map_err(|error| error.at(&item.span))
    }

    fn tuple_variant<V: Visitor<'t>>(self, n: usize, visitor: V) -> Result<V::Value, ReadError> {
        let NodeKind::Tuple { items, .. } = &self.written.kind else {
            return Err(self.without_value());
        };
        let slot = self.slot();
        match items.as_slice() {
            [item] => Reader {
                node: item,
                slot,
                ..self.reader
            }
            .deserialize_tuple(n, visitor),
            _ => {
                let reader = Reader {
                    slot,
                    ..self.reader
                };
                visitor.visit_seq(Items::of_row(&reader, items))
            }
        }
    }

    fn struct_variant<V: Visitor<'t>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let NodeKind::Record { fields: found, .. } = &self.written.kind else {
            return Err(self.without_value());
        };
        let reader = Reader {
            slot: self.slot(),
            ..self.reader
        };
        visitor
            .visit_map(Fields::new(reader, found, fields))
            .map_err(|error| error.within(self.name).at(&self.place))
    }
}
