//! From text to a typed scene: every failure has a path, a line and a column.

use std::io;
use std::path::Path;

use serde::Deserialize;
use signorini_qp as qp;

use super::absent::other_format;
use super::deck::is_deck;
use super::json::{Typed, line_and_column, parsed, plain};
use super::locate::MOST_OF_SCENE;
use crate::error::Error;
use crate::scene::Scene;
use signorini_qp::file::read_text_capped;

impl Scene {
    /// Reads a scene from JSON text, in which lines that begin with `//` are comments; errors begin with `source_name`.
    ///
    /// # Errors
    /// [`Error::SceneSyntax`] for text that is not JSON, or does not have the form of a scene.
    pub fn from_json(text: &str, source_name: &str) -> Result<Scene, Error> {
        let text = plain(text);
        parsed(&text).and_then(|scene| Scene::deserialize(Typed(&scene))).map_err(|fault| {
            let (line, column) = line_and_column(&text, fault.at.unwrap_or_default());
            let message = other_format(&text).unwrap_or_else(|| fault.to_string());
            let path = if fault.path.is_empty() { ".".into() } else { fault.path };
            Error::SceneSyntax { source_name: source_name.into(), line, column, path, message }
        })
    }

    /// Reads a scene from a JSON file, or from a deck of CalculiX, whose name ends with `.inp`; relative names of other
    /// files start in its folder.
    ///
    /// # Errors
    /// [`qp::LinearError::File`] for a file that cannot be read, and as [`Scene::from_json`] and [`Scene::read_deck`].
    pub fn read(path: impl AsRef<Path>) -> Result<Scene, Error> {
        let path = path.as_ref();
        if path.is_dir() {
            let source = io::Error::new(io::ErrorKind::IsADirectory, "it is a folder, but a scene is a JSON file");
            return Err(qp::LinearError::File { action: "read", path: path.into(), source }.into());
        }
        if is_deck(path) {
            return Scene::read_deck(path, &[], None);
        }
        let text = read_text_capped(path, MOST_OF_SCENE)?;
        let scene = Self::from_json(&text, &path.display().to_string())?;
        Ok(Scene { folder: path.parent().map(Path::to_path_buf), ..scene })
    }
}
