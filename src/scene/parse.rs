//! From text to a typed scene: every failure has a path, a line and a column.

use std::borrow::Cow;
use std::io;
use std::path::Path;

use super::Scene;
use super::schema::json::object;
use super::syntax::Fault;
use crate::error::Error;
use crate::file::{MOST_OF_SCENE, read_text_capped};

impl Scene {
    /// Reads a scene from JSON text, in which lines that begin with `//` are comments; errors begin with `source_name`.
    ///
    /// # Errors
    /// [`Error::SceneSyntax`] for text that is not JSON, or does not have the form of a scene.
    pub fn from_json(text: &str, source_name: &str) -> Result<Scene, Error> {
        // Some editors write a byte order mark at the start.
        let text = without_comments(text.strip_prefix('\u{feff}').unwrap_or(text));
        let mut json = serde_json::Deserializer::from_str(&text);
        let mut track = serde_path_to_error::Track::new();
        let scene = object(serde_path_to_error::Deserializer::new(&mut json, &mut track));
        let fail = |path: String, error: serde_json::Error| {
            let (line, column) = (error.line(), error.column().max(1));
            let (path, message) = Fault { text: &text, path, error }.in_words();
            Error::SceneSyntax { source_name: source_name.into(), line, column, path, message }
        };
        let scene = scene.map_err(|error| fail(known_path(track), error))?;
        json.end().map_err(|error| fail(".".into(), error))?;
        Ok(scene)
    }

    /// Reads a scene from a JSON file; relative names of other files start in its folder.
    ///
    /// # Errors
    /// [`Error::File`] for a file that cannot be read, and as [`Scene::from_json`].
    pub fn read(path: impl AsRef<Path>) -> Result<Scene, Error> {
        let path = path.as_ref();
        if path.is_dir() {
            let source = io::Error::new(io::ErrorKind::IsADirectory, "it is a folder, but a scene is a JSON file");
            return Err(Error::File { action: "read", path: path.into(), source });
        }
        let text = read_text_capped(path, MOST_OF_SCENE)?;
        let scene = Self::from_json(&text, &path.display().to_string())?;
        Ok(Scene { folder: path.parent().map(Path::to_path_buf), ..scene })
    }
}

/// The text with empty lines instead of comments, so that all other lines keep their numbers.
fn without_comments(text: &str) -> Cow<'_, str> {
    let is_comment = |line: &str| line.trim_start().starts_with("//");
    if !text.lines().any(is_comment) {
        return Cow::Borrowed(text);
    }
    Cow::Owned(text.split('\n').map(|line| if is_comment(line) { "" } else { line }).collect::<Vec<_>>().join("\n"))
}

/// The position of the parser, without the key that it could not read.
fn known_path(track: serde_path_to_error::Track) -> String {
    match track.path().to_string().trim_end_matches('?').trim_end_matches('.') {
        "" => ".".into(),
        path => path.into(),
    }
}
