//! From text to a typed scene: every failure has a path, a line and a column. The JSON Schema of scenes.

use std::io;
use std::path::Path;

use super::absent::other_format;
use super::entry::{Files, Named};
use super::json::{Typed, line_and_column, parsed, plain, start_of};
use super::warning::Warning;
use crate::error::Error;
use crate::fem::mesh::deck::Deck;
use crate::scene::Scene;
use serde::Deserialize;
use serde_json::Value;
use signorini_deck::{DeckScene, Reading, ReferenceNode, is_deck};
use signorini_qp as qp;
use signorini_qp::file::read_text_capped;

pub(crate) fn scene_of(text: &str, source_name: &str) -> Result<Scene, Error> {
    let text = plain(text);
    parsed(&text).and_then(|scene| Scene::deserialize(Typed(&scene))).map_err(|fault| {
        let (line, column) = line_and_column(&text, fault.at.unwrap_or_default());
        let message = other_format(&text).unwrap_or_else(|| fault.to_string());
        let path = if fault.path.is_empty() { ".".into() } else { fault.path };
        Error::SceneSyntax { source_name: source_name.into(), line, column, path, message }
    })
}

pub(crate) fn read(path: &Path) -> Result<Scene, Error> {
    if path.is_dir() {
        let source = io::Error::new(io::ErrorKind::IsADirectory, "it is a folder, but a scene is a JSON file");
        return Err(qp::LinearError::File { action: "read", path: path.into(), source }.into());
    }
    if is_deck(path) {
        return Scene::read_deck(path, &[], None);
    }
    let text = read_text_capped(path, MOST_OF_SCENE)?;
    let scene = scene_of(&text, &path.display().to_string())?;
    Ok(Scene { folder: path.parent().map(Path::to_path_buf), ..scene })
}

/// The scene of a deck, with what it is read from.
pub(crate) fn read_deck(path: &Path, reading: Reading) -> Result<(Scene, Deck, Vec<ReferenceNode>), Error> {
    let named = path.file_name().unwrap_or_default().to_string_lossy();
    let DeckScene { text, warnings, references, deck, lines } = DeckScene::read(path, &named, reading)?;
    let noted = warnings.into_iter().map(|(code, message)| Warning::new(code, message)).collect();
    let (scene, folder) = (Scene::from_json(&text, &named)?, path.parent().map(Path::to_path_buf));
    Ok((Scene { folder, noted, lines, ..scene }, deck, references))
}

pub(crate) fn json_schema() -> String {
    let mut schema = schemars::schema_for!(Scene).to_value();
    without_null(&mut schema);
    let version = env!("CARGO_PKG_VERSION");
    schema["$id"] = Value::String(format!("urn:signorini:scene:{version}"));
    format!("{schema:#}\n")
}

/// Removes `null` from the allowed values: a field that is left out is absent, not null.
fn without_null(schema: &mut Value) {
    match schema {
        Value::Object(map) => {
            if let Some(Value::Array(kinds)) = map.get_mut("type") {
                kinds.retain(|kind| kind != "null");
                if let [kind] = &kinds[..] {
                    let kind = kind.clone();
                    map.insert("type".into(), kind);
                }
            }
            if let Some(Value::Array(choices)) = map.get_mut("anyOf") {
                choices.retain(|choice| choice["type"] != "null");
            }
            if map.get("default").is_some_and(Value::is_null) {
                map.remove("default");
            }
            map.values_mut().for_each(without_null);
        }
        Value::Array(items) => items.iter_mut().for_each(without_null),
        _ => {}
    }
}

/// Most bytes of a scene: a height map of millions of points fits.
pub(super) const MOST_OF_SCENE: u64 = 256 << 20;

/// The files that the scene may name.
pub(crate) fn files(scene: &Scene) -> Files<'_> {
    Files { folder: scene.folder.as_deref().unwrap_or(Path::new("")), reads_outside: scene.reads_outside }
}

/// An error of a value of a scene of a deck with the line of the deck that it comes from.
pub(crate) fn with_line(scene: &Scene, error: Error) -> Error {
    let of = |path: &str| {
        let is_in =
            |known: &str| path.strip_prefix(known).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']));
        let known = scene.lines.iter().filter(|(known, _)| known.is_empty() || is_in(known));
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

pub(crate) fn located(error: Error, file: &Path) -> Error {
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

/// Line and column of the value at `path`; if it is missing, of the value that should contain it. `None` if the text is
/// not JSON.
fn position(text: &str, path: &str) -> Option<(usize, usize)> {
    let text = plain(text);
    let scene = parsed(&text).ok()?;
    Some(line_and_column(&text, start_of(&scene, path)))
}
