//! Faults of values, placed on their way out of the tree.

use std::fmt::{self, Display};
use std::ops::Range;

use serde::de;

use crate::messages::Code;
use crate::scene::parse::TextError;
use crate::scene::parse::suggest::{missing_field, unknown_field, unknown_variant};

/// Fault of a value.
#[derive(Clone, Debug)]
pub(in crate::scene::parse) struct ReadError {
    fault: Fault,
    /// Name of the type around it.
    outer: Option<&'static str>,
    /// Location; bytes.
    span: Option<Range<usize>>,
}

#[derive(Clone, Debug)]
enum Fault {
    UnknownField(String, &'static [&'static str]),
    UnknownVariant(String, &'static [&'static str]),
    MissingField(&'static str),
    Twice(&'static str),
    Quantity(String),
    Other(String),
}

impl ReadError {
    fn new(fault: Fault) -> Self {
        Self {
            fault,
            outer: None,
            span: None,
        }
    }

    pub(super) fn other(message: &str) -> Self {
        Self::new(Fault::Other(message.to_owned()))
    }

    /// Of a quantity in a wrong unit.
    pub(super) fn quantity(message: String) -> Self {
        Self::new(Fault::Quantity(message))
    }

    /// Whether it is the fault of a quantity in a wrong unit.
    pub(in crate::scene::parse) fn is_of_quantity(&self) -> bool {
        matches!(self.fault, Fault::Quantity(_))
    }

    /// Places the error where it has no place yet.
    pub(super) fn at(mut self, span: &Range<usize>) -> Self {
        self.span.get_or_insert_with(|| span.clone());
        self
    }

    /// Names the type around it where none is named yet.
    pub(super) fn within(mut self, outer: &'static str) -> Self {
        self.outer.get_or_insert(outer);
        self
    }

    pub(in crate::scene::parse) fn into_text_error(self) -> TextError {
        TextError {
            code: self.code(),
            message: self.to_string(),
            span: self.span.unwrap_or(0..0),
        }
    }
}

impl ReadError {
    fn code(&self) -> Code {
        match self.fault {
            Fault::UnknownField(..) => Code::UnknownField,
            Fault::UnknownVariant(..) => Code::UnknownKind,
            Fault::MissingField(_) => Code::MissingField,
            Fault::Twice(_) => Code::WrittenTwice,
            Fault::Quantity(_) => Code::WrongUnit,
            Fault::Other(_) => Code::SceneSyntax,
        }
    }
}

impl Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let message = match &self.fault {
            Fault::UnknownField(found, expected) => unknown_field(found, self.outer, expected),
            Fault::UnknownVariant(found, expected) => unknown_variant(found, self.outer, expected),
            Fault::MissingField(field) => missing_field(field, self.outer),
            Fault::Twice(field) => format!("`{field}` is written twice; keep one"),
            Fault::Quantity(message) | Fault::Other(message) => message.clone(),
        };
        f.write_str(&message)
    }
}

impl std::error::Error for ReadError {}

impl de::Error for ReadError {
    fn custom<T: Display>(message: T) -> Self {
        Self::new(Fault::Other(message.to_string()))
    }

    fn unknown_field(found: &str, expected: &'static [&'static str]) -> Self {
        Self::new(Fault::UnknownField(found.to_owned(), expected))
    }

    fn unknown_variant(found: &str, expected: &'static [&'static str]) -> Self {
        Self::new(Fault::UnknownVariant(found.to_owned(), expected))
    }

    fn missing_field(field: &'static str) -> Self {
        Self::new(Fault::MissingField(field))
    }

    fn duplicate_field(field: &'static str) -> Self {
        Self::new(Fault::Twice(field))
    }
}
