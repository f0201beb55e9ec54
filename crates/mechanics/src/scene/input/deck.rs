//! The scene of a deck of CalculiX, by way of its text.

use std::path::Path;

use super::warning::Warning;
use crate::error::Error;
use crate::fem::mesh::deck::Deck;
use crate::scene::Scene;
use signorini_deck::{DeckScene, Reading, ReferenceNode};

/// The scene of a deck, with what it is read from.
pub(crate) fn read(path: &Path, reading: Reading) -> Result<(Scene, Deck, Vec<ReferenceNode>), Error> {
    let named = path.file_name().unwrap_or_default().to_string_lossy();
    let DeckScene { text, warnings, references, deck, lines } = DeckScene::read(path, &named, reading)?;
    let noted = warnings.into_iter().map(|(code, message)| Warning::new(code, message)).collect();
    let (scene, folder) = (Scene::from_json(&text, &named)?, path.parent().map(Path::to_path_buf));
    Ok((Scene { folder, noted, lines, ..scene }, deck, references))
}
