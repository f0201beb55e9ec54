//! The fields of the data lines of a deck.

use std::fmt::Display;
use std::str::FromStr;

use super::card::{Line, Place};
use super::source::Source;
use crate::error::Error;

/// The fields of a data line, one after the other.
#[derive(Clone)]
pub(crate) struct Fields<'a> {
    source: &'a Source,
    pub place: Place,
    /// `None` behind the last field.
    rest: Option<&'a [u8]>,
}

/// Longer fields are cut in messages.
const SHOWN: usize = 40;

/// A field as it is quoted in messages.
fn shown(field: &[u8]) -> String {
    let text: String = String::from_utf8_lossy(field).chars().filter(|c| !c.is_control()).collect();
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

impl Source {
    /// The fields of a data line; a comma at its end begins no field.
    pub fn fields(&self, line: &Line) -> Fields<'_> {
        let text = self.text(line);
        let text = text.strip_suffix(b",").unwrap_or(text);
        Fields { source: self, place: line.place, rest: Some(text) }
    }
}

impl<'a> Fields<'a> {
    /// The next field without blanks around it; empty fields too.
    pub fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest?;
        let end = rest.iter().position(|&byte| byte == b',');
        self.rest = end.map(|end| &rest[end + 1..]);
        Some(rest[..end.unwrap_or(rest.len())].trim_ascii())
    }

    /// The next field, as a name or the like; `None` if it is empty or missing.
    pub fn text(&mut self) -> Option<String> {
        self.next().filter(|field| !field.is_empty()).map(|field| String::from_utf8_lossy(field).into_owned())
    }

    /// The next field as a whole number that is not negative.
    pub fn whole(&mut self, what: impl Display) -> Result<usize, Error> {
        let field = self.next().filter(|field| !field.is_empty());
        let Some(field) = field else { return Err(self.fault(format!("{what} is missing"))) };
        number(field).ok_or_else(|| self.wrong(field, what, "a whole number"))
    }

    /// The next field as a finite number; 0 if it is empty or missing.
    pub fn finite_or_zero(&mut self, what: impl Display) -> Result<f64, Error> {
        match self.clone().next() {
            Some(field) if !field.is_empty() => self.finite(what),
            _ => {
                self.next();
                Ok(0.0)
            }
        }
    }

    pub fn finite(&mut self, what: impl Display) -> Result<f64, Error> {
        let field = self.next().filter(|field| !field.is_empty());
        let Some(field) = field else { return Err(self.fault(format!("{what} is missing"))) };
        match number(field).or_else(|| number(&with_exponent(field))) {
            Some(value) if f64::is_finite(value) => Ok(value),
            _ => Err(self.wrong(field, what, "a finite number")),
        }
    }

    /// Refuses further fields.
    pub fn end(&mut self) -> Result<(), Error> {
        while let Some(field) = self.next() {
            if !field.is_empty() {
                let field = shown(field);
                return Err(self
                    .fault(format!("`{field}` follows the last value of this line; remove it, or a value before it")));
            }
        }
        Ok(())
    }

    /// Passes over further fields, as CalculiX does; the first line with some is noted.
    pub fn pass_over(&mut self) {
        if let Some(field) = std::iter::from_fn(|| self.next()).find(|field| !field.is_empty()) {
            let message =
                format!("`{}` follows the last value of this line; such values are passed over", shown(field));
            self.source.longer.get_or_init(|| (self.place, message));
        }
    }

    pub fn fault(&self, message: impl Into<String>) -> Error {
        self.source.fault(self.place, message)
    }

    fn wrong(&self, field: &[u8], what: impl Display, allowed: &str) -> Error {
        self.fault(format!("{what} is `{}`; it must be {allowed}", shown(field)))
    }
}

/// A number as text; also one that is only part of a field in other languages, such as `1.` and `.3`.
fn number<T: FromStr>(field: &[u8]) -> Option<T> {
    std::str::from_utf8(field).ok().and_then(|text| text.parse().ok())
}

/// A number of Fortran with the letter of its exponent: `1d5` and `1+5` are `1e5`.
fn with_exponent(field: &[u8]) -> Vec<u8> {
    let mut text = Vec::with_capacity(field.len() + 1);
    for &byte in field {
        match byte {
            b'd' | b'D' => text.push(b'e'),
            b'+' | b'-' if text.last().is_some_and(|last| last.is_ascii_digit() || *last == b'.') => {
                text.extend([b'e', byte]);
            }
            _ => text.push(byte),
        }
    }
    text
}
