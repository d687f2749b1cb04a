//! Codes of errors and warnings: one for each cause and remedy, printed behind the message and explained in
//! `docs/troubleshooting.md`.

mod codes;
pub mod guide;
mod solvers;

use std::fmt::{self, Display, Formatter};
use std::io::{Error, ErrorKind};

pub use codes::Code;

impl Display for Code {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// An error or a warning with its code.
pub trait Coded: Display {
    /// Its cause, as the guide explains it.
    fn code(&self) -> Code;
}

/// An error or a warning in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    code: Code,
    text: String,
}

impl Message {
    /// A message; lowercase, no full stop.
    pub fn new(code: Code, text: impl Into<String>) -> Self {
        let text = text.into();
        Self { code, text }
    }

    /// The words and the code of an error.
    pub fn of(error: impl Coded) -> Self {
        Self::new(error.code(), error.to_string())
    }
}

impl Display for Message {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Coded for Message {
    fn code(&self) -> Code {
        self.code
    }
}

/// A text with a code at the end of its first line.
pub fn with_code(text: &str, code: Code) -> String {
    match text.split_once('\n') {
        Some((first, rest)) => format!("{first} [{code}]\n{rest}"),
        None => format!("{text} [{code}]"),
    }
}

/// Cause of an error of writing.
pub(crate) fn of_writing(error: &Error) -> Code {
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Code::DiskFull,
        _ => Code::CannotWrite,
    }
}
