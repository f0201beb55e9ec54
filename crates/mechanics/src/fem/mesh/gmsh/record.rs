//! The numbers of a record: the words of a line, or bytes.

use std::fmt::Display;
use std::str::FromStr;

use super::form::{ByteOrder, Form, Version};
use super::source::{Source, shortened};
use crate::error::Error;

const WHOLE: &str = "a whole number that is not negative";

/// The numbers that belong together, as a node or an element: a line of text, or numbers in binary form.
pub struct Record<'s, 'a> {
    source: &'s mut Source<'a>,
    numbers: Numbers<'a>,
}

enum Numbers<'a> {
    /// The whole line, and its part that has not been read.
    Words {
        line: &'a [u8],
        rest: &'a [u8],
    },
    Bytes(ByteOrder, Version),
}

impl<'a> Source<'a> {
    /// The next line of a section that is text in either form; `what` names the expected content.
    pub fn line<D: Display>(&mut self, what: impl Fn() -> D) -> Result<Record<'_, 'a>, Error> {
        let Some(line) = self.next() else {
            return Err(self.fault(format!("the file ends where {} should stand", what())));
        };
        if line.starts_with(b"$") {
            return Err(self.fault(format!("`{}` stands where {} should stand", shortened(line), what())));
        }
        Ok(Record { source: self, numbers: Numbers::Words { line, rest: line } })
    }

    /// The next record of a section; `what` names the expected content.
    pub fn record<D: Display>(&mut self, what: impl Fn() -> D) -> Result<Record<'_, 'a>, Error> {
        let Form::Binary { order, version, .. } = self.form else { return self.line(what) };
        self.begin();
        if self.is_at_end() {
            return Err(self.fault(format!("the file ends where {} should stand", what())));
        }
        Ok(Record { source: self, numbers: Numbers::Bytes(order, version) })
    }
}

impl<'a> Record<'_, 'a> {
    /// The position of the record.
    pub fn place(&self) -> usize {
        self.source.place()
    }

    /// The next number as a tag or a count.
    pub fn whole(&mut self, name: impl Display) -> Result<usize, Error> {
        match self.numbers {
            Numbers::Words { .. } => self.word(name, WHOLE),
            Numbers::Bytes(_, Version::V2) => self.code(name),
            Numbers::Bytes(order, Version::V4) => {
                let value = u64::from_le_bytes(self.bytes(order, &name, WHOLE)?);
                usize::try_from(value).map_err(|_| self.not_allowed(name, value, WHOLE))
            }
        }
    }

    /// The next number as a code: a dimension or a type.
    pub fn code(&mut self, name: impl Display) -> Result<usize, Error> {
        match self.numbers {
            Numbers::Words { .. } => self.word(name, WHOLE),
            Numbers::Bytes(order, _) => {
                let value = i32::from_le_bytes(self.bytes(order, &name, WHOLE)?);
                usize::try_from(value).map_err(|_| self.not_allowed(name, value, WHOLE))
            }
        }
    }

    /// The next number as an integer of either sign: the tag of an entity or a group.
    pub fn integer(&mut self, name: impl Display) -> Result<i64, Error> {
        const ALLOWED: &str = "a whole number";
        match self.numbers {
            Numbers::Words { .. } => self.word(name, ALLOWED),
            Numbers::Bytes(order, _) => Ok(i32::from_le_bytes(self.bytes(order, name, ALLOWED)?).into()),
        }
    }

    /// The next number, which must be finite.
    pub fn finite(&mut self, name: impl Display) -> Result<f64, Error> {
        const ALLOWED: &str = "a number";
        let value = match self.numbers {
            Numbers::Words { .. } => self.word(&name, ALLOWED)?,
            Numbers::Bytes(order, _) => f64::from_le_bytes(self.bytes(order, &name, ALLOWED)?),
        };
        if value.is_finite() { Ok(value) } else { Err(self.fault(format!("{name} is {value}; it must be finite"))) }
    }

    /// The next word of the line.
    fn word<T: FromStr>(&mut self, name: impl Display, allowed: &str) -> Result<T, Error> {
        let word = self.next_word();
        if word.is_empty() {
            return Err(self.fault(format!("the line ends where {name} should stand, {allowed}")));
        }
        let value = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        value.ok_or_else(|| self.not_allowed(name, shortened(word), allowed))
    }

    /// The next word of the line; empty at its end.
    fn next_word(&mut self) -> &'a [u8] {
        let Numbers::Words { rest, .. } = &mut self.numbers else { return &[] };
        let from = rest.trim_ascii_start();
        let (word, after) = from.split_at(from.iter().position(u8::is_ascii_whitespace).unwrap_or(from.len()));
        *rest = after;
        word
    }

    /// The next bytes, with the lowest byte first.
    fn bytes<const N: usize>(&mut self, order: ByteOrder, name: impl Display, allowed: &str) -> Result<[u8; N], Error> {
        let Some(mut bytes) = self.source.take() else {
            return Err(self.fault(format!("the file ends where {name} should stand, {allowed}")));
        };
        if order == ByteOrder::Big {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// The whole line; empty in binary form.
    pub fn text(&self) -> &'a [u8] {
        match self.numbers {
            Numbers::Words { line, .. } => line,
            Numbers::Bytes(..) => &[],
        }
    }

    /// Checks that the line has no further word.
    pub fn end(mut self) -> Result<(), Error> {
        match self.next_word() {
            [] => Ok(()),
            word => {
                let message = format!("`{}` is one field too many in `{}`", shortened(word), shortened(self.text()));
                Err(self.fault(message))
            }
        }
    }

    fn not_allowed(&self, name: impl Display, value: impl Display, allowed: &str) -> Error {
        self.fault(format!("{name} is `{value}`; it must be {allowed}"))
    }

    pub fn fault(&self, message: impl Into<String>) -> Error {
        self.source.fault(message)
    }
}
