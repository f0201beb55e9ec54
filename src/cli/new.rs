//! `signorini new`: a first scene for a mesh, or the scene of a deck.

use super::options::New;
use super::outcome::Outcome;
use crate::Error;
use crate::output::write_atomically;
use crate::scene::Scene;

pub(super) fn run(options: &New) -> Result<Outcome, Error> {
    // A scene beside its mesh names the file alone.
    let beside = options.out.as_ref().is_some_and(|out| out.parent() == options.mesh.parent());
    let named = match options.mesh.file_name().filter(|_| beside) {
        Some(name) => name.to_string_lossy().into_owned(),
        None => options.mesh.to_string_lossy().into_owned(),
    };
    let is_deck = Scene::is_deck(&options.mesh);
    let text = match is_deck {
        true => Scene::text_of_deck(&options.mesh, &named, &options.deck.permits(), options.deck.step)?,
        false => Scene::start(&options.mesh, &named)?,
    };
    match &options.out {
        Some(file) => {
            write_atomically(file, text.as_bytes())?;
            let what = if is_deck { "the scene of the deck" } else { "a first scene" };
            Ok(Outcome::done(format!("{}: written as {what}; solve it, then change it\n", file.display())))
        }
        None => Ok(Outcome::done(text)),
    }
}
