//! The lines of a text that is not held in memory.

use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::file::Capped;

/// Bytes of a text that are read at a time.
const PIECE: usize = 1 << 20;

/// Bytes of a line beyond this number are skipped: no valid line is as long.
const LONGEST: usize = 1 << 16;

/// The lines of a file, one at a time.
pub(super) struct Lines {
    file: PathBuf,
    reader: BufReader<Capped>,
    number: usize,
    bytes: Vec<u8>,
    text: String,
}

impl Lines {
    /// Before the first line.
    pub fn of(file: &Path, text: Capped) -> Self {
        let reader = BufReader::with_capacity(PIECE, text);
        Lines { file: file.to_path_buf(), reader, number: 0, bytes: Vec::new(), text: String::new() }
    }

    /// Number of lines that were read.
    pub fn number(&self) -> usize {
        self.number
    }

    /// The next line, with its number from 1 and without blanks at its ends.
    pub fn next(&mut self) -> Result<Option<(usize, &str)>, Error> {
        let there = self.advance().map_err(|source| Error::File { action: "read", path: self.file.clone(), source })?;
        Ok(there.then(|| (self.number, self.text.trim())))
    }

    /// The next line that is neither blank nor a comment.
    pub fn next_data(&mut self) -> Result<Option<(usize, &str)>, Error> {
        loop {
            match self.next()? {
                None => return Ok(None),
                Some((_, line)) if line.is_empty() || line.starts_with('%') => {}
                Some(_) => return Ok(Some((self.number, self.text.trim()))),
            }
        }
    }

    /// Reads a line; `false` at the end of the file.
    fn advance(&mut self) -> io::Result<bool> {
        self.bytes.clear();
        self.reader.by_ref().take(LONGEST as u64).read_until(b'\n', &mut self.bytes)?;
        if self.bytes.is_empty() {
            return Ok(false);
        }
        if self.bytes.len() == LONGEST && !self.bytes.ends_with(b"\n") {
            self.reader.skip_until(b'\n')?;
        }
        self.number += 1;
        // Comments of older collections hold names in other encodings; the numbers are always ASCII.
        let text = String::from_utf8_lossy(&self.bytes);
        // Some editors put a byte order mark in front.
        let mark = if self.number == 1 { "\u{feff}" } else { "" };
        self.text.clear();
        self.text.push_str(text.strip_prefix(mark).unwrap_or(&text));
        Ok(true)
    }
}
