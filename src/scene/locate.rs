//! The position of a value in the text of a scene, by its JSON path.

use std::io;
use std::path::Path;

use super::Scene;
use super::files::Named;
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
            Error::File { action, path, source } => {
                let named = source.get_ref().and_then(|reason| reason.downcast_ref::<Named>()).cloned();
                let place = named.as_ref().and_then(|named| place_of(&named.path));
                let source = match (named, place) {
                    (Some(named), Some((line, column))) => {
                        let scene = format!("{}:{line}:{column}", file.display());
                        io::Error::new(source.kind(), Named { scene, ..named })
                    }
                    _ => source,
                };
                Error::File { action, path, source }
            }
            other => other,
        }
    }
}

/// Line and column, from 1, of the value at `path` as `supports[0].on.boundary`; if it is missing, of the value that should contain it.
/// `None` if the text is not valid JSON up to there.
fn position(text: &str, path: &str) -> Option<(usize, usize)> {
    let before = &text[..start_of(text, path)?];
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
    Some((line, column))
}

/// The place of the value at `path`, in bytes, as [`position`].
fn start_of(text: &str, path: &str) -> Option<usize> {
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
    Some(at.place)
}

/// The places of the entries of the array at `path`, in bytes; `None` if there is no array.
pub(super) fn starts_of_entries(text: &str, path: &str) -> Option<Vec<usize>> {
    let mut at = Scanner { bytes: text.as_bytes(), place: start_of(text, path)? };
    let mut starts = Vec::new();
    if at.peek()? != b'[' {
        return None;
    }
    at.place += 1;
    loop {
        at.skip_space();
        match at.peek()? {
            b']' => return Some(starts),
            b',' => at.place += 1,
            _ => {
                starts.push(at.place);
                at.skip_value()?;
            }
        }
    }
}

/// The last key before a place (in bytes) in the object that contains the place; `None` if an array contains it.
pub(super) fn key_before(text: &str, place: usize) -> Option<&str> {
    let mut open: Vec<Option<&str>> = Vec::new();
    let (mut string, mut from) = ("", None);
    let mut is_escaped = false;
    for (at, byte) in text.bytes().enumerate().take(place) {
        match (byte, from) {
            _ if is_escaped => is_escaped = false,
            (b'\\', Some(_)) => is_escaped = true,
            (b'"', None) => from = Some(at + 1),
            (b'"', Some(start)) => {
                string = &text[start..at];
                from = None;
            }
            (_, Some(_)) => {}
            (b'{' | b'[', None) => open.push(None),
            (b'}' | b']', None) => drop(open.pop()),
            (b':', None) => {
                if let Some(key) = open.last_mut() {
                    *key = Some(string);
                }
            }
            _ => {}
        }
    }
    open.last().copied().flatten()
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
            || self.bytes.get(self.place..).is_some_and(|rest| rest.starts_with(b"\xef\xbb\xbf"))
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
