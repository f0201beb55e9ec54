//! The position of a value in the text of a scene, by its JSON path.

use std::io;
use std::path::Path;

use super::deck::is_deck;
use super::files::Named;
use super::json::{line_and_column, parsed, plain, start_of};
use crate::error::Error;
use crate::scene::Scene;
use signorini_qp as qp;
use signorini_qp::file::read_text_capped;

/// Most bytes of a scene: a height map of millions of points fits.
pub(super) const MOST_OF_SCENE: u64 = 256 << 20;

impl Scene {
    /// An error of a value of a scene of a deck with the line of the deck that it comes from.
    pub(crate) fn with_line(&self, error: Error) -> Error {
        let of = |path: &str| {
            let is_in = |known: &str| {
                path.strip_prefix(known).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
            };
            let known = self.lines.iter().filter(|(known, _)| known.is_empty() || is_in(known));
            known.max_by_key(|(known, _)| known.len()).map(|(_, place)| place.clone())
        };
        match error {
            Error::Scene { path, message } => match of(&path) {
                Some((file, line)) => {
                    let message = format!("at `{path}` of the scene of this deck: {message}");
                    qp::LinearError::FileSyntax { file, line, message }.into()
                }
                None => Error::Scene { path, message },
            },
            Error::Refused { code, place, path, message } => {
                let found = of(&path).map(|(file, line)| format!("{}:{line}: ", file.display()));
                Error::Refused { code, place: found.unwrap_or(place), path, message }
            }
            other => other,
        }
    }

    /// An error of a value with its line and column, if the scene was read from a file that can be read again. Errors
    /// of decks have their lines.
    pub fn located(error: Error, file: &Path) -> Error {
        if is_deck(file) {
            return error;
        }
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
            Error::Linear(qp::LinearError::File { action, path, source }) => {
                let named = source.get_ref().and_then(|reason| reason.downcast_ref::<Named>()).cloned();
                let place = named.as_ref().and_then(|named| place_of(&named.path));
                let source = match (named, place) {
                    (Some(named), Some((line, column))) => {
                        let scene = format!("{}:{line}:{column}", file.display());
                        io::Error::new(source.kind(), Named { scene, ..named })
                    }
                    _ => source,
                };
                qp::LinearError::File { action, path, source }.into()
            }
            other => other,
        }
    }
}

/// Line and column of the value at `path`; if it is missing, of the value that should contain it. `None` if the text is
/// not JSON.
fn position(text: &str, path: &str) -> Option<(usize, usize)> {
    let text = plain(text);
    let scene = parsed(&text).ok()?;
    Some(line_and_column(&text, start_of(&scene, path)))
}
