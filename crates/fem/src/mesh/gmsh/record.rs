//! The two forms of a file and its sections; the numbers of a record: words of a line, or bytes. Errors have positions.

use std::fmt::Display;
use std::path::Path;
use std::str::FromStr;

use crate::error::Error;
use signorini_linear as linear;

const WHOLE: &str = "a whole number that is not negative";

/// The numbers that belong together, as a node or an element: a line of text, or numbers in binary form.
pub struct Record<'s, 'a> {
    source: &'s mut MshSource<'a>,
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

impl<'a> MshSource<'a> {
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
        let FileForm::Binary { order, version, .. } = self.form else { return self.line(what) };
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

/// The form in which the numbers of a file are written.
#[derive(Clone, Debug, Default)]
pub(super) enum FileForm {
    /// As words in lines. A position is a line, from 1.
    #[default]
    Text,
    /// As bytes. A position is a byte, from 0.
    Binary {
        order: ByteOrder,
        version: Version,
        /// The byte at which each section begins, and its line: a line ends at every byte 10, as in an editor.
        sections: Vec<(usize, usize)>,
    },
}

/// The byte order of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// The versions of the format that are read; each has its width of tags and counts in binary form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    /// 2.2: four bytes, signed.
    V2,
    /// 4.1: eight bytes, unsigned.
    V4,
}

impl FileForm {
    /// An error at a position: with its line, or with its byte and the line in which the section begins.
    pub fn fault(&self, file: &Path, place: usize, message: impl Into<String>) -> Error {
        let (line, message) = match self {
            FileForm::Text => (place, message.into()),
            FileForm::Binary { sections, .. } => {
                let begun = sections.partition_point(|(begin, _)| *begin <= place);
                let line = sections[..begun].last().map_or(1, |(_, line)| *line);
                (line, format!("at byte {place}: {}", message.into()))
            }
        };
        linear::Error::FileSyntax { file: file.into(), line, message }.into()
    }
}

/// A file that is read from its first byte to its last: as text, until it says that it is binary.
pub(super) struct MshSource<'a> {
    pub file: &'a Path,
    /// In binary form it also states positions after the file has been read.
    pub form: FileForm,
    /// The bytes that have not been read.
    rest: &'a [u8],
    /// Number of bytes that have been read, and of line ends among them.
    bytes: usize,
    line_ends: usize,
    /// First byte and line of the last item read.
    byte: usize,
    line: usize,
}

impl<'a> MshSource<'a> {
    pub fn new(file: &'a Path, content: &'a [u8]) -> Self {
        // Some editors write a byte order mark at the start.
        const MARK: &[u8] = "\u{feff}".as_bytes();
        let mut source =
            MshSource { file, form: FileForm::Text, rest: content, bytes: 0, line_ends: 0, byte: 0, line: 1 };
        if content.starts_with(MARK) {
            source.pass(MARK.len());
        }
        source
    }

    /// The position of the last item read; in an empty file the first line.
    pub fn place(&self) -> usize {
        match self.form {
            FileForm::Text => self.line,
            FileForm::Binary { .. } => self.byte,
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
        if let FileForm::Binary { sections, .. } = &mut self.form {
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
            FileForm::Text => std::iter::from_fn(|| self.next())
                .find(|line| line.strip_prefix(b"$End").is_some_and(|end| end.trim_ascii() == name)),
            // The length of the numbers in an unknown section is unknown.
            FileForm::Binary { .. } => {
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
