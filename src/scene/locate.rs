//! The position of a value in the text of a scene, by its JSON path.

use std::path::Path;

use super::Scene;
use crate::error::Error;
use crate::file::{MOST_OF_SCENE, read_text_capped};

impl Scene {
    /// An error of a value with its line and column, if the scene was read from a file that can be read again.
    pub fn located(error: Error, file: &Path) -> Error {
        let place_of = |path: &str| match read_text_capped(file, MOST_OF_SCENE) {
            Ok(text) if file.is_file() => position(&text, path),
            _ => None,
        };
        match error {
            Error::Scene { path, message } => match place_of(&path) {
                Some((line, column)) => {
                    Error::SceneSyntax { source_name: file.display().to_string(), line, column, path, message }
                }
                None => Error::Scene { path, message },
            },
            Error::Refused { code, place, path, message } => {
                let found = place_of(&path).map(|(line, column)| format!("{}:{line}:{column}: ", file.display()));
                Error::Refused { code, place: found.unwrap_or(place), path, message }
            }
            other => other,
        }
    }
}

/// Line and column, from 1, of the value at `path` as `supports[0].on.boundary`; if it is missing, of the value that should contain it.
/// `None` if the text is not valid JSON up to there.
fn position(text: &str, path: &str) -> Option<(usize, usize)> {
    let mut at = Scanner { bytes: text.as_bytes(), place: 0 };
    at.skip_space();
    let keys = path.split(['.', '[']).map(|key| key.trim_end_matches(']')).filter(|key| !key.is_empty());
    for key in keys {
        let found = Scanner { ..at }.enter(key)?;
        match found {
            Some(place) => at.place = place,
            None => break,
        }
    }
    let before = &text[..at.place];
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
    Some((line, column))
}

/// A position in a JSON text.
struct Scanner<'a> {
    bytes: &'a [u8],
    place: usize,
}

impl Scanner<'_> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.place).copied()
    }

    fn skip_space(&mut self) {
        while self.peek().is_some_and(|byte| byte.is_ascii_whitespace())
            || self.bytes[self.place..].starts_with(b"\xef\xbb\xbf")
        {
            self.place += if self.peek() == Some(0xef) { 3 } else { 1 };
        }
    }

    /// The start of the value of `key`, or of the item with that number; `Some(None)` if it does not exist.
    fn enter(mut self, key: &str) -> Option<Option<usize>> {
        let open = self.peek()?;
        if open != b'{' && open != b'[' {
            return Some(None);
        }
        self.place += 1;
        for index in 0.. {
            self.skip_space();
            if matches!(self.peek()?, b'}' | b']') {
                return Some(None);
            }
            let mut found = open == b'[' && key.parse() == Ok(index);
            if open == b'{' {
                let start = self.place;
                self.skip_value()?;
                let name: Option<String> = serde_json::from_slice(&self.bytes[start..self.place]).ok();
                found = name.as_deref() == Some(key);
                self.skip_space();
                // Skip the colon.
                self.place += 1;
                self.skip_space();
            }
            if found {
                return Some(Some(self.place));
            }
            self.skip_value()?;
            self.skip_space();
            if self.peek()? == b',' {
                self.place += 1;
            }
        }
        None
    }

    fn skip_value(&mut self) -> Option<()> {
        let mut depth = 0_usize;
        loop {
            match self.peek()? {
                b'"' => {
                    self.place += 1;
                    while self.peek()? != b'"' {
                        self.place += if self.peek()? == b'\\' { 2 } else { 1 };
                    }
                }
                b'{' | b'[' => depth += 1,
                b'}' | b']' => depth = depth.checked_sub(1)?,
                _ => {}
            }
            self.place += 1;
            if depth == 0 && self.peek().is_none_or(|byte| b",:}] \t\r\n".contains(&byte)) {
                return Some(());
            }
        }
    }
}
