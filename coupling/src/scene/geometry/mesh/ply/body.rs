//! Numbers of a PLY file, one after another.

use std::borrow::Cow;
use std::collections::VecDeque;

use super::header::{Element, Encoding, Kind, Scalar};
use crate::scene::access::fault::Fault;

/// Numbers after the header, in the order of its elements and properties.
pub(super) struct Body<'a> {
    encoding: Encoding,
    rest: &'a [u8],
    /// Words left of the present line of a text.
    words: VecDeque<Cow<'a, str>>,
    /// Number of the present line of a text, from 1.
    line: usize,
    /// Present item, for messages: its element, its number from 1, their number.
    item: (String, u64, u64),
}

impl<'a> Body<'a> {
    /// Numbers in the bytes after a header of `n_lines`.
    pub(super) fn new(encoding: Encoding, rest: &'a [u8], n_lines: usize) -> Self {
        Self {
            encoding,
            rest,
            words: VecDeque::new(),
            line: n_lines,
            item: (String::new(), 0, 0),
        }
    }

    /// Begins item `number` of an element: a line of its own in a text.
    pub(super) fn begin(&mut self, element: &Element, number: u64) -> Result<(), Fault> {
        if number == 0 {
            self.item = (element.name.clone(), 0, element.n);
        }
        self.item.1 = number + 1;
        while self.encoding == Encoding::Text && self.words.is_empty() {
            if self.rest.is_empty() {
                return Err(self.cut());
            }
            let end = self.rest.iter().position(|&byte| byte == b'\n');
            let (line, rest) = match end {
                Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
                None => (self.rest, &[][..]),
            };
            let words = line
                .split(u8::is_ascii_whitespace)
                .filter(|w| !w.is_empty());
            self.words.extend(words.map(String::from_utf8_lossy));
            self.rest = rest;
            self.line += 1;
        }
        Ok(())
    }

    /// Ends an item: nothing may be left on its line.
    pub(super) fn end(&mut self) -> Result<(), Fault> {
        match self.words.front() {
            Some(word) => Err(self.wrong(&format!("`{word}` follows the last property"))),
            None => Ok(()),
        }
    }

    /// The next number.
    pub(super) fn number(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        if self.encoding == Encoding::Text {
            let Some(word) = self.words.pop_front() else {
                return Err(self.wrong("fewer numbers than properties"));
            };
            return word
                .parse()
                .map_err(|_| self.wrong(&format!("found `{word}`, needed a number")));
        }
        match scalar {
            Scalar::I8 => self.bytes().map(|[byte]| f64::from(byte as i8)),
            Scalar::U8 => self.bytes().map(|[byte]| f64::from(byte)),
            Scalar::I16 => self.bytes().map(|b| f64::from(i16::from_le_bytes(b))),
            Scalar::U16 => self.bytes().map(|b| f64::from(u16::from_le_bytes(b))),
            Scalar::I32 => self.bytes().map(|b| f64::from(i32::from_le_bytes(b))),
            Scalar::U32 => self.bytes().map(|b| f64::from(u32::from_le_bytes(b))),
            Scalar::F32 => self.bytes().map(|b| f64::from(f32::from_le_bytes(b))),
            Scalar::F64 => self.bytes().map(f64::from_le_bytes),
        }
    }

    /// Hands the next number, or each of a list, to `take`.
    pub(super) fn list(
        &mut self,
        kind: Kind,
        mut take: impl FnMut(f64) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        match kind {
            Kind::Scalar(scalar) => {
                let number = self.number(scalar)?;
                take(number)
            }
            Kind::List { count, item } => {
                let n = self.number(count)?;
                if !(n >= 0.0 && n.fract() == 0.0) {
                    return Err(self.wrong(&format!("a list of {n} items")));
                }
                // ends with the bytes at the latest, however large the count
                for _ in 0..n as u64 {
                    let number = self.number(item)?;
                    take(number)?;
                }
                Ok(())
            }
        }
    }

    /// The next bytes of a binary file, in little-endian order.
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let Some((first, rest)) = self.rest.split_first_chunk::<N>() else {
            return Err(self.cut());
        };
        let mut bytes = *first;
        self.rest = rest;
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn cut(&self) -> Fault {
        let (element, number, n) = &self.item;
        Fault::Format(format!(
            "ends within {element} {number} of {n}; the file is cut: export it again"
        ))
    }

    fn wrong(&self, found: &str) -> Fault {
        let (element, number, n) = &self.item;
        Fault::Format(match self.encoding {
            Encoding::Text => format!("line {}: {element} {number} of {n}: {found}", self.line),
            _ => format!("{element} {number} of {n}: {found}"),
        })
    }
}
