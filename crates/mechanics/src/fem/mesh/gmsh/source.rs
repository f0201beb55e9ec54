//! The bytes of a file and the sections in them; every error has its position.

use std::path::Path;

use super::form::Form;
use crate::error::Error;

/// A file that is read from its first byte to its last: as text, until it says that it is binary.
pub(super) struct Source<'a> {
    pub file: &'a Path,
    /// In binary form it also states positions after the file has been read.
    pub form: Form,
    /// The bytes that have not been read.
    rest: &'a [u8],
    /// Number of bytes that have been read, and of line ends among them.
    bytes: usize,
    line_ends: usize,
    /// First byte and line of the last item read.
    byte: usize,
    line: usize,
}

impl<'a> Source<'a> {
    pub fn new(file: &'a Path, content: &'a [u8]) -> Self {
        // Some editors write a byte order mark at the start.
        const MARK: &[u8] = "\u{feff}".as_bytes();
        let mut source = Source { file, form: Form::Text, rest: content, bytes: 0, line_ends: 0, byte: 0, line: 1 };
        if content.starts_with(MARK) {
            source.pass(MARK.len());
        }
        source
    }

    /// The position of the last item read; in an empty file the first line.
    pub fn place(&self) -> usize {
        match self.form {
            Form::Text => self.line,
            Form::Binary { .. } => self.byte,
        }
    }

    /// The next line that is not empty, without surrounding blanks.
    pub fn next(&mut self) -> Option<&'a [u8]> {
        while !self.rest.is_empty() {
            self.begin();
            let end = self.rest.iter().position(|&byte| byte == b'\n');
            let line = self.pass(end.map_or(self.rest.len(), |end| end + 1)).trim_ascii();
            if !line.is_empty() {
                return Some(line);
            }
        }
        None
    }

    /// The line in which the next section should begin.
    pub fn section(&mut self) -> Option<&'a [u8]> {
        let line = self.next()?;
        if let Form::Binary { sections, .. } = &mut self.form {
            sections.push((self.byte, self.line));
        }
        Some(line)
    }

    /// Makes the next item the position of errors.
    pub fn begin(&mut self) {
        (self.byte, self.line) = (self.bytes, self.line_ends + 1);
    }

    pub fn is_at_end(&self) -> bool {
        self.rest.is_empty()
    }

    /// The next `N` bytes, if the file has them.
    pub fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let bytes = *self.rest.first_chunk()?;
        self.pass(N);
        Some(bytes)
    }

    /// The next `count` bytes of the remaining ones.
    fn pass(&mut self, count: usize) -> &'a [u8] {
        let (passed, rest) = self.rest.split_at(count);
        self.rest = rest;
        self.bytes += count;
        self.line_ends += passed.iter().filter(|&&byte| byte == b'\n').count();
        passed
    }

    /// Closes the section `name`, whose content has been read.
    pub fn end(&mut self, name: &str) -> Result<(), Error> {
        match self.next().map(|line| line.strip_prefix(b"$End")) {
            Some(Some(end)) if end.trim_ascii() == name.as_bytes() => Ok(()),
            Some(Some(end)) => {
                Err(self.fault(format!("`$End{}` stands where `$End{name}` should stand", shortened(end))))
            }
            Some(None) => {
                Err(self
                    .fault(format!("there is more in the section than it announces; `$End{name}` should stand here")))
            }
            None => Err(self.fault(format!("the file ends before `$End{name}`"))),
        }
    }

    /// Skips the section `name`, which has just begun.
    pub fn skip(&mut self, name: &[u8]) -> Result<(), Error> {
        let begin = self.line;
        let end = [b"$End", name].concat();
        let found = match self.form {
            Form::Text => std::iter::from_fn(|| self.next())
                .find(|line| line.strip_prefix(b"$End").is_some_and(|end| end.trim_ascii() == name)),
            // The length of the numbers in an unknown section is unknown.
            Form::Binary { .. } => {
                let ends = |rest: &[u8]| rest.first().is_none_or(u8::is_ascii_whitespace);
                let is_end = |at: &usize| self.rest[*at..].strip_prefix(end.as_slice()).is_some_and(ends);
                (0..self.rest.len()).find(is_end).map(|at| self.pass(at + end.len()))
            }
        };
        match found {
            Some(_) => Ok(()),
            None => {
                let end = shortened(&end);
                Err(self.fault(format!("the file ends before `{end}`; the section begins in line {begin}")))
            }
        }
    }

    /// An error at the last item read.
    pub fn fault(&self, message: impl Into<String>) -> Error {
        self.fault_at(self.place(), message)
    }

    /// An error at a position.
    pub fn fault_at(&self, place: usize, message: impl Into<String>) -> Error {
        self.form.fault(self.file, place, message)
    }
}

/// Bytes for a message: as text of one line, only their beginning if they are long.
pub(super) fn shortened(bytes: &[u8]) -> String {
    const SHOWN: usize = 60;
    // A character has at most four bytes.
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * SHOWN + 4)]);
    let shown = text.chars().map(|character| if character.is_control() { '\u{fffd}' } else { character });
    match text.char_indices().nth(SHOWN) {
        Some(_) => shown.take(SHOWN).chain("...".chars()).collect(),
        None => shown.collect(),
    }
}
