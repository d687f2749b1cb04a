//! Types of saving and reading a state as bytes.

/// Bytes with a state appended.
pub(crate) type Saved = Result<Vec<u8>, postcard::Error>;
/// Remaining bytes after a state was read.
pub(crate) type Read<'a> = Result<&'a [u8], postcard::Error>;
