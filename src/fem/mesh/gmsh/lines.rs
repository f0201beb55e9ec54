//! The lines of a file and the numbers in them; every fault has its line.

use std::fmt::Display;
use std::path::Path;
use std::str::{FromStr, SplitAsciiWhitespace};

use crate::error::Error;

/// The lines of a text that are not empty, one after the other.
pub(super) struct Lines<'a> {
    file: &'a Path,
    lines: std::str::Lines<'a>,
    line: usize,
}

impl<'a> Lines<'a> {
    pub fn new(file: &'a Path, text: &'a str) -> Self {
        Lines { file, lines: text.lines(), line: 0 }
    }

    /// Number of the line read last, from 1; in an empty file 1 too.
    pub fn line(&self) -> usize {
        self.line.max(1)
    }

    /// The next line that is not empty, without the blanks around it.
    pub fn next(&mut self) -> Option<&'a str> {
        loop {
            let line = self.lines.next()?.trim();
            self.line += 1;
            if !line.is_empty() {
                return Some(line);
            }
        }
    }

    /// The fields of the next line of a section; `what` names what stands there.
    pub fn fields<D: Display>(&mut self, what: impl Fn() -> D) -> Result<Fields<'a>, Error> {
        let Some(text) = self.next() else {
            return Err(self.fault(format!("the file ends where {} should stand", what())));
        };
        if text.starts_with('$') {
            return Err(self.fault(format!("`{text}` stands where {} should stand", what())));
        }
        Ok(Fields { file: self.file, line: self.line, text, words: text.split_ascii_whitespace() })
    }

    /// Closes the section `name`, whose content has been read.
    pub fn end(&mut self, name: &str) -> Result<(), Error> {
        match self.next().map(|line| line.strip_prefix("$End")) {
            Some(Some(end)) if end.trim() == name => Ok(()),
            Some(Some(end)) => Err(self.fault(format!("`$End{end}` stands where `$End{name}` should stand"))),
            Some(None) => {
                Err(self
                    .fault(format!("there is more in the section than it announces; `$End{name}` should stand here")))
            }
            None => Err(self.fault(format!("the file ends before `$End{name}`"))),
        }
    }

    /// Passes over the section `name`, which has just begun.
    pub fn skip(&mut self, name: &str) -> Result<(), Error> {
        let begin = self.line;
        while let Some(line) = self.next() {
            if line.strip_prefix("$End").is_some_and(|end| end.trim() == name) {
                return Ok(());
            }
        }
        Err(self.fault(format!("the file ends before `$End{name}`; the section begins in line {begin}")))
    }

    /// A fault of the line read last.
    pub fn fault(&self, message: impl Into<String>) -> Error {
        fault(self.file, self.line(), message)
    }
}

/// A fault of a line.
pub(super) fn fault(file: &Path, line: usize, message: impl Into<String>) -> Error {
    Error::FileSyntax { file: file.into(), line, message: message.into() }
}

/// The fields of one line, separated by blanks.
pub(super) struct Fields<'a> {
    file: &'a Path,
    line: usize,
    text: &'a str,
    words: SplitAsciiWhitespace<'a>,
}

impl Fields<'_> {
    /// Number of the line, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// The whole line.
    pub fn text(&self) -> &str {
        self.text
    }

    /// The next field as a whole number that is not negative: a tag or a count.
    pub fn whole(&mut self, name: impl Display) -> Result<usize, Error> {
        self.number(name, "a whole number that is not negative")
    }

    /// The next field as a whole number of either sign.
    pub fn integer(&mut self, name: impl Display) -> Result<i64, Error> {
        self.number(name, "a whole number")
    }

    /// The next field as a finite number.
    pub fn finite(&mut self, name: impl Display) -> Result<f64, Error> {
        let value: f64 = self.number(&name, "a number")?;
        if value.is_finite() { Ok(value) } else { Err(self.fault(format!("{name} is {value}; it must be finite"))) }
    }

    fn number<T: FromStr>(&mut self, name: impl Display, allowed: &str) -> Result<T, Error> {
        match self.words.next() {
            Some(word) => word.parse().map_err(|_| self.fault(format!("{name} is `{word}`; it must be {allowed}"))),
            None => Err(self.fault(format!("the line ends where {name} should stand, {allowed}"))),
        }
    }

    /// Checks that the line has no further field.
    pub fn end(mut self) -> Result<(), Error> {
        match self.words.next() {
            Some(word) => Err(self.fault(format!("`{word}` is one field too many in `{}`", shortened(self.text)))),
            None => Ok(()),
        }
    }

    /// A fault of this line.
    pub fn fault(&self, message: impl Into<String>) -> Error {
        fault(self.file, self.line, message)
    }
}

/// A line for a message: its beginning, if it is long.
pub(super) fn shortened(text: &str) -> String {
    const SHOWN: usize = 60;
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.into(),
    }
}
